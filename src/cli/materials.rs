//! From the flags of materials, and the file of `--materials`, to looks that win over those of a scene.

use super::Failure;
use super::args::parse_color;
use super::args_material::{MaterialArguments, linear, parse_share};
use super::pattern::Pattern;
use super::selection::meant;
use crate::render::{Overridden, Override, PartOverride, override_looks};
use crate::scene::Scene;
use anyhow::Context;
use std::path::Path;
use toml::{Table, Value};

/// Bytes of a file of looks at most.
const MOST_BYTES: u64 = 1 << 24;

/// What is said of looks.
pub(super) struct Looks {
    all: Override,
    parts: Vec<(Pattern, Override)>,
}

/// What the flags and their file say.
///
/// # Errors
///
/// The file cannot be read, or says what is not allowed.
pub(super) fn looks(flags: &MaterialArguments) -> anyhow::Result<Looks> {
    let parts = match &flags.materials {
        None => Vec::new(),
        Some(path) => {
            let text = read(path).with_context(|| format!("cannot read {}", path.display()))?;
            parse(&text).map_err(|reason| Failure::Usage(format!("{}: {reason}", path.display())))?
        }
    };
    Ok(Looks { all: flags.all(), parts })
}

fn read(path: &Path) -> anyhow::Result<String> {
    anyhow::ensure!(std::fs::metadata(path)?.len() <= MOST_BYTES, "it is longer than {MOST_BYTES} bytes");
    Ok(std::fs::read_to_string(path)?)
}

/// The looks that a scene has by them; `input` is for errors.
///
/// # Errors
///
/// A pattern that means nothing.
pub(super) fn overridden(looks: &Looks, scene: &Scene<'_>, input: &Path) -> anyhow::Result<Overridden> {
    let patterns: Vec<&Pattern> = looks.parts.iter().map(|(pattern, _)| pattern).collect();
    let meant = meant(scene, &patterns, input)?;
    let parts: Vec<PartOverride> = looks
        .parts
        .iter()
        .zip(meant)
        .map(|(&(_, look), meant)| PartOverride { look, instances: meant.instances, faces: meant.faces })
        .collect();
    override_looks(scene, &looks.all, &parts).context("too many different materials")
}

fn parse(text: &str) -> Result<Vec<(Pattern, Override)>, String> {
    let tables: Table = toml::from_str(text).map_err(|error| error.to_string())?;
    let part = |(pattern, value): (&String, &Value)| {
        let Value::Table(table) = value else {
            return Err(format!(
                "`{pattern}` is no table: write [\"{pattern}\"] and below it what its parts look like"
            ));
        };
        let look = parse_look(table).map_err(|reason| format!("[\"{pattern}\"]: {reason}"))?;
        let Ok(pattern) = pattern.parse();
        Ok((pattern, look))
    };
    tables.iter().map(part).collect()
}

fn parse_look(table: &Table) -> Result<Override, String> {
    let mut look = Override::default();
    for (key, value) in table {
        let share = || parse_share(&plain(value)).map(Some).map_err(|reason| format!("{key}: {reason}"));
        match key.as_str() {
            "color" => {
                let color = parse_color(&plain(value)).map_err(|reason| format!("color: {reason}"))?;
                look.rgb = Some(linear(color));
            }
            "roughness" => look.roughness = share()?,
            "metallic" => look.metallic = share()?,
            "opacity" => look.opacity = share()?,
            _ => return Err(format!("`{key}` is none of color, roughness, metallic and opacity")),
        }
    }
    Ok(look)
}

/// A value as the flags have it: numbers of an array with commas between them.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(","),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => number.to_string(),
        Value::Boolean(_) | Value::Datetime(_) | Value::Table(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_in_their_order() {
        let text = "[\"Z*\"]\ncolor = '#ff0000'\nroughness = 1\n[a.b]\n[\"Car/**\"]\ncolor = [0, 1.0, 0]\nopacity = 0.5\n";
        assert!(parse(text).is_err_and(|reason| reason.contains("`b`")));
        let looks = parse(&text.replace("[a.b]\n", "")).expect("two tables");
        let [(first, red), (second, green)] = &looks[..] else { panic!("{looks:?}") };
        assert_eq!((first.to_string(), second.to_string()), ("Z*".into(), "Car/**".into()));
        assert_eq!((red.rgb, red.roughness, red.metallic), (Some([1.0, 0.0, 0.0]), Some(1.0), None));
        assert_eq!((green.rgb, green.opacity), (Some([0.0, 1.0, 0.0]), Some(0.5)));
    }

    #[test]
    fn what_is_not_allowed_is_told() {
        for (text, said) in [
            ("[bolt]\nshine = 1", "`shine`"),
            ("[bolt]\nroughness = 2", "from 0 to 1"),
            ("[bolt]\nmetallic = 'very'", "from 0 to 1"),
            ("[bolt]\ncolor = 'red'", "#rrggbb"),
            ("[bolt]\ncolor = [1, 2]", "r,g,b"),
            ("bolt = 3", "no table"),
            ("[bolt]\n[bolt]", "bolt"),
            ("[bolt", "TOML"),
        ] {
            let reason = parse(text).expect_err(text);
            assert!(reason.contains(said), "{text}: {reason}");
        }
    }
}
