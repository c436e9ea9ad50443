//! Strings of exchange structures: control directives decoded (ISO 10303-21, clause 6.4.3).
//!
//! `\X2\..\X0\` (UTF-16), `\X4\..\X0\` (UTF-32), `\X\hh` (Latin-1), `\S\c` (upper half of the page chosen by `\P?\`), `\N\` and `\F\`
//! (print controls), `''`, `\\`. Raw bytes are UTF-8 where they form it (as edition 3 has it and many files do), else Latin-1.
//! A directive that is no good stays as it is written; control characters other than line breaks and tabs are left out.

use super::pages;

/// The characters of the string between its apostrophes.
pub fn decode(raw: &[u8]) -> String {
    let raw = match std::str::from_utf8(raw) {
        Ok(text) => text.to_owned(),
        Err(_) => raw.iter().map(|&b| char::from(b)).collect(),
    };
    if !raw.contains(['\\', '\'']) && !raw.contains(|c: char| c.is_ascii_control()) {
        return raw;
    }
    let mut out = String::with_capacity(raw.len());
    let mut rest = raw.as_str();
    let mut page = b'A';
    while let Some(first) = rest.chars().next() {
        let directive = if first == '\\' { directive(rest, &mut page, &mut out) } else { None };
        rest = match directive {
            Some(length) => &rest[length..],
            None => {
                // Long strings are wrapped by some systems: a line break is no character (clause 5.2).
                if first == '\t' || !first.is_ascii_control() {
                    out.push(first);
                }
                let doubled = first == '\'' && rest[1..].starts_with('\'');
                &rest[first.len_utf8() + usize::from(doubled)..]
            }
        };
    }
    out
}

/// Decodes the directive that `text` begins with into `out`, or has it choose the page, and returns its length.
fn directive(text: &str, page: &mut u8, out: &mut String) -> Option<usize> {
    let body = &text[1..];
    if body.starts_with('\\') {
        out.push('\\');
        return Some(2);
    }
    if let Some(hex) = body.strip_prefix("X2\\") {
        return coded(hex, 4, out).map(|length| 4 + length);
    }
    if let Some(hex) = body.strip_prefix("X4\\") {
        return coded(hex, 8, out).map(|length| 4 + length);
    }
    if let Some(hex) = body.strip_prefix("X\\") {
        let code = u8::from_str_radix(hex.get(..2)?, 16).ok()?;
        out.push(char::from(code));
        return Some(5);
    }
    if let Some(shifted) = body.strip_prefix("S\\") {
        let character = shifted.chars().next().filter(char::is_ascii)?;
        out.push(pages::shifted(*page, character as u8));
        // An apostrophe is doubled here as everywhere.
        return Some(4 + usize::from(shifted.starts_with("''")));
    }
    if body.starts_with("N\\") {
        out.push('\n');
        return Some(3);
    }
    if body.starts_with("F\\") {
        return Some(3);
    }
    let chosen = body.strip_prefix('P')?.as_bytes();
    let letter =
        chosen.first().filter(|letter| letter.is_ascii_alphabetic() && chosen.get(1) == Some(&b'\\'))?;
    *page = letter.to_ascii_uppercase();
    Some(4)
}

/// Decodes groups of `width` hexadecimal digits up to `\X0\` and returns the length consumed.
fn coded(hex: &str, width: usize, out: &mut String) -> Option<usize> {
    let length =
        hex.bytes().position(|b| !b.is_ascii_hexdigit()).filter(|&at| hex[at..].starts_with("\\X0\\"))?;
    let digits = &hex.as_bytes()[..length];
    let mut units = Vec::with_capacity(length / width);
    for group in digits.chunks(width) {
        let group = std::str::from_utf8(group).ok()?;
        units.push(u32::from_str_radix(group, 16).ok()?);
    }
    if width == 4 {
        let units = units.iter().map(|&unit| unit as u16);
        out.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    } else {
        out.extend(units.iter().map(|&unit| char::from_u32(unit).unwrap_or(char::REPLACEMENT_CHARACTER)));
    }
    Some(length + 4)
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn directives() {
        for (raw, text) in [
            ("it''s", "it's"),
            (r"a\\b", r"a\b"),
            (r"\X2\00C400D6\X0\!", "ÄÖ!"),
            (r"\X2\D83DDE00\X0\", "😀"),
            (r"\X4\0001F600\X0\", "😀"),
            (r"\X\E9t\X\E9", "été"),
            (r"\PA\\S\Dx", "Äx"),
            (r"\PE\\S\2\S\P\S\[\PA\\S\[", "ВалÛ"),
            (r"\S\'' 5", "§ 5"),
            ("nul\0 and\ttab", "nul and\ttab"),
            (r"line\N\break", "line\nbreak"),
            ("wrap\r\nped", "wrapped"),
            ("Würfel", "Würfel"),
            (r"\X2\00C4", r"\X2\00C4"),
            (r"\Xzz\", r"\Xzz\"),
            (r"\", r"\"),
            ("''", "'"),
        ] {
            assert_eq!(decode(raw.as_bytes()), text, "{raw}");
        }
        assert_eq!(decode(b"W\xFCrfel"), "Würfel");
    }
}
