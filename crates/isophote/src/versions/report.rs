//! What a comparison of two versions found: a document, a table and one plain line.

use super::measured::{Measured, Place, Spread};
use crate::text::{escaped, grouped};
use crate::{say, terminal};
use anyhow::Result;
use comfy_table::{Cell, CellAlignment};
use gbuffer::GBuffer;
use glam::DVec3;
use scene::Model;
use serde::Serialize;

/// The version of the document; a key that changes its meaning raises it.
const SCHEMA_VERSION: u32 = 1;

/// What the comparison found.
#[derive(Serialize)]
pub struct Report {
    /// Of `testdata/schema/versions-1.json`.
    pub(super) schema_version: u32,
    /// The names of both, as they were given.
    pub(super) versions: [String; 2],
    /// What comes after a pixel on the command line that tells of it.
    #[serde(skip)]
    pub(super) view: String,
    /// What the unit of length is called; `unit` where the files say none.
    pub(super) unit: String,
    pub(super) size: [usize; 2],
    /// Pixels that show the first version.
    pub(super) seen: usize,
    /// Pixels of which the ray caster could not say what they show.
    pub(super) undecided: usize,
    /// Pixels whose nearest point of the second version is on a border or a crease of it, and not opposite.
    pub(super) beside: usize,
    /// Of the distances, model units; `null` where nothing was measured.
    pub(super) distance: Option<Spread>,
    /// The least deviation and the greatest, model units: above 0 on the side that the first version's normal points to.
    pub(super) deviation: Option<[f64; 2]>,
    /// Of the angles between tangent planes, degrees.
    pub(super) angle_deg: Option<Spread>,
    /// Where the distance is greatest.
    pub(super) worst_distance: Option<Worst>,
    /// Where the angle is.
    pub(super) worst_angle: Option<Worst>,
    /// The greatest distance that is allowed, model units, where one was given.
    pub(super) within: Option<f64>,
    /// Pixels that are farther off.
    pub(super) beyond: usize,
}

/// A place by its numbers.
#[derive(Serialize)]
pub(super) struct Worst {
    pub(super) pixel: [usize; 2],
    pub(super) deviation: f64,
    pub(super) angle_deg: Option<f64>,
    /// On the first version and on the second.
    pub(super) face: [usize; 2],
    pub(super) uv: [[f64; 2]; 2],
    pub(super) position: [DVec3; 2],
    pub(super) is_opposite: bool,
}

impl Report {
    /// Of what was measured; `view` are the words of the camera's options, and `within` the distance that is allowed.
    pub fn new(
        names: [&str; 2],
        view: String,
        unit: &str,
        within: Option<f64>,
        models: [&Model; 2],
        first: &GBuffer,
        measured: &Measured,
    ) -> Self {
        let deviations = || measured.found().map(|place| place.deviation);
        let worst = |place: &Place| Worst {
            pixel: place.pixel,
            deviation: place.deviation,
            angle_deg: place.angle_deg,
            face: place.faces(models[0], models[1]),
            uv: [place.hit.uv.to_array(), place.foot.uv.to_array()],
            position: [place.hit.position, place.foot.position],
            is_opposite: place.foot.is_opposite,
        };
        let (low, high) = deviations().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let farthest = measured.found().max_by(|a, b| a.distance().total_cmp(&b.distance()));
        let angle = |place: &&Place| place.angle_deg.unwrap_or(-1.0);
        let most_turned = measured.found().max_by(|a, b| angle(a).total_cmp(&angle(b)));
        let viewport = first.viewport();
        Self {
            schema_version: SCHEMA_VERSION,
            versions: names.map(str::to_owned),
            view,
            unit: unit.to_owned(),
            size: [viewport.width(), viewport.height()],
            seen: first.covered(),
            undecided: first.undecided(),
            beside: measured.found().filter(|place| !place.foot.is_opposite).count(),
            distance: Spread::of(measured.found().map(Place::distance)),
            deviation: (low <= high).then_some([low, high]),
            angle_deg: Spread::of(measured.found().filter_map(|place| place.angle_deg)),
            worst_distance: farthest.map(worst),
            worst_angle: most_turned.filter(|place| place.angle_deg.is_some()).map(worst),
            within,
            beyond: within.map_or(0, |allowed| measured.found().filter(|place| allowed < place.distance()).count()),
        }
    }

