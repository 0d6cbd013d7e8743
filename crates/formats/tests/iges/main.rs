//! IGES files through the public interface.

#[path = "../formats/common.rs"]
#[allow(dead_code)]
mod common;
mod oracle;
#[path = "../formats/same_faces.rs"]
mod same_faces;
