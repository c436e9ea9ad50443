//! From the bytes of one statement to its records (ISO 10303-21, clauses 6 and 10).
//!
//! More is accepted than the standard allows, as files have it: lower-case keywords, `1E-3`, `.5`, `+1`, empty lists, missing
//! parameters (`,,` reads as `$`). Nesting is bounded; everything else is linear in the statement's length.

use super::scan::{instance_name, keyword_end, skip_blank};
use super::value::{Entity, Record, Value};
use memchr::memchr;
use std::borrow::Cow;

/// Why a statement cannot be decoded, and where (a byte offset in the file).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Byte offset.
    pub at: usize,
    /// What was expected.
    pub reason: &'static str,
}

/// Lists may be nested this deep; no schema needs more than 3.
const MAX_DEPTH: usize = 32;

/// A statement may not have more values than this, each list counted as [`LIST_VALUES`] more for its own memory: 200 MB.
/// A surface of a million control points has two million, its weights included.
const MAX_VALUES: usize = 1 << 22;
const LIST_VALUES: usize = 4;

/// Keywords are looked for in this many bytes.
const MAX_KEYWORD: usize = 256;

/// Statements that are plainly a point or a direction are shorter than this.
const MAX_TRIPLE: usize = 1024;

/// `word` in upper case.
pub fn upper_case(word: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(word) {
        Ok(word) if !word.bytes().any(|b| b.is_ascii_lowercase()) => Cow::Borrowed(word),
        _ => Cow::Owned(String::from_utf8_lossy(word).to_ascii_uppercase()),
    }
}

/// The keyword that a statement's body begins with, as written; empty for complex instances.
pub fn leading_keyword(body: &[u8]) -> &[u8] {
    let start = skip_blank(body, 0);
    let word = &body[start..body.len().min(start + MAX_KEYWORD)];
    &word[..keyword_end(word, 0)]
}

/// Decodes the body of statement `id`, which is `bytes[body]`.
pub fn decode(bytes: &[u8], id: u64, body: std::ops::Range<usize>) -> Result<Entity<'_>, SyntaxError> {
    let mut cursor = Cursor { bytes: &bytes[..body.end], at: body.start, left: MAX_VALUES };
    cursor.skip_blank();
    let mut records = Vec::with_capacity(1);
    if cursor.take(b'(') {
        loop {
            cursor.skip_blank();
            if cursor.take(b')') {
                break;
            }
            records.push(cursor.record()?);
        }
    } else {
        records.push(cursor.record()?);
    }
    if records.is_empty() { Err(cursor.expected("a record")) } else { Ok(Entity { id, records }) }
}

/// The numbers of `keyword('..',(x,y,z))`, up to three and the missing ones 0: what most statements of a file are, read
/// without a record. `None` where it is anything else, right or wrong; [`decode`] tells.
pub fn triple(bytes: &[u8], body: std::ops::Range<usize>, keyword: &[u8]) -> Option<[f64; 3]> {
    if body.len() > MAX_TRIPLE {
        return None;
    }
    let mut cursor = Cursor { bytes: &bytes[..body.end], at: body.start, left: 0 };
    cursor.skip_blank();
    if !cursor.bytes[cursor.at..].starts_with(keyword) {
        return None;
    }
    cursor.at += keyword.len();
    let expect = |cursor: &mut Cursor, byte: u8| {
        cursor.skip_blank();
        cursor.take(byte).then_some(())
    };
    expect(&mut cursor, b'(')?;
    cursor.skip_blank();
    if cursor.peek() != Some(b'\'') || cursor.string().is_err() {
        return None;
    }
    expect(&mut cursor, b',')?;
    expect(&mut cursor, b'(')?;
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        cursor.skip_blank();
        *number = cursor.number().ok()?.real()?;
        cursor.skip_blank();
        if cursor.take(b')') {
            return expect(&mut cursor, b')').map(|()| numbers);
        }
        expect(&mut cursor, b',')?;
    }
    None
}

/// Decodes the records of a header section.
pub fn decode_header(bytes: &[u8], header: std::ops::Range<usize>) -> Vec<Record<'_>> {
    let mut cursor = Cursor { bytes: &bytes[..header.end], at: header.start, left: MAX_VALUES };
    let mut records = Vec::new();
    loop {
        cursor.skip_blank();
        if cursor.at >= cursor.bytes.len() || cursor.left == 0 {
            return records;
        }
        match cursor.record() {
            Ok(record) => records.push(record),
            Err(_) => {
                let rest = &cursor.bytes[cursor.at..];
                cursor.at += memchr(b';', rest).unwrap_or(rest.len());
            }
        }
        cursor.skip_blank();
        if !cursor.take(b';') {
            cursor.at += 1;
        }
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// How many more values there may be.
    left: usize,
}

