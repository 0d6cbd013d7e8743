//! The rasterizer against geometry worked out by hand: flat plates, whose (u, v) a ray meets in closed form.

use gbuffer::{GBuffer, Hit, Meta};
use glam::{DMat3, DVec2, DVec3};
use nurbs::{KnotVector, Surface};
use pipeline::{PackedScene, Scheme, View};
use raster::clip::{ClipVertex, clip};
use raster::setup::Triangle;
use raster::vertex::{Screen, clip_position};
use raster::{Drawing, Options, Rasterizer};
use scene::{Camera, Model, Projection, Ray, Viewport};
use std::sync::atomic::{AtomicUsize, Ordering};
use techniques::fragment::Tessellation;
use techniques::{DEFAULT_CHORD_PX, Limits, Prepared};

/// A flat parallelogram with linear parameters.
#[derive(Clone, Copy)]
struct Plate {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
}

impl Plate {
    fn surface(&self) -> Surface {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let Self { corner, u, v } = *self;
        Surface::new(knots(), knots(), vec![corner, corner + v, corner + u, corner + u + v], None).unwrap()
    }

    /// (u, v) and distance where a ray meets the plate's plane, in f64.
    fn meet(&self, ray: &Ray) -> (DVec2, f64) {
        let solution = DMat3::from_cols(self.u, self.v, -ray.direction).inverse() * (ray.origin - self.corner);
        (solution.truncate(), solution.z)
    }
}

/// A model with all that a drawing borrows.
struct Setting {
    model: Model,
    scene: PackedScene,
    triangles: Tessellation,
    views: Vec<View>,
    camera: Camera,
    viewport: Viewport,
}

impl Setting {
    fn new(surfaces: Vec<Surface>, camera: Camera, size: [usize; 2], cells: Option<usize>) -> Self {
        let model = Model::of_surfaces("test", surfaces).unwrap();
        let viewport = Viewport::new(size[0], size[1]).unwrap();
        let scene = PackedScene::new(&model, Scheme::Specialised).unwrap();
        let views = scene.views(&model, &camera, viewport);
        let triangles = match cells {
            Some(cells) => Tessellation::uniform(&model, &scene, cells).unwrap(),
            None => {
                let (limits, chord_px) = (Limits::default(), DEFAULT_CHORD_PX);
                let (model, scene, camera) = (&model, &scene, &camera);
                let setting =
                    techniques::Setting { model, scene, camera, viewport, chord_px, limits, vertex_normals: false };
                Tessellation::new(&setting).unwrap()
            }
        };
        Self { model, scene, triangles, views, camera, viewport }
    }

    fn raster(&self, options: Options) -> Rasterizer<'_> {
        let Self { scene, triangles, views, camera, viewport, .. } = self;
        let drawing = Drawing { scene, views, camera, viewport: *viewport, options };
        Rasterizer::new(drawing, triangles.visibility(drawing))
    }

    fn meta(&self) -> Meta {
        Meta::new("raster", "fragment", &self.model, &self.camera)
    }

    fn render(&self, options: Options) -> GBuffer {
        self.raster(options).render(self.meta(), &|_| {})
    }

    fn ray(&self, x: usize, y: usize) -> Ray {
        self.camera.ray(self.viewport, x as f64 + 0.5, y as f64 + 0.5)
    }

    /// How far the hit's position lies off the pixel's ray, in pixels at its depth.
    fn off_ray_px(&self, hit: &Hit, ray: &Ray) -> f64 {
        let q = hit.position - ray.origin;
        let across = (q - ray.direction * q.dot(ray.direction)).length();
        let depth = (hit.position - self.camera.eye()).dot(self.camera.forward());
        across * self.camera.pixels_per_unit(self.viewport, depth)
    }
}

fn look(eye: [f64; 3], target: [f64; 3], projection: Projection) -> Camera {
    Camera::look_at(eye.into(), target.into(), DVec3::Z, projection).unwrap()
}

const WIDE: Projection = Projection::Perspective { fov_deg: 60.0 };

