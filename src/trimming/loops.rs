//! Loops in the parameter plane: unwrapping, seams, poles, closing.

use super::{FaceTrim, TrimError, TrimOptions};
use crate::brep::{Face, Id, Model};

/// The trimmed region of `face`.
pub fn trim_face(model: &Model, face: Id<Face>, options: &TrimOptions) -> Result<FaceTrim, TrimError> {
    todo!()
}
