//! `mutants`: changes the WGSL in one small place after the other and counts the changes that the comparison catches.

pub mod capped;
pub mod journal;
pub mod mutant;
pub mod operator;
pub mod record;
pub mod report;
pub mod scenes;
pub mod shown;
pub mod token;
pub mod trial;
pub mod way;
pub mod worker;

use crate::random::Random;
use anyhow::{Context, Result, bail};
use clap::Args;
use isophote::format::Format;
use isophote::output;
use isophote::stage::Path;
use isophote::{technique, terminal};
use journal::Journal;
use mutant::{Generated, Mutant, generate};
use report::{Report, Tried};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};
use techniques::Technique;
use way::Way;
use worker::{Setting, Worker};

/// Mutants tried at once: each worker's software GPU keeps two cores busy about half of the time.
const DEFAULT_JOBS: u16 = 2;

/// Change the WGSL in one place after the other, and see whether the comparison catches each change
///
/// Mutants are generated from the shaders' own text: operators, constants, comparisons, indices, variables, components,
/// statements. Each that compiles is drawn by the GPU on a list of scenes and judged by the ray caster, until one
/// scene catches it. Mutants that nothing can catch stand with their reasons in testdata/mutants/reviewed.json.
///
/// Exit code 0: all others were caught; 1: some survive, or the list is stale; 2: something could not run.
#[derive(Debug, Args)]
pub struct MutantsArgs {
    /// The technique whose parts are changed; those that both share are changed with `fragment`, and drawn by both
    #[arg(long, value_parser = technique::parser(), default_value = technique::default())]
    technique: &'static dyn Technique,
    /// Change the kernels' own parts, and draw by them; what they share with the fragment stage is changed without this
    #[arg(long, value_enum, default_value_t)]
    path: Path,
    /// Only mutants of this file, or of one line of it, as in eval.wgsl:27; may be given several times
    #[arg(long, value_name = "FILE[:LINE]")]
    at: Vec<String>,
    /// Draw only the scene of this name; may be given several times
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// Try this many, drawn by chance from those that are not on the reviewed list, in the order drawn
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// What the chance starts from
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// List the mutants and try none
    #[arg(long)]
    list: bool,
    /// Mutants tried at once, each in a process of its own
    #[arg(long, value_name = "N", default_value_t = DEFAULT_JOBS, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: u16,
    /// Begin none after this many seconds; those left are untried
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
    /// Write a line to this file as soon as a mutant's outcome is known, and try none that stands there
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
    /// Part of the GPU adapter's name [default: a hardware one, else a software one]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Write mutants.json, with what became of each, to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Answer jobs on standard input: how the command runs itself
    #[arg(long, hide = true)]
    worker: bool,
}

impl MutantsArgs {
    /// Who draws the mutants.
    fn way(&self) -> Result<Way> {
        let way = Way { technique: self.technique, path: self.path };
        if !Way::all().any(|known| known == way) {
            bail!("kernels are the same for all techniques: leave --technique out where --path is given")
        }
        Ok(way)
    }
}

/// Runs the command.
///
/// # Errors
/// Where there is no adapter, the sources as they are do not agree, or a file cannot be read or written.
pub fn run(args: &MutantsArgs) -> Result<ExitCode> {
    if args.worker {
        worker::serve(args.adapter.as_deref(), &args.scene)?;
        return Ok(ExitCode::SUCCESS);
    }
    let reviewed = record::reviewed()?;
    let way = args.way()?;
    let is_wanted = |file: &str| args.at.is_empty() || args.at.iter().any(|place| halves(place).0 == file);
    let Generated { mutants, stillborn } = generate(way, &is_wanted);
    let unknown = report::unknown(&reviewed, &mutants, way, &is_wanted);
    let mut chosen = if args.at.is_empty() { mutants.clone() } else { at_places(&mutants, &args.at, way)? };
    if let Some(count) = args.sample {
        let is_reviewed = |m: &Mutant| reviewed.iter().any(|group| group.mutants.contains(&m.key));
        chosen.retain(|m| !is_reviewed(m));
        chosen = sample(chosen, count, args.seed);
    }
    if args.list {
        report::list(&chosen, args.format)?;
        return Ok(ExitCode::SUCCESS);
    }
    let began = Instant::now();
    let (count, tried) = (chosen.len(), tried(chosen, args, way)?);
    let untried = count - tried.len();
    let report = Report::new([mutants.len(), stillborn.len(), untried], tried, &reviewed, unknown, began.elapsed());
    if let Some(folder) = &args.out {
        output::folder(folder)?;
        output::write_json(&folder.join("mutants.json"), &report)?;
    }
    match args.format {
        Format::Json => terminal::json(&report)?,
        Format::Table => report.print()?,
    }
    Ok(ExitCode::from(if report.is_proof() { 0 } else { 1 }))
}

