//! Scenes baked before: `.trimray` files in a folder, named by what they were baked from and how.
//!
//! A name is a hash of the source's bytes, of the options and of the program, so that no name ever stands for two scenes: a file that is there is right,
//! and one that is found damaged is as good as none. The folder is kept below a size; what was not used for longest goes first. Whatever fails here
//! costs time only: callers bake as if there were no folder.

use super::program::program;
use super::sound::{SoundFiles, is_hash};
use super::{CacheError, CacheFile, Provenance, write};
use crate::scene::Scene;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// The folder's greatest size, bytes.
const MOST_BYTES: u64 = 4 << 30;

/// The folder's folder of notes on what was found sound.
const SOUND: &str = "sound";

/// Ages of scenes need not be known better.
const LEAST_AGE: Duration = Duration::from_secs(3600);

/// What a scene is baked from and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key(blake3::Hash);

impl Key {
    /// Of a source by its hash. `how` tells all options in words; they need not be stable from one version of the program to the next.
    pub fn new(source_hash: [u8; 32], how: &str) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&source_hash).update(how.as_bytes()).update(&program().unwrap_or_default());
        Self(hasher.finalize())
    }
}

/// A folder of baked scenes.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    most_bytes: u64,
    /// Of a folder in which nobody else writes.
    sound: Option<SoundFiles>,
}

impl Store {
    /// In a folder, which need not exist yet. Others may write there: every scene is checked when it is found.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, most_bytes: MOST_BYTES, sound: None }
    }

    /// In a folder of the user's own: scenes that were found sound are not checked again.
    pub fn private(folder: PathBuf) -> Self {
        let sound = Some(SoundFiles::new(folder.join(SOUND)));
        Self { sound, ..Self::new(folder) }
    }

    /// In the user's folder for such things, where there is one: `~/.cache/trimray`, on macOS `~/Library/Caches/trimray`, on Windows
    /// `%LOCALAPPDATA%\trimray`.
    pub fn of_user() -> Option<Self> {
        Some(Self::private(dirs::cache_dir()?.join("trimray")))
    }

    /// Opens a file anywhere; one that is noted as sound, and has not been changed since, is not checked again.
    ///
    /// # Errors
    ///
    /// Those of [`CacheFile::open`].
    pub fn open(&self, path: &Path) -> Result<CacheFile, CacheError> {
        CacheFile::open_unless_sound(path, self.sound.as_ref())
    }

    /// The scene of a key, if it is there and sound.
    pub fn find(&self, key: &Key) -> Option<CacheFile> {
        let path = self.path(key);
        let file = self.open(&path).ok()?;
        // Its age counts from now on; where that cannot be noted it goes a little earlier.
        let _ = self.touch(&path);
        Some(file)
    }

    /// Dates a sound scene anew, and notes it as sound as it then is. Not every time: ages need not be known that well.
    fn touch(&self, path: &Path) -> std::io::Result<()> {
        let file = fs::File::options().append(true).open(path)?;
        let age = file.metadata()?.modified()?.elapsed();
        if age.is_ok_and(|age| age < LEAST_AGE) {
            return Ok(());
        }
        file.set_modified(SystemTime::now())?;
        if let Some(sound) = &self.sound {
            sound.add_own(&file.metadata()?);
        }
        Ok(())
    }

    /// Keeps a scene, which has been validated; others go where there is no room for it. One larger than the folder may be is not kept.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    pub fn keep(&self, key: &Key, scene: &Scene<'_>, provenance: &Provenance) -> Result<(), CacheError> {
        let path = self.path(key);
        fs::create_dir_all(&self.folder)
            .map_err(|source| CacheError::Io { path: self.folder.clone(), source })?;
        let written = write(&path, scene, provenance)?;
        if let (Some(sound), Ok(written)) = (&self.sound, written.metadata()) {
            sound.add_own(&written);
        }
        self.make_room();
        Ok(())
    }

    fn path(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{}.trimray", key.0.to_hex()))
    }

    /// Removes scenes, the longest unused first, until the rest is small enough.
    fn make_room(&self) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let mut files: Vec<(SystemTime, u64, PathBuf)> = entries
            .filter_map(Result::ok)
            .filter(|entry| is_ours(&entry.path()))
            .filter_map(|entry| {
                let metadata = entry.metadata().ok()?;
                Some((metadata.modified().ok()?, metadata.len(), entry.path()))
            })
            .collect();
        files.sort();
        let mut bytes: u64 = files.iter().map(|(_, size, _)| size).sum();
        for (_, size, path) in files {
            if bytes <= self.most_bytes {
                break;
            }
            if fs::remove_file(path).is_ok() {
                bytes -= size;
            }
        }
    }
}

