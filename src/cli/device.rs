//! Which device computes: a hardware GPU where there is one, else the CPU, unless one is asked for by name. It says which, once, on
//! stderr; where the GPU fails under `auto`, the CPU takes over, with the reason.

use super::args::{DeviceChoice, General};
use crate::image::{Film, Layers};
use crate::render::cpu::{self, Precision};
#[cfg(feature = "gpu")]
use crate::render::gpu::{AdapterChoice, Gpu, GpuError, GpuScene};
use crate::render::{Camera, Coherence, Exactness, Hit, PathOptions, Ray, RenderOptions};
use crate::scene::Scene;
use std::io::Write;
#[cfg(feature = "gpu")]
use std::thread::JoinHandle;

/// Rays that a GPU holds.
#[cfg(feature = "gpu")]
pub(super) type HeldRays = crate::render::gpu::HeldWork;
#[cfg(not(feature = "gpu"))]
pub(super) type HeldRays = std::convert::Infallible;

/// The device of one run of a command.
pub(super) struct Device<'a> {
    choice: DeviceChoice,
    general: &'a General,
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
    /// A GPU that is being opened: drivers take as long as small files do.
    #[cfg(feature = "gpu")]
    opening: Option<JoinHandle<Result<Gpu, GpuError>>>,
    /// Why it is not the GPU, where it might have been.
    reason: Option<String>,
    announced: bool,
    /// What computed last, for people.
    name: String,
}

impl<'a> Device<'a> {
    /// Opens the device of choice.
    ///
    /// # Errors
    ///
    /// The GPU was asked for by name and there is none.
    pub(super) fn open(choice: DeviceChoice, general: &'a General) -> anyhow::Result<Self> {
        let mut device = Self {
            choice,
            general,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            opening: None,
            reason: None,
            announced: false,
            name: String::new(),
        };
        device.open_gpu()?;
        Ok(device)
    }

    #[cfg(feature = "gpu")]
    fn open_gpu(&mut self) -> anyhow::Result<()> {
        match self.choice {
            DeviceChoice::Cpu => {}
            DeviceChoice::Auto => {
                self.opening = Some(std::thread::spawn(|| Gpu::new(AdapterChoice::Hardware)));
            }
            DeviceChoice::Gpu => self.gpu = Some(Gpu::new(AdapterChoice::Any)?),
        }
        Ok(())
    }

    /// Waits for a GPU that is being opened.
    #[cfg(feature = "gpu")]
    pub(super) fn wait(&mut self) {
        match self.opening.take().map(JoinHandle::join) {
            None => {}
            Some(Ok(Ok(gpu))) => self.gpu = Some(gpu),
            Some(Ok(Err(error))) => self.reason = Some(error.to_string()),
            Some(Err(_)) => self.reason = Some("the GPU's driver failed".to_owned()),
        }
    }

    #[cfg(not(feature = "gpu"))]
    fn open_gpu(&mut self) -> anyhow::Result<()> {
        anyhow::ensure!(self.choice != DeviceChoice::Gpu, "this trimray was built without the `gpu` feature");
        Ok(())
    }

