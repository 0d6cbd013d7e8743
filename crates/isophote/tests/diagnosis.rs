//! Faults of a whole picture, planted in what another renderer might save: each must be named, and no other.

use compare::{Diagnosis, Verdict};
use gbuffer::{GBuffer, Hit, Meta};
use glam::{DVec3, Vec3Swizzles};
use isophote::compare::Saved;
use isophote::stage::Plan;
use nurbs::{Direction, Normal, Surface, basis_derivatives};
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use std::path::Path;

/// A rational model, seen from where no axis of the camera is one of the world's.
const MODEL: &str = "sphere";

struct Scene {
    model: Model,
    camera: Camera,
    viewport: Viewport,
}

impl Scene {
    fn new(size: [usize; 2]) -> Self {
        let model = models::builtin(MODEL).expect("built in");
        let viewport = Viewport::new(size[0], size[1]).expect("a size");
        let camera = Camera::framing(&model, viewport);
        Self { model, camera, viewport }
    }

    /// What rays of `camera` see through places `offset` pixels beside the centres, as a foreign renderer would save it.
    fn drawn(&self, camera: &Camera, offset: [f64; 2]) -> GBuffer {
        let caster = Caster::new(&self.model);
        let ray =
            |x: usize, y: usize| camera.ray(self.viewport, x as f64 + 0.5 + offset[0], y as f64 + 0.5 + offset[1]);
        self.saved(|x, y| caster.first(&ray(x, y)).hit.map(|hit| Hit { local: None, ..hit }))
    }

    fn saved(&self, pixel: impl Fn(usize, usize) -> Option<Hit>) -> GBuffer {
        let (width, height) = (self.viewport.width(), self.viewport.height());
        let rows = (0..height).map(|y| (0..width).map(|x| pixel(x, y)).collect());
        GBuffer::from_rows(self.viewport, Meta::new("foreign", "fragment", &self.model, &self.camera), rows)
    }

    fn each(&self, buffer: &GBuffer, change: impl Fn(Hit) -> Hit) -> GBuffer {
        self.saved(|x, y| buffer.get(x, y).map(|hit| change(*hit)))
    }

    fn turned(&self, buffer: &GBuffer, turn: impl Fn(DVec3) -> DVec3) -> GBuffer {
        let of = |normal: Normal| match normal {
            Normal::Regular(n) => Normal::Regular(turn(n)),
            Normal::Limit(n) => Normal::Limit(turn(n)),
            Normal::Undefined => Normal::Undefined,
        };
        self.each(buffer, |hit| Hit { normal: of(hit.normal), ..hit })
    }
}

/// What the tool says of a file, and whether it differs.
fn judged(name: &str, buffer: &GBuffer) -> (Verdict, Option<Diagnosis>) {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("diagnosis-{}.npz", name.replace([' ', '/'], "-")));
    buffer.write_npz(&path).expect("a file");
    let saved = Saved::open(&[path], None).unwrap_or_else(|error| panic!("{name}: {error:#}"));
    let found = saved.compare(Plan::default(), None).unwrap_or_else(|error| panic!("{name}: {error:#}"));
    (found.pairs[0].verdict, found.diagnoses[0].clone())
}

#[test]
fn a_picture_without_curvatures_agrees_and_the_plain_line_says_what_was_not_judged() {
    let scene = Scene::new([36, 24]);
    let sound = scene.drawn(&scene.camera, [0.0; 2]);
    let line = |name: &str, buffer: &GBuffer| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("diagnosis-{name}.npz"));
        buffer.write_npz(&path).expect("a file");
        let found = Saved::open(&[path], None).expect("it opens").compare(Plan::default(), None).expect("it is judged");
        assert_eq!(found.pairs[0].verdict, Verdict::Agree, "{name}");
        found.line()
    };
    assert!(!line("with-curvatures", &sound).contains("curvatures"));
    let none = scene.each(&sound, |hit| Hit { curvature: None, ..hit });
    assert!(line("without-curvatures", &none).contains("; no curvatures are given, so none were judged."));
    let half = scene.saved(|x, y| {
        let hit = *sound.get(x, y)?;
        Some(Hit { curvature: hit.curvature.filter(|_| x.is_multiple_of(2)), ..hit })
    });
    assert!(line("half-the-curvatures", &half).contains("; curvatures are given, and were judged, at "));
}

/// A number as 10 bits after the leading one hold it, rounded to the nearest.
fn half(x: f64) -> f64 {
    let bits = (x as f32).to_bits();
    f64::from(f32::from_bits((bits + 0x0fff + (bits >> 13 & 1)) & !0x1fff))
}

fn halves(v: DVec3) -> DVec3 {
    DVec3::new(half(v.x), half(v.y), half(v.z))
}

fn srgb(x: f64) -> f64 {
    let size = x.abs();
    let encoded = if size <= 0.003_130_8 { 12.92 * size } else { 1.055 * size.powf(1.0 / 2.4) - 0.055 };
    encoded.copysign(x)
}

/// The normal of the numerator alone, by the basis functions' own sums.
fn undivided(surface: &Surface, hit: &Hit) -> DVec3 {
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let (k, l) = (ku.find_span(hit.uv.x), kv.find_span(hit.uv.y));
    let (nu, nv) = (basis_derivatives(ku, k, hit.uv.x, 1), basis_derivatives(kv, l, hit.uv.y, 1));
    let weights = surface.weights().expect("a rational surface");
    let sum = |a: usize, b: usize| {
        let mut total = DVec3::ZERO;
        for i in 0..=ku.degree() {
            for j in 0..=kv.degree() {
                let at = (k - ku.degree() + i) * surface.control_counts()[1] + l - kv.degree() + j;
                total += nu[a][i] * nv[b][j] * weights[at] * surface.points()[at];
            }
        }
        total
    };
    sum(1, 0).cross(sum(0, 1)).normalize()
}

