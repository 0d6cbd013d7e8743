//! What stands in `capsule.json` and in `answer.json`: WebGPU's own words wherever it has one, so that a host passes them on.
//!
//! Objects are named by their place in their list. `testdata/schema/capsule-1.json` is the same as a JSON schema.

use super::commands::{Command, Range};
use gbuffer::Meta;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wgpu::{
    BlendState, CompareFunction, StorageTextureAccess, TextureFormat, TextureViewDimension, VertexAttribute,
    VertexStepMode,
};

/// The file of a capsule that names all others.
pub const CAPSULE_FILE: &str = "capsule.json";

/// The file of an answer that names all others.
pub const ANSWER_FILE: &str = "answer.json";

/// Marks a capsule, and the version of its layout.
pub const SCHEMA: (&str, u32) = ("isophote-capsule", 1);

/// Marks an answer, and the version of its layout.
pub const ANSWER_SCHEMA: (&str, u32) = ("isophote-answer", 1);

/// What is read of the four targets, in the order of `GBufferOutput` in `shaders/output.wgsl`.
pub const TARGETS: [&str; 4] = ["identity", "position", "normal", "shape"];

/// What is read of the marks of undecided pixels.
pub const UNDECIDED: &str = "undecided";

/// What is read of the count of what there may be too little room for.
pub const COUNT: &str = "count";

/// A picture, ready to be drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Capsule {
    /// The first of `SCHEMA`.
    pub schema: String,
    /// The second.
    pub schema_version: u32,
    /// What the G-buffer is made of beside what is read; none where no G-buffer is, as where a rasterizer is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<Picture>,
    /// Limits of WebGPU that must be raised, by name.
    pub limits: BTreeMap<String, u64>,
    /// Every file beside this one.
    pub files: Vec<File>,
    /// Shaders, each a file of WGSL.
    pub modules: Vec<Module>,
    /// Buffers; all zeros at first.
    pub buffers: Vec<Buffer>,
    /// Textures of two dimensions, one level and one sample, each with one view.
    pub textures: Vec<Texture>,
    /// `GPUBindGroupLayout`s.
    pub group_layouts: Vec<GroupLayout>,
    /// `GPUBindGroup`s.
    pub groups: Vec<Group>,
    /// `GPUPipelineLayout`s: of each group its layout, or null.
    pub pipeline_layouts: Vec<Vec<Option<usize>>>,
    /// `GPUComputePipeline`s.
    pub compute_pipelines: Vec<ComputePipeline>,
    /// `GPURenderPipeline`s of triangle lists, nothing culled.
    pub render_pipelines: Vec<RenderPipeline>,
    /// What is done, in order.
    pub commands: Vec<Command>,
    /// What is handed back.
    pub reads: Vec<Read>,
    /// The greatest `COUNT` with which nothing is lost.
    pub room: Option<u64>,
}

/// What the G-buffer is made of beside what is read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Picture {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Whether hits have curvatures.
    pub curvature: bool,
    /// Whether trim edges were looked for.
    pub edges: bool,
    /// The facts of the G-buffer; adapter, driver and compiler are the host's.
    pub meta: Meta,
    /// How each face's numbers become the model's.
    pub faces: Vec<Face>,
}

/// How a face's numbers become the model's: `pipeline::PackedFrame`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Face {
    /// World position of the local origin.
    pub origin: [f64; 3],
    /// Model units a local unit.
    pub scale: f64,
    /// The ends of its knot spans in u and v, ascending.
    pub breaks: [Vec<f64>; 2],
}

/// A file of a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct File {
    /// Its name.
    pub name: String,
    /// How long it is.
    pub bytes: u64,
    /// 64-bit FNV-1a of its bytes, 16 hexadecimal digits.
    pub hash: String,
}

/// A shader.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Module {
    /// Its WGSL.
    pub file: String,
}

/// `GPUBufferDescriptor`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Buffer {
    /// What it holds.
    pub label: String,
    /// Bytes.
    pub size: u64,
    /// `GPUBufferUsage`.
    pub usage: u32,
}

/// `GPUTextureDescriptor`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Texture {
    /// What it holds.
    pub label: String,
    /// `GPUTextureFormat`.
    pub format: TextureFormat,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// `GPUTextureUsage`.
    pub usage: u32,
}

