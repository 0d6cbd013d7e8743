//! Workers: child processes that try one mutant after the other, because a shader that never ends can only be stopped
//! with its process.
//!
//! A worker reads one [`Job`] a line and answers with [`Word`]s: each scene as it begins, then the outcome. Where it
//! is silent for too long, it is killed and the mutant counts as a hang; where it ends by itself, as a crash. The next
//! mutant gets a new one.

use super::mutant::Mutant;
use super::scenes::{Shown, scenes};
use super::trial::{Catch, REFUSED, Shot, Trial};
use anyhow::{Context, Result, bail};
use pipeline::Technique;
use pipeline::wgsl;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// What a worker is asked.
#[derive(Debug, Serialize, Deserialize)]
pub struct Job {
    /// The change; none asks whether the sources as they are agree on every scene.
    pub mutant: Option<Mutant>,
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
    let shown: Vec<Shown> = techniques();
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

/// Every scene by every technique.
fn techniques() -> Vec<Shown> {
    let of = |technique| {
        scenes().into_iter().map(move |mut shown| {
            shown.plan.technique = technique;
            shown
        })
    };
    Technique::ALL.into_iter().flat_map(of).collect()
}

fn answer<'s>(
    device: &gpu::Device,
    shown: &'s [Shown],
    trials: &mut [Option<Trial<'s>>],
    job: &Job,
    say: &dyn Fn(Word) -> Result<()>,
) -> Result<Outcome> {
    let source = |variant| job.mutant.as_ref().map_or_else(|| wgsl::source(variant), |mutant| mutant.source(variant));
    let mut agreed = 0;
    for (shown, trial) in shown.iter().zip(trials) {
        say(Word::Scene(shown.name.to_owned()))?;
        let trial = match trial {
            Some(trial) => trial,
            None => trial.insert(Trial::new(shown)?),
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

    /// What becomes of a mutant, or of the sources as they are; `None` means no limit on the time that a scene takes.
    ///
    /// # Errors
    /// Where a worker cannot be started or cannot judge.
    pub fn outcome(&mut self, mutant: Option<&Mutant>, limit: Option<Duration>) -> Result<(Outcome, Duration)> {
        if self.running.is_none() {
            self.running = Some(Running::start(self.adapter.as_deref())?);
        }
        let running = self.running.as_mut().expect("just started");
        let mut slowest = Duration::ZERO;
        let asked = running.ask(&Job { mutant: mutant.cloned() });
        let mut scene = "start".to_owned();
        let outcome = loop {
            let began = std::time::Instant::now();
            let word = match (&asked, limit) {
                (Err(_), _) => Err(RecvTimeoutError::Disconnected),
                (Ok(()), Some(limit)) => running.words.recv_timeout(limit),
                (Ok(()), None) => running.words.recv().map_err(RecvTimeoutError::from),
            };
            slowest = slowest.max(began.elapsed());
            let caught = |cause: &str, detail: &str| {
                Outcome::Caught(Catch { scene: scene.clone(), cause: cause.to_owned(), detail: detail.to_owned() })
            };
            match word {
                Ok(Word::Scene(name)) => scene = name,
                Ok(Word::Done(outcome)) => {
                    if matches!(&outcome, Outcome::Caught(catch) if catch.cause == REFUSED) {
                        self.stop();
                    }
                    break outcome;
                }
                Ok(Word::Failed(message)) => bail!("on {scene}: {message}"),
                Err(error) => {
                    self.stop();
                    if mutant.is_none() {
                        bail!("a worker ended on {scene} with the sources as they are");
                    }
                    break match error {
                        RecvTimeoutError::Timeout => caught("hang", "killed after the time limit"),
                        RecvTimeoutError::Disconnected => caught("crash", "the process ended"),
                    };
                }
            }
        };
        Ok((outcome, slowest))
    }

    fn stop(&mut self) {
        self.running = None;
    }
}

impl Running {
    fn start(adapter: Option<&str>) -> Result<Self> {
        let program = std::env::current_exe().context("this program's own file")?;
        let mut command = Command::new(program);
        command.args(["mutants", "--worker"]).stdin(Stdio::piped()).stdout(Stdio::piped());
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

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself; then there is nothing to kill.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
