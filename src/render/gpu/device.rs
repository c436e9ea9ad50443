//! The device: which adapter, with which limits, and what to say where there is none.
//!
//! A hardware adapter is preferred, a discrete one before an integrated one. A software adapter (lavapipe and the like) is slower
//! than the CPU tracer, so it counts only where the caller asked for the GPU in so many words, which is how the tests reach it.
//!
//! wgpu reports most mistakes late and by default panics on them. Here the first one is kept and [`Gpu::check`] turns it into an
//! error, so that a shader that does not compile or a lost device ends a render instead of leaving a black picture.

use super::GpuError;
use super::kernels::Kernels;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Storage buffers that one kernel binds: the arrays of a scene and those of its entry file.
pub const STORAGE_BUFFERS: u32 = 16;
/// The same of a software device, where the two records of constants are storage buffers too.
const SOFTWARE_STORAGE_BUFFERS: u32 = STORAGE_BUFFERS + 2;

/// How long submissions may take before the device counts as lost. Dispatches are cut so that the few that are waited for together take far less.
const SUBMISSION_TIMEOUT: Duration = Duration::from_secs(120);
/// The same of a software device, which compiles a kernel when it first runs: a minute on a core of its own, several on a busy one.
const SOFTWARE_TIMEOUT: Duration = Duration::from_secs(1800);

/// Which adapters count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdapterChoice {
    /// Only real GPUs.
    Hardware,
    /// Real GPUs, else software.
    Any,
}

impl AdapterChoice {
    /// `Any` where the environment says `REQUIRE_GPU=1`, else `self`.
    fn or_required(self) -> Self {
        if std::env::var_os("REQUIRE_GPU").is_some_and(|value| value == "1") { Self::Any } else { self }
    }
}

/// An open device with its kernels.
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) kernels: Kernels,
    /// What the last read copied to.
    pub(super) staging: Mutex<Option<wgpu::Buffer>>,
    name: String,
    software: bool,
    failure: Arc<Mutex<Option<GpuError>>>,
}

impl Gpu {
    /// Opens the best adapter.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] where none counts, [`GpuError::Device`] where the best one cannot be opened.
    pub fn new(choice: AdapterChoice) -> Result<Self, GpuError> {
        let adapter = choose_adapter(choice.or_required())?;
        let info = adapter.get_info();
        let (device, queue) = open(&adapter)?;
        let failure = Arc::new(Mutex::new(None));
        let first = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error| keep_first(&first, classify(error))));
        let first = Arc::clone(&failure);
        device.set_device_lost_callback(move |reason, text| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                keep_first(&first, GpuError::Lost(text));
            }
        });
        let software = is_software(&info);
        let kernels = Kernels::new(&device, software);
        let gpu = Self {
            device,
            queue,
            kernels,
            staging: Mutex::new(None),
            name: format!("{} ({})", info.name, info.backend),
            software,
            failure,
        };
        gpu.check()?;
        Ok(gpu)
    }

    /// The adapter's name and its backend, for people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the adapter is a CPU in disguise.
    pub fn is_software(&self) -> bool {
        self.software
    }

    /// The first thing that went wrong since the last call, if any.
    pub(super) fn check(&self) -> Result<(), GpuError> {
        match self.failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Waits for all that was submitted.
    pub(super) fn wait(&self) -> Result<(), GpuError> {
        self.run(self.device.create_command_encoder(&Default::default()).finish())
    }

    /// Submits commands and waits for them.
    pub(super) fn run(&self, commands: wgpu::CommandBuffer) -> Result<(), GpuError> {
        self.check()?;
        let submission_index = Some(self.queue.submit([commands]));
        let timeout = Some(if self.software { SOFTWARE_TIMEOUT } else { SUBMISSION_TIMEOUT });
        let wait = wgpu::PollType::Wait { submission_index, timeout };
        let waited = self.device.poll(wait).map_err(|error| GpuError::Lost(error.to_string()));
        self.check()?;
        waited.map(|_| ())
    }
}

fn keep_first(failure: &Mutex<Option<GpuError>>, error: GpuError) {
    failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
}

fn classify(error: wgpu::Error) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory,
        wgpu::Error::Validation { description, .. } => GpuError::Invalid(description),
        wgpu::Error::Internal { description, .. } => GpuError::Lost(description),
    }
}

fn choose_adapter(choice: AdapterChoice) -> Result<wgpu::Adapter, GpuError> {
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Err(GpuError::NoAdapter("there is no backend for this system".to_owned()));
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let mut refused = Vec::new();
    let mut best: Option<(u32, wgpu::Adapter)> = None;
    for adapter in adapters {
        let info = adapter.get_info();
        match usable(&adapter, choice) {
            Err(reason) => refused.push(format!("{}: {reason}", info.name)),
            Ok(()) => {
                let rank = rank(info.device_type);
                if best.as_ref().is_none_or(|(other, _)| rank < *other) {
                    best = Some((rank, adapter));
                }
            }
        }
    }
    match best {
        Some((_, adapter)) => Ok(adapter),
        None if refused.is_empty() => Err(GpuError::NoAdapter("no driver was found".to_owned())),
        None => Err(GpuError::NoAdapter(refused.join("; "))),
    }
}

fn usable(adapter: &wgpu::Adapter, choice: AdapterChoice) -> Result<(), String> {
    let limits = adapter.limits();
    let software = is_software(&adapter.get_info());
    if choice == AdapterChoice::Hardware && software {
        return Err("a software renderer, slower than the CPU tracer".to_owned());
    }
    if !adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
        return Err("no compute shaders".to_owned());
    }
    let (has, needed) = (limits.max_storage_buffers_per_shader_stage, storage_buffers(software));
    if has < needed {
        return Err(format!("{has} storage buffers in a kernel, {needed} are needed"));
    }
    Ok(())
}

fn is_software(info: &wgpu::AdapterInfo) -> bool {
    info.device_type == wgpu::DeviceType::Cpu
}

fn storage_buffers(software: bool) -> u32 {
    if software { SOFTWARE_STORAGE_BUFFERS } else { STORAGE_BUFFERS }
}

/// Lower is better.
fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn open(adapter: &wgpu::Adapter) -> Result<(wgpu::Device, wgpu::Queue), GpuError> {
    let has = adapter.limits();
    let required_limits = wgpu::Limits {
        max_storage_buffers_per_shader_stage: storage_buffers(is_software(&adapter.get_info())),
        max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
        max_buffer_size: has.max_buffer_size,
        ..wgpu::Limits::defaults().or_worse_values_from(&has)
    };
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("trimray"),
        required_features: wgpu::Features::empty(),
        required_limits,
        ..Default::default()
    };
    pollster::block_on(adapter.request_device(&descriptor))
        .map_err(|error| GpuError::Device(error.to_string()))
}
