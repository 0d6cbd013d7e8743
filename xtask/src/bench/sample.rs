//! Figures, and what they are made of.

use serde::Serialize;

/// What was measured of one thing.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// Of what.
    pub what: String,
    /// Its unit.
    pub unit: &'static str,
    /// Half are at most this.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// What there is to compare it with, and whether more is better.
    pub reference: Option<String>,
}

/// A figure in the making.
pub struct Sample {
    what: String,
    unit: &'static str,
    reference: Option<String>,
    /// What each round measured.
    pub values: Vec<f64>,
}

impl Sample {
    /// Nothing measured yet.
    pub fn new(what: impl Into<String>, unit: &'static str, reference: impl Into<Option<String>>) -> Self {
        Self { what: what.into(), unit, reference: reference.into(), values: vec![] }
    }

    /// What the rounds come to; at least one has been.
    pub fn figure(mut self) -> Figure {
        self.values.sort_by(f64::total_cmp);
        let n = self.values.len();
        Figure {
            what: self.what,
            unit: self.unit,
            median: self.values[n / 2],
            least: self.values[0],
            greatest: self.values[n - 1],
            reference: self.reference,
        }
    }
}
