//! Colours: where they come from, which of several counts, and what is invisible.

use super::assembly_tests::placed;
use super::tests::{PRODUCT, cube, model};
use crate::brep::{Color, Model, Severity, occurrences};

const RED: Color = Color::opaque(1.0, 0.0, 0.0);
const GREEN: Color = Color::opaque(0.0, 1.0, 0.0);
const BLUE: Color = Color::opaque(0.0, 0.0, 1.0);

/// A presentation style of number `id` to `id` + 6 for one side.
fn side(id: u32, side: &str, color: &str) -> String {
    format!(
        "#{id}=PRESENTATION_STYLE_ASSIGNMENT((#{b}));#{b}=SURFACE_STYLE_USAGE(.{side}.,#{c});\
         #{c}=SURFACE_SIDE_STYLE('',(#{d}));#{d}=SURFACE_STYLE_FILL_AREA(#{e});#{e}=FILL_AREA_STYLE('',(#{f}));\
         #{f}=FILL_AREA_STYLE_COLOUR('',#{g});#{g}={color};",
        b = id + 1,
        c = id + 2,
        d = id + 3,
        e = id + 4,
        f = id + 5,
        g = id + 6
    )
}

/// Styles #400 red, #410 green, #420 blue.
fn three() -> String {
    side(400, "BOTH", "COLOUR_RGB('',1.,0.,0.)")
        + &side(410, "POSITIVE", "PRE_DEFINED_COLOUR('green')")
        + &side(420, "both", "DRAUGHTING_PRE_DEFINED_COLOUR('Blue')")
}

fn color(model: &Model, entity: u64) -> Option<Color> {
    model.faces.iter().find(|f| f.entity == entity).and_then(|f| f.color)
}

/// The colours of faces #200 and #201 of the cube with these styles.
fn colors(styles: &str) -> [Option<Color>; 2] {
    let model = model(&(cube("#900") + PRODUCT + &three() + styles));
    [200, 201].map(|face| color(&model, face))
}

#[test]
fn the_nearest_colour_counts() {
    assert_eq!(colors(""), [None, None]);
    assert_eq!(colors("#430=STYLED_ITEM('',(#400),#2);"), [Some(RED), Some(RED)]);
    let solid = "#430=STYLED_ITEM('',(#400),#2);#431=STYLED_ITEM('',(#410),#1);";
    assert_eq!(colors(solid), [Some(GREEN), Some(GREEN)]);
    let shell =
        "#430=STYLED_ITEM('',(#400),#1);#431=STYLED_ITEM('',(#410),#3);#432=STYLED_ITEM('',(#420),#200);";
    assert_eq!(colors(shell), [Some(BLUE), Some(GREEN)]);
}

#[test]
fn what_overrides_an_override_counts() {
    // In any order in the file; as a complex instance, too.
    let twice = "#430=OVER_RIDING_STYLED_ITEM('',(#420),#1,#431);#431=OVER_RIDING_STYLED_ITEM('',(#410),#1,#432);\
                 #432=STYLED_ITEM('',(#400),#1);";
    assert_eq!(colors(twice), [Some(BLUE), Some(BLUE)]);
    let complex = "#430=(OVER_RIDING_STYLED_ITEM(#432) REPRESENTATION_ITEM('') STYLED_ITEM((#410),#1));\
                   #432=STYLED_ITEM('',(#400),#1);";
    assert_eq!(colors(complex), [Some(GREEN), Some(GREEN)]);
    let face = "#430=STYLED_ITEM('',(#400),#1);#431=OVER_RIDING_STYLED_ITEM('',(#410),#200,#430);";
    assert_eq!(colors(face), [Some(GREEN), Some(RED)]);
}

#[test]
fn styles_without_a_colour_are_no_styles() {
    let none = "#430=STYLED_ITEM('',(#440),#200);#440=PRESENTATION_STYLE_ASSIGNMENT((NULL_STYLE(.NULL.)));\
                #431=STYLED_ITEM('',(#441,#999),#201);#441=PRESENTATION_STYLE_ASSIGNMENT((#442));\
                #442=CURVE_STYLE('',$,POSITIVE_LENGTH_MEASURE(1.),#406);#432=STYLED_ITEM('',(#410),#1);";
    assert_eq!(colors(none), [Some(GREEN), Some(GREEN)]);
    assert_eq!(colors("#430=STYLED_ITEM('',(#431),#1);#431=COLOUR_SPECIFICATION('red');"), [None, None]);
}

