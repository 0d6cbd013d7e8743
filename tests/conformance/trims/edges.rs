//! Trim edges that pixels record, and pictures blended along them.

use compare::{Cause, PairReport, Verdict};
use gbuffer::{EDGE_REACH_PX, GBuffer, Hit, Meta, Picture};
use glam::{DVec2, DVec3};
use isophote::stage::{Plan, Stage};
use nurbs::{KnotVector, Surface};
use pipeline::Parameters;
use pipeline::edge::{edge, packed, unpacked};
use raycast::Caster;
use scene::{Camera, Face, FaceId, Loop, Model, Projection, Trim, Viewport};
use techniques::Technique;

/// Side of the pictures, pixels.
const SIDE: usize = 48;

const ADAPTER: &str = "a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`";

fn viewport() -> Viewport {
    Viewport::new(SIDE, SIDE).expect("a legal size")
}

fn plan(technique: &'static dyn Technique) -> Plan {
    Plan { technique, edges: true, ..Plan::default() }
}

fn bezier(points: &[DVec2], weights: Option<Vec<f64>>) -> Trim {
    let p = points.len() - 1;
    let knots = KnotVector::new(p, [vec![0.0; p + 1], vec![1.0; p + 1]].concat()).expect("legal");
    Trim::new(knots, points.to_vec(), weights)
}

fn polygon(corners: &[DVec2]) -> Vec<Trim> {
    (0..corners.len()).map(|i| bezier(&[corners[i], corners[(i + 1) % corners.len()]], None)).collect()
}

fn square(center: DVec2, half: f64) -> Vec<Trim> {
    polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| center + half * DVec2::new(x, y)))
}

fn disc(center: DVec2, radius: f64) -> Vec<Trim> {
    let at = |x: f64, y: f64| center + radius * DVec2::new(x, y);
    let weights = || Some(vec![1.0, std::f64::consts::FRAC_1_SQRT_2, 1.0]);
    let quarter = |(a, b): (f64, f64)| bezier(&[at(a, b), at(a - b, a + b), at(-b, a)], weights());
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(quarter).to_vec()
}

/// The plane z = tilt · x over 0 … SIDE squared, where (x, y) = (u, v) and, seen from above, a pixel is a unit.
fn plane(tilt: f64) -> Surface {
    let side = SIDE as f64;
    let knots = || KnotVector::new(1, vec![0.0, 0.0, side, side]).expect("legal");
    let points = [(0.0, 0.0), (0.0, side), (side, 0.0), (side, side)];
    let points = points.map(|(x, y)| DVec3::new(x, y, tilt * x)).to_vec();
    Surface::new(knots(), knots(), points, None).expect("legal")
}

fn face(surface: usize, loops: Vec<(bool, Vec<Trim>)>) -> Face {
    let loops = loops.into_iter().map(|(outer, trims)| Loop { outer, trims }).collect();
    Face { loops, ..Face::whole(surface) }
}

/// Looks straight down; `turn` radians off the rows of pixels.
fn from_above(turn: f64) -> Camera {
    let center = DVec3::new(SIDE as f64 / 2.0, SIDE as f64 / 2.0, 0.0);
    let up = DVec3::new(-turn.sin(), turn.cos(), 0.0);
    let projection = Projection::Orthographic { height: SIDE as f64 };
    Camera::look_at(center + 1000.0 * DVec3::Z, center, up, projection).expect("legal")
}

/// All that a model may bring: a disc with square holes, one smaller than a pixel and one a slit, and an edge along u.
fn assorted() -> Model {
    let at = DVec2::new;
    let slit = [(15.2, 8.1), (33.0, 8.1), (33.0, 8.9), (15.2, 8.9)].map(|(x, y)| at(x, y));
    let loops = vec![
        (true, disc(at(24.0, 24.0), 22.3)),
        (false, square(at(20.53, 20.4), 4.1)),
        (false, square(at(30.3, 31.2), 0.21)),
        (false, polygon(&slit)),
    ];
    Model::new("assorted", vec![plane(0.0)], vec![face(0, loops)]).expect("legal")
}

