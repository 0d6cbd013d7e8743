//! Workers: child processes that try one mutant after the other, because a shader that never ends can only be stopped
//! with its process.
//!
//! A worker reads one [`Job`] a line and answers with words: each scene as it begins, then the outcome. Where it
//! computes for too long, it is killed and the mutant counts as a hang; where it ends by itself, as a crash. The next
//! mutant gets a new one.

use super::capped::capped;
use super::mutant::Mutant;
use super::scenes::scenes;
use super::shown::Shown;
use super::trial::{Catch, REFUSED, Shot, Trial};
use super::way::Way;
use anyhow::{Context, Result, bail};
use pipeline::wgsl::{self, Variant};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How long a scene may keep a worker busy.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Processor time after which it is called a hang. What other programs take does not count.
    cpu: Duration,
    /// Time after which it is called a hang where the processor waits for a hardware GPU.
    wall: Duration,
}

impl Limits {
    /// Of the sources as they are, which take what this driver needs to compile them.
    const SOUND: Self = Self { cpu: Duration::from_secs(3600), wall: Duration::from_secs(600) };

    /// The least that a mutant has: llvmpipe takes ten seconds for the kernels of technique `exact` for any degree.
    const LEAST: Self = Self { cpu: Duration::from_secs(30), wall: Duration::from_secs(60) };

    /// How often the time of the sources as they are a mutant has: others are at work beside it.
    const TIMES: u32 = 4;

    /// Of a mutant, where the sources as they are took this long for their slowest scene, and so many workers share the GPU
    /// where one had it then. One that waits for a GPU may compute as it waits, so that processor time counts as often.
    fn after(slowest: Self, jobs: u32) -> Self {
        let Self { cpu, wall } = Self::LEAST;
        let longest = |least: Duration, taken: Duration| jobs * least.max(Self::TIMES * taken);
        Self { cpu: longest(cpu, slowest.cpu), wall: longest(wall, slowest.wall) }
    }
}

/// How often a silent worker's processor time is looked at.
const LOOK: Duration = Duration::from_millis(250);

/// Ticks a second in which Linux counts processor time for its users.
const TICKS: u64 = 100;

/// What Mesa's software GPU is told: not to keep thousands of programs on disk, and, as each is drawn once, not to
/// spend time on making it fast (a quarter of the time, measured on llvmpipe 25.0).
const MESA: [(&str, &str); 2] = [("MESA_SHADER_CACHE_DISABLE", "true"), ("GALLIVM_PERF", "nopt")];

/// What asks a program in numbers: of a picture that is wrong little may be seen.
type Asks = fn(&gpu::Device, &dyn Fn(Variant) -> String) -> Result<Option<String>, gpu::GpuError>;

/// The parts that are asked so, what they are named by, and what asks.
const ASKED: [(&str, &str, Asks); 3] = [
    ("raster/strict.wgsl", "arithmetic", techniques::wrong_arithmetic),
    ("grid/levels.wgsl", "levels", techniques::grid::wrong_levels),
    ("grid/tiles.wgsl", "tiles", techniques::grid::wrong_levels),
];

/// How worker processes are started.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Part of the GPU adapter's name.
    pub adapter: Option<String>,
    /// Only scenes of these names, where there are any.
    pub scenes: Vec<String>,
    /// How many work at once.
    pub jobs: u16,
    /// Threads that each computes with.
    pub threads: usize,
}

/// What a worker is asked.
#[derive(Debug, Serialize, Deserialize)]
pub enum Job {
    /// Whether a mutant is caught.
    Mutant(Mutant),
    /// Whether the sources as they are agree on every scene that mutants of this way's parts are shown on.
    Sound(String),
}

/// What a worker says.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Word {
    /// It begins with a scene.
    Scene(String),
    /// It is done.
    Done(Outcome),
    /// It cannot go on.
    Failed(String),
}

/// What became of a mutant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Some scene gave it away.
    Caught(Catch),
    /// It agreed on this many scenes, all whose programs hold it.
    Survived(usize),
}

