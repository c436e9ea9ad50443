//! The list of all curves (LC; Martin, Cohen, Fish and Shirley 2000), without those that a ray to the left cannot cross.

use super::super::region::Region;
use super::Structure;
use super::elements::is_horizontal;
use crate::scene::TrimMethod;

pub(super) fn build(region: &Region, method: TrimMethod) -> Structure {
    let mut list = Structure { words: vec![0, 0], ..Structure::default() };
    for piece in region.pieces.iter().filter(|piece| !is_horizontal(piece)) {
        list.push_element(region, piece, method.has_boxing());
        list.words[1] += 1;
    }
    list
}
