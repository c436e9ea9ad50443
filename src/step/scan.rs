//! The statement index of an exchange structure (ISO 10303-21, clauses 5 and 9): where each instance begins and ends.
//!
//! Only the borders of statements are found here; what is inside is decoded when the mapping reaches it
//! ([`super::value`]). So a broken statement costs itself, and what nobody refers to costs nothing.
//!
//! Outside of strings and comments `;` ends a statement and `=` appears nowhere but after an instance name. The second
//! fact finds the end of a statement whose `;` is missing: the next `#digits=` begins a new one. A string that runs over
//! the beginning of another instance at a line's start was never closed.
//!
//! Scopes of edition 1 are flattened: what is inside is as visible as everything else. References to other files
//! (edition 3) are kept apart.
//!
//! Invariants: work is linear in the file, whatever it holds; statements are sorted by id and have distinct ids (the first of
//! several counts); ranges are inside the file and do not overlap; memory is linear in the number of statements.

use memchr::{memchr, memchr3, memmem};
use std::cell::OnceCell;
use std::ops::Range;

/// One instance: `#id = body ;`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement {
    /// The instance name's number.
    pub id: u64,
    /// Bytes between `=` and `;`.
    pub body: Range<usize>,
}

/// Something wrong with the text at a byte position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Byte offset.
    pub at: usize,
    /// The instance concerned; 0 where none is.
    pub id: u64,
    /// What is wrong.
    pub reason: &'static str,
}

/// The indexed file.
#[derive(Debug)]
pub struct Index<'a> {
    /// The whole file.
    pub bytes: &'a [u8],
    /// Bytes of the header section, keyword and end excluded; empty where there is none.
    pub header: Range<usize>,
    /// All instances of all data sections, sorted by id.
    pub statements: Vec<Statement>,
    /// What was wrong on the way: the first [`MOST_FAULTS`] findings.
    pub faults: Vec<Fault>,
    /// How many more there were.
    pub further_faults: usize,
    /// Instances of a reference section, sorted: number, and where the name of the file lies; an empty name is this file's.
    pub external: Vec<(u64, Range<usize>)>,
    /// Offsets of line breaks, found when a line number is first asked for.
    line_breaks: OnceCell<Vec<usize>>,
}

/// A file that is wrong everywhere may be wrong in each of its bytes; after so many findings they are only counted.
pub const MOST_FAULTS: usize = 1000;

impl Index<'_> {
    fn fault(&mut self, at: usize, id: u64, reason: &'static str) {
        if self.faults.len() < MOST_FAULTS {
            self.faults.push(Fault { at, id, reason });
        } else {
            self.further_faults += 1;
        }
    }

    /// The statement with this id.
    pub fn find(&self, id: u64) -> Option<&Statement> {
        self.position(id).map(|at| &self.statements[at])
    }

    /// The index of the statement with this id.
    pub fn position(&self, id: u64) -> Option<usize> {
        // Most files number their instances without gaps.
        let offset = usize::try_from(id.checked_sub(self.statements.first()?.id)?).ok()?;
        if self.statements.get(offset).is_some_and(|s| s.id == id) {
            return Some(offset);
        }
        self.statements.binary_search_by_key(&id, |s| s.id).ok()
    }

    /// Whether a reference section says that this instance stands in another file.
    pub fn is_external(&self, id: u64) -> bool {
        self.external.binary_search_by_key(&id, |(id, _)| *id).is_ok()
    }

    /// The line, from 1, of a byte offset.
    pub fn line(&self, at: usize) -> usize {
        let is_break = |at: &usize| self.bytes[*at] == b'\n' || self.bytes.get(at + 1) != Some(&b'\n');
        let breaks = self
            .line_breaks
            .get_or_init(|| memchr::memchr2_iter(b'\n', b'\r', self.bytes).filter(is_break).collect());
        1 + breaks.partition_point(|&line_break| line_break < at)
    }
}

/// Whether the file begins as an exchange structure, after a byte order mark, white space and comments.
pub fn is_exchange_structure(bytes: &[u8]) -> bool {
    let start = skip_blank(bytes, byte_order_mark(bytes));
    bytes[start..].get(..9).is_some_and(|word| word.eq_ignore_ascii_case(b"ISO-10303"))
}

