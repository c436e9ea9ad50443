//! The kernels: WGSL files put together, one pipeline for each entry file, specialisation and grouping.
//!
//! A source text is a generated prelude of constants, `types.wgsl`, an entry file with the bindings and entry points, and the
//! function files, which are the twins of `render/cpu`. WGSL does not mind the order of declarations, so nothing is ever included
//! from within. The prelude states what a scene needs: the nets' degrees, in fours, size the local arrays, and a kind of surface that
//! a scene lacks is a constant `false` that the driver removes with all that hangs on it. So is the search cell by cell where less exactness is asked for.

use super::{Gpu, GpuError, GpuScene, Grouping};
use crate::render::Exactness;
use crate::render::cpu::trace::Certainty;
use crate::render::cpu::{bsdf, light, path, pixels, section, shade_rays};
use crate::render::gpu::buffers::SCENE_BINDINGS;
use crate::render::section::MAX_PLANES;
use crate::scene::{
    Band, Face, FaceKind, Header, Instance, MAX_DEGREE, MAX_TREE_DEPTH, Material, NO_MATERIAL, TRIM_INSIDE,
    TrimMethod, TrimSegment, TrimStructure, primitive, trim_study, trim_word,
};
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::{Mutex, PoisonError};

/// Elements of one dispatch of a software device at most: also that many narrow workgroups are allowed.
const MOST_SOFTWARE_ELEMENTS: usize = 65_472;
/// The same of a hardware device: more than the largest keeps in flight, and tenths of a second on a slow one.
pub(super) const MOST_HARDWARE_ELEMENTS: usize = 1 << 19;

/// An entry file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Entry {
    /// Pictures.
    Render,
    /// Path-traced pictures.
    Paths,
    /// Hits of given rays.
    Probe,
    /// Whether given points are inside trims.
    Trim,
}

impl Entry {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Render, Self::Paths, Self::Probe, Self::Trim];

    /// The name of its file and of its only entry point.
    fn name(self) -> &'static str {
        match self {
            Self::Render => "render",
            Self::Paths => "paths",
            Self::Probe => "probe",
            Self::Trim => "trim",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Render => concat!(
                include_str!("../../../shaders/entry/render.wgsl"),
                include_str!("../../../shaders/entry/pixel.wgsl"),
                include_str!("../../../shaders/entry/sight.wgsl")
            ),
            Self::Paths => concat!(
                include_str!("../../../shaders/entry/paths.wgsl"),
                include_str!("../../../shaders/entry/path.wgsl"),
                include_str!("../../../shaders/entry/environment.wgsl"),
                include_str!("../../../shaders/entry/sight.wgsl")
            ),
            Self::Probe => include_str!("../../../shaders/entry/probe.wgsl"),
            Self::Trim => include_str!("../../../shaders/entry/trim.wgsl"),
        }
    }

    /// The storage buffers of group 1 after the uniform of binding 0; whether each is only read.
    fn storage_is_read_only(self) -> &'static [bool] {
        match self {
            Self::Render => &[true, false, false, false],
            Self::Paths => &[true, true, false, false],
            Self::Probe => &[true, false, false],
            Self::Trim => &[true, false],
        }
    }
}

/// The function files: name and text.
pub const FUNCTION_FILES: [(&str, &str); 23] = [
    ("elementary", include_str!("../../../shaders/elementary.wgsl")),
    ("frames", include_str!("../../../shaders/frames.wgsl")),
    ("ray_space", include_str!("../../../shaders/ray_space.wgsl")),
    ("bvh", include_str!("../../../shaders/bvh.wgsl")),
    ("analytic", include_str!("../../../shaders/analytic.wgsl")),
    ("torus", include_str!("../../../shaders/torus.wgsl")),
    ("bernstein", include_str!("../../../shaders/bernstein.wgsl")),
    ("planes", include_str!("../../../shaders/planes.wgsl")),
    ("slab", include_str!("../../../shaders/slab.wgsl")),
    ("isolate", include_str!("../../../shaders/isolate.wgsl")),
    ("footprint", include_str!("../../../shaders/footprint.wgsl")),
    ("net", include_str!("../../../shaders/net.wgsl")),
    ("trim", include_str!("../../../shaders/trim.wgsl")),
    ("trim_curve", include_str!("../../../shaders/trim_curve.wgsl")),
    ("trim_study", include_str!("../../../shaders/trim_study.wgsl")),
    ("cover", include_str!("../../../shaders/cover.wgsl")),
    ("trace", include_str!("../../../shaders/trace.wgsl")),
    ("hit", include_str!("../../../shaders/hit.wgsl")),
    ("camera", include_str!("../../../shaders/camera.wgsl")),
    ("section", include_str!("../../../shaders/section.wgsl")),
    ("shade", include_str!("../../../shaders/shade.wgsl")),
    ("sobol", include_str!("../../../shaders/sobol.wgsl")),
    ("bsdf", include_str!("../../../shaders/bsdf.wgsl")),
];

