//! Other forms of the same shape: moved, turned, scaled, of higher degree, with more knots, in other parameters, turned around.

use crate::brep::{Face, Model};
use crate::geometry::{BsplineSurface, Frame, Homogeneous3, Surface, decompose_surface, elevated};
use glam::{DAffine3, DMat3, DVec3};

/// What is done to a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Moved by powers of two of a millimetre.
    Translation,
    /// Turned by right angles about two axes.
    QuarterTurns,
    /// Made a power of two times as large.
    Scale,
    /// B-splines of degrees higher by one and two.
    Elevation,
    /// B-splines with every span halved, and all inner knots as many as the degree allows.
    KnotInsertion,
    /// B-splines over other intervals.
    Reparametrisation,
    /// B-splines with u and v exchanged and the face turned; other surfaces turned half around their x axis, which turns both parameters.
    Flip,
}

impl Change {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Translation,
        Self::QuarterTurns,
        Self::Scale,
        Self::Elevation,
        Self::KnotInsertion,
        Self::Reparametrisation,
        Self::Flip,
    ];

    /// For people and for `--only`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::QuarterTurns => "quarter-turns",
            Self::Scale => "scale",
            Self::Elevation => "elevation",
            Self::KnotInsertion => "knot-insertion",
            Self::Reparametrisation => "reparametrisation",
            Self::Flip => "flip",
        }
    }

    /// Whether it leaves all other surfaces as they are.
    pub(super) fn is_of_splines(self) -> bool {
        matches!(self, Self::Elevation | Self::KnotInsertion | Self::Reparametrisation)
    }

    /// Where the changed model lies: a similarity without roundings.
    pub(super) fn placement(self) -> DAffine3 {
        match self {
            Self::Translation => DAffine3::from_translation(DVec3::new(1024.0, -64.0, 8192.0)),
            Self::QuarterTurns => DAffine3::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X)),
            Self::Scale => DAffine3::from_scale(DVec3::splat(128.0)),
            _ => DAffine3::IDENTITY,
        }
    }

    /// The changed model.
    pub(super) fn applied(self, model: Model) -> Model {
        let mut model = moved(model, &self.placement());
        for id in model.faces.ids() {
            let Face { surface, same_sense, .. } = model.faces[id].clone();
            let (changed, is_turned) = self.surface(&model.surfaces[surface]);
            model.faces[id].surface = model.surfaces.push(changed);
            model.faces[id].same_sense = same_sense != is_turned;
        }
        model
    }

    /// The changed surface, and whether its normal is opposite to what it was.
    fn surface(self, surface: &Surface) -> (Surface, bool) {
        match (self, surface) {
            (Self::Elevation, Surface::Bspline(spline)) => (Surface::Bspline(raised(spline)), false),
            (Self::KnotInsertion, Surface::Bspline(spline)) => (Surface::Bspline(halved(spline)), false),
            (Self::Reparametrisation, Surface::Bspline(spline)) => {
                (Surface::Bspline(reparametrised(spline)), false)
            }
            (Self::Flip, Surface::Bspline(spline)) => (Surface::Bspline(exchanged(spline)), true),
            (Self::Flip, _) => half_turned(surface),
            _ => (surface.clone(), false),
        }
    }
}

/// The model moved by a similarity that does not mirror, geometry and all.
pub(super) fn moved(mut model: Model, placement: &DAffine3) -> Model {
    for id in model.surfaces.ids() {
        model.surfaces[id] = model.surfaces[id].transformed(placement).0;
    }
    for id in model.edges.ids() {
        model.edges[id].curve = model.edges[id].curve.transformed(placement);
    }
    for id in model.vertices.ids() {
        model.vertices[id].point = placement.transform_point3(model.vertices[id].point);
    }
    model
}

fn reparametrised(spline: &BsplineSurface) -> BsplineSurface {
    let degrees = [spline.u_knots.degree(), spline.v_knots.degree()];
    let u = spline.u_knots.as_slice().iter().map(|knot| 8.0 * knot - 3.0).collect();
    let v = spline.v_knots.as_slice().iter().map(|knot| 0.25 * knot + 1.0).collect();
    spline_of(degrees, [u, v], spline.points.clone())
}

