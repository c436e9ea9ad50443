//! How the time of trims depends on the degree of the trim curves: Figure 9 of Sloup and Havran 2021.

use super::measure::{StudyOptions, trim_rate};
use crate::bake::{Lines, TrimRegions, retrim};
use crate::render::cpu::TrimQuery;
use crate::scene::{SceneBuffers, TrimMethod, TrimStructure};

/// The numbers of the methods of Figure 9, and ours.
pub const DEGREE_METHODS: [u32; 9] = [1, 2, 3, 4, 5, 7, 14, 16, 30];

/// Trims of one method on curves of one degree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DegreePoint {
    /// Which one.
    pub method: TrimMethod,
    /// Curves have at least this one.
    pub degree: usize,
    /// Whether straight curves have it too.
    pub lines: Lines,
    /// For a trim, on one thread, of the fastest run.
    pub nanoseconds: f64,
}

/// Measures `methods` on `queries` with curves of at least each of `degrees`; our own once more with its lines kept.
///
/// # Errors
///
/// The reason why a method cannot hold the scene's trims.
pub fn measure_degrees(
    scene: &mut SceneBuffers,
    regions: &TrimRegions,
    queries: &[TrimQuery],
    methods: &[TrimMethod],
    degrees: &[usize],
    options: &StudyOptions,
) -> Result<Vec<DegreePoint>, String> {
    let mut points = Vec::new();
    for &degree in degrees {
        for lines in [Lines::Elevated, Lines::Kept] {
            let raised = regions.elevated(degree, lines);
            let is_wanted = |method: &&TrimMethod| {
                lines == Lines::Elevated || method.structure() == TrimStructure::Packed
            };
            for &method in methods.iter().filter(is_wanted) {
                retrim(scene, &raised, method)?;
                let rate = trim_rate(&scene.scene(), queries, options.runs);
                points.push(DegreePoint { method, degree, lines, nanoseconds: 1e9 / rate.best });
            }
        }
    }
    Ok(points)
}