#[test]
fn every_planted_fault_of_a_whole_picture_is_named_and_no_other() {
    let scene = Scene::new([72, 48]);
    let Scene { model, camera, viewport } = &scene;
    let sound = scene.drawn(camera, [0.0; 2]);
    assert_eq!(judged("sound", &sound), (Verdict::Agree, None));
    let (width, height) = (viewport.width(), viewport.height());
    let wider = |projection| {
        let other = Camera::look_at(camera.eye(), camera.target(), DVec3::Z, projection).expect("a camera");
        scene.drawn(&other.with_near(camera.near()).expect("a depth"), [0.0; 2])
    };
    let eight = |x: f64| ((x * 0.5 + 0.5) * 255.0).round() / 255.0 * 2.0 - 1.0;
    let of_view = |n: DVec3| DVec3::new(n.dot(camera.right()), n.dot(camera.above()), -n.dot(camera.forward()));
    let faults = [
        ("shifted", scene.drawn(camera, [-0.5, -0.5]), "the picture is shifted by (+0.5, +0.5) px"),
        ("by a column", scene.drawn(camera, [1.0, 0.0]), "the picture is shifted by (-1, +0) px"),
        ("field of view", wider(Projection::Perspective { fov_deg: 43.0 }), "its field of view is 43°, not 40°"),
        (
            "across",
            wider(Projection::Perspective {
                fov_deg: 2.0 * (20f64.to_radians().tan() * height as f64 / width as f64).atan().to_degrees(),
            }),
            "the 40° are meant up the picture, not across it",
        ),
        ("mirrored", scene.saved(|x, y| sound.get(width - 1 - x, y).copied()), "mirrored, left for right"),
        ("rows", scene.saved(|x, y| sound.get(x, height - 1 - y).copied()), "rows are flipped"),
        (
            "transposed",
            scene.saved(|x, y| {
                let i = y * width + x;
                sound.get(i / height, i % height).copied()
            }),
            "arrays are transposed",
        ),
        ("flipped", scene.turned(&sound, |n| -n), "normals are flipped"),
        ("of view", scene.turned(&sound, of_view), "normals are in view space, not in the world's"),
        ("y up", scene.turned(&sound, |n| DVec3::new(n.x, n.z, -n.y)), "(x, z, −y) is stored for (x, y, z)"),
        ("cycled", scene.turned(&sound, |n| n.yzx()), "(y, z, x) is stored for (x, y, z)"),
        (
            "quotient",
            scene.each(&sound, |hit| Hit { normal: Normal::Regular(undivided(model.surface(hit.face), &hit)), ..hit }),
            "normals lack the quotient rule",
        ),
        (
            "srgb",
            scene.each(&sound, |hit| Hit { position: DVec3::from(hit.position.to_array().map(srgb)), ..hit }),
            "positions are sRGB-encoded",
        ),
        (
            "positions of view",
            scene.each(&sound, |hit| Hit { position: of_view(hit.position - camera.eye()), ..hit }),
            "positions are in view space",
        ),
        (
            "halves",
            scene.each(&sound, |hit| Hit { position: halves(hit.position), ..hit }),
            "half floats (16 bits) store pos",
        ),
        (
            "all halves",
            scene.each(&scene.turned(&sound, halves), |hit| Hit {
                position: halves(hit.position),
                uv: hit.uv.to_array().map(half).into(),
                t: half(hit.t),
                ..hit
            }),
            "half floats (16 bits) store u, v, pos, normal, t",
        ),
        ("8 bits", scene.turned(&sound, |n| DVec3::from(n.to_array().map(eight))), "normals are stored in 8 bits"),
    ];
    for (name, buffer, words) in &faults {
        let (verdict, diagnosis) = judged(name, buffer);
        assert_eq!(verdict, Verdict::Differ, "{name}");
        let said = diagnosis.map_or("nothing".to_owned(), |diagnosis| diagnosis.to_string());
        assert!(said.contains(words), "{name}: {said}");
    }
}

/// A cause is named only where undoing it makes the pixels agree.
#[test]
fn what_no_one_fault_explains_is_named_by_none() {
    let scene = Scene::new([48, 48]);
    let sound = scene.drawn(&scene.camera, [0.0; 2]);
    let noise = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 97) as f64 / 97.0 - 0.5;
    let bent = |tilt: f64| {
        scene.saved(|x, y| {
            sound.get(x, y).map(|hit| {
                let n = hit.normal.unit().map(|n| (n + tilt * noise(x, y) * DVec3::X).normalize());
                Hit { normal: n.map_or(Normal::Undefined, Normal::Regular), ..*hit }
            })
        })
    };
    let both = scene.turned(&scene.drawn(&scene.camera, [0.5, 0.5]), |n| -n);
    let wrong = [
        ("noise", bent(0.1)),
        ("noise and flipped", scene.turned(&bent(0.1), |n| -n)),
        ("shifted and flipped", both),
        ("exchanged", scene.each(&sound, |hit| Hit { uv: [hit.uv.y, hit.uv.x].into(), ..hit })),
        ("scaled", scene.each(&sound, |hit| Hit { position: 1.01 * hit.position, ..hit })),
    ];
    for (name, buffer) in &wrong {
        assert_eq!(judged(name, buffer), (Verdict::Differ, None), "{name}");
    }
}
