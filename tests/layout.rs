//! The two texts of the kernels agree where it can be read off: records field by field, functions by name; and every text compiles.
#![cfg(feature = "gpu")]

use naga::{Module, TypeInner};
use std::mem::{offset_of, size_of};
use trimray::render::Exactness;
use trimray::render::gpu::{
    Entry, FUNCTION_FILES, Grouping, PATH_FILES, Specialisation, software_source, source,
};
use trimray::scene::{self, TrimStructure};

const EXACT: Exactness = Exactness::Exact;

/// What the others change.
const WIDE: Specialisation = Specialisation {
    net_chunks: 1,
    feature_mask: 0b11_1111,
    exactness: EXACT,
    trim_structure: TrimStructure::Packed,
    trim_boxing: false,
    section: false,
};

/// All kinds, planes alone, one analytic kind, nets alone, nothing; degrees low and high; less exactness; each trim structure.
const SPECIALISATIONS: [Specialisation; 13] = [
    Specialisation { net_chunks: 1, feature_mask: 0b11_1111, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 7, feature_mask: 0b11_1111, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 1, feature_mask: 0b00_0001, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 1, feature_mask: 0b01_0000, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 2, feature_mask: 0b10_0000, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 1, feature_mask: 0, exactness: EXACT, ..WIDE },
    Specialisation { net_chunks: 1, feature_mask: 0b10_0000, exactness: Exactness::Fast, ..WIDE },
    Specialisation { net_chunks: 1, feature_mask: 0b10_0000, exactness: Exactness::Balanced, ..WIDE },
    Specialisation { trim_structure: TrimStructure::List, trim_boxing: true, ..WIDE },
    Specialisation { trim_structure: TrimStructure::Slabs, ..WIDE },
    Specialisation { trim_structure: TrimStructure::KdCurves, trim_boxing: true, ..WIDE },
    Specialisation { trim_structure: TrimStructure::KdCurvesets, trim_boxing: true, ..WIDE },
    Specialisation { section: true, ..WIDE },
];

fn parse(entry: Entry, specialisation: &Specialisation, grouping: Grouping) -> Module {
    let text = source(entry, specialisation, grouping);
    naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)))
}

fn wgsl_layout(module: &Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: TypeInner::Struct { members, span }, .. })) = found else {
        panic!("no WGSL struct {name}")
    };
    let fields = members
        .iter()
        .map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize))
        .collect();
    (fields, *span as usize)
}

macro_rules! assert_layout {
    ($module:expr, $ty:ident { $($field:ident),* $(,)? }) => {
        let rust = (
            vec![$((stringify!($field).to_owned(), offset_of!(scene::$ty, $field))),*],
            size_of::<scene::$ty>(),
        );
        assert_eq!(rust, wgsl_layout($module, stringify!($ty)), stringify!($ty));
    };
}

#[test]
fn records_agree() {
    let module = &parse(Entry::Probe, &SPECIALISATIONS[0], Grouping::Wide);
    assert_layout!(
        module,
        Instance {
            part_from_world_0,
            part,
            part_from_world_1,
            material,
            part_from_world_2,
            is_translation,
            grid,
            flags,
            fraction,
            radius,
            material_shift,
            reserved_1,
            reserved_2,
        }
    );
    assert_layout!(module, Part { first_node, node_count, first_primitive, primitive_count });
    assert_layout!(
        module,
        Face {
            grid,
            kind,
            x_axis,
            radius_0,
            y_axis,
            radius_1,
            z_axis,
            flags,
            offset,
            material,
            uv_low,
            uv_scale,
            period,
            trim_root,
            part,
            slack,
            body,
            reserved,
        }
    );
    assert_layout!(module, Net { first_point, degrees, face, reserved, uv_low, uv_size });
    assert_layout!(
        module,
        NetLeaf {
            center,
            extent_n,
            tangent_u,
            extent_u,
            tangent_v,
            extent_v,
            certificate,
            domain,
            net,
            trim,
        }
    );
    assert_layout!(module, TrimSegment { low, high, band, curve });
    assert_layout!(module, Material { rgb, opacity, roughness, metallic, reserved });
}