/// Function files of path-traced pictures alone, as in [`FUNCTION_FILES`].
pub const PATH_FILES: [(&str, &str); 2] = [
    ("path", include_str!("../../../shaders/entry/path.wgsl")),
    ("environment", include_str!("../../../shaders/entry/environment.wgsl")),
];

/// What a scene asks of the kernels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Specialisation {
    /// Groups of four basis functions that the highest degree of a net asks for; it sizes the local arrays.
    pub net_chunks: u32,
    /// As in [`Header`].
    pub feature_mask: u32,
    /// Decides whether the kernel has the search cell by cell at all.
    pub exactness: Exactness,
    /// What trim queries search in: a kernel knows one structure.
    pub trim_structure: TrimStructure,
    /// Whether curves of that structure have slabs.
    pub trim_boxing: bool,
    /// Whether rays are cut by planes; only in pictures.
    pub section: bool,
}

impl Specialisation {
    /// That of a scene. Where there is no net, one kernel serves every exactness.
    pub fn of(header: &Header, exactness: Exactness) -> Self {
        let method = TrimMethod::from_number(header.trim_method).unwrap_or_default();
        let asked = Self {
            net_chunks: header.max_net_degree / 4 + 1,
            feature_mask: header.feature_mask,
            exactness,
            trim_structure: match method.structure() {
                // They differ in how the bake cuts curvesets.
                TrimStructure::KdCurvesetsSf19 => TrimStructure::KdCurvesets,
                structure => structure,
            },
            trim_boxing: method.has_boxing(),
            section: false,
        };
        if asked.has(FaceKind::Nets) { asked } else { Self { exactness: Exactness::default(), ..asked } }
    }

    /// One of a few that serve all scenes: for devices that take longer to compile a kernel than a leaner one saves.
    #[must_use]
    pub fn widened(self) -> Self {
        let nets = 1 << FaceKind::Nets as u32;
        let others: u32 = KINDS.iter().map(|(_, kind)| 1 << *kind as u32).sum::<u32>() - nets;
        Self {
            net_chunks: if self.net_chunks <= 4 { 4 } else { MAX_DEGREE / 4 + 1 },
            feature_mask: others | self.feature_mask & nets,
            ..self
        }
    }

    fn has(&self, kind: FaceKind) -> bool {
        self.feature_mask >> kind as u32 & 1 == 1
    }
}

/// Turns after which Mesa's software renderer ends all loops.
const LOOP_TURNS: u32 = 65_535;
/// Those in which an invocation that has used up its turns leaves the loops that it is in, and enters those on its way out once each: more than the kernels
/// have loops.
const LAST_TURNS: u32 = 100;

/// What stands instead of an answer where a kernel ran out of loop turns: what stood there before.
pub(super) const INCOMPLETE: u32 = 0;

/// The text of a kernel for Mesa's software renderer: it counts the turns of its loops, and has no uniform buffers.
///
/// Mesa's software renderer ends all loops, without a word, after 65,535 turns in total. Hits found by then are not all hits, so its kernels
/// keep count, end them themselves before that and say so. The invocations of a workgroup may share the limit, whose turns fall on different times: of a
/// wide one each has a sixty-fourth for certain, of a narrow one all; and one that has used up its own must not go on with that of others, whose
/// hits would be lost without a word. Loops that the compiler unrolls are free, but it makes some of its own, and lanes without an invocation may run
/// along: so the count alone is not enough, and a last loop (`was_cut`) at the end of the kernel, or of each ray, tells whether loops go on still.
///
/// What a branch finds in a uniform buffer that renderer takes for a constant of the kernel, which it then compiles anew for each value: half a
/// minute for each scene and each sample. It reads them as storage buffers instead.
pub fn software_source(entry: Entry, specialisation: &Specialisation, grouping: Grouping) -> String {
    let mut text = String::new();
    for line in kernel_text(entry, specialisation, grouping, true).lines() {
        let trimmed = line.trim_start();
        let opens_loop = ["for (", "while ", "loop {"].iter().any(|start| trimmed.starts_with(start));
        if opens_loop && line.ends_with('{') {
            // The turn that finds the loop's end counts too.
            let _ = writeln!(text, "turns += 1u;\n{line}\nturns += 1u;\nif turns > MOST_TURNS {{ break; }}");
        } else {
            let _ = writeln!(text, "{line}");
        }
    }
    text.replace("var<uniform>", "var<storage, read>")
}