fn byte_order_mark(bytes: &[u8]) -> usize {
    if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 }
}

/// The first position at or after `at` that is neither white space (or another control character) nor in a comment.
#[inline]
pub fn skip_blank(bytes: &[u8], at: usize) -> usize {
    // Between most tokens there is nothing.
    match bytes.get(at) {
        Some(&byte) if byte > b' ' && byte != b'/' => at,
        _ => skip_some_blank(bytes, at),
    }
}

fn skip_some_blank(bytes: &[u8], mut at: usize) -> usize {
    while at < bytes.len() {
        if bytes[at] <= b' ' {
            at += 1;
        } else if bytes[at..].starts_with(b"/*") {
            at = comment_end(bytes, at);
        } else {
            break;
        }
    }
    at
}

fn comment_end(bytes: &[u8], at: usize) -> usize {
    memmem::find(&bytes[at + 2..], b"*/").map_or(bytes.len(), |length| at + 2 + length + 2)
}

/// The position after a keyword's last character.
pub fn keyword_end(bytes: &[u8], at: usize) -> usize {
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'!');
    bytes[at..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |length| at + length)
}

/// Reads `#digits` and returns the number and the position after it; `None` where there is no such name or it does not fit.
pub fn instance_name(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    if bytes.get(at) != Some(&b'#') {
        return None;
    }
    let mut end = at + 1;
    let mut id = 0_u64;
    while let Some(digit) = bytes.get(end).filter(|b| b.is_ascii_digit()) {
        id = id.checked_mul(10)?.checked_add(u64::from(digit - b'0'))?;
        end += 1;
    }
    (end > at + 1).then_some((id, end))
}

/// `#digits =` at `at`: the number, and the position after the `=`.
fn instance_start(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let (id, end) = instance_name(bytes, at)?;
    let equals = skip_blank(bytes, end);
    (bytes.get(equals) == Some(&b'=')).then_some((id, equals + 1))
}

/// The section that a position lies in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Data,
    Reference,
    Other,
}

/// Finds all statements.
pub fn index(bytes: &[u8]) -> Index<'_> {
    let mut index = Index {
        bytes,
        header: 0..0,
        statements: Vec::new(),
        faults: Vec::new(),
        further_faults: 0,
        external: Vec::new(),
        line_breaks: OnceCell::new(),
    };
    let mut at = byte_order_mark(bytes);
    let mut section = Section::Other;
    // The instances whose scopes are open, from outside in.
    let mut scopes = Vec::new();
    loop {
        at = skip_blank(bytes, at);
        if at >= bytes.len() {
            break;
        }
        if bytes[at] == b'#' && section != Section::Other {
            at = match section {
                Section::Data => read_instance(&mut index, at, &mut scopes),
                _ => read_reference(&mut index, at),
            };
            continue;
        }
        let end = keyword_end(bytes, at);
        if bytes[at..end].eq_ignore_ascii_case(b"ENDSCOPE")
            && let Some(id) = scopes.pop()
        {
            at = read_scoped(&mut index, id, end);
            continue;
        }
        let next = statement_end(bytes, end).next;
        let is = |word: &[u8]| bytes[at..end].eq_ignore_ascii_case(word);
        if is(b"DATA") {
            section = Section::Data;
        } else if is(b"REFERENCE") {
            section = Section::Reference;
        } else if is(b"ENDSEC") {
            section = Section::Other;
        } else if is(b"HEADER") {
            index.header = next..section_end(bytes, next);
            at = index.header.end;
            continue;
        } else if section == Section::Data {
            index.fault(at, 0, "text that is no instance");
        }
        at = next.max(at + 1);
    }
    for id in scopes {
        index.fault(bytes.len(), id, "a scope is not closed");
    }
    sort_by_id(&mut index);
    index.external.sort_by_key(|(id, _)| *id);
    index
}

