//! Product trees: what is placed where, by every mechanism, and by broken ones.

use super::tests::{PRODUCT, cube, model};
use crate::brep::{Severity, occurrences};
use glam::DVec3;

/// An assembly #700 that places the cube's representation #2 at (10, 0, 0), turned a quarter about z.
pub fn placed(relationship: &str, transformation: &str) -> String {
    cube("#900")
        + PRODUCT
        + "#700=PRODUCT('','assembly','',());#701=PRODUCT_DEFINITION_FORMATION('','',#700);\
           #702=PRODUCT_DEFINITION('','',#701,$);#703=PRODUCT_DEFINITION_SHAPE('','',#702);\
           #704=SHAPE_DEFINITION_REPRESENTATION(#703,#705);#705=SHAPE_REPRESENTATION('',(#706),#910);\
           #706=AXIS2_PLACEMENT_3D('',#707,#32,#31);#707=CARTESIAN_POINT('',(10.,0.,0.));\
           #710=NEXT_ASSEMBLY_USAGE_OCCURRENCE('id','first cube','',#702,#502,$);\
           #711=PRODUCT_DEFINITION_SHAPE('','',#710);#712=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#713,#711);"
        + &format!(
            "#713=(REPRESENTATION_RELATIONSHIP('','',{relationship}) REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#714) \
             SHAPE_REPRESENTATION_RELATIONSHIP());#714=ITEM_DEFINED_TRANSFORMATION('','',{transformation});"
        )
}

#[test]
fn occurrences_are_placed_whatever_the_order_of_the_relationship() {
    // Child first, parent first, and parent first with the items left in the order of a child.
    for (relationship, items) in [("#2,#705", "#4,#706"), ("#705,#2", "#706,#4"), ("#705,#2", "#4,#706")] {
        let model = model(&placed(relationship, items));
        assert_eq!(model.diagnostics, []);
        let (found, cut) = occurrences(&model);
        assert!(!cut && found.len() == 1 && model.roots.len() == 1);
        assert_eq!(found[0].path, "assembly/first cube");
        // The parent is in inches, the child in millimetres.
        let point = found[0].world_from_part.transform_point3(DVec3::new(1.0, 0.0, 0.0));
        assert!(point.distance(DVec3::new(254.0, 1.0, 0.0)) < 1e-9, "{relationship}: {point}");
    }
}

#[test]
fn mapped_items_may_mirror_and_scale() {
    let model = model(
        &(cube("#900")
            + "#800=SHAPE_REPRESENTATION('top',(#801,#811),#900);#801=MAPPED_ITEM('left',#802,#706);\
               #802=REPRESENTATION_MAP(#4,#2);#706=AXIS2_PLACEMENT_3D('',#707,$,$);#707=CARTESIAN_POINT('',(10.,0.,0.));\
               #811=MAPPED_ITEM('right',#802,#812);#812=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,#30,#813,#707,2.,#32);\
               #813=DIRECTION('',(0.,-1.,0.));"),
    );
    let (found, _) = occurrences(&model);
    let points: Vec<DVec3> = found.iter().map(|o| o.world_from_part.transform_point3(DVec3::ONE)).collect();
    assert_eq!(points, [DVec3::new(11.0, 1.0, 1.0), DVec3::new(12.0, -2.0, 2.0)]);
    assert_eq!((model.roots.len(), model.faces.len()), (1, 6));
}

#[test]
fn circles_of_placements_end() {
    let model = model(
        &(cube("#900").replace("(#1,#4)", "(#1,#4,#801)")
            + "#800=SHAPE_REPRESENTATION('b',(#811,#4),#900);#801=MAPPED_ITEM('',#802,#4);\
               #802=REPRESENTATION_MAP(#4,#800);#811=MAPPED_ITEM('',#812,#4);#812=REPRESENTATION_MAP(#4,#2);"),
    );
    assert_eq!(model.roots.len(), 1);
    assert!(occurrences(&model).1);
}

/// An assembly with the parts of [`placed`], without what places one in the other.
fn unplaced() -> String {
    let text = placed("#2,#705", "#4,#706");
    let (start, end) =
        (text.find("#712=").expect("a placement"), text.find("#713=").expect("a relationship"));
    text.replace(&text[start..end], "").split("#713=").next().expect("a beginning").to_owned()
}