/// `GPUBindGroupLayoutDescriptor`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct GroupLayout {
    /// Its bindings.
    pub entries: Vec<LayoutEntry>,
}

/// `GPUBindGroupLayoutEntry`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct LayoutEntry {
    /// Which.
    pub binding: u32,
    /// `GPUShaderStage`.
    pub visibility: u32,
    /// The one member that the entry has beside these.
    pub resource: Binding,
}

/// `GPUBufferBindingLayout`, `GPUTextureBindingLayout` or `GPUStorageTextureBindingLayout`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase", deny_unknown_fields)]
pub enum Binding {
    Buffer {
        #[serde(rename = "type")]
        kind: BufferKind,
        has_dynamic_offset: bool,
    },
    Texture {
        sample_type: SampleType,
        view_dimension: TextureViewDimension,
    },
    StorageTexture {
        access: StorageTextureAccess,
        format: TextureFormat,
        view_dimension: TextureViewDimension,
    },
}

/// `GPUBufferBindingType`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BufferKind {
    Uniform,
    Storage,
    ReadOnlyStorage,
}

/// `GPUTextureSampleType`; only masks are looked up, by whole texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SampleType {
    UnfilterableFloat,
}

/// `GPUBindGroupDescriptor`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Group {
    /// Its layout.
    pub layout: usize,
    /// Its resources.
    pub entries: Vec<GroupEntry>,
}

/// `GPUBindGroupEntry`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct GroupEntry {
    /// Which.
    pub binding: u32,
    /// What is bound.
    pub resource: Resource,
}

/// What is bound: a part of a buffer, or a texture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub enum Resource {
    /// `GPUBufferBinding`.
    Buffer(Range),
    /// Its one view.
    Texture(usize),
}

/// `GPUProgrammableStage`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Stage {
    /// Its shader.
    pub module: usize,
    /// A function there.
    pub entry_point: String,
    /// Values of `override`s.
    pub constants: BTreeMap<String, f64>,
}

/// `GPUComputePipelineDescriptor`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct ComputePipeline {
    /// Its layout.
    pub layout: usize,
    /// What runs.
    pub compute: Stage,
}

/// `GPURenderPipelineDescriptor`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct RenderPipeline {
    /// Its layout.
    pub layout: usize,
    /// What runs for each vertex.
    pub vertex: Stage,
    /// What it fetches.
    pub buffers: Vec<VertexBuffer>,
    /// What runs for each fragment.
    pub fragment: Stage,
    /// What it writes.
    pub targets: Vec<Target>,
    /// The depth test, where there is one.
    pub depth: Option<Depth>,
}

/// `GPUVertexBufferLayout`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct VertexBuffer {
    /// Bytes a vertex.
    pub array_stride: u64,
    /// `GPUVertexStepMode`.
    pub step_mode: VertexStepMode,
    /// `GPUVertexAttribute`s.
    pub attributes: Vec<VertexAttribute>,
}

/// `GPUColorTargetState`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Target {
    /// `GPUTextureFormat`.
    pub format: TextureFormat,
    /// `GPUBlendState`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<BlendState>,
    /// `GPUColorWrite`.
    pub write_mask: u32,
}

/// `GPUDepthStencilState` without a stencil.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Depth {
    /// `GPUTextureFormat`.
    pub format: TextureFormat,
    /// Whether a fragment that passes leaves its depth.
    pub depth_write_enabled: bool,
    /// Which pass.
    pub depth_compare: CompareFunction,
}

/// What is handed back: a file of an answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Read {
    /// One of `TARGETS`, `UNDECIDED` or `COUNT`; the file is this with `.bin`.
    pub name: String,
    /// A texture's rows from the top, without padding, or a buffer's bytes.
    pub of: Resource,
}

/// Who answers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Host {
    /// Name of the adapter.
    pub adapter: String,
    /// Its driver and the version of it.
    pub driver: String,
    /// The API that it is reached through.
    pub backend: String,
    /// What made its programs of WGSL.
    pub compiler: String,
}

/// What a host hands back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Answer {
    /// The first of `ANSWER_SCHEMA`.
    pub schema: String,
    /// The second.
    pub schema_version: u32,
    /// 64-bit FNV-1a of the capsule's [`CAPSULE_FILE`].
    pub capsule: String,
    /// Who answers.
    pub host: Host,
    /// A file each of [`Capsule::reads`].
    pub files: Vec<File>,
}
