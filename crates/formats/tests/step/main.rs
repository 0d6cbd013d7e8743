//! STEP files through the public interface.

mod attributes;
mod bad_input;
mod cases;
mod closed_forms;
#[path = "../formats/common.rs"]
#[allow(dead_code)]
mod common;
mod oracle;
mod replicas;
mod solids;
mod support;
mod writer;
