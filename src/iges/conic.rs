//! Conic arcs (entity 104): `A x² + B x y + C y² + D x + E y + F = 0` at a height, from a start to an end.

use super::curve::sweep;
use super::directory::{Mapped, Parameters};
use crate::geometry::{Curve, Frame};
use glam::{DMat2, DVec2};

/// A discriminant below this share of the coefficients makes a parabola where the form does not say what it is.
const PARABOLIC: f64 = 1e-10;

/// The curve, its range, and the file's own range.
pub fn piece(parameters: &Parameters, form: i32) -> Mapped<(Curve, [f64; 2], [f64; 2])> {
    let mut values = [0.0; 11];
    for (i, value) in values.iter_mut().enumerate() {
        *value = parameters.real(i + 1)?;
    }
    let [a, b, c, d, e, f, height, x1, y1, x2, y2] = values;
    let conic = Conic {
        quadratic: DMat2::from_cols_array(&[a, 0.5 * b, 0.5 * b, c]),
        linear: DVec2::new(d, e),
        constant: f,
        height,
        ends: [DVec2::new(x1, y1), DVec2::new(x2, y2)],
    };
    let size = a.abs().max(b.abs()).max(c.abs());
    let determinant = conic.quadratic.determinant();
    let parabolic = match form {
        3 => true,
        1 | 2 => false,
        _ => determinant.abs() <= PARABOLIC * size * size,
    };
    let found = if size == 0.0 {
        None
    } else if parabolic {
        conic.parabola()
    } else {
        conic.with_center(determinant)
    };
    let finite = |curve: &(Curve, [f64; 2])| {
        curve.1.iter().all(|t| t.is_finite()) && curve.0.point(curve.1[0]).is_finite()
    };
    let (curve, range) = found.filter(finite).ok_or_else(|| parameters.problem("the conic is degenerate"))?;
    Ok((curve, range, range))
}

struct Conic {
    quadratic: DMat2,
    linear: DVec2,
    constant: f64,
    height: f64,
    ends: [DVec2; 2],
}

/// The eigenvalues of a symmetric matrix and the eigenvector of the first; the other one is perpendicular to it.
fn eigen(matrix: &DMat2) -> ([f64; 2], DVec2) {
    let (p, q, r) = (matrix.x_axis.x, matrix.x_axis.y, matrix.y_axis.y);
    let angle = 0.5 * (2.0 * q).atan2(p - r);
    let axis = DVec2::from_angle(angle);
    let value = |v: DVec2| v.dot(*matrix * v);
    ([value(axis), value(axis.perp())], axis)
}

impl Conic {
    fn frame(&self, origin: DVec2, x: DVec2) -> Frame {
        Frame::from_axes(origin.extend(self.height), None, Some(x.extend(0.0)))
    }

    fn with_center(&self, determinant: f64) -> Option<(Curve, [f64; 2])> {
        let center = self.quadratic.inverse() * self.linear * -0.5;
        let level = -(self.constant + 0.5 * self.linear.dot(center));
        let (values, axis) = eigen(&self.quadratic);
        // λ₁ x'² + λ₂ y'² = level around the centre.
        let squares = values.map(|value| level / value);
        let local = |axis: DVec2| self.ends.map(|p| (p - center).rotate(DVec2::new(axis.x, -axis.y)));
        if determinant > 0.0 {
            let radii = squares.map(f64::sqrt);
            if !radii.iter().all(|r| *r > 0.0 && r.is_finite()) {
                return None;
            }
            let [start, end] = local(axis).map(|p| p / DVec2::from_array(radii));
            let from = start.y.atan2(start.x);
            let curve = Curve::Ellipse { frame: self.frame(center, axis), radii };
            return Some((curve, [from, from + sweep(start, end, 1.0)]));
        }
        let (along, squares) =
            if squares[0] > 0.0 { (axis, squares) } else { (axis.perp(), [squares[1], squares[0]]) };
        let radii = [squares[0].sqrt(), (-squares[1]).sqrt()];
        if !radii.iter().all(|r| *r > 0.0 && r.is_finite()) {
            return None;
        }
        // The branch on which the start lies.
        let along = if local(along)[0].x < 0.0 { -along } else { along };
        let range = local(along).map(|p| (p.y / radii[1]).asinh());
        Some((Curve::Hyperbola { frame: self.frame(center, along), radii }, range))
    }

    fn parabola(&self) -> Option<(Curve, [f64; 2])> {
        let (values, axis) = eigen(&self.quadratic);
        // λ y'² + δ x' + ε y' + F = 0, with x' along the axis of symmetry.
        let (axis, value) =
            if values[0].abs() < values[1].abs() { (axis, values[1]) } else { (axis.perp(), values[0]) };
        let (delta, epsilon) = (self.linear.dot(axis), self.linear.dot(axis.perp()));
        let y = -epsilon / (2.0 * value);
        let x = (value * y * y - self.constant) / delta;
        let four_focal = -delta / value;
        let (open, focal) =
            if four_focal < 0.0 { (-axis, -0.25 * four_focal) } else { (axis, 0.25 * four_focal) };
        if !(focal > 0.0 && focal.is_finite()) {
            return None;
        }
        let vertex = axis * x + axis.perp() * y;
        let range = self.ends.map(|p| (p - vertex).dot(open.perp()) / (2.0 * focal));
        Some((Curve::Parabola { frame: self.frame(vertex, open), focal }, range))
    }
}
