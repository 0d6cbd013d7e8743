//! Shaders that the device has read.

use crate::device::plain;
use crate::{Device, GpuError};
use pipeline::Program;
use std::collections::HashMap;

/// The shaders of the programs that a scene has.
pub type Modules = HashMap<Program, wgpu::ShaderModule>;

impl Device {
    /// A shader module, or the compiler's message.
    pub fn module(&self, program: Program, source: String) -> Result<wgpu::ShaderModule, GpuError> {
        self.guarded("reading a shader", || {
            self.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: None,
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        })
        .map_err(|error| as_shader_error(error, program, "source"))
    }
}

/// A refusal of a shader or its pipeline is the shader's error; any other passes.
pub fn as_shader_error(error: GpuError, program: Program, entry: &'static str) -> GpuError {
    match error {
        GpuError::Refused { message, .. } => {
            GpuError::Shader { program: format!("{program:?}"), entry, message: plain(&message) }
        }
        other => other,
    }
}
