//! Mutated files for each reader, for as long as is asked: `cargo run -p fuzz -- TARGET SECONDS [SEED]`.
//!
//! A target is `json`, `bpt`, `step`, `iges`, `3dm`, `obj`, `npz` or `shard`. Inputs begin as the project's own test data. A panic, an input that takes longer
//! than [`PATIENCE`] and one that takes more memory than [`allowed_kib`] are failures: the input is kept in `target/fuzz/`,
//! and the exit code is 1. The input at work is written there before it is read, so that an abort leaves it, too.
//!
//! A loop of seeded mutations and not libFuzzer: that needs a nightly compiler, and this runs where the tests do.

mod mutation;

use anyhow::{Context, Result, bail};
use isophote::conform::check::check;
use isophote::conform::corpus::{Corpus, Suite};
use isophote::conform::report::Report;
use mutation::Random;
use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The longest that one input may take, on a loaded machine, too.
const PATIENCE: Duration = Duration::from_secs(20);

/// The longest input that is made, bytes.
const LONGEST: usize = 1 << 18;

/// How many lines of findings of one kind are printed.
const LISTED: usize = 20;

/// Takes a file by its name and bytes; says what it says of one that it does not take.
type Read = Box<dyn Fn(&Path, &[u8]) -> Result<()>>;

/// A reader, and what it begins with.
struct Target {
    seeds: Vec<Vec<u8>>,
    /// Whether it takes the file; what it says of one that it does not take.
    read: Read,
    /// Whether inputs are zip archives, whose entries are changed behind their checksums.
    zipped: bool,
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (name, seconds, seed) = match &arguments[..] {
        [name, seconds] => (name, seconds, "1"),
        [name, seconds, seed] => (name, seconds, seed.as_str()),
        _ => bail!("usage: fuzz json|bpt|step|iges|3dm|obj|npz|shard SECONDS [SEED]"),
    };
    let time = Duration::from_secs(seconds.parse().with_context(|| format!("{seconds:?} is no number of seconds"))?);
    let seed = seed.parse().with_context(|| format!("{seed:?} is no seed"))?;
    run(name, &target(name)?, time, seed)
}

fn target(name: &str) -> Result<Target> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../testdata");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let folders = |names: &[&str], extension: &str| seeds(&data, names, extension);
    Ok(match name {
        "json" => Target {
            seeds: folders(&["field", "hostile", "cases", "models"], "json")?,
            read: Box::new(move |_, bytes| Ok(formats::json::parse(&text(bytes), "fuzz.json").map(|_| ())?)),
            zipped: false,
        },
        "bpt" => Target {
            seeds: vec![
                b"1\n1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n16\n".iter().copied().chain(points(16)).collect(),
                b"2\n3 3\n".iter().copied().chain(points(16)).chain(*b"1 2\n").chain(points(6)).collect(),
            ],
            read: Box::new(move |_, bytes| Ok(formats::bpt::parse(&text(bytes), "fuzz.bpt").map(|_| ())?)),
            zipped: false,
        },
        "step" => {
            let step = formats::FORMATS.iter().find(|format| format.name() == "STEP").context("a format")?;
            Target {
                seeds: folders(&["step", "step/solids"], "step")?,
                read: Box::new(|_, bytes| Ok(step.read(bytes, "fuzz.step").map(|_| ())?)),
                zipped: false,
            }
        }
        "iges" => {
            let iges = formats::FORMATS.iter().find(|format| format.name() == "IGES").context("a format")?;
            Target {
                seeds: folders(&["iges", "iges/solids"], "igs")?,
                read: Box::new(|_, bytes| Ok(iges.read(bytes, "fuzz.igs").map(|_| ())?)),
                zipped: false,
            }
        }
        // The folder of test data has the name of the extension.
        "3dm" | "obj" => {
            let format = formats::FORMATS.iter().find(|format| format.extensions() == [name]).context("a format")?;
            Target {
                seeds: folders(&[name], name)?,
                read: Box::new(move |_, bytes| Ok(format.read(bytes, "fuzz").map(|_| ())?)),
                zipped: false,
            }
        }
        "npz" => Target {
            seeds: folders(&["foreign", "golden"], "npz")?,
            read: Box::new(|path, _| {
                gbuffer::GBuffer::read_npz_meta(path)?;
                gbuffer::GBuffer::read_npz(path)?;
                Ok(())
            }),
            zipped: true,
        },
        "shard" => {
            let corpus = Corpus::new(Suite::Smoke, &Suite::Smoke.scenes(), isophote::stage::Path::default());
            let mut seeds = folders(&["hostile"], "json")?;
            seeds.retain(|seed| seed.windows(16).any(|part| part == b"isophote-conform"));
            // Brought up to date, so that mutations get behind the version.
            let member = format!("\"schema_version\": 2, \"corpus\": {:?}", corpus.hash);
            let current = seeds.iter().map(|seed| text(seed).replace("\"schema_version\": 1", &member));
            let members = "\"unanswered\": 0, \"unbounded_causes\": {}, \"ambiguous\":";
            let current = current.map(|seed| seed.replace("\"ambiguous\":", members).into_bytes());
            Target {
                seeds: current.collect(),
                read: Box::new(move |path, _| check(&Report::read(path)?, &corpus)),
                zipped: false,
            }
        }
        other => bail!("{other:?} is none of json, bpt, step, iges, 3dm, obj, npz, shard"),
    })
}

