// Areas between a sample and two corners, as f64 has them: each product exact, their difference rounded to 53 bits, and that to
// 24. Twin: `cross` of crates/raster/src/setup.rs.
// Uses raster/strict.wgsl

// A number: sign, mantissa × 2^exponent, with the leading one at bit 63 of the mantissa; zero where `high` is.
struct Factor {
    sign: u32,
    high: u32,
    low: u32,
    exponent: i32,
}

fn exact_product(a: f32, b: f32) -> Factor {
    let of_a = bitcast<u32>(a) & MAGNITUDE;
    let of_b = bitcast<u32>(b) & MAGNITUDE;
    if (of_a == 0u || of_b == 0u) {
        return Factor();
    }
    let x = unpacked(of_a);
    let y = unpacked(of_b);
    let w = wide_product(i32(x.mantissa), i32(y.mantissa));
    let high = u32(w.high);
    // 47 or 48 bits.
    let shift = firstLeadingBit(high) ^ 31u;
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & SIGN;
    return Factor(sign, (high << shift) | (w.low >> (32u - shift)), w.low << shift, x.exponent + y.exponent - 300 - i32(shift));
}

// Bits moved right through three words; last, not zero where some are lost.
fn moved(words: vec3<u32>, by: u32) -> vec4<u32> {
    var x = vec4<u32>(words, 0u);
    var rest = by;
    for (; rest >= 32u; rest -= 32u) {
        x = vec4<u32>(0u, x.x, x.y, x.w | x.z);
    }
    if (rest > 0u) {
        let back = 32u - rest;
        x = vec4<u32>(x.x >> rest, (x.y >> rest) | (x.x << back), (x.z >> rest) | (x.y << back), x.w | (x.z << back));
    }
    return x;
}

fn area_between(a: vec2<f32>, b: vec2<f32>) -> f32 {
    var greater = exact_product(a.x, b.y);
    var less = exact_product(a.y, b.x);
    less.sign ^= SIGN;
    let is_swapped = greater.high == 0u || (less.high != 0u && (less.exponent > greater.exponent
        || (less.exponent == greater.exponent
            && (less.high > greater.high || (less.high == greater.high && less.low > greater.low)))));
    if (is_swapped) {
        let first = greater;
        greater = less;
        less = first;
    }
    if (greater.high == 0u) {
        return 0.0;
    }
    // 96 bits, the first one free for a carry.
    var x = moved(vec3<u32>(greater.high, greater.low, 0u), 1u).xyz;
    var rest = 0u;
    if (less.high != 0u) {
        let by = u32(min(greater.exponent - less.exponent, 95)) + 1u;
        let y = moved(vec3<u32>(less.high, less.low, 0u), by);
        rest = y.w;
        if (greater.sign == less.sign) {
            x = added(x, y.xyz, 0u);
        } else {
            // − y = not y + 1; what is lost of y takes the 1.
            x = added(x, ~y.xyz, select(1u, 0u, rest != 0u));
        }
    }
    if (all(x == vec3<u32>(0u))) {
        return 0.0;
    }
    let leading = leading_of(x);
    var exponent = greater.exponent - 31;
    if (leading > 52u) {
        let half = moved(x, leading - 53u);
        let whole = moved(half.xyz, 1u);
        let is_up = (half.z & 1u) != 0u && ((half.w | rest | (whole.z & 1u)) != 0u);
        x = added(whole.xyz, vec3<u32>(0u), select(0u, 1u, is_up));
        exponent += i32(leading) - 52;
    }
    let nearest = bitcast<u32>(rounded(Wide(i32(x.y), x.z)));
    return bitcast<f32>(greater.sign | (nearest + (bitcast<u32>(exponent) << 23u)));
}

fn added(a: vec3<u32>, b: vec3<u32>, carry: u32) -> vec3<u32> {
    let low = a.z + b.z + carry;
    let to_middle = select(0u, 1u, low < a.z || (carry != 0u && low == a.z));
    let middle = a.y + b.y + to_middle;
    let to_high = select(0u, 1u, middle < a.y || (to_middle != 0u && middle == a.y));
    return vec3<u32>(a.x + b.x + to_high, middle, low);
}

fn leading_of(x: vec3<u32>) -> u32 {
    if (x.x != 0u) {
        return 64u + firstLeadingBit(x.x);
    }
    if (x.y != 0u) {
        return 32u + firstLeadingBit(x.y);
    }
    return firstLeadingBit(x.z);
}
