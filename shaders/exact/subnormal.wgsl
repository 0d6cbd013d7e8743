// Technique `exact`, strictly: how it says that it met a subnormal number where it computes none, by more meetings than there is room
// for. `picture` is that of exact/entry.wgsl.
// Uses exact/entry.wgsl raster/strict.wgsl

fn raise_subnormal() {
    atomicMax(&picture.most, 0xffffffffu);
}
