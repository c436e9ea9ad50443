//! Lines against what they are known to cover.
