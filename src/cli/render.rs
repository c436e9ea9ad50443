//! `trimray render`: pictures of models.
//!
//! Each input is read and sent to the device once, for all its views and frames.

use super::Failure;
use super::args::{AovChoice, DeviceChoice, General, Render};
use super::args_output::{BitDepthChoice, layers};
use super::args_select::SelectionArguments;
use super::args_style::StyleChoice;
use super::device::{Device, Renderer};
use super::id_map::IdMap;
use super::info::point_text;
use super::load::{Purpose, load, nothing};
use super::materials::{Looks, looks, overridden};
use super::output::{Output, Still, Subjects, plan, with_model};
use super::path::{environment, path_options};
use super::progress::Progress;
use super::ray_report::RayReport;
use super::reference::{Reference, reference};
use super::render_report::{FaceReport, FileReport, InputReport, RunReport};
use super::section;
use super::selection::select_of_scene;
use super::sheet::{grid, sheet};
use super::style::{Look, look};
use super::view;
use super::window::window;
use crate::bake::explode;
use crate::image::{Animation, Film, Layers, Window, make_folder_of, unique_names, write_file};
use crate::render::cpu::{RayCounts, count_steps_of_picture};
use crate::render::section::Section;
use crate::render::{Background, Camera, Environment, PathOptions, RenderOptions, bounds};
use anyhow::Context;
use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(super) fn run(command: &Render, general: &General) -> anyhow::Result<()> {
    let views = view::names(&command.camera);
    let subjects = Subjects { inputs: &command.inputs, views: &views, frames: command.camera.frames };
    let plan = plan(&command.output, &subjects)?;
    check(command, &plan)?;
    let window = window(&command.writing, command.resolution)?;
    let background = match (command.no_background, command.background_color) {
        (true, _) => Some(Background::Transparent),
        (false, color) => color.map(Background::Color),
    };
    let look = look(&command.style, background, &command.path)?;
    let looks = looks(&command.material)?;
    let environment = environment(&command.path)?;
    let maps = id_maps(command)?;
    let reference = reference(&command.reference, &plan)?;
    // Before the work is done, not after it.
    for path in plan.iter().flatten().filter_map(|still| still.output.path()) {
        make_folder_of(path)?;
    }
    let choice = if command.aov.is_some() { DeviceChoice::Cpu } else { command.device };
    let mut device = Device::open(choice, general)?;
    let mut report = RunReport::default();
    let is_batch = command.inputs.len() > 1;
    for (index, (input, stills)) in command.inputs.iter().zip(&plan).enumerate() {
        let mut own = InputReport::default();
        let task = Task {
            input,
            stills,
            views: &views,
            window,
            id_map: maps.get(index).map(PathBuf::as_path),
            reference: reference.as_ref(),
        };
        let result = render_input(
            &task,
            command,
            (&look, &looks, environment.as_ref()),
            general,
            &mut device,
            &mut own,
        );
        let result = report.add(own, input, result);
        match result {
            Err(error) if is_batch && !super::is_broken_pipe(&error) => {
                // Nobody is left to tell if stderr is closed.
                let _ = writeln!(std::io::stderr(), "trimray: {error:#}");
            }
            Err(error) => {
                if command.writing.json {
                    report.write()?;
                }
                return Err(error);
            }
            Ok(()) => {}
        }
    }
    if command.writing.json {
        report.write()?;
    }
    Ok(report.outcome()?)
}

