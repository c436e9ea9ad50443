//! The directory (IGES 5.3, clause 2.2.4.4) and the parameters of its entities, decoded when they are asked for.

use super::card::Cards;
use super::compressed;
use super::value::{Delimiters, MOST_VALUES, Value, number, values};
use std::collections::HashMap;

/// Parameter data is decoded again whenever an entity is used again. All in all the reader takes this many times the
/// records that the file has, plus [`FREE_RECORDS`]: a file in which entities refer to each other more often is hostile.
const MOST_READINGS: usize = 64;
const FREE_RECORDS: usize = 100_000;

/// The columns of a parameter record that hold data; the rest points back to the entity.
const PARAMETER_DATA: usize = 64;

/// An entity's line in the directory. Pointers are numbers of directory entries (odd, from 1), 0 where there is none.
#[derive(Debug, Clone, Copy, Default)]
pub struct Entry {
    /// Entity type number.
    pub kind: u32,
    /// The first parameter record, from 1.
    pub parameters: u32,
    /// How many parameter records there are.
    pub records: u32,
    /// The form number.
    pub form: i32,
    /// The level number, or less than 0: minus the property that lists levels.
    pub level: i32,
    /// The transformation matrix.
    pub transform: u32,
    /// The colour number, or less than 0: minus the colour definition.
    pub color: i32,
    /// Blank status: not to be shown.
    pub blanked: bool,
    /// Subordinate switch: physically a part of another entity.
    pub physically_dependent: bool,
    /// Hierarchy: the entity's colour and visibility override those of its members.
    pub is_global: bool,
    /// Use: geometry, annotation, definition, other, logical, 2-D parametric, construction.
    pub usage: u8,
    /// The label, filled up with blanks.
    pub label: [u8; 8],
    /// The number that goes with the label; 0 where there is none.
    pub subscript: u32,
}

/// A file of entities.
#[derive(Debug)]
pub struct Directory<'a> {
    entries: Vec<Entry>,
    parameters: Vec<&'a [u8]>,
    /// The first parameter record that points back to an entity, for entries that point to a wrong one.
    first_record: HashMap<u32, u32>,
    delimiters: Delimiters,
    /// Whether parameters take whole lines and nothing points back.
    compressed: bool,
    /// Records that may still be decoded.
    left: std::cell::Cell<usize>,
}

/// The parameters of one entity.
#[derive(Debug, Clone)]
pub struct Parameters {
    /// The entity's directory number.
    pub entity: u32,
    /// The entity's type.
    pub kind: u32,
    /// The values; the type number comes first, so that indices are those of the standard.
    pub values: Vec<Value>,
}

/// Why an entity cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The directory number of the entity at fault.
    pub entity: u32,
    /// Its type number; 0 where unknown.
    pub kind: u32,
    /// What is wrong.
    pub reason: String,
}

/// The result of a mapping.
pub type Mapped<T> = Result<T, Problem>;

impl<'a> Directory<'a> {
    /// The entities of `cards`, and how many directory records have no other half.
    pub fn new(cards: &Cards<'a>, delimiters: Delimiters) -> (Self, usize) {
        let budget = |records: usize| {
            std::cell::Cell::new(records.saturating_mul(MOST_READINGS).saturating_add(FREE_RECORDS))
        };
        if let Some(lines) = &cards.compressed {
            let compressed::Unfolded { entries, parameters } = compressed::unfold(lines, delimiters);
            let left = budget(parameters.len());
            let first_record = HashMap::new();
            return (Self { entries, parameters, first_record, delimiters, compressed: true, left }, 0);
        }
        let (entries, unpaired) = paired(&cards.directory);
        let mut first_record = HashMap::new();
        for (i, card) in cards.parameters.iter().enumerate() {
            if let Some(entity) = back_pointer(card) {
                first_record.entry(entity).or_insert(i as u32);
            }
        }
        let parameters = cards.parameters.clone();
        let left = budget(parameters.len());
        (Self { entries, parameters, first_record, delimiters, compressed: false, left }, unpaired)
    }

    /// How many entities there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// The directory numbers and entries in file order.
    pub fn entities(&self) -> impl Iterator<Item = (u32, &Entry)> {
        self.entries.iter().enumerate().map(|(i, entry)| (2 * i as u32 + 1, entry))
    }

    /// The entry with directory number `entity`.
    pub fn entry(&self, entity: u32) -> Mapped<&Entry> {
        let missing = || Problem { entity, kind: 0, reason: "the file has no such entity".into() };
        if entity.is_multiple_of(2) {
            return Err(missing());
        }
        self.entries.get(entity as usize / 2).ok_or_else(missing)
    }

    /// Type number of the entity; 0 where there is none.
    pub fn kind(&self, entity: u32) -> u32 {
        self.entry(entity).map_or(0, |entry| entry.kind)
    }