    /// Brings a scene to the GPU; `None` where that does not compute, or has no room.
    #[cfg(feature = "gpu")]
    fn upload<'s>(&mut self, scene: &Scene<'s>) -> anyhow::Result<Option<GpuScene<'s>>> {
        self.wait();
        match self.gpu.as_ref().map(|gpu| gpu.upload(scene)) {
            Some(Err(error)) => {
                self.fall_back(error)?;
                Ok(None)
            }
            Some(Ok(uploaded)) => {
                self.announce_gpu();
                Ok(Some(uploaded))
            }
            None => Ok(None),
        }
    }

    /// Prepares to render pictures of a scene.
    pub(super) fn renderer<'d, 's>(&'d mut self, scene: Scene<'s>) -> anyhow::Result<Renderer<'d, 'a, 's>> {
        #[cfg(feature = "gpu")]
        let uploaded = self.upload(&scene)?;
        Ok(Renderer {
            device: self,
            scene,
            #[cfg(feature = "gpu")]
            uploaded,
        })
    }

    /// Prepares to answer rays. Only the CPU knows f64.
    pub(super) fn prober<'s>(
        #[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "only the GPU may fail here"))] mut self,
        scene: Scene<'s>,
        precision: Precision,
        exactness: Exactness,
    ) -> anyhow::Result<Prober<'a, 's>> {
        #[cfg(feature = "gpu")]
        let uploaded = if precision == Precision::F32 { self.upload(&scene)? } else { None };
        Ok(Prober {
            device: self,
            scene,
            precision,
            exactness,
            #[cfg(feature = "gpu")]
            uploaded,
        })
    }

    /// Does some work on the GPU; `None` where that does not compute, or fails.
    #[cfg(feature = "gpu")]
    fn on_gpu<T>(
        &mut self,
        uploaded: Option<&GpuScene<'_>>,
        work: impl FnOnce(&Gpu, &GpuScene<'_>) -> Result<T, GpuError>,
    ) -> anyhow::Result<Option<T>> {
        let (Some(gpu), Some(uploaded)) = (&self.gpu, uploaded) else { return Ok(None) };
        match work(gpu, uploaded) {
            Ok(done) => Ok(Some(done)),
            Err(error) => {
                self.fall_back(error)?;
                Ok(None)
            }
        }
    }

    /// Passes the GPU's error on where the GPU was asked for by name; else the CPU takes over.
    #[cfg(feature = "gpu")]
    fn fall_back(&mut self, error: GpuError) -> anyhow::Result<()> {
        if self.choice == DeviceChoice::Gpu {
            return Err(error.into());
        }
        self.gpu = None;
        self.reason = Some(error.to_string());
        self.announced = false;
        self.announce_cpu();
        Ok(())
    }

    #[cfg(feature = "gpu")]
    fn announce_gpu(&mut self) {
        if let Some(name) = self.gpu.as_ref().map(|gpu| gpu.name().to_owned()) {
            self.announce(&name);
        }
    }

    fn announce_cpu(&mut self) {
        let threads = rayon::current_num_threads();
        let reason = self.reason.as_ref().map(|reason| format!(" ({reason})")).unwrap_or_default();
        self.announce(&format!("the CPU, {threads} threads{reason}"));
    }

    /// What computed last, for people; empty before anything was computed.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    fn announce(&mut self, name: &str) {
        if !self.announced && !self.general.quiet {
            // Nobody is left to tell if stderr is closed.
            let _ = writeln!(std::io::stderr(), "computing on {name}");
        }
        self.announced = true;
        name.clone_into(&mut self.name);
    }
}

#[cfg(feature = "gpu")]
impl Drop for Device<'_> {
    /// A driver that is still being loaded when the process ends may bring it down.
    fn drop(&mut self) {
        self.wait();
    }
}

/// A device that renders pictures of one scene.
pub(super) struct Renderer<'d, 'a, 's> {
    device: &'d mut Device<'a>,
    scene: Scene<'s>,
    #[cfg(feature = "gpu")]
    uploaded: Option<GpuScene<'s>>,
}

