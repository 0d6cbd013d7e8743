//! What the tests share: a corpus of three scenes, adapters that fail on purpose, and a folder for each test.

use gbuffer::{GBuffer, Hit};
use glam::DVec3;
use isophote::conform::corpus::{SCENES, Scene, Suite};
use isophote::conform::report::{Case, Report, Subject};
use isophote::conform::run::{Adapter, DrawError, Gpu, Plans};
use isophote::conform::shard::Shard;
use isophote::stage::{OnGpu, Path as DrawnBy, Stage};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

/// Scenes that are quick and agree.
pub const NAMES: [&str; 3] = ["pole", "repeated-knots", "knots-unclamped"];

/// They are drawn by one technique: that makes a case a view.
static ONCE: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let scene = |name: &&str| SCENES.iter().find(|scene| scene.name == *name).expect("in the corpus");
    NAMES.iter().map(|name| Scene { techniques: &techniques::ALL[..1], ..scene(name).clone() }).collect()
});

pub fn scenes() -> Vec<&'static Scene> {
    ONCE.iter().collect()
}

pub fn plans() -> Plans {
    Plans { suite: Suite::Smoke, scenes: scenes(), shard: Shard::WHOLE, path: DrawnBy::default() }
}

pub fn gpu() -> Gpu {
    Gpu::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`")
}

/// Runs the three scenes on an adapter.
pub fn run(adapter: Box<dyn Adapter>) -> Report {
    run_plans(&plans(), adapter)
}

/// Runs what is planned on an adapter.
pub fn run_plans(plans: &Plans, adapter: Box<dyn Adapter>) -> Report {
    let mut report = plans.report(vec![adapter.subject()]);
    plans.run(&mut [adapter], &mut report, &AtomicBool::new(false), &mut |_| Ok(())).expect("nothing to write");
    report
}

/// A complete run in which all agree.
pub static AGREEING: LazyLock<Report> = LazyLock::new(|| run(Box::new(gpu())));

/// The same on an adapter that moves one pixel of each picture.
pub static DIFFERING: LazyLock<Report> = LazyLock::new(|| run(Box::new(Wrong(gpu()))));

/// A report of the whole smoke suite in which every case came out as the first of `like` did.
pub fn smoke(like: &Report) -> Report {
    let plans = Plans { scenes: Suite::Smoke.scenes(), ..plans() };
    let mut report = plans.report(vec![]);
    report.subjects = like.subjects.clone();
    report.sources = like.sources.clone();
    for planned in plans.corpus().cases {
        report.cases.push(Case { key: planned.key, options: planned.options, ..like.cases[0].clone() });
    }
    report
}

/// An adapter that is gone after so many pictures.
pub struct Losing {
    pub gpu: Gpu,
    pub left: usize,
}

impl Adapter for Losing {
    fn subject(&self) -> Subject {
        self.gpu.subject()
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        match self.left.checked_sub(1) {
            Some(left) => self.left = left,
            None => return Err(DrawError::Lost("the device was lost while drawing: pulled out".to_owned())),
        }
        self.gpu.draw(stage)
    }
}

/// An adapter that shows S a hundredth of a unit too high in one pixel.
pub struct Wrong(pub Gpu);

impl Adapter for Wrong {
    fn subject(&self) -> Subject {
        self.0.subject()
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        let OnGpu { gbuffer: right, moves_px, .. } = self.0.draw(stage)?;
        let (width, height) = (right.viewport().width(), right.viewport().height());
        let moved = |x, y, hit: &Hit| {
            let here = (x, y) == (width / 2, height / 2);
            Hit { position: hit.position + if here { DVec3::Z * 0.01 } else { DVec3::ZERO }, ..*hit }
        };
        let row = |y| (0..width).map(|x| right.get(x, y).map(|hit| moved(x, y, hit))).collect::<Vec<_>>();
        let gbuffer = GBuffer::from_rows(right.viewport(), right.meta().clone(), (0..height).map(row));
        Ok(OnGpu { gbuffer, shaded: None, moves_px })
    }
}

/// An empty folder of that name.
pub fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("conform").join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder can be made");
    path
}
