//! A file whose area, and volume, are known in closed form.

use crate::writer::Writer;
use std::f64::consts::PI;

/// A file, and what it holds.
pub struct Case {
    pub name: &'static str,
    pub text: String,
    pub faces: usize,
    pub area: f64,
    /// `None` where the faces enclose nothing.
    pub volume: Option<f64>,
}

pub fn open(name: &'static str, w: &Writer, faces: usize, area: f64) -> Case {
    Case { name, text: w.file(), faces, area, volume: None }
}

pub fn solid(name: &'static str, w: &Writer, faces: usize, area: f64, volume: f64) -> Case {
    Case { name, text: w.file(), faces, area, volume: Some(volume) }
}

/// A sector and a triangle turned about an axis that is `centre` from the circle's middle: area and volume.
pub fn turned(centre: f64, radius: f64) -> (f64, f64) {
    let half = (-centre / radius).acos();
    let area = 4.0 * PI * radius * (centre * half + radius * half.sin());
    let sector = centre * half * radius * radius + 2.0 / 3.0 * radius.powi(3) * half.sin();
    (area, 2.0 * PI * (sector + centre * centre * radius * half.sin() / 3.0))
}
