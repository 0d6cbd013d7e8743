//! The kernels' strict arithmetic, asked one operation at a time: whether a device has the bits of Rust's own. A picture shows
//! the last digit of a depth nowhere; what kernels promise rests on it all the same.

use super::compute::STRICT;
use bytemuck::{Pod, Zeroable};
use gpu::groups::{READ, UNIFORM, WRITE, whole};
use gpu::{Device, GpuError};
use pipeline::wgsl::{Part, Variant};
use pipeline::{Program, TrimMethod};
use wgpu::{BufferUsages, ShaderStages};

/// The kernel, and what it asks.
const PARTS: &[Part] = &[
    Part { file: "raster/arithmetic.wgsl", text: include_str!("../../../../shaders/raster/arithmetic.wgsl") },
    STRICT,
];

/// Threads of a workgroup in `shaders/raster/arithmetic.wgsl`.
const WORKGROUP: u32 = 64;

/// How far a number of 64 bits may be from its approximation, as a share of it (`approximate` in `shaders/raster/strict.wgsl`).
const APPROXIMATE: f64 = 1.0 / (1 << 22) as f64;

const ASKING: &str = "asking for arithmetic";

/// `Operands` in `shaders/raster/arithmetic.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Operands {
    a: u32,
    b: u32,
    i: i32,
    j: i32,
}

/// `Results` there.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Results {
    sum: f32,
    difference: f32,
    product: f32,
    quotient: f32,
    wide_product: [u32; 2],
    wide_difference: [u32; 2],
    rounded: f32,
    approximate: f32,
    product_and_sum: f32,
}

impl Operands {
    /// The same in Rust's own arithmetic.
    fn results(self) -> Results {
        let [a, b] = [self.a, self.b].map(f32::from_bits);
        let whole = |high: i32, low: u32| i64::from(high) << 32 | i64::from(low);
        let halves = |x: i64| [(x >> 32) as u32, x as u32];
        Results {
            sum: a + b,
            difference: a - b,
            product: a * b,
            quotient: a / b,
            wide_product: halves(i64::from(self.i) * i64::from(self.j)),
            wide_difference: halves(whole(self.i, self.a).wrapping_sub(whole(self.j, self.b))),
            rounded: whole(self.j & 0x7f_ffff, self.a) as f32,
            approximate: whole(self.j << 8 >> 8, self.a) as f32,
            product_and_sum: a * b + a,
        }
    }

    /// The first operation of which a device's result is another. What is too large for a float may be anything, and what
    /// is below the least normal one 0.
    fn wrong(self, found: Results) -> Option<&'static str> {
        let [a, b] = [self.a, self.b].map(|bits| f64::from(f32::from_bits(bits)));
        let expected = self.results();
        let is_same = |exact: f64, e: f32, f: f32| {
            e == f || e.is_infinite() || (exact.abs() < f64::from(f32::MIN_POSITIVE) && f == 0.0)
        };
        let is_small = |x: f32| x != 0.0 && !x.is_normal();
        let is_left_out = is_small((a * b) as f32) || is_small(expected.product_and_sum);
        let off = (f64::from(found.approximate) - f64::from(expected.approximate)).abs();
        let checks = [
            ("sum", is_same(a + b, expected.sum, found.sum)),
            ("difference", is_same(a - b, expected.difference, found.difference)),
            ("product", is_same(a * b, expected.product, found.product)),
            ("quotient", is_same(a / b, expected.quotient, found.quotient)),
            ("product of whole numbers", expected.wide_product == found.wide_product),
            ("difference of whole numbers", expected.wide_difference == found.wide_difference),
            ("rounded whole number", expected.rounded == found.rounded),
            ("product and sum", is_left_out || is_same(f64::NAN, expected.product_and_sum, found.product_and_sum)),
            ("approximate whole number", off <= APPROXIMATE * f64::from(expected.approximate.abs())),
        ];
        checks.into_iter().find(|(_, is_right)| !is_right).map(|(name, _)| name)
    }
}

