//! Where a picture needs all its samples.
//!
//! A ray through the centre of each pixel shows most of a picture: within a smooth face light changes so little over a pixel that the mean of many samples
//! is the centre's own. All samples are taken where that is not so: where light bends between neighbours, where something else begins, where
//! surfaces step, and behind what is seen through. What a sample there shows beside a neighbour that the neighbour's centre does not show makes that one
//! sampled too, so that a line thinner than a pixel is followed wherever it is found once.
//!
//! The sky that the centres see is one ray each, freed of its grain (`occlusion`), and samples take it from the centres of their own surface.
//! Both tracers do this alike: [`paint`] is their common part.
//!
//! A pixel depends on those around it, as far as [`MARGIN`]: a part of a picture is rendered with such a border, and is then to the bit what the whole picture
//! has there.

use super::bands::rows_per_band;
use super::camera::center_in_picture;
use super::curvature::{Place, curvature};
use super::hit::surface_parameters;
use super::marks::{Shown, marks, neighbours};
use super::occlusion::{REACH, Surface, smooth};
use super::pixels::{
    BESIDE_ALL, BESIDE_LEFT, CAP, Center, Neighbour, Refined, SEE_THROUGH, Sampled, perceived,
};
use super::shade::{SkyLight, hit_material};
use super::shade_rays::is_other;
use crate::image::{Film, RANKS, Share, Window, filled};
use crate::render::{Camera, RenderOptions, Sampling};
use crate::scene::Scene;
use bytemuck::Zeroable;
use rayon::prelude::*;
use std::ops::{Range, RangeInclusive};

/// Rows of pixels whose centres one thread finds at a time.
const ROWS_PER_BAND: RangeInclusive<usize> = 1..=8;

/// How often neighbours are followed: as far as a line is followed from where it is found.
const MOST_ROUNDS: usize = 8;

/// How far, in pixels, what a pixel shows depends on others: on as many rounds, whose last looks at pixels beside those it asks for and at theirs, which
/// know of the sky as far as its mean reaches.
const MARGIN: usize = MOST_ROUNDS + 2 + REACH;

/// What the centres of all pixels show, row by row.
pub struct Centers<'a> {
    scene: &'a Scene<'a>,
    camera: &'a Camera,
    options: &'a RenderOptions,
    /// With the plain layers and those that are asked for; its colours are without any sky, until that is known.
    film: Film,
    lit: Vec<[f32; 3]>,
    open: Vec<f32>,
    see_through: Vec<bool>,
}

/// The part of a picture to render so that the part that is asked for is right.
pub fn with_margin(options: &RenderOptions) -> Window {
    let whole = options.resolution.map(|n| n as usize);
    let Some(window) = options.window else { return Window::whole(whole[0], whole[1]) };
    window.with_margin(MARGIN, whole)
}

impl<'a> Centers<'a> {
    /// Those of [`with_margin`]'s part of a picture, with nothing in it.
    pub fn new(scene: &'a Scene<'a>, camera: &'a Camera, options: &'a RenderOptions) -> Self {
        let layers = options.layers.with_plain();
        let whole = options.resolution.map(|n| n as usize);
        let film = Film::of_window(with_margin(options), whole, layers);
        let pixels = film.color.len();
        Self {
            scene,
            camera,
            options,
            film,
            lit: filled([0.0; 3], pixels),
            open: filled(0.0, pixels),
            see_through: vec![false; pixels],
        }
    }

    /// Takes what `count` pixels from index `first` on show; depths are made `behind` millimetres greater. `find` tells it of some of them at a time, by
    /// their indices, on all threads.
    pub fn take<C: AsRef<[Center]>>(
        &mut self,
        first: usize,
        count: usize,
        behind: f64,
        find: impl Fn(Range<usize>) -> C + Sync,
    ) {
        let scene = self.scene;
        let firsts = (first..).step_by(self.pixels_per_band());
        let bands: Vec<(usize, Band<'_>)> = firsts.zip(self.bands(first, count)).collect();
        bands.into_par_iter().for_each(|(first, mut band)| {
            let found = find(first..first + band.open.len());
            for (pixel, center) in found.as_ref().iter().enumerate() {
                if center.instance != 0 {
                    band.put(scene, pixel, center, behind);
                } else {
                    // `put_behind` reads these before it writes them: the system would give their pages twice.
                    band.color[pixel] = [0.0; 4];
                }
            }
        });
    }

    fn pixels_per_band(&self) -> usize {
        self.film.width.max(1) * rows_per_band(self.film.height, ROWS_PER_BAND)
    }

    /// The pixels' places in bands.
    fn bands(&mut self, first: usize, count: usize) -> impl Iterator<Item = Band<'_>> {
        let pixels = self.pixels_per_band();
        let Film { color, depth, normal, part, face, uv, curvature, albedo, matte, .. } = &mut self.film;
        let mut rest = Band {
            color,
            depth,
            normal,
            part,
            face,
            uv,
            curvature,
            albedo,
            matte,
            lit: &mut self.lit,
            open: &mut self.open,
            see_through: &mut self.see_through,
        };
        rest.split_off(first);
        let mut rest = rest.split_off(count);
        std::iter::from_fn(move || {
            let band = rest.split_off(pixels);
            (!band.open.is_empty()).then_some(band)
        })
    }

