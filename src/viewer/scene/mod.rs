//! The picture in space, painted by a graphics card in the order of the BSP tree.
//!
//! In: a [`Painter`] of a level, uploaded once as a [`Scene`]; for each frame a [`Look`]: the camera, which
//! cells to draw. Out: a [`Target`] with the picture, and the same [`Figures`] as the
//! software preview. Both paint the same polygons in the same order, [`Painter::order`]; no depth is compared
//! between them (Fuchs, Kedem, Naylor 1980; lecture, "BSP tree: Painting").
//!
//! | file | what |
//! |---|---|
//! | [`corners`] | polygons as triangles, without gaps between them |
//! | [`texels`] | all pictures in one texture |
//! | [`things`] | objects as triangles, cut at the borders of cells |
//! | [`pipelines`] | how triangles become pixels, and what they are painted on |
//! | `shader.wgsl` | the software painter's rules for colours |
//!
//! What differs from the software preview: pixels on the edges of polygons, since graphics cards count
//! in another way where an edge lies; round objects have sides; a pane of glass rounds twice; of several
//! objects of glass behind each other in one cell all are seen, not the nearest alone; an eye within an object
//! looks out of it. Objects of one cell are told apart by a depth buffer, which nothing else looks at.

pub mod corners;
pub mod pipelines;
pub mod texels;
pub mod things;

use std::ops::Range;

use glam::{DVec2, DVec3};
use wgpu::util::DeviceExt;

use corners::Skins;
pub use pipelines::{Pipelines, Target};
use texels::Texels;
use things::Things;

use crate::preview::coat::AFAR;
use crate::preview::{Culling, Easel, Figures, Painter, Turn};
use crate::trace::beam::Bundle;
use crate::trace::camera::Camera;
use crate::trace::dress::sky_place;
use crate::trace::world::EyeError;

/// Columns of the texture with all texels.
const COLUMNS: u32 = 4096;
/// Nothing is drawn nearer to the eye than this share of the distance at which light fades.
const NEAR: f64 = 1e-5;
/// Where there is nothing.
const BACKGROUND: [f64; 3] = [0.07, 0.075, 0.085];

/// What is to be seen.
#[derive(Clone, Debug)]
pub struct Look<'a> {
    /// The eye, and the size of the picture.
    pub camera: &'a Camera,
    /// Which cells are drawn.
    pub culling: Culling,
    /// Another eye that the cells are chosen for, as when one freezes what is drawn and walks around it.
    pub chosen_for: Option<&'a Camera>,
    /// Whether pictures are smoothed where they are small. The software preview does not.
    pub smooth: bool,
    /// Whether objects are drawn.
    pub objects: bool,
}

/// What a frame came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// What is drawn. What lies within the picture is not counted.
    pub figures: Figures,
    /// Why all cells are drawn although others were asked for: the eye is in none.
    pub unculled: Option<EyeError>,
    /// Draw calls.
    pub calls: u32,
}

/// What is drawn in one call, or two.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Run {
    /// Triangles of this frame's list.
    Solid(Range<u32>),
    Glass(Range<u32>),
    /// Corners of objects.
    Things(Range<u32>),
    Clear(Range<u32>),
}

/// A level on the graphics card.
pub struct Scene {
    skins: Skins,
    things: Things,
    origin: DVec3,
    dusk: f64,
    sky: [u32; 4],
    group: wgpu::BindGroup,
    globals: wgpu::Buffer,
    corners: wgpu::Buffer,
    things_corners: wgpu::Buffer,
    triangles: Growing,
    /// Of this frame.
    runs: Vec<Run>,
    list: Vec<u32>,
}

