// What the operators of a strict program are made of: IEEE 754 on 32 bits, rounded to nearest, halves to even, with the numbers
// below the least normal one. crates/gpu/src/ieee.rs puts these functions in the place of the operators.
// Uses raster/strict.wgsl, and `raise_subnormal` of the program.

// Whether subnormal numbers, those below the least normal one, are computed. That takes most of the code. Otherwise what may be one,
// or be made of one, is raised, and the picture is drawn again.
override COMPUTES_SUBNORMALS: bool = true;

// 2^-100: what is at least as large is summed by the adapter itself, what is below it 2^100 times as large.
const SCALED_BELOW: u32 = 0x0d800000u;
// 2^-75: beside one as large, a sum below 2^-100 is exact and needs no number below the least normal one.
const MODERATE: u32 = 0x1a000000u;
const HUNDRED_EXPONENTS: u32 = 0x32000000u;

fn ieee_negative(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ SIGN);
}

fn ieee_magnitude(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & MAGNITUDE);
}

fn ieee_sum(a: f32, b: f32) -> f32 {
    let s = kept(a + b);
    if ((bitcast<u32>(s) & MAGNITUDE) - SCALED_BELOW < INFINITE - SCALED_BELOW) {
        return s;
    }
    let greatest = max(bitcast<u32>(a) & MAGNITUDE, bitcast<u32>(b) & MAGNITUDE);
    if (!COMPUTES_SUBNORMALS) {
        // Of a number of at least 2^-100 and another, a sum below is zero or normal.
        if (greatest != 0u && greatest < SCALED_BELOW) {
            raise_subnormal();
        }
        return s;
    }
    if (greatest >= MODERATE) {
        return s;
    }
    return hundred_down(kept(hundred_up(a) + hundred_up(b)));
}

fn ieee_difference(a: f32, b: f32) -> f32 {
    return ieee_sum(a, ieee_negative(b));
}

// x × 2^100, exactly, of a number below 2^-75.
fn hundred_up(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let magnitude = bits & MAGNITUDE;
    if (magnitude >= LEADING) {
        return bitcast<f32>(bits + HUNDRED_EXPONENTS);
    }
    // 2^100 units of 2^-149.
    return bitcast<f32>((bits & SIGN) | bitcast<u32>(kept(f32(magnitude) * exp2_of(-49))));
}

// x × 2^-100 of a sum of two such numbers, which is a whole number of 2^-149.
fn hundred_down(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let magnitude = bits & MAGNITUDE;
    if (magnitude >= HUNDRED_EXPONENTS + LEADING) {
        return bitcast<f32>(bits - HUNDRED_EXPONENTS);
    }
    return bitcast<f32>((bits & SIGN) | u32(kept(bitcast<f32>(magnitude) * exp2_of(49))));
}

// 2^k.
fn exp2_of(k: i32) -> f32 {
    return bitcast<f32>(u32(127 + k) << 23u);
}

fn ieee_product(a: f32, b: f32) -> f32 {
    let p = kept(a * b);
    // Adapters part where a product is at most the least normal number.
    if ((bitcast<u32>(p) & MAGNITUDE) - (LEADING + 1u) < INFINITE - (LEADING + 1u)) {
        return p;
    }
    let of_a = bitcast<u32>(a) & MAGNITUDE;
    let of_b = bitcast<u32>(b) & MAGNITUDE;
    if (max(of_a, of_b) >= INFINITE) {
        return p;
    }
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & SIGN;
    if (of_a == 0u || of_b == 0u) {
        return bitcast<f32>(sign);
    }
    if (!COMPUTES_SUBNORMALS) {
        if ((bitcast<u32>(p) & MAGNITUDE) <= LEADING) {
            raise_subnormal();
        }
        return p;
    }
    let x = unpacked(of_a);
    let y = unpacked(of_b);
    let w = wide_product(i32(x.mantissa), i32(y.mantissa));
    // 47 or 48 bits, of which 26 are kept for now.
    let shift = firstLeadingBit(u32(w.high)) + 7u;
    let high = (u32(w.high) << (32u - shift)) | (w.low >> shift);
    let rest = (w.low & ((1u << shift) - 1u)) != 0u;
    return bitcast<f32>(sign | packed(x.exponent + y.exponent - 148 + i32(shift), high, 2u, rest));
}

fn ieee_quotient(a: f32, b: f32) -> f32 {
    return quotient(a, b);
}

// The square root, digit by digit.
fn ieee_root(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    if (bits == 0u || bits == SIGN || bits == INFINITE) {
        return x;
    }
    if (bits > INFINITE) {
        return bitcast<f32>(0x7fc00000u | zeros.x);
    }
    let number = unpacked(bits);
    let exponent = number.exponent - 127;
    var rest = number.mantissa << (1u + (u32(exponent) & 1u));
    var root = 0u;
    var twice = 0u;
    for (var digit = 0x1000000u; digit != 0u; digit >>= 1u) {
        let tried = twice + digit;
        if (tried <= rest) {
            twice = tried + digit;
            rest -= tried;
            root += digit;
        }
        rest <<= 1u;
    }
    // 25 digits, and halves do not occur.
    root += root & 1u;
    return bitcast<f32>((root >> 1u) + (u32((exponent >> 1u) + 126) << 23u));
}

fn is_number(x: f32) -> bool {
    return (bitcast<u32>(x) & MAGNITUDE) <= INFINITE;
}

// Whole numbers in the order of floats.
fn place_among_floats(x: f32) -> i32 {
    let magnitude = bitcast<i32>(bitcast<u32>(x) & MAGNITUDE);
    return select(magnitude, -magnitude, bitcast<i32>(x) < 0);
}

fn ieee_less(a: f32, b: f32) -> bool {
    return is_number(a) & is_number(b) & (place_among_floats(a) < place_among_floats(b));
}

fn ieee_at_most(a: f32, b: f32) -> bool {
    return is_number(a) & is_number(b) & (place_among_floats(a) <= place_among_floats(b));
}

fn ieee_equal(a: f32, b: f32) -> bool {
    return is_number(a) & is_number(b) & (place_among_floats(a) == place_among_floats(b));
}

fn ieee_unequal(a: f32, b: f32) -> bool {
    return !ieee_equal(a, b);
}

// Of a number and what is none, the number.
fn ieee_least(a: f32, b: f32) -> f32 {
    return select(a, b, ieee_less(b, a) | !is_number(a));
}

fn ieee_greatest(a: f32, b: f32) -> f32 {
    return select(a, b, ieee_less(a, b) | !is_number(a));
}

fn ieee_clamped(x: f32, low: f32, high: f32) -> f32 {
    return ieee_least(ieee_greatest(x, low), high);
}
