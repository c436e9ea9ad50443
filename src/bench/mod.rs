//! Measurements of what the other rooms do; nothing else depends on them.

mod stages;

pub use stages::{Seconds, Stages, measure_stages};
