//! Pictures that are the same to the bit on every processor, and how that is asked.
//!
//! [`golden`] says which scenes are drawn and draws them; [`hashes`] makes a line of each G-buffer and finds those that differ
//! from blessed ones. The program beside this library prints these lines, or judges itself by them. It needs neither files nor
//! a GPU, so it runs wherever Rust builds: `tests/processors/run` tries aarch64 and WebAssembly.

pub mod golden;
pub mod hashes;
