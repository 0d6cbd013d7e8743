//! A document in, a file out: the model as exact surfaces (JSON, STEP) or as triangles (OBJ, STL, glTF).
//!
//! [`export()`] chooses from the one list, [`WRITERS`], by the extension. A writer keeps what its format can hold, and
//! `docs/export.md` says of each what that is. Triangles come from [`mesh`]: every one is proven to be within the asked
//! error of its surface, and faces that share an edge share its points. A file is written whole or not at all.

mod error;
mod gltf;
mod json;
pub mod mesh;
mod obj;
mod parts;
mod step;
mod stl;
mod write;
mod writer;

pub use error::ExportError;
pub use write::{WRITERS, export, exported, writer_of};
pub use writer::{Asked, Beside, Fill, Ready, Writer, Written};