/// Whether a file has a name that only [`Store::path`] gives.
fn is_ours(path: &Path) -> bool {
    path.file_stem().is_some_and(is_hash) && path.extension().is_some_and(|extension| extension == "trimray")
}

#[cfg(test)]
mod tests {
    use super::super::tests::{buffers, provenance};
    use super::*;

    /// Last changed so long ago.
    fn date(path: &Path, age: Duration) {
        let file = fs::File::options().append(true).open(path).expect("there");
        file.set_modified(SystemTime::now() - age).expect("dated");
    }

    #[test]
    fn what_is_kept_is_found_by_its_own_key_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::new(folder.path().join("deep/er"));
        let buffers = buffers();
        let keys = [Key::new([1; 32], "a"), Key::new([1; 32], "b"), Key::new([2; 32], "a")];
        assert!(store.find(&keys[0]).is_none());
        store.keep(&keys[0], &buffers.scene(), &provenance()).expect("written");
        let found = store.find(&keys[0]).expect("kept");
        assert_eq!(found.scene().faces, buffers.scene().faces);
        assert!(keys[1..].iter().all(|key| store.find(key).is_none()));
    }

    #[test]
    fn a_damaged_scene_is_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::private(folder.path().to_owned());
        let key = Key::new([1; 32], "");
        store.keep(&key, &buffers().scene(), &provenance()).expect("written");
        assert!(store.find(&key).is_some());
        let path = store.path(&key);
        let bytes = fs::read(&path).expect("there");
        fs::write(&path, &bytes[..bytes.len() / 2]).expect("cut");
        assert!(store.find(&key).is_none());
        // As long as before, but unsound.
        let mut changed = bytes.clone();
        let scene_of = |bytes: &[u8]| CacheFile::from_bytes(bytes).is_ok();
        let at = (0..changed.len()).rev().find(|&at| {
            changed[at] ^= 0xff;
            let is_unsound = !scene_of(&changed);
            if !is_unsound {
                changed[at] ^= 0xff;
            }
            is_unsound
        });
        fs::write(&path, &changed).expect("changed");
        date(&path, Duration::from_secs(1000));
        assert!(at.is_some() && store.find(&key).is_none());
    }

    #[test]
    fn what_was_found_sound_is_not_checked_again_until_it_changes() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::private(folder.path().to_owned());
        let mut buffers = buffers();
        buffers.materials[0].opacity = 7.0;
        let key = Key::new([1; 32], "");
        // The store takes its word for it, which tells that it does not look.
        store.keep(&key, &buffers.scene(), &provenance()).expect("written");
        assert!(CacheFile::open(&store.path(&key)).is_err());
        assert!(Store::new(folder.path().to_owned()).find(&key).is_none(), "others may write there");
        if cfg!(unix) {
            assert!(store.find(&key).is_some());
        }
        date(&store.path(&key), Duration::from_secs(1000));
        assert!(store.find(&key).is_none());
    }

    #[test]
    fn a_scene_of_long_ago_is_noted_as_it_is_dated() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::private(folder.path().to_owned());
        let key = Key::new([1; 32], "");
        store.keep(&key, &buffers().scene(), &provenance()).expect("written");
        let path = store.path(&key);
        date(&path, Duration::from_secs(100_000));
        let sound = store.sound.as_ref().expect("private");
        let is_noted = || sound.has(&fs::metadata(&path).expect("there"));
        assert!(!is_noted());
        assert!(store.find(&key).is_some());
        let age = fs::metadata(&path).and_then(|m| m.modified()).expect("there").elapsed();
        assert!(age.is_ok_and(|age| age < LEAST_AGE) && is_noted() == cfg!(unix));
    }

    #[test]
    fn the_longest_unused_goes_first_and_strangers_stay() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut store = Store::new(folder.path().to_owned());
        let keys: Vec<Key> = (0..3).map(|index| Key::new([index; 32], "")).collect();
        fs::write(folder.path().join("mine.trimray"), "not a hash").expect("written");
        for (age, key) in (1..).zip(&keys[..2]) {
            store.keep(key, &buffers().scene(), &provenance()).expect("written");
            date(&store.path(key), Duration::from_secs(3600 * (1000 - age * 100)));
        }
        assert!(store.find(&keys[0]).is_some(), "and used");
        let size = fs::metadata(store.path(&keys[0])).expect("there").len();
        store.most_bytes = 2 * size;
        store.keep(&keys[2], &buffers().scene(), &provenance()).expect("written");
        let is_there: Vec<bool> = keys.iter().map(|key| store.path(key).exists()).collect();
        assert_eq!(is_there, [true, false, true]);
        assert!(folder.path().join("mine.trimray").exists());
    }
}
