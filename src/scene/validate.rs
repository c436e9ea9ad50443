//! Every index, count and bound of a scene, checked once before any kernel relies on them.

use super::Scene;

/// What is wrong with a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{array}[{index}]: {reason}")]
pub struct InvalidScene {
    /// The array.
    pub array: &'static str,
    /// The element.
    pub index: usize,
    /// What is wrong with it.
    pub reason: &'static str,
}

/// Checks all that the kernels rely on: after it, no index is out of range, no tree has a cycle or is deeper than the kernels' stacks.
pub fn validate(scene: &Scene<'_>) -> Result<(), InvalidScene> {
    todo!()
}