    /// Points that the pixels show, from `origin`; 0 where nothing is.
    fn positions(&self, origin: glam::DVec3) -> Vec<[f32; 3]> {
        let from_origin = self.camera.position - origin;
        let position = |pixel: usize| {
            if self.film.part[pixel] == 0 {
                return [0.0; 3];
            }
            let [x, y, aspect] = center_in_picture(self.options.resolution, self.film.window(), pixel);
            let depth = f64::from(self.film.depth[pixel]);
            (from_origin + self.camera.at_depth(x, y, aspect, depth)).as_vec3().to_array()
        };
        let mut positions = filled([0.0; 3], self.film.part.len());
        positions.par_iter_mut().enumerate().for_each(|(pixel, at)| *at = position(pixel));
        positions
    }

    /// The part of the picture that was asked for, with the layers that were.
    fn finish(mut self) -> Film {
        if self.options.layers.position {
            self.film.position = self.positions(glam::DVec3::ZERO);
        }
        match self.options.window {
            Some(window) => self.film.part(window, self.options.layers),
            None => {
                self.film.keep(self.options.layers);
                self.film
            }
        }
    }
}

/// Some pixels' places in the arrays of [`Centers`]; those of layers that it has not are empty.
struct Band<'a> {
    color: &'a mut [[f32; 4]],
    depth: &'a mut [f32],
    normal: &'a mut [[f32; 3]],
    part: &'a mut [u32],
    face: &'a mut [u32],
    uv: &'a mut [[f32; 2]],
    curvature: &'a mut [[f32; 2]],
    albedo: &'a mut [[f32; 3]],
    matte: &'a mut [[Share; RANKS]],
    lit: &'a mut [[f32; 3]],
    open: &'a mut [f32],
    see_through: &'a mut [bool],
}

impl Band<'_> {
    /// The first pixels, which are taken off.
    fn split_off(&mut self, pixels: usize) -> Self {
        Self {
            color: split_off(&mut self.color, pixels),
            depth: split_off(&mut self.depth, pixels),
            normal: split_off(&mut self.normal, pixels),
            part: split_off(&mut self.part, pixels),
            face: split_off(&mut self.face, pixels),
            uv: split_off(&mut self.uv, pixels),
            curvature: split_off(&mut self.curvature, pixels),
            albedo: split_off(&mut self.albedo, pixels),
            matte: split_off(&mut self.matte, pixels),
            lit: split_off(&mut self.lit, pixels),
            open: split_off(&mut self.open, pixels),
            see_through: split_off(&mut self.see_through, pixels),
        }
    }

    /// Tells what pixel `pixel` of the band shows.
    fn put(&mut self, scene: &Scene<'_>, pixel: usize, center: &Center, behind: f64) {
        self.depth[pixel] = (behind + f64::from(center.depth)) as f32;
        self.normal[pixel] = center.normal;
        self.part[pixel] = center.instance;
        let is_cap = center.flags & CAP != 0;
        self.face[pixel] = if is_cap { 0 } else { center.face };
        let (instance, face) = (center.instance - 1, center.face - 1);
        if let (Some(found), false) = (self.uv.get_mut(pixel), is_cap) {
            let uv = surface_parameters(scene, face, center.net, center.uv);
            *found = uv.map(|parameter| parameter as f32);
        }
        if let Some(found) = self.curvature.get_mut(pixel) {
            *found = curvature_at(scene, center);
        }
        if let Some(found) = self.albedo.get_mut(pixel) {
            *found = hit_material(scene, instance, face).rgb;
        }
        if let Some(found) = self.matte.get_mut(pixel) {
            found[0] = Share { part: center.instance, coverage: 1.0 };
        }
        let [r, g, b] = center.dark;
        self.color[pixel] = [r, g, b, 1.0];
        self.lit[pixel] = center.lit;
        self.open[pixel] = center.open;
        self.see_through[pixel] = center.flags & SEE_THROUGH != 0;
    }
}

