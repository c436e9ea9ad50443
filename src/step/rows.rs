//! Long lists of numbers, read without a value for each: a tessellation is little else, and decoding it as
//! [`super::value::Value`]s would take ten times the memory of its text.
//!
//! A statement is cut into its parameters as they are written ([`records`]); a parameter that is a list of numbers, or a
//! list of such lists, is walked row by row ([`for_each_row`]).

use super::decode::upper_case;
use super::scan::{keyword_end, skip_blank};
use memchr::memchr;
use std::borrow::Cow;

/// A statement may not have more records, nor a record more parameters, than this: those of no schema come near.
const MOST_RECORDS: usize = 1 << 10;
const MOST_PARAMETERS: usize = 1 << 16;

/// A record whose parameters are still text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawRecord<'a> {
    /// In upper case.
    pub keyword: Cow<'a, str>,
    /// The text of each parameter.
    pub parameters: Vec<&'a [u8]>,
}

/// The records of a statement's body: one, or the partial ones of a complex instance. What is broken ends the list.
pub fn records(body: &[u8]) -> Vec<RawRecord<'_>> {
    let mut records = Vec::new();
    let mut at = skip_blank(body, 0);
    if body.get(at) == Some(&b'(') {
        at += 1;
    }
    loop {
        at = skip_blank(body, at);
        let end = keyword_end(body, at.min(body.len()));
        let open = skip_blank(body, end);
        if end == at || body.get(open) != Some(&b'(') || records.len() == MOST_RECORDS {
            return records;
        }
        let (parameters, next) = parameters(body, open + 1);
        records.push(RawRecord { keyword: upper_case(&body[at..end]), parameters });
        at = next;
    }
}

/// The parameters from `at`, which follows their `(`, and the position after their `)`.
fn parameters(body: &[u8], at: usize) -> (Vec<&[u8]>, usize) {
    let (mut from, mut at, mut depth) = (at, at, 0_usize);
    let mut parameters = Vec::new();
    while at < body.len() {
        match body[at] {
            b'\'' => at = memchr(b'\'', &body[at + 1..]).map_or(body.len(), |length| at + length + 2),
            b'/' if body.get(at + 1) == Some(&b'*') => at = skip_blank(body, at),
            byte => {
                match byte {
                    b'(' => depth += 1,
                    b')' if depth == 0 => {
                        parameters.push(&body[from..at]);
                        return (parameters, at + 1);
                    }
                    b')' => depth -= 1,
                    b',' if depth == 0 && parameters.len() < MOST_PARAMETERS => {
                        parameters.push(&body[from..at]);
                        from = at + 1;
                    }
                    _ => {}
                }
                at += 1;
            }
        }
    }
    parameters.push(&body[from..]);
    (parameters, body.len())
}

/// Calls `row` with the numbers of each innermost list of `text`; what is no number reads as NaN. Lists that hold lists are no
/// rows. Text without any list, such as `$`, has none.
pub fn for_each_row(text: &[u8], mut row: impl FnMut(&[f64])) {
    let mut numbers = Vec::new();
    // Whether the list that is open has held nothing but numbers so far.
    let mut is_innermost = false;
    let mut at = 0;
    loop {
        at = skip_blank(text, at);
        match text.get(at) {
            None => return,
            Some(b'(') => {
                numbers.clear();
                is_innermost = true;
                at += 1;
            }
            Some(b')') => {
                if is_innermost {
                    row(&numbers);
                }
                is_innermost = false;
                at += 1;
            }
            Some(b',') => at += 1,
            Some(_) => {
                let ends = |b: &u8| *b <= b' ' || matches!(b, b'(' | b')' | b',' | b'/');
                let rest = &text[at..];
                // A `/` that opens no comment is a word of its own, so that each turn goes on.
                let length = rest.iter().position(ends).unwrap_or(rest.len()).max(1);
                let word = std::str::from_utf8(&rest[..length]).unwrap_or_default();
                let number = word.parse().ok().filter(|number: &f64| number.is_finite());
                numbers.push(number.unwrap_or(f64::NAN));
                at += length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str) -> Vec<Vec<f64>> {
        let mut rows = Vec::new();
        for_each_row(text.as_bytes(), |row| rows.push(row.to_vec()));
        rows
    }

    #[test]
    fn rows_of_nested_and_flat_lists() {
        assert_eq!(
            rows(" ( (1.,-2E1 , .5) ,( 3 /* ) */) )"),
            [vec![1.0, -20.0, 0.5], vec![3.0]] as [Vec<f64>; 2]
        );
        assert_eq!(rows("(1,2)"), [[1.0, 2.0]]);
        assert_eq!(rows("()"), [[0.0; 0]]);
        assert_eq!(rows("$"), [[0.0; 0]; 0]);
        assert!(rows("((1,$,1e999,#4))")[0][1..].iter().all(|x| x.is_nan()));
        assert_eq!(rows("((1/2,(3"), [[0.0; 0]; 0]);
    }

    #[test]
    fn records_are_cut_at_their_commas() {
        let cut = |text: &str| {
            let text_of = |bytes: &&[u8]| String::from_utf8_lossy(bytes).into_owned();
            let joined = |r: RawRecord| {
                format!("{}: {}", r.keyword, r.parameters.iter().map(text_of).collect::<Vec<_>>().join(" | "))
            };
            records(text.as_bytes()).into_iter().map(joined).collect::<Vec<_>>()
        };
        assert_eq!(cut("a ('it''s, (',(1,(2,3)),/* , */$)"), ["A: 'it''s, (' | (1,(2,3)) | /* , */$"]);
        assert_eq!(cut("(A()B(1,2))"), ["A: ", "B: 1 | 2"]);
        assert_eq!(cut("A(1,(2"), ["A: 1 | (2"]);
        assert_eq!(cut("#1"), [""; 0]);
    }
}
