//! Instructions of the CPU's kernels, counted by valgrind's callgrind, and held to an earlier count.
//!
//! A count does not depend on what else the machine does. Each kernel runs in a process of its own on one thread, once with its
//! work and once without, so that what comes before the work does not count. Valgrind knows vectors up to AVX2.

use super::frames::Frames;
use super::parts::{POINTS, Together, cast, evaluate_f32, evaluate_f64, points, rays};
use anyhow::{Context, Result, bail, ensure};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use isophote::format::Format;
use isophote::stage::Plan;
use isophote::{say, terminal};
use lanes::Level;
use raycast::Caster;
use scene::{Camera, Viewport};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, ExitCode};

/// A count that is greater by this share is a slowdown.
const SLOWDOWN: f64 = 0.1;

/// The greatest file of counts that is read, bytes.
const MAX_BASELINE_BYTES: u64 = 1 << 20;

/// Side of the pictures that are drawn, pixels.
const SIDE: usize = 64;

/// Points that are evaluated: callgrind is some fifty times slower than the processor.
const FEW_POINTS: usize = POINTS / 16;

/// Rays that are cast.
const FEW_RAYS: usize = 1024;

/// What is counted, each with what it works on.
const KERNELS: &[(&str, &str)] = &[
    ("points-one", "S, S_u, S_v, normal of a bicubic rational surface in f64, one by one"),
    ("points-list", "the same, a list in no order"),
    ("points-grid", "the same, a grid"),
    ("fragments", "the fragment program in f32 on the same surface, packed and sorted by spans before"),
    ("frame-fragment", "the CPU rasterizer, teapot 64x64, technique fragment"),
    ("frame-exact", "the CPU rasterizer, teapot 64x64, technique exact"),
    ("rays-top-down", "the f64 ray caster from above on the same surface"),
    ("rays-grazing", "the same, grazing"),
];

/// Counts of one run.
#[derive(Debug, Serialize, Deserialize)]
struct Counts {
    /// How the program was compiled.
    profile: String,
    /// The vectors that the kernels ran on.
    vectors: String,
    /// Instructions, by kernel.
    instructions: BTreeMap<String, u64>,
}

/// Works `repeats` times on a kernel, and prints what vectors it has.
///
/// # Errors
/// Where there is no such kernel.
pub fn work(kernel: &str, repeats: usize) -> Result<()> {
    let level = format!("{:?}", Level::new());
    say!("{}", level.split('(').next().unwrap_or_default())?;
    let model = models::builtin("rational").expect("built in");
    let points = &points()[..FEW_POINTS];
    let frame = |technique: &'static dyn techniques::Technique| -> Result<()> {
        let teapot = models::builtin("teapot").expect("built in");
        let viewport = Viewport::new(SIDE, SIDE)?;
        let cameras = [Camera::framing(&teapot, viewport)];
        let frames = Frames::new(&teapot, Plan { technique, ..Plan::default() }, Some(10), &cameras, viewport)?;
        (0..repeats).for_each(|_| {
            frames.on_cpu();
        });
        Ok(())
    };
    let rays = |k: usize| {
        let (caster, rays) = (Caster::new(&model), rays(&model));
        // Spread over the picture.
        let step = rays[k].len() / FEW_RAYS;
        let few: Vec<_> = rays[k].iter().step_by(step).copied().collect();
        (0..repeats).for_each(|_| {
            cast(&caster, &few);
        });
    };
    let evaluate = |together| {
        (0..repeats).for_each(|_| {
            evaluate_f64(&model, points, together);
        });
    };
    match kernel {
        "points-one" => evaluate(Together::One),
        "points-list" => evaluate(Together::List),
        "points-grid" => evaluate(Together::Grid),
        "fragments" => {
            for _ in 0..repeats {
                evaluate_f32(&model, points)?;
            }
        }
        "frame-fragment" => frame(&techniques::fragment::Fragment)?,
        "frame-exact" => frame(&techniques::exact::Exact)?,
        "rays-top-down" => rays(0),
        "rays-grazing" => rays(1),
        _ => bail!("no kernel is called {kernel}"),
    }
    Ok(())
}