/// The first elements, as many as there are, which are taken off.
fn split_off<'a, T>(from: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let all = std::mem::take(from);
    let (first, rest) = all.split_at_mut(count.min(all.len()));
    *from = rest;
    first
}

/// What the layer of curvatures has where a centre is on something; 0 on caps.
fn curvature_at(scene: &Scene<'_>, center: &Center) -> [f32; 2] {
    if center.flags & CAP != 0 {
        return [0.0; 2];
    }
    let &Center { net, uv, normal, .. } = center;
    let place = Place { instance: center.instance - 1, face: center.face - 1, net, uv, normal };
    curvature(scene, &place).map(|x| x as f32)
}

/// From what the centres show to the picture, without a background. `refine` takes all samples of some pixels, at most `most`, in order of their index; it is
/// called as often as it leads to more.
///
/// # Errors
///
/// Those of `refine`.
pub fn paint<E>(
    centers: Centers<'_>,
    most: usize,
    mut refine: impl FnMut(&[Refined]) -> Result<Vec<Sampled>, E>,
) -> Result<Film, E> {
    let mut centers = centers;
    let options = centers.options;
    let is_uniform = options.sampling == Sampling::Uniform && options.samples > 1;
    let has_sky = options.ambient_occlusion && !is_uniform;
    let positions = if has_sky { centers.positions(centers.camera.position) } else { Vec::new() };
    if has_sky {
        let surface =
            Surface { width: centers.film.width, normal: &centers.film.normal, position: &positions };
        centers.open = smooth(&surface, &centers.open);
    }
    add_sky(&mut centers);
    let pixels = centers.film.color.len();
    let mut is_asked = if is_uniform {
        vec![true; pixels]
    } else if options.samples > 1 {
        let Centers { camera, film, lit, see_through, .. } = &centers;
        marks(&Shown { camera, film, lit, see_through, positions: &positions })
    } else {
        centers.see_through.clone()
    };
    let mut asked: Vec<usize> = memchr::memchr_iter(1, bytemuck::cast_slice(&is_asked)).collect();
    for _ in 0..=MOST_ROUNDS {
        let mut next = Vec::new();
        for asked in asked.chunks(most) {
            let refined: Vec<Refined> =
                asked.par_iter().map(|&pixel| around(&centers, pixel, is_uniform)).collect();
            for (&pixel, sampled) in asked.iter().zip(refine(&refined)?) {
                centers.film.color[pixel] = sampled.color;
                if options.layers.albedo {
                    centers.film.albedo[pixel] = sampled.albedo;
                }
                if options.layers.matte {
                    centers.film.matte[pixel] = sampled.matte;
                }
                for beside in suspects(&centers.film, pixel, sampled.flags) {
                    if !is_asked[beside] {
                        is_asked[beside] = true;
                        next.push(beside);
                    }
                }
            }
        }
        if next.is_empty() {
            break;
        }
        next.sort_unstable();
        asked = next;
    }
    Ok(centers.finish())
}

/// Adds the light of the sky to the colours, as the centres have it.
fn add_sky(centers: &mut Centers<'_>) {
    let Centers { film, lit, open, .. } = centers;
    let part = &film.part;
    film.color.par_iter_mut().enumerate().filter(|&(pixel, _)| part[pixel] != 0).for_each(
        |(pixel, color)| {
            let [r, g, b, coverage] = *color;
            let [r, g, b] = SkyLight { dark: [r, g, b], lit: lit[pixel] }.at(open[pixel]);
            *color = [r, g, b, coverage];
        },
    );
}

/// The pixels around one that its samples give reason to look into: those of whose sides the flags tell, and where all four do those at the corners too, for a
/// line passes from pixel to pixel over corners.
fn suspects(film: &Film, pixel: usize, flags: u32) -> impl Iterator<Item = usize> {
    let sides = neighbours(film, pixel);
    let [_, _, above, below] = sides.map(|side| side.filter(|_| flags & BESIDE_ALL == BESIDE_ALL));
    let corners = [above, below].map(|row| row.map_or([None; 4], |row| neighbours(film, row)));
    let of_sides =
        (0..4).filter(move |side| flags & BESIDE_LEFT << side != 0).filter_map(move |side| sides[side]);
    of_sides.chain(corners.into_iter().flat_map(|[left, right, ..]| [left, right]).flatten())
}

