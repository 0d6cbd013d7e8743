//! Rates of the rasterizer: the fragment program alone, and whole frames; optionally a picture of what was drawn.
//!
//! `cargo run --release -p raster --example raster_rate [PICTURE.png]`
//!
//! Beside the time by the clock on the wall stands what all threads together took of processors, which does not count what
//! others do on the machine.

use gbuffer::{GBuffer, Meta};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, Surface};
use pipeline::fragment::fragment_row;
use pipeline::{PackedScene, Parameters, Scheme};
use raster::{Drawing, Options, Rasterizer};
use rustix::time::{ClockId, clock_gettime};
use scene::{Camera, Model, Projection, Viewport};
use std::hint::black_box;
use std::time::Instant;
use techniques::fragment::Tessellation;
use techniques::{DEFAULT_CHORD_PX, Limits, Prepared, Setting};

/// A clamped uniform bicubic sheet of `nu` × `nv` control points over a unit square, waves on it, weights not all one.
fn sheet(nu: usize, nv: usize, corner: DVec2, side: f64) -> Surface {
    let knots = |n: usize| {
        let inner = (1..n - 3).map(|i| i as f64 / (n - 3) as f64);
        KnotVector::new(3, [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect()).expect("clamped uniform")
    };
    let mut points = vec![];
    let mut weights = vec![];
    for i in 0..nu {
        for j in 0..nv {
            let at = corner + side * DVec2::new(i as f64 / (nu - 1) as f64, j as f64 / (nv - 1) as f64);
            // Parabolic waves: no sine, so that the picture is the same everywhere.
            let wave = |t: f64| {
                let t = t.rem_euclid(1.0);
                if t < 0.5 { t * (0.5 - t) } else { (t - 0.5) * (t - 1.0) }
            };
            points.push(at.extend(2.0 * wave(2.0 * at.x + at.y) * side.min(1.0) + 1.5 * wave(1.5 * at.y)));
            weights.push(1.0 + 0.02 * ((i + 2 * j) % 3) as f64);
        }
    }
    Surface::new(knots(nu), knots(nv), points, Some(weights)).expect("legal")
}

/// Medians of nine runs, seconds: by the clock on the wall, and by that of the process.
fn medians(run: &mut dyn FnMut()) -> [f64; 2] {
    let process = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    };
    let mut times = [[0.0; 9]; 2];
    for i in 0..9 {
        let (wall, taken) = (Instant::now(), process());
        run();
        (times[0][i], times[1][i]) = (wall.elapsed().as_secs_f64(), process() - taken);
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[4]
    })
}

fn main() {
    let model = Model::of_surfaces("sheet", vec![sheet(14, 6, DVec2::ZERO, 1.0)]).expect("a face");
    let scene = PackedScene::new(&model, Scheme::Specialised).expect("packs");
    for curvature in [false, true] {
        // One span, as most pixels have it.
        let uv = |i: usize| [0.25 + i as f32 * 1e-4, 0.4 + (i % 64) as f32 * 1e-3];
        let places: Vec<_> = (0..4096).map(|i| Parameters { span: [5, 1], uv: uv(i) }).collect();
        let mut out = Vec::with_capacity(places.len());
        let [_, seconds] = medians(&mut || {
            for _ in 0..50 {
                out.clear();
                fragment_row(&scene, 0, black_box(&places), curvature, &mut out);
                black_box(&out);
            }
        });
        let each = seconds / (50 * places.len()) as f64;
        println!("fragment program, bicubic rational, curvature {curvature}: {:.1} ns a fragment", each * 1e9);
    }
    let patches = (0..10_000).map(|i| sheet(4, 4, DVec2::new((i / 100) as f64, (i % 100) as f64) * 0.01, 0.01));
    let many = Model::of_surfaces("10,000 patches", patches.collect()).expect("faces");
    // From above, so near that the model fills the picture.
    let above = |height| {
        let middle = DVec3::new(0.5, 0.5, 0.0);
        Camera::look_at(middle + DVec3::Z, middle, DVec3::Y, Projection::Orthographic { height }).expect("a camera")
    };
    let cases = [
        (&model, 512, 512, None),
        (&model, 512, 512, Some(above(0.9))),
        (&many, 512, 512, None),
        (&many, 1920, 1080, Some(above(0.5))),
    ];
    for (model, width, height, camera) in cases {
        let viewport = Viewport::new(width, height).expect("legal");
        let filled = if camera.is_some() { ", filled" } else { "" };
        let camera = camera.unwrap_or_else(|| Camera::framing(model, viewport));
        let scene = PackedScene::new(model, Scheme::Specialised).expect("packs");
        let views = scene.views(model, &camera, viewport);
        let setting = Setting {
            model,
            scene: &scene,
            camera: &camera,
            viewport,
            chord_px: DEFAULT_CHORD_PX,
            limits: Limits::default(),
            vertex_normals: false,
        };
        let triangles = Tessellation::new(&setting).expect("fits");
        let options = Options::default();
        let drawing = Drawing { scene: &scene, views: &views, camera: &camera, viewport, options };
        let meta = Meta::new("raster", "fragment", model, &camera);
        let frame = || Rasterizer::new(drawing, triangles.visibility(drawing)).render(meta.clone(), &|_| {});
        let picture = frame();
        for threads in [1, rayon::current_num_threads()] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let [seconds, taken] = medians(&mut || {
                pool.install(|| black_box(frame()));
            });
            println!(
                "{}, {width}×{height}{filled}, {} triangles, {} pixels seen, {threads} threads: {:.2} ms a frame, of processors {:.2} ms, {:.0} ns a seen pixel",
                model.name(),
                triangles.triangles(),
                picture.covered(),
                seconds * 1e3,
                taken * 1e3,
                taken * 1e9 / picture.covered() as f64
            );
        }
        if let (Some(path), ("sheet", "")) = (std::env::args().nth(1), (model.name(), filled)) {
            write(&picture, &path);
        }
    }
}

/// Normals as colours, over white.
fn write(picture: &GBuffer, path: &str) {
    let color = |n: DVec3| ((n * 0.5 + 0.5) * 255.0).to_array().map(|c| c as u8);
    let pixels = picture.pixels().flat_map(|hit| match hit {
        Some(hit) => color(hit.normal.unit().unwrap_or(DVec3::ONE)),
        None => [255; 3],
    });
    let (width, height) = (picture.viewport().width() as u32, picture.viewport().height() as u32);
    let image = image::RgbImage::from_raw(width, height, pixels.collect()).expect("three bytes a pixel");
    image.save(path).expect("the picture can be written");
}
