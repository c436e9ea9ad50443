//! The rooms of the house and the one way between them, as `src/lib.rs` describes it.

use std::fs;
use std::path::{Path, PathBuf};

/// Each module at the top, and the other ones that it may name.
const CHAIN: &[(&str, &[&str])] = &[
    ("numeric", &[]),
    ("geometry", &["numeric"]),
    ("brep", &["numeric", "geometry"]),
    ("step", &["numeric", "geometry", "brep"]),
    ("iges", &["numeric", "geometry", "brep"]),
    ("import", &["numeric", "geometry", "brep", "step", "iges"]),
    ("trimming", &["numeric", "geometry", "brep"]),
    ("scene", &["numeric"]),
    ("cache", &["numeric", "scene"]),
    ("bake", &["numeric", "geometry", "brep", "trimming", "scene"]),
    ("image", &["numeric"]),
    ("render", &["numeric", "scene", "image"]),
    ("bench", &["numeric", "geometry", "brep", "import", "bake", "scene", "cache", "image", "render"]),
    ("cli", &["numeric", "brep", "import", "bake", "scene", "cache", "image", "render", "bench"]),
];

/// A word that only some rooms may use.
struct Reserved {
    words: &'static [&'static str],
    rooms: &'static [&'static str],
}

const RESERVED: &[Reserved] = &[
    Reserved { words: &["wgpu", "pollster"], rooms: &["render/gpu"] },
    Reserved { words: &["clap", "indicatif", "anyhow", "env_logger"], rooms: &["cli"] },
    Reserved { words: &["KnotVector"], rooms: &["geometry", "brep", "step", "trimming", "bake"] },
    Reserved {
        words: &["fs", "File", "OpenOptions", "memmap2", "tempfile"],
        rooms: &["cli", "cache", "image", "import"],
    },
    Reserved { words: &["stdout", "stdin"], rooms: &["cli"] },
];

/// A file of `src`: its path from there, without comments and without what only tests see.
struct Source {
    path: PathBuf,
    code: String,
}

impl Source {
    /// The module at the top that the file belongs to.
    fn room(&self) -> String {
        let first = self.path.components().next().expect("a path has a component");
        Path::new(&first).file_stem().expect("a name").to_string_lossy().into_owned()
    }

    /// How many modules lie between the root and the file's own, that one included.
    fn depth(&self) -> usize {
        let is_folder_head = self.path.file_name().is_some_and(|name| name == "mod.rs");
        self.path.components().count() - usize::from(is_folder_head)
    }
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("src can be listed") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let source = |path: &PathBuf| Source {
        path: path.strip_prefix(&root).expect("below src").to_owned(),
        code: code_of(&fs::read_to_string(path).expect("UTF-8")),
    };
    paths.iter().map(source).collect()
}

