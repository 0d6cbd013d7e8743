//! Each operation of a strict program, held against Rust's.

use crate::random::Random;
use anyhow::Result;
use clap::ValueEnum;
use gpu::{Device, Operation, Operator};
use isophote::say;
use rayon::prelude::*;
use std::time::Instant;

/// Pairs of operands a dispatch.
const CHUNK: u64 = 1 << 22;

/// How many operands each operation is tried at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Amount {
    /// None
    None,
    /// Some millions
    Few,
    /// All of 2^32 for the root, 2^30 pairs for the others, among them all mantissas of a divisor
    All,
}

/// Pairs of operands by chance or in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operands {
    /// Any bits.
    Bits,
    /// Finite numbers near each other in size, so that sums cancel.
    Near,
    /// Numbers whose products or quotients are about the least normal one.
    Tiny,
    /// The first goes through all bits.
    InOrder,
    /// The second goes through all mantissas of 1 … 2, and the first is of 1 … 2.
    Mantissas,
}

impl Operands {
    /// The pairs from number `first` on.
    pub fn pairs(self, first: u64, count: usize) -> Vec<[f32; 2]> {
        let pair = |index: u64| {
            let mut random = Random::new(index ^ (self as u64) << 56);
            let [x, y] = [random.bits() as u32, (random.bits() >> 16) as u32];
            let near = |bits: u32, exponent: u32| (bits & 0x807f_ffff) | (exponent.min(254) << 23);
            let spread = random.below(60) as u32;
            let bits = match self {
                Self::Bits => [x, y],
                Self::Near => {
                    let exponent = random.below(255) as u32;
                    [near(x, exponent), near(y, (exponent + spread).saturating_sub(30))]
                }
                Self::Tiny => {
                    let exponent = random.below(128) as u32;
                    let other = if random.coin() { 128 - exponent } else { 126 + exponent };
                    // Few digits, so that halves occur.
                    let mut few = |bits: u32| bits & (u32::MAX << random.below(23));
                    [few(near(x, exponent)), few(near(y, other.saturating_sub(10) + spread / 3))]
                }
                Self::InOrder => [index as u32, 0],
                Self::Mantissas => [(x & 0x7f_ffff) | 0x3f80_0000, (index as u32 & 0x7f_ffff) | 0x3f80_0000],
            };
            bits.map(f32::from_bits)
        };
        (first..first + count as u64).into_par_iter().map(pair).collect()
    }
}

/// What is tried: an operation, its operands, and how many pairs of them by `Few` and by `All`.
const TRIALS: [(Operation, Operands, [u64; 2]); 19] = [
    (Operation::Root, Operands::InOrder, [CHUNK, 1 << 32]),
    (Operation::Root, Operands::Bits, [CHUNK, CHUNK]),
    (Operation::Quotient, Operands::Mantissas, [CHUNK, 1 << 30]),
    (Operation::Quotient, Operands::Bits, [CHUNK, 1 << 26]),
    (Operation::Quotient, Operands::Tiny, [CHUNK, 1 << 26]),
    (Operation::Product, Operands::Bits, [CHUNK, 1 << 26]),
    (Operation::Product, Operands::Tiny, [CHUNK, 1 << 26]),
    (Operation::Sum, Operands::Near, [CHUNK, 1 << 28]),
    (Operation::Sum, Operands::Bits, [CHUNK, 1 << 26]),
    (Operation::Difference, Operands::Near, [CHUNK, 1 << 26]),
    (Operation::Less, Operands::Bits, [CHUNK, 1 << 24]),
    (Operation::Less, Operands::Near, [CHUNK, 1 << 24]),
    (Operation::ProductAndSum, Operands::Bits, [CHUNK, 1 << 26]),
    (Operation::ProductAndSum, Operands::Mantissas, [CHUNK, 1 << 26]),
    (Operation::TwiceKept, Operands::Mantissas, [CHUNK, 1 << 26]),
    (Operation::Products, Operands::Bits, [CHUNK, 1 << 26]),
    (Operation::Products, Operands::Mantissas, [CHUNK, 1 << 26]),
    (Operation::Rounding, Operands::Near, [CHUNK, 1 << 26]),
    (Operation::Rounding, Operands::Mantissas, [CHUNK, 1 << 26]),
];

/// Tries all, prints a line each, and returns how many differ.
///
/// # Errors
/// Where the adapter refuses.
pub fn run(device: &Device, amount: Amount) -> Result<usize> {
    let mut wrong = 0;
    for (operation, operands, [few, all]) in TRIALS {
        let count = if amount == Amount::All { all } else { few };
        let began = Instant::now();
        let operator = |subnormals| Operator::new(device, operation, subnormals, &|source| source);
        let operators = [operator(true)?, operator(false)?];
        let (mut differ, mut raised, mut first) = (0, 0, None);
        for start in (0..count).step_by(CHUNK as usize) {
            let pairs = operands.pairs(start, CHUNK as usize);
            for operator in &operators {
                let results = operator.results(&pairs)?;
                let found = unlike(operation, &pairs, &results);
                differ += found.len();
                raised += results.iter().filter(|result| result.is_none()).count();
                first = first.or(found.first().copied());
            }
        }
        let seconds = began.elapsed().as_secs_f64();
        let name = format!("{operation:?}, {operands:?}");
        say!("{name:26} {count} pairs, {differ} differ, {raised} raised, {seconds:.1} s")?;
        if let Some(([a, b], result)) = first {
            let [exact, result] = [operation.exact([a, b]), result].map(f32::to_bits);
            say!("    first at {:08x}, {:08x}: {exact:08x} is right, {result:08x} came", a.to_bits(), b.to_bits())?;
        }
        wrong += usize::from(differ > 0);
    }
    Ok(wrong)
}

/// The pairs of operands of which a result has other bits than Rust's. Of what is no number only that is asked, and nothing of a
/// result that was raised.
pub fn unlike(operation: Operation, pairs: &[[f32; 2]], results: &[Option<f32>]) -> Vec<([f32; 2], f32)> {
    let other = |(&pair, result): (&[f32; 2], &Option<f32>)| {
        let (exact, result) = (operation.exact(pair), (*result)?);
        let is_other = exact.to_bits() != result.to_bits() && !(exact.is_nan() && result.is_nan());
        is_other.then_some((pair, result))
    };
    pairs.par_iter().zip(results).filter_map(other).collect()
}
