//! Image files as the file system sees them: whole or not there.

use std::io::Write;
use std::path::{Path, PathBuf};

/// Why an image cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// Reading or writing failed.
    #[error("{path}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The pixels cannot be encoded, or the bytes are no such image.
    #[error("{format}: {reason}")]
    Invalid {
        /// "PNG" or "EXR".
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, ImageError> {
    std::fs::read(path).map_err(|source| ImageError::Io { path: path.to_owned(), source })
}

/// Makes the folder that a file is to be in, unless it is there.
pub fn make_folder_of(path: &Path) -> Result<(), ImageError> {
    let folder = folder_of(path);
    std::fs::create_dir_all(folder).map_err(|source| ImageError::Io { path: folder.to_owned(), source })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes `bytes` to a temporary file beside `path` and renames it to `path`, with the permissions of a file made the plain way.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    let failed = |source| ImageError::Io { path: path.to_owned(), source };
    // Renaming would put a file in the place of a device.
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(failed(std::io::Error::new(
            std::io::ErrorKind::InvalidInput,
            "it exists and is no file",
        )));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".trimray-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder_of(path)).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.persist(path).map_err(|e| failed(e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.bin");
        write(&path, b"one").expect("written");
        write(&path, b"two").expect("overwritten");
        assert_eq!(read(&path).expect("read"), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
    }

    #[test]
    fn a_missing_folder_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("none").join("a.png");
        let error = write(&path, b"x").expect_err("no such folder");
        assert!(error.to_string().contains("a.png"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_what_the_umask_lets_them() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let ours = folder.path().join("ours");
        let plain = folder.path().join("plain");
        write(&ours, b"x").expect("written");
        std::fs::write(&plain, b"x").expect("written");
        let mode = |path| std::fs::metadata(path).expect("there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
