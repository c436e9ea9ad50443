//! How a scene answers whether a point is inside a face's trims: the methods of the trimming study, by number and by name.
//!
//! 1 to 29 are the rows of Table 2 of Sloup and Havran 2021: a list of curves (LC; Martin, Cohen, Fish and Shirley 2000), horizontal slabs (HS;
//! Schollmeyer and Fröhlich 2009), kd-trees on curves (KC) and on curvesets (KCS, and KCS of Schollmeyer and Fröhlich 2019), with refinement of leaves (R),
//! parallel boxing (B), empty space cutting off (E) and overlap minimisation (M). 30 is this program's own, the default; 31 is the same without
//! curves, decided by bands as narrow as what f32 resolves.

use std::fmt;
use std::str::FromStr;

/// Names in order of the numbers, which start at 1.
const NAMES: [&str; 31] = [
    "lc",
    "lc+b",
    "hs",
    "hs+b",
    "kc",
    "kc+r",
    "kc+b",
    "kc+e",
    "kc+rb",
    "kc+re",
    "kc+be",
    "kc+rbe",
    "kcs-sf19",
    "kcs",
    "kcs+r",
    "kcs+b",
    "kcs+e",
    "kcs+m",
    "kcs+rb",
    "kcs+re",
    "kcs+rm",
    "kcs+be",
    "kcs+bm",
    "kcs+em",
    "kcs+rbe",
    "kcs+rbm",
    "kcs+rem",
    "kcs+bem",
    "kcs+rbem",
    "packed",
    "packed-bands",
];

/// A bit for each method whose name has a letter after the plus.
const fn with_letter(letter: u8) -> u32 {
    let mut methods = 0;
    let mut index = 0;
    while index < NAMES.len() {
        let name = NAMES[index].as_bytes();
        let mut is_after_plus = false;
        let mut at = 0;
        while at < name.len() {
            if is_after_plus && name[at] == letter {
                methods |= 1 << (index + 1);
            }
            is_after_plus |= name[at] == b'+';
            at += 1;
        }
        index += 1;
    }
    methods
}

const BOXING: u32 = with_letter(b'b');
const REFINEMENT: u32 = with_letter(b'r');
const EMPTY_SPACE: u32 = with_letter(b'e');
const OVERLAP: u32 = with_letter(b'm');

/// A method of the trimming study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrimMethod(u8);

/// What a method searches in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum TrimStructure {
    /// All curves of a face.
    List = 0,
    /// Slabs of v between curve ends, and intervals of u in each.
    Slabs = 1,
    /// A kd-tree over curves.
    KdCurves = 2,
    /// A kd-tree over chains of curves of equal monotonicity.
    KdCurvesets = 3,
    /// The same, its chains cut by the full cost function first.
    KdCurvesetsSf19 = 4,
    /// A grid of cells and kd-trees, in [`trim_word`](super::trim_word) words.
    Packed = 5,
}

impl TrimMethod {
    /// This program's own.
    pub const PACKED: Self = Self(30);

    /// The same without curves.
    pub const PACKED_BANDS: Self = Self(31);

    /// All of them, by number.
    pub fn all() -> impl Iterator<Item = Self> {
        (1..=31).map(Self)
    }

    /// The method of a number, 1 to 31.
    #[inline]
    pub fn from_number(number: u32) -> Option<Self> {
        (1..=31).contains(&number).then_some(Self(number as u8))
    }

    /// 1 to 31.
    #[inline]
    pub const fn number(self) -> u32 {
        self.0 as u32
    }

    /// As the command line takes it.
    pub fn name(self) -> &'static str {
        NAMES[usize::from(self.0) - 1]
    }

    /// As tables show it: `12-KC+RBE`.
    pub fn label(self) -> String {
        let name = match self.name() {
            "kcs-sf19" => "KCS[SF19]".to_owned(),
            name => name.to_uppercase(),
        };
        format!("{}-{name}", self.0)
    }

    /// What it searches in.
    pub fn structure(self) -> TrimStructure {
        match self.0 {
            1..=2 => TrimStructure::List,
            3..=4 => TrimStructure::Slabs,
            5..=12 => TrimStructure::KdCurves,
            13 => TrimStructure::KdCurvesetsSf19,
            30 | 31 => TrimStructure::Packed,
            _ => TrimStructure::KdCurvesets,
        }
    }

    /// Whether curves and curvesets have slabs along the diagonals of their boxes.
    pub fn has_boxing(self) -> bool {
        self.is_in(BOXING)
    }

    /// Whether leaves with curves are halved while they are large.
    pub fn has_refinement(self) -> bool {
        self.is_in(REFINEMENT)
    }

    /// Whether empty strips are cut off leaves with one curve.
    pub fn has_empty_space(self) -> bool {
        self.is_in(EMPTY_SPACE)
    }

    /// Whether curvesets are cut where their boxes overlap.
    pub fn has_overlap(self) -> bool {
        self.is_in(OVERLAP)
    }

    #[inline]
    fn is_in(self, methods: u32) -> bool {
        methods >> self.0 & 1 == 1
    }
}

impl Default for TrimMethod {
    fn default() -> Self {
        Self::PACKED
    }
}

impl fmt::Display for TrimMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No method has this name or number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "no trim method is called {0}: a number from 1 to 31, or a name such as lc, hs+b, kc+rbe, kcs-sf19, kcs+rbem, packed"
)]
pub struct UnknownTrimMethod(String);

impl FromStr for TrimMethod {
    type Err = UnknownTrimMethod;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let lower = text.to_lowercase();
        let by_name = || NAMES.iter().position(|name| *name == lower).map(|index| index as u32 + 1);
        let number = lower.parse().ok().or_else(by_name);
        number.and_then(Self::from_number).ok_or_else(|| UnknownTrimMethod(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_those_of_the_table() {
        let label = |number: u32| TrimMethod::from_number(number).expect("a number of the table").label();
        assert_eq!([1, 12, 13, 29].map(label), ["1-LC", "12-KC+RBE", "13-KCS[SF19]", "29-KCS+RBEM"]);
        for method in TrimMethod::all() {
            assert_eq!(method.name().parse(), Ok(method));
            assert_eq!(method.number().to_string().parse(), Ok(method));
        }
        let with = |has: fn(TrimMethod) -> bool| TrimMethod::all().filter(|method| has(*method)).count();
        assert_eq!(with(TrimMethod::has_boxing), 2 + 4 + 8);
        assert_eq!([with(TrimMethod::has_refinement), with(TrimMethod::has_empty_space)], [4 + 8; 2]);
        assert_eq!(with(TrimMethod::has_overlap), 8);
        for wrong in ["", "0", "32", "kc+br", "-1"] {
            assert!(wrong.parse::<TrimMethod>().is_err(), "{wrong}");
        }
    }
}