/// Lines of so many points.
fn points(count: usize) -> impl Iterator<Item = u8> {
    (0..count).flat_map(|k| format!("{} {} {}.5\n", k % 4, k / 4, k % 3).into_bytes())
}

/// The files of some folders that end so.
fn seeds(data: &Path, folders: &[&str], extension: &str) -> Result<Vec<Vec<u8>>> {
    let mut paths = vec![];
    for folder in folders {
        for entry in fs::read_dir(data.join(folder)).with_context(|| (*folder).to_owned())? {
            paths.push(entry?.path());
        }
    }
    paths.sort();
    let mut found = vec![];
    for path in paths.iter().filter(|path| path.extension().is_some_and(|end| end == extension)) {
        let bytes = fs::read(path)?;
        found.extend((bytes.len() <= LONGEST && !path.to_string_lossy().ends_with(".expect.json")).then_some(bytes));
    }
    Ok(found)
}

fn run(name: &str, target: &Target, time: Duration, seed: u64) -> Result<ExitCode> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz");
    fs::create_dir_all(&folder)?;
    let current = folder.join(format!("{name}-{seed}-current"));
    let done = Arc::new(AtomicU64::new(0));
    watch(done.clone(), current.clone());
    std::panic::set_hook(Box::new(|_| {}));
    let (start, mut random) = (Instant::now(), Random::new(seed));
    let (mut taken, mut messages, mut kept) = (0u64, BTreeSet::new(), vec![]);
    while start.elapsed() < time {
        let input = mutation::mutated(&target.seeds, target.zipped, LONGEST, &mut random);
        fs::write(&current, &input)?;
        let before = peak_kib();
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.read)(&current, &input)));
        let count = done.fetch_add(1, Ordering::Relaxed);
        let grown = peak_kib().saturating_sub(before);
        let what = match outcome {
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                Some(format!("panic: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("?")))
            }
            Ok(_) if grown > allowed_kib(input.len()) => Some(format!("{grown} KiB of memory")),
            Ok(Ok(())) => {
                taken += 1;
                None
            }
            Ok(Err(error)) => {
                // How deep mutations get shows in how many messages there are, but for their numbers and names.
                let text: String = format!("{error:#}").chars().filter(|c| c.is_ascii_lowercase()).take(60).collect();
                messages.insert(text);
                None
            }
        };
        if let Some(what) = what {
            let path = folder.join(format!("{name}-{seed}-{count}"));
            fs::copy(&current, &path)?;
            kept.push(format!("{}: {what}", path.display()));
        }
    }
    let count = done.load(Ordering::Relaxed);
    println!(
        "{name}, seed {seed}: {count} inputs, {taken} taken, {} kinds of message, {} failures",
        messages.len(),
        kept.len()
    );
    kept.iter().take(LISTED).for_each(|line| println!("{line}"));
    Ok(if kept.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Ends the program where one input takes too long; the input stays.
fn watch(done: Arc<AtomicU64>, current: PathBuf) {
    std::thread::spawn(move || {
        let (mut last, mut since) = (0, Instant::now());
        loop {
            std::thread::sleep(Duration::from_millis(200));
            let now = done.load(Ordering::Relaxed);
            if now != last {
                (last, since) = (now, Instant::now());
            } else if since.elapsed() > PATIENCE {
                println!("{}: takes longer than {} s", current.display(), PATIENCE.as_secs());
                std::process::exit(1);
            }
        }
    });
}

/// What reading an input of so many bytes may add to the peak: 16 times the input, and a small picture with what the allocator keeps.
fn allowed_kib(bytes: usize) -> u64 {
    (16 * bytes / 1024) as u64 + 65_536
}

/// The most memory that this process has taken so far; 0 where the system does not say.
fn peak_kib() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
