//! The second half of a face's bake: its records, with indices that count from its own arrays.

use super::narrow::{self, GridPoint};
use super::nets::{self, Nets};
use super::outline::Outline;
use super::times::{BakeTimes, timed};
use super::trim_segments::Evaluation;
use super::trim_tree::{self, TrimTree};
use crate::brep;
use crate::geometry::{Frame, Surface};
use crate::numeric::Aabb;
use crate::scene::{Face, FaceF64, FaceInfo, FaceKind, TRIM_INSIDE};
use glam::{DVec2, DVec3};

/// Where a part's own coordinates lie in the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartSpace {
    /// Part space = the part's own coordinates − this; a multiple of `grid_step`.
    pub center: DVec3,
    /// Millimetres.
    pub grid_step: f64,
    /// The size from which leaves are divided further, millimetres.
    pub large_leaf: f64,
}

/// Everything that one face adds to the scene.
#[derive(Debug)]
pub(super) struct BakedFace {
    /// `trim_root` is 0 or [`TRIM_INSIDE`]; material and part are not set.
    pub face: Face,
    /// The same in f64.
    pub face_f64: FaceF64,
    /// For people.
    pub info: FaceInfo,
    /// Part-space boxes: one for an analytic face, else one for each leaf.
    pub boxes: Vec<Aabb>,
    /// The nets; empty for analytic faces.
    pub nets: Nets,
    /// The trim tree; empty where the whole window is inside.
    pub trim: TrimTree,
    /// What it took.
    pub times: BakeTimes,
}

/// An analytic surface in the terms of the scene.
struct Carrier {
    kind: FaceKind,
    frame: Frame,
    radii: [f64; 2],
    /// Surface parameters − parameters of `frame`.
    slide: DVec2,
}

/// Bakes a face; fails with the reason where nothing of it remains.
pub(super) fn bake_face(
    surface: &Surface,
    face: &brep::Face,
    outline: &Outline,
    space: &PartSpace,
    is_alone: bool,
    distortion: f64,
    max_leaves: usize,
) -> Result<BakedFace, String> {
    let (trim, trim_trees) = timed(|| trim_tree::build(&outline.region, Evaluation::Curves));
    let mut trim = trim?;
    if trim.uniform() == Some(false) {
        return Err("its trim curves enclose nothing".into());
    }
    let size = outline.window.max - outline.window.min;
    let period = DVec2::from_array(surface.periods().map(|p| p.unwrap_or(0.0))) / size;
    let (carrier, mut nets) = match carrier(surface, outline) {
        Some(carrier) => (carrier, None),
        None => {
            let Surface::Bspline(bspline) = surface else {
                unreachable!("all other surfaces have analytic carriers");
            };
            let (origin, nets) =
                nets::bake_nets(bspline, period, outline, &trim, space, distortion, max_leaves)?;
            let frame = Frame { origin: origin + space.center, ..Frame::IDENTITY };
            let carrier = Carrier { kind: FaceKind::Nets, frame, radii: [0.0; 2], slide: DVec2::ZERO };
            (carrier, Some(nets))
        }
    };
    let origin = carrier.frame.origin - space.center;
    let GridPoint { grid, fraction } =
        narrow::grid_point(origin, space.grid_step).ok_or("its surface's origin lies too far out")?;

    let reach = match &nets {
        Some(nets) => nets.reach,
        None => carrier.radii[0].abs() + carrier.radii[1].abs(),
    };
    let slack = outline.slack(reach);
    if let Some(nets) = &mut nets {
        nets.grow(slack);
    }
    let low = outline.window.min - carrier.slide;
    let needs_trim = match &nets {
        Some(nets) => nets.is_mixed,
        None => trim.uniform() != Some(true),
    };
    if !needs_trim {
        trim = TrimTree::default();
    }
    let boxes = match &nets {
        Some(nets) => nets.boxes.clone(),
        None => {
            let bounds =
                Aabb { min: outline.bounds.min - space.center, max: outline.bounds.max - space.center };
            vec![bounds.grown(slack)]
        }
    };
    let record = Face {
        grid,
        kind: carrier.kind as u32,
        x_axis: narrow::vector(carrier.frame.x),
        radius_0: narrow::number(carrier.radii[0]),
        y_axis: narrow::vector(carrier.frame.y),
        radius_1: narrow::number(carrier.radii[1]),
        z_axis: narrow::vector(carrier.frame.z),
        flags: if face.same_sense { 0 } else { Face::REVERSED } | if is_alone { Face::ALONE } else { 0 },
        offset: fraction,
        material: 0,
        uv_low: narrow::pair(low),
        uv_scale: narrow::pair(DVec2::ONE / size),
        period: narrow::pair(period),
        trim_root: if needs_trim { 0 } else { TRIM_INSIDE },
        part: 0,
        slack: narrow::above(slack),
        body: 0,
        reserved: [0; 2],
    };
    // A window that is too large for single precision has a scale of 0.
    if !is_finite(&record) || record.uv_scale.iter().any(|scale| !(*scale > 0.0)) {
        return Err("its numbers are beyond single precision".into());
    }
    let nets = nets.unwrap_or_default();
    Ok(BakedFace {
        times: nets.times + BakeTimes { trim_trees, ..BakeTimes::default() },
        face: record,
        face_f64: FaceF64 {
            origin: origin.to_array(),
            x_axis: carrier.frame.x.to_array(),
            y_axis: carrier.frame.y.to_array(),
            z_axis: carrier.frame.z.to_array(),
            radii: carrier.radii,
            uv_low: low.to_array(),
            uv_scale: (DVec2::ONE / size).to_array(),
            period: period.to_array(),
        },
        info: FaceInfo {
            entity: face.entity,
            uv_low: outline.window.min.to_array(),
            uv_size: size.to_array(),
        },
        boxes,
        nets,
        trim,
    })
}

