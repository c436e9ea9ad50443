//! What an importer has to tell: nothing is dropped or repaired silently.

use std::fmt;
use std::ops::Deref;

/// Findings that are kept one by one; the others are counted.
const MOST_KEPT: usize = 10_000;

/// Bytes of a keyword or a reason that are kept.
const MOST_TEXT: usize = 300;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Something was not needed for the shape and was left out, or was odd but harmless.
    Note,
    /// A piece of shape that the file marks as invisible was left out.
    Hidden,
    /// Something was mended in the way that its author plainly meant.
    Repaired,
    /// Something was guessed; the shape may differ from the author's.
    Warning,
    /// A piece of shape was dropped.
    Dropped,
}

/// One finding about one entity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// The file's entity number; 0 where the finding concerns the whole file.
    pub entity: u64,
    /// The entity's keyword, such as `ADVANCED_FACE`.
    pub kind: String,
    /// What happened and why.
    pub reason: String,
    /// How many declared faces are not in the model because of it.
    pub faces: u32,
}

impl Diagnostic {
    /// A finding that costs no face.
    pub fn new(severity: Severity, entity: u64, kind: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { severity, entity, kind: kind.into(), reason: reason.into(), faces: 0 }
    }

    /// A face that is dropped.
    pub fn dropped_face(entity: u64, kind: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { faces: 1, ..Self::new(Severity::Dropped, entity, kind, reason) }
    }

    /// A face that is not wanted.
    pub fn hidden_face(entity: u64, kind: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { faces: 1, ..Self::new(Severity::Hidden, entity, kind, reason) }
    }
}

/// Findings in the order in which they were made.
///
/// A broken file can have millions. The first ten thousand are kept as they are; behind them stands one finding for each
/// severity that says how many more there were and how many faces these cost.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    /// How many findings each one behind [`MOST_KEPT`] stands for.
    counts: Vec<usize>,
}

impl Diagnostics {
    /// Adds a finding; long texts are cut.
    pub fn push(&mut self, mut diagnostic: Diagnostic) {
        if self.list.len() < MOST_KEPT {
            shorten(&mut diagnostic.kind);
            shorten(&mut diagnostic.reason);
            self.list.push(diagnostic);
            return;
        }
        let others = &self.list[MOST_KEPT..];
        let at = others.iter().position(|other| other.severity == diagnostic.severity).unwrap_or_else(|| {
            self.list.push(Diagnostic::new(diagnostic.severity, 0, "file", ""));
            self.counts.push(0);
            self.counts.len() - 1
        });
        self.counts[at] += 1;
        let summary = &mut self.list[MOST_KEPT + at];
        summary.faces = summary.faces.saturating_add(diagnostic.faces);
        summary.reason = format!("{} more findings of this kind are not listed", self.counts[at]);
    }

    /// Every finding costs so many times the faces: those of copies of the model.
    pub(super) fn multiply_faces(&mut self, copies: u32) {
        for diagnostic in &mut self.list {
            diagnostic.faces = diagnostic.faces.saturating_mul(copies);
        }
    }
}

impl Deref for Diagnostics {
    type Target = [Diagnostic];
    fn deref(&self) -> &[Diagnostic] {
        &self.list
    }
}

impl<const N: usize> PartialEq<[Diagnostic; N]> for Diagnostics {
    fn eq(&self, other: &[Diagnostic; N]) -> bool {
        self.list == other
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

fn shorten(text: &mut String) {
    if text.len() > MOST_TEXT {
        text.truncate(text.floor_char_boundary(MOST_TEXT));
        text.push('…');
        text.shrink_to_fit();
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Note => "note",
            Severity::Hidden => "hidden",
            Severity::Repaired => "repaired",
            Severity::Warning => "warning",
            Severity::Dropped => "dropped",
        };
        write!(f, "{severity}: ")?;
        if self.entity != 0 {
            write!(f, "#{} ", self.entity)?;
        }
        write!(f, "{}: {}", self.kind, self.reason)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_findings_are_counted() {
        let mut found = Diagnostics::default();
        for entity in 0..1_000_000 {
            let severity = if entity % 4 == 0 { Severity::Note } else { Severity::Dropped };
            let faces = u32::from(severity == Severity::Dropped);
            found.push(Diagnostic { faces, ..Diagnostic::new(severity, entity, "é".repeat(400), "") });
        }
        assert_eq!(found.len(), MOST_KEPT + 2);
        assert_eq!(found.iter().map(|d| d.faces).sum::<u32>(), 750_000);
        assert!(found.iter().all(|d| d.kind.len() <= MOST_TEXT + '…'.len_utf8()));
        let last = found.last().expect("a summary");
        assert_eq!((last.severity, last.faces), (Severity::Dropped, 750_000 - 7_500));
        assert!(last.reason.starts_with("742500 more"), "{}", last.reason);
    }
}
