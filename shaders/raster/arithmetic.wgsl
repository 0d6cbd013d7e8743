// The strict arithmetic at given numbers: no triangles. Host: crates/techniques/src/triangles/arithmetic.rs.
// Uses raster/strict.wgsl

// Bits of two floats, the second positive, and two whole numbers.
struct Operands {
    a: u32,
    b: u32,
    i: i32,
    j: i32,
}

// What the operations make of them. Of numbers of 64 bits i and j are the high halves, a and b the low ones.
struct Results {
    sum: f32,
    difference: f32,
    product: f32,
    quotient: f32,
    wide_product: Wide,
    wide_difference: Wide,
    rounded: f32,
    approximate: f32,
    product_and_sum: f32,
}

@group(1) @binding(0) var<storage, read> operands: array<Operands>;
@group(1) @binding(1) var<storage, read_write> results: array<Results>;

@compute @workgroup_size(64)
fn operate(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= min(arrayLength(&operands), arrayLength(&results))) {
        return;
    }
    let given = operands[id.x];
    let a = bitcast<f32>(given.a);
    let b = bitcast<f32>(given.b);
    let first = Wide(given.i, given.a);
    // From 0 to below 2^55, and of either sign.
    let positive = Wide(given.j & 0x7fffff, given.a);
    let signed = Wide((given.j << 8u) >> 8u, given.a);
    results[id.x] = Results(
        sum(a, b),
        difference(a, b),
        product(a, b),
        quotient(a, b),
        wide_product(given.i, given.j),
        wide_difference(first, Wide(given.j, given.b)),
        rounded(positive),
        approximate(signed),
        sum(kept(product(a, b)), a),
    );
}
