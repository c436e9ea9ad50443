//! The words of the study's trim structures: every place in bounds, every walk ends, in time that grows with the words alone.
//!
//! Faces follow each other, lists of references too; a curveset is looked at once, and all curvesets of a face together have no more elements than it
//! has room for. So words that many others point to cannot make the check take longer than reading them all.

use super::trim_study::{HIGH_IS_LEFT, KD_HEADER, MANY_CURVES, PARITY_BIT, PLACES, RECORD_WORDS, STUDY_LEAF};
use super::validate::{Check, require};
use super::{Scene, TRIM_INSIDE, TrimMethod, TrimStructure};

/// Checks the structures of all faces.
pub(super) fn structures(scene: &Scene<'_>, method: TrimMethod) -> Check {
    let faces = || scene.faces.iter().enumerate().filter(|(_, face)| face.trim_root != TRIM_INSIDE);
    let mut ends: Vec<usize> = faces().skip(1).map(|(_, face)| face.trim_root as usize).collect();
    ends.push(scene.trim_nodes.len());
    for ((index, face), end) in faces().zip(ends) {
        let words = scene.trim_nodes.get(face.trim_root as usize..end);
        let face = words.map(|words| Words {
            words,
            points: scene.trim_points.len(),
            max_degree: scene.header.max_trim_degree,
        });
        let is_sound = face.and_then(|face| face.check(method.structure())).is_some();
        require(is_sound, "faces", index, "no such trim structure")?;
    }
    Ok(())
}

struct Words<'a> {
    words: &'a [u32],
    points: usize,
    max_degree: u32,
}

impl Words<'_> {
    fn check(&self, structure: TrimStructure) -> Option<()> {
        match structure {
            TrimStructure::List => self.list(),
            TrimStructure::Slabs => self.slabs(),
            TrimStructure::KdCurves => self.kd_tree(false),
            TrimStructure::KdCurvesets | TrimStructure::KdCurvesetsSf19 => self.kd_tree(true),
            TrimStructure::Packed => None,
        }
    }

    fn get(&self, place: usize) -> Option<u32> {
        self.words.get(place).copied()
    }

    /// A coordinate of the parameter square.
    fn unit(&self, place: usize) -> Option<f32> {
        let x = f32::from_bits(self.get(place)?);
        (0.0..=1.0).contains(&x).then_some(x)
    }

    fn ascending(&self, place: usize, count: usize) -> Option<()> {
        let mut before = -1.0;
        for at in place..place.checked_add(count)? {
            let x = self.unit(at)?;
            (x > before).then_some(())?;
            before = x;
        }
        Some(())
    }

    /// Whether the record is horizontal.
    fn ends(&self, place: usize) -> Option<bool> {
        let [_, low, _, high] =
            [self.unit(place)?, self.unit(place + 1)?, self.unit(place + 2)?, self.unit(place + 3)?];
        self.get(place + RECORD_WORDS - 1)?;
        (low <= high).then_some(low == high)
    }

    fn element(&self, place: usize) -> Option<()> {
        let is_flat = self.ends(place)?;
        let (first, degree) = (self.get(place + 4)?, self.get(place + 5)?);
        if is_flat {
            return Some(());
        }
        let last = self.get(0)?.checked_add(first)?.checked_add(degree)?;
        (degree >= 1 && degree <= self.max_degree && (last as usize) < self.points).then_some(())
    }

    fn list(&self) -> Option<()> {
        let count = self.get(1)? as usize;
        (0..count).try_for_each(|index| self.element(2 + index * RECORD_WORDS))
    }

    fn slabs(&self) -> Option<()> {
        let count = self.get(1)? as usize;
        if count == 0 {
            return Some(());
        }
        self.ascending(2, count + 1)?;
        let table = 2 + count + 1;
        let mut place = table + count;
        for slab in 0..count {
            (self.get(table + slab)? as usize == place).then_some(())?;
            place = self.slab(place)?;
        }
        Some(())
    }

    /// Returns the place after the slab.
    fn slab(&self, place: usize) -> Option<usize> {
        let count = self.get(place)? as usize;
        if count > 0 {
            self.ascending(place + 1, count + 1)?;
        }
        let first = place + 1 + count + 1;
        // A slab of no curves, or of vertical lines at one place, has an end and no interval.
        let end = first.checked_add(count)?;
        let mut list = end;
        for interval in first..end {
            let word = self.get(interval)?;
            let at = (word & (PLACES - 1)) as usize;
            let mut number = word >> 24 & MANY_CURVES;
            match number {
                0 => continue,
                1 => {
                    self.element(at)?;
                    continue;
                }
                _ => (at == list).then_some(())?,
            }
            if number == MANY_CURVES {
                number = self.get(list)?;
                list += 1;
            }
            for reference in list..list.checked_add(number as usize)? {
                self.element(self.get(reference)? as usize)?;
            }
            list += number as usize;
        }
        Some(list)
    }

    fn kd_tree(&self, has_sets: bool) -> Option<()> {
        (1..KD_HEADER).try_for_each(|place| self.unit(place).map(|_| ()))?;
        let mut seen = vec![false; self.words.len()];
        let mut open = vec![KD_HEADER];
        // References of leaves, in the order of their lists; elements of sets.
        let mut list = None;
        let mut elements = 0;
        while let Some(node) = open.pop() {
            if std::mem::replace(seen.get_mut(node)?, true) {
                return None;
            }
            let word = self.get(node + 1)?;
            if word >> 30 < STUDY_LEAF {
                let distance = (word & (HIGH_IS_LEFT - 1)) as usize;
                f32::from_bits(self.get(node)?).is_finite().then_some(())?;
                (distance > 2).then_some(())?;
                open.push(node + distance);
                open.push(node + 2);
                continue;
            }
            let count = (word & (PARITY_BIT - 1)) as usize;
            let first = if count == 1 { node } else { self.get(node)? as usize };
            if count > 1 {
                (list.is_none_or(|expected| expected == first)).then_some(())?;
                list = Some(first.checked_add(count)?);
            }
            for at in first..first.checked_add(count)? {
                let place = (self.get(at)? & (HIGH_IS_LEFT - 1)) as usize;
                if has_sets { self.curveset(place, &mut seen, &mut elements)? } else { self.element(place)? }
            }
        }
        Some(())
    }

    fn curveset(&self, place: usize, seen: &mut [bool], elements: &mut usize) -> Option<()> {
        let is_flat = self.ends(place)?;
        if std::mem::replace(seen.get_mut(place)?, true) || is_flat {
            return Some(());
        }
        let (first, count) = (self.get(place + 4)? as usize, self.get(place + 5)? as usize);
        *elements += count;
        (count > 0 && *elements <= self.words.len() / RECORD_WORDS).then_some(())?;
        (0..count).try_for_each(|index| self.element(first + index * RECORD_WORDS))
    }
}