/// Answers jobs from standard input until it ends, on the scenes of these names, or on all where there are none.
///
/// # Errors
/// Where there is no adapter or a job cannot be read.
pub fn serve(adapter: Option<&str>, names: &[String]) -> Result<()> {
    let device = gpu::Device::open(adapter)?;
    let is_chosen = |shown: &Shown| names.is_empty() || names.iter().any(|name| name == shown.name);
    let shown: Vec<Shown> = Way::all().flat_map(scenes).filter(is_chosen).collect();
    let mut trials: Vec<Option<Trial>> = shown.iter().map(|_| None).collect();
    let say = |word: Word| -> Result<()> {
        let mut out = std::io::stdout().lock();
        serde_json::to_writer(&mut out, &word)?;
        out.write_all(b"\n")?;
        Ok(out.flush()?)
    };
    for line in std::io::stdin().lock().lines() {
        let job: Job = serde_json::from_str(&line?)?;
        match answer(&device, &shown, &mut trials, &job, &say) {
            Ok(outcome) => {
                let refused = matches!(&outcome, Outcome::Caught(catch) if catch.cause == REFUSED);
                say(Word::Done(outcome))?;
                // A device that has refused once may be lost.
                if refused {
                    return Ok(());
                }
            }
            Err(error) => say(Word::Failed(format!("{error:#}")))?,
        }
    }
    Ok(())
}

fn answer<'s>(
    device: &gpu::Device,
    shown: &'s [Shown],
    trials: &mut [Option<Trial<'s>>],
    job: &Job,
    say: &dyn Fn(Word) -> Result<()>,
) -> Result<Outcome> {
    let source = |variant| match job {
        Job::Mutant(mutant) => mutant.source(variant),
        Job::Sound(_) => wgsl::source(variant),
    };
    for (_, cause, asks) in ASKED.iter().filter(|(file, ..)| is_of(job, file)) {
        if let Some(catch) = shown_by_numbers(device, cause, *asks, &source) {
            return Ok(Outcome::Caught(catch));
        }
    }
    let mut agreed = 0;
    let is_shown = |(shown, _): &(&Shown, _)| match job {
        Job::Mutant(mutant) => mutant.is_shown_by(shown),
        Job::Sound(label) => Way::all().any(|way| way.label() == *label && shown.is_of(way)),
    };
    for (shown, trial) in shown.iter().zip(trials).filter(is_shown) {
        say(Word::Scene(shown.name.to_owned()))?;
        let trial = match trial {
            Some(trial) => trial,
            None => trial.insert(Trial::new(device, shown)?),
        };
        match trial.run(device, &source)? {
            Shot::Caught(catch) => return Ok(Outcome::Caught(catch)),
            Shot::Agrees => agreed += 1,
            Shot::Untouched if matches!(job, Job::Sound(_)) => agreed += 1,
            Shot::Untouched => {}
        }
    }
    Ok(Outcome::Survived(agreed))
}

/// Whether a job is about a part: a mutant of it, or the sources of a way that has it, as they are.
fn is_of(job: &Job, file: &str) -> bool {
    match job {
        Job::Mutant(mutant) => mutant.key.file == file,
        Job::Sound(label) => {
            Way::all().any(|way| way.label() == *label && way.parts().iter().any(|part| part.file == file))
        }
    }
}

/// Where a program does not come to Rust's numbers.
fn shown_by_numbers(
    device: &gpu::Device,
    cause: &str,
    asks: Asks,
    source: &dyn Fn(Variant) -> String,
) -> Option<Catch> {
    let (cause, detail) = match asks(device, &|variant| capped(&source(variant))) {
        Ok(None) => return None,
        Ok(Some(detail)) => (cause, detail),
        Err(error) => (REFUSED, error.to_string()),
    };
    Some(Catch { scene: "numbers".to_owned(), cause: cause.to_owned(), detail })
}

/// A running worker.
struct Running {
    child: Child,
    input: ChildStdin,
    words: Receiver<Word>,
}

/// The parent's side: starts workers as they are needed.
pub struct Worker {
    setting: Setting,
    limits: Limits,
    running: Option<Running>,
}

impl Worker {
    /// A worker that has drawn the sources as they are on every scene of a way's mutants, and found that they agree.
    /// Its time is the measure of the mutants'.
    ///
    /// # Errors
    /// Where it cannot be started or cannot judge, or the sources do not agree.
    pub fn of_sound_sources(setting: Setting, way: Way) -> Result<Self> {
        let mut worker = Self { setting, limits: Limits::SOUND, running: None };
        let mut slowest = Limits { cpu: Duration::ZERO, wall: Duration::ZERO };
        match worker.drawn(&Job::Sound(way.label()), &mut slowest)? {
            Outcome::Caught(Catch { scene, cause, detail }) => {
                bail!("the sources as they are do not agree on {scene}: {cause}: {detail}")
            }
            Outcome::Survived(0) => bail!("no scene of {} is called so", way.label()),
            Outcome::Survived(_) => {}
        }
        worker.limits = Limits::after(slowest, worker.setting.jobs.into());
        Ok(worker)
    }