/// Whether fewer than two of a pixel's neighbours show what it shows.
fn is_alone(centers: &Centers<'_>, pixel: usize) -> bool {
    let part = &centers.film.part;
    let own = perceived(centers.lit[pixel]);
    let shows_same =
        |&other: &usize| !is_other([own, perceived(centers.lit[other])], [part[pixel], part[other]]);
    neighbours(&centers.film, pixel).into_iter().flatten().filter(shows_same).count() < 2
}

/// A pixel for `refine`. Under uniform sampling samples find out all by themselves.
fn around(centers: &Centers<'_>, pixel: usize, is_uniform: bool) -> Refined {
    let neighbour = |other: usize| Neighbour {
        normal: centers.film.normal[other],
        open: if is_uniform { -1.0 } else { centers.open[other] },
        perceived: perceived(centers.lit[other]),
        instance: centers.film.part[other],
        face: centers.film.face[other],
        is_alone: is_alone(centers, other).into(),
        reserved: [0; 2],
    };
    let [left, right, above, below] = neighbours(&centers.film, pixel).map(|other| other.unwrap_or(pixel));
    Refined {
        pixel: pixel as u32,
        around: [pixel, left, right, above, below].map(neighbour),
        ..Refined::zeroed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneBuffers;

    /// Taken at once and in parts that end within bands, with more at the end than there are: each pixel has its own.
    #[test]
    fn centers_are_where_they_were_taken() {
        let buffers = SceneBuffers::default();
        let camera = Camera {
            position: glam::DVec3::ZERO,
            forward: glam::DVec3::NEG_Z,
            right: glam::DVec3::X,
            up: glam::DVec3::Y,
            half_height: 1.0,
            orthographic: true,
        };
        let options = RenderOptions { resolution: [70, 50], ..RenderOptions::default() };
        let of = |some: Range<usize>| -> Vec<Center> {
            let center = |pixel: usize| Center {
                depth: pixel as f32,
                open: 0.5,
                flags: if pixel.is_multiple_of(5) { CAP } else { SEE_THROUGH },
                instance: (pixel % 3) as u32,
                face: pixel as u32,
                ..Center::zeroed()
            };
            some.map(center).collect()
        };
        let scene = buffers.scene();
        for parts in [vec![0, 3500], vec![0, 700, 1023, 1025, 3000, 3500], vec![0, 1000, 9000]] {
            let mut centers = Centers::new(&scene, &camera, &options);
            for ends in parts.windows(2) {
                centers.take(ends[0], ends[1] - ends[0], 2.0, of);
            }
            for pixel in 0..3500 {
                let is_there = pixel % 3 != 0;
                let film = &centers.film;
                assert_eq!(film.part[pixel], (pixel % 3) as u32, "{pixel}");
                assert_eq!(film.depth[pixel], if is_there { 2.0 + pixel as f32 } else { f32::INFINITY });
                assert_eq!(film.face[pixel], if is_there && pixel % 5 != 0 { pixel as u32 } else { 0 });
                assert_eq!(centers.open[pixel], if is_there { 0.5 } else { 0.0 });
                assert_eq!(centers.see_through[pixel], is_there && pixel % 5 != 0);
            }
        }
    }

    /// Of both kinds of camera, and where a picture is not square to the view.
    #[test]
    fn points_at_a_depth_lie_on_the_rays() {
        for orthographic in [false, true] {
            let camera = Camera {
                position: glam::DVec3::new(1.0, -2.0, 30.0),
                forward: glam::DVec3::NEG_Z,
                right: glam::DVec3::new(0.8, 0.0, 0.6),
                up: glam::DVec3::Y,
                half_height: 0.5,
                orthographic,
            };
            for (x, y) in [(0.0, 0.0), (-0.7, 0.9), (1.0, -1.0)] {
                let ray = camera.ray(x, y, 1.5);
                let along = 12.5 / ray.direction.dot(camera.forward);
                let expected = ray.origin + ray.direction * along;
                let found = camera.position + camera.at_depth(x, y, 1.5, 12.5);
                assert!(found.distance(expected) < 1e-12, "{orthographic} {found} {expected}");
            }
        }
    }
}
