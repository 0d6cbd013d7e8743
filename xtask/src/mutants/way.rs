//! Who draws a mutant: a technique, and who finds its triangles.

use gpu::Atomics;
use isophote::stage::Path;
use pipeline::wgsl::Part;
use techniques::{ByCompute, Technique};

/// A technique by a path of its triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// The technique.
    pub technique: &'static dyn Technique,
    /// Who finds its triangles.
    pub path: Path,
}

impl Way {
    /// Every technique by the GPU's own rasterizer, and then the first by kernels, whose programs are the same for all of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let kernels = [Path::Compute, Path::Compute32].map(|path| Self { technique: techniques::ALL[0], path });
        techniques::ALL.iter().map(|technique| Self { technique: *technique, path: Path::Fragment }).chain(kernels)
    }

    /// The parts of its programs beside those that all have.
    pub fn parts(&self) -> &'static [Part] {
        match self.path {
            Path::Fragment => self.technique.parts(),
            Path::Compute => ByCompute::parts_by(Atomics::Bits64),
            Path::Compute32 => ByCompute::parts_by(Atomics::Bits32),
            Path::Strict => ByCompute::strict_parts(),
        }
    }

    /// The words by which processes speak of it.
    pub fn label(&self) -> String {
        format!("{} {:?}", self.technique.name(), self.path)
    }
}
