// How a strict program says that it met a subnormal number where it computes none. `queue` is that of raster/entry.wgsl.

fn raise_subnormal() {
    atomicStore(&queue[0], 1u);
}