impl<'a> Cursor<'a> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn skip_blank(&mut self) {
        self.at = skip_blank(self.bytes, self.at);
    }

    fn expected(&self, reason: &'static str) -> SyntaxError {
        SyntaxError { at: self.at, reason }
    }

    fn record(&mut self) -> Result<Record<'a>, SyntaxError> {
        let keyword = self.keyword()?;
        Ok(Record { keyword, parameters: self.parameters(0)? })
    }

    fn keyword(&mut self) -> Result<Cow<'a, str>, SyntaxError> {
        let end = keyword_end(self.bytes, self.at.min(self.bytes.len()));
        let word = &self.bytes[self.at.min(end)..end];
        if !word.first().is_some_and(|b| b.is_ascii_alphabetic() || matches!(b, b'!' | b'_')) {
            return Err(self.expected("expected a keyword"));
        }
        self.at = end;
        self.skip_blank();
        Ok(upper_case(word))
    }

    /// `( value, .. )`.
    fn parameters(&mut self, depth: usize) -> Result<Vec<Value<'a>>, SyntaxError> {
        if depth > MAX_DEPTH {
            return Err(self.expected("lists are nested too deep"));
        }
        if !self.take(b'(') {
            return Err(self.expected("expected `(`"));
        }
        let mut values = Vec::new();
        self.skip_blank();
        if self.take(b')') {
            self.charge(1)?;
            return Ok(values);
        }
        self.charge(LIST_VALUES)?;
        loop {
            self.skip_blank();
            self.charge(1)?;
            values.push(if matches!(self.peek(), Some(b',' | b')')) {
                Value::Unset
            } else {
                self.value(depth)?
            });
            self.skip_blank();
            if self.take(b')') {
                return Ok(values);
            }
            if !self.take(b',') {
                return Err(self.expected("expected `,` or `)`"));
            }
        }
    }

    fn charge(&mut self, count: usize) -> Result<(), SyntaxError> {
        let left = self.left.checked_sub(count);
        self.left = left.unwrap_or(0);
        left.map(|_| ()).ok_or_else(|| self.expected("the statement has too many values"))
    }

    fn value(&mut self, depth: usize) -> Result<Value<'a>, SyntaxError> {
        let start = self.at;
        match self.peek().ok_or_else(|| self.expected("the statement ends early"))? {
            b'#' => {
                let (id, end) = instance_name(self.bytes, start)
                    .ok_or_else(|| self.expected("expected an instance number below 2^64"))?;
                self.at = end;
                Ok(Value::Reference(id))
            }
            b'\'' => self.string(),
            b'"' => {
                let length = memchr(b'"', &self.bytes[start + 1..])
                    .ok_or_else(|| self.expected("a binary is not closed"))?;
                self.at = start + length + 2;
                Ok(Value::Binary(&self.bytes[start + 1..start + 1 + length]))
            }
            b'$' => {
                self.at += 1;
                Ok(Value::Unset)
            }
            b'*' => {
                self.at += 1;
                Ok(Value::Derived)
            }
            b'(' => Ok(Value::List(self.parameters(depth + 1)?)),
            b'.' if !self.bytes.get(start + 1).is_some_and(u8::is_ascii_digit) => {
                let end = keyword_end(self.bytes, start + 1);
                if self.bytes.get(end) != Some(&b'.') {
                    return Err(self.expected("an enumeration is not closed"));
                }
                self.at = end + 1;
                Ok(Value::Enumeration(&self.bytes[start + 1..end]))
            }
            b'0'..=b'9' | b'+' | b'-' | b'.' => self.number(),
            b if b.is_ascii_alphabetic() || b == b'!' || b == b'_' => {
                let keyword = self.keyword()?;
                Ok(Value::Typed(keyword, self.parameters(depth + 1)?))
            }
            _ => Err(self.expected("expected a value")),
        }
    }

    fn string(&mut self) -> Result<Value<'a>, SyntaxError> {
        let start = self.at + 1;
        let mut from = start;
        loop {
            let length = memchr(b'\'', self.bytes.get(from..).unwrap_or_default())
                .ok_or_else(|| self.expected("a string is not closed"))?;
            let end = from + length;
            if self.bytes.get(end + 1) != Some(&b'\'') {
                self.at = end + 1;
                return Ok(Value::Text(&self.bytes[start..end]));
            }
            from = end + 2;
        }
    }

    fn number(&mut self) -> Result<Value<'a>, SyntaxError> {
        let is_part = |b: &u8| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'E' | b'e' | b'D' | b'd');
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|b| !is_part(b)).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..length]).expect("digits, signs and letters are ASCII");
        let value = if word.bytes().all(|b| b.is_ascii_digit() || b == b'-' || b == b'+') {
            word.parse().map(Value::Integer).or_else(|_| word.parse().map(Value::Real)).ok()
        } else if word.contains(['D', 'd']) {
            // Fortran's exponent, in files of old systems.
            word.replace(['D', 'd'], "E").parse().ok().map(Value::Real)
        } else {
            word.parse().ok().map(Value::Real)
        };
        let value = value.ok_or_else(|| self.expected("expected a number"))?;
        self.at += length;
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entity(body: &str) -> Entity<'_> {
        decode(body.as_bytes(), 1, 0..body.len()).unwrap_or_else(|e| panic!("{body}: {e:?}"))
    }

    #[test]
    fn every_kind_of_value() {
        use Value::*;
        let e =
            entity("Foo( #12 ,-3,1.5,1E-3,.5,+2.,1.0D+2,'a''b',.True.,\"0A\",$,*,(),((1),(2)),BAR(7),'')");
        assert_eq!(e.first().keyword, "FOO");
        let expected = vec![
            Reference(12),
            Integer(-3),
            Real(1.5),
            Real(1e-3),
            Real(0.5),
            Real(2.0),
            Real(100.0),
            Text(b"a''b"),
            Enumeration(b"True"),
            Binary(b"0A"),
            Unset,
            Derived,
            List(vec![]),
            List(vec![List(vec![Integer(1)]), List(vec![Integer(2)])]),
            Typed("BAR".into(), vec![Integer(7)]),
            Text(b""),
        ];
        assert_eq!(e.first().parameters, expected);
        assert_eq!(e.first().logical(8), Some(true));
        assert_eq!(e.first().text(7), "a'b");
        assert_eq!(e.first().real(14), Some(7.0));
        assert_eq!(e.first().get(99), &Unset);
    }

    #[test]
    fn complex_instances_and_comments() {
        let e = entity("( LENGTH_UNIT() /* ( */ NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )");
        assert_eq!(e.kind(), "LENGTH_UNIT+NAMED_UNIT+SI_UNIT");
        assert_eq!(e.record("SI_UNIT").and_then(|r| r.get(1).enumeration()).as_deref(), Some("METRE"));
    }

    #[test]
    fn huge_integers_become_reals_and_missing_parameters_are_unset() {
        assert_eq!(entity("A(99999999999999999999,,)").first().parameters.len(), 3);
        assert_eq!(entity("A(99999999999999999999)").first().real(0), Some(1e20));
    }

    #[test]
    fn broken_bodies_are_errors() {
        let deep = format!("A({}{})", "(".repeat(100_000), ")".repeat(100_000));
        for body in [
            "", "(", "()", "A", "A(", "A(1", "A(#)", "A('x)", "A(.T)", "A(\"0)", "A(1 2)", "A(--)", "#1",
            &deep,
        ] {
            assert!(decode(body.as_bytes(), 1, 0..body.len()).is_err(), "{body:.20}");
        }
    }

    #[test]
    fn triples_are_read_without_a_record() {
        let read = |text: &str| triple(text.as_bytes(), 0..text.len(), b"CARTESIAN_POINT");
        assert_eq!(read("CARTESIAN_POINT ( 'a''b' , ( 1. ,-2E1 /* x */, 3 ) ) "), Some([1.0, -20.0, 3.0]));
        assert_eq!(read("CARTESIAN_POINT('',(1.,2.))"), Some([1.0, 2.0, 0.0]));
        for other in [
            "CARTESIAN_POINT('',())",
            "CARTESIAN_POINT('',(1.,2.,3.,4.))",
            "CARTESIAN_POINT('',(1.,$))",
            "CARTESIAN_POINT_X('',(1.))",
            "CARTESIAN_POINT($,(1.))",
            "CARTESIAN_POINT('',(1.),2)",
            "CARTESIAN_POINT('",
            "(CARTESIAN_POINT((1.)))",
            "",
        ] {
            assert_eq!(read(other), None, "{other}");
        }
    }

    #[test]
    fn header_records() {
        let text = b"FILE_NAME('a','b');garbage;FILE_SCHEMA(('X'));";
        let names: Vec<_> = decode_header(text, 0..text.len()).into_iter().map(|r| r.keyword).collect();
        assert_eq!(names, ["FILE_NAME", "FILE_SCHEMA"]);
    }
}
