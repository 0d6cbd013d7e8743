//! The fragment program at given parameters, in a compute shader: no triangles, no interpolation, no coverage.

use crate::buffers::SceneBuffers;
use crate::groups::{READ, WRITE, whole};
use crate::masks::MaskBlend;
use crate::readback::Record;
use crate::{Device, GpuError};
use bytemuck::{Pod, Zeroable};
use pipeline::fragment::Fragment;
use pipeline::wgsl::{self, Part, Variant};
use pipeline::{PackedScene, Parameters, Program, TrimMethod};
use wgpu::ShaderStages;

/// The compute entry point `probe`.
pub const PROBE: &[Part] = &[Part { file: "probe.wgsl", text: include_str!("../../../shaders/probe.wgsl") }];

/// Queries answered in one dispatch: WebGPU promises 65,535 workgroups, and a workgroup answers 64.
const GREATEST_DISPATCH: usize = 65_535 * WORKGROUP;

/// Size of a workgroup in `shaders/probe.wgsl`.
const WORKGROUP: usize = 64;

/// What answers hold before they are written: no face, no status, no span; as floats, NaN.
const UNANSWERED: u32 = u32::MAX;

const PROBING: &str = "probing";

/// `MATERIAL` in `shaders/probe.wgsl`.
const MATERIAL: u32 = 0x100;

/// One question, `ProbeQuery` in `shaders/probe.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Query {
    uv: [f32; 2],
    span: [u32; 2],
    face: u32,
    padding: u32,
}

/// Runs `program` with curvature for each face and place of it, and returns its answers in order.
///
/// The queries' faces must be of that program. It is the same text as a renderer's, but the driver compiles it for
/// another stage.
///
/// # Errors
/// [`GpuError::ProbeFace`], [`GpuError::Unanswered`], [`GpuError::Limit`] where the scene or a dispatch does not fit;
/// [`GpuError::Shader`], [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
pub fn probe(
    device: &Device,
    scene: &PackedScene,
    program: Program,
    queries: &[(u32, Parameters)],
) -> Result<Vec<Fragment>, GpuError> {
    let plain = |mut record: Record| {
        record.identity[1] &= !MATERIAL;
        record.fragment()
    };
    Ok(answers(device, scene, program, queries)?.into_iter().map(plain).collect())
}

/// Whether the face has material, for each face and (u, v) of its whole domain, 0 … 1, in order: the trimming of `program`, asked as [`probe()`]
/// asks the rest of it.
///
/// # Errors
/// As [`probe()`].
pub fn probe_material(
    device: &Device,
    scene: &PackedScene,
    program: Program,
    queries: &[(u32, [f32; 2])],
) -> Result<Vec<bool>, GpuError> {
    let is_material = |record: Record| record.identity[1] & MATERIAL != 0;
    let queries: Vec<_> = queries.iter().map(|&(face, uv)| (face, Parameters::searched(uv))).collect();
    Ok(answers(device, scene, program, &queries)?.into_iter().map(is_material).collect())
}

fn answers(
    device: &Device,
    scene: &PackedScene,
    program: Program,
    queries: &[(u32, Parameters)],
) -> Result<Vec<Record>, GpuError> {
    let of_program = |face: u32| scene.programs().get(face as usize) == Some(&program);
    if let Some(index) = queries.iter().position(|&(face, _)| !of_program(face)) {
        return Err(GpuError::ProbeFace { index, face: queries[index].0, program: format!("{program:?}") });
    }
    let variant = Variant { parts: PROBE, program, curvature: true, vertex_normals: false, trims: TrimMethod::Curves };
    let module = device.module(program, wgsl::source(variant))?;
    let buffers = SceneBuffers::new(device, scene, ShaderStages::COMPUTE, Some(MaskBlend::default()))?;
    let (pipeline_layout, layout) = device.guarded(PROBING, || {
        let layout = device.group_layout("probe", ShaderStages::COMPUTE, (0..).zip([READ, WRITE]));
        (device.pipeline_layout("probe", &[Some(&buffers.layouts.scene), Some(&layout)]), layout)
    })?;
    let pipeline = device.kernel(&pipeline_layout, (program, &module), "probe", &[])?;
    let mut answers = Vec::with_capacity(queries.len());
    for chunk in queries.chunks(GREATEST_DISPATCH) {
        let records = dispatch(device, &buffers, &pipeline, &layout, chunk)?;
        for (record, &(face, _)) in records.iter().zip(chunk) {
            if record.identity[0] != face + 1 {
                return Err(GpuError::Unanswered { index: answers.len() });
            }
            answers.push(*record);
        }
    }
    Ok(answers)
}

fn dispatch(
    device: &Device,
    buffers: &SceneBuffers,
    pipeline: &wgpu::ComputePipeline,
    layout: &wgpu::BindGroupLayout,
    queries: &[(u32, Parameters)],
) -> Result<Vec<Record>, GpuError> {
    let question = |&(face, Parameters { span, uv }): &(u32, Parameters)| Query { uv, span, face, padding: 0 };
    let questions: Vec<Query> = queries.iter().map(question).collect();
    let mut words = vec![UNANSWERED; questions.len() * size_of::<Record>() / 4];
    let asked = device.storage("probe queries", bytemuck::cast_slice(&questions))?;
    let answered = device.storage("probe answers", bytemuck::cast_slice(&words))?;
    let encoder = device.guarded(PROBING, || {
        let group = device.group("probe", layout, whole([&asked, &answered]));
        let mut encoder = device.wgpu.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &buffers.group, &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(questions.len().div_ceil(WORKGROUP) as u32, 1, 1);
        drop(pass);
        encoder
    })?;
    device.submit(PROBING, encoder)?;
    device.read_buffer(PROBING, &answered, 0, bytemuck::cast_slice_mut(&mut words))?;
    Ok(bytemuck::cast_slice(&words).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::TypeInner;

    #[test]
    fn queries_and_answers_have_the_layout_of_the_shader() {
        let variant = Variant {
            parts: PROBE,
            program: Program::General,
            curvature: true,
            vertex_normals: false,
            trims: TrimMethod::Curves,
        };
        let module = naga::front::wgsl::parse_str(&wgsl::source(variant)).unwrap();
        let members = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap().1;
            let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
            (*span as usize, members.iter().map(|m| m.offset as usize).collect::<Vec<_>>())
        };
        assert_eq!(members("ProbeQuery"), (size_of::<Query>(), vec![0, 8, 16, 20]));
        assert_eq!(members("ProbeAnswer"), (size_of::<Record>(), vec![0, 16, 32, 48]));
        let (_, material) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some("MATERIAL")).unwrap();
        assert_eq!(module.global_expressions[material.init], naga::Expression::Literal(naga::Literal::U32(MATERIAL)));
        assert!(module.entry_points.iter().any(|e| e.name == "probe" && e.workgroup_size == [WORKGROUP as u32, 1, 1]));
    }
}
