//! A candidate's picture as a diagnosis looks at it: a sample of its pixels, and the same picture with a mistake undone.

use super::fault::Fault;
use gbuffer::{GBuffer, Hit};
use glam::{DVec2, DVec3};
use scene::{Camera, Model};

/// Pixels of which a hypothesis is asked first; those that pass are tried on all.
const SAMPLES: usize = 400;

/// The share of the sample that a hypothesis must explain to be tried: silhouettes and poles are seldom explained.
const MOSTLY: f64 = 0.9;

/// A picture and what it should show.
pub(super) struct View<'a> {
    pub model: &'a Model,
    pub camera: &'a Camera,
    pub buffer: &'a GBuffer,
}

/// One pixel of a picture.
pub(super) struct Seen {
    /// Its centre, pixels.
    pub center: DVec2,
    /// What it shows.
    pub hit: Hit,
    /// S at its own (u, v).
    pub s: DVec3,
    /// The model's unit normal there.
    pub normal: Option<DVec3>,
    /// Where the camera sees S, pixels.
    pub place: Option<DVec2>,
}

/// A mistake, and the picture without it, as `camera` sees it.
pub(super) struct Hypothesis {
    pub fault: Fault,
    pub undone: GBuffer,
    pub camera: Camera,
}

impl View<'_> {
    /// Covered pixels whose parameters are numbers, evenly over the picture.
    pub fn samples(&self) -> Vec<Seen> {
        let viewport = self.buffer.viewport();
        let width = viewport.width();
        let covered: Vec<(usize, &Hit)> = self
            .buffer
            .pixels()
            .enumerate()
            .filter_map(|(i, hit)| Some((i, hit.filter(|hit| hit.uv.is_finite())?)))
            .collect();
        let step = covered.len().div_ceil(SAMPLES).max(1);
        let seen = |&(i, hit): &(usize, &Hit)| {
            let s = self.model.surface(hit.face).point(hit.uv.x, hit.uv.y);
            Seen {
                center: DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5),
                hit: *hit,
                s,
                normal: self.normal(hit),
                place: self.camera.picture(viewport, s),
            }
        };
        covered.iter().step_by(step).map(seen).collect()
    }

    /// The model's unit normal at a hit's own (u, v), where these are numbers.
    pub fn normal(&self, hit: &Hit) -> Option<DVec3> {
        if !hit.uv.is_finite() {
            return None;
        }
        let n = self.model.surface(hit.face).inspect(hit.uv.x, hit.uv.y).normal.unit()?;
        Some(if self.model.faces()[hit.face.0 as usize].reversed { -n } else { n })
    }

    /// The picture with each hit changed.
    pub fn each(&self, change: impl Fn(&Hit) -> Hit) -> GBuffer {
        self.made(|x, y| self.buffer.get(x, y).map(&change))
    }

    /// A picture of the same size and origin.
    pub fn made(&self, pixel: impl Fn(usize, usize) -> Option<Hit>) -> GBuffer {
        let viewport = self.buffer.viewport();
        let rows = (0..viewport.height()).map(|y| (0..viewport.width()).map(|x| pixel(x, y)).collect());
        GBuffer::from_rows(viewport, self.buffer.meta().clone(), rows)
    }

    /// The mistake whose undoing changes hits and nothing else.
    pub fn hypothesis(&self, fault: Fault, undone: GBuffer) -> Hypothesis {
        Hypothesis { fault, undone, camera: *self.camera }
    }
}

/// Whether a test holds of most of a sample.
pub(super) fn mostly(samples: &[Seen], test: impl Fn(&Seen) -> bool) -> bool {
    let holds = samples.iter().filter(|seen| test(seen)).count();
    !samples.is_empty() && holds as f64 >= MOSTLY * samples.len() as f64
}
