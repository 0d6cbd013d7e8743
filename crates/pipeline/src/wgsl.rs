//! The twin in WGSL, as text.
//!
//! A shader says in its head which others it uses. A program is the file with its entry points, all that this one uses, and
//! a short prelude that fixes what a Rust generic would: capacity, degree, and which outputs are wanted.

use crate::packed::{Program, TrimMethod};
use nurbs::MAX_ORDER;

/// A file of `shaders/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Part {
    /// Its path there.
    pub file: &'static str,
    /// Its text, which stands in a program as it is.
    pub text: &'static str,
}

/// Evaluation: span, basis, surface.
pub const EVAL: Part = Part { file: "eval.wgsl", text: include_str!("../../../shaders/eval.wgsl") };

/// Trimming by curves.
pub const TRIM: Part = Part { file: "trim.wgsl", text: include_str!("../../../shaders/trim.wgsl") };

/// Trimming by masks, which stands in [`TRIM`]'s place.
const MASK: Part = Part { file: "mask.wgsl", text: include_str!("../../../shaders/mask.wgsl") };

/// Which trim edge passes by.
pub const EDGE: Part = Part { file: "edge.wgsl", text: include_str!("../../../shaders/edge.wgsl") };

/// What stands in [`EDGE`]'s place where no edge is looked for.
const NO_EDGE: Part =
    Part { file: "no edge", text: "fn edge(face: u32, uv: vec2<f32>, at: vec2<f32>) -> u32 { return 0u; }\n" };

/// What draws masks; a program of its own.
pub const ENTRY_MASK: &str = include_str!("../../../shaders/entry_mask.wgsl");

/// What takes masks over as the CPU drew them; a program of its own.
pub const ENTRY_TEXELS: &str = include_str!("../../../shaders/entry_texels.wgsl");

/// The parts that every technique may use.
pub const COMMON: &[Part] = &[
    Part { file: "layout.wgsl", text: include_str!("../../../shaders/layout.wgsl") },
    EVAL,
    Part { file: "sight.wgsl", text: include_str!("../../../shaders/sight.wgsl") },
    TRIM,
    Part { file: "fragment.wgsl", text: include_str!("../../../shaders/fragment.wgsl") },
    Part { file: "shade.wgsl", text: include_str!("../../../shaders/shade.wgsl") },
    Part { file: "output.wgsl", text: include_str!("../../../shaders/output.wgsl") },
    EDGE,
];

/// What a program is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The parts beside [`COMMON`]; the first holds the entry points.
    pub parts: &'static [Part],
    /// Which degrees.
    pub program: Program,
    /// Whether second derivatives and curvatures are computed.
    pub curvature: bool,
    /// Whether shading uses the normal interpolated from the vertices instead of the fragment's own, where there are some.
    pub vertex_normals: bool,
    /// What is done about trims.
    pub trims: TrimMethod,
}

impl Variant {
    /// The parts that its program is put together from: each behind those that it uses.
    ///
    /// # Panics
    /// Where a part uses a file that is neither its technique's nor common.
    pub fn assembled(&self) -> Vec<Part> {
        let mut assembled = vec![];
        self.enter(self.parts[0].file, &mut vec![], &mut assembled);
        assembled
    }

    fn enter(&self, file: &str, entered: &mut Vec<&'static str>, assembled: &mut Vec<Part>) {
        let mut all = self.parts.iter().chain(COMMON);
        let part = *all.find(|part| part.file == file).unwrap_or_else(|| panic!("{file} is no part of a program"));
        if entered.contains(&part.file) {
            return;
        }
        entered.push(part.file);
        let part = match (part, self.trims) {
            (TRIM, TrimMethod::Masks) => MASK,
            (EDGE, TrimMethod::Whole | TrimMethod::Curves | TrimMethod::Masks) => NO_EDGE,
            (part, _) => part,
        };
        for used in part.uses() {
            self.enter(used, entered, assembled);
        }
        assembled.push(part);
    }
}

impl Part {
    /// The files that it uses, as its head says.
    pub fn uses(&self) -> impl Iterator<Item = &'static str> {
        let head = self.text.lines().take_while(|line| line.starts_with("//"));
        head.filter_map(|line| line.strip_prefix("// Uses ")).flat_map(str::split_whitespace)
    }
}

/// The source of a variant.
///
/// # Panics
/// As of [`Variant::assembled`].
pub fn source(variant: Variant) -> String {
    variant.assembled().iter().fold(prelude(variant), |source, part| source + part.text)
}

fn prelude(variant: Variant) -> String {
    let (capacity, degree) = match variant.program {
        Program::General => (MAX_ORDER as u32, "stored".to_owned()),
        Program::Degree(p) => (p + 1, format!("{p}u")),
    };
    let Variant { curvature, vertex_normals, trims, .. } = variant;
    let trimmed = trims != TrimMethod::Whole;
    format!(
        "const CAPACITY: u32 = {capacity}u;\n\
         const CURVATURE: bool = {curvature};\n\
         const VERTEX_NORMALS: bool = {vertex_normals};\n\
         const TRIMMED: bool = {trimmed};\n\
         fn degree(stored: u32) -> u32 {{ return {degree}; }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_holds_what_its_parts_use_once_and_before_it() {
        const PARTS: &[Part] =
            &[Part { file: "own.wgsl", text: "// Own.\n// Uses output.wgsl trim.wgsl\nfn own() {}\n" }];
        let variant =
            |trims| Variant { parts: PARTS, program: Program::General, curvature: false, vertex_normals: false, trims };
        let files = |trims| variant(trims).assembled().iter().map(|part| part.file).collect::<Vec<_>>();
        let curves = [
            "shade.wgsl",
            "layout.wgsl",
            "eval.wgsl",
            "fragment.wgsl",
            "no edge",
            "output.wgsl",
            "trim.wgsl",
            "own.wgsl",
        ];
        assert_eq!(files(TrimMethod::Curves), curves);
        assert!(files(TrimMethod::Masks).contains(&"mask.wgsl") && !files(TrimMethod::Masks).contains(&"trim.wgsl"));
        assert!(files(TrimMethod::CurvesWithEdges).contains(&"edge.wgsl"));
    }

    /// The files that a part reaches by what it uses.
    fn reached(part: &Part, found: &mut Vec<&'static str>) {
        for file in part.uses().filter(|file| !found.contains(file)).collect::<Vec<_>>() {
            found.push(file);
            reached(COMMON.iter().find(|part| part.file == file).expect("common parts use common parts"), found);
        }
    }

    #[test]
    fn no_part_uses_itself_by_way_of_others() {
        for part in COMMON.iter().chain([&MASK]) {
            let mut found = vec![];
            reached(part, &mut found);
            assert!(!found.contains(&part.file), "{}: {found:?}", part.file);
        }
    }
}
