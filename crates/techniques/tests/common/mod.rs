//! What the tests share: the software adapter, and numbers by chance.

#![allow(dead_code, reason = "each test file uses some of it")]

use gpu::Device;

/// The adapter that every machine has.
pub fn software() -> Device {
    Device::open(Some("llvmpipe")).expect("`apt-get install mesa-vulkan-drivers libvulkan1`")
}

/// Numbers in [0, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}