    /// Decodes the parameters of `entity`.
    pub fn parameters(&self, entity: u32) -> Mapped<Parameters> {
        let entry = self.entry(entity)?;
        let fail = |reason: &str| Problem { entity, kind: entry.kind, reason: reason.into() };
        let (first, owned) = self.first_record(entity, entry).ok_or_else(|| fail("it has no parameters"))?;
        let given = (entry.records as usize).max(1);
        let width = if self.compressed { usize::MAX } else { PARAMETER_DATA };
        let mut text = Vec::new();
        let mut ended = false;
        for (i, card) in self.parameters[first..].iter().enumerate() {
            // An entity's own records go on as long as they point back to it, whatever the count says; one that points
            // elsewhere belongs to it too where the count says so and the record before does not end.
            // Where nothing points back, records go on to the end of the last parameter.
            let back = back_pointer(card);
            let is_own = owned && back == Some(entity);
            let is_enough = i >= given && (ended || back.is_some() || self.compressed);
            if !is_own && (is_enough || (owned && ended)) {
                break;
            }
            let left = self.left.get().checked_sub(1);
            self.left.set(left.ok_or_else(|| fail("entities refer to each other too often"))?);
            let mut data = &card[..card.len().min(width)];
            text.extend_from_slice(data);
            if !self.compressed {
                text.resize(text.len() + PARAMETER_DATA - data.len(), b' ');
                // Column 65 is blank; some write numbers of 13 columns, five to a record.
                if card.get(PARAMETER_DATA).is_some_and(|byte| self.delimiters.contains(*byte)) {
                    data = &card[..=PARAMETER_DATA];
                    text.push(card[PARAMETER_DATA]);
                }
            }
            ended = data.trim_ascii_end().last() == Some(&self.delimiters.record);
        }
        let (values, _) = values(&text, self.delimiters);
        if values.len() > MOST_VALUES {
            return Err(fail("it has too many parameters"));
        }
        if !matches!(values.first(), Some(Value::Number(kind)) if *kind == f64::from(entry.kind)) {
            return Err(fail("its parameters are those of another entity"));
        }
        Ok(Parameters { entity, kind: entry.kind, values })
    }

    /// The position of the entity's first parameter record, and whether that record points back to the entity.
    fn first_record(&self, entity: u32, entry: &Entry) -> Option<(usize, bool)> {
        let at = (entry.parameters as usize).checked_sub(1).filter(|at| *at < self.parameters.len());
        let back = at.and_then(|at| back_pointer(self.parameters[at]));
        match (at, back) {
            (Some(at), Some(owner)) if owner == entity && !self.compressed => Some((at, true)),
            _ => match self.first_record.get(&entity) {
                Some(first) => Some((*first as usize, true)),
                None => at.map(|at| (at, false)),
            },
        }
    }
}

impl Parameters {
    /// A problem of this entity.
    pub fn problem(&self, reason: impl Into<String>) -> Problem {
        Problem { entity: self.entity, kind: self.kind, reason: reason.into() }
    }

    /// Parameter `at` as a number; 0 where it is left out.
    pub fn real(&self, at: usize) -> Mapped<f64> {
        match self.values.get(at) {
            Some(Value::Number(number)) => Ok(*number),
            Some(Value::Empty) | None => Ok(0.0),
            Some(_) => Err(self.problem(format!("parameter {at} is no number"))),
        }
    }

    /// Parameter `at` as a number that must be there.
    pub fn given(&self, at: usize) -> Mapped<f64> {
        match self.values.get(at) {
            Some(Value::Number(number)) => Ok(*number),
            _ => Err(self.problem(format!("parameter {at} is missing"))),
        }
    }

    /// Parameter `at` as a number that the record reaches to; 0 where it is left out.
    pub fn within(&self, at: usize) -> Mapped<f64> {
        if at < self.values.len() {
            return self.real(at);
        }
        Err(self.problem(format!("the parameters end before number {at}")))
    }

    /// Parameters from `at` on as a point that the record reaches to; those left out are 0.
    pub fn point_within(&self, at: usize) -> Mapped<glam::DVec3> {
        Ok(glam::DVec3::new(self.within(at)?, self.within(at + 1)?, self.within(at + 2)?))
    }

    /// Parameters from `at` on as a direction; `default` where all are left out or zero.
    pub fn direction(&self, at: usize, default: glam::DVec3) -> Mapped<glam::DVec3> {
        let given = self.point(at)?;
        Ok(given.try_normalize().unwrap_or(default))
    }

    /// Parameters from `at` on as pointers, `count` of them; those that are none are left out.
    pub fn references(&self, at: usize, count: usize) -> Vec<u32> {
        (0..count).filter_map(|i| self.reference(at + i).ok()).collect()
    }

    /// Parameters from `at` on as a point; missing ones are 0.
    pub fn point(&self, at: usize) -> Mapped<glam::DVec3> {
        Ok(glam::DVec3::new(self.real(at)?, self.real(at + 1)?, self.real(at + 2)?))
    }