/// The whole text of a kernel.
pub fn source(entry: Entry, specialisation: &Specialisation, grouping: Grouping) -> String {
    kernel_text(entry, specialisation, grouping, false)
}

fn kernel_text(entry: Entry, specialisation: &Specialisation, grouping: Grouping, software: bool) -> String {
    let mut text = prelude(specialisation, grouping, software);
    text.push_str(include_str!("../../../shaders/types.wgsl"));
    text.push_str(include_str!("../../../shaders/entry/scene.wgsl"));
    text.push_str(entry.text());
    for (_, functions) in FUNCTION_FILES {
        text.push_str(functions);
    }
    text
}

/// The constants that Rust owns.
fn prelude(specialisation: &Specialisation, grouping: Grouping, software: bool) -> String {
    let lanes = grouping.lanes(software);
    let words: [(&str, u32); 63] = [
        ("WORKGROUP_SIZE", lanes),
        ("MOST_TURNS", LOOP_TURNS / lanes - LAST_TURNS),
        ("CHUNKS", specialisation.net_chunks),
        ("REVERSED", Face::REVERSED),
        ("ALONE", Face::ALONE),
        ("CLOSED", Face::CLOSED),
        ("UNCUT", Instance::UNCUT),
        ("MAX_PLANES", MAX_PLANES as u32),
        ("MAX_SETTLED", section::MAX_SETTLED as u32),
        ("NO_PLANE", section::NO_PLANE),
        ("HATCH_TURN_COUNT", section::HATCH_TURNS.len() as u32),
        ("NO_MATERIAL", NO_MATERIAL),
        ("TRIM_INSIDE", TRIM_INSIDE),
        ("NET_LEAF_BIT", primitive::NET_LEAF_BIT),
        ("FALLS", TrimSegment::FALLS),
        ("RATIONAL", TrimSegment::RATIONAL),
        ("OFFSET_MASK", TrimSegment::OFFSET_MASK),
        ("HEADER_WORDS", trim_word::HEADER_WORDS as u32),
        ("PLANE_STEPS", trim_word::PLANE_STEPS),
        ("FAR", trim_word::FAR),
        ("MAX_SEGMENT", trim_word::MAX_SEGMENT),
        ("MAX_OFFSET", trim_word::MAX_OFFSET),
        ("SHORT", trim_word::SHORT),
        ("MAX_SHORT_SEGMENT", trim_word::MAX_SHORT_SEGMENT),
        ("MAX_SHORT_OFFSET", trim_word::MAX_SHORT_OFFSET),
        ("WIDTH_BIAS", Band::WIDTH_BIAS),
        ("BY_V", Band::BY_V),
        ("INCOMPLETE_PIXEL", pixels::INCOMPLETE),
        ("SEE_THROUGH", pixels::SEE_THROUGH),
        ("CAP", pixels::CAP),
        ("BESIDE_LEFT", pixels::BESIDE_LEFT),
        ("BESIDE_ALL", pixels::BESIDE_ALL),
        ("START", path::START),
        ("PATH", path::PATH),
        ("SHADOW", path::SHADOW),
        ("CATCHER", path::CATCHER),
        ("DONE", path::DONE),
        ("MAX_PASSED", path::MAX_PASSED),
        ("SURE_BOUNCES", path::SURE_BOUNCES),
        ("CERTAIN", Certainty::Certain as u32),
        ("OWN", Certainty::Own as u32),
        ("NEAR_BORDER", Certainty::Border as u32),
        ("STACK_SIZE", MAX_TREE_DEPTH as u32),
        ("FAST", Exactness::Fast as u32),
        ("BALANCED", Exactness::Balanced as u32),
        ("EXACT", Exactness::Exact as u32),
        ("EXACTNESS", specialisation.exactness as u32),
        ("LIST", TrimStructure::List as u32),
        ("SLABS", TrimStructure::Slabs as u32),
        ("KD_CURVESETS", TrimStructure::KdCurvesets as u32),
        ("PACKED", TrimStructure::Packed as u32),
        ("TRIM_STRUCTURE", specialisation.trim_structure as u32),
        ("RECORD_WORDS", trim_study::RECORD_WORDS as u32),
        ("KD_HEADER", trim_study::KD_HEADER as u32),
        ("ODD_BIT", trim_study::ODD_BIT),
        ("MANY_CURVES", trim_study::MANY_CURVES),
        ("PLACES", trim_study::PLACES),
        ("STUDY_LEAF", trim_study::STUDY_LEAF),
        ("PARITY_BIT", trim_study::PARITY_BIT),
        ("LOW_IS_LEFT", trim_study::LOW_IS_LEFT),
        ("HIGH_IS_LEFT", trim_study::HIGH_IS_LEFT),
        ("NO_INTERVAL", u32::MAX),
        ("SLAB_MASK", trim_study::SLAB_MASK),
    ];
    let mut text = String::new();
    for (name, value) in words {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    let numbers = [
        ("BULGE_STEPS", Band::BULGE_STEPS),
        ("SKEW_STEPS", Band::SKEW_STEPS),
        ("AMBIENT_WEIGHT", light::AMBIENT_WEIGHT),
        ("GLOSS", light::GLOSS),
        ("LEAST_ROUGHNESS", light::LEAST_ROUGHNESS),
        ("METAL_LIGHT", light::METAL_LIGHT),
        ("METAL_BOX", light::METAL_BOX),
        ("DEFAULT_ROUGHNESS", Material::DEFAULT_ROUGHNESS),
        ("SPECULAR_REFLECTANCE", light::SPECULAR_REFLECTANCE),
        ("OCCLUSION_RADIUS", light::OCCLUSION_RADIUS as f32),
        ("SURFACE_OFFSET", light::SURFACE_OFFSET as f32),
        ("LEAST_ALPHA", bsdf::LEAST_ALPHA),
        ("DIELECTRIC", bsdf::DIELECTRIC),
        ("SAME_WAY", shade_rays::SAME_WAY),
        ("CLOSE", shade_rays::CLOSE),
        ("OTHER", shade_rays::OTHER),
        ("HATCH_SHARE", section::HATCH_SHARE),
        ("HATCH_LIGHT", section::HATCH_LIGHT),
        ("BEFORE_ONE", trim_study::BEFORE_ONE),
        ("SLAB_STEPS", trim_study::SLAB_STEPS),
    ];
    for (name, value) in numbers {
        let _ = writeln!(text, "const {name}: f32 = {value:e};");
    }
    let colors = [
        ("KEY_COLOR", light::KEY_COLOR),
        ("FILL_COLOR", light::FILL_COLOR),
        ("AMBIENT_UP", light::AMBIENT_UP),
        ("AMBIENT_DOWN", light::AMBIENT_DOWN),
        ("RIM_COLOR", light::RIM_COLOR),
        ("METAL_UP", light::METAL_UP),
        ("METAL_DOWN", light::METAL_DOWN),
    ];
    for (name, [red, green, blue]) in colors {
        let _ = writeln!(text, "const {name} = vec3<f32>({red:e}, {green:e}, {blue:e});");
    }
    let turns = section::HATCH_TURNS.map(|[cos, sin]| format!("vec2<f32>({cos:e}, {sin:e})"));
    let _ = writeln!(text, "const HATCH_TURNS = array<vec2<f32>, {}>({});", turns.len(), turns.join(", "));
    let _ = writeln!(text, "const SHARES_RAYS: bool = {};", grouping == Grouping::Shared);
    let _ = writeln!(text, "const HAS_SECTION: bool = {};", specialisation.section);
    let _ = writeln!(text, "const TRIM_BOXING: bool = {};", specialisation.trim_boxing);
    for (name, kind) in KINDS {
        let _ = writeln!(text, "const {name}: u32 = {}u;", kind as u32);
        let _ = writeln!(text, "const HAS_{name}: bool = {};", specialisation.has(kind));
    }
    let has_carriers = KINDS.iter().any(|&(_, kind)| kind != FaceKind::Nets && specialisation.has(kind));
    let _ = writeln!(text, "const HAS_CARRIERS: bool = {has_carriers};");
    text
}

const KINDS: [(&str, FaceKind); 6] = [
    ("PLANE", FaceKind::Plane),
    ("CYLINDER", FaceKind::Cylinder),
    ("CONE", FaceKind::Cone),
    ("SPHERE", FaceKind::Sphere),
    ("TORUS", FaceKind::Torus),
    ("NETS", FaceKind::Nets),
];

/// Entry file, what the scene asks for, how elements are shared out.
type PipelineKey = (Entry, Specialisation, Grouping);

/// Layouts and the pipelines made so far.
pub(super) struct Kernels {
    pub(super) scene_layout: wgpu::BindGroupLayout,
    entry_layouts: [wgpu::BindGroupLayout; Entry::ALL.len()],
    pipelines: Mutex<HashMap<PipelineKey, wgpu::ComputePipeline>>,
}

impl Kernels {
    pub(super) fn new(device: &wgpu::Device, software: bool) -> Self {
        let constants = |binding| if software { storage(binding, true) } else { uniform(binding) };
        let arrays = SCENE_BINDINGS.len() as u32;
        let mut scene_entries: Vec<_> = (0..arrays).map(|binding| storage(binding, true)).collect();
        scene_entries.push(constants(arrays));
        Self {
            scene_layout: layout(device, "scene", &scene_entries),
            entry_layouts: Entry::ALL.map(|entry| {
                let mut entries = vec![constants(0)];
                entries.extend(
                    (1..).zip(entry.storage_is_read_only()).map(|(binding, &only)| storage(binding, only)),
                );
                layout(device, "entry", &entries)
            }),
            pipelines: Mutex::new(HashMap::new()),
        }
    }

    pub(super) fn entry_layout(&self, entry: Entry) -> &wgpu::BindGroupLayout {
        &self.entry_layouts[entry as usize]
    }
}

impl Gpu {
    /// Elements of one dispatch at most.
    pub(super) fn most_elements(&self) -> usize {
        if self.is_software() { MOST_SOFTWARE_ELEMENTS } else { MOST_HARDWARE_ELEMENTS }
    }

    /// The pipeline of an entry file for a scene, compiled at its first use.
    pub(super) fn pipeline(
        &self,
        entry: Entry,
        scene: &GpuScene<'_>,
        exactness: Exactness,
        section: bool,
        grouping: Grouping,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let of_scene = Specialisation::of(scene.scene.header, exactness);
        let mut specialisation = Specialisation { section, ..of_scene };
        if self.is_software() {
            specialisation = specialisation.widened();
        }
        debug_assert!(grouping != Grouping::Shared || entry == Entry::Probe, "{entry:?} cannot share");
        let key = (entry, specialisation, grouping);
        let entry_point = entry.name();
        let mut pipelines = self.kernels.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(&key) {
            return Ok(pipeline.clone());
        }
        let text = if self.is_software() {
            software_source(entry, &specialisation, grouping)
        } else {
            source(entry, &specialisation, grouping)
        };
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry_point),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        self.check()?;
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(entry_point),
            bind_group_layouts: &[Some(&self.kernels.scene_layout), Some(self.kernels.entry_layout(entry))],
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        self.check()?;
        pipelines.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// Has a kernel run over `count` elements, at most [`Gpu::most_elements`]; [`Gpu::read`] waits for it.
    pub(super) fn dispatch(
        &self,
        pipeline: &wgpu::ComputePipeline,
        scene: &GpuScene<'_>,
        bind_group: &wgpu::BindGroup,
        count: u32,
        grouping: Grouping,
    ) -> Result<(), GpuError> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &scene.bind_group, &[]);
        pass.set_bind_group(1, bind_group, &[]);
        pass.dispatch_workgroups(grouping.workgroups(count, self.is_software()), 1, 1);
        drop(pass);
        let commands = encoder.finish();
        self.check()?;
        self.queue.submit([commands]);
        Ok(())
    }
}

fn layout(
    device: &wgpu::Device,
    label: &str,
    entries: &[wgpu::BindGroupLayoutEntry],
) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
}

fn storage(binding: u32, read_only: bool) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, wgpu::BufferBindingType::Storage { read_only })
}

fn uniform(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, wgpu::BufferBindingType::Uniform)
}

fn buffer(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
