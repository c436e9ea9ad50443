//! What was dropped, repaired and guessed, for people: many findings of one kind are one line.

use crate::scene::Metadata;
use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

/// Lines before "and more", unless all are asked for.
const LINES: usize = 10;
/// Entities named in a line that stands for many.
const EXAMPLES: usize = 3;

const WARNING: u8 = 1;
const DROPPED: u8 = 2;

/// A severity's name.
pub(super) fn severity_name(severity: u8) -> &'static str {
    match severity {
        0 => "note",
        WARNING => "warning",
        _ => "dropped",
    }
}

/// Declared faces that are not in the scene.
pub(super) fn dropped_faces(metadata: &Metadata) -> u64 {
    metadata.diagnostics.iter().filter(|d| d.0 >= DROPPED).map(|d| u64::from(d.4)).sum()
}

/// Writes the findings to stderr: drops first; with `all`, every line and the notes too.
pub(super) fn warn(path: &Path, metadata: &Metadata, all: bool) {
    let lines = lines(metadata, all);
    if lines.is_empty() {
        return;
    }
    let mut stderr = std::io::stderr().lock();
    let dropped = dropped_faces(metadata);
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
    let least = if all { 0 } else { WARNING };
    let mut groups: Vec<Group<'_>> = Vec::new();
    let mut index_of: HashMap<(u8, &str, String), usize> = HashMap::new();
    for (severity, entity, kind, reason, _) in metadata.diagnostics.iter().filter(|d| d.0 >= least) {
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
    severity: u8,
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

    fn metadata(diagnostics: Vec<(u8, u64, &str, &str, u32)>) -> Metadata {
        let diagnostics =
            diagnostics.into_iter().map(|(s, e, k, r, f)| (s, e, k.to_owned(), r.to_owned(), f)).collect();
        Metadata { diagnostics, declared_faces: 100, ..Metadata::default() }
    }

    #[test]
    fn like_findings_are_one_line() {
        let metadata = metadata(vec![
            (1, 5, "EDGE_CURVE", "edge lies 3.25e-3 mm off", 0),
            (2, 7, "ADVANCED_FACE", "no surface #12", 1),
            (2, 8, "ADVANCED_FACE", "no surface #139", 1),
            (0, 9, "PRODUCT", "no name", 0),
            (1, 6, "EDGE_CURVE", "edge lies 1e+2 mm off", 0),
        ]);
        assert_eq!(
            lines(&metadata, false),
            [
                "dropped 2 times: ADVANCED_FACE: no surface #12 (#7, #8)",
                "warning 2 times: EDGE_CURVE: edge lies 3.25e-3 mm off (#5, #6)",
            ]
        );
        assert_eq!(lines(&metadata, true).len(), 3);
        assert_eq!(dropped_faces(&metadata), 2);
    }

    #[test]
    fn long_reports_are_cut() {
        let reasons: Vec<String> = (b'a'..=b'z').map(|c| char::from(c).to_string()).collect();
        let metadata = metadata(reasons.iter().map(|r| (1, 0, "X", r.as_str(), 0)).collect());
        let lines = lines(&metadata, false);
        assert_eq!(lines.len(), LINES + 1);
        assert_eq!(lines[LINES], "and 16 more findings (-v shows all)");
    }
}
