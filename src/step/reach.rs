//! Decoding on its own: everything that shape refers to, each statement once, and nothing made of it.
//!
//! The mapping decodes an entity when it reaches it, so that no decoded file is ever held in memory; what decoding alone
//! costs shows only when it is done for itself.

use super::decode;
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS};
use super::scan::Index;
use super::value::Value;

/// Decodes all statements that bodies and faces refer to, directly or not, and those themselves; returns how many there are.
pub fn decode_shape(index: &Index<'_>) -> usize {
    let bytes = index.bytes;
    let is_shape = |body: &std::ops::Range<usize>| {
        let keyword = decode::upper_case(decode::leading_keyword(&bytes[body.clone()]));
        BODY_KEYWORDS.contains(&&*keyword) || FACE_KEYWORDS.contains(&&*keyword)
    };
    let mut reached = vec![false; index.statements.len()];
    let mut waiting = Vec::new();
    for (at, statement) in index.statements.iter().enumerate() {
        if is_shape(&statement.body) {
            reached[at] = true;
            waiting.push(at);
        }
    }
    let mut decoded = 0;
    while let Some(at) = waiting.pop() {
        let statement = &index.statements[at];
        decoded += 1;
        let is_plain = |keyword: &[u8]| decode::triple(bytes, statement.body.clone(), keyword).is_some();
        if is_plain(b"CARTESIAN_POINT") || is_plain(b"DIRECTION") {
            continue;
        }
        let Ok(entity) = decode::decode(bytes, statement.id, statement.body.clone()) else { continue };
        for_each_reference(entity.records.iter().flat_map(|record| &record.parameters), &mut |id| {
            if let Some(next) = index.position(id)
                && !reached[next]
            {
                reached[next] = true;
                waiting.push(next);
            }
        });
    }
    decoded
}

fn for_each_reference<'v, 'a: 'v>(values: impl Iterator<Item = &'v Value<'a>>, visit: &mut dyn FnMut(u64)) {
    for value in values {
        match value {
            Value::Reference(id) => visit(*id),
            Value::List(inner) | Value::Typed(_, inner) => for_each_reference(inner.iter(), visit),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::scan;

    #[test]
    fn only_what_shape_refers_to_is_decoded() {
        let text = "ISO-10303-21;HEADER;ENDSEC;DATA;#1=ADVANCED_FACE('',(#2),#3,.T.);#2=FACE_BOUND('',#9,.T.);\
                    #3=PLANE('',#4);#4=AXIS2_PLACEMENT_3D('',#5,$,$);#5=CARTESIAN_POINT('',(0.,0.,0.));\
                    #6=CARTESIAN_POINT('',(0.,0.,0.));#7=PRODUCT('a','b',$,(#1));#8=( A(#1) B() );ENDSEC;";
        assert_eq!(decode_shape(&scan(text.as_bytes()).expect("statements")), 5);
    }

    #[test]
    fn circles_end() {
        let text =
            "ISO-10303-21;HEADER;ENDSEC;DATA;#1=CLOSED_SHELL('',(#1,#2));#2=FACE('',((#1,A(#2))));ENDSEC;";
        assert_eq!(decode_shape(&scan(text.as_bytes()).expect("statements")), 2);
    }
}
