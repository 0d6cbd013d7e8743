//! Faults in G-buffers: pixels of the CPU's picture changed one by one.

use super::Labelled;
use super::scenes::{Scene, Shown};
use compare::{Cause, NEARLY};
use gbuffer::{Hit, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use isophote::stage::Stage;
use nurbs::{Direction, Normal, Surface};
use pipeline::enclosure::Interval;
use raster::Options;
use scene::FaceId;

const SURFACES: &[Scene] = &[Scene::Bicubic, Scene::ManySpans, Scene::Rational, Scene::Wave];

/// Every so many pixels, in both directions, one is changed: a neighbour in the picture never is.
const STEP: usize = 3;

/// A hit and what there is to change it by.
struct Pixel<'a> {
    stage: &'a Stage<'a>,
    surface: &'a Surface,
    tolerance: Tolerance,
    hit: Hit,
    at: [usize; 2],
}

/// What becomes of a hit; `None` where it stays as it is.
type Change = fn(&Pixel) -> Option<Option<Hit>>;

struct Fault {
    name: &'static str,
    change: Change,
    scenes: &'static [Scene],
    cause: Cause,
}

const FAULTS: &[Fault] = &[
    Fault {
        name: "parameters of a place beside",
        change: |p| p.hit_at(p.hit.uv + 0.05 * (p.middle() - p.hit.uv).signum() * p.size()),
        scenes: SURFACES,
        cause: Cause::Interpolation,
    },
    Fault {
        name: "u and v exchanged with all that follows",
        change: |p| p.hit_at(p.exchanged()),
        scenes: &[Scene::Bicubic, Scene::Wave],
        cause: Cause::Parameters,
    },
    Fault {
        name: "u and v exchanged alone",
        change: |p| p.with(Hit { uv: p.exchanged(), local: None, ..p.hit }).filter(|_| p.is_off_diagonal()),
        scenes: &[Scene::Bicubic, Scene::Wave],
        cause: Cause::Parameters,
    },
    Fault {
        name: "another face's name",
        change: |p| p.with(Hit { face: FaceId((p.hit.face.0 + 1) % p.stage.model.faces().len() as u32), ..p.hit }),
        scenes: &[Scene::Bicubic],
        cause: Cause::Face,
    },
    Fault { name: "a hole", change: |p| p.is_inside().then_some(None), scenes: SURFACES, cause: Cause::Coverage },
    Fault {
        name: "the farther layer",
        change: |p| p.farther().map(Some),
        scenes: &[Scene::Bicubic, Scene::ManySpans, Scene::Rational],
        cause: Cause::Depth,
    },
    Fault {
        name: "a position four tolerances off",
        change: |p| p.moved(4.0 * p.tolerance.position),
        scenes: SURFACES,
        cause: Cause::Rounding,
    },
    Fault {
        name: "a position a thousandth of the face off",
        change: |p| p.moved(1e-3 * p.surface.hull().diagonal()),
        scenes: SURFACES,
        cause: Cause::Position,
    },
    Fault {
        name: "the next span's polynomial",
        change: |p| p.next_span(),
        scenes: &[Scene::ManySpans],
        cause: Cause::Span,
    },
    Fault {
        name: "the numerator",
        change: |p| {
            let point = p.numerator();
            p.with(Hit { position: point, ..p.hit })
        },
        scenes: &[Scene::Rational, Scene::Wave],
        cause: Cause::Rational,
    },
    Fault {
        name: "a flipped normal",
        change: |p| p.normal(|n, _| Normal::Regular(-n)),
        scenes: SURFACES,
        cause: Cause::Derivative,
    },
    Fault {
        name: "a tilted normal",
        change: |p| p.normal(|n, _| Normal::Regular((n + 0.05 * n.any_orthonormal_vector()).normalize())),
        scenes: SURFACES,
        cause: Cause::Derivative,
    },
    Fault {
        name: "a normal four tolerances off",
        change: |p| {
            p.normal(|n, allowed| Normal::Regular((n + 4.0 * allowed * n.any_orthonormal_vector()).normalize()))
        },
        scenes: SURFACES,
        cause: Cause::Rounding,
    },
    Fault {
        name: "a normal too long",
        change: |p| p.normal(|n, _| Normal::Regular(1.01 * n)),
        scenes: SURFACES,
        cause: Cause::NormalLength,
    },
    Fault {
        name: "no normal",
        change: |p| p.normal(|_, _| Normal::Undefined),
        scenes: SURFACES,
        cause: Cause::DegenerateNormal,
    },
    Fault {
        name: "principal curvatures a tenth too great",
        change: |p| p.curvature(|k, size| PrincipalCurvatures { k1: k.k1 + 0.1 * size, k2: k.k2 + 0.1 * size }),
        scenes: SURFACES,
        cause: Cause::Curvature,
    },
    Fault {
        name: "principal curvatures that are no numbers",
        change: |p| p.curvature(|_, _| PrincipalCurvatures { k1: f64::NAN, k2: f64::NAN }),
        scenes: &[Scene::Bicubic],
        cause: Cause::NotFinite,
    },
    Fault {
        name: "a position that is no number",
        change: |p| p.with(Hit { position: DVec3::NAN, ..p.hit }),
        scenes: SURFACES,
        cause: Cause::NotFinite,
    },
    Fault {
        name: "parameters that are no numbers",
        change: |p| p.with(Hit { uv: DVec2::NAN, ..p.hit }),
        scenes: SURFACES,
        cause: Cause::NotFinite,
    },
    Fault {
        name: "a normal that is no number",
        change: |p| p.normal(|_, _| Normal::Regular(DVec3::NAN)),
        scenes: SURFACES,
        cause: Cause::NotFinite,
    },
];

