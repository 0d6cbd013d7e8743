//! Levels, tiles and draw calls of random grids, on a device and in Rust.

mod common;

use common::software;
use pipeline::wgsl::{self, Variant};
use techniques::grid::wrong_levels;

#[test]
fn kernels_come_to_the_levels_tiles_and_calls_of_their_twin() {
    assert_eq!(wrong_levels(&software(), &wgsl::source), Ok(None));
}

#[test]
fn a_kernel_that_comes_to_others_is_found_out() {
    let device = software();
    let faults = [
        ("atomicMax(&marks[groups.z], level.x);", "atomicMax(&marks[groups.z], level.y);", "is grid"),
        (
            "let level = level_of(measures[grid].bend, allowed, floor);",
            "let level = level_of(measures[grid].bend, allowed, floor.yx);",
            "is grid",
        ),
        (
            "vec3<f32>(power(2u * level.x), power(level.x + level.y)",
            "vec3<f32>(power(2u * level.x), power(2u * level.y)",
            "is grid",
        ),
        (
            "if (off > allowed && widened <= GREATEST) {",
            "if (off > allowed) {\n        pixel = allowed;\n    }\n    if (false) {",
            "is grid",
        ),
        (
            "let tiles = min(counts[row + calls[id.x].end_grid], asked.capacity) - start;",
            "let tiles = counts[row + calls[id.x].end_grid] - start;",
            "draw call",
        ),
        ("carried += scans[SCANNERS - 1u];", "carried = scans[SCANNERS - 1u];", "draw call"),
        ("((k % across) << column.side)", "(k % across)", "draw call"),
    ];
    for (original, replacement, cause) in faults {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(original), "{original}");
            source.replacen(original, replacement, 1)
        };
        let found = wrong_levels(&device, &source).expect("it compiles");
        let found = found.unwrap_or_else(|| panic!("{original} -> {replacement} changes nothing"));
        assert!(found.contains(cause), "{original} -> {replacement}: {found}");
    }
}
