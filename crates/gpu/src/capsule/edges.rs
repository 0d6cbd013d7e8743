//! The measurement of the grid of corners as a capsule, so that any host's rasterizer can be asked.
//!
//! What it is and what it tells stands in `snapping`; here it is put in WebGPU's words once more, since the measurement is no
//! picture that could be recorded.

use super::commands::{Attachment, Command, RenderStep};
use super::document::{Capsule, Module, Read, RenderPipeline, Resource, SCHEMA, Stage, Target, Texture};
use super::error::CapsuleError;
use super::folder::{Contents, Files, Played};
use crate::coverage::FORMAT;
use crate::grid::{Grid, QUADS};
use crate::snapping;
use std::collections::BTreeMap;
use wgpu::{Color, ColorWrites, TextureUsages};

/// The file of the program.
const MODULE: &str = "module-0.wgsl";

/// What is read: the lengths of edges that slant across, and down.
const READS: [(&str, bool); 2] = [("across", false), ("down", true)];

/// A capsule of pictures that tell to which grid a rasterizer snaps the corners of triangles.
pub fn edges() -> Contents {
    let texture = |(label, is_down): (&str, bool)| {
        let [width, height] = snapping::size(is_down);
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        Texture { label: label.to_owned(), format: FORMAT, width, height, usage: usage.bits() }
    };
    let stage = |entry_point: &str, constants| Stage { module: 0, entry_point: entry_point.to_owned(), constants };
    let pipeline = |(_, is_down): (&str, bool)| {
        let [vertex, fragment] = snapping::ENTRIES;
        let constants = BTreeMap::from([(snapping::IS_DOWN.to_owned(), f64::from(u8::from(is_down)))]);
        RenderPipeline {
            layout: 0,
            vertex: stage(vertex, constants),
            buffers: vec![],
            fragment: stage(fragment, BTreeMap::new()),
            targets: vec![Target { format: FORMAT, blend: None, write_mask: ColorWrites::RED.bits() }],
            depth: None,
        }
    };
    let render = |k: usize| Command::Render {
        colors: vec![Attachment { texture: k, clear: Some(Color::TRANSPARENT) }],
        depth: None,
        steps: vec![RenderStep::Pipeline(k), RenderStep::Draw([6, QUADS, 0, 0])],
    };
    let read = |(k, (name, _)): (usize, (&str, bool))| Read { name: name.to_owned(), of: Resource::Texture(k) };
    let (schema, schema_version) = SCHEMA;
    let capsule = Capsule {
        schema: schema.to_owned(),
        schema_version,
        picture: None,
        limits: BTreeMap::new(),
        files: vec![],
        modules: vec![Module { file: MODULE.to_owned() }],
        buffers: vec![],
        textures: READS.map(texture).to_vec(),
        group_layouts: vec![],
        groups: vec![],
        pipeline_layouts: vec![vec![]],
        compute_pipelines: vec![],
        render_pipelines: READS.map(pipeline).to_vec(),
        commands: (0..READS.len()).map(render).collect(),
        reads: READS.into_iter().enumerate().map(read).collect(),
        room: None,
    };
    Contents::new(capsule, Files::from([(MODULE.to_owned(), snapping::SHADER.as_bytes().to_vec())]))
}

/// The grid that a host's answer to [`edges`] tells of; `None` where its edges are those of no grid of 4 to 11 bits.
///
/// # Errors
/// [`CapsuleError::OtherCapsule`], [`CapsuleError::NoFile`], [`CapsuleError::Length`] where it is no such answer.
pub fn grid(played: &Played) -> Result<Option<Grid>, CapsuleError> {
    let (found, expected) = (played.answer().capsule.clone(), edges().hash().to_owned());
    if found != expected {
        return Err(CapsuleError::OtherCapsule { found, expected });
    }
    let mut lengths = vec![];
    for (name, is_down) in READS {
        let name = format!("{name}.bin");
        let texels = played.file(&name)?;
        let [width, height] = snapping::size(is_down).map(|side| side as usize);
        if texels.len() != width * height {
            return Err(CapsuleError::Length { name, found: texels.len() as u64, expected: (width * height) as u64 });
        }
        lengths.push(snapping::lengths(texels, is_down));
    }
    Ok(snapping::grid(&lengths[0], &lengths[1]))
}

#[cfg(test)]
mod tests {
    use super::super::{document::Host, play};
    use super::*;
    use crate::Device;

    fn host() -> Host {
        let name = || "a host".to_owned();
        Host { adapter: name(), driver: name(), backend: name(), compiler: name() }
    }

    #[test]
    fn an_adapter_that_plays_the_measurement_is_measured_as_it_is_otherwise() {
        let played = play(&edges(), Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
        let device = Device::open(Some("llvmpipe")).expect("it is there");
        let found = grid(&played).expect("an answer");
        assert!(found.is_some());
        assert_eq!(found, device.measured_grid().expect("a picture"));
    }

    #[test]
    fn an_answer_that_is_moved_or_cut_off_or_to_something_else_tells_of_no_grid() {
        let played = play(&edges(), Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`");
        let mut files = played.files.clone();
        let across = files.get_mut("across.bin").expect("it is read");
        let [width, _] = snapping::size(false);
        across.rotate_right(40 * width as usize);
        across[..40 * width as usize].fill(255);
        assert_eq!(grid(&Played::new(&edges(), host(), files.clone())).expect("an answer"), None);
        files.get_mut("down.bin").expect("it is read").pop();
        let cut_off = grid(&Played::new(&edges(), host(), files.clone()));
        assert!(matches!(cut_off, Err(CapsuleError::Length { name, .. }) if name == "down.bin"));
        let other = Contents::new(Capsule { reads: vec![], ..edges().capsule().clone() }, Files::new());
        let other = grid(&Played::new(&other, host(), files));
        assert!(matches!(other, Err(CapsuleError::OtherCapsule { .. })));
    }
}
