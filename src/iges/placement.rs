//! Transformation matrices (entity 124) and the way from an entity's definition space to the model, in millimetres.

use super::directory::{Directory, Mapped};
use glam::{DAffine3, DMat3, DVec3};

/// Matrices may refer to matrices; longer chains are cyclic or hostile.
const MAX_CHAIN: usize = 16;

/// Directions and lengths may differ by this much before a matrix is no similarity: files keep some seven digits.
const SIMILAR: f64 = 1e-5;

/// The place of `entity`: its own matrix, seen from `outer`.
pub fn of(file: &Directory, entity: u32, outer: &DAffine3) -> Mapped<DAffine3> {
    Ok(*outer * chain(file, file.entry(entity)?.transform)?)
}

/// The matrix of entity `next` (124; 0 for none) and of all that it refers to.
pub fn chain(file: &Directory, mut next: u32) -> Mapped<DAffine3> {
    let mut placement = DAffine3::IDENTITY;
    for _ in 0..MAX_CHAIN {
        if next == 0 {
            return Ok(placement);
        }
        // A matrix's own matrix applies after it.
        placement = matrix(file, next)? * placement;
        next = file.entry(next)?.transform;
    }
    Err(super::directory::Problem {
        entity: next,
        kind: 124,
        reason: "matrices refer to each other in a circle".into(),
    })
}

fn matrix(file: &Directory, entity: u32) -> Mapped<DAffine3> {
    let parameters = file.parameters(entity)?;
    if parameters.kind != 124 {
        return Err(parameters.problem("this is no transformation matrix"));
    }
    let mut rows = [[0.0; 4]; 3];
    for (i, value) in rows.iter_mut().flatten().enumerate() {
        *value = parameters.real(i + 1)?;
    }
    let column = |j: usize| DVec3::new(rows[0][j], rows[1][j], rows[2][j]);
    let placement =
        DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3));
    let determinant = placement.matrix3.determinant();
    if determinant != 0.0 && determinant.is_finite() {
        Ok(placement)
    } else {
        Err(parameters.problem("the matrix has no inverse"))
    }
}

/// Whether a placement keeps all shapes: a rotation, a translation, a uniform scale, a mirror.
pub fn is_similarity(placement: &DAffine3) -> bool {
    let [x, y, z] = [placement.matrix3.x_axis, placement.matrix3.y_axis, placement.matrix3.z_axis];
    let size = x.length();
    let near = |value: f64, wanted: f64| (value - wanted).abs() <= SIMILAR * size;
    near(y.length(), size)
        && near(z.length(), size)
        && [x.dot(y), y.dot(z), z.dot(x)].iter().all(|dot| dot.abs() <= SIMILAR * size * size)
}