impl Pixel<'_> {
    fn with(&self, hit: Hit) -> Option<Option<Hit>> {
        Some(Some(hit))
    }

    fn size(&self) -> DVec2 {
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        DVec2::new(u1 - u0, v1 - v0)
    }

    fn middle(&self) -> DVec2 {
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        DVec2::new(u0 + u1, v0 + v1) / 2.0
    }

    fn local(&self) -> DVec2 {
        let [[u0, _], [v0, _]] = self.surface.domain();
        (self.hit.uv - DVec2::new(u0, v0)) / self.size()
    }

    fn exchanged(&self) -> DVec2 {
        let [[u0, _], [v0, _]] = self.surface.domain();
        let local = self.local();
        DVec2::new(u0, v0) + self.size() * DVec2::new(local.y, local.x)
    }

    fn is_off_diagonal(&self) -> bool {
        let local = self.local();
        (local.x - local.y).abs() > 0.05
    }

    /// The whole hit at other parameters, without error.
    fn hit_at(&self, uv: DVec2) -> Option<Option<Hit>> {
        let point = self.surface.inspect(uv.x, uv.y);
        let position = point.derivatives.s;
        let seen = self.stage.camera.picture(self.stage.viewport, position)?;
        let [x, y] = self.at.map(|t| t as f64 + 0.5);
        // Where the picture is the same, as at a pole, nothing is at fault.
        let is_beside = seen.distance(DVec2::new(x, y)) > 1.0;
        let curvature = point.curvature.map(|k| PrincipalCurvatures { k1: k.k1, k2: k.k2 });
        is_beside.then_some(Some(Hit { uv, local: None, position, normal: point.normal, curvature, ..self.hit }))
    }

    fn moved(&self, length: f64) -> Option<Option<Hit>> {
        let direction = DVec3::new(0.48, -0.6, 0.64);
        self.with(Hit { position: self.hit.position + length * direction, ..self.hit })
    }

    fn normal(&self, change: impl Fn(DVec3, f64) -> Normal) -> Option<Option<Hit>> {
        let normal = change(self.hit.normal.unit()?, self.tolerance.normal?);
        self.with(Hit { normal, ..self.hit })
    }

    fn curvature(&self, change: impl Fn(PrincipalCurvatures, f64) -> PrincipalCurvatures) -> Option<Option<Hit>> {
        let found = self.hit.curvature?;
        let size = found.k1.abs().max(found.k2.abs());
        // Where f32 itself is not much better, the change is none.
        let is_large = 0.1 * size > 2.0 * NEARLY * self.tolerance.curvature?;
        is_large.then_some(Some(Hit { curvature: Some(change(found, size)), ..self.hit }))
    }

    /// Whether the pixel and all around it show one face, far from its borders.
    fn is_inside(&self) -> bool {
        let local = self.local();
        let near_end = |t: f64| !(0.1..=0.9).contains(&t);
        let facing = self.hit.normal.unit().is_some_and(|n| n.dot(self.ray()).abs() > 0.4);
        !near_end(local.x) && !near_end(local.y) && facing
    }

    fn ray(&self) -> DVec3 {
        let [x, y] = self.at.map(|t| t as f64 + 0.5);
        self.stage.camera.ray(self.stage.viewport, x, y).direction
    }

    /// The second layer under the pixel, where it is far behind the first.
    fn farther(&self) -> Option<Hit> {
        let rasterizer = self.stage.rasterizer(Options { curvature: true, vertex_normals: false });
        let [x, y] = self.at.map(|t| t as f64 + 0.5);
        let behind = self.hit.t + 0.1 * self.surface.hull().diagonal();
        rasterizer.sampler().layers(x, y).into_iter().find(|hit| hit.t > behind).filter(|_| self.is_inside())
    }

    fn spans(&self) -> [usize; 2] {
        let span = |direction, t| self.surface.knots(direction).find_span(t);
        [span(Direction::U, self.hit.uv.x), span(Direction::V, self.hit.uv.y)]
    }

    fn next_span(&self) -> Option<Option<Hit>> {
        let [k, l] = self.spans();
        let next = self.surface.knots(Direction::U).spans().find(|&span| span > k)?;
        let position = self.surface.inspect_on(next, l, self.hit.uv.x, self.hit.uv.y).derivatives.s;
        let moved = position.distance(self.hit.position) > 20.0 * self.tolerance.position;
        moved.then_some(Some(Hit { position, ..self.hit }))
    }

    fn numerator(&self) -> DVec3 {
        let nets = [Direction::U, Direction::V].map(|d| self.surface.knots(d));
        let [k, l] = self.spans();
        let nu = nurbs::basis_derivatives(nets[0], k, self.hit.uv.x, 0);
        let nv = nurbs::basis_derivatives(nets[1], l, self.hit.uv.y, 0);
        let columns = nets[1].control_count();
        let mut sum = DVec3::ZERO;
        for i in 0..=nets[0].degree() {
            for j in 0..=nets[1].degree() {
                let [x, y, z, _] =
                    self.surface.homogeneous()[(k - nets[0].degree() + i) * columns + l - nets[1].degree() + j];
                sum += nu[0][i] * nv[0][j] * DVec3::new(x, y, z);
            }
        }
        self.surface.origin() + sum
    }
}

