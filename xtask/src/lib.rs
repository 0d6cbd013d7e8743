//! What the developers of Isophote need beside its own commands: one file a command.

pub mod bench;
pub mod bless;
pub mod ci;
pub mod figures;
pub mod geiger;
pub mod kanai;
pub mod legal;
pub mod mutants;
pub mod random;
pub mod strict;
pub mod variants;
