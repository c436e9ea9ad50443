//! The records of an IGES file, sorted into their sections (IGES 5.3, clause 2.2).
//!
//! A record has 80 columns: data in 1–72, the section's letter in 73, a sequence number in 74–80. Files come with and
//! without line ends, with records cut short or followed by garbage, and with sequence numbers that are wrong, so the
//! letter alone decides and the position in the section counts. The compressed form is unfolded by `compressed`.

/// Columns of data in a record.
const DATA: usize = 72;
/// Columns of a record.
const RECORD: usize = 80;

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

/// Whether the beginning of `bytes` looks like an IGES file: a record of the start or global section, or of a flag section.
pub fn looks_like_iges(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(40 * (RECORD + 2))];
    let lines = records(head).take(40);
    let letters: Vec<u8> = lines.filter_map(|line| split(line).map(|(_, letter)| letter)).take(3).collect();
    letters.first().is_some_and(|letter| matches!(letter, b'S' | b'G' | b'C' | b'B'))
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
                None => cards.strange += usize::from(!line.trim_ascii().is_empty()),
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

/// A record's data columns and the letter of its section; `None` where it has none.
fn split(line: &[u8]) -> Option<(&[u8], u8)> {
    let is_section = |letter: u8| matches!(letter, b'S' | b'G' | b'D' | b'P' | b'T' | b'C' | b'B');
    let is_number = |text: &[u8]| text.iter().all(|b| b.is_ascii_digit() || *b == b' ');
    if let Some(&letter) = line.get(DATA)
        && is_section(letter)
        && is_number(&line[DATA + 1..line.len().min(RECORD)])
    {
        return Some((&line[..DATA], letter));
    }
    // A record that lost or gained some columns still ends with its letter and number.
    let text = line.trim_ascii_end();
    let digits = text.iter().rev().take_while(|b| b.is_ascii_digit()).count();
    let before = text[..text.len() - digits].trim_ascii_end();
    let letter = *before.last()?;
    let at = before.len() - 1;
    let shifted = at.abs_diff(DATA) <= 4 && (1..=7).contains(&digits) && text.len() - at <= RECORD - DATA + 1;
    (is_section(letter) && shifted).then(|| (&line[..at.min(DATA)], letter))
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
        assert!(!looks_like_iges(b"ISO-10303-21;\nHEADER;\n"));
        assert!(!looks_like_iges(b""));
    }

    #[test]
    fn flag_records() {
        assert!(read(record("", 'B', 1).as_bytes()).binary);
        assert!(
            read((record("", 'C', 1) + "\nD1@1_110;\n").as_bytes()).compressed.is_some_and(|c| c.len() == 1)
        );
    }
}
