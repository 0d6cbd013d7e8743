//! Targets that kernels write: the host's side of `shaders/resolve.wgsl`.

use gpu::{Device, Output, Targets};
use pipeline::wgsl::Part;
use scene::Viewport;
use std::collections::HashMap;
use wgpu::ShaderStages;

/// What is seen becomes what is written.
pub const PART: Part = Part { file: "resolve.wgsl", text: include_str!("../../../shaders/resolve.wgsl") };

/// Binding of the first target of an output.
fn first_target(output: Output) -> u32 {
    match output {
        Output::GBuffer => 0,
        Output::Shaded => 4,
    }
}

/// Side of the square of pixels that a workgroup resolves, in `shaders/resolve.wgsl`.
pub const TILE: u32 = 8;

/// Layouts of group 2 and of the pipelines of the kernels that write the targets of an output.
pub type Layouts = HashMap<Output, (wgpu::BindGroupLayout, wgpu::PipelineLayout)>;

/// The layouts of both outputs, where groups 0 and 1 have these.
pub fn layouts(device: &Device, label: &str, groups: [&wgpu::BindGroupLayout; 2]) -> Layouts {
    let of_output = |output| {
        let targets = layout(device, output);
        let pipeline = device.pipeline_layout(label, &[Some(groups[0]), Some(groups[1]), Some(&targets)]);
        (output, (targets, pipeline))
    };
    HashMap::from([Output::GBuffer, Output::Shaded].map(of_output))
}

/// Workgroups that resolve a picture.
pub fn tiles(viewport: Viewport) -> [u32; 2] {
    [viewport.width(), viewport.height()].map(|pixels| (pixels as u32).div_ceil(TILE))
}

/// Clears the targets unless the call numbered 0 is the first that is run: that one clears what nothing is seen in, and the
/// rasterizer takes longer for it.
pub fn clear_unless_first(encoder: &mut wgpu::CommandEncoder, targets: &Targets, first: Option<usize>) {
    if first != Some(0) {
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &targets.cleared(),
            ..Default::default()
        }));
    }
}

/// The layout of group 2: an output's targets.
fn layout(device: &Device, output: Output) -> wgpu::BindGroupLayout {
    let texture = |&format| wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    let bindings = (first_target(output)..).zip(output.formats().iter().map(texture));
    device.group_layout("targets", ShaderStages::COMPUTE, bindings)
}

/// Group 2 of a picture.
pub fn group(device: &Device, layout: &wgpu::BindGroupLayout, targets: &Targets) -> wgpu::BindGroup {
    let views = targets.colour_views.iter().map(wgpu::BindingResource::TextureView);
    device.group("targets", layout, (first_target(targets.output)..).zip(views))
}
