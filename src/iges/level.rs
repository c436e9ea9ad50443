//! Levels (field 5 of the directory): the layers of an IGES file, which its writers sort what stands alone by.
//!
//! A level is a number, or a list of numbers in a property (entity 406, form 1), of which the first counts. A property (entity 406,
//! form 3) may say what a level is for.

use super::directory::Directory;
use super::reader::Reader;
use super::value::Value;
use std::collections::{BTreeMap, HashMap};

/// The entities that belong to no layer, and the others by level: layers are worth having where there are several levels.
pub fn sorted(reader: &Reader, entities: Vec<u32>) -> (Vec<u32>, BTreeMap<u32, Vec<u32>>) {
    let mut levels: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &entity in &entities {
        levels.entry(of(&reader.file, entity)).or_default().push(entity);
    }
    if levels.len() < 2 {
        return (entities, BTreeMap::new());
    }
    (levels.remove(&0).unwrap_or_default(), levels)
}

/// The names of levels that have one.
pub fn names(reader: &Reader) -> HashMap<u32, String> {
    let file = &reader.file;
    let properties = file.entities().filter(|(_, entry)| entry.kind == 406 && entry.form == 3);
    properties
        .filter_map(|(entity, _)| {
            let parameters = file.parameters(entity).ok()?;
            match parameters.values.get(3) {
                Some(Value::Text(name)) if !name.trim().is_empty() => {
                    Some((of(file, entity), name.trim().to_owned()))
                }
                _ => None,
            }
        })
        .collect()
}

fn of(file: &Directory, entity: u32) -> u32 {
    let level = file.entry(entity).map_or(0, |entry| entry.level);
    match u32::try_from(level) {
        Ok(level) => level,
        Err(_) => {
            // How many levels, these.
            let list = file.parameters(level.unsigned_abs()).ok().filter(|list| list.kind == 406);
            list.and_then(|list| u32::try_from(list.integer(2).ok()?).ok()).unwrap_or(0)
        }
    }
}
