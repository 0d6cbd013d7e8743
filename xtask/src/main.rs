//! `cargo xtask`: parses and dispatches.

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use xtask::terminal::{self, OutputError};
use xtask::{
    adapters, bench, bless, ci, compare, conform, continuity, convert, eval, geiger, info, kanai, mutants, pixel,
    render, scene, study,
};

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
    Continuity(continuity::ContinuityArgs),
    Convert(convert::ConvertArgs),
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
    Study(study::StudyArgs),
    Bless(bless::BlessArgs),
    Ci(ci::CiArgs),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // Help goes to standard output, and a full device is none that it reached.
        Err(stopped) => match stopped.print() {
            Ok(()) => return ExitCode::from(stopped.exit_code() as u8),
            Err(_) => return ExitCode::from(2),
        },
    };
    let done = |result: anyhow::Result<()>| result.map(|()| ExitCode::SUCCESS);
    let result = match cli.command {
        Command::Compare(args) => compare::run(&args),
        Command::Conform(args) => conform::run(&args),
        Command::Continuity(args) => continuity::run(&args),
        Command::Convert(args) => done(convert::run(&args)),
        Command::Render(args) => done(render::run(&args)),
        Command::Scene(args) => done(scene::run(&args)),
        Command::Eval(args) => done(eval::run(&args)),
        Command::Pixel(args) => pixel::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Kanai(args) => done(kanai::run(&args)),
        Command::Geiger(args) => done(geiger::run(&args)),
        Command::Mutants(args) => mutants::run(&args),
        Command::Adapters(args) => done(adapters::run(&args)),
        Command::Bench(args) => bench::run(&args),
        Command::Study(args) => done(study::run(&args)),
        Command::Bless(args) => done(bless::run(&args)),
        Command::Ci(args) => ci::run(&args),
    };
    result.unwrap_or_else(|error| {
        // Nobody reads on, as below `| head`: no words, and yet no success, since the answer did not arrive.
        let closed = error.downcast_ref::<OutputError>().is_some_and(OutputError::is_closed);
        if !closed {
            terminal::note(format_args!("error: {error:#}"));
        }
        ExitCode::from(2)
    })
}
