//! Strict programs: no operator on floats is left to an adapter, and what stands in their place has Rust's bits.

use gpu::{Device, Drawable, Operation, Operator};
use naga::{Expression, Function, MathFunction, Module, ScalarKind, TypeInner, UnaryOperator};
use pipeline::wgsl::{self, Variant};
use pipeline::{Program, TrimMethod};
use techniques::ByCompute;
use techniques::exact::{Hulls, Strict};
use xtask::strict::operations::{Operands, unlike};

/// Functions in which the adapter's own sums and products stay, each behind a barrier.
const OWN: [&str; 5] = ["ieee_sum", "ieee_product", "hundred_up", "hundred_down", "guessed"];

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
    let search = Strict(Hulls::default());
    let sources = [ByCompute::strict_parts(), search.parts()];
    for (parts, trims) in sources.into_iter().flat_map(|parts| {
        let trims = [TrimMethod::Whole, TrimMethod::Curves, TrimMethod::CurvesWithEdges, TrimMethod::Masks];
        trims.map(|trims| (parts, trims))
    }) {
        for (program, curvature) in [(Program::General, true), (Program::Degree(3), false)] {
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
    let refused = format!("{strict}fn raise_subnormal() {{}}\nfn f(x: f32) -> f32 {{ return exp(x); }}\n");
    assert!(gpu::strict(&refused).is_err_and(|error| error.to_string().contains("no strict form of Exp")));
}

type Edit<'e> = &'e dyn Fn(String) -> String;

/// Of 2^18 results, how many have other bits than Rust's, and the operands of those that raised and were not computed.
fn tried(
    device: &Device,
    operation: Operation,
    operands: Operands,
    computes: bool,
    edit: Edit<'_>,
) -> (usize, Vec<[f32; 2]>) {
    let pairs = operands.pairs(0, 1 << 18);
    let results = Operator::new(device, operation, computes, edit).and_then(|operator| operator.results(&pairs));
    let results = results.expect("it runs");
    let differ = unlike(operation, &pairs, &results).len();
    (differ, pairs.into_iter().zip(results).filter(|(_, result)| result.is_none()).map(|(pair, _)| pair).collect())
}

#[test]
fn each_operation_has_rusts_bits_and_planted_faults_have_not() {
    use Operands::{Bits, InOrder, Mantissas, Near, Tiny};
    use Operation::{Difference, Less, Product, ProductAndSum, Products, Quotient, Root, Rounding, Sum, TwiceKept};
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
        (ProductAndSum, Mantissas),
        (TwiceKept, Mantissas),
        (Products, Mantissas),
        (Rounding, Mantissas),
    ] {
        let whole = tried(&device, operation, operands, true, &|source| source);
        assert_eq!(whole, (0, vec![]), "{operation:?} of {operands:?}");
        // Without subnormal numbers none is wrong, and no other is left out than may be one or be made of one.
        let (differ, raised) = tried(&device, operation, operands, false, &|source| source);
        assert_eq!(differ, 0, "{operation:?} of {operands:?}");
        let is_small = |&[a, b]: &[f32; 2]| match operation {
            Product => (a * b).abs() <= f32::MIN_POSITIVE || a.is_subnormal() || b.is_subnormal(),
            _ => a.abs().max(b.abs()) < 2f32.powi(-100),
        };
        assert!(raised.iter().all(is_small), "{operation:?} of {operands:?}: {raised:?}");
        assert_eq!(
            [Product, Sum, Difference].contains(&operation),
            !raised.is_empty(),
            "{operation:?} of {operands:?}"
        );
    }
    let faults = [
        (Quotient, Mantissas, true, "lost == half", "lost != half"),
        (Quotient, Tiny, true, "lost > half", "lost >= half"),
        (Root, Bits, true, "& 1u)", "& 0u)"),
        (Sum, Near, true, "838860800u", "847249408u"),
    ];
    for (operation, operands, computes, right, wrong) in faults {
        let edit = |source: String| {
            assert!(source.contains(right), "{right}");
            source.replace(right, wrong)
        };
        let (differ, _) = tried(&device, operation, operands, computes, &edit);
        assert!(differ > 0, "{operation:?}, {wrong} for {right}");
    }
}
