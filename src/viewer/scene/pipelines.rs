//! How triangles become pixels: the pipelines, and what is painted on.
//!
//! Polygons cover what was painted before, whatever it was: no depth is compared, their order is the
//! tree's. Objects do so too, but for other objects: those of one cell have no order, so they compare depths
//! among themselves. What is in a farther cell is farther, so one depth buffer does for all cells.
//! Glass is painted twice: once it dims what is behind, once it adds its own colour.

use std::mem::offset_of;

use super::corners::Corner;

/// Colours are bytes as the screen has them, and are mixed as such; egui shows textures of this kind.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Of the depths of objects.
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The pipelines, made once for a device.
pub struct Pipelines {
    /// Samples of a pixel.
    pub samples: u32,
    pub(super) layout: wgpu::BindGroupLayout,
    /// Polygons that cover.
    pub(super) solid: wgpu::RenderPipeline,
    /// Polygons of glass: what passes, what is added.
    pub(super) glass: [wgpu::RenderPipeline; 2],
    /// Objects that cover.
    pub(super) things: wgpu::RenderPipeline,
    /// Objects of glass.
    pub(super) clear: [wgpu::RenderPipeline; 2],
}

/// How a pipeline paints.
struct Manner {
    fragment: &'static str,
    blend: Option<wgpu::BlendState>,
    /// Whether depths are compared, and whether they are kept.
    depth: (bool, bool),
}

impl Pipelines {
    /// Pipelines that take 1 or 4 samples of a pixel.
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        let shader = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: stages,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Uint,
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
            ],
        });
        let own = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let make = |manner: &Manner| pipeline(device, (&shader, &own), manner, samples);
        let covers = |depth| Manner {
            fragment: "solid",
            blend: None,
            depth,
        };
        let glass = |compare| {
            [("tint", TINT), ("add", ADD)].map(|(fragment, blend)| Manner {
                fragment,
                blend: Some(blend),
                depth: (compare, false),
            })
        };
        Self {
            samples,
            solid: make(&covers((false, false))),
            glass: glass(false).map(|m| make(&m)),
            things: make(&covers((true, true))),
            clear: glass(true).map(|m| make(&m)),
            layout,
        }
    }
}

/// The opacity that is there.
const KEEP: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Zero,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};
const TINT: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEEP,
};
const ADD: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEEP,
};

fn pipeline(
    device: &wgpu::Device,
    (module, layout): (&wgpu::ShaderModule, &wgpu::PipelineLayout),
    manner: &Manner,
    samples: u32,
) -> wgpu::RenderPipeline {
    use wgpu::VertexFormat as Form;
    let attribute = |format, offset: usize, shader_location| wgpu::VertexAttribute {
        format,
        offset: offset as u64,
        shader_location,
    };
    let corner = [
        attribute(Form::Float32x3, offset_of!(Corner, place), 0),
        attribute(Form::Float32x2, offset_of!(Corner, uv), 1),
        attribute(Form::Snorm16x4, offset_of!(Corner, normal), 2),
        attribute(Form::Uint32x4, offset_of!(Corner, paint), 3),
        attribute(Form::Float32, offset_of!(Corner, light), 4),
    ];
    let (compare, keep) = manner.depth;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(manner.fragment),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Corner>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &corner,
            })],
        },
        primitive: wgpu::PrimitiveState {
            // Polygons that show their backs are left out before; objects' backs are here.
            cull_mode: compare.then_some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(keep),
            // 1 is near, 0 infinitely far.
            depth_compare: Some(if compare {
                wgpu::CompareFunction::GreaterEqual
            } else {
                wgpu::CompareFunction::Always
            }),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: samples,
            ..Default::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(manner.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: FORMAT,
                blend: manner.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// What is painted on.
pub struct Target {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// The picture: sRGB bytes in a texture that can be shown, and copied.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
    /// The samples of its pixels, if they have several.
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

impl Target {
    /// An empty picture of at least one pixel, with as many samples as the pipelines take.
    pub fn new(device: &wgpu::Device, pipelines: &Pipelines, size: [u32; 2]) -> Self {
        use wgpu::TextureUsages as Usage;
        let size = size.map(|n| n.max(1));
        let make = |format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let n = pipelines.samples;
        let shown = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let texture = make(FORMAT, 1, shown);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Self {
            size,
            view: view(&texture),
            samples: (n > 1).then(|| view(&make(FORMAT, n, Usage::RENDER_ATTACHMENT))),
            depth: view(&make(DEPTH, n, Usage::RENDER_ATTACHMENT)),
            texture,
        }
    }

    /// Begins to paint on it, from one colour.
    pub(super) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        background: [f64; 3],
    ) -> wgpu::RenderPass<'e> {
        let [r, g, b] = background;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.samples.as_ref().unwrap_or(&self.view),
                depth_slice: None,
                resolve_target: self.samples.as_ref().map(|_| &self.view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: match self.samples {
                        Some(_) => wgpu::StoreOp::Discard,
                        None => wgpu::StoreOp::Store,
                    },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}
