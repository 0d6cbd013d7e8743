//! One operation of a strict program at given operands: what a host makes of it, to be held against Rust's own.

use crate::groups::{READ, UNIFORM, WRITE, whole, workgroups};
use crate::{Device, GpuError, ieee};
use pipeline::Program;
use wgpu::{BufferUsages, ShaderStages};

/// The program, up to the operation.
const OPERATE: &str = concat!(
    include_str!("../../../shaders/raster/strict.wgsl"),
    include_str!("../../../shaders/raster/operation.wgsl")
);

/// Size of a workgroup in `shaders/raster/operation.wgsl`.
const WORKGROUP: u32 = 64;

const OPERATING: &str = "running an operation";

/// An operation on floats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// a + b.
    Sum,
    /// a − b.
    Difference,
    /// a b.
    Product,
    /// a / b.
    Quotient,
    /// √a.
    Root,
    /// 1 where a < b, else 0.
    Less,
    /// a b + a, which an adapter may fuse.
    ProductAndSum,
    /// The same by functions that have a barrier of their own, so that there are two, one behind the other.
    TwiceKept,
    /// a b − b a, which is zero unless one product is fused.
    Products,
    /// What is lost of a + b by rounding (Knuth's TwoSum), which is zero for a compiler that takes floats for real numbers.
    Rounding,
}

impl Operation {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Sum,
        Self::Difference,
        Self::Product,
        Self::Quotient,
        Self::Root,
        Self::Less,
        Self::ProductAndSum,
        Self::TwiceKept,
        Self::Products,
        Self::Rounding,
    ];

    fn text(self) -> &'static str {
        match self {
            Self::Sum => "a + b",
            Self::Difference => "a - b",
            Self::Product => "a * b",
            Self::Quotient => "a / b",
            Self::Root => "sqrt(a)",
            Self::Less => "select(0.0, 1.0, a < b)",
            Self::ProductAndSum => "a * b + a",
            Self::TwiceKept => "sum(product(a, b), a)",
            Self::Products => "a * b - b * a",
            Self::Rounding => "(a - ((a + b) - ((a + b) - a))) + (b - ((a + b) - a))",
        }
    }

    /// What Rust makes of it.
    pub fn exact(self, [a, b]: [f32; 2]) -> f32 {
        match self {
            Self::Sum => a + b,
            Self::Difference => a - b,
            Self::Product => a * b,
            Self::Quotient => a / b,
            Self::Root => a.sqrt(),
            Self::Less => f32::from(u8::from(a < b)),
            Self::ProductAndSum | Self::TwiceKept => a * b + a,
            Self::Products => {
                let turned = b * a;
                a * b - turned
            }
            Self::Rounding => (a - ((a + b) - ((a + b) - a))) + (b - ((a + b) - a)),
        }
    }
}

/// An operation in a strict program, compiled.
pub struct Operator<'d> {
    device: &'d Device,
    pipeline: wgpu::ComputePipeline,
    operands: wgpu::BindGroupLayout,
    zeros: wgpu::BindGroup,
}

impl<'d> Operator<'d> {
    /// Compiles it, with subnormal numbers or without. `edit` changes the program's text, so that a test can
    /// plant a fault.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the text is illegal; [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(
        device: &'d Device,
        operation: Operation,
        subnormals: bool,
        edit: &dyn Fn(String) -> String,
    ) -> Result<Self, GpuError> {
        let result = format!("fn result(a: f32, b: f32) -> f32 {{ return {}; }}\n", operation.text());
        let program = Program::General;
        let module = device.module(program, edit(ieee::strict(&format!("{OPERATE}{result}"))?))?;
        let buffer = device.buffer("zeros", BufferUsages::UNIFORM, &[])?;
        let (layout, operands, zeros) = device.guarded(OPERATING, || {
            let operands = device.group_layout("operands", ShaderStages::COMPUTE, (0..).zip([READ, WRITE]));
            let barrier = device.group_layout("zeros", ShaderStages::COMPUTE, [(5, UNIFORM)]);
            let layout = device.pipeline_layout("operation", &[Some(&operands), Some(&barrier)]);
            let zeros = device.group("zeros", &barrier, [(5, buffer.as_entire_binding())]);
            (layout, operands, zeros)
        })?;
        let pipeline = device.kernel(&layout, (program, &module), "operate", &ieee::constants(subnormals))?;
        Ok(Self { device, pipeline, operands, zeros })
    }

    /// What the device makes of each pair of operands; `None` where a subnormal number was raised.
    ///
    /// # Errors
    /// [`GpuError::Limit`] where there are too many at once; [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
    pub fn results(&self, operands: &[[f32; 2]]) -> Result<Vec<Option<f32>>, GpuError> {
        let Self { device, pipeline, .. } = self;
        let asked = device.storage("operands", bytemuck::cast_slice(operands))?;
        let answered = device.empty("results", 8 * operands.len().max(1) as u64)?;
        let encoder = device.guarded(OPERATING, || {
            let group = device.group("operands", &self.operands, whole([&asked, &answered]));
            let mut encoder = device.wgpu.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &self.zeros, &[]);
            let [x, y] = workgroups(operands.len() as u32, WORKGROUP);
            pass.dispatch_workgroups(x, y, 1);
            drop(pass);
            encoder
        })?;
        device.submit(OPERATING, encoder)?;
        let mut results = vec![[0u32; 2]; operands.len()];
        device.read_buffer(OPERATING, &answered, 0, bytemuck::cast_slice_mut(&mut results))?;
        Ok(results.into_iter().map(|[bits, raised]| (raised == 0).then_some(f32::from_bits(bits))).collect())
    }
}