/// The carrier of an analytic surface, its frame slid to the middle of the window.
fn carrier(surface: &Surface, outline: &Outline) -> Option<Carrier> {
    let middle = (outline.window.min + outline.window.max) * 0.5;
    let slid = |frame: &Frame, by: DVec3| Frame { origin: frame.point(by), ..*frame };
    let along = DVec2::new(0.0, middle.y);
    Some(match surface {
        Surface::Plane { frame } => Carrier {
            kind: FaceKind::Plane,
            frame: slid(frame, middle.extend(0.0)),
            radii: [0.0; 2],
            slide: middle,
        },
        Surface::Cylinder { frame, radius } => Carrier {
            kind: FaceKind::Cylinder,
            frame: slid(frame, DVec3::Z * middle.y),
            radii: [*radius, 0.0],
            slide: along,
        },
        Surface::Cone { frame, radius, half_angle } => {
            let slope = half_angle.tan();
            Carrier {
                kind: FaceKind::Cone,
                frame: slid(frame, DVec3::Z * middle.y),
                radii: [radius + middle.y * slope, slope],
                slide: along,
            }
        }
        Surface::Sphere { frame, radius } => {
            Carrier { kind: FaceKind::Sphere, frame: *frame, radii: [*radius, 0.0], slide: DVec2::ZERO }
        }
        Surface::Torus { frame, major, minor } => {
            Carrier { kind: FaceKind::Torus, frame: *frame, radii: [*major, *minor], slide: DVec2::ZERO }
        }
        Surface::Bspline(_) => return None,
    })
}

fn is_finite(face: &Face) -> bool {
    let vectors = [face.x_axis, face.y_axis, face.z_axis, face.offset];
    let pairs = [face.uv_low, face.uv_scale, face.period, [face.radius_0, face.radius_1]];
    vectors.iter().flatten().chain(pairs.iter().flatten()).all(|x| x.is_finite())
}
