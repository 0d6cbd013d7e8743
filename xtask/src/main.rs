//! `cargo xtask`: parses and dispatches.

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use xtask::{adapters, bench, bless, ci, compare, conform, eval, geiger, info, kanai, mutants, pixel, render, scene};

/// Isophote: NURBS surfaces, exact per pixel, three independent ways, and how far the three agree
#[derive(Parser)]
#[command(name = "cargo xtask", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Compare(compare::CompareArgs),
    Conform(conform::ConformArgs),
    Render(render::RenderArgs),
    Scene(scene::SceneArgs),
    Eval(eval::EvalArgs),
    Pixel(pixel::PixelArgs),
    Info(info::InfoArgs),
    Kanai(kanai::KanaiArgs),
    Geiger(geiger::GeigerArgs),
    Mutants(mutants::MutantsArgs),
    Adapters(adapters::AdaptersArgs),
    Bench(bench::BenchArgs),
    Bless(bless::BlessArgs),
    Ci(ci::CiArgs),
}

fn main() -> ExitCode {
    let done = |result: anyhow::Result<()>| result.map(|()| ExitCode::SUCCESS);
    let result = match Cli::parse().command {
        Command::Compare(args) => compare::run(&args),
        Command::Conform(args) => conform::run(&args),
        Command::Render(args) => done(render::run(&args)),
        Command::Scene(args) => done(scene::run(&args)),
        Command::Eval(args) => done(eval::run(&args)),
        Command::Pixel(args) => pixel::run(&args),
        Command::Info(args) => done(info::run(&args)),
        Command::Kanai(args) => done(kanai::run(&args)),
        Command::Geiger(args) => done(geiger::run(&args)),
        Command::Mutants(args) => mutants::run(&args),
        Command::Adapters(args) => done(adapters::run(&args)),
        Command::Bench(args) => done(bench::run(&args)),
        Command::Bless(args) => done(bless::run(&args)),
        Command::Ci(args) => ci::run(&args),
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(2)
    })
}
