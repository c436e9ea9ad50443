//! The records of an IGES file, sorted into their sections (IGES 5.3, clause 2.2).
//!
//! A record has 80 columns: data in 1–72, the section's letter in 73, a sequence number in 74–80. Files come with and
//! without line ends, with records cut short or followed by garbage, with letters in lower case, with characters of
//! several bytes, and with sequence numbers that are wrong, so the letter alone decides and the position in the section
//! counts. The compressed form is unfolded by `compressed`.

use std::borrow::Cow;

/// Columns of data in a record.
const DATA: usize = 72;
/// Columns of a record.
const RECORD: usize = 80;
/// How many columns a record may have lost or gained before its letter.
const MOST_SHIFTED: usize = 4;

/// The records of each section, each without its letter and number, in file order.
#[derive(Debug, Default)]
pub struct Cards<'a> {
    /// Records of the start section.
    pub start: Vec<&'a [u8]>,
    /// Records of the global section.
    pub global: Vec<&'a [u8]>,
    /// Records of the directory section: two to an entity.
    pub directory: Vec<&'a [u8]>,
    /// Records of the parameter section.
    pub parameters: Vec<&'a [u8]>,
    /// The records of a file in compressed form, from the first one after the global section.
    pub compressed: Option<Vec<&'a [u8]>>,
    /// Records that belong to no section.
    pub strange: usize,
    /// Whether a terminate record ends the file.
    pub terminated: bool,
    /// Whether the file says that it is in binary form.
    pub binary: bool,
}

/// How many bytes tell what a file is.
pub const HEAD: usize = 40 * (RECORD + 2);

/// Whether the beginning of `bytes` looks like an IGES file: a record of the start or global section, or of a flag section.
pub fn looks_like_iges(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let lines = records(head).take(40);
    let letters: Vec<u8> = lines.filter_map(|line| split(line).map(|(_, letter)| letter)).take(3).collect();
    letters.first().is_some_and(|letter| matches!(letter, b'S' | b'G' | b'C' | b'B'))
}

/// The bytes of a file without the mark of UTF-8 before them, and with its tabs replaced by blanks up to the next column
/// that is a multiple of 8: fields of the directory are that wide.
pub fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    const TAB_STOP: usize = 8;
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if !bytes.contains(&b'\t') {
        return Cow::Borrowed(bytes);
    }
    let mut plain = Vec::with_capacity(bytes.len());
    let mut column = 0;
    for &byte in bytes {
        match byte {
            b'\t' => {
                let width = TAB_STOP - column % TAB_STOP;
                plain.resize(plain.len() + width, b' ');
                column += width;
            }
            b'\n' | b'\r' => {
                plain.push(byte);
                column = 0;
            }
            _ => {
                plain.push(byte);
                column += 1;
            }
        }
    }
    Cow::Owned(plain)
}

/// Sorts the records of a file.
pub fn read(bytes: &[u8]) -> Cards<'_> {
    let mut cards = Cards::default();
    for line in records(bytes) {
        if cards.terminated {
            break;
        }
        let Some((data, letter)) = split(line) else {
            match &mut cards.compressed {
                Some(lines) => lines.push(&line[..line.len().min(DATA)]),
                None => cards.strange += usize::from(line.iter().any(|b| b.is_ascii_graphic())),
            }
            continue;
        };
        match letter {
            b'S' => cards.start.push(data),
            b'G' => cards.global.push(data),
            b'D' => cards.directory.push(data),
            b'P' => cards.parameters.push(data),
            b'T' => cards.terminated = true,
            b'C' => cards.compressed = Some(Vec::new()),
            _ => cards.binary = true,
        }
    }
    cards
}

/// The lines of a file; pieces of 80 columns where it has no line ends.
fn records(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let head = &bytes[..bytes.len().min(3 * RECORD)];
    let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let has_lines = bytes.len() < RECORD || head.iter().any(is_end);
    let (lines, pieces) = if has_lines { (bytes, &bytes[..0]) } else { (&bytes[..0], bytes) };
    lines.split(is_end).filter(|line| !line.is_empty()).chain(pieces.chunks(RECORD))
}

