//! Curves (ISO 10303-42, clause 4.4). Those that need a surface or a distance are in [`super::map_lifted`].

use super::map_bspline;
use super::map_composite::{self, MEETING};
use super::map_geometry::positive_length;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use super::value::{Entity, Record, Value};
use crate::geometry::{BsplineCurve, Curve, Homogeneous, Homogeneous3, invert_curve};
use glam::DVec3;

/// A curve, and what a file says around it.
#[derive(Debug, Clone)]
pub struct MappedCurve {
    /// The carrier, in millimetres; its parameter is the file's, angles in radians.
    pub curve: Curve,
    /// First and last parameter of a TRIMMED_CURVE as it runs: descending where it runs against the carrier.
    pub trim: Option<[f64; 2]>,
    /// The parameter-space curves of a SURFACE_CURVE.
    pub pcurves: Vec<u64>,
    /// What had to be mended.
    pub repairs: Vec<Problem>,
}

impl From<Curve> for MappedCurve {
    fn from(curve: Curve) -> Self {
        Self { curve, trim: None, pcurves: Vec::new(), repairs: Vec::new() }
    }
}

impl MappedCurve {
    /// The parameters from start to end: the trim, else the whole curve, which may be endless.
    pub fn range(&self) -> [f64; 2] {
        self.trim.unwrap_or(self.curve.domain())
    }
}

