//! The walls of holes that are few pixels wide, seen from the side: nothing of a wall is shown through the plane before it.
//!
//! Where the far border of a wall turns away from the camera, its skirt comes up to the plane, and shows a place of the wall that
//! is far behind.

mod common;

use common::software;
use compare::{Deviation, Interpolation, Judge, PairReport, Sampler, Verdict};
use gbuffer::{GBuffer, Hit, Meta};
use glam::{DVec2, DVec3, dvec2};
use gpu::{Atomics, Drawable, Overrides, Renderer, RendererOptions};
use nurbs::{KnotVector, Surface};
use pipeline::wgsl::{self, Variant};
use pipeline::{PackedScene, Scheme, View};
use raster::{Drawing, Rasterizer};
use raycast::Caster;
use scene::{Camera, Face, Loop, Model, Trim, Viewport};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI, SQRT_2, TAU};
use std::sync::Arc;
use techniques::{ByCompute, Limits, Prepared, Setting};

/// Holes along each side of a plate of size 1.
const HOLES: usize = 6;

/// The error of the triangles, pixels.
const CHORD_PX: f64 = 0.25;

/// What is sunk into a plate, at 6 × 6 places of other sizes and turns.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// A hole, its wall two halves of a cylinder.
    Hole,
    /// A slot, its wall two halves of cylinders and two planes.
    Slot,
    /// A hole, a step in it, and a narrower hole.
    Stepped,
}

fn clamped(degree: usize) -> KnotVector {
    KnotVector::new(degree, [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat()).expect("legal")
}

fn curve(points: &[DVec2], weights: Option<Vec<f64>>) -> Trim {
    Trim::new(clamped(points.len() - 1), points.to_vec(), weights)
}

/// The quarter of a circle that runs clockwise from an angle.
fn quarter(center: DVec2, radius: f64, start: f64) -> Trim {
    let at = |angle: f64, reach: f64| center + radius * reach * DVec2::from_angle(angle);
    let points = [at(start, 1.0), at(start - FRAC_PI_4, SQRT_2), at(start - FRAC_PI_2, 1.0)];
    curve(&points, Some(vec![1.0, FRAC_1_SQRT_2, 1.0]))
}

/// A circle, clockwise, and as an outer loop the same from its other side.
fn circle(center: DVec2, radius: f64) -> Vec<Trim> {
    (0..4).map(|k| quarter(center, radius, -FRAC_PI_2 * f64::from(k))).collect()
}

fn reversed(trims: Vec<Trim>) -> Vec<Trim> {
    trims.into_iter().rev().map(|trim| Trim { reversed: !trim.reversed, ..trim }).collect()
}

fn inner(trims: Vec<Trim>) -> Loop {
    Loop { outer: false, trims }
}

/// The border of a domain from 0 to 1.
fn border() -> Loop {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
    Loop { outer: true, trims: (0..4).map(|k| curve(&[corners[k], corners[(k + 1) % 4]], None)).collect() }
}

fn parallelogram(corner: DVec3, u: DVec3, v: DVec3) -> Surface {
    Surface::new(clamped(1), clamped(1), vec![corner, corner + v, corner + u, corner + u + v], None).expect("legal")
}

/// Half a cylinder about z, counterclockwise from an angle, between two heights.
fn half(center: DVec2, radius: f64, start: f64, heights: [f64; 2]) -> Surface {
    let around = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).expect("legal");
    let reach = |k: usize| [1.0, SQRT_2][k % 2];
    let at = |k: usize| center + radius * reach(k) * DVec2::from_angle(start + FRAC_PI_4 * k as f64);
    let points = (0..5).flat_map(|k| heights.map(|z| at(k).extend(z))).collect();
    let weights = (0..5).flat_map(|k| [1.0 / reach(k); 2]).collect();
    Surface::new(around, clamped(1), points, Some(weights)).expect("legal")
}