/// Every fault on its scenes.
pub fn labelled() -> Vec<Labelled> {
    let mut all = vec![];
    for fault in FAULTS {
        for scene in fault.scenes {
            let shown = Shown::new(*scene);
            let stage = shown.stage();
            let report = shown.changed(|x, y, hit| {
                let hit = hit?;
                if x % STEP != 0 || y % STEP != 0 {
                    return Some(*hit);
                }
                let surface = shown.model.surface(hit.face);
                let tolerance = tolerance(&stage, hit);
                let pixel = Pixel { stage: &stage, surface, tolerance, hit: *hit, at: [x, y] };
                (fault.change)(&pixel).unwrap_or(Some(*hit))
            });
            all.push(Labelled { name: format!("{}, {scene:?}", fault.name), cause: fault.cause, report });
        }
    }
    all
}

/// The half-widths of a hit's intervals, the greatest coordinate's, in model units.
struct Tolerance {
    position: f64,
    normal: Option<f64>,
    curvature: Option<f64>,
}

fn tolerance(stage: &Stage, hit: &Hit) -> Tolerance {
    let scale = stage.scene.frames()[hit.face.0 as usize].scale;
    let enclosures = stage.enclosures(hit, true);
    let enclosure = enclosures.iter().next().expect("a parameter has a span");
    let widest = |intervals: &[Interval]| intervals.iter().fold(0.0, |w: f64, i| w.max(i.half_width + i.packing));
    Tolerance {
        position: enclosure.position.map_or(0.0, |s| widest(&s) * scale),
        normal: enclosure.normal.map(|n| widest(&n)),
        curvature: enclosure.curvature.map(|k| widest(&k) / scale),
    }
}
