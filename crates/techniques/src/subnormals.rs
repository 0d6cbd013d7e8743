//! How strict kernels go without subnormal numbers until a frame meets one: these take much code, which an adapter may compile for
//! minutes.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Of strict kernels.
#[derive(Default)]
pub struct Subnormals {
    /// Whether the pipelines that are there compute them.
    are_computed: bool,
    are_met: Arc<AtomicBool>,
}

/// Of a frame whose kernels compute none.
pub struct Lacking(Arc<AtomicBool>);

impl Subnormals {
    /// Whether a frame met one that its kernels did not compute, so that these must be compiled anew.
    pub fn begin(&mut self) -> bool {
        let is_new = !self.are_computed && self.are_met.load(Relaxed);
        self.are_computed |= is_new;
        is_new
    }

    /// What a pipeline takes.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        gpu::strict_constants(self.are_computed)
    }

    /// What a frame has that computes none.
    pub fn lacking(&self) -> Option<Lacking> {
        (!self.are_computed).then(|| Lacking(self.are_met.clone()))
    }
}

impl Lacking {
    /// Says that there is one.
    pub fn met(&self) {
        self.0.store(true, Relaxed);
    }
}
