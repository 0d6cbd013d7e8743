//! What a capsule does, command by command, in WebGPU's own words.

use serde::{Deserialize, Serialize};
use wgpu::{Color, IndexFormat};

/// Bytes of a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Range {
    /// Which.
    pub buffer: usize,
    /// The first byte.
    pub offset: u64,
    /// How many.
    pub size: u64,
}

/// What is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase", deny_unknown_fields)]
pub enum Command {
    /// `GPUQueue.writeBuffer` with the bytes of a file.
    Write {
        /// To which.
        buffer: usize,
        /// From which byte on.
        offset: u64,
        /// The file.
        file: String,
    },
    /// `GPUCommandEncoder.clearBuffer`.
    Clear(Range),
    /// A compute pass.
    Compute {
        /// What is done in it.
        steps: Vec<ComputeStep>,
    },
    /// A render pass.
    Render {
        /// What is drawn to.
        colors: Vec<Attachment>,
        /// The depth buffer.
        depth: Option<DepthAttachment>,
        /// What is done in it.
        steps: Vec<RenderStep>,
    },
}

/// `GPURenderPassColorAttachment`; what is drawn is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Attachment {
    /// Which.
    pub texture: usize,
    /// What it is cleared to; null where it is kept.
    pub clear: Option<Color>,
}

/// `GPURenderPassDepthStencilAttachment`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct DepthAttachment {
    /// Which.
    pub texture: usize,
    /// What it is cleared to; null where it is kept.
    pub clear: Option<f32>,
    /// Whether it is needed afterwards.
    pub store: bool,
}

/// `setBindGroup`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SetGroup {
    /// As which.
    pub index: u32,
    /// Which.
    pub group: usize,
    /// Its dynamic offsets.
    pub offsets: Vec<u32>,
}

/// A call of `GPUComputePassEncoder`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub enum ComputeStep {
    /// `setPipeline`.
    Pipeline(usize),
    /// `setBindGroup`.
    Group(SetGroup),
    /// `dispatchWorkgroups`.
    Dispatch([u32; 3]),
}

/// A call of `GPURenderPassEncoder`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase", deny_unknown_fields)]
pub enum RenderStep {
    /// `setPipeline`.
    Pipeline(usize),
    /// `setBindGroup`.
    Group(SetGroup),
    /// `setViewport`: x, y, width, height, least and greatest depth.
    Viewport([f32; 6]),
    /// `setVertexBuffer`.
    VertexBuffer {
        /// As which.
        slot: u32,
        /// Of which bytes.
        range: Range,
    },
    /// `setIndexBuffer`.
    IndexBuffer {
        /// `GPUIndexFormat`.
        format: IndexFormat,
        /// Of which bytes.
        range: Range,
    },
    /// `draw`: vertices, instances, first vertex, first instance.
    Draw([u32; 4]),
    /// `drawIndexed`: indices, instances, first index, base vertex, first instance.
    DrawIndexed([i64; 5]),
    /// `drawIndexedIndirect`.
    DrawIndexedIndirect {
        /// Where the call stands.
        buffer: usize,
        /// Bytes before it.
        offset: u64,
    },
}
