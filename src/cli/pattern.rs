//! Patterns that mean places of the product tree and entities of the file.

use std::convert::Infallible;
use std::str::FromStr;

/// `Bolt*`, `Car/**/Bolt` or `#123`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Pattern {
    /// The file's number of an entity.
    Entity(u64),
    /// A glob for names, or, where it has a `/`, for paths.
    Glob(String),
}

impl FromStr for Pattern {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        let entity = text.strip_prefix('#').and_then(|digits| digits.parse().ok());
        Ok(entity.map_or_else(|| Self::Glob(text.to_owned()), Self::Entity))
    }
}

impl std::fmt::Display for Pattern {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Entity(entity) => write!(f, "#{entity}"),
            Self::Glob(glob) => f.write_str(glob),
        }
    }
}

impl Pattern {
    /// Whether it means a place of the product tree itself, not only one above it.
    pub(super) fn means_place(&self, path: &str, name: &str, entities: &[u64]) -> bool {
        match self {
            Self::Entity(entity) => entities.contains(entity),
            Self::Glob(glob) if glob.contains('/') => matches(glob, path),
            Self::Glob(glob) => matches(glob, name),
        }
    }

    /// Whether it means an entity by its number.
    pub(super) fn means_entity(&self, entity: u64) -> bool {
        *self == Self::Entity(entity)
    }
}

/// Whether a glob stands for the whole text: `?` for one character and `*` for any number, none of them `/`, `**` for any characters at all.
///
/// Two places to go back to, one for each kind of star, suffice: whatever the last star of a kind can take, an earlier one need not.
fn matches(glob: &str, text: &str) -> bool {
    let glob: Vec<char> = glob.chars().collect();
    let text: Vec<char> = text.chars().collect();
    let (mut g, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    let mut double_star: Option<(usize, usize)> = None;
    loop {
        if glob.get(g) == Some(&'*') {
            if glob.get(g + 1) == Some(&'*') {
                g += 2;
                double_star = Some((g, t));
                star = None;
            } else {
                g += 1;
                star = Some((g, t));
            }
            continue;
        }
        let is_same = match (glob.get(g), text.get(t)) {
            (None, None) => return true,
            (Some('?'), Some(c)) => *c != '/',
            (Some(p), Some(c)) => p == c,
            _ => false,
        };
        if is_same {
            (g, t) = (g + 1, t + 1);
            continue;
        }
        // The last star takes one more character.
        match (star, double_star) {
            (Some((after, from)), _) if text.get(from).is_some_and(|c| *c != '/') => {
                star = Some((after, from + 1));
                (g, t) = (after, from + 1);
            }
            (_, Some((after, from))) if from < text.len() => {
                star = None;
                double_star = Some((after, from + 1));
                (g, t) = (after, from + 1);
            }
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globs_match_as_in_a_shell() {
        for (glob, text) in [
            ("Bolt", "Bolt"),
            ("B*t", "Bolt"),
            ("*", ""),
            ("?olt*", "Bolt (3)"),
            ("Car/*/Bolt", "Car/Wheel/Bolt"),
            ("Car/**/Bolt", "Car/Wheel/Hub/Bolt"),
            ("**/Bolt*", "Car/Wheel/Bolt 4"),
            ("**b/*c", "aab/b/bc"),
            ("*a*b", "xaxab"),
            ("Ü*", "Überwurf"),
        ] {
            assert!(matches(glob, text), "{glob} {text}");
        }
        for (glob, text) in [
            ("Bolt", "bolt"),
            ("B*", "A/B"),
            ("*", "a/b"),
            ("a?b", "a/b"),
            ("Car/*/Bolt", "Car/Wheel/Hub/Bolt"),
            ("Bolt?", "Bolt"),
            ("", "a"),
            ("**/b", "ab"),
        ] {
            assert!(!matches(glob, text), "{glob} {text}");
        }
    }

    #[test]
    fn many_stars_take_no_time() {
        assert!(!matches(&"*a".repeat(200), &"a".repeat(100_000)[..199]));
        assert!(!matches(&"**a".repeat(50), &format!("{}b", "a".repeat(20_000))));
    }

    #[test]
    fn numbers_mean_entities() {
        let pattern: Pattern = "#12".parse().expect("it cannot fail");
        assert!(pattern.means_entity(12) && pattern.means_place("a", "a", &[3, 12]));
        assert!(!pattern.means_place("#12", "#12", &[0]));
        let named: Pattern = "#12b".parse().expect("it cannot fail");
        assert!(named.means_place("a/#12b", "#12b", &[]));
    }
}
