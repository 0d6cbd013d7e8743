//! The crate through its public interface: bad input, the format's extensions, and round trips of real models.

mod bad_input;
mod common;
mod extensions;
mod obj;
mod rhino;
mod round_trip;
