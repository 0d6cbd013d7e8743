//! `conform`: a portable corpus on each adapter, and one report of it for people, for CI systems and for a browser.

pub mod answer;
pub mod check;
pub mod compilers;
pub mod dawn;
pub mod foreign;
pub mod html;
pub mod junit;
pub mod merge;
pub mod own;
pub mod page;
pub mod table;

pub use suite::{bits, corpus, report, run, shard, wrong};

use crate::terminal;
use answer::{OutputArgs, claim, finish};
use anyhow::Result;
use clap::{Args, Subcommand, ValueEnum};
use corpus::Suite;
use dawn::Dawn;
use own::OwnArgs;
use run::{Adapter, Gpu, Plans, absent};
use shard::Shard;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use suite::stage;

/// Run the conformance suite on a GPU, and write a report
///
/// Renders each scene of a portable corpus by the ray caster, the CPU rasterizer and the GPU, compares all pairs, and
/// writes report.html, report.json and junit.xml. A run that is cut short leaves what it measured.
///
/// With --models it runs model files instead. One that cannot be read is a case with its error, and the others go on.
///
/// Exit code 0: all agree; 1: something differs; 2: something could not run, could not be read or is missing.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  isophote conform                                17 s on two cores
  isophote conform --suite standard --shard 1/3   a third, on one of three machines
  isophote conform merge conform-* --out conform  join them
  isophote conform --path strict                  the CPU's bits on a GPU
  isophote conform --models parts                 your own files, each a scene
  isophote conform export scenes                  for a renderer of your own,
  isophote conform judge scenes                   and its verdict
  isophote conform page gpu.html                  for a visitor's GPU, in a browser"
)]
pub struct ConformArgs {
    #[command(subcommand)]
    command: Option<ConformCommand>,
    #[command(flatten)]
    run: RunArgs,
}

#[derive(Debug, Subcommand)]
enum ConformCommand {
    Merge(merge::MergeArgs),
    Export(foreign::ExportArgs),
    Judge(foreign::JudgeArgs),
    Page(page::PageArgs),
}

/// What is run.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Part of the adapter's name, or `all` [default: the best one]
    ///
    /// `all` takes each adapter of this machine, those of one name and driver once.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// What compiles and draws: wgpu (by naga), dawn (by Tint), or both, compared with each other
    #[arg(long, value_enum, value_delimiter = ',', default_value = "wgpu")]
    hosts: Vec<HostName>,
    /// With --hosts dawn: the folder of the Node program, `hosts/node` of the sources
    #[arg(long, hide_short_help = true, value_name = "DIR", default_value = "hosts/node")]
    dawn: PathBuf,
    /// How much of the corpus
    #[arg(long, value_enum, default_value = "smoke")]
    suite: Suite,
    /// How the GPU draws: by its rasterizer, or by strict programs, which must have the CPU rasterizer's bits
    ///
    /// Strict programs take minutes to compile. docs/strict.md says what they cover.
    #[arg(long, value_enum, default_value_t)]
    path: DrawnBy,
    /// Run part K of N only; `conform merge` joins the parts
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    shard: Shard,
    #[command(flatten)]
    models: OwnArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// How the GPU draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum DrawnBy {
    /// By its own rasterizer
    #[default]
    Fragment,
    /// By kernels with the CPU rasterizer's bits
    Strict,
}

/// What plays a picture's commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum HostName {
    /// In this process, by naga
    Wgpu,
    /// By the Node program in --dawn, by Tint
    Dawn,
}

/// Runs the command.
///
/// # Errors
/// Where the folder cannot be written. An adapter that is not there is no error here: the report says so.
pub fn run(args: &ConformArgs) -> Result<ExitCode> {
    match &args.command {
        None => {}
        Some(ConformCommand::Merge(args)) => return merge::run(args),
        Some(ConformCommand::Export(args)) => return foreign::export(args),
        Some(ConformCommand::Judge(args)) => return foreign::judge(args),
        Some(ConformCommand::Page(args)) => return page::run(args).map(|()| ExitCode::SUCCESS),
    }
    let RunArgs { adapter, hosts, dawn, suite, path, shard, models, output } = &args.run;
    let path = match path {
        DrawnBy::Fragment => stage::Path::Fragment,
        DrawnBy::Strict => stage::Path::Strict,
    };
    let plans = Plans { suite: *suite, scenes: models.scenes(*suite), shard: *shard, path };
    let (mut adapters, mut absent): (Vec<Box<dyn Adapter>>, Vec<report::Subject>) = (vec![], vec![]);
    let once = hosts.iter().enumerate().filter(|(place, host)| !hosts[..*place].contains(host));
    for (_, host) in once {
        let (opened, missing) = match host {
            HostName::Wgpu => open(adapter.as_deref()),
            HostName::Dawn => open_dawn(dawn, adapter.as_deref()),
        };
        adapters.extend(opened);
        absent.extend(missing);
    }
    let subjects = adapters.iter().map(|adapter| adapter.subject()).chain(absent).collect();
    let mut report = plans.report(subjects);
    let folder = &output.out;
    let _lock = claim(folder, *suite, *shard)?;
    plans.run(&mut adapters, &mut report, on_interrupt(), &mut |report| report.write(folder))?;
    finish(&report, output)
}

/// The adapters asked for, and the ones that could not be opened.
fn open(name: Option<&str>) -> (Vec<Box<dyn Adapter>>, Vec<report::Subject>) {
    let all = name == Some("all");
    let wanted: Vec<Option<String>> = match name {
        Some(_) if all => gpu::adapters().into_iter().map(|info| Some(info.name)).collect(),
        name => vec![name.map(str::to_owned)],
    };
    let (all, wanted) = if wanted.is_empty() { (false, vec![None]) } else { (all, wanted) };
    let (mut opened, mut missing): (Vec<Box<dyn Adapter>>, Vec<report::Subject>) = (vec![], vec![]);
    for name in wanted {
        let label = name.as_deref().unwrap_or("any GPU");
        match Gpu::open(name.as_deref()) {
            // With `all` the name is whole, yet `open` takes the first that contains it.
            Ok(gpu) if all && gpu.subject().name != label => {
                let why = format!("its name is part of {:?}, which is opened instead", gpu.subject().name);
                missing.push(absent(label, why));
            }
            Ok(gpu) if opened.iter().all(|other| other.subject().id != gpu.subject().id) => opened.push(Box::new(gpu)),
            // Two adapters of one name, driver and host: what holds for one holds for the other.
            Ok(_) => {}
            Err(error) => missing.push(absent(label, error.to_string())),
        }
    }
    (opened, missing)
}

/// Dawn on the adapter asked for, or why it is not there.
fn open_dawn(folder: &Path, name: Option<&str>) -> (Vec<Box<dyn Adapter>>, Vec<report::Subject>) {
    match Dawn::open(folder, name.filter(|name| *name != "all")) {
        Ok(dawn) => (vec![Box::new(dawn)], vec![]),
        Err(error) => (vec![], vec![absent("Dawn", format!("{error:#}"))]),
    }
}

/// Set once a person interrupts: the run ends after the case at hand and is reported as far as it went. A second
/// interrupt ends the program.
fn on_interrupt() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    let handled = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(2);
        }
        terminal::note(format_args!("stopping after this case; interrupt again to end at once"));
    });
    if let Err(error) = handled {
        terminal::note(format_args!("an interrupt will end the run at once: {error}"));
    }
    &STOP
}