/// `e` and `imask`, three bytes and one, are the one word `e_imask` in WGSL.
#[test]
fn bvh_node_agrees() {
    let module = &parse(Entry::Probe, &SPECIALISATIONS[0], Grouping::Wide);
    let (mut fields, size) = wgsl_layout(module, "BvhNode");
    assert_eq!(fields.remove(1), ("e_imask".to_owned(), offset_of!(scene::BvhNode, e)));
    assert_eq!(offset_of!(scene::BvhNode, imask), offset_of!(scene::BvhNode, e) + 3);
    macro_rules! rust_fields {
        ($($field:ident),*) => { vec![$((stringify!($field).to_owned(), offset_of!(scene::BvhNode, $field))),*] };
    }
    let rust = rust_fields!(
        p,
        child_base,
        primitive_base,
        child_meta,
        child_min_x,
        child_max_x,
        child_min_y,
        child_max_y,
        child_min_z,
        child_max_z
    );
    assert_eq!((fields, size), (rust, size_of::<scene::BvhNode>()));
}

#[test]
fn kernels_validate() {
    let all = Entry::ALL.into_iter().flat_map(|entry| [(entry, Grouping::Narrow), (entry, Grouping::Wide)]);
    for (entry, grouping) in all.chain([(Entry::Probe, Grouping::Shared)]) {
        for specialisation in &SPECIALISATIONS {
            let text = software_source(entry, specialisation, grouping);
            naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
            let module = parse(entry, specialisation, grouping);
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap_or_else(|error| panic!("{entry:?} {specialisation:?}: {error:?}"));
            assert!(!module.entry_points.is_empty(), "{entry:?} has no entry point");
        }
    }
}

/// What only the shaders need: tests that the twin writes in place, loops of the twin that are one loop here, reads of arrays by index, and
/// what WGSL's built-ins do not give; and what keeps vectors out of memory.
const WITHOUT_TWIN: [&str; 26] = [
    "advance",
    "add_search",
    "search_from",
    "apply_axes",
    "control_point",
    "moved_point",
    "four_points",
    "real_atan2",
    "real_sin_cos",
    "is_finite",
    "signum",
    "along_axis",
    "count_along",
    "with_count_along",
    "no_roots",
    "certainty_of",
    "next_root",
    "bvh_node",
    "cubic_basis",
    "cubic_jet",
    "start_leaf",
    "search_leaf",
    "world_boxes",
    "carrier_ray",
    "face_place",
    "leaf_place",
];

/// A file's functions stand in the Rust file of the same stem, but for the methods that became functions.
#[test]
fn functions_have_twins() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/cpu");
    let read =
        |stem: &str| std::fs::read_to_string(folder.join(stem).with_extension("rs")).unwrap_or_default();
    // Unpacking functions stand beside the records.
    let scene = |name: &str| std::fs::read_to_string(folder.join("../../scene").join(name)).unwrap();
    let mut rust = scene("layout.rs") + &scene("trim.rs");
    for entry in std::fs::read_dir(&folder).unwrap() {
        rust.push_str(&std::fs::read_to_string(entry.unwrap().path()).unwrap());
    }
    let mut checked = 0;
    for (stem, text) in FUNCTION_FILES.into_iter().chain(PATH_FILES) {
        assert!(stem == "elementary" || !read(stem).is_empty(), "shaders/{stem}.wgsl has no twin");
        for line in text.lines() {
            let Some(rest) = line.strip_prefix("fn ") else { continue };
            let name = rest.split('(').next().unwrap_or_default();
            let found = [format!("fn {name}("), format!("fn {name}<")].iter().any(|text| rust.contains(text));
            assert!(found || WITHOUT_TWIN.contains(&name), "`{name}` of shaders/{stem}.wgsl has no twin");
            checked += 1;
        }
    }
    assert!(checked > 60, "{checked} functions checked");
}
