//! Which files were found sound, so that whoever opens one of them again need not read all of it.
//!
//! A note is an empty file in a folder in which nobody but the user writes. Its name is a hash of the device, the inode, the size and the times of the file that
//! it stands for, and of the program: a file that is changed or replaced has other times, and is checked again. Since clocks have ticks, a file from elsewhere is
//! noted only once it is older than those.
//! Nothing in a cache file says that it is sound: others may have written it.
//!
//! It is the file system's word that is taken: what changes a file through a map of its own, or makes times up, is not noticed. Such a scene may end the program or
//! keep it from ending; memory stays safe, as everywhere in code that checks bounds.

use super::program::program;
use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// How long a file has to have been as it is before it is noted: longer than file systems' clocks stand still.
const SETTLED: Duration = Duration::from_secs(2);

/// Notes kept at most.
const MOST_NOTES: usize = 1024;

/// A folder of notes, which need not exist yet.
#[derive(Debug, Clone)]
pub struct SoundFiles {
    folder: PathBuf,
}

impl SoundFiles {
    /// In a folder.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Whether the file, as it is now, was found sound.
    pub fn has(&self, file: &Metadata) -> bool {
        identity(file).and_then(|identity| self.note(&identity)).is_some_and(|note| note.exists())
    }

    /// Notes that the file is sound, if it is as it was before it was looked at.
    pub fn add(&self, before: &Metadata, now: &Metadata) {
        self.add_at(before, now, SystemTime::now());
    }

    fn add_at(&self, before: &Metadata, now: &Metadata, clock: SystemTime) {
        let is_settled =
            changed(now).and_then(|then| clock.duration_since(then).ok()).is_some_and(|age| age >= SETTLED);
        if is_settled && identity(before) == identity(now) {
            self.add_own(now);
        }
    }

    /// Notes that a file is sound which this program has just written, or dated. What fails here costs the next one time, and nothing else.
    pub fn add_own(&self, file: &Metadata) {
        let Some(note) = identity(file).and_then(|identity| self.note(&identity)) else { return };
        if fs::create_dir_all(&self.folder).is_ok() {
            self.make_room();
            let _ = fs::File::create(note);
        }
    }

    fn note(&self, identity: &[u8]) -> Option<PathBuf> {
        let mut hasher = blake3::Hasher::new();
        hasher.update(identity).update(&program()?);
        Some(self.folder.join(hasher.finalize().to_hex().as_str()))
    }

    /// Removes the oldest half of the notes where there are too many.
    fn make_room(&self) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let dated = |path: PathBuf| Some((fs::metadata(&path).and_then(|m| m.modified()).ok()?, path));
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let mut notes: Vec<_> = paths.filter(|path| is_note(path)).filter_map(dated).collect();
        if notes.len() >= MOST_NOTES {
            notes.sort();
            notes.drain(..MOST_NOTES / 2).for_each(|(_, path)| drop(fs::remove_file(path)));
        }
    }
}

/// Whether a file has a name that only [`SoundFiles::note`] gives.
fn is_note(path: &Path) -> bool {
    path.file_name().is_some_and(is_hash)
}

/// Whether a name is a hash in hexadecimal.
pub(super) fn is_hash(name: &OsStr) -> bool {
    name.len() == 2 * blake3::OUT_LEN && name.as_encoded_bytes().iter().all(u8::is_ascii_hexdigit)
}

/// What changes with every change of a file; `None` where the system does not tell.
#[cfg(unix)]
fn identity(file: &Metadata) -> Option<Vec<u8>> {
    use std::os::unix::fs::MetadataExt;
    let times = [file.mtime(), file.mtime_nsec(), file.ctime(), file.ctime_nsec()];
    let words = [file.dev(), file.ino(), file.size()].into_iter().chain(times.map(|time| time as u64));
    Some(words.flat_map(u64::to_le_bytes).collect())
}

#[cfg(not(unix))]
fn identity(_: &Metadata) -> Option<Vec<u8>> {
    None
}

/// When the file was last changed, its name, owner and permissions included.
#[cfg(unix)]
fn changed(file: &Metadata) -> Option<SystemTime> {
    use std::os::unix::fs::MetadataExt;
    let since_epoch = Duration::new(file.ctime().try_into().ok()?, file.ctime_nsec().try_into().ok()?);
    SystemTime::UNIX_EPOCH.checked_add(since_epoch)
}

#[cfg(not(unix))]
fn changed(_: &Metadata) -> Option<SystemTime> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn written(path: &Path, text: &str) -> Metadata {
        fs::write(path, text).expect("written");
        fs::metadata(path).expect("there")
    }

    #[test]
    fn files_are_noted_as_they_are() {
        let folder = tempfile::tempdir().expect("a folder");
        let notes = SoundFiles::new(folder.path().join("deep/er"));
        let path = folder.path().join("a");
        let first = written(&path, "one");
        assert!(!notes.has(&first));
        // As young as a clock's tick, and from a future that the clock does not know yet.
        for clock in [changed(&first).expect("dated"), SystemTime::UNIX_EPOCH] {
            notes.add_at(&first, &first, clock);
            assert!(!notes.has(&first));
        }
        notes.add_at(&first, &first, changed(&first).expect("dated") + SETTLED);
        assert!(notes.has(&first));
        // Of the same size and with the same time of change, but not of the change of that.
        fs::File::options()
            .write(true)
            .open(&path)
            .and_then(|f| f.set_modified(SystemTime::UNIX_EPOCH))
            .expect("dated");
        let dated = fs::metadata(&path).expect("there");
        assert!(!notes.has(&dated));
        let longer = written(&path, "longer");
        assert!(!notes.has(&longer) && notes.has(&first));
        // Another file with the same contents.
        assert!(!notes.has(&written(&folder.path().join("b"), "one")));
    }

    #[test]
    fn a_file_that_changes_under_the_eyes_is_not_noted() {
        let folder = tempfile::tempdir().expect("a folder");
        let notes = SoundFiles::new(folder.path().to_owned());
        let path = folder.path().join("a");
        let before = written(&path, "one");
        let now = written(&path, "other");
        notes.add_at(&before, &now, changed(&now).expect("dated") + SETTLED);
        assert!(!notes.has(&before) && !notes.has(&now));
        notes.add_own(&now);
        assert!(!notes.has(&before) && notes.has(&now));
    }

    #[test]
    fn the_oldest_notes_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let notes = SoundFiles::new(folder.path().to_owned());
        fs::create_dir_all(&notes.folder).expect("made");
        for index in 0..MOST_NOTES {
            let name = blake3::hash(&index.to_le_bytes()).to_hex();
            fs::write(notes.folder.join(name.as_str()), "").expect("written");
        }
        let stranger = notes.folder.join("mine");
        let file = written(&stranger, "one");
        notes.add_own(&file);
        assert_eq!(fs::read_dir(&notes.folder).expect("there").count(), MOST_NOTES / 2 + 2);
        assert!(stranger.exists() && notes.has(&file));
    }
}