fn plate(kind: Kind) -> Model {
    let mut surfaces = vec![parallelogram(DVec3::ZERO, DVec3::X, DVec3::Y)];
    let mut faces = vec![vec![border()]];
    let mut add = |surface: Surface, loops: Vec<Loop>| {
        surfaces.push(surface);
        faces.push(loops);
    };
    let mut cuts = vec![];
    for k in 0..HOLES * HOLES {
        let share = |step: f64| (step * k as f64).fract();
        let center = dvec2((k / HOLES) as f64 + 0.5, (k % HOLES) as f64 + 0.5) / HOLES as f64;
        let radius = (0.02 + 0.04 * share(0.618034)) * if kind == Kind::Slot { 0.6 } else { 1.0 };
        let depth = radius * (0.2 + 0.8 * share(0.754878));
        let turn = TAU * share(0.569840);
        let corner = |x: f64, y: f64, z: f64| (center + radius * dvec2(x, y)).extend(z);
        if kind == Kind::Slot {
            let ends = [(1.0, -FRAC_PI_2), (-1.0, FRAC_PI_2)];
            for (side, start) in ends {
                add(half(center + dvec2(side * radius, 0.0), radius, start, [-depth, 0.0]), vec![border()]);
            }
            for y in [1.0, -1.0] {
                let side = parallelogram(corner(-1.0, y, -depth), 2.0 * radius * DVec3::X, depth * DVec3::Z);
                add(side, vec![border()]);
            }
            let at = |x: f64, y: f64| center + radius * dvec2(x, y);
            let end = |side: f64, start: f64| {
                let middle = center + dvec2(side * radius, 0.0);
                [quarter(middle, radius, start), quarter(middle, radius, start - FRAC_PI_2)]
            };
            let mut cut = vec![curve(&[at(-1.0, 1.0), at(1.0, 1.0)], None)];
            cut.extend(end(1.0, FRAC_PI_2));
            cut.push(curve(&[at(1.0, -1.0), at(-1.0, -1.0)], None));
            cut.extend(end(-1.0, -FRAC_PI_2));
            cuts.push(inner(cut));
            continue;
        }
        for side in [0.0, PI] {
            add(half(center, radius, turn + side, [-depth, 0.0]), vec![border()]);
        }
        cuts.push(inner(circle(center, radius)));
        if kind == Kind::Stepped {
            let step = parallelogram(corner(-1.0, -1.0, -depth), 2.0 * radius * DVec3::X, 2.0 * radius * DVec3::Y);
            let middle = DVec2::splat(0.5);
            let rim = Loop { outer: true, trims: reversed(circle(middle, 0.5)) };
            add(step, vec![rim, inner(circle(middle, 0.25))]);
            for side in [0.0, PI] {
                add(half(center, radius / 2.0, turn + 1.0 + side, [-1.5 * depth, -depth]), vec![border()]);
            }
        }
    }
    faces[0].extend(cuts);
    let faces = faces.into_iter().enumerate().map(|(k, loops)| Face { loops, ..Face::whole(k) }).collect();
    Model::new("plate", surfaces, faces).expect("legal")
}

/// What is seen, by which technique, at how many pixels, and from where: degrees about z from the front, and above the horizon.
/// Pixels of each showed a wall through a plane while skirts had the depth of their triangles.
const VIEWS: [(Kind, &str, [usize; 2], [f64; 2]); 8] = [
    (Kind::Hole, "fragment", [96, 72], [68.0, 56.0]),
    (Kind::Hole, "fragment", [64, 48], [224.0, 62.0]),
    (Kind::Hole, "grid", [64, 48], [280.0, 64.0]),
    (Kind::Slot, "fragment", [96, 72], [206.0, 46.0]),
    (Kind::Slot, "grid", [64, 48], [28.0, 50.0]),
    (Kind::Stepped, "fragment", [64, 48], [224.0, 62.0]),
    (Kind::Stepped, "grid", [64, 48], [333.0, 56.0]),
    (Kind::Stepped, "zones", [64, 48], [162.0, 58.0]),
];

/// A plate in a view, packed.
struct Shot<'m> {
    model: &'m Model,
    scene: PackedScene,
    camera: Camera,
    viewport: Viewport,
    views: Vec<View>,
    prepared: Arc<dyn Prepared>,
}

impl<'m> Shot<'m> {
    fn new(model: &'m Model, technique: &str, [width, height]: [usize; 2], [azimuth, elevation]: [f64; 2]) -> Self {
        let viewport = Viewport::new(width, height).expect("a legal size");
        let [azimuth, elevation] = [azimuth, elevation].map(f64::to_radians);
        let level = dvec2(azimuth.sin(), -azimuth.cos()) * elevation.cos();
        let camera = Camera::framing_from(model, viewport, level.extend(elevation.sin())).expect("legal");
        let scene = PackedScene::new(model, Scheme::Specialised).expect("it packs");
        let (limits, vertex_normals) = (Limits::default(), false);
        let setting =
            Setting { model, scene: &scene, camera: &camera, viewport, chord_px: CHORD_PX, limits, vertex_normals };
        let prepared = techniques::named(technique).expect("a technique").prepare(&setting).expect("few triangles");
        let views = scene.views(model, &camera, viewport);
        Self { model, scene, camera, viewport, views, prepared }
    }

    fn meta(&self, renderer: &str) -> Meta {
        Meta::new(renderer, self.prepared.technique(), self.model, &self.camera)
    }