    /// One more like this, not started yet.
    pub fn another(&self) -> Self {
        Self { setting: self.setting.clone(), limits: self.limits, running: None }
    }

    /// What becomes of a mutant. A process that cannot judge it may have lost its device to an earlier one: another is asked
    /// before that is an error.
    ///
    /// # Errors
    /// Where a worker cannot be started or cannot judge.
    pub fn outcome(&mut self, mutant: &Mutant) -> Result<Outcome> {
        let job = Job::Mutant(mutant.clone());
        let untimed = || Limits { cpu: Duration::ZERO, wall: Duration::ZERO };
        self.drawn(&job, &mut untimed()).or_else(|_| {
            self.running = None;
            self.drawn(&job, &mut untimed())
        })
    }

    fn drawn(&mut self, job: &Job, slowest: &mut Limits) -> Result<Outcome> {
        if self.running.is_none() {
            self.running = Some(Running::start(&self.setting)?);
        }
        let running = self.running.as_mut().expect("just started");
        let asked = running.ask(job);
        let mut scene = "start".to_owned();
        let (cause, detail) = loop {
            let disconnected = Err(RecvTimeoutError::Disconnected);
            match if asked.is_ok() { running.word(self.limits, slowest) } else { disconnected } {
                Ok(Word::Scene(name)) => scene = name,
                Ok(Word::Done(outcome)) => {
                    if matches!(&outcome, Outcome::Caught(catch) if catch.cause == REFUSED) {
                        self.running = None;
                    }
                    return Ok(outcome);
                }
                Ok(Word::Failed(message)) => bail!("on {scene}: {message}"),
                Err(RecvTimeoutError::Timeout) => break ("hang", "killed after the time limit"),
                Err(RecvTimeoutError::Disconnected) => break ("crash", "the process ended"),
            }
        };
        self.running = None;
        if matches!(job, Job::Sound(_)) {
            bail!("on {scene}, with the sources as they are: {cause}: {detail}");
        }
        Ok(Outcome::Caught(Catch { scene, cause: cause.to_owned(), detail: detail.to_owned() }))
    }
}

impl Running {
    fn start(Setting { adapter, scenes, threads, .. }: &Setting) -> Result<Self> {
        let program = std::env::current_exe().context("this program's own file")?;
        let mut command = Command::new(program);
        command.args(["mutants", "--worker"]).envs(MESA).env("RAYON_NUM_THREADS", threads.to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let named = |flag: &'static str, name| [flag.to_owned(), String::clone(name)];
        command.args(adapter.iter().flat_map(|name| named("--adapter", name)));
        command.args(scenes.iter().flat_map(|name| named("--scene", name)));
        let mut child = command.spawn().context("a worker cannot be started")?;
        let input = child.stdin.take().expect("piped");
        let output = child.stdout.take().expect("piped");
        let (sender, words) = channel();
        std::thread::spawn(move || {
            let said = BufReader::new(output).lines().map_while(Result::ok);
            for word in said.map_while(|line| serde_json::from_str(&line).ok()) {
                if sender.send(word).is_err() {
                    break;
                }
            }
        });
        Ok(Self { child, input, words })
    }

    fn ask(&mut self, job: &Job) -> Result<()> {
        let line = serde_json::to_string(job)? + "\n";
        self.input.write_all(line.as_bytes())?;
        Ok(self.input.flush()?)
    }
}

impl Running {
    /// What it says next, or that it ended, or that it has computed for too long; `slowest` grows to the time that it took.
    fn word(&self, limits: Limits, slowest: &mut Limits) -> Result<Word, RecvTimeoutError> {
        let (began, spent) = (Instant::now(), cpu_time(self.child.id()));
        loop {
            let word = self.words.recv_timeout(LOOK);
            let cpu =
                cpu_time(self.child.id()).zip(spent).map_or(Duration::ZERO, |(now, then)| now.saturating_sub(then));
            slowest.cpu = slowest.cpu.max(cpu);
            slowest.wall = slowest.wall.max(began.elapsed());
            match word {
                Err(RecvTimeoutError::Timeout) if cpu <= limits.cpu && began.elapsed() <= limits.wall => {}
                other => return other,
            }
        }
    }
}

/// The processor time of a process of this machine, where the system tells it as Linux does (proc(5), fields 14 and 15).
fn cpu_time(process: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let ticks: u64 = fields.next()?.parse::<u64>().ok()? + fields.next()?.parse::<u64>().ok()?;
    Some(Duration::from_millis(ticks * 1000 / TICKS))
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself; then there is nothing to kill.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
