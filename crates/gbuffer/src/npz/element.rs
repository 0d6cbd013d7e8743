//! Elements of arrays: which of NumPy's types are taken without loss, and how.

/// Bytes of an element, and how to read it from them.
pub(super) type Decoder<T> = (usize, fn(&[u8]) -> T);

/// The type that elements have in memory.
pub(super) trait Element: Copy {
    /// Zero, to begin with.
    const ZERO: Self;
    /// The types that are read, for messages.
    const EXPECTED: &'static str;
    /// How to read an element of NumPy type `descr`; `None` where it might lose something.
    fn decoder(descr: &str) -> Option<Decoder<Self>>;
}

/// The first `N` bytes, of which the caller has that many.
pub(super) fn bytes<const N: usize>(bytes: &[u8]) -> [u8; N] {
    *bytes.first_chunk().expect("elements are cut to their own length")
}

impl Element for f64 {
    const ZERO: Self = 0.0;
    const EXPECTED: &'static str = "<f8, <f4";
    fn decoder(descr: &str) -> Option<Decoder<Self>> {
        match descr {
            "<f8" => Some((8, |b| f64::from_le_bytes(bytes(b)))),
            "<f4" => Some((4, |b| f64::from(f32::from_le_bytes(bytes(b))))),
            _ => None,
        }
    }
}

impl Element for i64 {
    const ZERO: Self = 0;
    const EXPECTED: &'static str = "|u1, |b1, |i1, <u2, <i2, <u4, <i4, <i8";
    fn decoder(descr: &str) -> Option<Decoder<Self>> {
        match descr {
            "|u1" | "|b1" => Some((1, |b| i64::from(b[0]))),
            "|i1" => Some((1, |b| i64::from(i8::from_le_bytes(bytes(b))))),
            "<u2" => Some((2, |b| i64::from(u16::from_le_bytes(bytes(b))))),
            "<i2" => Some((2, |b| i64::from(i16::from_le_bytes(bytes(b))))),
            "<u4" => Some((4, |b| i64::from(u32::from_le_bytes(bytes(b))))),
            "<i4" => Some((4, |b| i64::from(i32::from_le_bytes(bytes(b))))),
            "<i8" => Some((8, |b| i64::from_le_bytes(bytes(b)))),
            _ => None,
        }
    }
}
