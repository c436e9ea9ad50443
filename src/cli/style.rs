//! From the flags of style and lines to what is done to a picture.

use super::Failure;
use super::args_path::PathArguments;
use super::args_style::StyleArguments;
use super::device::Renderer;
use crate::image::{Film, ToneMapping, Window};
use crate::render::lines::{HiddenLines, LineOptions, line_coverage, margin};
use crate::render::{Background, Camera, Hit, Ray, RenderOptions, Style, first_in_section};

/// What is done to a picture once its faces are rendered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) style: Style,
    lines: Option<LineOptions>,
    line_color: [f32; 3],
    background: Background,
    tones: ToneMapping,
    /// Powers of two.
    exposure: f32,
}

/// The look that is asked for; `background` where one is asked for by its colour, or by its absence.
///
/// # Errors
///
/// What is said of lines where none are drawn.
pub(super) fn look(
    flags: &StyleArguments,
    background: Option<Background>,
    light: &PathArguments,
) -> Result<Look, Failure> {
    let about_lines = [
        ("--edge-width", flags.edge_width.is_some()),
        ("--edge-color", flags.edge_color.is_some()),
        ("--no-silhouettes", flags.no_silhouettes),
        ("--hidden-lines", flags.hidden_lines.is_some()),
    ];
    if let (false, Some((flag, _))) = (flags.has_lines(), about_lines.iter().find(|(_, given)| *given)) {
        let reason = format!(
            "{flag} is about lines, and none are drawn: add --edges feature, --edges all or a --style"
        );
        return Err(Failure::Usage(reason));
    }
    let style = Style::from(flags.style);
    let lines = flags.has_lines().then(|| LineOptions {
        edges: flags.edges().into(),
        contours: !flags.no_silhouettes,
        hidden: flags.hidden_lines.map_or(HiddenLines::Off, HiddenLines::from),
        width: flags.edge_width.unwrap_or(1.5),
    });
    Ok(Look {
        style,
        lines,
        line_color: flags.edge_color.unwrap_or(style.line_color()),
        background: background.unwrap_or(Background::Color(style.paper())),
        tones: light.tone_mapping(),
        exposure: light.exposure,
    })
}

impl Look {
    /// Whether lines are drawn.
    pub(super) fn has_lines(&self) -> bool {
        self.lines.is_some()
    }

    /// The part of a picture to render so that the part that is asked for has its lines.
    pub(super) fn with_margin(&self, window: Window, resolution: [u32; 2]) -> Window {
        let margin = self.lines.as_ref().map_or(0, margin);
        window.with_margin(margin, resolution.map(|n| n as usize))
    }

    /// What stands behind it all.
    pub(super) fn background(&self) -> Background {
        self.background
    }

    /// The colour of words over the background, sRGB.
    pub(super) fn label_color(&self) -> [f32; 3] {
        match self.background {
            Background::Color([red, green, blue]) if red + green + blue < 1.5 => [0.95; 3],
            _ => [0.12; 3],
        }
    }

    /// What the faces are rendered before: nothing where more is laid over them.
    pub(super) fn rendered_background(&self) -> Background {
        if self.lines.is_some() || self.style != Style::Shaded || self.has_tones() {
            Background::Transparent
        } else {
            self.background
        }
    }

    /// Whether light is shown other than as it is.
    fn has_tones(&self) -> bool {
        self.tones != ToneMapping::None || self.exposure != 0.0
    }

    /// Turns the light of the scene into that of a screen. The background is a screen's already, so that it comes later.
    pub(super) fn develop(&self, film: &mut Film) {
        if self.has_tones() {
            film.develop(self.tones, self.exposure);
        }
    }

    /// Recolours faces, draws lines over them and puts the background behind.
    pub(super) fn finish(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        film: &mut Film,
        renderer: &mut Renderer<'_, '_, '_>,
    ) -> anyhow::Result<()> {
        self.style.recolor(film);
        if let Some(lines) = &self.lines {
            let section = &options.section;
            let scene = renderer.scene();
            film.lines = line_coverage(&scene, camera, lines, section, film, &mut |rays| {
                let hits = renderer.probe(rays, section.is_empty(), options.exactness)?;
                if section.is_empty() {
                    return Ok::<_, anyhow::Error>(hits);
                }
                let first = |(ray, hits): (&Ray, Vec<Hit>)| {
                    first_in_section(&scene, section, ray, &hits).into_iter().collect()
                };
                Ok(rays.iter().zip(hits).map(first).collect())
            })?;
            film.draw_lines(self.line_color);
        }
        if let (Background::Transparent, Background::Color(color)) =
            (self.rendered_background(), self.background)
        {
            film.put_behind(color);
        }
        Ok(())
    }
}
