//! Dawn as an adapter: each stage's capsule is played by the Node program in `hosts/node`, whose compiler is Tint.

use crate::capsule::recorded;
use anyhow::{Context, Result, bail, ensure};
use files::Scratch;
use gpu::capsule::{self, Contents, Host, Played};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use suite::report::Subject;
use suite::run::{Adapter, DrawError, by_capsule, host};
use suite::stage::{OnGpu, Stage};

/// The program of a Dawn host in its folder.
const PROGRAM: &str = "play.mjs";

/// The longest wait for one picture: SwiftShader stays below it on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(300);

/// How often it is asked whether a picture is there.
const PAUSE: Duration = Duration::from_millis(10);

/// Dawn on one adapter.
pub struct Dawn {
    folder: PathBuf,
    adapter: Option<String>,
    host: Host,
    /// How far its rasterizer moves corners, as measured; none where no grid was found.
    moves_px: Option<f64>,
}

impl Dawn {
    /// Measures the rasterizer of the host in `folder`, on the adapter whose name contains `adapter` or on the best one.
    ///
    /// # Errors
    /// What is missing, or what the host said.
    pub fn open(folder: &Path, adapter: Option<&str>) -> Result<Self> {
        let program = folder.join(PROGRAM);
        ensure!(program.is_file(), "{} is not there", program.display());
        ensure!(
            folder.join("node_modules").join("webgpu").is_dir(),
            "the package webgpu is not there: `npm ci` in {} installs it",
            folder.display()
        );
        let played = played(folder, adapter, &capsule::edges())?;
        let moves_px = capsule::grid(&played)?.map(gpu::Grid::moves_px);
        let (folder, adapter) = (folder.to_owned(), adapter.map(str::to_owned));
        Ok(Self { folder, adapter, host: played.answer().host.clone(), moves_px })
    }
}

impl Adapter for Dawn {
    fn subject(&self) -> Subject {
        by_capsule(&self.host, &host())
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        let draw = || {
            let (contents, _) = recorded(stage, None, gpu::Overrides::default())?;
            let played = played(&self.folder, self.adapter.as_deref(), &contents)?;
            let drawn_by = &played.answer().host;
            ensure!(*drawn_by == self.host, "it was drawn on {}, not on {}", drawn_by.adapter, self.host.adapter);
            let gbuffer = capsule::gbuffer(&contents, &played)?;
            anyhow::Ok(OnGpu { gbuffer, shaded: None, moves_px: self.moves_px.filter(|_| stage.snaps_corners()) })
        };
        draw().map_err(|error| DrawError::Refused(format!("{error:#}")))
    }
}

/// What the host in `folder` makes of a capsule.
fn played(folder: &Path, adapter: Option<&str>, contents: &Contents) -> Result<Played> {
    let scratch = Scratch::new().context("a temporary folder")?;
    let [capsule, answer, said] = ["capsule", "answer", "said.txt"].map(|name| scratch.path().join(name));
    contents.write(&capsule)?;
    let mut command = Command::new("node");
    command.arg(folder.join(PROGRAM)).arg(&capsule).arg("--out").arg(&answer);
    if let Some(adapter) = adapter {
        command.args(["--adapter", adapter]);
    }
    let output = std::fs::File::create(&said).context("a temporary file")?;
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(output).spawn().context("node")?;
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if started.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            bail!("the host did not answer within {} s", PATIENCE.as_secs());
        }
        std::thread::sleep(PAUSE);
    };
    if !status.success() {
        let said = files::read(&said, 1 << 16).map(|text| String::from_utf8_lossy(&text).trim().to_owned());
        bail!("the host ended with {status}: {}", said.unwrap_or_default());
    }
    Ok(Played::read(&answer)?)
}
