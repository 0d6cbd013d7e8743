//! Which object of a capsule an address of a trace stands for.

use super::error::CapsuleError;
use std::collections::HashMap;
use wgpu::wgc::id::{Marker, PointerId, markers};

/// What capsules do not hold.
pub(super) fn unsupported(what: impl Into<String>) -> CapsuleError {
    CapsuleError::Unsupported { what: what.into() }
}

fn address<M: Marker>(id: PointerId<M>) -> usize {
    let PointerId::PointerId(address, _) = id;
    address.get()
}

/// The objects of a kind, by address; the latest of an address counts.
pub(super) struct Names<M> {
    kind: std::marker::PhantomData<M>,
    places: HashMap<usize, usize>,
}

impl<M> Default for Names<M> {
    fn default() -> Self {
        Self { kind: Default::default(), places: HashMap::new() }
    }
}

impl<M: Marker> Names<M> {
    /// Appends an object to its list.
    pub(super) fn add<T>(&mut self, id: PointerId<M>, all: &mut Vec<T>, object: T) {
        self.name(id, all.len());
        all.push(object);
    }

    /// Gives an address to the object of that place.
    pub(super) fn name(&mut self, id: PointerId<M>, place: usize) {
        self.places.insert(address(id), place);
    }

    /// The place of an object.
    pub(super) fn get(&self, id: PointerId<M>) -> Result<usize, CapsuleError> {
        let missing = || unsupported(format!("what was made before it was recorded: {}", std::any::type_name::<M>()));
        self.places.get(&address(id)).copied().ok_or_else(missing)
    }
}

/// The objects of all kinds.
#[derive(Default)]
pub(super) struct Table {
    pub(super) buffers: Names<markers::Buffer>,
    pub(super) textures: Names<markers::Texture>,
    /// By the places of their textures.
    pub(super) views: Names<markers::TextureView>,
    pub(super) group_layouts: Names<markers::BindGroupLayout>,
    pub(super) groups: Names<markers::BindGroup>,
    pub(super) pipeline_layouts: Names<markers::PipelineLayout>,
    pub(super) modules: Names<markers::ShaderModule>,
    pub(super) compute: Names<markers::ComputePipeline>,
    pub(super) render: Names<markers::RenderPipeline>,
    /// What staging buffers are for, by address.
    staging: HashMap<usize, String>,
}

impl Table {
    /// A staging buffer and its label.
    pub(super) fn staging(&mut self, id: PointerId<markers::Buffer>, label: String) {
        self.staging.insert(address(id), label);
    }

    /// What a staging buffer is for.
    pub(super) fn what_for(&self, id: PointerId<markers::Buffer>) -> Result<&str, CapsuleError> {
        self.staging.get(&address(id)).map(String::as_str).ok_or_else(|| unsupported("a copy between buffers"))
    }
}