/// Every pair of 120 numbers: round ones and their neighbours, the least that are normal, and any. The second float is positive.
fn operands() -> Vec<Operands> {
    // As many digits as there are, by the golden ratio.
    let any = |k: u32| k.wrapping_mul(0x9e37_79b9) ^ (k << 7);
    let powers = || [-126, -125, -101, -24, -1, 0, 1, 8, 23, 24, 60].map(|power| 2f32.powi(power).to_bits());
    let round = powers().into_iter().flat_map(|bits| [bits, bits + 1, bits | 0x7f_ffff]);
    // As low halves the last two are of numbers half way between two floats.
    let chosen = [3f32.to_bits(), 5f32.to_bits(), 7f32.to_bits(), 10f32.to_bits(), 0x100_0001, 0x100_0003];
    // Of either sign, from 2^-31 to 2^32.
    let floats = (1..81).map(|k| any(k) & 0x807f_ffff | (96 + k % 64) << 23);
    let floats: Vec<u32> = [0].into_iter().chain(round).chain(chosen).chain(floats).collect();
    let edges = [0, 1, 2, 0xffff, 0x1_0000, 0x1_0001, 0x7f_ffff, 0x100_0000, i32::MAX];
    let wholes: Vec<i32> =
        edges.into_iter().flat_map(|i| [i, -i]).chain((1..103).map(|k| (any(k + 200) as i32) >> (k % 24))).collect();
    let pair = |k: usize, l: usize| Operands { a: floats[k], b: floats[l] & 0x7fff_ffff, i: wholes[k], j: wholes[l] };
    let divisors = (1..floats.len()).collect::<Vec<_>>();
    (0..floats.len()).flat_map(|k| divisors.iter().map(move |&l| (k, l))).map(|(k, l)| pair(k, l)).collect()
}

/// The first operation, with its operands, that the program of `source` does otherwise than Rust on this device; `None` where it has
/// the same bits in all of 14,400 cases.
///
/// # Errors
/// [`GpuError::Shader`], [`GpuError::OutOfMemory`], [`GpuError::Timeout`], [`GpuError::Lost`].
pub fn wrong_arithmetic(device: &Device, source: &dyn Fn(Variant) -> String) -> Result<Option<String>, GpuError> {
    let (program, trims) = (Program::Degree(3), TrimMethod::Whole);
    let variant = Variant { parts: PARTS, program, curvature: false, vertex_normals: false, trims };
    let module = device.module(program, source(variant))?;
    let layout = device.guarded(ASKING, || {
        device.group_layout("arithmetic", ShaderStages::COMPUTE, [(0, READ), (1, WRITE), (5, UNIFORM)])
    })?;
    let pipeline_layout = device.guarded(ASKING, || device.pipeline_layout("arithmetic", &[None, Some(&layout)]))?;
    let pipeline = device.kernel(&pipeline_layout, (program, &module), "operate", &[])?;
    let asked = operands();
    let mut found: Vec<Results> = vec![Zeroable::zeroed(); asked.len()];
    let buffers = [bytemuck::cast_slice(&asked), bytemuck::cast_slice::<Results, u8>(&found)];
    let [given, made] = [device.storage("operands", buffers[0])?, device.storage("results", buffers[1])?];
    let zeros = device.buffer("zeros", BufferUsages::UNIFORM, &[0; 16])?;
    let encoder = device.guarded(ASKING, || {
        let resources = whole([&given, &made]).chain([(5, zeros.as_entire_binding())]);
        let group = device.group("arithmetic", &layout, resources);
        let mut encoder = device.wgpu.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups((asked.len() as u32).div_ceil(WORKGROUP), 1, 1);
        drop(pass);
        encoder
    })?;
    device.submit(ASKING, encoder)?;
    device.read_buffer(ASKING, &made, 0, bytemuck::cast_slice_mut(&mut found))?;
    let wrong = |(asked, found): (&Operands, &Results)| {
        let name = asked.wrong(*found)?;
        Some(format!("{name} of {asked:?}: {found:?}, not {:?}", asked.results()))
    };
    Ok(asked.iter().zip(&found).find_map(wrong))
}
