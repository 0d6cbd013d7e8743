//! Tests of the GPU path on Mesa's software adapter, and of the shaders' text without any.

mod exact;
mod layout;
mod models;
mod picture;
mod refusals;
mod twin;

use gpu::Device;

/// The software adapter, which keeps strict order and is the same on every machine.
fn software() -> Device {
    Device::open(Some("llvmpipe")).unwrap_or_else(|error| panic!("{error}; `{}` installs it", gpu::SOFTWARE_DRIVER))
}