impl Reader<'_> {
    /// Any curve that we have a form for.
    pub fn curve(&self, id: u64) -> Mapped<MappedCurve> {
        self.curve_in_chain(id, 0)
    }

    /// Curve `id`, `depth` references down a chain of curves and surfaces.
    pub fn curve_in_chain(&self, id: u64, depth: usize) -> Mapped<MappedCurve> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "curves refer to each other in a circle"));
        }
        if let Some(surface_curve) = entity.record("SURFACE_CURVE").filter(|_| entity.records.len() > 1) {
            return self.surface_curve(&entity, surface_curve, 0, depth);
        }
        if entity.is("PCURVE") {
            return self.lifted(id, None, depth + 1);
        }
        if map_bspline::is_curve(&entity) {
            let (spline, repair) = map_bspline::curve(self, &entity)?;
            let repairs = repair.into_iter().map(|reason| problem(&entity, reason)).collect();
            return Ok(MappedCurve { repairs, ..Curve::Bspline(spline).into() });
        }
        if map_composite::segments(&entity).is_some() {
            return self.composite_curve(&entity, depth + 1);
        }
        let record = entity.first();
        let frame = || self.placement(reference(id, record, 1)?);
        let length = |at| positive_length(self, &entity, record, at);
        let curve = match &*record.keyword {
            "LINE" => {
                let origin = self.point(reference(id, record, 1)?)?;
                Curve::Line { origin, direction: self.vector(reference(id, record, 2)?)? }
            }
            "CIRCLE" => Curve::Circle { frame: frame()?, radius: length(2)? },
            "ELLIPSE" => Curve::Ellipse { frame: frame()?, radii: [length(2)?, length(3)?] },
            "PARABOLA" => Curve::Parabola { frame: frame()?, focal: length(2)? },
            "HYPERBOLA" => Curve::Hyperbola { frame: frame()?, radii: [length(2)?, length(3)?] },
            "POLYLINE" => Curve::Bspline(self.polyline(&entity)?),
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "BOUNDED_SURFACE_CURVE" => {
                return self.surface_curve(&entity, record, 1, depth);
            }
            "TRIMMED_CURVE" => {
                let basis = self.curve_in_chain(reference(id, record, 1)?, depth + 1)?;
                let trim = self.trim_range(&basis.curve, record);
                return Ok(MappedCurve { trim: trim.or(basis.trim), ..basis });
            }
            "CURVE_REPLICA" => {
                let parent = self.curve_in_chain(reference(id, record, 1)?, depth + 1)?;
                let curve = parent.curve.transformed(&self.transform(reference(id, record, 2)?)?);
                return Ok(MappedCurve { curve, pcurves: Vec::new(), ..parent });
            }
            "OFFSET_CURVE_3D" => return self.offset_curve(&entity, depth + 1),
            _ => return Err(problem(&entity, "this kind of curve is not supported")),
        };
        Ok(curve.into())
    }

    /// `curve_3d, associated_geometry` from parameter `at` on. Without a usable curve in space the one in the parameter plane is
    /// lifted.
    fn surface_curve(
        &self,
        entity: &Entity,
        record: &Record,
        at: usize,
        depth: usize,
    ) -> Mapped<MappedCurve> {
        let in_space = reference(entity.id, record, at).and_then(|id| self.curve_in_chain(id, depth + 1));
        let pcurves = record.references(at + 1);
        match in_space {
            Ok(curve) => Ok(MappedCurve { pcurves, ..curve }),
            Err(reason) => {
                let lifted = pcurves.iter().find_map(|&id| self.lifted(id, None, depth + 1).ok());
                lifted.map(|curve| MappedCurve { pcurves, ..curve }).ok_or(reason)
            }
        }
    }

    /// The points of a POLYLINE(name, points).
    pub fn polyline_points(&self, entity: &Entity) -> Mapped<Vec<DVec3>> {
        let ids = entity.first().references(1);
        self.charge(entity, ids.len())?;
        ids.into_iter().map(|id| self.point(id)).collect()
    }

    /// A polyline; its parameter counts the points. Those that repeat their predecessor are left out.
    fn polyline(&self, entity: &Entity) -> Mapped<BsplineCurve<Homogeneous3>> {
        let mut corners: Vec<(f64, DVec3)> =
            (0..).map(f64::from).zip(self.polyline_points(entity)?).collect();
        corners.dedup_by_key(|(_, point)| *point);
        let ends = corners.first().into_iter().chain(&corners).chain(corners.last());
        let knots = ends.map(|(knot, _)| *knot).collect();
        let points = corners.iter().map(|(_, point)| Homogeneous::new(*point, 1.0)).collect();
        BsplineCurve::new(1, knots, points).map_err(|error| problem(entity, error.to_string()))
    }

    /// The parameters of a TRIMMED_CURVE(name, basis, trim 1, trim 2, sense, master) on its basis, as it runs.
    fn trim_range(&self, basis: &Curve, record: &Record) -> Option<[f64; 2]> {
        let is_angle = matches!(basis, Curve::Circle { .. } | Curve::Ellipse { .. });
        let factor = if is_angle { self.units.radians } else { 1.0 };
        let by_points = record.get(5).enumeration().is_some_and(|master| master == "CARTESIAN");
        let end = |at: usize| {
            let trims = record.list(at);
            let parameter = trims.iter().filter(|v| v.reference().is_none()).find_map(Value::real);
            let parameter = parameter.map(|t| t * factor);
            let point = trims.iter().find_map(Value::reference).and_then(|id| self.point(id).ok());
            let foot = point.map(|point| invert_curve(basis, point, None));
            match (parameter, point, foot) {
                (Some(parameter), Some(point), Some(foot)) => {
                    let off = |t: f64| basis.point(t).distance(point);
                    // The file says which one rules; it does not where the other one alone fits.
                    let slack = MEETING * basis.derivatives(parameter).first.length();
                    let is_wrong = off(parameter) > slack && off(foot) <= slack;
                    Some(if by_points || is_wrong { foot } else { parameter })
                }
                (parameter, _, foot) => parameter.or(foot),
            }
        };
        let (from, to) = (end(2)?, end(3)?);
        let forward = record.logical(4) != Some(false);
        let range = match basis.period() {
            Some(period) => {
                let turn = if forward { to - from } else { from - to }.rem_euclid(period);
                let turn = if turn == 0.0 { period } else { turn };
                [from, if forward { from + turn } else { from - turn }]
            }
            None => [from, to],
        };
        (range[0] != range[1] && range.iter().all(|t| t.is_finite())).then_some(range)
    }

    /// The point of a vertex: a CARTESIAN_POINT, or one on a curve or surface, or a moved one.
    pub fn vertex_point(&self, id: u64, depth: usize) -> Mapped<DVec3> {
        if let Some(point) = self.plain_triple(id, "CARTESIAN_POINT") {
            return Ok(point * self.units.millimetres);
        }
        let keyword = self.keyword(id);
        if !["POINT_ON_CURVE", "POINT_ON_SURFACE", "POINT_REPLICA"].contains(&&*keyword) {
            return self.point(id);
        }
        let entity = self.entity(id)?;
        let record = entity.first();
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "points refer to each other in a circle"));
        }
        let basis = reference(id, record, 1)?;
        let number = |at| super::reader::real(id, record, at);
        match &*keyword {
            "POINT_ON_CURVE" => {
                let curve = self.curve_in_chain(basis, depth + 1)?.curve;
                Ok(curve.point(number(2)? * self.curve_scale(&curve)))
            }
            "POINT_ON_SURFACE" => {
                let surface = self.parameter_form(basis, depth + 1)?;
                Ok(surface.point(glam::DVec2::new(number(2)?, number(3)?)))
            }
            _ => {
                let parent = self.vertex_point(basis, depth + 1)?;
                Ok(self.transform(reference(id, record, 2)?)?.transform_point3(parent))
            }
        }
    }

    /// The factor from the file's curve parameter to ours.
    pub fn curve_scale(&self, curve: &Curve) -> f64 {
        match curve {
            Curve::Circle { .. } | Curve::Ellipse { .. } => self.units.radians,
            _ => 1.0,
        }
    }
}
