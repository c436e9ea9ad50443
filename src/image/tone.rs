//! From the light of a scene to the light of a screen: tone mapping. For pictures alone; EXR files keep the scene's light.

use super::Film;

/// How light that is brighter than a screen is brought down to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ToneMapping {
    /// It is cut off.
    #[default]
    None,
    /// Khronos PBR Neutral: colours up to 0.8 stay as they are but for a little contrast in the dark, highlights are pressed and lose their
    /// colour.
    Neutral,
    /// AgX of Troy Sobotka, as Blender, Filament and three.js have it: film-like, soft in the light, colours fade as they get bright.
    Agx,
}

impl ToneMapping {
    /// The light of the screen, of 0 to 1, for linear light with the primaries of sRGB.
    pub fn map(self, light: [f32; 3]) -> [f32; 3] {
        match self {
            Self::None => light,
            Self::Neutral => neutral(light),
            Self::Agx => agx(light),
        }
    }
}

impl Film {
    /// Brightens the light by `exposure`, in powers of two, and maps it to that of a screen. Coverage stays.
    pub fn develop(&mut self, tones: ToneMapping, exposure: f32) {
        let factor = exposure.exp2();
        for [red, green, blue, alpha] in &mut self.color {
            if *alpha > 0.0 {
                let mapped = tones.map([*red, *green, *blue].map(|channel| channel * factor / *alpha));
                [*red, *green, *blue] = mapped.map(|channel| channel * *alpha);
            }
        }
    }
}

/// Khronos PBR Neutral Tone Mapper, specification of May 2024, with its constants.
fn neutral(light: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = light.into_iter().fold(f32::INFINITY, f32::min);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = light.map(|channel| channel - offset);
    let peak = color.into_iter().fold(f32::NEG_INFINITY, f32::max);
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let pressed = 1.0 - room * room / (peak + room - START);
    let fade = 1.0 - 1.0 / (DESATURATION * (peak - pressed) + 1.0);
    color.map(|channel| {
        let channel = channel * (pressed / peak);
        channel + (pressed - channel) * fade
    })
}

/// Rows of the matrix from linear light with the primaries of sRGB to that with those of BT.2020.
const REC2020_FROM_SRGB: [[f32; 3]; 3] =
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]];
/// And back.
const SRGB_FROM_REC2020: [[f32; 3]; 3] =
    [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
/// AgX brings primaries together …
const INSET: [[f32; 3]; 3] = [
    [0.856_627_15, 0.095_121_24, 0.048_251_606],
    [0.137_318_97, 0.761_242, 0.101_439_04],
    [0.111_898_21, 0.076_799_42, 0.811_302_4],
];
/// … and apart again.
const OUTSET: [[f32; 3]; 3] = [
    [1.127_100_6, -0.110_606_64, -0.016_493_94],
    [-0.141_329_76, 1.157_823_7, -0.016_493_94],
    [-0.141_329_76, -0.110_606_64, 1.251_936_4],
];
/// The range of light that AgX shows, in powers of two.
const RANGE: [f32; 2] = [-12.47393, 4.026_069];

/// AgX as in Filament and three.js, with the polynomial for its curve by Benjamin Wrensch.
fn agx(light: [f32; 3]) -> [f32; 3] {
    let inset = apply(&INSET, apply(&REC2020_FROM_SRGB, light));
    let curved = inset.map(|channel| {
        let x = ((channel.max(1e-10).log2() - RANGE[0]) / (RANGE[1] - RANGE[0])).clamp(0.0, 1.0);
        let x2 = x * x;
        let x4 = x2 * x2;
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
    });
    let linear = apply(&OUTSET, curved).map(|channel| channel.max(0.0).powf(2.2));
    apply(&SRGB_FROM_REC2020, linear).map(|channel| channel.clamp(0.0, 1.0))
}

fn apply(rows: &[[f32; 3]; 3], [x, y, z]: [f32; 3]) -> [f32; 3] {
    rows.map(|[a, b, c]| a * x + b * y + c * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greatest(light: [f32; 3]) -> f32 {
        light.into_iter().fold(0.0, f32::max)
    }

    #[test]
    fn greys_stay_grey_rise_and_end_below_one() {
        for tones in [ToneMapping::Neutral, ToneMapping::Agx] {
            let mut before = -1.0;
            for step in 0..200 {
                let light = 0.001 * 1.06_f32.powi(step);
                let [red, green, blue] = tones.map([light; 3]);
                assert!(
                    (red - green).abs() < 3e-3 && (blue - green).abs() < 3e-3,
                    "{tones:?} {red} {green} {blue}"
                );
                assert!(green > before - 1e-6 && (0.0..=1.0).contains(&green), "{tones:?} {light}: {green}");
                before = green;
            }
            assert!(before > 0.9, "{tones:?}: {before}");
        }
    }

    /// Values of the specification's own curve: 0.04 less in the middle, the same at 0.
    #[test]
    fn neutral_keeps_colours() {
        let [red, green, blue] = ToneMapping::Neutral.map([0.5, 0.3, 0.2]);
        assert!((red - 0.46).abs() < 1e-6 && (green - 0.26).abs() < 1e-6 && (blue - 0.16).abs() < 1e-6);
        assert_eq!(ToneMapping::Neutral.map([0.0; 3]), [0.0; 3]);
        assert!(greatest(ToneMapping::Neutral.map([50.0, 1.0, 1.0])) < 1.0);
    }

    /// Middle grey of 0.18 comes out near its place on a screen, and bright red turns towards white.
    #[test]
    fn agx_is_like_film() {
        let grey = ToneMapping::Agx.map([0.18; 3])[1];
        assert!((0.15..0.25).contains(&grey), "{grey}");
        let [red, green, _] = ToneMapping::Agx.map([20.0, 0.2, 0.2]);
        assert!(red > 0.9 && green > 0.3, "{red} {green}");
    }

    #[test]
    fn coverage_is_divided_out_and_exposure_doubles() {
        let mut film = Film::new(2, 1);
        film.color = vec![[0.1, 0.05, 0.05, 0.5], [0.0; 4]];
        film.develop(ToneMapping::None, 1.0);
        assert_eq!(film.color, [[0.2, 0.1, 0.1, 0.5], [0.0; 4]]);
        film.develop(ToneMapping::Neutral, 0.0);
        assert!(film.color[0][0] < 0.2 && film.color[0][3] == 0.5);
    }
}