/// A bicubic rational sheet with waves.
fn waves() -> Surface {
    let knots = || {
        let inner = [0.2, 0.4, 0.4, 0.8];
        KnotVector::new(3, [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect()).unwrap()
    };
    let point = |i: usize| {
        let (i, j) = (i / 8, i % 8);
        DVec3::new(i as f64 / 7.0, j as f64 / 7.0, [0.3, -0.1, 0.2, 0.0][(i * 3 + j) % 4])
    };
    let weights = (0..64).map(|i| 1.0 + 0.1 * (i % 3) as f64).collect();
    Surface::new(knots(), knots(), (0..64).map(point).collect(), Some(weights)).unwrap()
}

/// The bound for a plate's hit in pixels off its ray: the f32 path from local coordinates to pixels.
///
/// A clip coordinate is a sum of four terms that are each at most about four times its w for the cameras here, so it is
/// off by at most 4 × 4 roundings of 2⁻²⁴ w; two divisions and the viewport map add three more; half the picture's greater
/// side (pixels) turns that into pixels, twice, as x and y both err, and once more as the fragment program's own
/// position does (local coordinates to 2⁻²², the plate at most twice the picture high).
fn bound_px(viewport: Viewport) -> f64 {
    let side = viewport.width().max(viewport.height()) as f64;
    (4.0 * 4.0 + 3.0) * f64::from(f32::EPSILON) / 2.0 * side / 2.0 * 3.0
}

#[test]
fn interpolation_is_perspective_correct_and_affine_would_not_be() {
    let plate =
        Plate { corner: DVec3::new(-1.0, -1.0, 0.0), u: DVec3::new(2.0, 0.3, 0.1), v: DVec3::new(-0.2, 6.0, 0.4) };
    let camera = look([0.4, -3.0, 1.0], [0.0, 0.5, 0.2], WIDE);
    let setting = Setting::new(vec![plate.surface()], camera, [320, 240], Some(1));
    let buffer = setting.render(Options::default());
    assert!(buffer.covered() > 4_000);
    let bound = bound_px(setting.viewport);
    let mut worst = 0.0f64;
    for y in 0..240 {
        for x in 0..320 {
            let Some(hit) = buffer.get(x, y) else { continue };
            let ray = setting.ray(x, y);
            worst = worst.max(setting.off_ray_px(hit, &ray));
            let (uv, t) = plate.meet(&ray);
            // A pixel is at most this large on the plate: the farthest corner's depth over pixels a unit, foreshortened.
            assert!(uv.distance(hit.uv) < 1e-4 && (t - hit.t).abs() < 1e-3, "{uv} {t} for {hit:?}");
        }
    }
    assert!(worst < bound, "{worst} px off the ray, bound {bound}");

    // The same corners with equal w: linear in the picture. It is wrong by many pixels.
    let screen = Screen::new(setting.viewport);
    let vertices = [0, 1, 2].map(|i| setting.triangles.mesh.vertices[setting.triangles.mesh.indices[i] as usize]);
    let mut corners = vertices.map(|v| screen.corner(clip_position(&setting.views[0], v.position)).unwrap());
    let middle = |axis: usize| corners.iter().map(|c| c.position[axis]).sum::<f32>() / 3.0;
    let (x, y) = (middle(0) as i32, middle(1) as i32);
    let off = |corners| {
        let triangle = Triangle::new(corners, [0.0; 2]).unwrap();
        let [u, v] = triangle.interpolate(triangle.weights(x, y), vertices.map(|v| v.uv));
        let p = plate.corner + plate.u * f64::from(u) + plate.v * f64::from(v);
        setting.camera.project(setting.viewport, p).unwrap().0.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))
    };
    assert!(off(corners) < bound, "{}", off(corners));
    corners.iter_mut().for_each(|c| c.inverse_w = 1.0);
    assert!(off(corners) > 10.0, "{}", off(corners));
}

