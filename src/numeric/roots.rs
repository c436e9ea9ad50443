//! Roots of functions of one variable.
