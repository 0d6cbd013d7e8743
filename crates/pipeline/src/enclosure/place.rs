//! Where a hit is on its face, as far as that is known.

use crate::layout::Parameters;
use crate::packed::PackedFrame;
use gbuffer::{Hit, LocalParameters};

/// A span's parameter as far as it is known: the program's own f32, or an interval of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    low: f32,
    high: f32,
}

impl Parameter {
    /// A parameter that is known, in 0 … 1; clamped to it as the program does.
    pub fn exact(t: f32) -> Self {
        let t = t.clamp(0.0, 1.0);
        Self { low: t, high: t }
    }

    /// The f32 that `t` is, or the two on either side where it is none.
    pub(super) fn nearest(t: f64) -> Self {
        let nearest = (t as f32).clamp(0.0, 1.0);
        match f64::from(nearest) - t {
            0.0 => Self::exact(nearest),
            above if above > 0.0 => Self { low: nearest.next_down().max(0.0), high: nearest },
            _ => Self { low: nearest, high: nearest.next_up().min(1.0) },
        }
    }

    /// All f32 that may have become `t` of the knot domain on the span from `start` to `end`, of which f64 may have lost `lost`.
    pub(super) fn of(t: f64, [start, end]: [f64; 2], lost: f64) -> Self {
        let local = (t - start) / (end - start);
        if lost < f64::from(f32::EPSILON) / 16.0 {
            // Many small ones become one t. Widening is monotone, so they are a run of f32, whose ends are found by halving.
            let one = 1.0f32.to_bits();
            let first = |is_there: &dyn Fn(f64) -> bool| {
                let (mut low, mut high) = (0, one);
                while low < high {
                    let middle = low + (high - low) / 2;
                    let widened = start + (end - start) * f64::from(f32::from_bits(middle));
                    if is_there(widened) {
                        high = middle;
                    } else {
                        low = middle + 1;
                    }
                }
                low
            };
            let (from, beyond) = (first(&|widened| widened >= t), first(&|widened| widened > t));
            let [low, high] = match (from < beyond, t == end) {
                (true, true) => [from, one],
                (true, false) => [from, beyond - 1],
                (false, true) => [one, one],
                (false, false) => [from.saturating_sub(1), from],
            };
            Self { low: f32::from_bits(low), high: f32::from_bits(high) }
        } else {
            let [low, high] = [local - lost, local + lost];
            Self { low: (low as f32).next_down().clamp(0.0, 1.0), high: (high as f32).next_up().clamp(0.0, 1.0) }
        }
    }

    /// Whether it is known to the bit.
    pub fn is_exact(self) -> bool {
        self.low == self.high
    }

    /// The middle of what is known.
    pub fn middle(self) -> f64 {
        0.5 * (f64::from(self.low) + f64::from(self.high))
    }

    pub(super) fn radius(self) -> f64 {
        0.5 * (f64::from(self.high) - f64::from(self.low))
    }
}

/// A span, and a parameter of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnSpan {
    /// Number of the span among those that are not empty.
    pub span: u32,
    /// The parameter.
    pub t: Parameter,
    /// What f64 may have lost of the parameter on the way to the knot domain and back.
    pub lost: f64,
}

/// Where a hit is on its face, as far as that is known: in u and in v, one span, or the two that meet there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known(pub(super) [[Option<OnSpan>; 2]; 2]);

impl Known {
    /// A place that is known to the bit.
    pub fn exact(Parameters { span, uv }: Parameters) -> Self {
        Self([0, 1].map(|k| [Some(OnSpan { span: span[k], t: Parameter::exact(uv[k]), lost: 0.0 }), None]))
    }

    /// Whether it is known to the bit on every span.
    pub fn is_exact(&self) -> bool {
        self.0.iter().flatten().flatten().all(|on| on.t.is_exact())
    }
}

impl PackedFrame {
    /// Where a hit is: by its local parameters, where they are [believed](Self::believed), else by (u, v) in the knot domain.
    pub fn known(&self, hit: &Hit) -> Known {
        match self.believed(hit) {
            None => Known([self.of_domain(0, hit.uv.x), self.of_domain(1, hit.uv.y)]),
            Some(LocalParameters { span, uv }) => Known([0, 1].map(|k| {
                [Some(OnSpan { span: span[k], t: Parameter::nearest(uv[k]), lost: 4.0 * f64::EPSILON }), None]
            })),
        }
    }

    /// A hit's local parameters, where it has some and they are those of its (u, v), to what f64 may have lost of these.
    pub fn believed(&self, hit: &Hit) -> Option<LocalParameters> {
        let belongs = |local: &LocalParameters, k: usize| {
            (local.span[k] as usize) + 1 < self.breaks[k].len() && {
                let [start, end] = self.span(k, local.span[k]);
                let off = start + (end - start) * local.uv[k] - hit.uv[k];
                off.abs() <= 4.0 * f64::EPSILON * (start.abs() + end.abs())
            }
        };
        hit.local.filter(|local| belongs(local, 0) && belongs(local, 1))
    }

    /// The span that a parameter of the knot domain is on, and its neighbour where it is the end of both.
    fn of_domain(&self, k: usize, t: f64) -> [Option<OnSpan>; 2] {
        let breaks = &self.breaks[k];
        let on = |span: usize| {
            let [start, end] = [breaks[span], breaks[span + 1]];
            let lost = 2.0 * f64::EPSILON * (1.0 + (start.abs() + end.abs()) / (end - start));
            OnSpan { span: span as u32, t: Parameter::of(t, [start, end], lost), lost }
        };
        let last = breaks.len() - 2;
        let span = breaks.partition_point(|&start| start <= t).saturating_sub(1).min(last);
        let before = (span > 0 && t <= breaks[span]).then(|| on(span - 1));
        [Some(on(span)), before]
    }
}
