//! Trim regions whose curves are of a higher degree and the same shape: how the cost of trims depends on the degree.
//!
//! As in Figure 9 of Sloup and Havran 2021, which elevates rational Bézier curves by section 5.2 of The NURBS Book.

use super::region::{Piece, Region};
use super::retrim::TrimRegions;
use crate::geometry::{Bezier, Homogeneous2, elevated};

/// What becomes of straight pieces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lines {
    /// They are curves of the degree too, as in a structure that does not know lines.
    Elevated,
    /// They stay lines, which need no more than their two ends.
    Kept,
}

impl TrimRegions {
    /// The same regions with curves of at least `degree`.
    pub fn elevated(&self, degree: usize, lines: Lines) -> Self {
        let mut raised = self.clone();
        raised.regions.iter_mut().for_each(|region| elevate(region, degree, lines));
        raised
    }
}

fn elevate(region: &mut Region, degree: usize, lines: Lines) {
    for curve in &mut region.curves {
        curve.points = elevated(std::mem::take(&mut curve.points), degree);
    }
    if lines == Lines::Kept || degree < 2 {
        return;
    }
    for piece in region.pieces.iter_mut().filter(|piece| piece.curve.is_none()) {
        let ends = [piece.low, piece.high];
        let points = ends.map(|[u, v]| Homogeneous2::new(f64::from(u), f64::from(v), 1.0));
        region.curves.push(Bezier { points: elevated(points.to_vec(), degree) });
        *piece = Piece { curve: Some(region.curves.len() as u32 - 1), t: [0.0, 1.0], ..*piece };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ParameterBox;
    use crate::scene::SceneBuffers;
    use crate::trimming::FaceTrim;
    use glam::DVec2;

    /// A half disc: a rational arc in two pieces and the line below it.
    fn half_disc() -> TrimRegions {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let curve = |points: &[[f64; 3]]| Bezier {
            points: points.iter().map(|&[u, v, w]| Homogeneous2::new(u * w, v * w, w)).collect(),
        };
        let mut trim = FaceTrim::whole(ParameterBox { min: DVec2::ZERO, max: DVec2::ONE });
        trim.curves = vec![
            curve(&[[1.0, 0.25, 1.0], [1.0, 0.75, half], [0.5, 0.75, 1.0]]),
            curve(&[[0.5, 0.75, 1.0], [0.0, 0.75, half], [0.0, 0.25, 1.0]]),
            curve(&[[0.0, 0.25, 1.0], [1.0, 0.25, 1.0]]),
        ];
        TrimRegions::new(vec![Region::new(&trim).expect("a region")], &SceneBuffers::default())
    }

    #[test]
    fn shapes_stay_and_degrees_rise() {
        let regions = half_disc();
        let judge = regions.judge(0);
        for degree in 1..=15 {
            for lines in [Lines::Elevated, Lines::Kept] {
                let raised = regions.elevated(degree, lines);
                let line = if lines == Lines::Kept { 1 } else { degree };
                let degrees: Vec<usize> = raised
                    .degrees()
                    .into_iter()
                    .flat_map(|(degree, n)| std::iter::repeat_n(degree, n))
                    .collect();
                let mut expected = vec![line, degree.max(2), degree.max(2)];
                expected.sort_unstable();
                assert_eq!(degrees, expected, "{degree} {lines:?}");
                let other = raised.judge(0);
                for i in 0..100 {
                    let (place, _) = other.place(f64::from(i) / 100.0).expect("a place");
                    assert!(judge.distance(place) < 1e-13, "{degree} {lines:?} {place:?}");
                    let (place, _) = judge.place(f64::from(i) / 100.0).expect("a place");
                    assert!(other.distance(place) < 1e-12, "{degree} {lines:?} {place:?}");
                }
            }
        }
    }
}
