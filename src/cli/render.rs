//! `trimray render`: pictures of models.

use super::Failure;
use super::args::{AovChoice, DeviceChoice, General, Render};
use super::device::Device;
use super::load::{Purpose, load, nothing};
use super::output::{Output, outputs};
use super::progress::Progress;
use super::section;
use super::style::{Look, look};
use super::view;
use crate::render::cpu::render_trim_tests;
use crate::render::{Background, RenderOptions};
use crate::scene::{Material, Scene};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

pub(super) fn run(command: &Render, general: &General) -> anyhow::Result<()> {
    let outputs = outputs(&command.output, &command.inputs)?;
    if command.aov.is_some() && (command.style.has_lines() || !command.section.section.is_empty()) {
        let reason = "--aov shows what trims cost: leave out lines, styles and sections".to_owned();
        return Err(Failure::Usage(reason).into());
    }
    let choice = match (command.aov, command.device) {
        (Some(_), DeviceChoice::Gpu) => {
            let reason = "--aov trim-tests is counted on the CPU: leave out --device gpu".to_owned();
            return Err(Failure::Usage(reason).into());
        }
        (Some(_), _) => DeviceChoice::Cpu,
        (None, choice) => choice,
    };
    let background = match (command.no_background, command.background_color) {
        (true, _) => Some(Background::Transparent),
        (false, color) => color.map(Background::Color),
    };
    let look = look(&command.style, background)?;
    let mut device = Device::open(choice, general)?;
    for (input, output) in command.inputs.iter().zip(&outputs) {
        render_one(input, output, command, &look, general, &mut device)?;
    }
    Ok(())
}

fn render_one(
    input: &Path,
    output: &Output,
    command: &Render,
    look: &Look,
    general: &General,
    device: &mut Device<'_>,
) -> anyhow::Result<()> {
    let loaded = load(
        input,
        Purpose { strict: command.import.strict, edges: command.style.has_lines(), ..Purpose::default() },
        general,
    )?;
    let scene = loaded.scene();
    if scene.faces.is_empty() || scene.instances.is_empty() {
        return Err(nothing(input, &scene, "render").into());
    }
    let materials: Vec<Material> = look.style.materials(scene.materials);
    let instances = section::instances(&command.section, &scene, input)?;
    let scene = Scene { materials: &materials, instances: &instances, ..scene };
    let section = section::section(&command.section, &scene)?;
    let camera = view::camera(&command.view, &scene, &section, command.resolution);
    let options = RenderOptions {
        resolution: command.resolution,
        samples: command.samples,
        background: look.rendered_background(),
        ambient_occlusion: !command.no_ambient_occlusion,
        exactness: command.exactness.into(),
        section,
    };
    let start = Instant::now();
    let progress = Progress::new(format!("Rendering {}", input.display()), general);
    let tell = |done, total| progress.tell(done, total);
    let mut film = match command.aov {
        Some(AovChoice::TrimTests) => render_trim_tests(&scene, &camera, &options, &tell),
        None => device.render(&scene, &camera, &options, &tell)?,
    };
    drop(progress);
    look.finish(&scene, &camera, &options, &mut film, device)?;
    log::info!("rendered in {:.2} s", start.elapsed().as_secs_f64());
    output.write(&film)?;
    if let (false, Some(path)) = (general.quiet, output.path()) {
        writeln!(std::io::stderr(), "{}: {} by {} pixels", path.display(), film.width, film.height)?;
    }
    Ok(())
}
