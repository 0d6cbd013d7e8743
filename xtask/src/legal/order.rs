//! Sums and products in any order: what WGSL lets a compiler do with an expression before it is computed (Sec. 15.7.3).
//!
//! An expression that is used once and has no name may be opened up: the terms of a sum in any order and in two halves, the
//! factors of a product in any order, and any product fused into the sum that it is a term of. What has a name keeps its value,
//! but a product of that name may still be fused, by each of its uses alone. That is the freedom that
//! `pipeline::enclosure` proves its intervals for.

use super::arithmetic::Arithmetic;
use super::program::{Frame, Prepared};
use naga::{BinaryOperator, Expression, Handle, UnaryOperator};

/// Terms of a sum, or factors of a product, that are put in another order together.
const MOST: usize = 8;

/// A term of a sum: its sign, and what it is.
type Term = (f32, Handle<Expression>);

/// A sum or a difference, at one lane.
pub fn sum(arithmetic: &mut Arithmetic, frame: &Frame, root: Handle<Expression>, lane: usize) -> f32 {
    let Expression::Binary { op, left, right } = frame.prepared.function.expressions[root] else {
        unreachable!("a sum")
    };
    let sign = if op == BinaryOperator::Add { 1.0 } else { -1.0 };
    if arithmetic.is_strict() {
        let [a, b] = [left, right].map(|x| frame.number(x, lane));
        return arithmetic.add(a, sign * b);
    }
    let mut terms = [(1.0, root); MOST];
    let mut count = 0;
    if arithmetic.random.coin() {
        open(frame.prepared, left, 1.0, &mut terms, &mut count, 1);
        open(frame.prepared, right, sign, &mut terms, &mut count, 0);
        arithmetic.random.shuffle(&mut terms[..count]);
    } else {
        terms[..2].copy_from_slice(&[(1.0, left), (sign, right)]);
        count = 2;
    }
    if count > 3 && arithmetic.random.below(4) == 0 {
        let (a, b) = terms[..count].split_at(count / 2);
        let [a, b] = [a, b].map(|terms| added(arithmetic, frame, terms, lane));
        return arithmetic.add(a, b);
    }
    added(arithmetic, frame, &terms[..count], lane)
}

/// Terms one after the other.
fn added(arithmetic: &mut Arithmetic, frame: &Frame, terms: &[Term], lane: usize) -> f32 {
    let (sign, first) = terms[0];
    let mut sum = sign * frame.number(first, lane);
    for &(sign, term) in &terms[1..] {
        sum = match frame.prepared.function.expressions[term] {
            Expression::Binary { op: BinaryOperator::Multiply, left, right } if arithmetic.random.coin() => {
                let [a, b] = [left, right].map(|x| frame.number(x, lane));
                arithmetic.fused(sign * a, b, sum)
            }
            _ => {
                let term = frame.number(term, lane);
                arithmetic.add(sum, sign * term)
            }
        };
    }
    sum
}

/// Takes a term apart where it is a sum itself that nothing else uses; `reserved` places are kept for what comes after it.
fn open(
    f: &Prepared,
    term: Handle<Expression>,
    sign: f32,
    terms: &mut [Term; MOST],
    count: &mut usize,
    reserved: usize,
) {
    let has_room = *count + 2 + reserved <= MOST;
    match f.function.expressions[term] {
        Expression::Binary { op: op @ (BinaryOperator::Add | BinaryOperator::Subtract), left, right }
            if has_room && !f.is_kept(term) =>
        {
            open(f, left, sign, terms, count, reserved + 1);
            open(f, right, if op == BinaryOperator::Add { sign } else { -sign }, terms, count, reserved);
        }
        Expression::Unary { op: UnaryOperator::Negate, expr } if !f.is_kept(term) => {
            open(f, expr, -sign, terms, count, reserved);
        }
        _ => {
            terms[*count] = (sign, term);
            *count += 1;
        }
    }
}

/// A product, at one lane.
pub fn product(arithmetic: &mut Arithmetic, frame: &Frame, root: Handle<Expression>, lane: usize) -> f32 {
    let Expression::Binary { left, right, .. } = frame.prepared.function.expressions[root] else {
        unreachable!("a product")
    };
    let mut factors = [left; MOST];
    let mut count = 0;
    if arithmetic.is_free() {
        factors_of(frame.prepared, left, &mut factors, &mut count, 1);
        factors_of(frame.prepared, right, &mut factors, &mut count, 0);
        arithmetic.random.shuffle(&mut factors[..count]);
    } else {
        factors[..2].copy_from_slice(&[left, right]);
        count = 2;
    }
    let mut product = frame.number(factors[0], lane);
    for &factor in &factors[1..count] {
        let factor = frame.number(factor, lane);
        product = arithmetic.multiply(product, factor);
    }
    product
}

fn factors_of(
    f: &Prepared,
    factor: Handle<Expression>,
    factors: &mut [Handle<Expression>; MOST],
    count: &mut usize,
    reserved: usize,
) {
    match f.function.expressions[factor] {
        Expression::Binary { op: BinaryOperator::Multiply, left, right }
            if *count + 2 + reserved <= MOST && !f.is_kept(factor) =>
        {
            factors_of(f, left, factors, count, reserved + 1);
            factors_of(f, right, factors, count, reserved);
        }
        _ => {
            factors[*count] = factor;
            *count += 1;
        }
    }
}

/// A sum of products of two numbers each.
pub fn products(arithmetic: &mut Arithmetic, terms: &[[f32; 2]]) -> f32 {
    let mut order = [0, 1, 2, 3];
    if arithmetic.is_free() {
        arithmetic.random.shuffle(&mut order[..terms.len()]);
    }
    let [a, b] = terms[order[0]];
    let mut sum = arithmetic.multiply(a, b);
    for &k in &order[1..terms.len()] {
        let [a, b] = terms[k];
        sum = if arithmetic.is_free() {
            arithmetic.fused(a, b, sum)
        } else {
            let product = arithmetic.multiply(a, b);
            arithmetic.add(sum, product)
        };
    }
    sum
}
