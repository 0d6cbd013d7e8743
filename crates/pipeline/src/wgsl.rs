//! The twin in WGSL, as text.
//!
//! WGSL needs no order of declaration, so a program is its parts put together behind a short prelude that fixes
//! what a Rust generic would: capacity, degree, and which outputs are wanted.

use crate::pack::Program;
use nurbs::MAX_ORDER;

/// Records and bindings.
pub const LAYOUT: &str = include_str!("../../../shaders/layout.wgsl");
/// Span, basis, surface.
pub const EVAL: &str = include_str!("../../../shaders/eval.wgsl");
/// The fragment program.
pub const FRAGMENT: &str = include_str!("../../../shaders/fragment.wgsl");
/// The shading code, twin of `gbuffer::shade`.
pub const SHADE: &str = include_str!("../../../shaders/shade.wgsl");
/// Vertex and fragment entry points.
pub const ENTRY: &str = include_str!("../../../shaders/entry.wgsl");

/// A file of `shaders/` that is part of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Its name.
    pub file: &'static str,
    /// Its text, which stands in a program as it is.
    pub text: &'static str,
}

/// All parts of a program, in the order in which they are put together.
pub const PARTS: &[Part] = &[
    Part { file: "layout.wgsl", text: LAYOUT },
    Part { file: "eval.wgsl", text: EVAL },
    Part { file: "fragment.wgsl", text: FRAGMENT },
    Part { file: "shade.wgsl", text: SHADE },
    Part { file: "entry.wgsl", text: ENTRY },
];

/// What a program is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Which degrees.
    pub program: Program,
    /// Whether second derivatives and curvatures are computed.
    pub curvature: bool,
    /// Whether shading uses the normal interpolated from the vertices instead of the fragment's own.
    pub interpolated_normal: bool,
}

/// The source of a variant. Entry points: `vertex`, `fragment_gbuffer`, `fragment_shaded`.
pub fn source(variant: Variant) -> String {
    PARTS.iter().fold(prelude(variant), |source, part| source + part.text)
}

fn prelude(variant: Variant) -> String {
    let (capacity, degree) = match variant.program {
        Program::General => (MAX_ORDER as u32, "stored".to_owned()),
        Program::Degree(p) => (p + 1, format!("{p}u")),
    };
    let Variant { curvature, interpolated_normal, .. } = variant;
    format!(
        "const CAPACITY: u32 = {capacity}u;\n\
         const CURVATURE: bool = {curvature};\n\
         const INTERPOLATED_NORMAL: bool = {interpolated_normal};\n\
         fn degree(stored: u32) -> u32 {{ return {degree}; }}\n"
    )
}
