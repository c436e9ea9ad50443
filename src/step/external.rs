//! What stands in other files, which are not read: references of edition 3, and documents that hold the shape of a product
//! (external references of AP203, AP214 and AP242). Each file is named once.

use super::catalog::Catalog;
use super::reader::{Problem, Reader};
use super::text;
use crate::brep::Severity;
use std::collections::BTreeMap;

/// Ends of the names of files that hold shape; other documents are none of a reader's business.
const SHAPES: [&str; 10] =
    [".stp", ".step", ".stpz", ".p21", ".stpx", ".igs", ".iges", ".jt", ".x_t", ".sat"];

/// Warns of each other file that this one refers to for shape.
pub fn report(reader: &mut Reader, catalog: &Catalog) {
    let mut files: BTreeMap<String, (u64, &str)> = BTreeMap::new();
    for (id, name) in &reader.index.external {
        let name = text::decode(&reader.index.bytes[name.clone()]);
        if !name.is_empty() {
            files.entry(name).or_insert((*id, "REFERENCE"));
        }
    }
    for &id in &catalog.documents {
        let Ok(entity) = reader.entity(id) else { continue };
        let names = entity.records.iter().flat_map(|r| &r.parameters).filter_map(|p| p.text());
        let is_shape = |name: &String| SHAPES.iter().any(|end| name.to_lowercase().ends_with(end));
        for name in names.filter(is_shape) {
            files.entry(name).or_insert((id, "DOCUMENT_FILE"));
        }
    }
    for (name, (entity, kind)) in files {
        let reason = format!("refers to the file '{name}', which is not read");
        reader.report(Severity::Warning, Problem { entity, kind: kind.into(), reason });
    }
}

#[cfg(test)]
mod tests {
    use crate::step::read;

    #[test]
    fn other_files_are_named_once() {
        let text = "ISO-10303-21;HEADER;ENDSEC;REFERENCE;#90=<bolt.stp#a>;#91=<bolt.stp#b>;#92=<#here>;ENDSEC;DATA;\
                    #1=DOCUMENT_FILE('nut.STEP','','',#2,'',$);#2=DOCUMENT_TYPE('');\
                    #3=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('nut.STEP',#4,#5,(#1));\
                    #6=DOCUMENT_FILE('manual.pdf','','',#2,'',$);#7=PRODUCT_DEFINITION_SHAPE('','',#90);\
                    #8=SHAPE_DEFINITION_REPRESENTATION(#7,#91);ENDSEC;END-ISO-10303-21;";
        let model = read(text.as_bytes()).expect("entities");
        let named = model.diagnostics.iter().filter(|d| d.entity != 0);
        let found: Vec<_> = named.map(|d| (d.entity, d.reason.as_str())).collect();
        let expected = [
            (90, "refers to the file 'bolt.stp', which is not read"),
            (1, "refers to the file 'nut.STEP', which is not read"),
        ];
        assert_eq!(found, expected);
    }
}
