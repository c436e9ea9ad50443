//! Which reader a file needs, and its call.

use crate::brep::{Model, recognise_surfaces};
use crate::{iges, step};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Why a file cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// It cannot be read.
    #[error("cannot read {path}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// It is of no format we know.
    #[error("{path}: {what}")]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it is, and what to do.
        what: String,
    },
    /// The STEP reader refuses it.
    #[error("{path}: {source}")]
    Step {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: step::StepError,
    },
    /// The IGES reader refuses it.
    #[error("{path}: {source}")]
    Iges {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: iges::IgesError,
    },
}

/// What a file's first bytes say it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Step,
    Iges,
    Gzip,
    Zip,
    Unknown,
}

/// Reads a CAD file of any known format; its contents decide, not its name. B-spline surfaces that are elementary become so.
pub fn import(path: &Path) -> Result<Model, ImportError> {
    Ok(Source::open(path)?.scan()?.map())
}

/// A file in memory.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    size: usize,
    /// In the encoding that its reader scans.
    bytes: Vec<u8>,
}

/// A file whose statements or records are known, and none of which is decoded yet.
pub enum Scanned<'a> {
    /// STEP.
    Step(step::Index<'a>),
    /// IGES.
    Iges(iges::Scanned<'a>),
}

fn read(path: &Path) -> Result<Vec<u8>, ImportError> {
    std::fs::read(path).map_err(|source| ImportError::Io { path: path.to_owned(), source })
}

impl Source {
    /// Reads the file.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        Ok(Self::new(path, read(path)?))
    }

    /// Reads the file, and tells the BLAKE3 hash of its bytes.
    pub fn open_hashed(path: &Path) -> Result<(Self, [u8; 32]), ImportError> {
        let bytes = read(path)?;
        let hash = blake3::hash(&bytes).into();
        Ok((Self::new(path, bytes), hash))
    }

    fn new(path: &Path, bytes: Vec<u8>) -> Self {
        Self { path: path.to_owned(), size: bytes.len(), bytes: plain(bytes) }
    }

    /// The file's length in bytes.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Finds out the format and where everything is.
    pub fn scan(&self) -> Result<Scanned<'_>, ImportError> {
        let path = || self.path.clone();
        let unsupported = |what: &str| Err(ImportError::Unsupported { path: path(), what: what.to_owned() });
        match sniff(&self.bytes) {
            Format::Step => step::scan(&self.bytes)
                .map(Scanned::Step)
                .map_err(|source| ImportError::Step { path: path(), source }),
            Format::Iges => iges::scan(&self.bytes)
                .map(Scanned::Iges)
                .map_err(|source| ImportError::Iges { path: path(), source }),
            Format::Gzip => unsupported("the file is compressed with gzip; unpack it first"),
            Format::Zip => unsupported("the file is a zip archive; unpack it first"),
            Format::Unknown => unsupported("neither STEP nor IGES: it begins as neither"),
        }
    }
}

impl Scanned<'_> {
    /// Decodes what the mapping would, on its own and once, and makes nothing of it; returns how many entities. For measurements: the
    /// mapping decodes for itself, whatever it reaches.
    pub fn decode(&self) -> usize {
        match self {
            Self::Step(index) => step::decode_shape(index),
            Self::Iges(scanned) => iges::decode_all(scanned),
        }
    }

    /// Makes the model.
    pub fn map(self) -> Model {
        let mut model = match self {
            Self::Step(index) => step::map(index),
            Self::Iges(scanned) => iges::map(scanned),
        };
        recognise_surfaces(&mut model);
        model
    }
}

/// The file in the encoding that its reader scans; most files are that as they are.
fn plain(bytes: Vec<u8>) -> Vec<u8> {
    let plain = match sniff(&bytes) {
        Format::Step => step::utf8(&bytes),
        Format::Iges => iges::plain(&bytes),
        _ => return bytes,
    };
    match plain {
        Cow::Owned(plain) => plain,
        Cow::Borrowed(rest) if rest.len() == bytes.len() => bytes,
        Cow::Borrowed(rest) => rest.to_vec(),
    }
}

fn sniff(bytes: &[u8]) -> Format {
    if step::is_exchange_structure(bytes) {
        Format::Step
    } else if bytes.starts_with(b"\x1F\x8B") {
        Format::Gzip
    } else if bytes.starts_with(b"PK\x03\x04") {
        Format::Zip
    } else if iges::looks_like_iges(bytes) {
        Format::Iges
    } else {
        Format::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_decide() {
        let iges = format!("{:72}S      1\n", "");
        for (bytes, format) in [
            (&b"\xEF\xBB\xBF\r\n/* a */ ISO-10303-21;"[..], Format::Step),
            (iges.as_bytes(), Format::Iges),
            (b"\x1F\x8B\x08", Format::Gzip),
            (b"PK\x03\x04", Format::Zip),
            (b"solid cube", Format::Unknown),
            (b"", Format::Unknown),
        ] {
            assert_eq!(sniff(bytes), format);
        }
    }

    #[test]
    fn a_missing_file_is_an_error() {
        assert!(matches!(import(Path::new("no such file.step")), Err(ImportError::Io { .. })));
    }
}