/// The distance of a point from the nearest edge of [`assorted`].
fn distance(p: DVec2) -> f64 {
    let of_box = |center: DVec2, half: DVec2| {
        let q = (p - center).abs() - half;
        q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
    };
    let at = DVec2::new;
    let all = [
        22.3 - p.distance(at(24.0, 24.0)),
        of_box(at(20.53, 20.4), DVec2::splat(4.1)),
        of_box(at(30.3, 31.2), DVec2::splat(0.21)),
        of_box(at(24.1, 8.5), at(8.9, 0.4)),
    ];
    all.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn every_renderer_records_the_distance_of_the_nearest_edge_however_small_what_it_bounds() {
    let device = gpu::Device::open(None).expect(ADAPTER);
    let model = assorted();
    let caster = Caster::new(&model).with_edges(true);
    for turn in [0.0, 0.37] {
        let camera = from_above(turn);
        let mut buffers = vec![];
        for &technique in techniques::ALL {
            let stage = Stage::new(&model, camera, viewport(), plan(technique)).expect("a stage");
            buffers.push(stage.raster());
            buffers.push(stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer);
            buffers.push(stage.raycast(&caster));
        }
        for buffer in buffers {
            let name = (&buffer.meta().renderer, &buffer.meta().technique);
            let mut recorded = 0;
            for (i, hit) in buffer.pixels().enumerate().filter_map(|(i, hit)| Some((i, hit?))) {
                let ray = camera.ray(viewport(), (i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5);
                let expected = distance(ray.origin.truncate());
                match hit.edge {
                    Some(edge) => {
                        recorded += 1;
                        let error = (edge.length() - expected).abs();
                        assert!(error < 2e-4, "{name:?}, pixel {i}: {edge}, {expected}");
                    }
                    None => assert!(EDGE_REACH_PX - 2e-4 < expected, "{name:?}, pixel {i}: {expected}"),
                }
            }
            assert!(recorded > 200, "{name:?}: {recorded}");
        }
    }
}

/// What differs, in words.
fn words(name: &str, pair: &PairReport) -> Option<String> {
    let worst: Vec<String> =
        pair.worst.iter().take(4).map(|p| format!("({}, {}) {:?}: {}", p.x, p.y, p.cause, p.detail)).collect();
    let (a, b) = (&pair.reference, &pair.candidate);
    (pair.verdict != Verdict::Agree).then(|| format!("{name}: {a} | {b}: {:?}\n{}", pair.causes, worst.join("\n")))
}

/// The ray caster's own buffer as another renderer's, which can be judged.
fn as_candidate(buffer: &GBuffer) -> GBuffer {
    buffer.clone().with_meta(Meta { renderer: "rays judged".to_owned(), ..buffer.meta().clone() })
}

#[test]
fn all_three_record_what_the_judge_finds_on_every_trimmed_model() {
    let device = gpu::Device::open(None).expect(ADAPTER);
    let mut found = vec![];
    let mut recorded = 0;
    for (name, _) in models::TRIMMED {
        let model = models::builtin(name).expect("built in");
        let caster = Caster::new(&model).with_edges(true);
        for &technique in techniques::ALL {
            let camera = Camera::framing(&model, viewport());
            let stage = Stage::new(&model, camera, viewport(), plan(technique)).expect("a stage");
            let (raycast, raster) = (stage.raycast(&caster), stage.raster());
            let mut pairs = vec![
                stage.against_raycast(&caster, &raycast, &raster),
                stage.against_raycast(&caster, &raycast, &as_candidate(&raycast)),
            ];
            // A software adapter takes seconds to compile the kernels of technique `exact`.
            if technique == techniques::ALL[0] || *name == "islands" {
                let on_gpu = stage.gpu(&device, None, gpu::Overrides::default()).expect("the GPU draws").gbuffer;
                pairs.push(stage.against_raycast(&caster, &raycast, &on_gpu));
                pairs.push(stage.against_raster(&raster, &on_gpu));
            }
            let pairs: Vec<PairReport> = pairs.into_iter().map(|pair| pair.expect("comparable")).collect();
            recorded += pairs.iter().map(|pair| pair.edges.expect("asked for").recorded).min().expect("some");
            found.extend(pairs.iter().filter_map(|pair| words(name, pair)));
        }
    }
    assert!(found.is_empty(), "{} pairs differ\n{}", found.len(), found.join("\n"));
    assert!(recorded > 1000, "{recorded}");
}

#[test]
fn the_program_in_wgsl_records_the_edge_of_the_program_in_rust() {
    let device = gpu::Device::open(None).expect(ADAPTER);
    for name in ["plate", "islands"] {
        let model = models::builtin(name).expect("built in");
        for &technique in techniques::ALL {
            let camera = Camera::framing(&model, viewport());
            let stage = Stage::new(&model, camera, viewport(), plan(technique)).expect("a stage");
            let options = gpu::RendererOptions::default();
            let mut renderer =
                gpu::Renderer::new(&device, &stage.scene, &*stage.prepared, options).expect("it is taken");
            let fragments = renderer.fragments(&stage.views, viewport()).expect("it draws");
            let mut recorded = 0;
            for (i, fragment) in fragments.iter().enumerate().filter_map(|(i, f)| Some((i, f.as_ref()?))) {
                let view = &stage.views[fragment.face as usize];
                let at = [(i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5];
                let whole = stage.scene.whole(fragment.face, Parameters { span: fragment.span, uv: fragment.uv });
                let expected = edge(&stage.scene, view, fragment.face, whole, at);
                let expected = unpacked(packed(expected)).1;
                recorded += usize::from(expected.is_some());
                // An adapter may fuse and round otherwise, and find the foot on the next chord; a slip shows by more.
                let near = match (fragment.edge, expected) {
                    (Some(a), Some(b)) => {
                        let [a, b] = [a, b].map(|edge| DVec2::from_array(edge.map(f64::from)));
                        (a.length() - b.length()).abs() < 1e-3 && a.distance(b) < 1e-2
                    }
                    (a, b) => a == b,
                };
                assert!(near, "{name} {technique:?} {i}: {:?}, {expected:?}", fragment.edge);
            }
            assert!(recorded > 50, "{name}: {recorded}");
        }
    }
}

/// What is made of an edge.
type Change = fn(DVec2) -> Option<DVec2>;

/// A buffer with its edges changed, and how many are.
fn changed(buffer: &GBuffer, change: Change) -> (GBuffer, usize) {
    let mut count = 0;
    let mut each = |hit: Option<&Hit>| {
        hit.map(|hit| {
            // Where a half-turn or twice the way would come to an edge as well, there is no fault.
            let edge = hit.edge.filter(|edge| (0.15..0.45).contains(&edge.length()));
            count += usize::from(edge.is_some());
            Hit { edge: edge.map_or(hit.edge, change), ..*hit }
        })
    };
    let rows: Vec<Vec<_>> = (0..SIDE).map(|y| (0..SIDE).map(|x| each(buffer.get(x, y))).collect()).collect();
    (GBuffer::from_rows(buffer.viewport(), buffer.meta().clone(), rows).with_edges(true), count)
}

#[test]
fn a_wrong_edge_is_a_difference_of_the_trim() {
    let model = Model::new("disc", vec![plane(0.3)], vec![face(0, vec![(true, disc(DVec2::splat(24.0), 20.3))])]);
    let model = model.expect("legal");
    let caster = Caster::new(&model);
    for &technique in techniques::ALL {
        let stage = Stage::new(&model, from_above(0.2), viewport(), plan(technique)).expect("a stage");
        let (raycast, raster) = (stage.raycast(&caster), stage.raster());
        let differing = |candidate: &GBuffer| {
            let pair = stage.against_raycast(&caster, &raycast, candidate).expect("comparable");
            (pair.differing(), pair.causes.keys().copied().collect::<Vec<_>>())
        };
        assert_eq!(differing(&raster), (0, vec![]));
        let faults: [(&str, Change); 5] = [
            ("turned about", |edge| Some(-edge)),
            ("twice as long", |edge| Some(2.0 * edge)),
            ("none", |_| None),
            ("at a right angle", |edge| Some(edge.perp())),
            ("a tenth of a pixel longer", |edge| Some(edge + 0.1 * edge.normalize())),
        ];
        for (name, fault) in faults {
            let (buffer, count) = changed(&raster, fault);
            assert!(count > 20, "{count}");
            assert_eq!(differing(&buffer), (count, vec![Cause::Trim]), "{name}");
        }
        // An edge, but not the nearest: that of the face without its hole.
        let with_hole = |holes: Vec<(bool, Vec<Trim>)>| {
            let loops = [vec![(true, disc(DVec2::splat(24.0), 20.3))], holes].concat();
            Model::new("disc", vec![plane(0.3)], vec![face(0, loops)]).expect("legal")
        };
        let near_the_rim = vec![(false, disc(DVec2::new(24.0, 43.0), 0.6))];
        let model = with_hole(near_the_rim);
        let caster = Caster::new(&model);
        let holed = Stage::new(&model, from_above(0.2), viewport(), plan(technique)).expect("a stage");
        let (raycast, sound) = (holed.raycast(&caster), holed.raster());
        let other = |x: usize, y: usize| {
            let hit = sound.get(x, y)?;
            Some(Hit { edge: raster.get(x, y).and_then(|other| other.edge), ..*hit })
        };
        let rows: Vec<Vec<_>> = (0..SIDE).map(|y| (0..SIDE).map(|x| other(x, y)).collect()).collect();
        let wrong = GBuffer::from_rows(viewport(), sound.meta().clone(), rows).with_edges(true);
        let pair = holed.against_raycast(&caster, &raycast, &wrong).expect("comparable");
        assert!(pair.differing() >= 3 && pair.causes.keys().all(|cause| *cause == Cause::Trim), "{:?}", pair.causes);
    }
    // And where there is none at all.
    let whole = Model::of_surfaces("whole", vec![plane(0.3)]).expect("legal");
    let caster = Caster::new(&whole);
    let stage =
        Stage::new(&whole, from_above(0.2), viewport(), plan(&techniques::fragment::Fragment)).expect("a stage");
    let (raycast, raster) = (stage.raycast(&caster), stage.raster());
    let rows: Vec<Vec<_>> = (0..SIDE)
        .map(|y| (0..SIDE).map(|x| raster.get(x, y).map(|hit| Hit { edge: Some(DVec2::X), ..*hit })).collect())
        .collect();
    let wrong = GBuffer::from_rows(viewport(), raster.meta().clone(), rows).with_edges(true);
    let pair = stage.against_raycast(&caster, &raycast, &wrong).expect("comparable");
    assert_eq!((pair.differing(), pair.main_cause()), (raster.covered(), Some(Cause::Trim)));
}

/// The area of a disc by what each pixel is covered, and by pixels' centres; and the exact one.
fn areas(radius: f64, side: usize) -> [f64; 3] {
    let model = Model::new("disc", vec![plane(0.0)], vec![face(0, vec![(true, disc(DVec2::splat(24.1), radius))])]);
    let model = model.expect("legal");
    let viewport = Viewport::new(side, side).expect("a legal size");
    let camera = from_above(0.3);
    let stage = Stage::new(&model, camera, viewport, plan(&techniques::fragment::Fragment)).expect("a stage");
    let buffer = stage.raster();
    let mut covered = 0.0;
    for y in 0..side {
        for x in 0..side {
            let parts = buffer.mixture(&camera, x, y).parts;
            covered +=
                parts.iter().filter(|([x, y], _)| buffer.get(*x, *y).is_some()).map(|(_, part)| part).sum::<f64>();
        }
    }
    let pixel = (SIDE as f64 / side as f64).powi(2);
    [covered * pixel, buffer.covered() as f64 * pixel, std::f64::consts::PI * radius * radius]
}

#[test]
fn the_area_of_a_disc_by_coverage_converges_with_far_less_error_than_by_pixels() {
    let mut hard_of_all = 0.0;
    let mut soft_of_all = 0.0;
    for side in [16, 32, 64, 128] {
        for k in 0..6 {
            let radius = 15.0 + 0.731 * f64::from(k);
            let [soft, hard, exact] = areas(radius, side);
            let pixel = SIDE as f64 / side as f64;
            // A straight edge is off the circle by x² / 2 radius at x from where it touches, and stands for the circle within
            // a pixel of there: on average pixel² / 6 radius along all of it.
            let bound = std::f64::consts::TAU * radius * pixel * pixel / (6.0 * radius);
            assert!((soft - exact).abs() <= bound, "{side}, {radius}: {soft} of {exact}, bound {bound}");
            soft_of_all += (soft - exact).abs() / (pixel * pixel);
            hard_of_all += (hard - exact).abs() / (pixel * pixel);
        }
    }
    assert!(soft_of_all * 5.0 < hard_of_all, "{soft_of_all} and {hard_of_all}");
}

#[test]
fn two_faces_that_share_an_edge_at_a_slope_show_no_third_colour() {
    let side = SIDE as f64;
    // A line that is not along the rows of pixels, on a plane that leans.
    let (a, b) = (DVec2::new(13.3, 0.0), DVec2::new(31.9, side));
    let left = polygon(&[DVec2::ZERO, a, b, DVec2::new(0.0, side)]);
    let right = polygon(&[a, DVec2::new(side, 0.0), DVec2::new(side, side), b]);
    let faces = vec![face(0, vec![(true, left)]), face(0, vec![(true, right)])];
    let model = Model::new("halves", vec![plane(0.8)], faces).expect("legal");
    let camera = from_above(0.3);
    let (red, green) = ([200, 20, 20], [20, 180, 20]);
    let caster = Caster::new(&model).with_edges(true);
    for &technique in techniques::ALL {
        let stage = Stage::new(&model, camera, viewport(), plan(technique)).expect("a stage");
        for buffer in [stage.raster(), stage.raycast(&caster)] {
            let colour =
                |hit: Option<&Hit>| hit.map_or([0, 0, 255], |hit| if hit.face == FaceId(0) { red } else { green });
            let picture = Picture::new(SIDE, SIDE, buffer.pixels().map(colour).collect()).expect("a picture");
            let resolved = buffer.resolved(&picture, &camera).expect("the same size");
            let mut mixed = 0;
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let p = camera.ray(viewport(), x as f64 + 0.5, y as f64 + 0.5).origin.truncate();
                    // Away from the outer border, where the background is next.
                    if (p - side / 2.0).abs().max_element() > side / 2.0 - 3.0 {
                        continue;
                    }
                    let mixture = buffer.mixture(&camera, x, y);
                    let of_red = |([x, y], part): &([usize; 2], f64)| {
                        if buffer.get(*x, *y).is_some_and(|hit| hit.face == FaceId(0)) { *part } else { 0.0 }
                    };
                    let share: f64 = mixture.parts.iter().map(of_red).sum();
                    // The line in the picture, which is turned by 0.3; the part of a pixel on its left.
                    let normal = (b - a).perp().normalize();
                    let turned = DVec2::from_angle(-0.3).rotate(normal);
                    let inside = (p - a).dot(normal);
                    let toward = -inside * DVec2::new(turned.x, -turned.y);
                    let own = gbuffer::coverage(toward);
                    let exact = if inside < 0.0 { 1.0 - own } else { own };
                    assert!((share - exact).abs() < 1e-3, "{technique:?} ({x}, {y}): {share} of {exact}");
                    let [r, g, blue] = resolved.pixel(x, y);
                    assert!(blue == 20 && (20..=200).contains(&r) && (20..=180).contains(&g), "({x}, {y})");
                    mixed += usize::from(0.01 < share && share < 0.99);
                }
            }
            assert!(mixed > 30, "{mixed}");
        }
    }
}
