//! Faults put into the WGSL one at a time: the comparison fails on each, and names the cause.

use compare::{Cause, PairReport, Verdict};
use glam::DVec3;
use nurbs::{KnotVector, Surface};
use pipeline::Proxy;
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Model, Projection, Viewport};
use xtask::stage::{Plan, Stage};

const SIDE: usize = 64;

/// A fault: what is replaced by what in the source, and the cause that the comparison must name.
struct Fault {
    name: &'static str,
    replace: &'static [(&'static str, &'static str)],
    scene: fn(Viewport) -> Shown,
    cause: Cause,
}

/// A model, who looks, and how coarsely it is cut.
struct Shown {
    model: Model,
    camera: Camera,
    cells: Option<usize>,
}

fn builtin(name: &str, viewport: Viewport) -> Shown {
    let model = formats::builtin(name).expect("built in");
    let camera = Camera::framing(&model, viewport);
    Shown { model, camera, cells: None }
}

fn many_spans(viewport: Viewport) -> Shown {
    builtin("periodic", viewport)
}

fn bicubic(viewport: Viewport) -> Shown {
    builtin("teapot", viewport)
}

fn rational(viewport: Viewport) -> Shown {
    builtin("torus", viewport)
}

/// A flat bilinear square over [−1, 1]² with u along −x, so that u = 1 on its left edge in the picture.
fn square() -> Model {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    let points = [(1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let surface = Surface::new(knots(), knots(), points.to_vec(), None).expect("legal");
    Model::of_surfaces("square", vec![surface]).expect("one face")
}

/// Two large triangles seen at a steep angle: depth varies by a factor of ten within each.
fn steep(_: Viewport) -> Shown {
    let projection = Projection::Perspective { fov_deg: 70.0 };
    let camera = Camera::look_at(DVec3::new(0.0, -1.2, 0.35), DVec3::new(0.0, 0.0, 0.0), DVec3::Z, projection);
    Shown { model: square(), camera: camera.expect("legal"), cells: Some(1) }
}

/// The square's left edge runs exactly through a column of pixel centres: 64 pixels on 4 units, shifted by half a pixel.
fn edge_on_centres(_: Viewport) -> Shown {
    let shift = DVec3::new(2.0 / SIDE as f64, 2.0 / SIDE as f64, 0.0);
    let projection = Projection::Orthographic { height: 4.0 };
    let camera = Camera::look_at(shift + DVec3::Z * 4.0, shift, DVec3::Y, projection).expect("legal");
    Shown { model: square(), camera, cells: Some(1) }
}

const FAULTS: &[Fault] = &[
    Fault {
        name: "the wrong sign of Eq. 6",
        replace: &[("((*term)[r - 1u] - (*term)[r]) * scale", "((*term)[r - 1u] + (*term)[r]) * scale")],
        scene: bicubic,
        cause: Cause::Derivative,
    },
    Fault {
        name: "a transposed control net",
        replace: &[
            (
                "face.points + (span_u - p + i) * face.count_v + span_v - q;",
                "face.points + span_u - p + i + (span_v - q) * face.count_u;",
            ),
            ("points[first + j]", "points[first + j * face.count_u]"),
        ],
        scene: bicubic,
        cause: Cause::ControlNet,
    },
    Fault {
        name: "span off by one",
        replace: &[("return low;", "return low + 1u;")],
        scene: many_spans,
        cause: Cause::Span,
    },
    Fault {
        name: "swapped u and v",
        replace: &[("fragment(in.face, in.uv)", "fragment(in.face, in.uv.yx)")],
        scene: bicubic,
        cause: Cause::Parameters,
    },
    Fault {
        name: "swapped u and v in the evaluation alone",
        replace: &[
            ("basis(face.knots_u, p, span_u, uv.x,", "basis(face.knots_u, p, span_u, uv.y,"),
            ("basis(face.knots_v, q, span_v, uv.y,", "basis(face.knots_v, q, span_v, uv.x,"),
        ],
        scene: bicubic,
        cause: Cause::Parameters,
    },
    Fault {
        name: "missing rational division",
        replace: &[("if ((face.flags & RATIONAL) != 0u)", "if (false)")],
        scene: rational,
        cause: Cause::Rational,
    },
    Fault {
        name: "un-normalised normal",
        replace: &[("n = n / length;", "n = n * 1.0;")],
        scene: bicubic,
        cause: Cause::NormalLength,
    },
    Fault {
        name: "affine instead of perspective interpolation",
        replace: &[("@interpolate(perspective) uv", "@interpolate(linear) uv")],
        scene: steep,
        cause: Cause::Interpolation,
    },
    Fault {
        name: "wrong face offset",
        replace: &[("let face = faces[face_id];", "let face = faces[(face_id + 1u) % arrayLength(&faces)];")],
        scene: bicubic,
        cause: Cause::Face,
    },
    Fault {
        name: "wrong end-knot case",
        replace: &[("return last;", "return last + 1u;")],
        scene: edge_on_centres,
        cause: Cause::Span,
    },
];

/// The comparison of the GPU, with overrides, against the ray caster.
fn compare(scene: fn(Viewport) -> Shown, overrides: gpu::Overrides) -> PairReport {
    let viewport = Viewport::new(SIDE, SIDE).expect("a legal size");
    let Shown { model, camera, cells } = scene(viewport);
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let mut stage = Stage::new(&model, camera, viewport, Plan { chord_px: 0.5, ..Plan::default() }).expect("a stage");
    if let Some(cells) = cells {
        stage.proxy = Proxy::uniform(&model, &stage.scene, cells).expect("few triangles");
    }
    let caster = Caster::new(&model);
    let gbuffer = stage.gpu(&device, None, overrides).expect("the GPU draws").gbuffer;
    stage.against_raycast(&caster, &stage.raycast(&caster), &gbuffer).expect("comparable")
}

#[test]
fn each_fault_in_the_wgsl_is_caught_and_its_cause_named() {
    let mut failures = vec![];
    for fault in FAULTS {
        let source = |variant: Variant| {
            fault.replace.iter().fold(wgsl::source(variant), |source, (from, to)| {
                assert!(source.contains(from), "{}: the source no longer says {from:?}", fault.name);
                source.replace(from, to)
            })
        };
        let report = compare(fault.scene, gpu::Overrides { source: Some(&source), ..Default::default() });
        if report.verdict != Verdict::Differ || report.main_cause() != Some(fault.cause) {
            let first = report.worst.first().map(|p| p.detail.clone());
            failures.push(format!("{}: {:?} {:?} {first:?}", fault.name, report.verdict, report.causes));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_reversed_depth_test_is_caught_as_depth() {
    let overrides = gpu::Overrides { depth: gpu::DepthOrder::Farthest, ..Default::default() };
    let report = compare(bicubic, overrides);
    assert_eq!((report.verdict, report.main_cause()), (Verdict::Differ, Some(Cause::Depth)), "{:?}", report.causes);
}

#[test]
fn the_scenes_of_the_faults_agree_without_them() {
    for scene in [many_spans, bicubic, rational, steep, edge_on_centres] {
        let report = compare(scene, gpu::Overrides::default());
        assert_eq!(report.verdict, Verdict::Agree, "{:?} {:?}", report.causes, report.worst.first());
    }
}