/// Reads the instance at `at` and returns where the next statement begins. Of one with a scope, `#1=&SCOPE #2=...; ENDSCOPE
/// /#2/ KEYWORD(...)`, only the beginning is read: `scopes` keeps its number.
fn read_instance(index: &mut Index, at: usize, scopes: &mut Vec<u64>) -> usize {
    let bytes = index.bytes;
    let Some((id, start)) = instance_start(bytes, at) else {
        index.fault(at, 0, "an instance needs `#number =`");
        return statement_end(bytes, at + 1).next;
    };
    let start = skip_blank(bytes, start);
    if bytes[start..].get(..6).is_some_and(|word| word.eq_ignore_ascii_case(b"&SCOPE")) {
        scopes.push(id);
        return start + 6;
    }
    read_body(index, id, start)
}

/// Reads the body of instance `id` that begins at `start` and returns where the next statement begins.
fn read_body(index: &mut Index, id: u64, start: usize) -> usize {
    let end = statement_end(index.bytes, start);
    if let Some(reason) = end.fault {
        index.fault(start, id, reason);
    }
    index.statements.push(Statement { id, body: start.min(end.body)..end.body });
    end.next
}

/// Reads the body of instance `id` from after its `ENDSCOPE`: a list of what the scope exports, between slashes, may come first.
fn read_scoped(index: &mut Index, id: u64, at: usize) -> usize {
    let bytes = index.bytes;
    let mut start = skip_blank(bytes, at);
    if bytes.get(start) == Some(&b'/') {
        let is_export = |b: &u8| *b <= b' ' || b.is_ascii_digit() || matches!(b, b'#' | b',');
        let rest = &bytes[start + 1..];
        let length = rest.iter().position(|b| !is_export(b)).unwrap_or(rest.len());
        start = skip_blank(bytes, (start + 2 + length).min(bytes.len()));
    }
    read_body(index, id, start)
}

/// Reads `#5=<file.stp#name>;` of a reference section and returns where the next statement begins.
fn read_reference(index: &mut Index, at: usize) -> usize {
    let bytes = index.bytes;
    let (id, start) = instance_start(bytes, at).unwrap_or((0, at + 1));
    let end = statement_end(bytes, start);
    let name = skip_blank(bytes, start);
    if id != 0 && name < end.body && bytes[name] == b'<' {
        let length = bytes[name + 1..end.body].iter().position(|b| matches!(b, b'#' | b'>'));
        index.external.extend(length.map(|length| (id, name + 1..name + 1 + length)));
    }
    end.next.max(at + 1)
}

/// The position of the `ENDSEC`, `DATA` or instance that ends the header beginning at `at`.
fn section_end(bytes: &[u8], mut at: usize) -> usize {
    loop {
        at = skip_blank(bytes, at);
        let end = keyword_end(bytes, at.min(bytes.len()));
        let keyword = &bytes[at..end];
        let ends = keyword.eq_ignore_ascii_case(b"ENDSEC") || keyword.eq_ignore_ascii_case(b"DATA");
        if at >= bytes.len() || ends || bytes[at] == b'#' {
            return at;
        }
        at = statement_end(bytes, end).next.max(at + 1);
    }
}

struct StatementEnd {
    /// Where the body ends.
    body: usize,
    /// Where the next statement may begin.
    next: usize,
    /// What was wrong.
    fault: Option<&'static str>,
}

/// How far ahead is looked at once: a few statements. Whatever is missing, no byte is looked at more often than its window is entered.
const WINDOW: usize = 256;

/// The end of the statement that `at` lies in.
fn statement_end(bytes: &[u8], mut at: usize) -> StatementEnd {
    let start = at;
    while at < bytes.len() {
        let window = &bytes[at..bytes.len().min(at + WINDOW)];
        let mark = memchr3(b';', b'\'', b'/', window);
        let plain = &window[..mark.unwrap_or(window.len())];
        if let Some(length) = memchr(b'=', plain) {
            at += length;
            if let Some(name) = name_before(bytes, start, at) {
                return StatementEnd { body: name, next: name, fault: Some("`;` is missing") };
            }
            at += 1;
            continue;
        }
        at += plain.len();
        match bytes.get(at).filter(|_| mark.is_some()) {
            Some(b';') => return StatementEnd { body: at, next: at + 1, fault: None },
            Some(b'\'') => match string_end(bytes, at) {
                Ok(end) => at = end,
                Err(end) => {
                    return StatementEnd { body: end, next: end, fault: Some("a string is not closed") };
                }
            },
            Some(_) if bytes.get(at + 1) == Some(&b'*') => at = comment_end(bytes, at),
            Some(_) => at += 1,
            None => {}
        }
    }
    StatementEnd { body: bytes.len(), next: bytes.len(), fault: Some("the file ends inside a statement") }
}