/// A record's data columns and the letter of its section, in upper case; `None` where it has none.
fn split(line: &[u8]) -> Option<(&[u8], u8)> {
    let section = |letter: u8| {
        let upper = letter.to_ascii_uppercase();
        matches!(upper, b'S' | b'G' | b'D' | b'P' | b'T' | b'C' | b'B').then_some(upper)
    };
    let is_number = |text: &[u8]| text.iter().all(|b| b.is_ascii_digit() || *b == b' ');
    if let Some(letter) = line.get(DATA).and_then(|letter| section(*letter))
        && is_number(&line[DATA + 1..line.len().min(RECORD)])
    {
        return Some((&line[..DATA], letter));
    }
    // A record that lost or gained some columns still ends with its letter and number.
    let text = line.trim_ascii_end();
    let digits = text.iter().rev().take_while(|b| b.is_ascii_digit()).count();
    let before = text[..text.len() - digits].trim_ascii_end();
    let letter = section(*before.last()?)?;
    let at = before.len() - 1;
    // Texts may hold characters of several bytes, of which the writer counted some way or other.
    let continued = before.iter().filter(|b| (0x80..0xC0).contains(*b)).count();
    let in_place = (DATA.saturating_sub(MOST_SHIFTED)..=DATA + MOST_SHIFTED + continued).contains(&at);
    let shifted = in_place && (1..=7).contains(&digits) && text.len() - at <= RECORD - DATA + 1;
    let data = if continued > 0 { &line[..at] } else { &line[..at.min(DATA)] };
    shifted.then_some((data, letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(data: &str, letter: char, number: usize) -> String {
        format!("{data:<72}{letter}{number:>7}")
    }

    #[test]
    fn sections_are_sorted_by_their_letter() {
        let lines =
            [record("hello", 'S', 1), record("1H,,1H;;", 'G', 9), record("a", 'D', 1), record("b", 'P', 1)];
        for end in ["\n", "\r\n", "\r", ""] {
            let text = lines.join(end) + end + &record("", 'T', 1) + "garbage";
            let cards = read(text.as_bytes());
            assert!(looks_like_iges(text.as_bytes()));
            let counts = [&cards.start, &cards.global, &cards.directory, &cards.parameters].map(Vec::len);
            assert_eq!(counts, [1; 4], "line end {end:?}");
            assert!(cards.terminated);
        }
    }

    #[test]
    fn shifted_and_strange_records() {
        let text = record("x", 'S', 1) + "\n" + &record("y", 'P', 1)[1..] + "\nnothing here\n";
        let cards = read(text.as_bytes());
        assert_eq!((cards.start.len(), cards.parameters.len(), cards.strange), (1, 1, 1));
        let lower = read(b"x").strange + read(record("x", 's', 1).as_bytes()).start.len();
        assert_eq!(lower, 2);
        let wide = format!("{}{}G      1", "12H", "\u{4e2d}".repeat(8));
        let wide = read(format!("{:<72}G      1\n{wide}", "").as_bytes()).global.len();
        assert_eq!(wide, 1, "far from column 73");
        let wide = format!("{:<72}G      1\n\u{1a}\n\0\0", "8H\u{4e2d}\u{6587}\u{4e2d}\u{6587}");
        let cards = read(wide.as_bytes());
        assert_eq!((cards.global.len(), cards.strange), (1, 0));
        assert!(!looks_like_iges(b"ISO-10303-21;\nHEADER;\n"));
        assert!(!looks_like_iges(b""));
    }

    #[test]
    fn tabs_and_marks() {
        assert_eq!(&*plain(b"\xEF\xBB\xBFab"), b"ab");
        assert_eq!(&*plain(b"a\tb\n\tc\r12345678\td"), b"a       b\n        c\r12345678        d");
    }

    #[test]
    fn flag_records() {
        assert!(read(record("", 'B', 1).as_bytes()).binary);
        assert!(
            read((record("", 'C', 1) + "\nD1@1_110;\n").as_bytes()).compressed.is_some_and(|c| c.len() == 1)
        );
    }
}