/// Refuses flags that make no sense together.
fn check(command: &Render, plan: &[Vec<Still>]) -> Result<(), Failure> {
    let usage = |reason: &str| Err(Failure::Usage(reason.to_owned()));
    if command.aov.is_some() && command.device == DeviceChoice::Gpu {
        return usage("--aov trim-tests is counted on the CPU: leave out --device gpu");
    }
    let is_plain = !command.style.has_lines()
        && command.style.style == StyleChoice::Shaded
        && command.section.section.is_empty()
        && !command.path.path_trace
        && !command.path.changes_tones();
    if command.aov.is_some() && !is_plain {
        return usage(
            "--aov shows what trims cost: leave out lines, styles, sections, --path-trace, --tone-mapping and --exposure",
        );
    }
    let mut stills = plan.iter().flatten();
    let has_window = command.writing.cropwindow.is_some() || command.writing.tile.is_some();
    if has_window && stills.clone().any(|still| still.views.len() > 1 || still.frames.len() > 1) {
        return usage(
            "--cropwindow and --tile need a file for each view and frame: put {view} and {frame} in its name",
        );
    }
    if command.style.style != StyleChoice::Shaded && command.path.path_trace {
        return usage(
            "the styles technical and blueprint have a light of their own: leave out --path-trace or the --style",
        );
    }
    if command.style.style != StyleChoice::Shaded && !command.material.is_empty() {
        return usage(
            "the styles technical and blueprint have looks of their own: leave out --color and its like",
        );
    }
    if command.writing.json && stills.clone().any(|still| still.output == Output::Stdout) {
        return usage("--json and the picture cannot both go to stdout: name a file with -o");
    }
    let is_exr = |still: &Still| matches!(still.output, Output::Exr(_));
    if layers(&command.writing.layers) != Layers::ALL && !stills.clone().any(is_exr) {
        return usage("--layers are those of EXR files, and no output is one");
    }
    if command.writing.bit_depth == BitDepthChoice::Sixteen && stills.clone().all(is_exr) {
        return usage("--bit-depth is that of PNG files, and no output is one");
    }
    let [width, height] = command.resolution.map(u64::from);
    let cells = |still: &Still| {
        let [columns, rows] = grid(still.views.len());
        columns as u64 * rows as u64
    };
    if stills.any(|still| width * height * cells(still) > super::args::MAX_PIXELS) {
        return usage(
            "the sheet of all views would be too large: lower the --resolution, which is that of each",
        );
    }
    Ok(())
}

/// One input and what is to be made of it.
struct Task<'t> {
    input: &'t Path,
    stills: &'t [Still],
    views: &'t [&'t str],
    window: Option<Window>,
    id_map: Option<&'t Path>,
    reference: Option<&'t Reference<'t>>,
}

/// The files of `--id-map`, one for each input; none without it.
fn id_maps(command: &Render) -> Result<Vec<PathBuf>, Failure> {
    let Some(template) = &command.writing.id_map else { return Ok(Vec::new()) };
    let names = command.inputs.iter().map(|input| PathBuf::from(with_model(template, input)));
    let names: Vec<PathBuf> = names.collect();
    if names.iter().collect::<HashSet<_>>().len() < names.len() {
        let reason = format!("--id-map {template} names one file for several inputs: put {{model}} in it");
        return Err(Failure::Usage(reason));
    }
    Ok(names)
}

