//! A variant and who draws with it: what is wrong with its picture.

use super::variant;
use crate::legal::picture::{Adapter, CALLED, Scene};
use crate::legal::{Judged, why};
use anyhow::{Result, ensure};
use clap::ValueEnum;
use compare::Verdict;
use gbuffer::GBuffer;
use isophote::stage::Stage;
use pipeline::wgsl::{self, Variant};
use std::cell::{Cell, RefCell};

/// What a compiler may get wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fault {
    /// A square is expanded, so that a difference cancels
    Reassociation,
    /// A place that was found is not clamped to its piece: of the program `exact`
    Clamp,
    /// A loop ends one turn too early
    Bound,
}

impl Fault {
    /// The text with the fault in it.
    pub fn put(self, program: &str) -> String {
        let (right, wrong) = match self {
            Self::Reassociation => ("sqrt(x * x + b * b)", "sqrt(mean * mean - (a * c - b * b))"),
            Self::Clamp => ("let inside = min(max(uv, piece.rectangle.xy), piece.rectangle.zw);", "let inside = uv;"),
            Self::Bound => ("j <= q", "j < q"),
        };
        program.replace(right, wrong)
    }
}

/// A host that is there.
pub enum Opened {
    /// A GPU.
    Gpu(Box<gpu::Device>),
    /// The machine.
    Machine,
}

impl Opened {
    /// The functions that it calls by their names, beside entry points.
    pub fn called(&self) -> &'static [&'static str] {
        match self {
            Self::Gpu(_) => &[],
            Self::Machine => &CALLED,
        }
    }

    /// Draws a stage with the programs of `source`.
    ///
    /// # Errors
    /// Where the host refuses them.
    pub fn draw(&self, stage: &Stage, source: &dyn Fn(Variant) -> String) -> Result<GBuffer> {
        match self {
            Self::Gpu(device) => {
                let overrides = gpu::Overrides { source: Some(source), ..Default::default() };
                Ok(stage.gpu(device, None, overrides)?.gbuffer)
            }
            Self::Machine => Scene::with_source(stage, source)?.draw(Adapter::STRICT),
        }
    }
}

/// A variant: a seed, and the fault of the compiler that is made with it.
#[derive(Debug, Clone, Copy)]
pub struct Wording {
    /// The seed.
    pub seed: u64,
    /// The fault, if any.
    pub fault: Option<Fault>,
    /// Whether declarations that nothing uses are left out.
    pub is_lean: bool,
}

impl Wording {
    /// A program in these words.
    pub fn program(self, variant: Variant, host: &Opened) -> String {
        let right = wgsl::source(variant);
        let text = self.fault.map_or(right.clone(), |fault| fault.put(&right));
        let program = variant::variant(&text, self.seed, host.called());
        if self.is_lean { variant::lean(&program, host.called()) } else { program }
    }

    /// Draws a scene; what is wrong with the picture, if anything is.
    ///
    /// # Errors
    /// Where the host refuses the programs.
    pub fn wrong(self, judged: &Judged, host: &Opened) -> Result<Option<Wrong>> {
        let is_put = Cell::new(self.fault.is_none());
        let programs = RefCell::new(vec![]);
        let source = |variant: Variant| {
            let right = wgsl::source(variant);
            is_put.set(is_put.get() || self.fault.is_some_and(|fault| fault.put(&right) != right));
            let program = self.program(variant, host);
            programs.borrow_mut().push(program.clone());
            program
        };
        let picture = host.draw(judged.stage(), &source)?;
        ensure!(is_put.get(), "no program has the text that the fault changes");
        let reports = judged.reports(&picture)?;
        let differing = reports.iter().find(|report| report.verdict == Verdict::Differ);
        Ok(differing.map(|report| Wrong { why: why(report), programs: programs.take() }))
    }
}

/// What is wrong with a picture.
pub struct Wrong {
    /// In words.
    pub why: String,
    /// The programs that drew it, in the order in which they were asked for.
    pub programs: Vec<String>,
}
