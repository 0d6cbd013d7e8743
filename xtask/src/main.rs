//! `cargo xtask`: all that `isophote` does, and what its developers need.

use clap::{Parser, Subcommand};
use isophote::{commands, entry};
use std::process::ExitCode;
use xtask::{bench, bless, ci, figures, geiger, kanai, legal, mutants, strict, variants};

/// Isophote and what its developers need
#[derive(Parser)]
#[command(name = "cargo xtask", version, arg_required_else_help = true, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    #[command(flatten)]
    Isophote(Box<commands::Command>),
    Kanai(kanai::KanaiArgs),
    Geiger(geiger::GeigerArgs),
    Mutants(mutants::MutantsArgs),
    Legal(legal::LegalArgs),
    Variants(variants::VariantsArgs),
    Strict(strict::StrictArgs),
    Bench(bench::BenchArgs),
    Bless(bless::BlessArgs),
    Figures(figures::FiguresArgs),
    Ci(ci::CiArgs),
}

fn main() -> ExitCode {
    let done = |result: anyhow::Result<()>| result.map(|()| ExitCode::SUCCESS);
    entry::main(|cli: Cli| match cli.command {
        Command::Isophote(command) => command.run(),
        Command::Kanai(args) => done(kanai::run(&args)),
        Command::Geiger(args) => done(geiger::run(&args)),
        Command::Mutants(args) => mutants::run(&args),
        Command::Legal(args) => legal::run(&args),
        Command::Variants(args) => variants::run(&args),
        Command::Strict(args) => strict::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Bless(args) => done(bless::run(&args)),
        Command::Figures(args) => done(figures::run(&args)),
        Command::Ci(args) => ci::run(&args),
    })
}
