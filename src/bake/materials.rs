//! Colours of the file to materials of the scene: linear light, each stored once.

use crate::brep::Color;
use crate::scene::Material;
use std::collections::HashMap;

/// What faces without a colour look like: a light grey with a touch of blue, so that white light still shows form.
const DEFAULT_COLOR: Color = Color::opaque(0.72, 0.75, 0.80);

/// Materials in order of first use.
#[derive(Debug, Default)]
pub(super) struct MaterialTable {
    materials: Vec<Material>,
    index_of: HashMap<[u32; 4], u32>,
}

impl MaterialTable {
    /// The index of the material of `color`; of the default one where there is none.
    pub(super) fn index(&mut self, color: Option<Color>) -> u32 {
        let color = color.unwrap_or(DEFAULT_COLOR);
        let material =
            Material { opacity: unit(color.opacity), ..Material::of_color(color.rgb.map(linear_from_srgb)) };
        let [red, green, blue] = material.rgb.map(f32::to_bits);
        *self.index_of.entry([red, green, blue, material.opacity.to_bits()]).or_insert_with(|| {
            self.materials.push(material);
            (self.materials.len() - 1) as u32
        })
    }

    /// All materials.
    pub(super) fn into_materials(self) -> Vec<Material> {
        self.materials
    }
}

/// `x` held to 0..=1; 0 where it is not a number. Negative zero becomes zero.
fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// IEC 61966-2-1.
fn linear_from_srgb(encoded: f32) -> f32 {
    let x = f64::from(unit(encoded));
    let linear = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_colours_share_a_material() {
        let mut table = MaterialTable::default();
        let red = table.index(Some(Color::opaque(1.0, 0.0, 0.0)));
        let default = table.index(None);
        assert_eq!(table.index(Some(Color::opaque(1.0, -0.0, 0.0))), red);
        assert_eq!(table.index(Some(DEFAULT_COLOR)), default);
        let materials = table.into_materials();
        assert_eq!(materials.len(), 2);
        assert_eq!(materials[red as usize].rgb, [1.0, 0.0, 0.0]);
    }

    #[test]
    fn odd_numbers_become_valid_materials() {
        let mut table = MaterialTable::default();
        table.index(Some(Color { rgb: [f32::NAN, 7.0, -1.0], opacity: f32::INFINITY }));
        assert_eq!(table.into_materials()[0], Material::of_color([0.0, 1.0, 0.0]));
    }

    #[test]
    fn srgb_is_decoded() {
        assert!((linear_from_srgb(0.5) - 0.214_041_14).abs() < 1e-6);
    }
}
