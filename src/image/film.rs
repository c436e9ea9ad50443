//! The film: what a renderer fills, pixel by pixel, top row first.

/// A picture and what each pixel shows. Arrays have `width · height` elements, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Linear-light red, green, blue, premultiplied, and coverage.
    pub color: Vec<[f32; 4]>,
    /// Distance along the view direction at the pixel's centre, millimetres; infinite where nothing is hit.
    pub depth: Vec<f32>,
    /// World-space unit normal towards the viewer; 0 where nothing is hit.
    pub normal: Vec<[f32; 3]>,
    /// 1 + instance index; 0 where nothing is hit.
    pub part: Vec<u32>,
    /// 1 + face index; 0 where nothing is hit.
    pub face: Vec<u32>,
}

impl Film {
    /// An empty picture.
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            color: vec![[0.0; 4]; pixels],
            depth: vec![f32::INFINITY; pixels],
            normal: vec![[0.0; 3]; pixels],
            part: vec![0; pixels],
            face: vec![0; pixels],
        }
    }
}
