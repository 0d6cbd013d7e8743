// Arithmetic with the same bits everywhere: sums and products that are neither fused nor put in another order, quotients and
// whole numbers of 64 bits in integers. Twin: Rust's own + − × ÷ on f32 and i64.
// What is asked of an adapter: a sum or a product of two floats, alone, is rounded to nearest. The results that are below the
// least normal float may be zero.

// Zeros that no compiler sees.
@group(1) @binding(5) var<uniform> zeros: vec4<u32>;

// A value as it is, which no compiler knows.
fn kept(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zeros.x);
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

// a / b rounded to nearest, by long division; b is positive. No quotient of two floats is half way between two others: times
// its divisor it would have more digits than a float.
fn quotient(a: f32, b: f32) -> f32 {
    let bits_a = bitcast<u32>(a);
    let bits_b = bitcast<u32>(b);
    let exponent_a = (bits_a >> 23u) & 0xffu;
    if (exponent_a == 0u) {
        return 0.0;
    }
    var exponent = i32(exponent_a) - i32((bits_b >> 23u) & 0xffu) + 127;
    var rest = (bits_a & 0x7fffffu) | 0x800000u;
    let divisor = (bits_b & 0x7fffffu) | 0x800000u;
    if (rest < divisor) {
        rest <<= 1u;
        exponent -= 1;
    }
    rest -= divisor;
    // 24 digits behind the leading one: the last says how to round.
    var digits = 1u;
    for (var i = 0u; i < 3u; i++) {
        rest <<= 8u;
        let eight = rest / divisor;
        rest -= eight * divisor;
        digits = (digits << 8u) | eight;
    }
    let mantissa = (digits + 1u) >> 1u;
    if (exponent <= 0) {
        return 0.0;
    }
    return bitcast<f32>((bits_a & 0x80000000u) | ((u32(exponent) << 23u) + (mantissa - 0x800000u)));
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
    return bitcast<f32>(((150u + shift) << 23u) + (mantissa - 0x800000u));
}

// A number of either sign below 2^55, to within 2^-22 of itself: the low half is taken with its sign, for what is little below
// zero would be lost among 2^32.
fn approximate(w: Wide) -> f32 {
    return f32(w.high + i32(w.low >> 31u)) * 4294967296.0 + f32(i32(w.low));
}
