//! Which reader a file needs, and its call.

use crate::brep::{Model, recognise_surfaces};
use crate::{iges, step};
use std::path::Path;

/// Why a file cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// It cannot be read.
    #[error("cannot read {path}")]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// It is of no format we know.
    #[error("{path}: {what}")]
    Unsupported {
        /// The file.
        path: std::path::PathBuf,
        /// What it is, and what to do.
        what: String,
    },
    /// The STEP reader refuses it.
    #[error("{path}: {source}")]
    Step {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        #[source]
        source: step::StepError,
    },
    /// The IGES reader refuses it.
    #[error("{path}: {source}")]
    Iges {
        /// The file.
        path: std::path::PathBuf,
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
    let bytes = std::fs::read(path).map_err(|source| ImportError::Io { path: path.to_owned(), source })?;
    let unsupported =
        |what: &str| Err(ImportError::Unsupported { path: path.to_owned(), what: what.to_owned() });
    let model = match sniff(&bytes) {
        Format::Step => {
            step::read(&bytes).map_err(|source| ImportError::Step { path: path.to_owned(), source })
        }
        Format::Iges => {
            iges::read(&bytes).map_err(|source| ImportError::Iges { path: path.to_owned(), source })
        }
        Format::Gzip => unsupported("the file is compressed with gzip; unpack it first"),
        Format::Zip => unsupported("the file is a zip archive; unpack it first"),
        Format::Unknown => unsupported("neither STEP nor IGES: it begins as neither"),
    };
    model.map(|mut model| {
        recognise_surfaces(&mut model);
        model
    })
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