    fn by_raster(&self) -> GBuffer {
        let Self { scene, camera, viewport, views, prepared, .. } = self;
        let options = raster::Options { curvature: true, vertex_normals: false };
        let drawing = Drawing { scene, views, camera, viewport: *viewport, options };
        Rasterizer::new(drawing, prepared.visibility(drawing)).render(self.meta("raster"), &|_| {})
    }

    fn by_gpu(&self, drawn: &dyn Drawable, source: &dyn Fn(Variant) -> String) -> GBuffer {
        let device = software();
        let overrides = Overrides { source: Some(source), ..Overrides::default() };
        let options = RendererOptions { overrides, ..RendererOptions::default() };
        let mut renderer = Renderer::new(&device, &self.scene, drawn, options).expect("it fits");
        renderer.gbuffer(&self.views, &self.camera, self.viewport, self.meta("gpu")).expect("drawn")
    }

    /// A picture against rays, by what the technique claims.
    fn judged(&self, shown: &GBuffer) -> PairReport {
        let rays = Rays { caster: Caster::new(self.model), camera: self.camera, viewport: self.viewport };
        let [width, height] = [self.viewport.width(), self.viewport.height()];
        let row = |y: usize| (0..width).map(|x| rays.first(x as f64 + 0.5, y as f64 + 0.5)).collect::<Vec<_>>();
        let reference = GBuffer::from_rows(self.viewport, self.meta("raycast"), (0..height).map(row));
        let claims = techniques::named(self.prepared.technique()).expect("a technique").claims();
        let interpolation = Interpolation::of(self.model);
        let deviation = Deviation::against_surface(claims, &interpolation, self.prepared.chord(), CHORD_PX);
        let judge = Judge::new(self.model, &self.camera, self.viewport, &self.scene);
        judge.pair(&reference, &rays, shown, &deviation, true, &|_| {}).expect("comparable")
    }
}

/// The ray caster, asked at any position.
struct Rays<'m> {
    caster: Caster<'m>,
    camera: Camera,
    viewport: Viewport,
}

impl Sampler for Rays<'_> {
    fn first(&self, x: f64, y: f64) -> Option<Hit> {
        self.caster.first(&self.camera.ray(self.viewport, x, y)).hit
    }

    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.caster.all(&self.camera.ray(self.viewport, x, y)).hits
    }
}

#[test]
fn no_wall_of_a_hole_is_shown_through_what_is_before_it() {
    for (kind, technique, size, view) in VIEWS {
        let model = plate(kind);
        let shot = Shot::new(&model, technique, size, view);
        let what = format!("{kind:?} by {technique} at {size:?} from {view:?}");
        let raster = shot.by_raster();
        assert!(raster.covered() > 500, "{what}");
        let report = shot.judged(&raster);
        assert_eq!(report.verdict, Verdict::Agree, "{what}, raster: {:?}", report.worst);
        let kernels = ByCompute::new(shot.prepared.clone(), Atomics::Bits32).expect("it has triangles");
        let drawn: [(&str, &dyn Drawable); 2] = [("fragment stage", &*shot.prepared), ("kernels", &kernels)];
        for (path, drawn) in drawn {
            let gpu = shot.by_gpu(drawn, &wgsl::source);
            assert!(gpu.covered().abs_diff(raster.covered()) <= 2, "{what}, {path}");
            let report = shot.judged(&gpu);
            assert_eq!(report.verdict, Verdict::Agree, "{what}, {path}: {:?}", report.worst);
        }
    }
}

#[test]
fn skirts_at_the_depth_of_their_triangles_show_walls_through_planes() {
    let faults = [
        (false, ["g.shape, skirt_depth(out, in.clip.z))", "g.shape, in.clip.z)"]),
        (true, ["select(made.order, of_skirt, made.on_skirt)", "made.order"]),
    ];
    for (by_kernels, [right, wrong]) in faults {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(right), "{right}");
            source.replace(right, wrong)
        };
        let found = |(kind, technique, size, view): (Kind, &str, [usize; 2], [f64; 2])| {
            let model = plate(kind);
            let shot = Shot::new(&model, technique, size, view);
            let kernels = ByCompute::new(shot.prepared.clone(), Atomics::Bits32).expect("it has triangles");
            let drawn: &dyn Drawable = if by_kernels { &kernels } else { &*shot.prepared };
            shot.judged(&shot.by_gpu(drawn, &source)).differing()
        };
        let found = [VIEWS[0], VIEWS[4], VIEWS[6]].map(found);
        assert!(found.iter().all(|&count| count > 0), "{wrong}: {found:?}");
    }
}