/// A buffer that is made larger when it is too small.
struct Growing {
    buffer: wgpu::Buffer,
    usage: wgpu::BufferUsages,
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Globals {
    across: [f32; 4],
    up: [f32; 4],
    depth: [f32; 4],
    eye: [f32; 4],
    light: [f32; 4],
    sky: [u32; 4],
}

impl Scene {
    /// Uploads a level.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        painter: &Painter,
    ) -> Self {
        let (world, brushes) = (painter.world(), painter.brushes());
        let bounds = world.bounds();
        // Whole, so that whole coordinates stay so.
        let origin = ((bounds.min + bounds.max) / 2.0).floor();
        let rows = device.limits().max_texture_dimension_2d;
        let most = COLUMNS as usize * rows as usize;
        let texels = Texels::new(world, &brushes.coats, most);
        let parts = (&brushes.polygons, &brushes.coats);
        let skins = Skins::new(&world.space, parts, &texels, origin);
        let dressed = (&brushes.coats, brushes.finish);
        let things = Things::new(world, dressed, &texels, origin);
        let buffer = |label, bytes: &[u8], usage| {
            // There is always something, so that an empty list needs no care.
            let contents = if bytes.is_empty() { &[0; 64] } else { bytes };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let globals = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = upload(device, queue, &texels);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &pipelines.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: globals.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&view),
                },
            ],
        });
        let vertex = wgpu::BufferUsages::VERTEX;
        Self {
            corners: buffer("corners", bytemuck::cast_slice(&skins.corners), vertex),
            things_corners: buffer("things", bytemuck::cast_slice(&things.corners), vertex),
            triangles: Growing::new(device, wgpu::BufferUsages::INDEX),
            dusk: brushes.coats.dusk(),
            sky: texels.sky,
            skins,
            things,
            origin,
            group,
            globals,
            runs: Vec::new(),
            list: Vec::new(),
        }
    }

    /// Makes the next frame ready: chooses the cells, and puts their polygons in order. `painter` is of the
    /// level that was uploaded. O(polygons of the chosen cells).
    ///
    /// # Errors
    /// The eye is beyond the grid, where no order is known: nothing is drawn.
    pub fn prepare(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        painter: &Painter,
        look: &Look,
        easel: &mut Easel,
    ) -> Result<Frame, EyeError> {
        self.runs.clear();
        self.list.clear();
        let eye = look.camera.eye;
        let chooser = look.chosen_for.unwrap_or(look.camera);
        let mut unculled = painter.choose(chooser, look.culling, easel).err();
        if look.culling == Culling::None {
            unculled = None;
        } else if unculled.is_some() {
            // It fails once more, but then all cells are chosen.
            let _ = painter.choose(chooser, Culling::None, easel);
        }
        let Self {
            skins,
            things,
            runs,
            list,
            ..
        } = self;
        let mut figures = painter.order(eye, easel, |turn| match turn {
            Turn::Polygon(polygon) => {
                for skin in skins.of(polygon) {
                    let start = list.len() as u32;
                    let own = skin.range.start as usize..skin.range.end as usize;
                    list.extend_from_slice(&skins.triangles[own]);
                    let own = start..list.len() as u32;
                    // What follows in the same manner is drawn in the same call.
                    match (runs.last_mut(), skin.glass) {
                        (Some(Run::Solid(last)), false) => last.end = own.end,
                        (_, false) => runs.push(Run::Solid(own)),
                        (_, true) => runs.push(Run::Glass(own)),
                    }
                }
            }
            Turn::Objects(cell) if look.objects => {
                let group = things.in_cell(cell);
                if !group.opaque.is_empty() {
                    runs.push(Run::Things(group.opaque.clone()));
                }
                let mut glass: Vec<_> = group.glass.iter().collect();
                glass.sort_by(|(p, _), (q, _)| {
                    let far = |m: &DVec3| m.distance_squared(eye);
                    far(q).total_cmp(&far(p))
                });
                let ranges = glass.into_iter().map(|(_, range)| range.clone());
                runs.extend(ranges.filter(|r| !r.is_empty()).map(Run::Clear));
            }
            Turn::Objects(_) => {}
        })?;
        if !look.objects {
            figures.objects = 0;
        }
        let list = bytemuck::cast_slice(&self.list);
        self.triangles.write(device, queue, list);
        let globals = self.globals_of(look);
        queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&globals));
        let calls = self.runs.iter().map(|run| match run {
            Run::Solid(_) | Run::Things(_) => 1,
            Run::Glass(_) | Run::Clear(_) => 2,
        });
        Ok(Frame {
            figures,
            unculled,
            calls: calls.sum(),
        })
    }

    fn globals_of(&self, look: &Look) -> Globals {
        let camera = look.camera;
        let [width, height] = camera.size.map(f64::from);
        let fan = camera.fan();
        let (right, up) = (fan.across * (width / 2.0), fan.down * (height / -2.0));
        let row = |v: DVec3, w: f64| v.extend(w).as_vec4().to_array();
        Globals {
            across: row(right / right.length_squared(), 0.0),
            up: row(up / up.length_squared(), 0.0),
            depth: row(fan.direction(DVec2::new(width, height) / 2.0), 0.0),
            eye: row(camera.eye - self.origin, self.dusk * NEAR),
            light: [
                self.dusk as f32,
                AFAR as f32,
                f32::from(u8::from(look.smooth)),
                sky_place(DVec3::X).y as f32,
            ],
            sky: self.sky,
        }
    }

    /// Paints the frame that was made ready.
    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines, target: &Target) {
        let mut pass = target.begin(encoder, BACKGROUND);
        pass.set_bind_group(0, &self.group, &[]);
        let triangles = self.triangles.buffer.slice(..);
        pass.set_index_buffer(triangles, wgpu::IndexFormat::Uint32);
        for run in &self.runs {
            match run {
                Run::Solid(list) => {
                    pass.set_pipeline(&pipelines.solid);
                    pass.set_vertex_buffer(0, self.corners.slice(..));
                    pass.draw_indexed(list.clone(), 0, 0..1);
                }
                Run::Glass(list) => {
                    pass.set_vertex_buffer(0, self.corners.slice(..));
                    for pipeline in &pipelines.glass {
                        pass.set_pipeline(pipeline);
                        pass.draw_indexed(list.clone(), 0, 0..1);
                    }
                }
                Run::Things(corners) => {
                    pass.set_pipeline(&pipelines.things);
                    pass.set_vertex_buffer(0, self.things_corners.slice(..));
                    pass.draw(corners.clone(), 0..1);
                }
                Run::Clear(corners) => {
                    pass.set_vertex_buffer(0, self.things_corners.slice(..));
                    for pipeline in &pipelines.clear {
                        pass.set_pipeline(pipeline);
                        pass.draw(corners.clone(), 0..1);
                    }
                }
            }
        }
    }
}

/// All texels as a texture; what is left of its last row is empty.
fn upload(device: &wgpu::Device, queue: &wgpu::Queue, texels: &Texels) -> wgpu::TextureView {
    let n = texels.list.len().max(1);
    let columns = COLUMNS.min(n as u32);
    let rows = n.div_ceil(columns as usize) as u32;
    let mut list = texels.list.clone();
    list.resize(columns as usize * rows as usize, 0);
    let texture = device.create_texture_with_data(
        queue,
        &wgpu::TextureDescriptor {
            label: Some("texels"),
            size: wgpu::Extent3d {
                width: columns,
                height: rows,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::default(),
        bytemuck::cast_slice(&list),
    );
    texture.create_view(&Default::default())
}

impl Growing {
    fn new(device: &wgpu::Device, usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let buffer = Self::buffer(device, usage, 1 << 16);
        Self { buffer, usage }
    }

    fn buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) {
        let size = bytes.len() as u64;
        if size > self.buffer.size() {
            self.buffer = Self::buffer(device, self.usage, size.next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
    }
}

#[cfg(test)]
mod tests;