fn exchanged(spline: &BsplineSurface) -> BsplineSurface {
    let degrees = [spline.v_knots.degree(), spline.u_knots.degree()];
    let [rows, columns] = spline.counts();
    let points = (0..columns).flat_map(|j| (0..rows).map(move |i| spline.points[i * columns + j])).collect();
    spline_of(degrees, [&spline.v_knots, &spline.u_knots].map(|knots| knots.as_slice().to_vec()), points)
}

/// The same surface about a frame turned half around its x axis; a plane turns its normal with it.
fn half_turned(surface: &Surface) -> (Surface, bool) {
    let turned = |frame: &Frame| Frame { y: -frame.y, z: -frame.z, ..*frame };
    match surface {
        Surface::Plane { frame } => (Surface::Plane { frame: turned(frame) }, true),
        Surface::Cylinder { frame, radius } => {
            (Surface::Cylinder { frame: turned(frame), radius: *radius }, false)
        }
        Surface::Cone { frame, radius, half_angle } => {
            (Surface::Cone { frame: turned(frame), radius: *radius, half_angle: -half_angle }, false)
        }
        Surface::Sphere { frame, radius } => {
            (Surface::Sphere { frame: turned(frame), radius: *radius }, false)
        }
        Surface::Torus { frame, major, minor } => {
            (Surface::Torus { frame: turned(frame), major: *major, minor: *minor }, false)
        }
        Surface::Bspline(_) => (surface.clone(), false),
    }
}

/// Of degrees higher by one along u and by two along v.
fn raised(spline: &BsplineSurface) -> BsplineSurface {
    by_pieces(spline, 1, [1, 2])
}

fn halved(spline: &BsplineSurface) -> BsplineSurface {
    by_pieces(spline, 2, [0, 0])
}

/// The surface from its Bézier patches, each cut into `parts` along u and v and raised in degree by `more`.
fn by_pieces(spline: &BsplineSurface, parts: usize, more: [usize; 2]) -> BsplineSurface {
    let old = [spline.u_knots.degree(), spline.v_knots.degree()];
    let [p, q] = [old[0] + more[0], old[1] + more[1]];
    let [u_breaks, v_breaks] =
        [&spline.u_knots, &spline.v_knots].map(|knots| breaks(knots.as_slice(), parts));
    let [rows, columns] = [(u_breaks.len() - 1) * p + 1, (v_breaks.len() - 1) * q + 1];
    let mut points = vec![Homogeneous3::default(); rows * columns];
    let across = (v_breaks.len() - 1) / parts;
    for (index, span) in decompose_surface(spline).enumerate() {
        let [a, b] = [index / across, index % across];
        for (i, j) in (0..parts).flat_map(|i| (0..parts).map(move |j| (i, j))) {
            let part = |k: usize| [k as f64 / parts as f64, (k + 1) as f64 / parts as f64];
            let patch = span.patch.piece(part(i), part(j));
            let first = [(a * parts + i) * p, (b * parts + j) * q];
            let along_v: Vec<Vec<Homogeneous3>> =
                patch.points.chunks_exact(old[1] + 1).map(|row| elevated(row.to_vec(), q)).collect();
            for k in 0..=q {
                let column = elevated(along_v.iter().map(|row| row[k]).collect(), p);
                for (l, point) in column.into_iter().enumerate() {
                    points[(first[0] + l) * columns + first[1] + k] = point;
                }
            }
        }
    }
    let repeated = |breaks: &[f64], degree: usize| {
        let ends = [breaks[0], breaks[breaks.len() - 1]];
        let inner = breaks.iter().flat_map(|&value| std::iter::repeat_n(value, degree));
        [ends[0]].into_iter().chain(inner).chain([ends[1]]).collect()
    };
    spline_of([p, q], [repeated(&u_breaks, p), repeated(&v_breaks, q)], points)
}

/// The different knots, with each span between them cut into `parts`.
fn breaks(knots: &[f64], parts: usize) -> Vec<f64> {
    let mut different = knots.to_vec();
    different.dedup();
    let cut = different
        .windows(2)
        .flat_map(|span| (0..parts).map(move |i| span[0] + (span[1] - span[0]) * i as f64 / parts as f64));
    cut.chain(different.last().copied()).collect()
}

fn spline_of(degrees: [usize; 2], knots: [Vec<f64>; 2], points: Vec<Homogeneous3>) -> BsplineSurface {
    BsplineSurface::new(degrees, knots, points).expect("what was a proper B-spline is one still")
}
