//! A document in, a file out: the model as exact surfaces (JSON, STEP) or as triangles (OBJ, STL, glTF).
//!
//! [`export()`] chooses from the one list, [`WRITERS`], by the extension. A writer keeps what its format can hold, and
//! `docs/export.md` says of each what that is. Triangles come from [`mesh`]: every one is proven to be within the asked
//! error of its surface, and faces that share an edge share its points. A file is written whole or not at all.
//!
//! # Examples
//! ```
//! use export::{Asked, exported, writer_of};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/models/teacup.json");
//! let document = formats::open(file)?;
//! let asked = Asked { error: 0.01, progress: &|_| () };
//! let (_, bytes) = exported(writer_of("cup.stl".as_ref())?, &document, asked)?;
//! assert!(bytes.len() > 84, "a head, and triangles");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
