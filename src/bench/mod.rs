//! Measurements of what the other rooms do; nothing else depends on them.

mod accuracy;
mod rays;
mod stages;

pub use accuracy::{Accuracy, Quantiles, measure_accuracy};
pub use rays::chord;
pub use stages::{Seconds, Stages, measure_stages};
