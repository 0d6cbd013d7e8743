//! The commands of `isophote`; `cargo xtask` offers all of them, too.

use crate::{
    adapters, capsule, compare, completions, conform, continuity, convert, eval, info, man, pixel, render, scene,
    study, viewer,
};
use anyhow::Result;
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// NURBS surfaces, exact per pixel, three independent ways, and how far the three agree
#[derive(Debug, Parser)]
#[command(name = "isophote", version, arg_required_else_help = true, max_term_width = 100)]
pub struct Cli {
    /// What is to be done.
    #[command(subcommand)]
    pub command: Command,
}

/// A command and its arguments.
#[derive(Debug, Subcommand)]
#[expect(missing_docs, reason = "each tells its own story where its arguments are")]
pub enum Command {
    Compare(compare::CompareArgs),
    Conform(conform::ConformArgs),
    Continuity(continuity::ContinuityArgs),
    Render(render::RenderArgs),
    View(viewer::ViewerArgs),
    Capsule(capsule::CapsuleArgs),
    Pixel(pixel::PixelArgs),
    Eval(eval::EvalArgs),
    Info(info::InfoArgs),
    Scene(scene::SceneArgs),
    Convert(convert::ConvertArgs),
    Study(study::StudyArgs),
    Adapters(adapters::AdaptersArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

impl Command {
    /// Runs the command. The exit code is its answer: 0 for yes, 1 for no.
    ///
    /// # Errors
    /// Where it cannot answer.
    pub fn run(&self) -> Result<ExitCode> {
        let done = |result: Result<()>| result.map(|()| ExitCode::SUCCESS);
        match self {
            Self::Compare(args) => compare::run(args),
            Self::Conform(args) => conform::run(args),
            Self::Continuity(args) => continuity::run(args),
            Self::Render(args) => done(render::run(args)),
            Self::View(args) => done(viewer::run(args)),
            Self::Capsule(args) => done(capsule::run(args)),
            Self::Pixel(args) => pixel::run(args),
            Self::Eval(args) => done(eval::run(args)),
            Self::Info(args) => info::run(args),
            Self::Scene(args) => done(scene::run(args)),
            Self::Convert(args) => done(convert::run(args)),
            Self::Study(args) => done(study::run(args)),
            Self::Adapters(args) => done(adapters::run(args)),
            Self::Completions(args) => done(completions::run(args, &mut Cli::command())),
            Self::Man(args) => done(man::run(args, Cli::command())),
        }
    }
}
