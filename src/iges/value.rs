//! Parameters in free format (IGES 5.3, clause 2.2.3): numbers, Hollerith strings, and nothing at all, between delimiters.

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Left out: the default counts.
    Empty,
    /// An integer, a real number, a pointer or a logical.
    Number(f64),
    /// A Hollerith string.
    Text(String),
    /// Something else.
    Bad,
}

/// The two characters that separate parameters and end records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delimiters {
    /// Between parameters; a comma unless the global section says otherwise.
    pub parameter: u8,
    /// At the end; a semicolon unless the global section says otherwise.
    pub record: u8,
}

impl Delimiters {
    /// Whether `byte` is one of the two.
    pub fn contains(self, byte: u8) -> bool {
        byte == self.parameter || byte == self.record
    }
}

impl Default for Delimiters {
    fn default() -> Self {
        Self { parameter: b',', record: b';' }
    }
}

/// No entity has more parameters: 200 MB of them. A surface of a million control points has four million.
pub const MOST_VALUES: usize = 1 << 23;

/// The values of a record, up to one more than [`MOST_VALUES`]; the flag tells whether the record's end was found.
pub fn values(text: &[u8], delimiters: Delimiters) -> (Vec<Value>, bool) {
    let mut values = Vec::new();
    let mut at = 0;
    loop {
        let (value, after) = value(text, at, delimiters);
        values.push(value);
        match text.get(after) {
            Some(&byte) if byte == delimiters.parameter && values.len() <= MOST_VALUES => at = after + 1,
            Some(_) => return (values, true),
            None => return (values, false),
        }
    }
}

/// The value that starts at `at`, and where the delimiter after it stands (the text's length where none does).
fn value(text: &[u8], at: usize, delimiters: Delimiters) -> (Value, usize) {
    if let Some((start, length)) = hollerith(text, at) {
        let end = string_end(text, start, length, delimiters);
        let string = String::from_utf8_lossy(&text[start.min(end)..end]).into_owned();
        return (Value::Text(string), find_delimiter(text, end, delimiters));
    }
    let end = find_delimiter(text, at, delimiters);
    let field = text[at..end].trim_ascii();
    let value = match number(field) {
        Some(number) => Value::Number(number),
        None if field.is_empty() => Value::Empty,
        None => Value::Bad,
    };
    (value, end)
}

/// Where a string ends that should have `length` bytes: there, unless no delimiter follows and one within it stands before what
/// must be the next parameter. Counts are too large where a file's characters were once wider.
fn string_end(text: &[u8], start: usize, length: usize, delimiters: Delimiters) -> usize {
    let end = start.saturating_add(length).min(text.len());
    let after = text[end..].iter().find(|byte| !byte.is_ascii_whitespace());
    if after.is_some_and(|byte| delimiters.contains(*byte)) {
        return end;
    }
    let inner = find_delimiter(text, start.min(end), delimiters);
    if inner >= end {
        return end;
    }
    let next = &text[inner + 1..find_delimiter(text, inner + 1, delimiters)];
    let is_parameter =
        next.trim_ascii().is_empty() || number(next.trim_ascii()).is_some() || hollerith(next, 0).is_some();
    if is_parameter { inner } else { end }
}

fn find_delimiter(text: &[u8], at: usize, delimiters: Delimiters) -> usize {
    text[at..].iter().position(|byte| delimiters.contains(*byte)).map_or(text.len(), |offset| at + offset)
}

/// Where the characters of a string `nH…` at `at` start, and how many there are.
fn hollerith(text: &[u8], at: usize) -> Option<(usize, usize)> {
    let blanks = text[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
    let digits = text[at + blanks..].iter().take(9).take_while(|b| b.is_ascii_digit()).count();
    let mark = at + blanks + digits;
    if digits == 0 || !matches!(text.get(mark), Some(b'H' | b'h')) {
        return None;
    }
    let count = std::str::from_utf8(&text[at + blanks..mark]).ok()?.parse().ok()?;
    Some((mark + 1, count))
}

/// A finite number: integer, or real with an exponent by E or D. Blanks within it count for nothing, as in FORTRAN.
pub fn number(field: &[u8]) -> Option<f64> {
    let first = *field.first()?;
    if !(first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.')) {
        return None;
    }
    let mut buffer = [0; 64];
    let mut length = 0;
    for from in field.iter().filter(|byte| **byte != b' ') {
        *buffer.get_mut(length)? = if matches!(from, b'd' | b'D') { b'e' } else { *from };
        length += 1;
    }
    let text = std::str::from_utf8(&buffer[..length]).ok()?;
    let parsed = text.parse::<f64>().ok().or_else(|| {
        // FORTRAN leaves the letter out before exponents of three digits: 1.5-120.
        let sign = text.rfind(['+', '-']).filter(|at| *at > 0)?;
        format!("{}e{}", &text[..sign], &text[sign..]).parse().ok()
    });
    parsed.filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Vec<Value>, bool) {
        values(text.as_bytes(), Delimiters::default())
    }

    #[test]
    fn numbers_strings_and_defaults() {
        use Value::{Bad, Empty, Number, Text};
        let (values, ended) = read("110, 1.5D2,,-.5E-1 ,4Ha,;b, +7., 1.5-2,oops;rest");
        assert!(ended);
        let expected = [
            Number(110.0),
            Number(150.0),
            Empty,
            Number(-0.05),
            Text("a,;b".into()),
            Number(7.0),
            Number(0.015),
            Bad,
        ];
        assert_eq!(values, expected);
    }

    #[test]
    fn numbers_as_fortran_writes_them() {
        for (text, expected) in [
            ("1.D0", 1.0),
            ("1.0E+00", 1.0),
            ("1.", 1.0),
            (".5", 0.5),
            ("-.5D-3", -5e-4),
            ("+3", 3.0),
            ("1.5-120", 1.5e-120),
            ("- 2.5 d 1", -25.0),
            ("1.0e01", 10.0),
        ] {
            assert_eq!(number(text.as_bytes()), Some(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_number() {
        for text in ["", "inf", "nan", "1e999", "0x10", "--1", "1.2.3", "e5"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
        assert_eq!(number(&[b'1'; 100]), None);
    }

    #[test]
    fn strings_that_lie_about_their_length() {
        assert_eq!(read("99Habc"), (vec![Value::Text("abc".into())], false));
        assert_eq!(read("0H;"), (vec![Value::Text(String::new())], true));
        assert_eq!(read("999999999H").0, vec![Value::Text(String::new())]);
        use Value::{Number, Text};
        // Too long by two, too short by two, and right with delimiters inside.
        assert_eq!(read("4Habc,27,3;").0, [Text("abc".into()), Number(27.0), Number(3.0)]);
        assert_eq!(read("5Habc,3HMMM,3;").0, [Text("abc".into()), Text("MMM".into()), Number(3.0)]);
        assert_eq!(read("1Habc,2;").0, [Text("a".into()), Number(2.0)]);
        assert_eq!(read("7Ha, b; 1,2;").0, [Text("a, b; 1".into()), Number(2.0)]);
        assert_eq!(read("11HSmith, John,2;").0, [Text("Smith, John".into()), Number(2.0)]);
    }

    #[test]
    fn other_delimiters() {
        let delimiters = Delimiters { parameter: b'/', record: b'#' };
        let (values, ended) = values(b"1/2,/3#4", delimiters);
        assert_eq!(values, [Value::Number(1.0), Value::Bad, Value::Number(3.0)]);
        assert!(ended);
    }
}