    /// 0 where every pixel is within that, or none was given; 1 where one is beyond; 2 where the first version is not seen.
    pub fn exit_code(&self) -> u8 {
        match self.distance {
            None => 2,
            Some(_) => u8::from(self.beyond > 0),
        }
    }

    /// The answer in one plain line.
    pub fn line(&self) -> String {
        let [first, second] = self.versions.each_ref().map(|name| escaped(name));
        let Some(distance) = self.distance else { return format!("No pixel shows {first}.") };
        let unit = &self.unit;
        let greatest = short(distance.greatest);
        let turned = self
            .angle_deg
            .map_or(String::new(), |angle| format!("; tangent planes turn by at most {}°", short(angle.greatest)));
        match self.within {
            Some(allowed) if self.beyond > 0 => format!(
                "{} of {} pixels are farther from {second} than {} {unit}; the farthest is {greatest} {unit}{turned}.",
                grouped(self.beyond),
                grouped(self.seen),
                short(allowed)
            ),
            allowed => {
                let allowed = allowed.map_or(String::new(), |allowed| format!(" where {} is allowed", short(allowed)));
                format!(
                    "{second} is within {greatest} {unit} of {first} at all {} pixels{allowed}{turned}.",
                    grouped(self.seen)
                )
            }
        }
    }

    /// Prints it for people.
    ///
    /// # Errors
    /// Where standard output does not take it.
    pub fn print(&self) -> Result<()> {
        let [first, second] = self.versions.each_ref().map(|name| escaped(name));
        say!("{second}, measured from {first}, as rays see it, {}x{}", self.size[0], self.size[1])?;
        let mut table = terminal::narrow_table();
        table.set_header(["pixels at most", "half", "90 %", "99 %", "all"]);
        let rows =
            [(format!("distance, {}", escaped(&self.unit)), self.distance), ("angle, °".to_owned(), self.angle_deg)];
        for (name, spread) in rows {
            let numbers = match spread {
                Some(Spread { half, percentile_90, percentile_99, greatest }) => {
                    [half, percentile_90, percentile_99, greatest].map(short)
                }
                None => ["—"; 4].map(str::to_owned),
            };
            let numbers = numbers.map(|number| Cell::new(number).set_alignment(CellAlignment::Right));
            table.add_row([Cell::new(name)].into_iter().chain(numbers));
        }
        terminal::table(&table)?;
        say!("  distance: to the nearest point of the second version; angle: between the tangent planes there")?;
        if let Some([low, high]) = self.deviation {
            let unit = escaped(&self.unit);
            say!(
                "  on the side of the normal up to {} {unit}, behind it up to {} {unit}",
                short(high.max(0.0)),
                short((-low).max(0.0))
            )?;
        }
        if self.beside > 0 {
            say!(
                "  {} pixels have nothing opposite: their nearest point is on a border or a crease of {second}",
                grouped(self.beside)
            )?;
        }
        if self.undecided > 0 {
            say!("  {} pixels were left undecided by the ray caster", grouped(self.undecided))?;
        }
        for (what, worst) in [("farthest", &self.worst_distance), ("most turned", &self.worst_angle)] {
            let Some(Worst { pixel: [x, y], face, position: [p, _], uv, .. }) = worst else { continue };
            let uv = uv.map(|[u, v]| format!("({}, {})", short(u), short(v)));
            say!("{what}: pixel {x},{y} at ({}, {}, {})", short(p.x), short(p.y), short(p.z))?;
            say!("  face {} at (u, v) = {}, nearest: face {} at {}", face[0], uv[0], face[1], uv[1])?;
            say!("  next: isophote pixel {first} {x},{y}{}", self.view)?;
        }
        say!("{}", self.line())
    }
}

/// Four digits, without the noughts at their end.
pub(super) fn short(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{x:.2e}");
    }
    let digits = (3 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
