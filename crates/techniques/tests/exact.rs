//! The search of technique `exact` in WGSL has the records and constants of its twin in Rust.

use naga::{Expression, Literal, Module, TypeInner};
use pipeline::wgsl::{self, Variant};
use pipeline::{Program, TrimMethod};
use std::mem::offset_of;
use techniques::Technique;
use techniques::exact::{Exact, PieceRecord, fold, newton, place};

fn module() -> Module {
    let variant = Variant {
        parts: Exact.parts(),
        program: Program::General,
        curvature: true,
        vertex_normals: false,
        trims: TrimMethod::Curves,
    };
    naga::front::wgsl::parse_str(&wgsl::source(variant)).expect("legal")
}

#[test]
fn a_piece_has_the_same_members_at_the_same_offsets() {
    let module = module();
    let (_, record) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("PieceRecord")).expect("there");
    let TypeInner::Struct { members, span } = &record.inner else { panic!("PieceRecord is no struct") };
    let found: Vec<(&str, usize)> =
        members.iter().map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize)).collect();
    let expected = [
        ("hull_from_local", offset_of!(PieceRecord, hull_from_local)),
        ("flat", offset_of!(PieceRecord, flat)),
        ("rectangle", offset_of!(PieceRecord, rectangle)),
        ("face", offset_of!(PieceRecord, face)),
        ("span_u", offset_of!(PieceRecord, span_u)),
        ("span_v", offset_of!(PieceRecord, span_v)),
        ("patience", offset_of!(PieceRecord, patience)),
    ];
    assert_eq!((*span as usize, found), (size_of::<PieceRecord>(), expected.to_vec()));
}

#[test]
fn constants_have_the_same_values() {
    let module = module();
    let constant = |name: &str| {
        let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
        let (_, constant) = found.unwrap_or_else(|| panic!("no constant {name}"));
        match module.global_expressions[constant.init] {
            Expression::Literal(literal) => literal,
            ref other => panic!("{name} is {other:?}"),
        }
    };
    for (name, value) in [
        ("EVALUATIONS", newton::EVALUATIONS),
        ("HALVINGS", newton::HALVINGS),
        ("PATIENCE", newton::PATIENCE),
        ("PATIENCE_EDGE_ON", newton::PATIENCE_EDGE_ON),
        ("APPROACHES", newton::APPROACHES),
        ("SAMPLES", fold::SAMPLES),
        ("QUEUE", fold::QUEUE as u32),
        ("RESTARTS", fold::RESTARTS.len() as u32),
    ] {
        assert_eq!(constant(name), Literal::U32(value), "{name}");
    }
    for (name, value) in [
        ("FINE_PX", newton::FINE_PX),
        ("NEAR_FOLD_PX", newton::NEAR_FOLD_PX),
        ("ONE_END", newton::ONE_END),
        ("NEAR_TWISTED_PX", newton::NEAR_TWISTED_PX),
        ("TWISTED_SIDE_PX", newton::TWISTED_SIDE_PX),
        ("LAST_BEND_PX", newton::LAST_BEND_PX),
        ("PROMISE", newton::PROMISE),
        ("LARGE_PX", newton::LARGE_PX),
        ("INSIDE", newton::INSIDE),
        ("STEP_EDGE_ON", newton::STEP_EDGE_ON),
        ("SLOW", newton::SLOW),
        ("ONE_SEED", newton::ONE_SEED),
        ("DAMPING", newton::DAMPING),
        ("ROUNDING", place::ROUNDING),
        ("BEYOND", place::BEYOND),
        ("EDGE_ON", place::EDGE_ON),
        ("ASIDE", fold::ASIDE),
        ("SHORT", fold::SHORT),
    ] {
        assert_eq!(constant(name), Literal::F32(value), "{name}");
    }
}