/// Checks hits and misses of a plate against its plane, but for centres within `edge_px` of an edge or the near plane.
fn check_plate(setting: &Setting, plate: &Plate, edge_px: f64, bound_px: f64) {
    let buffer = setting.render(Options::default());
    let mut seen = 0;
    for y in 0..setting.viewport.height() {
        for x in 0..setting.viewport.width() {
            let ray = setting.ray(x, y);
            let is_on = |ray: &Ray| {
                let (uv, t) = plate.meet(ray);
                t >= ray.near && uv.min_element() >= 0.0 && uv.max_element() <= 1.0
            };
            let around = [[edge_px, 0.0], [-edge_px, 0.0], [0.0, edge_px], [0.0, -edge_px]]
                .map(|[dx, dy]| is_on(&setting.camera.ray(setting.viewport, x as f64 + 0.5 + dx, y as f64 + 0.5 + dy)));
            let hit = buffer.get(x, y);
            if around == [true; 4] || around == [false; 4] {
                assert_eq!(hit.is_some(), is_on(&ray), "pixel {x},{y}");
            }
            if let Some(hit) = hit {
                seen += 1;
                let off = setting.off_ray_px(hit, &ray);
                assert!(off < bound_px, "pixel {x},{y}: {off} px off the ray, bound {bound_px}; {hit:?}");
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn a_plate_through_the_eyes_plane_is_cut_at_the_near_plane() {
    // A floor that reaches from far behind the eye to far ahead, and a camera that looks along it.
    let floor =
        Plate { corner: DVec3::new(-3.0, -20.0, -0.5), u: DVec3::new(7.0, 0.0, 0.0), v: DVec3::new(0.0, 40.0, 0.0) };
    let camera = look([0.0, 0.0, 0.0], [0.1, 1.0, -0.05], WIDE);
    for near in [0.001, 0.9] {
        let camera = camera.with_near(near).unwrap();
        for cells in [1, 5] {
            let setting = Setting::new(vec![floor.surface()], camera, [160, 120], Some(cells));
            // A floor 40 units long under an eye at 0.5: local coordinates are off by 2⁻²⁴ × 40, seen from 0.6 units
            // (the nearest visible) at 104 pixels a unit and unit depth; 8 roundings on the way.
            check_plate(&setting, &floor, 0.02, 8.0 * 40.0 * f64::from(f32::EPSILON) / 2.0 / 0.6 * 104.0);
        }
    }
}

#[test]
fn a_plate_cut_by_hand_at_the_near_plane_shows_the_same() {
    let long = Plate { corner: DVec3::new(-3.0, -20.0, -0.5), u: DVec3::X * 7.0, v: DVec3::Y * 40.0 };
    // Everything visible lies ahead of y = 0.25, where this one starts.
    let cut = Plate { corner: DVec3::new(-3.0, 0.25, -0.5), u: DVec3::X * 7.0, v: DVec3::Y * 19.75 };
    let camera = look([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], WIDE);
    let render =
        |plate: Plate| Setting::new(vec![plate.surface()], camera, [128, 96], Some(1)).render(Options::default());
    let (a, b) = (render(long), render(cut));
    assert!(a.covered() > 4000);
    for (a, b) in a.pixels().zip(b.pixels()) {
        assert_eq!(a.is_some(), b.is_some());
        if let (Some(a), Some(b)) = (a, b) {
            // 8 roundings of 2⁻²⁴ on coordinates up to 20, stretched by the view along the floor: t / 0.5 of it.
            let bound = 8.0 * 20.0 * f64::from(f32::EPSILON) / 2.0 * (1.0 + a.t / 0.5) * (1.0 + a.t / 0.5);
            assert!(a.position.distance(b.position) < bound, "{} {} {bound}", a.position, b.position);
        }
    }
}

#[test]
fn triangles_a_million_pixels_large_stay_in_the_guard_band() {
    let plate = |size: f64| Plate {
        corner: DVec3::new(-0.4 * size, 1.0, -0.6 * size),
        u: DVec3::new(size, 0.0, 0.0),
        v: DVec3::new(0.0, 0.25, size),
    };
    let cameras = [
        (look([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], WIDE), 1e4),
        (look([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], Projection::Orthographic { height: 1e-4 }), 1.0),
    ];
    for (camera, size) in cameras {
        let plate = plate(size);
        let setting = Setting::new(vec![plate.surface()], camera, [120, 100], Some(1));
        let per_unit = setting.camera.pixels_per_unit(setting.viewport, 1.0);
        assert!(per_unit * size > 8e5, "{} pixels", per_unit * size);
        let buffer = setting.render(Options::default());
        assert_eq!(buffer.covered(), 12_000);
        for y in 0..100 {
            for x in 0..120 {
                let ray = setting.ray(x, y);
                let hit = buffer.get(x, y).unwrap();
                let (uv, _) = plate.meet(&ray);
                // Parameters near ½ in f32, off by a few of their own roundings: that is what is left at this size.
                assert!(uv.distance(hit.uv) < 4.0 * f64::from(f32::EPSILON), "{uv} {}", hit.uv);
            }
        }
    }
}

#[test]
fn clipping_a_corner_far_away_keeps_the_visible_part() {
    // One corner 10^6 half pictures to the right: cut at the guard band, on the plane of the triangle.
    let vertex = |x: f32, y: f32, uv| ClipVertex { clip: [x, y, 0.5, 1.0], uv, normal: [0.0; 3] };
    let polygon = clip([vertex(-1.0, -1.0, [0.0, 0.0]), vertex(1e6, 0.0, [1.0, 0.0]), vertex(-1.0, 1.0, [0.0, 1.0])]);
    assert_eq!(polygon.len(), 4);
    assert!(polygon.iter().all(|v| v.clip[0] <= 4.0 * (1.0 + f32::EPSILON)));
}

#[test]
fn at_equal_depth_the_earlier_face_is_seen() {
    let camera = look([1.0, -0.5, 0.7], [0.5, 0.5, 0.0], WIDE);
    let alone = Setting::new(vec![waves()], camera, [96, 64], None).render(Options::default());
    let twice = Setting::new(vec![waves(), waves()], camera, [96, 64], None).render(Options::default());
    assert!(alone.covered() > 1000);
    assert!(alone.pixels().eq(twice.pixels()));
}

#[test]
fn the_nearer_plate_is_seen_whichever_comes_first() {
    let plate = |y: f64| Plate { corner: DVec3::new(-1.0, y, -1.0), u: DVec3::X * 2.0, v: DVec3::Z * 2.0 };
    for projection in [WIDE, Projection::Orthographic { height: 1.5 }] {
        let camera = look([0.0, -2.0, 0.0], [0.0, 0.0, 0.0], projection);
        for (distances, nearer) in [([0.0, 1e-4], 0), ([1e-4, 0.0], 1)] {
            let surfaces = distances.map(|y| plate(y).surface()).to_vec();
            let buffer = Setting::new(surfaces, camera, [64, 64], Some(3)).render(Options::default());
            assert!(buffer.covered() > 2000);
            assert!(buffer.pixels().flatten().all(|hit| hit.face.0 == nearer));
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let camera = look([1.0, -0.5, 0.7], [0.5, 0.5, 0.0], WIDE);
    let setting = Setting::new(vec![waves(), waves()], camera, [333, 201], None);
    let options = Options { curvature: true, vertex_normals: false };
    let render = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| setting.render(options))
    };
    let one = render(1);
    assert!(one.covered() > 8_000);
    // `Debug` prints each float so that it reads back to the same bits, and tells −0 from 0.
    let text = format!("{one:?}");
    for threads in [2, 7] {
        assert!(format!("{:?}", render(threads)) == text, "{threads} threads");
    }
}

#[test]
fn a_sampler_at_pixel_centres_is_the_picture() {
    // The eye above the middle of the sheet, so that triangles are clipped too; two equal sheets, so that depths tie.
    let cameras = [look([1.0, -0.5, 0.7], [0.5, 0.5, 0.0], WIDE), look([0.5, 0.5, 0.3], [0.6, 1.0, 0.1], WIDE)];
    for camera in cameras {
        for vertex_normals in [false, true] {
            let setting = Setting::new(vec![waves(), waves()], camera, [150, 90], None);
            let raster = setting.raster(Options { curvature: true, vertex_normals });
            let buffer = raster.render(setting.meta(), &|_| {});
            assert!(buffer.covered() > 1_500);
            let sampler = raster.sampler();
            for y in 0..90 {
                for x in 0..150 {
                    let sampled = sampler.sample(x as f64 + 0.5, y as f64 + 0.5);
                    assert_eq!(format!("{sampled:?}"), format!("{:?}", buffer.get(x, y).copied()), "pixel {x},{y}");
                }
            }
        }
    }
}

#[test]
fn a_sampler_between_centres_sees_what_stands_there() {
    let plate = Plate { corner: DVec3::new(-0.71, 0.0, -0.6), u: DVec3::new(1.3, 0.4, 0.1), v: DVec3::Z * 1.1 };
    let camera = look([0.3, -2.0, 0.2], [0.0, 0.0, 0.0], WIDE);
    let setting = Setting::new(vec![plate.surface()], camera, [100, 80], Some(2));
    let raster = setting.raster(Options::default());
    let sampler = raster.sampler();
    let (mut seen, mut unseen) = (0, 0);
    for i in 0..20_000 {
        let (x, y) = (f64::from(i * 7919 % 100_003) / 1000.03, f64::from(i * 104_729 % 80_021) / 1000.27);
        let ray = camera.ray(setting.viewport, x, y);
        let (uv, _) = plate.meet(&ray);
        let margin = uv.min(1.0 - uv).min_element();
        let hit = sampler.sample(x, y);
        // The plate is some 60 pixels high: 1e-4 of it is more than the 1/362 pixel by which snapping moves an edge.
        if margin.abs() > 1e-4 {
            assert_eq!(hit.is_some(), margin > 0.0, "{x} {y}: {uv}");
        }
        match hit {
            Some(hit) => {
                seen += 1;
                let off = setting.off_ray_px(&hit, &ray);
                assert!(off < bound_px(setting.viewport), "{off}");
            }
            None => unseen += 1,
        }
    }
    assert!(seen > 2000 && unseen > 2000, "{seen} {unseen}");
    assert_eq!(sampler.sample(-0.1, 10.0), None);
    assert_eq!(sampler.sample(100.0, 10.0), None);
    assert_eq!(sampler.sample(f64::NAN, 10.0), None);
}

#[test]
fn vertex_normals_come_with_the_triangles_points_and_nothing_else_changes() {
    let camera = look([1.0, -0.5, 0.7], [0.5, 0.5, 0.0], WIDE);
    let setting = Setting::new(vec![waves()], camera, [96, 64], Some(4));
    let own = setting.render(Options::default());
    let interpolated = setting.render(Options { vertex_normals: true, ..Options::default() });
    let (mut widest, mut farthest) = (0.0f64, 0.0f64);
    for (a, b) in own.pixels().flatten().zip(interpolated.pixels().flatten()) {
        let (n, m) = (a.normal.unit().unwrap(), b.normal.unit().unwrap());
        assert!((m.length() - 1.0).abs() < 1e-6);
        widest = widest.max(n.distance(m));
        assert_eq!(Hit { normal: a.normal, position: a.position, t: a.t, curvature: a.curvature, ..*b }, *a);
        // The triangle's point is on the pixel's ray, and off the surface by the chord.
        farthest = farthest.max(a.position.distance(b.position));
    }
    // Four cells over a wave: the corners' normals cannot follow it.
    assert!(widest > 0.1 && farthest > 0.01 && farthest < 0.3, "{widest} {farthest}");
}

#[test]
fn no_pixel_between_the_triangles_of_a_face_is_missed() {
    // Seen from straight above, in every chord size: the sheet's projection is the unit square.
    let camera = look([0.5, 0.5001, 3.0], [0.5, 0.5, 0.0], Projection::Orthographic { height: 0.8 });
    for cells in [1, 2, 7, 40, 150] {
        let setting = Setting::new(vec![waves()], camera, [128, 128], Some(cells));
        assert_eq!(setting.render(Options::default()).covered(), 128 * 128, "{cells} cells");
    }
}

#[test]
fn progress_counts_every_pixel() {
    let camera = look([1.0, -0.5, 0.7], [0.5, 0.5, 0.0], WIDE);
    let setting = Setting::new(vec![waves()], camera, [130, 70], None);
    let done = AtomicUsize::new(0);
    setting.raster(Options::default()).render(setting.meta(), &|pixels| {
        done.fetch_add(pixels, Ordering::Relaxed);
    });
    assert_eq!(done.into_inner(), 130 * 70);
}
