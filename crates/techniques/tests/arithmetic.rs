//! The arithmetic on which kernels' bits rest, one operation at a time, on a device.

mod common;

use common::software;
use pipeline::wgsl::{self, Variant};
use techniques::wrong_arithmetic;

#[test]
fn strict_arithmetic_has_the_bits_of_rusts_own() {
    assert_eq!(wrong_arithmetic(&software(), &wgsl::source), Ok(None));
}

#[test]
fn a_quotient_that_an_adapter_guesses_badly_is_corrected() {
    for factor in ["1.000002", "0.999998"] {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains("return a / b;"));
            source.replace("return a / b;", &format!("return a / b * {factor};"))
        };
        assert_eq!(wrong_arithmetic(&software(), &source), Ok(None), "{factor}");
    }
}

#[test]
fn a_digit_that_is_rounded_otherwise_is_named() {
    let device = software();
    let faults = [
        ("if (lost > half || (", "if (lost > half && (", "quotient"),
        ("lost == half && (mantissa & 1u) != 0u", "false", "rounded whole number"),
        ("+ (middle >> 16u)", "", "product of whole numbers"),
        // The first that the difference is asked in.
        ("a.low < b.low", "a.low <= b.low", "product of whole numbers"),
        ("f32(i32(w.low))", "f32(w.low)", "approximate whole number"),
    ];
    for (original, replacement, operation) in faults {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(original), "{original}");
            source.replacen(original, replacement, 1)
        };
        let found = wrong_arithmetic(&device, &source).expect("it compiles");
        let found = found.unwrap_or_else(|| panic!("{original} -> {replacement} has all bits"));
        assert!(found.starts_with(operation), "{original} -> {replacement}: {found}");
    }
}