#[test]
fn the_outer_side_goes_before_the_inner_one() {
    let inner = side(450, "NEGATIVE", "COLOUR_RGB('',1.,1.,0.)");
    let both = format!("{inner}#430=STYLED_ITEM('',(#450,#400),#200);#431=STYLED_ITEM('',(#450),#201);");
    assert_eq!(colors(&both), [Some(RED), Some(Color::opaque(1.0, 1.0, 0.0))]);
}

#[test]
fn transparency_is_of_the_rendering() {
    let text = "#430=STYLED_ITEM('',(#440),#1);#440=PRESENTATION_STYLE_ASSIGNMENT((#441));\
                #441=SURFACE_STYLE_USAGE(.BOTH.,#442);#442=SURFACE_SIDE_STYLE('',(#443,#444));\
                #443=SURFACE_STYLE_RENDERING_WITH_PROPERTIES($,#406,(#445));#444=SURFACE_STYLE_FILL_AREA(#404);\
                #445=SURFACE_STYLE_TRANSPARENT(0.75);";
    assert_eq!(colors(text)[0], Some(Color { opacity: 0.25, ..RED }));
}

#[test]
fn occurrences_have_colours_of_their_own() {
    let assembly = placed("#2,#705", "#4,#706") + &three();
    let of_occurrence = |styles: &str| {
        let model = model(&(assembly.clone() + styles));
        (occurrences(&model).0[0].color, color(&model, 200))
    };
    for context in ["#712", "#713"] {
        let text = format!(
            "#430=STYLED_ITEM('',(#400),#1);\
            #431=CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(#410),#1,#430,({context}));"
        );
        assert_eq!(of_occurrence(&text), (Some(GREEN), Some(RED)), "{context}");
    }
    // A face of one occurrence has no place in the model.
    let text = "#431=CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM('',(#410),#200,#430,(#712));";
    let model = model(&(assembly.clone() + text));
    assert_eq!((occurrences(&model).0[0].color, color(&model, 200)), (None, None));
    assert_eq!(
        model.diagnostics.iter().map(|d| (d.entity, d.severity)).collect::<Vec<_>>(),
        [(431, Severity::Note)]
    );
}

#[test]
fn mapped_items_have_colours_of_their_own() {
    let text = cube("#900")
        + &three()
        + "#800=SHAPE_REPRESENTATION('top',(#801,#811),#900);#801=MAPPED_ITEM('left',#802,#4);#802=REPRESENTATION_MAP(#4,#2);\
           #811=MAPPED_ITEM('right',#802,#706);#706=AXIS2_PLACEMENT_3D('',#11,$,$);#430=STYLED_ITEM('',(#420),#811);";
    let colors: Vec<_> = occurrences(&model(&text)).0.iter().map(|o| o.color).collect();
    assert_eq!(colors, [None, Some(BLUE)]);
}

#[test]
fn styles_of_nothing_are_said() {
    let model = model(
        &(cube("#900")
            + PRODUCT
            + &three()
            + "#430=STYLED_ITEM('',(#400),#999);#431=STYLED_ITEM('',(#400),$);"),
    );
    assert_eq!(
        model.diagnostics.iter().map(|d| (d.entity, d.severity)).collect::<Vec<_>>(),
        [(430, Severity::Note)]
    );
    assert!(model.diagnostics[0].reason.starts_with("2 styles"));
}

#[test]
fn layers_and_representations_hide_what_they_hold() {
    for hidden in [
        "#430=PRESENTATION_LAYER_ASSIGNMENT('l','',(#1));#431=INVISIBILITY((#430));",
        "#430=PRESENTATION_LAYER_ASSIGNMENT('l','',(#432));#431=INVISIBILITY((#430));#432=STYLED_ITEM('',(#400),#1);",
        "#431=INVISIBILITY((#2));",
    ] {
        let model = model(&(cube("#900") + PRODUCT + &three() + hidden));
        assert_eq!((model.faces.len(), model.declared_faces), (0, 6), "{hidden}");
    }
    let visible = "#430=PRESENTATION_LAYER_ASSIGNMENT('l','',(#1));#431=INVISIBILITY((#433));";
    assert_eq!(model(&(cube("#900") + PRODUCT + visible)).faces.len(), 6);
}
