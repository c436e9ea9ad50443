//! Cryptomatte (Friedman and Jones 2015, specification 1.2 of Psyop): which parts a pixel shows, and how much of it each covers.
//!
//! A part is known by the hash of its name, as the bits of an f32. Of each pixel the parts with the greatest coverage are kept, in pairs of hash and coverage,
//! two pairs to a layer: `CryptoObject00.R G B A` and so on. The file's attributes tell the layer's name, the hash and a manifest of all names, so
//! that Nuke, Blender and others can pick parts by name.

use bytemuck::{Pod, Zeroable};
use std::collections::HashMap;
use std::fmt::Write;

/// Parts that are kept of a pixel.
pub const RANKS: usize = 6;

/// The layer's name.
const LAYER: &str = "CryptoObject";

/// How much of a pixel a part covers.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Share {
    /// 1 + instance index; 0 where there is none.
    pub part: u32,
    /// 0 to 1.
    pub coverage: f32,
}

/// Names for parts at these paths of the product tree: paths that occur again get a number.
pub fn unique_names<'a>(paths: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut times: HashMap<String, usize> = HashMap::new();
    let mut names = Vec::new();
    for path in paths {
        let mut name = path.to_owned();
        while times.contains_key(&name) {
            let times = times.entry(path.to_owned()).or_insert(0);
            *times += 1;
            name = format!("{path} ({})", *times);
        }
        times.insert(name.clone(), 1);
        names.push(name);
    }
    names
}

/// The hash by which a name is known: MurmurHash3 of 32 bits, with an exponent that makes it a normal f32.
pub fn matte_id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    let exponent = hash >> 23 & 255;
    if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash }
}

/// MurmurHash3_x86_32 (Appleby, public domain) with seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let scramble = |k: u32| k.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (blocks, tail) = bytes.as_chunks::<4>();
    let mut hash = 0_u32;
    for block in blocks {
        hash ^= scramble(u32::from_le_bytes(*block));
        hash = hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    let mut last = [0; 4];
    last[..tail.len()].copy_from_slice(tail);
    hash ^= scramble(u32::from_le_bytes(last));
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// The channels of a film's shares: names and samples.
pub(super) fn channels(matte: &[[Share; RANKS]], names: &[String]) -> Vec<(String, Vec<f32>)> {
    let ids: Vec<f32> = names.iter().map(|name| f32::from_bits(matte_id(name))).collect();
    let id = |share: &Share| {
        let index = (share.part as usize).checked_sub(1);
        index.and_then(|index| ids.get(index)).copied().unwrap_or_default()
    };
    let channel = |rank: usize, letter: &str, value: &dyn Fn(&Share) -> f32| {
        let samples = matte.iter().map(|shares| value(&shares[rank])).collect();
        (format!("{LAYER}{:02}.{letter}", rank / 2), samples)
    };
    let letters = |rank: usize| if rank.is_multiple_of(2) { ["R", "G"] } else { ["B", "A"] };
    (0..RANKS)
        .flat_map(|rank| {
            let [of_id, of_coverage] = letters(rank);
            [channel(rank, of_id, &id), channel(rank, of_coverage, &|share| share.coverage)]
        })
        .collect()
}

/// The attributes that tell what the layer is.
pub(super) fn attributes(names: &[String]) -> Vec<(String, String)> {
    let key =
        |field: &str| format!("cryptomatte/{:.7}/{field}", format!("{:08x}", murmur3(LAYER.as_bytes())));
    vec![
        (key("name"), LAYER.to_owned()),
        (key("hash"), "MurmurHash3_32".to_owned()),
        (key("conversion"), "uint32_to_float32".to_owned()),
        (key("manifest"), manifest(names)),
    ]
}

/// A JSON object of names and hashes, in ASCII: EXR's strings promise no more.
fn manifest(names: &[String]) -> String {
    let mut text = String::from("{");
    for (index, name) in names.iter().enumerate() {
        let separator = if index > 0 { "," } else { "" };
        let quoted = serde_json::Value::from(name.as_str()).to_string();
        write!(text, "{separator}{}:\"{:08x}\"", ascii(&quoted), matte_id(name)).expect("a string takes all");
    }
    text + "}"
}

/// JSON text with escapes for what is not ASCII.
fn ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        if c.is_ascii() {
            text.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                write!(text, "\\u{unit:04x}").expect("a string takes all");
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_reference() {
        for (text, hash) in [
            ("", 0),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
        assert_eq!(matte_id(""), 1 << 23, "a normal number");
        for index in 0..10_000 {
            assert!(f32::from_bits(matte_id(&format!("part {index}"))).is_normal());
        }
    }

    #[test]
    fn equal_paths_get_numbers() {
        let names = unique_names(["a/b", "a/b", "a/b (2)", "a/b", "c"]);
        assert_eq!(names, ["a/b", "a/b (2)", "a/b (2) (2)", "a/b (3)", "c"]);
    }

    #[test]
    fn the_manifest_is_json_in_ascii() {
        let names = ["Kugel ⌀10/\"𝄞\"".to_owned(), "b".to_owned()];
        let manifest = manifest(&names);
        assert!(manifest.is_ascii());
        let parsed: HashMap<String, String> = serde_json::from_str(&manifest).expect("JSON");
        assert_eq!(parsed[&names[0]], format!("{:08x}", matte_id(&names[0])));
        assert_eq!(parsed.len(), 2);
    }

    #[test]
    fn ranks_are_pairs_of_channels() {
        let mut shares = [Share::default(); RANKS];
        shares[0] = Share { part: 2, coverage: 0.75 };
        shares[1] = Share { part: 1, coverage: 0.25 };
        let found: HashMap<String, Vec<f32>> =
            channels(&[shares], &["a".into(), "b".into()]).into_iter().collect();
        assert_eq!(found.len(), 12);
        assert_eq!(found["CryptoObject00.R"][0].to_bits(), matte_id("b"));
        assert_eq!(found["CryptoObject00.G"], [0.75]);
        assert_eq!(found["CryptoObject00.B"][0].to_bits(), matte_id("a"));
        assert_eq!(found["CryptoObject00.A"], [0.25]);
        assert_eq!(found["CryptoObject02.A"], [0.0]);
    }
}
