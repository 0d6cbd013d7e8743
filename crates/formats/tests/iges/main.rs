//! IGES files through the public interface.

mod bad_input;
mod cases;
mod closed;
mod closed_forms;
#[path = "../formats/common.rs"]
#[allow(dead_code)]
mod common;
#[path = "../formats/corpus.rs"]
mod corpus;
#[path = "../formats/green.rs"]
mod green;
mod instances;
mod levels;
mod looks;
#[path = "../formats/opencascade.rs"]
mod opencascade;
mod oracle;
#[path = "../formats/same_faces.rs"]
mod same_faces;
mod sheets;
mod silence;
mod solids;
mod support;
#[path = "../formats/table.rs"]
mod table;
mod writer;