/// The lines of code: no comment lines, nothing after the test module begins (it ends the file, by convention).
fn code_of(text: &str) -> String {
    let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    let lines = text[..end].lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

fn is_test_file(path: &Path) -> bool {
    path.file_stem().is_some_and(|stem| stem == "tests" || stem.to_string_lossy().ends_with("_tests"))
}

/// The modules at the top that the code names, by `crate::` or by enough `super::`.
fn named_rooms(code: &str, depth: usize) -> Vec<String> {
    let to_root = "super::".repeat(depth);
    let mut rooms = Vec::new();
    for prefix in ["crate::", to_root.as_str()] {
        for (at, _) in code.match_indices(prefix) {
            let before = &code[..at];
            let is_part =
                before.ends_with(|c: char| c.is_alphanumeric() || c == '_') || before.ends_with("super::");
            if is_part || code[at + prefix.len()..].starts_with("super::") {
                continue;
            }
            rooms.extend(first_names(&code[at + prefix.len()..]));
        }
    }
    rooms
}

/// The first name of a path, or the first name of each path of a group in braces.
fn first_names(rest: &str) -> Vec<String> {
    let name_at =
        |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(group) = rest.strip_prefix('{') else { return vec![name_at(rest)] };
    let mut names = vec![name_at(group.trim_start())];
    let mut level = 0;
    for (at, c) in group.char_indices() {
        match c {
            '{' => level += 1,
            '}' if level == 0 => break,
            '}' => level -= 1,
            ',' if level == 0 => names.push(name_at(group[at + 1..].trim_start())),
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

fn is_room(name: &str) -> bool {
    CHAIN.iter().any(|(room, _)| *room == name)
}

/// The rooms that the code of `room` names and may not.
fn forbidden(room: &str, code: &str, depth: usize) -> Vec<String> {
    let allowed = CHAIN.iter().find(|(name, _)| *name == room).map_or(&[][..], |(_, allowed)| allowed);
    let mut named = named_rooms(code, depth);
    named.retain(|name| is_room(name) && name != room && !allowed.contains(&name.as_str()));
    named
}

fn names_word(code: &str, word: &str) -> bool {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word)
        .any(|(at, _)| !code[..at].ends_with(is_name) && !code[at + word.len()..].starts_with(is_name))
}

#[test]
fn every_room_is_in_the_chain() {
    for source in sources() {
        let room = source.room();
        assert!(
            is_room(&room) || room == "lib" || room == "main",
            "{} has no place in the chain",
            source.path.display()
        );
    }
}

#[test]
fn rooms_name_only_what_stands_before_them() {
    let mut checked = 0;
    for source in sources().iter().filter(|s| is_room(&s.room()) && !is_test_file(&s.path)) {
        let room = source.room();
        let found = forbidden(&room, &source.code, source.depth());
        assert!(found.is_empty(), "{}: `{room}` must not name {found:?}", source.path.display());
        checked += 1;
    }
    eprintln!("{checked} files keep the chain");
    assert!(checked > 50, "only {checked} files were found");
}

#[test]
fn reserved_words_stay_in_their_rooms() {
    let mut checked = 0;
    for source in sources().iter().filter(|s| !is_test_file(&s.path)) {
        for reserved in RESERVED.iter().filter(|r| !r.rooms.iter().any(|room| is_in(&source.path, room))) {
            for word in reserved.words {
                assert!(
                    !names_word(&source.code, word),
                    "{}: `{word}` belongs to {:?}",
                    source.path.display(),
                    reserved.rooms
                );
            }
        }
        checked += 1;
    }
    eprintln!("{checked} files keep to their words");
}

fn is_in(path: &Path, room: &str) -> bool {
    path.starts_with(room) || path == Path::new(room).with_extension("rs")
}

#[test]
fn files_stay_small() {
    const MOST_LINES: usize = 600;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for source in sources() {
        let lines = fs::read_to_string(root.join(&source.path)).expect("UTF-8").lines().count();
        assert!(lines <= MOST_LINES, "{} has {lines} lines; split it", source.path.display());
    }
}

#[test]
fn what_must_not_be_is_found() {
    assert_eq!(forbidden("numeric", "use crate::scene::Scene;", 2), ["scene"]);
    assert_eq!(forbidden("step", "use crate::{brep::{Face, Edge}, bake, numeric::Aabb};", 2), ["bake"]);
    assert_eq!(forbidden("scene", "fn f() { super::super::bake::bake() }", 2), ["bake"]);
    assert_eq!(forbidden("scene", "use super::bake;", 1), ["bake"]);
    assert_eq!(forbidden("scene", "use super::bake; use super::super::super::bake;", 2), [""; 0]);
    assert_eq!(forbidden("render", "use crate::scene::Scene; use crate::image::Film;", 2), [""; 0]);
    assert!(names_word("use std::fs;", "fs") && names_word("wgpu::Device", "wgpu"));
    assert!(!names_word("let profile = 1; // offs", "fs"));
    assert_eq!(code_of("a\n// crate::bake\n    /// b\nc\n#[cfg(test)]\nmod tests {\n crate::bake"), "a\nc");
}
