//! The compressed form (IGES 5.3, clause 2.3): a directory entry gives only the fields that differ from the entry before,
//! as `D<number>@<field>_<value>@…;`, and the entity's parameters follow at once.

use super::directory::Entry;
use super::value::{Delimiters, number};

/// The entities of a compressed file; entry pointers count `parameters` from 1.
#[derive(Debug, Default)]
pub struct Unfolded<'a> {
    /// By position.
    pub entries: Vec<Entry>,
    /// Lines of parameter data.
    pub parameters: Vec<&'a [u8]>,
}

/// Reads the lines after the global section.
pub fn unfold<'a>(lines: &[&'a [u8]], delimiters: Delimiters) -> Unfolded<'a> {
    let mut unfolded = Unfolded::default();
    let mut fields = [0_i64; 21];
    let (mut status, mut label) = (Vec::new(), Vec::new());
    let mut in_entry = false;
    for line in lines {
        let text = line.trim_ascii();
        let starts = text.first() == Some(&b'D')
            && text.get(1).is_some_and(u8::is_ascii_digit)
            && text.contains(&b'@');
        if starts || (in_entry && text.first() == Some(&b'@')) {
            let end = text.iter().position(|b| *b == delimiters.record);
            apply(&text[..end.unwrap_or(text.len())], &mut fields, &mut status, &mut label);
            if starts {
                unfolded.entries.push(Entry::default());
            }
            in_entry = end.is_none();
            if let Some(entry) = unfolded.entries.last_mut() {
                *entry = Entry::from_fields(|at| fields[at], &status, &label);
                entry.parameters = unfolded.parameters.len() as u32 + 1;
                entry.records = 0;
            }
        } else if let Some(entry) = unfolded.entries.last_mut() {
            unfolded.parameters.push(line);
            entry.records += 1;
            in_entry = false;
        }
    }
    unfolded
}

/// Sets the fields that a directory line gives.
fn apply(line: &[u8], fields: &mut [i64; 21], status: &mut Vec<u8>, label: &mut Vec<u8>) {
    for part in line.split(|b| *b == b'@').skip(1) {
        let Some(bar) = part.iter().position(|b| *b == b'_') else { continue };
        let (name, value) = (&part[..bar], part[bar + 1..].trim_ascii());
        match number(name).filter(|n| n.fract() == 0.0 && (1.0..=20.0).contains(n)) {
            Some(9.0) => *status = value.to_vec(),
            Some(18.0) => *label = value.to_vec(),
            Some(at) => fields[at as usize] = number(value).map_or(0, |n| n as i64),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_inherited() {
        let lines: [&[u8]; 5] =
            [b"D1@1_116@9_00010000@13_3;", b"116,1.,2.,", b"3.;", b"D3@1_110;", b"110,0.,0.,0.,1.,1.,1.;"];
        let unfolded = unfold(&lines, Delimiters::default());
        let [point, line] = unfolded.entries[..] else { panic!("two entities") };
        assert_eq!((point.kind, point.parameters, point.records, point.color), (116, 1, 2, 3));
        assert_eq!((line.kind, line.parameters, line.records, line.color), (110, 3, 1, 3));
        assert!(line.physically_dependent && unfolded.parameters.len() == 3);
    }
}
