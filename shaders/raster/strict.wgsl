// Arithmetic with the same bits everywhere: sums and products that are neither fused nor put in another order, quotients that are
// corrected in integers, whole numbers of 64 bits. Twin: Rust's own + − × ÷ on f32 and i64.
// What is asked of an adapter: a sum or a product of two floats, alone, is rounded to nearest, and a quotient is near (`quotient`). The
// results of sums and products that are below the least normal float may be zero.

// Zeros that no compiler sees.
@group(1) @binding(5) var<uniform> zeros: vec4<u32>;

// A value as it is, which no compiler knows. Not by an exclusive or: of two such with the same number, one behind the other, a
// compiler leaves out both, and fuses what they stood between.
fn kept(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) | zeros.x);
}

fn sum(a: f32, b: f32) -> f32 {
    return kept(a + b);
}

fn difference(a: f32, b: f32) -> f32 {
    return kept(a - b);
}

fn product(a: f32, b: f32) -> f32 {
    return kept(a * b);
}

const SIGN: u32 = 0x80000000u;
const MAGNITUDE: u32 = 0x7fffffffu;
const INFINITE: u32 = 0x7f800000u;
const LEADING: u32 = 0x800000u;

// A positive number as mantissa × 2^(exponent − 150), where the mantissa has its leading one at bit 23.
struct Unpacked {
    mantissa: u32,
    exponent: i32,
}

// Of the bits of a number that is neither zero nor infinite.
fn unpacked(magnitude: u32) -> Unpacked {
    let exponent = magnitude >> 23u;
    if (exponent == 0u) {
        let shift = 23u - firstLeadingBit(magnitude);
        return Unpacked(magnitude << shift, 1 - i32(shift));
    }
    return Unpacked((magnitude & 0x7fffffu) | LEADING, i32(exponent));
}

// Bits of a number with this exponent, of which a mantissa's bits to the right of the lowest say how to round: `rest` of what
// is to the right of it. The mantissa has its leading one at bit 23 + `digits`, of which there are 1 … 7.
fn packed(exponent: i32, mantissa: u32, digits: u32, rest: bool) -> u32 {
    // Below the least normal number a number has fewer digits.
    let shift = min(digits + u32(max(1 - exponent, 0)), 31u);
    var kept_digits = mantissa >> shift;
    let lost = mantissa & ((1u << shift) - 1u);
    let half = 1u << (shift - 1u);
    if (lost > half || (lost == half && (rest || (kept_digits & 1u) != 0u))) {
        kept_digits += 1u;
    }
    if (exponent >= 255) {
        return INFINITE;
    }
    return (u32(max(exponent, 1) - 1) << 23u) + kept_digits;
}

// a / b, or near it: by the adapter.
fn guessed(a: f32, b: f32) -> f32 {
    return a / b;
}

// a / b, rounded to nearest, halves to even. The adapter's own quotient may be off by 32 units of its last place: what it leaves is
// computed in integers, and corrects it.
fn quotient(a: f32, b: f32) -> f32 {
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & SIGN;
    let of_a = bitcast<u32>(a) & MAGNITUDE;
    let of_b = bitcast<u32>(b) & MAGNITUDE;
    if (of_a == 0u || of_b == 0u || max(of_a, of_b) >= INFINITE) {
        return bitcast<f32>((sign ^ endless_quotient(of_a, of_b)) | zeros.x);
    }
    let x = unpacked(of_a);
    let y = unpacked(of_b);
    let is_less = x.mantissa < y.mantissa;
    let dividend = select(x.mantissa, x.mantissa << 1u, is_less);
    let divisor = i32(y.mantissa);
    // A number of 1 … 2: its digits behind the point, and one more, which says how to round.
    let guess = guessed(f32(dividend), f32(divisor));
    var digits = 2 * (bitcast<i32>(guess) - 0x3f800000) + 0x1000000;
    // dividend × 2^24 − digits × divisor, which is far below 2^31, so that what is beyond 32 bits need not be known.
    var rest = bitcast<i32>((dividend << 24u) - u32(digits) * u32(divisor));
    let more = i32(guessed(f32(rest), f32(divisor)));
    digits += more;
    rest -= more * divisor;
    // `more` may be off by one to either side.
    let is_over = rest < 0;
    digits -= select(0, 1, is_over);
    rest += select(0, divisor, is_over);
    let is_under = rest >= divisor;
    digits += select(0, 1, is_under);
    rest -= select(0, divisor, is_under);
    let exponent = x.exponent - y.exponent + 127 - select(0, 1, is_less);
    return bitcast<f32>(sign | packed(exponent, u32(digits), 1u, rest != 0));
}

// The same of magnitudes of which one is zero, infinite or no number.
fn endless_quotient(a: u32, b: u32) -> u32 {
    if (max(a, b) > INFINITE || a == b) {
        return 0x7fc00000u;
    }
    return select(0u, INFINITE, a > b);
}

// A whole number of 64 bits.
struct Wide {
    high: i32,
    low: u32,
}

fn wide_product(a: i32, b: i32) -> Wide {
    let ua = u32(abs(a));
    let ub = u32(abs(b));
    let low_low = (ua & 0xffffu) * (ub & 0xffffu);
    let low_high = (ua & 0xffffu) * (ub >> 16u);
    let high_low = (ua >> 16u) * (ub & 0xffffu);
    let middle = (low_low >> 16u) + (low_high & 0xffffu) + (high_low & 0xffffu);
    let high = (ua >> 16u) * (ub >> 16u) + (low_high >> 16u) + (high_low >> 16u) + (middle >> 16u);
    let positive = Wide(i32(high), (middle << 16u) | (low_low & 0xffffu));
    if ((a < 0) != (b < 0)) {
        return wide_difference(Wide(0, 0u), positive);
    }
    return positive;
}

fn wide_difference(a: Wide, b: Wide) -> Wide {
    return Wide(a.high - b.high - select(0, 1, a.low < b.low), a.low - b.low);
}

// The float nearest to a number from 0 to below 2^55, halves to even.
fn rounded(w: Wide) -> f32 {
    if (w.high == 0 && w.low < 0x1000000u) {
        return f32(w.low);
    }
    var leading = firstLeadingBit(w.low);
    if (w.high != 0) {
        leading = 32u + firstLeadingBit(u32(w.high));
    }
    // 1 … 31 bits are lost.
    let shift = leading - 23u;
    var mantissa = (w.low >> shift) | (u32(w.high) << (32u - shift));
    let lost = w.low & ((1u << shift) - 1u);
    let half = 1u << (shift - 1u);
    if (lost > half || (lost == half && (mantissa & 1u) != 0u)) {
        mantissa += 1u;
    }
    return bitcast<f32>(((150u + shift) << 23u) + (mantissa - LEADING));
}

// A number of either sign below 2^55, to within 2^-22 of itself: the low half is taken with its sign, for what is little below
// zero would be lost among 2^32.
fn approximate(w: Wide) -> f32 {
    return f32(w.high + i32(w.low >> 31u)) * 4294967296.0 + f32(i32(w.low));
}
