//! The baked layout: flat Pod arrays that are at once the cache file, the memory map and the GPU's buffers.
//!
//! This is the second waist of the chain. Nothing here knows a knot vector, an edge or a file format. A [`Scene`] borrows its
//! arrays, from a [`SceneBuffers`] just baked or from a mapped file; both are checked by [`validate`] before use, a file that has not been changed since once.
//!
//! # Spaces
//!
//! Lengths are millimetres. *World* space is the model's, moved by [`Header::world_anchor`]; *part* space is a part's own, moved so
//! that its box is centred at 0; *face* space is part space moved by [`Face::grid`] grid steps. A position in world and in part
//! space is a pair (grid i32×3, fraction f32×3) meaning `grid · grid_step + fraction`: differences of grids are exact, so a ray
//! reaches the face's own space without loss, wherever the face stands.
//! (u, v) of a face are *normalised*: 0 to 1 over the face's trim window. (u, v) of a net are *local*: 0 to 1 over the net.

mod bytes;
mod edge;
mod layout;
#[cfg(test)]
mod layout_tests;
mod metadata;
mod source;
mod trim;
mod trim_method;
pub mod trim_study;
mod validate;
mod validate_edges;
mod validate_study;
mod validate_trees;
mod validate_trims;

pub use bytes::section_bytes;
pub use edge::{EdgeKind, EdgePiece, NO_FACE};
pub use layout::{
    BvhNode, Face, FaceF64, FaceKind, Header, Instance, InstanceF64, MAX_DEGREE, MAX_TREE_DEPTH, Material,
    NO_MATERIAL, Net, NetLeaf, Part, bend_bound, bend_byte, point_side, primitive,
};
pub use metadata::{EdgeGap, Finding, InstanceInfo, Metadata, PartInfo, Severity};
pub use source::{BodyInfo, FaceInfo};
pub use trim::{Band, TRIM_INSIDE, TrimSegment, trim_word};
pub use trim_method::{TrimMethod, TrimStructure, UnknownTrimMethod};
pub use validate::{InvalidScene, validate};

/// Owned arrays of a scene, as the bake makes them.
#[derive(Debug, Clone, Default)]
pub struct SceneBuffers {
    /// Names, colours' origins, diagnostics: for people.
    pub metadata: Metadata,
    /// Scene-wide numbers.
    pub header: Header,
    /// The BVH over instances first, then one BVH for each part.
    pub bvh_nodes: Vec<BvhNode>,
    /// What the leaves of the BVHs hold: instance indices in the top BVH, then [`primitive`] words.
    pub primitives: Vec<u32>,
    /// Placements.
    pub instances: Vec<Instance>,
    /// Parts with faces.
    pub parts: Vec<Part>,
    /// Faces, grouped by part.
    pub faces: Vec<Face>,
    /// One per face.
    pub face_infos: Vec<FaceInfo>,
    /// Those of the source's parts with faces.
    pub body_infos: Vec<BodyInfo>,
    /// Bézier nets, grouped by face.
    pub nets: Vec<Net>,
    /// Sub-domains of nets.
    pub net_leaves: Vec<NetLeaf>,
    /// Control points of nets, homogeneous, in face space.
    pub net_points: Vec<[f32; 4]>,
    /// Cells and trees of trims, [`trim_word`] words.
    pub trim_nodes: Vec<u32>,
    /// Monotone pieces of trim curves.
    pub trim_segments: Vec<TrimSegment>,
    /// Control points of trim curves: `(w·u, w·v, w)`, normalised parameters.
    pub trim_points: Vec<[f32; 3]>,
    /// Looks.
    pub materials: Vec<Material>,
    /// Pieces of edges, grouped by edge; empty unless asked for.
    pub edge_pieces: Vec<EdgePiece>,
    /// Control points of edge pieces, homogeneous, relative to the piece's anchor.
    pub edge_points: Vec<[f32; 4]>,
    /// Faces in f64; empty unless asked for, else one per face.
    pub faces_f64: Vec<FaceF64>,
    /// Instances in f64; empty unless asked for, else one per instance.
    pub instances_f64: Vec<InstanceF64>,
    /// Control points of nets in f64; empty unless asked for, else one per net point.
    pub net_points_f64: Vec<[f64; 4]>,
}

/// A scene to trace: borrowed arrays, the same as in [`SceneBuffers`].
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub struct Scene<'a> {
    pub metadata: &'a Metadata,
    pub header: &'a Header,
    pub bvh_nodes: &'a [BvhNode],
    pub primitives: &'a [u32],
    pub instances: &'a [Instance],
    pub parts: &'a [Part],
    pub faces: &'a [Face],
    pub face_infos: &'a [FaceInfo],
    pub body_infos: &'a [BodyInfo],
    pub nets: &'a [Net],
    pub net_leaves: &'a [NetLeaf],
    pub net_points: &'a [[f32; 4]],
    pub trim_nodes: &'a [u32],
    pub trim_segments: &'a [TrimSegment],
    pub trim_points: &'a [[f32; 3]],
    pub materials: &'a [Material],
    pub edge_pieces: &'a [EdgePiece],
    pub edge_points: &'a [[f32; 4]],
    pub faces_f64: &'a [FaceF64],
    pub instances_f64: &'a [InstanceF64],
    pub net_points_f64: &'a [[f64; 4]],
}

impl SceneBuffers {
    /// Borrows all arrays.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            metadata: &self.metadata,
            header: &self.header,
            bvh_nodes: &self.bvh_nodes,
            primitives: &self.primitives,
            instances: &self.instances,
            parts: &self.parts,
            faces: &self.faces,
            face_infos: &self.face_infos,
            body_infos: &self.body_infos,
            nets: &self.nets,
            net_leaves: &self.net_leaves,
            net_points: &self.net_points,
            trim_nodes: &self.trim_nodes,
            trim_segments: &self.trim_segments,
            trim_points: &self.trim_points,
            materials: &self.materials,
            edge_pieces: &self.edge_pieces,
            edge_points: &self.edge_points,
            faces_f64: &self.faces_f64,
            instances_f64: &self.instances_f64,
            net_points_f64: &self.net_points_f64,
        }
    }
}

impl Scene<'_> {
    /// Whether the f64 arrays are there.
    pub fn has_f64(&self) -> bool {
        self.faces_f64.len() == self.faces.len()
            && self.instances_f64.len() == self.instances.len()
            && self.net_points_f64.len() == self.net_points.len()
    }
}
