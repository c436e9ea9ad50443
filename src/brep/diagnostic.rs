//! What an importer has to tell: nothing is dropped or repaired silently.

use std::fmt;

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