impl<'s> Renderer<'_, '_, 's> {
    /// Renders a picture.
    pub(super) fn render(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> anyhow::Result<Film> {
        #[cfg(feature = "gpu")]
        if let Some(film) = self
            .device
            .on_gpu(self.uploaded.as_ref(), |gpu, uploaded| gpu.render(uploaded, camera, options, progress))?
        {
            return Ok(film);
        }
        self.device.announce_cpu();
        Ok(cpu::render(&self.scene, camera, options, progress))
    }

    /// Renders a picture of light paths. What its layers tell is not of paths: they are those of a picture without.
    pub(super) fn render_paths(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        paths: &PathOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> anyhow::Result<Film> {
        let film = self.trace_paths(camera, options, paths, progress)?;
        if options.layers == Layers::NONE {
            return Ok(film);
        }
        let plain = RenderOptions {
            ambient_occlusion: false,
            samples: options.samples.min(paths.samples),
            ..*options
        };
        let layers = self.render(camera, &plain, &|_, _| {})?;
        Ok(Film { color: film.color, ..layers })
    }

    fn trace_paths(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        paths: &PathOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> anyhow::Result<Film> {
        #[cfg(feature = "gpu")]
        if let Some(film) = self.device.on_gpu(self.uploaded.as_ref(), |gpu, uploaded| {
            gpu.render_paths(uploaded, camera, options, paths, progress)
        })? {
            return Ok(film);
        }
        self.device.announce_cpu();
        Ok(cpu::render_paths(&self.scene, camera, options, paths, progress))
    }

    /// What is rendered.
    pub(super) fn scene(&self) -> Scene<'s> {
        self.scene
    }

    /// All hits of each ray in f32, nearest first, or only the nearest of each.
    pub(super) fn probe(
        &mut self,
        rays: &[Ray],
        first_only: bool,
        exactness: Exactness,
    ) -> anyhow::Result<Vec<Vec<Hit>>> {
        #[cfg(feature = "gpu")]
        if let Some(hits) = self.device.on_gpu(self.uploaded.as_ref(), |gpu, uploaded| {
            gpu.probe_with(uploaded, rays, first_only, exactness)
        })? {
            return Ok(hits);
        }
        Ok(cpu::probe_with(&self.scene, rays, Precision::F32, first_only, exactness))
    }

    /// Brings rays to the GPU, to be traced to their first hits; `None` where that does not compute.
    #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "only a GPU holds rays"))]
    pub(super) fn hold_rays(
        &mut self,
        rays: impl FnOnce() -> Vec<Ray>,
        coherence: Coherence,
    ) -> anyhow::Result<Option<HeldRays>> {
        #[cfg(feature = "gpu")]
        return self.device.on_gpu(self.uploaded.as_ref(), |gpu, uploaded| {
            gpu.hold_rays(uploaded, &rays(), Exactness::default(), coherence)
        });
        #[cfg(not(feature = "gpu"))]
        Ok(None)
    }

    /// Traces them once more.
    #[cfg(feature = "gpu")]
    pub(super) fn run_held(&mut self, work: &HeldRays) -> anyhow::Result<()> {
        let done =
            self.device.on_gpu(self.uploaded.as_ref(), |gpu, uploaded| gpu.run_held(uploaded, work, 1))?;
        done.ok_or_else(|| anyhow::anyhow!("the GPU that holds the rays has failed"))
    }

    /// Without a GPU there is nothing to trace.
    #[cfg(not(feature = "gpu"))]
    pub(super) fn run_held(&mut self, work: &HeldRays) -> anyhow::Result<()> {
        match *work {}
    }

    /// How many there are, and how many have hits.
    pub(super) fn count_held(&mut self, work: &HeldRays) -> anyhow::Result<(u64, u64)> {
        #[cfg(feature = "gpu")]
        {
            let hits = self.device.on_gpu(self.uploaded.as_ref(), |gpu, _| gpu.count_held(work))?;
            Ok((work.count(), hits.unwrap_or(0)))
        }
        #[cfg(not(feature = "gpu"))]
        match *work {}
    }

    /// Renders what trims cost, on the CPU.
    pub(super) fn render_trim_tests(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Film {
        self.device.announce_cpu();
        cpu::render_trim_tests(&self.scene, camera, options, progress)
    }
}

/// A device that answers rays of one scene.
pub(super) struct Prober<'a, 's> {
    device: Device<'a>,
    scene: Scene<'s>,
    precision: Precision,
    exactness: Exactness,
    #[cfg(feature = "gpu")]
    uploaded: Option<GpuScene<'s>>,
}

impl Prober<'_, '_> {
    /// All hits of each ray, nearest first, or only the nearest of each.
    pub(super) fn probe(&mut self, rays: &[Ray], first_only: bool) -> anyhow::Result<Vec<Vec<Hit>>> {
        #[cfg(feature = "gpu")]
        if let Some(hits) = self.device.on_gpu(self.uploaded.as_ref(), |gpu, uploaded| {
            gpu.probe_with(uploaded, rays, first_only, self.exactness)
        })? {
            return Ok(hits);
        }
        if self.device.choice != DeviceChoice::Cpu {
            self.device.announce_cpu();
        }
        Ok(cpu::probe_with(&self.scene, rays, self.precision, first_only, self.exactness))
    }
}
