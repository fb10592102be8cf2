//! A graphics device without a window, and pictures read back from it.
//!
//! In: what the machine has, and `WGPU_BACKEND` in the environment (`vulkan`, `gl`, …; Vulkan and OpenGL
//! if it is not set). Out: a [`Gpu`], or a [`GpuError`] that says what to install. The window makes its
//! own device; this one is for pictures in files, and for tests.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use thiserror::Error;

/// A device with its queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What it is called, and by which interface it is reached.
    pub name: String,
}

/// Why there is no device, or no picture from it.
#[derive(Clone, Debug, Error)]
pub enum GpuError {
    /// There is no adapter.
    #[error(
        "no graphics adapter was found ({0}); install a driver: without a graphics card, Mesa's software \
         renderer will do (Debian and Ubuntu: `apt-get install mesa-vulkan-drivers`)"
    )]
    NoAdapter(String),
    /// The adapter gives no device.
    #[error(
        "the graphics adapter {adapter} cannot be used ({why}); update its driver, or use Mesa's software \
         renderer (Debian and Ubuntu: `apt-get install mesa-vulkan-drivers`, then WGPU_BACKEND=vulkan)"
    )]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What it says.
        why: String,
    },
    /// A picture cannot be read back.
    #[error("the picture could not be read from the graphics device ({0})")]
    Read(String),
}

/// The interfaces that are tried, one after the other: those that the environment names, or Vulkan (on other
/// systems Metal or Direct3D) and then OpenGL.
pub fn backends() -> Vec<wgpu::Backends> {
    match wgpu::Backends::from_env() {
        Some(named) => vec![named],
        None => vec![wgpu::Backends::PRIMARY, wgpu::Backends::GL],
    }
}

impl Gpu {
    /// A device without a window.
    pub fn headless() -> Result<Self, GpuError> {
        let mut tried = backends().into_iter().map(Self::of);
        let first = tried
            .next()
            .unwrap_or_else(|| Self::of(wgpu::Backends::empty()));
        // What the first has to say is more to the point than that the others are not there.
        first.or_else(|error| tried.find_map(Result::ok).ok_or(error))
    }

    /// A device without a window, reached by one of some interfaces.
    pub fn of(backends: wgpu::Backends) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = finish(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        }));
        let adapter = adapter.map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        let info = adapter.get_info();
        let name = format!("{} by {}", info.name, info.backend);
        let device = finish(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("enfilade"),
            required_limits:
                wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
            ..Default::default()
        }));
        let (device, queue) = device.map_err(|error| GpuError::NoDevice {
            adapter: name.clone(),
            why: error.to_string(),
        })?;
        Ok(Self {
            device,
            queue,
            name,
        })
    }

    /// The bytes of a texture of four to a pixel, row after row from the top. It must be one that may be
    /// copied from.
    pub fn read(&self, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
        read(&self.device, &self.queue, texture)
    }
}

/// The bytes of a texture of four to a pixel, row after row from the top. It must be one that may be copied
/// from. Waits for the device.
pub fn read(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let padded = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(height),
            },
        },
        texture.size(),
    );
    let submission = queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody waits any more if the poll failed.
        let _ = sender.send(result);
    });
    let wrong = |why: String| GpuError::Read(why);
    (device.poll(wgpu::PollType::Wait {
        submission_index: Some(submission),
        timeout: None,
    }))
    .map_err(|e| wrong(e.to_string()))?;
    let mapped = receiver.recv().map_err(|e| wrong(e.to_string()))?;
    mapped.map_err(|e| wrong(e.to_string()))?;
    let view = buffer.get_mapped_range(..);
    let view = view.map_err(|e| wrong(e.to_string()))?;
    let rows = view.chunks_exact(padded as usize);
    Ok(rows
        .flat_map(|row| &row[..4 * width as usize])
        .copied()
        .collect())
}

/// Waits for what wgpu answers at once on all systems but the web.
fn finish<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
        std::thread::yield_now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_has_no_adapter_is_told_what_to_install() {
        let error = Gpu::of(wgpu::Backends::empty()).expect_err("there is none");
        let text = error.to_string();
        assert!(
            text.contains("apt-get install mesa-vulkan-drivers"),
            "{text}"
        );
    }

    #[test]
    fn rows_of_any_length_are_read_back() {
        let gpu = match Gpu::headless() {
            Ok(gpu) => gpu,
            Err(error) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                println!("skipped: {error}");
                return;
            }
        };
        let bytes: Vec<u8> = (0..75 * 3 * 4).map(|k| (k % 251) as u8).collect();
        let texture = wgpu::util::DeviceExt::create_texture_with_data(
            &gpu.device,
            &gpu.queue,
            &wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d {
                    width: 75,
                    height: 3,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            },
            wgpu::util::TextureDataOrder::default(),
            &bytes,
        );
        assert_eq!(gpu.read(&texture).expect("it is read"), bytes);
    }
}
