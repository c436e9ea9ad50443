//! Random B-splines and one of each analytic form.

use crate::geometry::{BsplineCurve, BsplineSurface, Frame, Homogeneous, Homogeneous3, Surface};
use arbtest::arbitrary::{Result, Unstructured};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Runs `property` on `runs` fixed streams of random bytes; the number of a failing one is in the message.
pub(super) fn check(runs: u64, mut property: impl FnMut(&mut Unstructured) -> Result<()>) {
    for run in 0..runs {
        let mut state = run;
        let mut next = || {
            // SplitMix64.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (mixed ^ (mixed >> 31)).to_le_bytes()
        };
        let bytes: Vec<u8> = (0..512).flat_map(|_| next()).collect();
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            property(&mut Unstructured::new(&bytes)).expect("enough bytes");
        }));
        if let Err(cause) = outcome {
            eprintln!("failed in run {run}");
            std::panic::resume_unwind(cause);
        }
    }
}

/// A number in `[low, high]`.
pub(super) fn number(u: &mut Unstructured, low: f64, high: f64) -> Result<f64> {
    let share = u.int_in_range(0..=1_000_000u32)? as f64 / 1e6;
    Ok(low + (high - low) * share)
}

/// A point of the cube of side 20 around the origin.
pub(super) fn point(u: &mut Unstructured) -> Result<DVec3> {
    Ok(DVec3::new(number(u, -10.0, 10.0)?, number(u, -10.0, 10.0)?, number(u, -10.0, 10.0)?))
}

/// A rotation, scale and translation, with a mirror now and then.
pub(super) fn similarity(u: &mut Unstructured) -> Result<DAffine3> {
    let turn = DQuat::from_axis_angle(point(u)?.try_normalize().unwrap_or(DVec3::X), number(u, 0.0, 6.0)?);
    let mirror = if u.arbitrary()? { DVec3::new(1.0, 1.0, -1.0) } else { DVec3::ONE };
    let linear = DMat3::from_quat(turn) * DMat3::from_diagonal(mirror * number(u, 0.5, 3.0)?);
    Ok(DAffine3::from_mat3_translation(linear, point(u)?))
}

/// Knots for `count` points: random steps with repeats; clamped at the ends, or running on beyond them.
pub(super) fn knots(u: &mut Unstructured, degree: usize, count: usize, clamped: bool) -> Result<Vec<f64>> {
    let mut knots = vec![number(u, -5.0, 5.0)?];
    for i in 1..count + degree + 1 {
        let at_end = i <= degree || i > count;
        let repeats = knots.iter().rev().take_while(|k| **k == knots[i - 1]).count();
        let stay = if clamped && at_end { true } else { repeats < degree && u.ratio(1, 4)? };
        // The step out of the clamped start and the one into the end have to be steps.
        let stay = stay && !(i == count || (clamped && i == degree + 1));
        knots.push(knots[i - 1] + if stay { 0.0 } else { number(u, 0.1, 2.0)? });
    }
    Ok(knots)
}

/// A control point with a weight in [0.3, 3].
pub(super) fn control_point(u: &mut Unstructured) -> Result<Homogeneous3> {
    Ok(<Homogeneous3 as Homogeneous>::new(point(u)?, number(u, 0.3, 3.0)?))
}

/// The parts of a random curve: degree, knots, points.
pub(super) fn curve_parts(
    u: &mut Unstructured,
    clamped: bool,
) -> Result<(usize, Vec<f64>, Vec<Homogeneous3>)> {
    let degree = u.int_in_range(1..=5usize)?;
    let count = degree + 1 + u.int_in_range(0..=6usize)?;
    let points = (0..count).map(|_| control_point(u)).collect::<Result<_>>()?;
    Ok((degree, knots(u, degree, count, clamped)?, points))
}

/// A random curve.
pub(super) fn curve(u: &mut Unstructured) -> Result<BsplineCurve<Homogeneous3>> {
    let clamped = u.arbitrary()?;
    let (degree, knots, points) = curve_parts(u, clamped)?;
    Ok(BsplineCurve::new(degree, knots, points).expect("the parts are good"))
}

/// A random surface; its control net undulates over a square, so that it does not fold.
pub(super) fn surface(u: &mut Unstructured) -> Result<BsplineSurface> {
    let degrees = [u.int_in_range(1..=4usize)?, u.int_in_range(1..=4usize)?];
    let counts = [degrees[0] + 1 + u.int_in_range(0..=4usize)?, degrees[1] + 1 + u.int_in_range(0..=4usize)?];
    let mut points = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let wiggle = point(u)? * DVec3::new(0.02, 0.02, 0.1);
            points.push(<Homogeneous3 as Homogeneous>::new(
                DVec3::new(i as f64, j as f64, 0.0) * 3.0 + wiggle,
                number(u, 0.7, 1.4)?,
            ));
        }
    }
    let clamped = u.arbitrary()?;
    let all_knots = [knots(u, degrees[0], counts[0], clamped)?, knots(u, degrees[1], counts[1], clamped)?];
    Ok(BsplineSurface::new(degrees, all_knots, points).expect("the parts are good"))
}

/// One surface of each analytic kind, in a tilted frame.
pub(super) fn analytic_surfaces() -> Vec<Surface> {
    let frame = Frame::from_axes(
        DVec3::new(3.0, -2.0, 5.0),
        Some(DVec3::new(1.0, 2.0, 2.0)),
        Some(DVec3::new(1.0, 0.0, 0.3)),
    );
    vec![
        Surface::Plane { frame },
        Surface::Cylinder { frame, radius: 2.5 },
        Surface::Cone { frame, radius: 2.0, half_angle: 0.4 },
        Surface::Cone { frame, radius: 1.0, half_angle: -0.9 },
        Surface::Sphere { frame, radius: 4.0 },
        Surface::Torus { frame, major: 5.0, minor: 1.5 },
    ]
}
