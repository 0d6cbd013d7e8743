//! Workers: child processes that try one mutant after the other, because a shader that never ends can only be stopped
//! with its process.
//!
//! A worker reads one [`Job`] a line and answers with words: each scene as it begins, then the outcome. Where it
//! computes for too long, it is killed and the mutant counts as a hang; where it ends by itself, as a crash. The next
//! mutant gets a new one.

use super::mutant::Mutant;
use super::scenes::{Shown, scenes};
use super::trial::{Catch, REFUSED, Shot, Trial};
use crate::compare::TechniqueName;
use anyhow::{Context, Result, bail};
use pipeline::Technique;
use pipeline::wgsl;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Processor time after which a scene is called a hang: a sound one takes ten seconds at most, to compile the kernels of
/// technique `exact` for any degree. What other programs take does not count.
const CPU_LIMIT: Duration = Duration::from_secs(30);

/// Time after which a scene is called a hang where the processor waits for a hardware GPU.
const WALL_LIMIT: Duration = Duration::from_secs(60);

/// How often a silent worker's processor time is looked at.
const LOOK: Duration = Duration::from_millis(250);

/// Ticks a second in which Linux counts processor time for its users.
const TICKS: u64 = 100;

/// What Mesa's software GPU is told: not to keep thousands of programs on disk, and, as each is drawn once, not to
/// spend time on making it fast (a quarter of the time, measured on llvmpipe 25.0).
const MESA: [(&str, &str); 2] = [("MESA_SHADER_CACHE_DISABLE", "true"), ("GALLIVM_PERF", "nopt")];

/// What a worker is asked.
#[derive(Debug, Serialize, Deserialize)]
pub struct Job {
    /// The change; none asks whether the sources as they are agree on every scene.
    pub mutant: Option<Mutant>,
    /// The technique by which the scenes are drawn.
    pub technique: TechniqueName,
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

/// Answers jobs from standard input until it ends.
///
/// # Errors
/// Where there is no adapter or a job cannot be read.
pub fn serve(adapter: Option<&str>) -> Result<()> {
    let device = gpu::Device::open(adapter)?;
    let shown: Vec<Shown> = Technique::ALL.into_iter().flat_map(scenes).collect();
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
    let source = |variant| job.mutant.as_ref().map_or_else(|| wgsl::source(variant), |mutant| mutant.source(variant));
    let technique = Technique::from(job.technique);
    let mut agreed = 0;
    let is_shown = |shown: &Shown| job.mutant.as_ref().is_none_or(|mutant| mutant.is_shown_by(&shown.model));
    let of_technique = |(shown, _): &(&Shown, _)| shown.plan.technique == technique && is_shown(shown);
    for (shown, trial) in shown.iter().zip(trials).filter(of_technique) {
        say(Word::Scene(shown.name.to_owned()))?;
        let trial = match trial {
            Some(trial) => trial,
            None => trial.insert(Trial::new(device, shown)?),
        };
        match trial.run(device, &source)? {
            Shot::Caught(catch) => return Ok(Outcome::Caught(catch)),
            Shot::Agrees => agreed += 1,
            Shot::Untouched => {}
        }
    }
    Ok(Outcome::Survived(agreed))
}

/// A running worker.
struct Running {
    child: Child,
    input: ChildStdin,
    words: Receiver<Word>,
}

/// The parent's side: starts workers as they are needed.
pub struct Worker {
    adapter: Option<String>,
    running: Option<Running>,
}

impl Worker {
    /// A worker, not started yet.
    pub fn new(adapter: Option<&str>) -> Self {
        Self { adapter: adapter.map(str::to_owned), running: None }
    }

    /// What becomes of a mutant, or of the sources as they are, drawn by a technique.
    ///
    /// # Errors
    /// Where a worker cannot be started or cannot judge.
    pub fn outcome(&mut self, mutant: Option<&Mutant>, technique: TechniqueName) -> Result<Outcome> {
        if self.running.is_none() {
            self.running = Some(Running::start(self.adapter.as_deref())?);
        }
        let running = self.running.as_mut().expect("just started");
        let asked = running.ask(&Job { mutant: mutant.cloned(), technique });
        let mut scene = "start".to_owned();
        let (cause, detail) = loop {
            let word = if asked.is_ok() { running.word() } else { Err(RecvTimeoutError::Disconnected) };
            match word {
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
        if mutant.is_none() {
            bail!("on {scene}, with the sources as they are: {cause}: {detail}");
        }
        Ok(Outcome::Caught(Catch { scene, cause: cause.to_owned(), detail: detail.to_owned() }))
    }
}

impl Running {
    fn start(adapter: Option<&str>) -> Result<Self> {
        let program = std::env::current_exe().context("this program's own file")?;
        let mut command = Command::new(program);
        command.args(["mutants", "--worker"]).envs(MESA).stdin(Stdio::piped()).stdout(Stdio::piped());
        if let Some(name) = adapter {
            command.args(["--adapter", name]);
        }
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
    /// What it says next, or that it ended, or that it has computed for too long.
    fn word(&self) -> Result<Word, RecvTimeoutError> {
        let (began, spent) = (Instant::now(), cpu_time(self.child.id()));
        loop {
            match self.words.recv_timeout(LOOK) {
                Err(RecvTimeoutError::Timeout) => {}
                other => return other,
            }
            let cpu = cpu_time(self.child.id()).zip(spent).map(|(now, then)| now.saturating_sub(then));
            if cpu.is_some_and(|cpu| cpu > CPU_LIMIT) || began.elapsed() > WALL_LIMIT {
                return Err(RecvTimeoutError::Timeout);
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