/// What becomes of each that there is time for.
fn tried(mutants: Vec<Mutant>, args: &MutantsArgs, way: Way) -> Result<Vec<Tried>> {
    let journal = args.journal.as_deref().map(Journal::open).transpose()?.unwrap_or_default();
    let known = |mutant: &Mutant| Some(Tried { outcome: journal.known(&mutant.key)?.clone(), mutant: mutant.clone() });
    let mut all: Vec<Tried> = mutants.iter().filter_map(known).collect();
    let left: Vec<&Mutant> = mutants.iter().filter(|mutant| journal.known(&mutant.key).is_none()).collect();
    if left.is_empty() {
        return Ok(all);
    }
    let end = args.seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = (cores / usize::from(args.jobs)).max(1);
    let setting = Setting { adapter: args.adapter.clone(), scenes: args.scene.clone(), jobs: args.jobs, threads };
    let first = Worker::of_sound_sources(setting, way)?;
    let others: Vec<Worker> = (1..args.jobs).map(|_| first.another()).collect();
    let bar = terminal::progress("mutants", left.len());
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<Result<Tried>>> = Mutex::new(vec![]);
    let tried = |worker: &mut Worker, mutant: &Mutant| {
        let place = || format!("{}:{}", mutant.key.file, mutant.line);
        let tried = Tried { mutant: mutant.clone(), outcome: worker.outcome(mutant).with_context(place)? };
        journal.add(&tried)?;
        Ok(tried)
    };
    let is_over = || end.is_some_and(|end| Instant::now() >= end);
    let work = |mut worker: Worker| {
        while let Some(mutant) = left.get(next.fetch_add(1, Relaxed)).filter(|_| !is_over()) {
            let tried = tried(&mut worker, mutant);
            if tried.is_err() {
                next.store(left.len(), Relaxed);
            }
            found.lock().expect("no holder panics").push(tried);
            bar.inc(1);
        }
    };
    std::thread::scope(|scope| {
        for worker in others {
            scope.spawn(|| work(worker));
        }
        work(first);
    });
    for tried in found.into_inner().expect("no holder panicked") {
        all.push(tried?);
    }
    Ok(all)
}

/// FILE or FILE:LINE, in two.
fn halves(place: &str) -> (&str, Option<&str>) {
    place.split_once(':').map_or((place, None), |(file, line)| (file, Some(line)))
}

/// Those at any FILE or FILE:LINE.
fn at_places(mutants: &[Mutant], places: &[String], way: Way) -> Result<Vec<Mutant>> {
    let mut chosen = vec![];
    for place in places {
        let (file, line) = halves(place);
        let number = |line: &str| line.parse::<usize>().with_context(|| format!("--at {place:?}: {line:?} is no line"));
        let line = line.map(number).transpose()?;
        let is_there = |m: &&Mutant| m.key.file == file && line.is_none_or(|line| line == m.line);
        let before = chosen.len();
        chosen.extend(mutants.iter().filter(is_there).cloned());
        if chosen.len() == before {
            let files: Vec<&str> = mutant::files(way).collect();
            bail!("--at {place:?}: no mutant is there; the files of this technique are {}", files.join(", "));
        }
    }
    Ok(chosen)
}

/// `count` of them by chance.
fn sample(mutants: Vec<Mutant>, count: usize, seed: u64) -> Vec<Mutant> {
    let mut random = Random::new(seed);
    let mut drawn: Vec<(u64, usize)> = (0..mutants.len()).map(|index| (random.bits(), index)).collect();
    drawn.sort_unstable();
    drawn.truncate(count);
    drawn.into_iter().map(|(_, index)| mutants[index].clone()).collect()
}
