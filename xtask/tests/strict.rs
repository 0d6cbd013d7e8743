//! Strict programs: no operator on floats is left to an adapter, and what stands in their place has Rust's bits.

use gpu::{Device, Operation, Operator};
use naga::{Expression, Function, MathFunction, Module, ScalarKind, TypeInner, UnaryOperator};
use pipeline::wgsl::{self, Variant};
use pipeline::{Program, TrimMethod};
use techniques::ByCompute;
use xtask::strict::operations::{Operands, unlike};

/// Functions in which the adapter's own sums and products stay, each behind a barrier.
const OWN: [&str; 4] = ["ieee_sum", "ieee_product", "hundred_up", "hundred_down"];

fn module(wgsl: &str) -> Module {
    naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|error| panic!("{}", error.emit_to_string(wgsl)))
}

/// The operators on floats outside of those functions, by the name of the function that holds them.
fn left(module: &Module) -> Vec<String> {
    use naga::valid::{Capabilities, FunctionInfo, ValidationFlags, Validator};
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(module).expect("it is legal");
    let mut found = vec![];
    let mut look = |name: &str, function: &Function, info: &FunctionInfo| {
        let is_float = |value: naga::Handle<Expression>| {
            let inner = info[value].ty.inner_with(&module.types);
            inner.scalar_kind() == Some(ScalarKind::Float) && !matches!(inner, TypeInner::Pointer { .. })
        };
        let is_left = |expression: &Expression| match *expression {
            Expression::Binary { left, .. } => is_float(left),
            Expression::Unary { op: UnaryOperator::Negate, expr } => is_float(expr),
            Expression::Math { fun, arg, .. } => {
                use MathFunction::{Ceil, Floor, Round, Transpose};
                is_float(arg) && ![Ceil, Floor, Round, Transpose].contains(&fun)
            }
            _ => false,
        };
        let count = function.expressions.iter().filter(|(_, expression)| is_left(expression)).count();
        if count > 0 && !OWN.contains(&name) {
            found.push(format!("{name}: {count}"));
        }
    };
    for (handle, function) in module.functions.iter() {
        look(function.name.as_deref().unwrap_or("?"), function, &info[handle]);
    }
    for (index, entry) in module.entry_points.iter().enumerate() {
        look(&entry.name, &entry.function, info.get_entry_point(index));
    }
    found
}

#[test]
fn no_operator_on_floats_is_left_to_an_adapter() {
    for trims in [TrimMethod::Whole, TrimMethod::Curves, TrimMethod::CurvesWithEdges] {
        for (program, curvature) in [(Program::General, true), (Program::Degree(3), false)] {
            let parts = ByCompute::strict_parts();
            let plain = wgsl::source(Variant { parts, program, curvature, vertex_normals: false, trims });
            let strict = gpu::strict(&plain).expect("it has a strict form");
            assert_eq!(left(&module(&strict)), [""; 0], "{trims:?} {program:?}");
            // The checker itself, on what is not strict.
            assert!(left(&module(&plain)).len() > 20, "{trims:?} {program:?}");
            let unbarred = format!("{strict}fn planted(x: f32) -> f32 {{ return x * x; }}\n");
            assert_eq!(left(&module(&unbarred)), ["planted: 1"]);
        }
    }
}

#[test]
fn what_has_no_strict_form_is_refused() {
    let strict = include_str!("../../shaders/raster/strict.wgsl");
    let refused = format!("{strict}fn f(x: f32) -> f32 {{ return exp(x); }}\n");
    assert!(gpu::strict(&refused).is_err_and(|error| error.to_string().contains("no strict form of Exp")));
}

/// How many of 2^18 results have other bits than Rust's.
fn differ(device: &Device, operation: Operation, operands: Operands, edit: &dyn Fn(String) -> String) -> usize {
    let pairs = operands.pairs(0, 1 << 18);
    let results = Operator::new(device, operation, edit).and_then(|operator| operator.results(&pairs));
    unlike(operation, &pairs, &results.expect("it runs")).len()
}

#[test]
fn each_operation_has_rusts_bits_and_planted_faults_have_not() {
    use Operands::{Bits, InOrder, Mantissas, Near, Tiny};
    use Operation::{Difference, Less, Product, Quotient, Root, Sum};
    let device = Device::open(Some("llvmpipe")).expect("the software adapter");
    for (operation, operands) in [
        (Root, Bits),
        (Root, InOrder),
        (Quotient, Mantissas),
        (Quotient, Bits),
        (Quotient, Tiny),
        (Product, Bits),
        (Product, Tiny),
        (Sum, Near),
        (Sum, Bits),
        (Difference, Near),
        (Less, Bits),
    ] {
        assert_eq!(differ(&device, operation, operands, &|source| source), 0, "{operation:?} of {operands:?}");
    }
    let faults: [(Operation, Operands, &str, &str); 4] = [
        (Quotient, Mantissas, "lost == half", "lost != half"),
        (Quotient, Tiny, "lost > half", "lost >= half"),
        (Root, Bits, "& 1u)", "& 0u)"),
        (Sum, Near, "838860800u", "847249408u"),
    ];
    for (operation, operands, right, wrong) in faults {
        let edit = |source: String| {
            assert!(source.contains(right), "{right}");
            source.replace(right, wrong)
        };
        assert!(differ(&device, operation, operands, &edit) > 0, "{operation:?}, {wrong} for {right}");
    }
}
