//! Measurements of what the other rooms do; nothing else depends on them.

mod accuracy;
mod first_hits;
mod frames;
mod leaks;
mod lines;
mod misclassified;
mod plot;
mod rays;
mod stages;
pub mod stress;
pub mod trim;
mod work;

pub use accuracy::{Accuracy, Quantiles, Tracer, measure_accuracy};
pub use first_hits::{FirstHitTimes, measure_first_hits};
pub use frames::{FrameLoad, FrameWork, measure_frames, measure_kernel, primary_rays, random_rays};
pub use leaks::{Leaks, count_aimed_leaks, count_uniform_leaks, edge_points, is_closed, rate_bound};
pub use lines::{PlotLine, lines_svg};
pub use plot::{PlotPoint, logarithmic_svg};
pub use rays::{aimed, chord};
pub use stages::{Stage, StageTimes, Stages, StagesError, growth_exponent, measure_stages};
pub use work::{WorkPoint, measure_work};
