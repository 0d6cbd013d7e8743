//! How a command answers.

/// For people or for machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Format {
    /// A table, with colours and pictures where standard output is a terminal.
    #[default]
    Table,
    /// One JSON object.
    Json,
}