/// The position after the string that begins at `at`; or, where it is not closed, where the next instance begins.
fn string_end(bytes: &[u8], at: usize) -> Result<usize, usize> {
    let mut from = at + 1;
    loop {
        let Some(length) = memchr(b'\'', &bytes[from..]) else {
            return Err(line_with_instance(bytes, at + 1, bytes.len()).unwrap_or(bytes.len()));
        };
        if let Some(line) = line_with_instance(bytes, from, from + length) {
            return Err(line);
        }
        from += length + 1;
        if bytes.get(from) != Some(&b'\'') {
            return Ok(from);
        }
        from += 1;
    }
}

/// The first line beginning in `from..to` that begins with `#digits=`. Nothing but blanks may stand before the `=`: to look over
/// line breaks and comments from each line would make the search quadratic.
fn line_with_instance(bytes: &[u8], from: usize, to: usize) -> Option<usize> {
    memchr::memchr2_iter(b'\n', b'\r', &bytes[from..to]).map(|length| from + length + 1).find(|&line| {
        instance_name(bytes, line).is_some_and(|(_, end)| {
            let blanks = bytes[end..].iter().position(|b| !matches!(b, b' ' | b'\t'));
            blanks.is_some_and(|length| bytes[end + length] == b'=')
        })
    })
}

/// Where the instance name begins that stands before the `=` at `equals`, not before `start`.
fn name_before(bytes: &[u8], start: usize, equals: usize) -> Option<usize> {
    let text = &bytes[start..equals];
    let digits_end = text.iter().rposition(|&b| b > b' ')? + 1;
    let hash = text[..digits_end].iter().rposition(|b| !b.is_ascii_digit())?;
    (text[hash] == b'#' && hash + 1 < digits_end).then_some(start + hash)
}

