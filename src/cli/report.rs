//! What was dropped, repaired and guessed, for people: many findings of one kind are one line.

use crate::scene::{Finding, Metadata, Severity};
use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

/// Lines before "and more", unless all are asked for.
const LINES: usize = 10;
/// Entities named in a line that stands for many.
const EXAMPLES: usize = 3;

/// A severity's name.
fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Hidden => "hidden",
        Severity::Repaired => "repaired",
        Severity::Warning => "warning",
        Severity::Dropped => "dropped",
    }
}

/// Writes the findings to stderr: drops first; with `all`, every line and the notes too.
pub(super) fn warn(path: &Path, metadata: &Metadata, all: bool) {
    let lines = lines(metadata, all);
    if lines.is_empty() {
        return;
    }
    let mut stderr = std::io::stderr().lock();
    let dropped = metadata.missing_faces(Severity::Dropped);
    // Nobody is left to tell if stderr is closed.
    if dropped > 0 {
        let _ =
            writeln!(stderr, "{}: {dropped} of {} faces dropped", path.display(), metadata.declared_faces);
    } else {
        let _ = writeln!(stderr, "{}:", path.display());
    }
    for line in lines {
        let _ = writeln!(stderr, "  {line}");
    }
}

/// One line for each group of like findings, the worst and largest groups first.
pub(super) fn lines(metadata: &Metadata, all: bool) -> Vec<String> {
    let least = if all { Severity::Note } else { Severity::Repaired };
    let mut groups: Vec<Group<'_>> = Vec::new();
    let mut index_of: HashMap<(Severity, &str, String), usize> = HashMap::new();
    for Finding { severity, entity, kind, reason, .. } in
        metadata.findings.iter().filter(|f| f.severity >= least)
    {
        let index = *index_of.entry((*severity, kind, without_numbers(reason))).or_insert(groups.len());
        if index == groups.len() {
            groups.push(Group { severity: *severity, kind, reason, entities: Vec::new() });
        }
        groups[index].entities.push(*entity);
    }
    groups.sort_by_key(|g| (std::cmp::Reverse(g.severity), std::cmp::Reverse(g.entities.len())));
    let shown = if all { groups.len() } else { LINES };
    let mut lines: Vec<String> = groups.iter().take(shown).map(Group::line).collect();
    if groups.len() > shown {
        let rest: usize = groups[shown..].iter().map(|g| g.entities.len()).sum();
        lines.push(format!("and {rest} more findings (-v shows all)"));
    }
    lines
}

struct Group<'a> {
    severity: Severity,
    kind: &'a str,
    reason: &'a str,
    entities: Vec<u64>,
}

impl Group<'_> {
    fn line(&self) -> String {
        let mut line = severity_name(self.severity).to_owned();
        let count = self.entities.len();
        if count > 1 {
            line += &format!(" {count} times");
        }
        line += ": ";
        if !self.kind.is_empty() {
            line += &format!("{}: ", self.kind);
        }
        line += self.reason;
        let named: Vec<String> =
            self.entities.iter().filter(|&&e| e != 0).take(EXAMPLES).map(|e| format!("#{e}")).collect();
        if !named.is_empty() {
            let more = if self.entities.len() > named.len() { ", …" } else { "" };
            line += &format!(" ({}{more})", named.join(", "));
        }
        line
    }
}

/// The text with every number replaced, so that findings that differ in a distance or an entity number are like.
fn without_numbers(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut in_number = false;
    let mut previous = ' ';
    for c in text.chars() {
        let continues = in_number
            && (c.is_ascii_digit()
                || matches!(c, '.' | 'e' | 'E')
                || (matches!(c, '+' | '-') && matches!(previous, 'e' | 'E')));
        if !continues {
            in_number = c.is_ascii_digit();
            out.push(if in_number { '0' } else { c });
        }
        previous = c;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(findings: Vec<(Severity, u64, &str, &str, u32)>) -> Metadata {
        let findings = findings
            .into_iter()
            .map(|(severity, entity, kind, reason, faces)| Finding {
                severity,
                entity,
                kind: kind.to_owned(),
                reason: reason.to_owned(),
                faces,
            })
            .collect();
        Metadata { findings, declared_faces: 100, ..Metadata::default() }
    }

    #[test]
    fn like_findings_are_one_line() {
        let metadata = metadata(vec![
            (Severity::Repaired, 5, "EDGE_CURVE", "edge lies 3.25e-3 mm off", 0),
            (Severity::Dropped, 7, "ADVANCED_FACE", "no surface #12", 1),
            (Severity::Dropped, 8, "ADVANCED_FACE", "no surface #139", 1),
            (Severity::Note, 9, "PRODUCT", "no name", 0),
            (Severity::Hidden, 10, "OPEN_SHELL", "invisible", 3),
            (Severity::Repaired, 6, "EDGE_CURVE", "edge lies 1e+2 mm off", 0),
        ]);
        assert_eq!(
            lines(&metadata, false),
            [
                "dropped 2 times: ADVANCED_FACE: no surface #12 (#7, #8)",
                "repaired 2 times: EDGE_CURVE: edge lies 3.25e-3 mm off (#5, #6)",
            ]
        );
        assert_eq!(lines(&metadata, true).len(), 4);
        assert_eq!(metadata.missing_faces(Severity::Dropped), 2);
        assert_eq!(metadata.missing_faces(Severity::Hidden), 3);
    }

    #[test]
    fn long_reports_are_cut() {
        let reasons: Vec<String> = (b'a'..=b'z').map(|c| char::from(c).to_string()).collect();
        let metadata = metadata(reasons.iter().map(|r| (Severity::Warning, 0, "X", r.as_str(), 0)).collect());
        let lines = lines(&metadata, false);
        assert_eq!(lines.len(), LINES + 1);
        assert_eq!(lines[LINES], "and 16 more findings (-v shows all)");
    }
}
