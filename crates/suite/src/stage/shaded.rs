//! The picture that the GPU shades in its fragment stage, judged by the G-buffer beside it.

use super::drawn::Stage;
use anyhow::{Result, bail};
use compare::Verdict;
use gbuffer::{GBuffer, Hit, Picture, ShadeInput, Shading, shade_tolerant};
use pipeline::enclosure::{Enclosure, Enclosures, Interval, enclose};
use serde::Serialize;

/// A colour shaded on the GPU may differ from that of its own G-buffer by this much in a channel: one step of
/// rounding to 8 bits on either side.
const COLOUR_STEPS: u8 = 2;

/// How far the argument of a band may move between the two, beyond what the normals may differ by, in units of 2⁻²⁴: the
/// view direction of the fragment stage comes from an interpolated position.
const VIEW_ULPS: f32 = 128.0;

/// The picture that the GPU shaded against the shading of its own G-buffer.
#[derive(Debug, Clone, Serialize)]
pub struct ShadedReport {
    /// Covered pixels compared.
    pub covered: usize,
    /// Pixels whose colour is none that the G-buffer allows.
    pub differ: usize,
    /// The first of them, (x, y).
    pub first: Option<[usize; 2]>,
    /// Which of its samples, from 0, where a pixel has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample: Option<usize>,
    /// The answer.
    pub verdict: Verdict,
}

impl ShadedReport {
    /// What reports on the samples of a picture, in their order, come to: it agrees where each does. `None` of none.
    pub fn of_samples(reports: impl IntoIterator<Item = Self>) -> Option<Self> {
        let named = |(k, report): (usize, Self)| Self { sample: report.first.map(|_| k), ..report };
        let reports: Vec<Self> = reports.into_iter().collect();
        if reports.len() == 1 {
            return reports.into_iter().next();
        }
        reports.into_iter().enumerate().map(named).reduce(|a, b| {
            let (first, sample) = if a.first.is_some() { (a.first, a.sample) } else { (b.first, b.sample) };
            let verdict = match (a.covered, b.covered) {
                (0, _) => b.verdict,
                (_, 0) => a.verdict,
                _ => a.verdict.max(b.verdict),
            };
            Self { covered: a.covered + b.covered, differ: a.differ + b.differ, first, sample, verdict }
        })
    }
}

impl Stage<'_> {
    /// What the fragment program may return at a hit's own place.
    pub fn enclosures(&self, hit: &Hit, curvature: bool) -> Enclosures {
        enclose(&self.scene, hit.face.0, &self.scene.frames()[hit.face.0 as usize].known(hit), curvature)
    }

    /// Judges the picture that the GPU shaded in its fragment stage by the G-buffer that it returned beside it.
    ///
    /// Each colour must be one that the shared shading code gives for that hit; where a band's argument is within
    /// rounding of the band's edge (the interval of the normal there, and the interpolated view), either side will do.
    ///
    /// # Errors
    /// Where the picture is of another size.
    pub fn judge_shading(&self, shading: &Shading, gpu: &GBuffer, picture: &Picture) -> Result<ShadedReport> {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        if (picture.width(), picture.height()) != (width, height) {
            bail!("the shaded picture measures {}x{}, not {width}x{height}", picture.width(), picture.height());
        }
        let uniform = shading.uniform(&self.camera, self.model.hull().diagonal());
        let mut report = ShadedReport { covered: 0, differ: 0, first: None, sample: None, verdict: Verdict::NoVerdict };
        for y in 0..height {
            for x in 0..width {
                let allowed = match gpu.get(x, y) {
                    None => vec![gbuffer::background()],
                    Some(hit) => {
                        report.covered += 1;
                        let ray = self.camera.ray(self.viewport, x as f64 + 0.5, y as f64 + 0.5);
                        let input = ShadeInput::new(hit, self.model, &ray).expect("the GPU's faces were checked");
                        let tolerance = self.normal_tolerance(hit) + VIEW_ULPS / (1 << 24) as f32;
                        shade_tolerant(&uniform, &input, tolerance)
                    }
                };
                let shown = picture.pixel(x, y);
                let near = |colour: &[u8; 3]| (0..3).all(|c| colour[c].abs_diff(shown[c]) <= COLOUR_STEPS);
                if !allowed.iter().any(near) {
                    report.differ += 1;
                    report.first = report.first.or(Some([x, y]));
                }
            }
        }
        report.verdict = match (report.differ, report.covered) {
            (0, 0) => Verdict::NoVerdict,
            (0, _) => Verdict::Agree,
            _ => Verdict::Differ,
        };
        Ok(report)
    }

    /// How far two normals that the program may return at a hit lie apart at most, or everything where there is no bound.
    fn normal_tolerance(&self, hit: &Hit) -> f32 {
        let diagonal = |enclosure: &Enclosure| {
            let length = |n: [Interval; 3]| n.iter().map(|x| x.half_width * x.half_width).sum::<f64>().sqrt();
            enclosure.normal.map_or(2.0, |n| 2.0 * length(n))
        };
        self.enclosures(hit, false).iter().map(diagonal).fold(0.0, f64::max) as f32
    }
}