fn render_input(
    task: &Task<'_>,
    command: &Render,
    (look, looks, environment): (&Look, &Looks, Option<&Environment>),
    general: &General,
    device: &mut Device<'_>,
    report: &mut InputReport,
) -> anyhow::Result<()> {
    let input = task.input;
    let start = Instant::now();
    let loaded = load(
        input,
        Purpose {
            strict: command.import.strict,
            kept_scenes: command.cache.kept_scenes(),
            edges: command.style.has_lines(),
            quality: command.bake_quality,
            selection: command.selection.clone(),
            ..Purpose::default()
        },
        general,
    );
    report.seconds.load = start.elapsed().as_secs_f64();
    let loaded = loaded?;
    let scene = loaded.scene();
    report.faces = FaceReport::of(&scene);
    if scene.faces.is_empty() || scene.instances.is_empty() {
        return Err(nothing(input, &scene, "render").into());
    }
    let exploded = (command.explode > 0.0)
        .then(|| explode(&scene, command.explode).map_err(anyhow::Error::msg))
        .transpose()
        .with_context(|| format!("{}: --explode {}", input.display(), command.explode))?;
    let scene = exploded.as_ref().map_or(scene, |exploded| exploded.of(&scene));
    let mut overridden = overridden(looks, &scene, input)?;
    look.style.recolor_materials(&mut overridden.materials);
    section::exclude(&command.section, &scene, &mut overridden.instances, input)?;
    let scene = overridden.of(&scene);
    let section = section::section(&command.section, &scene)?;
    if !general.quiet && section::is_empty(&section, &scene) {
        let bounds = bounds(&scene);
        let [low, high] = [bounds.min, bounds.max].map(|corner| point_text(corner.to_array()));
        let name = input.display();
        writeln!(
            std::io::stderr(),
            "{name}: the section keeps nothing of it: it is from {low} to {high} mm"
        )?;
    }
    let paths = scene.metadata.instances.iter().map(|info| info.path.as_str());
    let part_names = unique_names(paths);
    if let Some(path) = task.id_map {
        write_file(path, &IdMap::of(&scene, &part_names).encode()?)?;
    }
    let start = Instant::now();
    let focus = SelectionArguments { only: command.camera.focus.clone(), hide: Vec::new() };
    let focused = select_of_scene(&scene, &focus, input)?;
    let framed = focused.as_ref().map_or(scene, |kept| kept.of(&scene));
    let cameras = view::cameras(&command.camera, &framed, &section, command.resolution);
    let pictures = cameras.iter().map(Vec::len).sum();
    let paths = environment.map(|environment| {
        path_options(&command.path, environment.clone(), &scene, &section, command.camera.up)
    });
    let mut job = Job {
        command,
        look,
        options: RenderOptions { window: task.window, section, ..options(command, look) },
        paths,
        part_names,
        renderer: device.renderer(scene)?,
        cameras,
        progress: Progress::new(format!("Rendering {}", input.display()), general),
        done: 0,
        pictures,
        counts: RayCounts::default(),
    };
    report.seconds.render += start.elapsed().as_secs_f64();
    let result = task.stills.iter().try_for_each(|still| job.write(still, task, general, report));
    log::info!("rendered in {:.2} s", report.seconds.render);
    if command.writing.stats {
        let rays = report.rays.insert(RayReport::of(&job.counts));
        if !command.writing.json {
            rays.write(&mut std::io::stderr())?;
        }
    }
    drop(job);
    device.name().clone_into(&mut report.device);
    result
}

fn options(command: &Render, look: &Look) -> RenderOptions {
    RenderOptions {
        resolution: command.resolution,
        samples: command.samples,
        sampling: command.sampling.into(),
        background: look.rendered_background(),
        ambient_occlusion: !command.no_ambient_occlusion,
        exactness: command.exactness.into(),
        layers: Layers::NONE,
        window: None,
        section: Section::default(),
    }
}

/// One input's pictures.
struct Job<'j, 'a, 's> {
    command: &'j Render,
    look: &'j Look,
    options: RenderOptions,
    /// How light paths are traced; none where they are not.
    paths: Option<PathOptions>,
    /// By instance, for Cryptomatte.
    part_names: Vec<String>,
    renderer: Renderer<'j, 'a, 's>,
    /// By view and frame.
    cameras: Vec<Vec<Camera>>,
    progress: Progress,
    /// Pictures that are done, of all.
    done: usize,
    pictures: usize,
    /// With `--stats`.
    counts: RayCounts,
}