fn sort_by_id(index: &mut Index) {
    if !index.statements.is_sorted_by(|a, b| a.id < b.id) {
        let mut statements = std::mem::take(&mut index.statements);
        statements.sort_by_key(|s| s.id);
        statements.dedup_by(|later, kept| {
            let same = later.id == kept.id;
            if same {
                let reason = "an instance with this number came before; this one is ignored";
                index.fault(later.body.start, later.id, reason);
            }
            same
        });
        index.statements = statements;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(text: &str) -> Vec<(u64, &str)> {
        let index = index(text.as_bytes());
        index.statements.iter().map(|s| (s.id, text[s.body.clone()].trim())).collect()
    }

    fn data(body: &str) -> String {
        format!("ISO-10303-21;HEADER;FILE_SCHEMA(('X'));ENDSEC;DATA;{body}ENDSEC;END-ISO-10303-21;")
    }

    #[test]
    fn statements_end_at_semicolons_outside_of_strings_and_comments() {
        let text = data("#2=A('it''s; #9=B()', /* ; ' #8=C(); */ 1);#1 = B ( ) ;\n");
        assert_eq!(bodies(&text), [(1, "B ( )"), (2, "A('it''s; #9=B()', /* ; ' #8=C(); */ 1)")]);
    }

    #[test]
    fn lower_case_sections_marks_and_missing_ends() {
        let text = "\u{feff} /* note */ iso-10303-21;\nHeader;\nEndsec;\nData;\n#7=A();";
        assert!(is_exchange_structure(text.as_bytes()));
        assert_eq!(bodies(text), [(7, "A()")]);
    }

    #[test]
    fn a_missing_semicolon_costs_nothing() {
        assert_eq!(bodies(&data("\n#1=A(1)\n#2=B(2);\n")), [(1, "A(1)"), (2, "B(2)")]);
    }

    #[test]
    fn an_open_string_costs_its_statement_only() {
        assert_eq!(bodies(&data("\n#1=A('x);\n#2=B('y');\n")), [(1, "A('x);"), (2, "B('y')")]);
    }

    #[test]
    fn several_data_sections_and_skipped_sections() {
        let text = "ISO-10303-21;HEADER;ENDSEC;ANCHOR;<a>=#1;ENDSEC;REFERENCE;#5=<x#y>;ENDSEC;\
                    DATA('one',('S'));#1=A();ENDSEC;DATA;#2=B();ENDSEC;END-ISO-10303-21;#3=C();";
        assert_eq!(bodies(text), [(1, "A()"), (2, "B()")]);
    }

    #[test]
    fn huge_ids_and_garbage() {
        let text = data("#18446744073709551615=A();#99999999999999999999=B();garbage;#3=C();#3=D();");
        assert_eq!(bodies(&text), [(3, "C()"), (u64::MAX, "A()")]);
        assert_eq!(index(text.as_bytes()).faults.len(), 3);
    }

    #[test]
    fn scopes_are_flattened() {
        let text = data("#1=&SCOPE #2=A(); ENDSCOPE /#2/ B(#2);#3=C();");
        assert_eq!(bodies(&text), [(1, "B(#2)"), (2, "A()"), (3, "C()")]);
        let text = data("#1=&SCOPE\n#2=&SCOPE #3=A();ENDSCOPE B(#3);#4=D();ENDSCOPE/#2, #4/C(#2);#5=E();");
        assert_eq!(bodies(&text), [(1, "C(#2)"), (2, "B(#3)"), (3, "A()"), (4, "D()"), (5, "E()")]);
        let open = data("#1=&SCOPE #2=A();");
        assert_eq!((bodies(&open), index(open.as_bytes()).faults.len()), (vec![(2, "A()")], 1));
    }

    #[test]
    fn references_to_other_files_are_kept() {
        let text = "ISO-10303-21;HEADER;ENDSEC;REFERENCE;#5=<../a b.stp#x>; #6 = <#local>;#7=;ENDSEC;\
                    DATA;#1=A(#5);ENDSEC;END-ISO-10303-21;";
        let index = index(text.as_bytes());
        let names: Vec<_> = index.external.iter().map(|(id, name)| (*id, &text[name.clone()])).collect();
        assert_eq!((names, bodies(text)), (vec![(5, "../a b.stp"), (6, "")], vec![(1, "A(#5)")]));
        assert_eq!(index.faults, []);
    }

    /// Texts on which a search that looks ahead from each line, or from each quote, would take hours.
    #[test]
    fn hostile_texts_are_scanned_in_linear_time() {
        for (start, repeated, end) in [
            ("#1=A('", "\n#1/*", "');"),
            ("#1=A('", "\n#1/*", "*/');"),
            ("", "\n#1=A('", ""),
            ("", "\n#1=A('''", "';"),
            ("#1=A(", "=", ");"),
            ("#1=A(", "1 =", ");"),
            ("", "#1=&SCOPE ", "ENDSCOPE A();"),
            ("", "ENDSCOPE /#1,", ";"),
            ("", "#1\n", ""),
            ("", "x;", ""),
        ] {
            let text = data(&format!("{start}{}{end}", repeated.repeat(1_000_000)));
            let index = index(text.as_bytes());
            assert!(index.faults.len() <= MOST_FAULTS, "{start}{repeated}");
            assert!(index.statements.iter().all(|s| s.body.end <= text.len()));
        }
    }

    #[test]
    fn lines_may_end_with_returns_alone() {
        assert_eq!(bodies(&data("\r#1=A('x);\r#2=B('y');\r")), [(1, "A('x);"), (2, "B('y')")]);
        let index = index(b"a\rb\r\nc");
        assert_eq!([0, 2, 5].map(|at| index.line(at)), [1, 2, 3]);
    }

    #[test]
    fn lines_count_from_one() {
        let index = index(b"a\nb\nc");
        assert_eq!([0, 1, 2, 4].map(|at| index.line(at)), [1, 1, 2, 3]);
    }
}
