//! Where the copies of an array stand: rectangular (412) and circular (414).

use super::directory::{Mapped, Parameters};
use glam::{DAffine3, DVec2, DVec3};

/// Larger arrays are hostile.
const MOST_COPIES: usize = 100_000;

/// The placements of an array's base in the file's units, those that are left out not among them.
pub fn copies(parameters: &Parameters) -> Mapped<Vec<DAffine3>> {
    match parameters.kind {
        412 => rectangular(parameters),
        _ => circular(parameters),
    }
}

/// Entity 412: base, scale, a corner, how many columns and rows, their distances, the angle of the array about z, how many
/// copies are listed, whether the listed ones are left out, these: numbered from 1, column by column along a row.
fn rectangular(parameters: &Parameters) -> Mapped<Vec<DAffine3>> {
    let scale = match parameters.real(2)? {
        0.0 => 1.0,
        scale => scale,
    };
    let corner = parameters.point(3)?;
    let [columns, rows] = [size(parameters, 6)?, size(parameters, 7)?];
    let step = DVec2::new(parameters.real(8)?, parameters.real(9)?);
    let along = DVec2::from_angle(parameters.real(10)?);
    let count = bounded(parameters, columns.checked_mul(rows))?;
    let shown = shown(parameters, 11, count)?;
    let place = |i: usize| {
        let local = DVec2::new((i % columns) as f64, (i / columns) as f64) * step;
        let offset = along.rotate(local).extend(0.0);
        DAffine3::from_translation(corner + offset) * DAffine3::from_scale(DVec3::splat(scale))
    };
    Ok((0..count).filter(|i| shown(*i)).map(place).collect())
}

/// Entity 414: base, how many copies, the centre, the radius, the angle of the first copy and that between two, then the list as
/// in a rectangular array. Copies are moved, not turned.
fn circular(parameters: &Parameters) -> Mapped<Vec<DAffine3>> {
    let count = bounded(parameters, Some(size(parameters, 2)?))?;
    let center = parameters.point(3)?;
    let radius = parameters.real(6)?;
    let [first, step] = [parameters.real(7)?, parameters.real(8)?];
    let shown = shown(parameters, 9, count)?;
    let place = |i: usize| {
        let around = DVec2::from_angle(first + step * i as f64) * radius;
        DAffine3::from_translation(center + around.extend(0.0))
    };
    Ok((0..count).filter(|i| shown(*i)).map(place).collect())
}

fn size(parameters: &Parameters, at: usize) -> Mapped<usize> {
    let value = parameters.integer(at)?;
    usize::try_from(value).ok().filter(|n| *n > 0).ok_or_else(|| parameters.problem("an array of nothing"))
}

fn bounded(parameters: &Parameters, count: Option<usize>) -> Mapped<usize> {
    count.filter(|count| *count <= MOST_COPIES).ok_or_else(|| parameters.problem("too large an array"))
}

/// Which copies are shown: all where none are listed, else the listed ones or the others.
fn shown(parameters: &Parameters, at: usize, count: usize) -> Mapped<impl Fn(usize) -> bool> {
    let listed = parameters.count(at, 1)?;
    let listed_are_left_out = parameters.integer(at + 1)? == 1;
    let mut is_shown = vec![listed == 0 || listed_are_left_out; count];
    for i in 0..listed {
        if let Some(flag) = usize::try_from(parameters.integer(at + 2 + i)?)
            .ok()
            .and_then(|number| is_shown.get_mut(number.checked_sub(1)?))
        {
            *flag = !listed_are_left_out;
        }
    }
    Ok(move |i: usize| is_shown[i])
}
