//! Targets that kernels write: the host's side of `shaders/resolve.wgsl`.

use gpu::{Device, Output, Targets};
use pipeline::wgsl::Part;
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

/// The layout of group 2: an output's targets.
pub fn layout(device: &Device, output: Output) -> wgpu::BindGroupLayout {
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
