//! Polynomials in Bernstein form on [0, 1], coefficients `c[0..=n]`: `Σ c[i] · C(n,i) · t^i (1−t)^(n−i)`.
