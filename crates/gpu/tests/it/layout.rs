//! The shaders' text, read by naga: every variant is valid, and what the processor shares with it has the same layout
//! and values. No adapter is needed.

use gbuffer::ShadeUniform;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Literal, Module, TypeInner};
use nurbs::NormalStatus;
use pipeline::eval::{COLLAPSED, PARALLEL};
use pipeline::wgsl::{self, Variant};
use pipeline::{BOUNDED, FaceRecord, Program, RATIONAL, REVERSED, TrimMethod, View, edge, sight};
use std::mem::offset_of;

fn variants() -> Vec<Variant> {
    let mut all = vec![];
    for program in [Program::General].into_iter().chain((3..=15).step_by(2).map(Program::Degree)) {
        for curvature in [false, true] {
            for vertex_normals in [false, true] {
                for trims in TrimMethod::ALL {
                    let parts = techniques::ALL.iter().map(|technique| technique.parts()).chain([gpu::PROBE]);
                    all.extend(parts.map(|parts| Variant { parts, program, curvature, vertex_normals, trims }));
                }
            }
        }
    }
    all
}

fn parsed(source: &str) -> Result<Module, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    Validator::new(ValidationFlags::all(), Capabilities::default())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

fn module() -> Module {
    parsed(&wgsl::source(variants()[0])).unwrap()
}

/// Size of a struct and its members with their offsets.
fn layout(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, ty) = found.unwrap_or_else(|| panic!("no struct {name}"));
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no struct") };
    (*span, members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect())
}

macro_rules! same_layout {
    ($module:expr, $record:ident, $($member:ident),+) => {
        let (span, members) = layout($module, stringify!($record));
        assert_eq!(span as usize, size_of::<$record>(), stringify!($record));
        let expected = vec![$((stringify!($member).to_owned(), offset_of!($record, $member) as u32)),+];
        assert_eq!(members, expected, stringify!($record));
    };
}

fn constant(module: &Module, name: &str) -> Literal {
    let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
    let (_, constant) = found.unwrap_or_else(|| panic!("no constant {name}"));
    match module.global_expressions[constant.init] {
        Expression::Literal(literal) => literal,
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn every_variant_is_valid() {
    for variant in variants() {
        parsed(&wgsl::source(variant)).unwrap_or_else(|error| panic!("{:?}: {error}", variant.assembled()));
    }
}

#[test]
fn an_invalid_source_is_found_out() {
    let source = wgsl::source(variants()[0]);
    assert!(parsed(&source.replace("return low;", "return f32(low);")).is_err());
}

#[test]
fn records_have_the_same_members_at_the_same_offsets() {
    let module = module();
    same_layout!(
        &module, FaceRecord, degree_u, degree_v, spans_u, spans_v, table_u, table_v, points, count_v, flags, trims,
        intervals, padding
    );
    same_layout!(&module, View, clip_from_local, eye, units);
    same_layout!(
        &module,
        ShadeUniform,
        light,
        kind,
        axis,
        stripes,
        squares,
        bands,
        curvature_scale,
        padding,
        thresholds
    );
}

#[test]
fn constants_have_the_same_values() {
    let module = module();
    assert_eq!(constant(&module, "RATIONAL"), Literal::U32(RATIONAL));
    assert_eq!(constant(&module, "REVERSED"), Literal::U32(REVERSED));
    assert_eq!(constant(&module, "BOUNDED"), Literal::U32(BOUNDED));
    assert_eq!(constant(&module, "SKIRT_STEPS"), Literal::U32(sight::SKIRT_STEPS));
    assert_eq!(constant(&module, "PARALLEL"), Literal::F32(PARALLEL));
    assert_eq!(constant(&module, "COLLAPSED"), Literal::F32(COLLAPSED));
    assert_eq!(constant(&module, "REGULAR"), Literal::U32(NormalStatus::Regular as u32));
    assert_eq!(constant(&module, "UNDEFINED"), Literal::U32(NormalStatus::Undefined as u32));
    for (name, value) in [
        ("NEAR_PX", sight::NEAR_PX),
        ("REACH_PX", sight::REACH_PX),
        ("STEEP", sight::STEEP),
        ("SKIRT_REACH_PX", sight::SKIRT_REACH_PX),
        ("SKIRT_FOUND_PX", sight::SKIRT_FOUND_PX),
        ("SKIRT_SETTLED_PX", sight::SKIRT_SETTLED_PX),
        ("NEARLY_SINGULAR", sight::NEARLY_SINGULAR),
        ("GREATEST", f32::MAX),
    ] {
        assert_eq!(constant(&module, name), Literal::F32(value), "{name}");
    }
    let with_edges =
        parsed(&wgsl::source(variants().into_iter().find(|v| v.trims == TrimMethod::CurvesWithEdges).unwrap()))
            .unwrap();
    for (name, value) in [
        ("EDGE_MAPS", edge::MAPS),
        ("EDGE_CLIP_HALVINGS", edge::CLIP_HALVINGS),
        ("EDGE_CHORDS", edge::CHORDS),
        ("EDGE_ROUNDS", edge::ROUNDS),
    ] {
        assert_eq!(constant(&with_edges, name), Literal::U32(value), "{name}");
    }
    for (name, value) in [
        ("EDGE_REACH_PX", edge::REACH_PX),
        ("EDGE_MAP_REACH_PX", edge::MAP_REACH_PX),
        ("EDGE_EDGE_ON", edge::EDGE_ON),
        ("EDGE_FINE_PX", edge::FINE_PX),
        ("EDGE_STEPS", edge::STEPS),
    ] {
        assert_eq!(constant(&with_edges, name), Literal::F32(value), "{name}");
    }
    assert_eq!(constant(&module, "STATUS_UNDEFINED"), Literal::U32(NormalStatus::Undefined as u32));
}

#[test]
fn a_prelude_fixes_what_its_variant_says() {
    for variant in variants() {
        let module = parsed(&wgsl::source(variant)).unwrap();
        let capacity = match variant.program {
            Program::General => nurbs::MAX_ORDER as u32,
            Program::Degree(p) => p + 1,
        };
        assert_eq!(constant(&module, "CAPACITY"), Literal::U32(capacity));
        assert_eq!(constant(&module, "CURVATURE"), Literal::Bool(variant.curvature));
        assert_eq!(constant(&module, "VERTEX_NORMALS"), Literal::Bool(variant.vertex_normals));
    }
}
