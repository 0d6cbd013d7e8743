//! STEP files through the public interface.

mod attributes;
mod bad_input;
mod cases;
mod closed_forms;
#[path = "../formats/common.rs"]
#[allow(dead_code)]
mod common;
#[path = "../formats/corpus.rs"]
mod corpus;
#[path = "../formats/green.rs"]
mod green;
mod layers;
mod offsets;
#[path = "../formats/opencascade.rs"]
mod opencascade;
mod oracle;
mod rectangles;
mod replicas;
#[path = "../formats/same_faces.rs"]
mod same_faces;
mod silence;
mod solids;
mod support;
#[path = "../formats/table.rs"]
mod table;
mod told;
mod writer;
