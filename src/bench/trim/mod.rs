//! The trimming study: the thirty trim methods side by side on the same queries, after section 5 of Sloup and Havran 2021.

mod check;
mod degrees;
#[cfg(feature = "gpu")]
mod device;
mod measure;
mod statistics;

pub use check::{MethodCheck, TrimCheck, check_methods};
pub use degrees::{DEGREE_METHODS, DegreePoint, measure_degrees};
#[cfg(feature = "gpu")]
pub use device::measure_on_gpu;
pub use measure::{
    Beside, DeviceMeasure, MethodMeasure, QuerySet, Rate, SetMeasure, StudyOptions, measure_methods,
    query_sets,
};
pub use statistics::{TrimStatistics, statistics};
