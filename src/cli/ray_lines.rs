//! Rays as people write them: a line `ox oy oz dx dy dz` each; what is empty or begins with `#` is none.

use crate::render::Ray;
use anyhow::{Context, ensure};
use glam::DVec3;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Rays read at a time: enough to keep every core busy, few enough to keep memory small.
pub(super) const RAYS_AT_A_TIME: usize = 1 << 15;

/// Lines of rays, a batch at a time.
pub(super) struct RayLines {
    reader: Box<dyn BufRead>,
    name: String,
    number: usize,
    text: Vec<u8>,
}

/// Rays, and whether something was wrong after the last of them.
pub(super) struct Batch {
    pub(super) rays: Vec<Ray>,
    pub(super) end: anyhow::Result<()>,
}

impl RayLines {
    /// Those of a file, or of stdin for `-`.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        let name = path.display().to_string();
        let reader: Box<dyn BufRead> = if path == Path::new("-") {
            Box::new(std::io::stdin().lock())
        } else {
            Box::new(BufReader::new(File::open(path).with_context(|| name.clone())?))
        };
        Ok(Self { reader, name, number: 0, text: Vec::new() })
    }

    /// The next [`RAYS_AT_A_TIME`] rays; fewer at the end or before a wrong line.
    pub(super) fn batch(&mut self) -> Batch {
        let mut rays = Vec::new();
        while rays.len() < RAYS_AT_A_TIME {
            match self.next_ray() {
                Ok(Some(ray)) => rays.push(ray),
                Ok(None) => break,
                Err(error) => return Batch { rays, end: Err(error) },
            }
        }
        Batch { rays, end: Ok(()) }
    }

    fn next_ray(&mut self) -> anyhow::Result<Option<Ray>> {
        loop {
            self.text.clear();
            self.number += 1;
            // No ray needs more than a few hundred bytes; a file without line ends must not fill the memory.
            let read = (&mut self.reader).take(MAX_LINE).read_until(b'\n', &mut self.text);
            let context = || format!("{}: line {}", self.name, self.number);
            if read.with_context(context)? == 0 {
                return Ok(None);
            }
            let line = str::from_utf8(&self.text).with_context(context)?.trim();
            if !line.is_empty() && !line.starts_with('#') {
                return parse_ray(line).with_context(context).map(Some);
            }
        }
    }
}

/// Bytes that a line may have.
const MAX_LINE: u64 = 4096;

fn parse_ray(line: &str) -> anyhow::Result<Ray> {
    let mut numbers = [0.0; 6];
    let mut words = line.split_whitespace();
    for number in &mut numbers {
        let word = words.next().context("expected six numbers: ox oy oz dx dy dz")?;
        *number = word.parse().ok().with_context(|| format!("`{word}` is no number"))?;
        ensure!(f64::is_finite(*number), "`{word}` is not finite");
    }
    ensure!(words.next().is_none(), "more than six numbers");
    let [x, y, z, dx, dy, dz] = numbers;
    // Scaled first, so that neither tiny nor huge directions underflow or overflow in their length.
    let direction = DVec3::new(dx, dy, dz);
    let direction =
        (direction / direction.abs().max_element()).try_normalize().context("the direction is 0")?;
    Ok(Ray { origin: DVec3::new(x, y, z), direction })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &'static str) -> RayLines {
        RayLines { reader: Box::new(text.as_bytes()), name: "rays".into(), number: 0, text: Vec::new() }
    }

    #[test]
    fn rays_are_normalised_and_comments_skipped() {
        let batch = lines("# a comment\n\n0 1 2  0 0 -5\r\n1e3\t0 0 3 0 4").batch();
        batch.end.expect("all lines are good");
        let down = Ray { origin: DVec3::new(0.0, 1.0, 2.0), direction: -DVec3::Z };
        let slanted = Ray { origin: DVec3::new(1000.0, 0.0, 0.0), direction: DVec3::new(0.6, 0.0, 0.8) };
        assert_eq!(batch.rays[0], down);
        assert!((batch.rays[1].direction - slanted.direction).length() < 1e-15);
        assert_eq!(batch.rays[1].origin, slanted.origin);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, wanted) in [
            ("0 0 0 0 0 1\n0 0 0 0 0 0\n", "rays: line 2: the direction is 0"),
            ("#\n0 0 0 0 0\n", "rays: line 2: expected six numbers"),
            ("0 0 0 0 0 1 7\n", "rays: line 1: more than six"),
            ("0 0 zero 0 0 1\n", "rays: line 1: `zero` is no number"),
            ("0 0 nan 0 0 1\n", "rays: line 1: `nan` is not finite"),
            ("0 0 0 inf 0 1\n", "rays: line 1: `inf` is not finite"),
        ] {
            let error = lines(text).batch().end.expect_err(text);
            assert!(format!("{error:#}").starts_with(wanted), "{error:#}");
        }
    }

    #[test]
    fn tiny_and_huge_directions_are_directions() {
        for scale in ["1e-300", "1e300"] {
            let ray = parse_ray(&format!("0 0 0 {scale} 0 {scale}")).expect("a ray");
            assert!((ray.direction.length() - 1.0).abs() < 1e-12);
        }
    }
}
