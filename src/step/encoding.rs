//! Which bytes a file's characters are: exchange structures are ASCII or UTF-8 (ISO 10303-21, clause 5.2), and some editors
//! save them as UTF-16.

use super::scan;
use std::borrow::Cow;

/// Bytes enough to see how a file begins.
const BEGINNING: usize = 4096;

/// Whether the file begins as an exchange structure, in any of its encodings.
pub fn is_exchange_structure(bytes: &[u8]) -> bool {
    if is_utf16(bytes).is_some() {
        scan::is_exchange_structure(&utf8(&bytes[..bytes.len().min(BEGINNING)]))
    } else {
        scan::is_exchange_structure(bytes)
    }
}

/// The file with its UTF-16 turned into UTF-8; everything else as it is.
pub fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let Some(unit) = is_utf16(bytes) else { return Cow::Borrowed(bytes) };
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    Cow::Owned(text.collect::<String>().into_bytes())
}

/// How two bytes make a unit, where the file is UTF-16: it has its mark, or begins with ASCII in every other byte.
fn is_utf16(bytes: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match bytes {
        [0xFF, 0xFE, ..] | [b'I' | b'i', 0, b'S' | b's', 0, ..] => Some(u16::from_le_bytes),
        [0xFE, 0xFF, ..] | [0, b'I' | b'i', 0, b'S' | b's', ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::read;

    #[test]
    fn utf_16_is_read_with_and_without_a_mark() {
        let text = "ISO-10303-21;HEADER;FILE_NAME('','',(''),(''),'','größe','');ENDSEC;DATA;#1=A();ENDSEC;";
        for mark in ["\u{feff}", ""] {
            let units: Vec<u16> = mark.chars().chain(text.chars()).map(|c| c as u16).collect();
            for order in [u16::to_le_bytes as fn(u16) -> [u8; 2], u16::to_be_bytes] {
                let mut bytes: Vec<u8> = units.iter().flat_map(|&unit| order(unit)).collect();
                assert!(is_exchange_structure(&bytes));
                assert_eq!(read(&bytes).expect("an entity").source.originating_system, "größe");
                // A last byte without its other half is nothing.
                bytes.push(0);
                assert!(read(&bytes).is_ok());
            }
        }
        assert!(!is_exchange_structure(b"\xFF\xFE"));
    }
}
