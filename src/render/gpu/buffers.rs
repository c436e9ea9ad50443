//! A scene on the device: each array in a buffer of its own, bytes as they are.
//!
//! The Pod arrays of [`Scene`] are the buffers' contents without any conversion, mapped files included. WebGPU knows no empty
//! binding, so an empty array becomes one zeroed element, which no index of a validated scene reaches.

use super::{Entry, Gpu, GpuError};
use crate::render::cpu::ray_space::scene_radius;
use crate::scene::Scene;
use std::sync::{Arc, OnceLock, PoisonError};
use wgpu::util::DeviceExt;

/// The arrays that the kernels read, in the order of their bindings in group 0.
pub const SCENE_BINDINGS: [&str; 12] = [
    "bvh_nodes",
    "primitives",
    "instances",
    "parts",
    "faces",
    "nets",
    "net_leaves",
    "net_points",
    "trim_nodes",
    "trim_segments",
    "trim_points",
    "materials",
];

/// `SceneHeader` of `shaders/types.wgsl`: what kernels need of the scene's header. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SceneHeader {
    grid_step: f32,
    scene_radius: f32,
    node_count: u32,
    reserved: u32,
}

/// The longest record: what an empty array is replaced by.
const DUMMY: [u8; 128] = [0; 128];

/// An uploaded scene, and the one on the host that it mirrors.
pub struct GpuScene<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) bind_group: wgpu::BindGroup,
    bytes: u64,
}

impl GpuScene<'_> {
    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Gpu {
    /// Copies a validated scene to the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] where an array is longer than the device can bind, and the device's own errors.
    pub fn upload<'a>(&self, scene: &Scene<'a>) -> Result<GpuScene<'a>, GpuError> {
        let arrays = scene_arrays(scene);
        let limits = self.device.limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        for (name, bytes) in SCENE_BINDINGS.iter().zip(&arrays) {
            if bytes.len() as u64 > most {
                return Err(GpuError::TooLarge { array: name, bytes: bytes.len() as u64, most });
            }
        }
        let buffers: Vec<wgpu::Buffer> = SCENE_BINDINGS
            .iter()
            .zip(&arrays)
            .map(|(name, bytes)| {
                self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some(name),
                    contents: if bytes.is_empty() { &DUMMY } else { bytes },
                    usage: wgpu::BufferUsages::STORAGE,
                })
            })
            .collect();
        let header = self.create_uniform(
            "header",
            &SceneHeader {
                grid_step: scene.header.grid_step as f32,
                scene_radius: scene_radius(scene.header) as f32,
                node_count: scene.header.node_count,
                reserved: 0,
            },
        );
        let all: Vec<&wgpu::Buffer> = buffers.iter().chain([&header]).collect();
        let bind_group = self.bind_group("scene", &self.kernels.scene_layout, &all);
        self.check()?;
        let bytes = buffers.iter().map(wgpu::Buffer::size).sum();
        Ok(GpuScene { scene: *scene, bind_group, bytes })
    }

    /// A buffer for the kernels to read.
    pub(super) fn create_input(&self, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: bytes,
            usage: wgpu::BufferUsages::STORAGE,
        })
    }

    /// A buffer of constants.
    pub(super) fn create_uniform<T: bytemuck::Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: bytemuck::bytes_of(value),
            // Software devices read it as a storage buffer.
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE,
        })
    }

    /// Group 1 of an entry file: its constants and arrays in the order of their bindings.
    pub(super) fn bind(&self, entry: Entry, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        self.bind_group("entry", self.kernels.entry_layout(entry), buffers)
    }

    fn bind_group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout,
            entries: &entries,
        })
    }

    /// A zeroed buffer for the kernels to write and the host to read.
    pub(super) fn create_output(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Copies the first `count` elements of an output buffer to the host.
    pub(super) fn read<T: bytemuck::Pod>(
        &self,
        buffer: &wgpu::Buffer,
        count: usize,
    ) -> Result<Vec<T>, GpuError> {
        self.read_with(buffer, count, <[T]>::to_vec)
    }

    /// Shows the first `count` elements of an output buffer where the device has copied them to: without a copy of ours.
    pub(super) fn read_with<T: bytemuck::Pod, R>(
        &self,
        buffer: &wgpu::Buffer,
        count: usize,
        use_of: impl FnOnce(&[T]) -> R,
    ) -> Result<R, GpuError> {
        let size = (count * size_of::<T>()) as u64;
        let staging = self.take_staging(size);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
        let mapped = Arc::new(OnceLock::new());
        let commands = encoder.finish();
        self.check()?;
        self.run(commands)?;
        let outcome = Arc::clone(&mapped);
        staging.map_async(wgpu::MapMode::Read, ..size, move |result| {
            let _ = outcome.set(result);
        });
        self.wait()?;
        match mapped.get() {
            Some(Ok(())) => {}
            Some(Err(error)) => return Err(GpuError::Lost(error.to_string())),
            None => return Err(GpuError::Lost("a buffer was not mapped".to_owned())),
        }
        let view =
            staging.slice(..size).get_mapped_range().map_err(|error| GpuError::Lost(error.to_string()))?;
        let values = bytemuck::try_cast_slice(&view)
            .map_err(|error| GpuError::Lost(format!("memory is mapped to an odd place: {error}")))?;
        let answer = use_of(values);
        drop(view);
        staging.unmap();
        *self.staging.lock().unwrap_or_else(PoisonError::into_inner) = Some(staging);
        Ok(answer)
    }

    /// Memory that both the device and the host reach: that of the read before, where it is large enough, as drivers take milliseconds to find some.
    fn take_staging(&self, size: u64) -> wgpu::Buffer {
        let kept = self.staging.lock().unwrap_or_else(PoisonError::into_inner).take();
        kept.filter(|buffer| buffer.size() >= size).unwrap_or_else(|| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("staging"),
                size,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })
    }
}

fn scene_arrays<'a>(scene: &Scene<'a>) -> [&'a [u8]; 12] {
    [
        bytemuck::cast_slice(scene.bvh_nodes),
        bytemuck::cast_slice(scene.primitives),
        bytemuck::cast_slice(scene.instances),
        bytemuck::cast_slice(scene.parts),
        bytemuck::cast_slice(scene.faces),
        bytemuck::cast_slice(scene.nets),
        bytemuck::cast_slice(scene.net_leaves),
        bytemuck::cast_slice(scene.net_points),
        bytemuck::cast_slice(scene.trim_nodes),
        bytemuck::cast_slice(scene.trim_segments),
        bytemuck::cast_slice(scene.trim_points),
        bytemuck::cast_slice(scene.materials),
    ]
}