/// Counts all kernels, and compares them with a baseline. Code 1 where one is slower by [`SLOWDOWN`] or more.
///
/// # Errors
/// Where callgrind is not there, or the baseline cannot be read or is of other kernels, vectors or another profile.
pub fn run(baseline: Option<&Path>, format: Format) -> Result<ExitCode> {
    let before = baseline.map(read).transpose()?;
    let counts = count()?;
    if let Some(before) = &before {
        for (what, old, new) in
            [("profile", &before.profile, &counts.profile), ("vectors", &before.vectors, &counts.vectors)]
        {
            ensure!(
                old == new,
                "the baseline's {what} is {old}, and this is {new}: their counts say nothing of each other"
            );
        }
    }
    let slower = before.as_ref().map(|before| slower(before, &counts)).transpose()?.unwrap_or_default();
    if format == Format::Json {
        terminal::json(&counts)?;
    } else {
        print(&counts, before.as_ref())?;
    }
    for (kernel, ratio) in &slower {
        terminal::note(format_args!("{kernel} takes {ratio:.2} times the instructions of the baseline"));
    }
    Ok(ExitCode::from(u8::from(!slower.is_empty())))
}

fn read(path: &Path) -> Result<Counts> {
    let name = path.display();
    let bytes = files::read(path, MAX_BASELINE_BYTES).with_context(|| name.to_string())?;
    serde_json::from_slice(&bytes)
        .with_context(|| format!("{name}: no report of `bench --suite kernels --format json`"))
}

/// The kernels that take more by [`SLOWDOWN`], and how many times as much.
fn slower(before: &Counts, now: &Counts) -> Result<Vec<(String, f64)>> {
    let mut found = vec![];
    for (kernel, &count) in &now.instructions {
        let Some(&old) = before.instructions.get(kernel) else { bail!("the baseline has no kernel {kernel}") };
        let ratio = count as f64 / old as f64;
        // A baseline of none is none.
        if !ratio.is_finite() || ratio >= 1.0 + SLOWDOWN {
            found.push((kernel.clone(), ratio));
        }
    }
    Ok(found)
}

fn count() -> Result<Counts> {
    let mut instructions = BTreeMap::new();
    let mut vectors = String::new();
    let bar = terminal::progress("kernels", KERNELS.len());
    for (kernel, _) in KERNELS {
        let (idle, _) = callgrind(kernel, 0)?;
        let (busy, found) = callgrind(kernel, 1)?;
        vectors = found;
        instructions.insert((*kernel).to_owned(), busy.saturating_sub(idle));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    Ok(Counts { profile: profile.to_owned(), vectors, instructions })
}

/// Instructions of a process that works on a kernel, and the vectors that it has.
fn callgrind(kernel: &str, repeats: usize) -> Result<(u64, String)> {
    let program = std::env::current_exe().context("this program has a path")?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["bench", "--kernel", kernel, "--repeats", &repeats.to_string()])
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .context("valgrind cannot be started (apt-get install valgrind)")?;
    let told = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "valgrind failed on {kernel}: {told}");
    let collected = told.lines().find_map(|line| line.split_once("Collected : "));
    let count = collected.and_then(|(_, count)| count.trim().parse().ok());
    let vectors = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    Ok((count.with_context(|| format!("valgrind counted nothing: {told}"))?, vectors))
}

fn print(counts: &Counts, before: Option<&Counts>) -> Result<()> {
    say!("instructions by callgrind, one thread, {} build, vectors: {}", counts.profile, counts.vectors)?;
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["kernel", "what", "instructions", "of the baseline"]);
    for (kernel, what) in KERNELS {
        let count = counts.instructions[*kernel];
        let ratio = before.and_then(|before| before.instructions.get(*kernel)).map(|&old| count as f64 / old as f64);
        let ratio = ratio.map(|ratio| format!("{ratio:.3}")).unwrap_or_default();
        table.add_row([(*kernel).to_owned(), (*what).to_owned(), count.to_string(), ratio]);
    }
    terminal::table(&table)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(all: &[(&str, u64)]) -> Counts {
        let instructions = all.iter().map(|&(kernel, count)| (kernel.to_owned(), count)).collect();
        Counts { profile: "release".to_owned(), vectors: "Avx2".to_owned(), instructions }
    }

    #[test]
    fn a_tenth_more_is_a_slowdown_and_less_is_none() {
        let before = counts(&[("a", 1000), ("b", 1000), ("c", 1000), ("d", 0)]);
        let now = counts(&[("a", 1099), ("b", 1100), ("c", 500), ("d", 7)]);
        let slower = slower(&before, &now).expect("the same kernels");
        assert_eq!(slower.iter().map(|(kernel, _)| kernel.as_str()).collect::<Vec<_>>(), ["b", "d"]);
    }

    #[test]
    fn a_kernel_that_the_baseline_lacks_is_no_pass() {
        let error = slower(&counts(&[("a", 1)]), &counts(&[("a", 1), ("b", 1)])).expect_err("b was not counted");
        assert!(error.to_string().contains("no kernel b"), "{error}");
    }
}