impl Job<'_, '_, '_> {
    /// Renders and writes one file.
    fn write(
        &mut self,
        still: &Still,
        task: &Task<'_>,
        general: &General,
        report: &mut InputReport,
    ) -> anyhow::Result<()> {
        let writing = &self.command.writing;
        let depth = writing.bit_depth.into();
        self.options.layers = match still.output {
            Output::Exr(_) => layers(&writing.layers),
            Output::Png(_) | Output::Stdout => Layers::NONE,
        };
        let is_animated = still.frames.len() > 1;
        let has_alpha = self.look.background() == Background::Transparent;
        let mut animation =
            Animation::new(still.frames.len() as u32, self.command.camera.frame_rate, depth, has_alpha);
        let (mut size, mut bytes) = ([0; 2], Vec::new());
        for frame in still.frames.clone() {
            let start = Instant::now();
            let film = self.sheet(still, frame, task.views)?;
            let rendered = Instant::now();
            size = [film.width, film.height];
            if is_animated {
                animation.push(&film)?;
            } else {
                bytes = still.output.encode(&film, depth, &self.part_names)?;
            }
            report.seconds.render += (rendered - start).as_secs_f64();
            report.seconds.write += rendered.elapsed().as_secs_f64();
        }
        let start = Instant::now();
        if is_animated {
            bytes = animation.finish()?;
        }
        still.output.write(&bytes)?;
        report.seconds.write += start.elapsed().as_secs_f64();
        tell(still, size, task.views, general, report)?;
        let Some(reference) = task.reference else { return Ok(()) };
        let comparison = reference.compare(&still.output, &bytes)?;
        if !general.quiet {
            comparison.write_table(&mut std::io::stderr())?;
        }
        Ok(report.reference.insert(comparison).verdict()?)
    }

    /// One frame of a file's views.
    fn sheet(&mut self, still: &Still, frame: u32, views: &[&str]) -> anyhow::Result<Film> {
        let asked = self.options;
        let mut options = asked;
        if self.look.has_lines() {
            options.layers = asked.layers.with_plain();
            options.window = asked.window.map(|window| self.look.with_margin(window, asked.resolution));
        }
        let mut films = Vec::with_capacity(still.views.len());
        for view in still.views.clone() {
            let camera = self.cameras[view][frame as usize];
            let (done, pictures) = (self.done, self.pictures);
            let progress = &self.progress;
            let tell = |part, of| progress.tell(done * of + part, pictures * of);
            let mut film = match (self.command.aov, &self.paths) {
                (Some(AovChoice::TrimTests), _) => self.renderer.render_trim_tests(&camera, &options, &tell),
                (None, Some(paths)) => self.renderer.render_paths(&camera, &options, paths, &tell)?,
                (None, None) => self.renderer.render(&camera, &options, &tell)?,
            };
            if self.command.writing.stats {
                self.counts += count_steps_of_picture(&self.renderer.scene(), &camera, &asked);
            }
            if still.output.is_shown() {
                self.look.develop(&mut film);
            }
            self.look.finish(&camera, &options, &mut film, &mut self.renderer)?;
            if self.look.has_lines() {
                film = film.part(asked.window.unwrap_or(film.window()), asked.layers);
            }
            if self.command.camera.labels {
                film.write_label(views[view], self.look.label_color());
            }
            films.push(film);
            self.done += 1;
        }
        Ok(sheet(films, self.look.background()))
    }
}

/// Tells of a file that is written.
fn tell(
    still: &Still,
    [width, height]: [usize; 2],
    views: &[&str],
    general: &General,
    report: &mut InputReport,
) -> anyhow::Result<()> {
    let Some(path) = still.output.path() else { return Ok(()) };
    if !general.quiet {
        let frames =
            if still.frames.len() > 1 { format!(", {} frames", still.frames.len()) } else { String::new() };
        writeln!(std::io::stderr(), "{}: {width} by {height} pixels{frames}", path.display())?;
    }
    let shown = views.get(still.views.clone()).unwrap_or_default();
    report.files.push(FileReport {
        path: path.display().to_string(),
        width,
        height,
        views: shown.iter().map(|&name| name.to_owned()).collect(),
        frames: [still.frames.start, still.frames.end],
    });
    Ok(())
}