#[test]
fn occurrences_without_a_placement_stand_at_the_origin() {
    let model = model(&unplaced());
    let (found, _) = occurrences(&model);
    assert_eq!((found.len(), found[0].path.as_str()), (1, "assembly/first cube"));
    assert_eq!(found[0].world_from_part.transform_point3(DVec3::X), DVec3::X);
    let warnings = model.diagnostics.iter().filter(|d| d.severity == Severity::Warning);
    assert_eq!(warnings.map(|d| d.entity).collect::<Vec<_>>(), [710]);
}

#[test]
fn a_mapped_item_places_an_occurrence_too() {
    let text = unplaced()
        .replace("#705=SHAPE_REPRESENTATION('',(#706)", "#705=SHAPE_REPRESENTATION('',(#706,#720)")
        + "#720=MAPPED_ITEM('',#721,#706);#721=REPRESENTATION_MAP(#4,#2);";
    let model = model(&text);
    assert_eq!(model.diagnostics, []);
    assert_eq!(occurrences(&model).0.len(), 1);
}

#[test]
fn occurrences_of_other_kinds() {
    // A quantified one as a complex instance; and one of a component of a component, which places nothing.
    let complex = "#710=(ASSEMBLY_COMPONENT_USAGE($) NEXT_ASSEMBLY_USAGE_OCCURRENCE() \
                   PRODUCT_DEFINITION_RELATIONSHIP('id','first cube','',#702,#502) PRODUCT_DEFINITION_USAGE() \
                   QUANTIFIED_ASSEMBLY_COMPONENT_USAGE(#719));";
    let text = placed("#2,#705", "#4,#706")
        .replace("#710=NEXT_ASSEMBLY_USAGE_OCCURRENCE('id','first cube','',#702,#502,$);", complex)
        + "#730=SPECIFIED_HIGHER_USAGE_OCCURRENCE('','','',#702,#502,$,#710,#710);#731=PRODUCT_DEFINITION_SHAPE('','',#730);\
           #732=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#713,#731);";
    let model = model(&text);
    let (found, _) = occurrences(&model);
    assert_eq!((found.len(), found[0].path.as_str()), (1, "assembly/first cube"));
    assert_eq!(model.diagnostics, []);
}

#[test]
fn invisible_occurrences_are_nowhere() {
    let hidden = [
        placed("#2,#705", "#4,#706")
            + "#750=CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(),#2,$,(#712));#751=INVISIBILITY((#750));",
        unplaced().replace("(#706),#910", "(#706,#720),#910")
            + "#720=MAPPED_ITEM('',#721,#706);#721=REPRESENTATION_MAP(#4,#2);#722=STYLED_ITEM('',(),#720);\
               #723=INVISIBILITY((#722));",
    ];
    for text in hidden {
        let model = model(&text);
        assert_eq!((model.faces.len(), occurrences(&model).0.len(), model.hidden_parts.len()), (6, 0, 1));
        assert_eq!(model.diagnostics.iter().map(|d| d.kind.as_str()).collect::<Vec<_>>()[0], "INVISIBILITY");
    }
}

#[test]
fn billions_of_instances_are_cut() {
    // Ten levels of ten mapped items each.
    let mut text = cube("#900") + "#706=AXIS2_PLACEMENT_3D('',#10,$,$);";
    let mut below = 2;
    for level in 0..10 {
        let (map, whole) = (1000 + 100 * level, 1001 + 100 * level);
        let items: Vec<u32> = (0..10).map(|i| map + 10 + 2 * i).collect();
        let list = items.iter().map(|item| format!("#{item}")).collect::<Vec<_>>().join(",");
        text += &format!(
            "#{map}=REPRESENTATION_MAP(#706,#{below});#{whole}=SHAPE_REPRESENTATION('',({list}),#900);"
        );
        for (i, item) in items.iter().enumerate() {
            let place = item + 1;
            text += &format!(
                "#{item}=MAPPED_ITEM('',#{map},#{place});#{place}=AXIS2_PLACEMENT_3D('',#{},$,$);\
                 #{}=CARTESIAN_POINT('',({i}.,{level}.,0.));",
                place + 5000,
                place + 5000
            );
        }
        below = whole;
    }
    let model = model(&text);
    let (found, cut) = occurrences(&model);
    assert!(cut && found.len() <= 4_000_000);
    assert_eq!(model.roots.len(), 1);
}
