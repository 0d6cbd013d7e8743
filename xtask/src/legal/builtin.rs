//! Operations on words: builtin functions, integers and truth values, conversions.

use super::arithmetic::Arithmetic;
use super::order;
use super::program::Frame;
use naga::{BinaryOperator, Expression, Handle, MathFunction, ScalarKind};

/// The words of a builtin function, of which there are at most sixteen. `is_real` says whether its arguments are real numbers.
pub fn math(
    arithmetic: &mut Arithmetic,
    frame: &Frame,
    fun: MathFunction,
    arguments: [Handle<Expression>; 3],
    is_real: bool,
    words: usize,
) -> [u32; 16] {
    let [a, b, _] = arguments;
    let count = frame.prepared.place(a).1;
    let lanes = |of| -> [f32; 4] { std::array::from_fn(|k| if k < count { frame.number(of, k) } else { 0.0 }) };
    let mut out = [0; 16];
    match fun {
        MathFunction::Dot => {
            let (a, b) = (lanes(a), lanes(b));
            let terms: [[f32; 2]; 4] = std::array::from_fn(|k| [a[k], b[k]]);
            out[0] = order::products(arithmetic, &terms[..count]).to_bits();
        }
        MathFunction::Cross => {
            let (a, b) = (lanes(a), lanes(b));
            for (k, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
                out[k] = order::products(arithmetic, &[[a[i], b[j]], [-a[j], b[i]]]).to_bits();
            }
        }
        MathFunction::Transpose => {
            let side = if words == 16 { 4 } else { 3 };
            (0..words).for_each(|k| out[k] = frame.word(a, k % side * side + k / side));
        }
        _ if is_real => {
            for k in 0..words {
                out[k] = real(arithmetic, fun, arguments.map(|x| frame.number(x, k))).to_bits();
            }
        }
        _ => {
            for k in 0..words {
                let [x, y, z] = arguments.map(|x| frame.word(x, k));
                out[k] = match fun {
                    MathFunction::Min => x.min(y),
                    MathFunction::Max => x.max(y),
                    MathFunction::Clamp => x.max(y).min(z),
                    _ => x,
                };
            }
        }
    }
    out
}

/// A function of real numbers.
fn real(arithmetic: &mut Arithmetic, fun: MathFunction, [x, y, z]: [f32; 3]) -> f32 {
    match fun {
        MathFunction::Abs => x.abs(),
        MathFunction::Min => x.min(y),
        MathFunction::Max => x.max(y),
        MathFunction::Clamp => x.max(y).min(z),
        MathFunction::Floor => x.floor(),
        MathFunction::Ceil => x.ceil(),
        MathFunction::Sqrt => arithmetic.root(x),
        // mix: x (1 − z) + y z, or x + (y − x) z.
        _ if arithmetic.is_free() => {
            let rest = arithmetic.add(1.0, -z);
            order::products(arithmetic, &[[x, rest], [y, z]])
        }
        _ => {
            let way = arithmetic.add(y, -x);
            let part = arithmetic.multiply(way, z);
            arithmetic.add(x, part)
        }
    }
}

/// An operation on integers or truth values.
pub fn of_integers(op: BinaryOperator, a: u32, b: u32) -> u32 {
    use BinaryOperator::*;
    match op {
        Add => a.wrapping_add(b),
        Subtract => a.wrapping_sub(b),
        Multiply => a.wrapping_mul(b),
        Divide => a.checked_div(b).unwrap_or(a),
        Modulo => a.checked_rem(b).unwrap_or(0),
        Equal => u32::from(a == b),
        NotEqual => u32::from(a != b),
        Less => u32::from(a < b),
        LessEqual => u32::from(a <= b),
        Greater => u32::from(a > b),
        GreaterEqual => u32::from(a >= b),
        And | LogicalAnd => a & b,
        ExclusiveOr => a ^ b,
        InclusiveOr | LogicalOr => a | b,
        ShiftLeft => a.wrapping_shl(b),
        ShiftRight => a.wrapping_shr(b),
    }
}

/// A scalar of another kind. Integers here are unsigned.
pub fn converted(word: u32, from: Option<ScalarKind>, to: ScalarKind) -> u32 {
    match (from, to) {
        (Some(ScalarKind::Float), ScalarKind::Uint) => f32::from_bits(word) as u32,
        (Some(ScalarKind::Float), ScalarKind::Sint) => (f32::from_bits(word) as i32) as u32,
        (Some(ScalarKind::Sint), ScalarKind::Float) => (word as i32 as f32).to_bits(),
        (Some(ScalarKind::Uint | ScalarKind::Bool), ScalarKind::Float) => (word as f32).to_bits(),
        (Some(ScalarKind::Float), ScalarKind::Bool) => u32::from(f32::from_bits(word) != 0.0),
        (_, ScalarKind::Bool) => u32::from(word != 0),
        _ => word,
    }
}