    /// Parameter `at` as an integer; 0 where it is left out.
    pub fn integer(&self, at: usize) -> Mapped<i64> {
        let number = self.real(at)?;
        if number.fract() == 0.0 && number.abs() < 1e15 {
            Ok(number as i64)
        } else {
            Err(self.problem(format!("parameter {at} is no integer")))
        }
    }

    /// Parameter `at` as a count of things that take `each` parameters: never more than there can be.
    pub fn count(&self, at: usize, each: usize) -> Mapped<usize> {
        let most = self.values.len() / each.max(1);
        usize::try_from(self.integer(at)?)
            .ok()
            .filter(|count| *count <= most)
            .ok_or_else(|| self.problem(format!("parameter {at} is no possible count")))
    }

    /// Parameter `at` as a pointer; 0 where there is none.
    pub fn pointer(&self, at: usize) -> Mapped<u32> {
        u32::try_from(self.integer(at)?).map_err(|_| self.problem(format!("parameter {at} is no pointer")))
    }

    /// Parameter `at` as a pointer that must be there.
    pub fn reference(&self, at: usize) -> Mapped<u32> {
        match self.pointer(at)? {
            0 => Err(self.problem(format!("parameter {at} is no pointer"))),
            entity => Ok(entity),
        }
    }

    /// Parameter `at` as a text; empty where there is none.
    pub fn text(&self, at: usize) -> &str {
        match self.values.get(at) {
            Some(Value::Text(text)) => text.trim(),
            _ => "",
        }
    }
}

/// The entries of the directory's records, two to each, and how many records lack their other half. Both halves begin with
/// the entity's type; where a record is lost its entry stays empty, so that the others keep their numbers.
fn paired(cards: &[&[u8]]) -> (Vec<Entry>, usize) {
    let kind = |card: &[u8]| number(card.get(..8.min(card.len())).unwrap_or_default().trim_ascii());
    let (mut entries, mut unpaired, mut at) = (Vec::with_capacity(cards.len() / 2), 0, 0);
    while let Some(first) = cards.get(at) {
        let second = cards.get(at + 1);
        let after = cards.get(at + 2);
        // A pair that differs is believed unless the next two records are one: some leave the second type out.
        let is_pair = second.is_some_and(|second| {
            kind(first) == kind(second)
                || kind(second).is_none()
                || !after.is_some_and(|after| kind(second).is_some() && kind(second) == kind(after))
        });
        match second {
            Some(second) if is_pair => {
                entries.push(entry(first, second));
                at += 2;
            }
            _ => {
                entries.push(Entry::default());
                unpaired += 1;
                at += 1;
            }
        }
    }
    (entries, unpaired)
}

fn entry(first: &[u8], second: &[u8]) -> Entry {
    let field = |card: &'_ [u8], at: usize| -> i64 {
        let end = card.len().min(8 * at + 8);
        let field = card.get(8 * at..end).unwrap_or_default();
        number(field.trim_ascii()).filter(|n| n.fract() == 0.0).map_or(0, |n| n as i64)
    };
    let status = first.get(64..first.len().min(72)).unwrap_or_default();
    let numbers = |at: usize| if at < 10 { field(first, at - 1) } else { field(second, at - 11) };
    let label = second.get(56..second.len().min(64)).unwrap_or_default();
    Entry::from_fields(numbers, status, label)
}

impl Entry {
    /// An entry from its numbered fields (1 to 20, integers), its status field and its label.
    pub fn from_fields(field: impl Fn(usize) -> i64, status: &[u8], label: &[u8]) -> Self {
        let unsigned = |at: usize| u32::try_from(field(at)).unwrap_or(0);
        let signed = |at: usize| i32::try_from(field(at)).unwrap_or(0);
        // Blanks count as zeros, and leading zeros may be missing.
        let mut digits = [b'0'; 8];
        let shift = 8 - status.len().min(8);
        for (to, from) in digits[shift..].iter_mut().zip(status) {
            *to = if from.is_ascii_digit() { *from } else { b'0' };
        }
        let pair = |at: usize| 10 * (digits[at] - b'0') + digits[at + 1] - b'0';
        Self {
            kind: unsigned(1),
            parameters: unsigned(2),
            records: unsigned(14),
            form: signed(15),
            level: signed(5),
            transform: unsigned(7),
            color: signed(13),
            blanked: pair(0) == 1,
            physically_dependent: matches!(pair(2), 1 | 3),
            is_global: pair(6) == 0,
            usage: pair(4),
            label: std::array::from_fn(|i| label.get(i).copied().unwrap_or(b' ')),
            subscript: unsigned(19),
        }
    }
}

/// The directory number in columns 66 to 72 of a parameter record.
fn back_pointer(card: &[u8]) -> Option<u32> {
    let field = card.get(PARAMETER_DATA + 1..)?.trim_ascii();
    std::str::from_utf8(field).ok()?.parse().ok()
}
