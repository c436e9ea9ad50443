//! The header section (ISO 10303-21, clause 8): for people only, nothing depends on it.

use super::decode;
use super::scan::Index;
use crate::brep::Source;

/// Schema and originating system, as far as the header gives them.
pub fn source(index: &Index) -> Source {
    let mut source = Source { format: "STEP".into(), ..Source::default() };
    for record in decode::decode_header(index.bytes, index.header.clone()) {
        match &*record.keyword {
            "FILE_SCHEMA" => {
                let names = record.list(0).iter().filter_map(|v| v.text());
                // The object identifier behind the name, such as `{ 1 0 10303 214 .. }`, is left out.
                let names = names.map(|name| name.split('{').next().unwrap_or_default().trim().to_owned());
                source.schema = names.collect::<Vec<_>>().join(", ");
            }
            // Name, time, authors, organisations, preprocessor, originating system, authorisation.
            "FILE_NAME" => source.originating_system = record.text(5).trim().to_owned(),
            _ => {}
        }
    }
    source
}
