//! Faults in the WGSL, as a programmer makes them.

use super::Labelled;
use super::scenes::{Scene, Shown};
use compare::Cause;
use pipeline::wgsl::{self, Variant};

/// A fault: what is replaced by what in the source, and the cause that the comparison must name.
struct Fault {
    name: &'static str,
    replace: &'static [(&'static str, &'static str)],
    scenes: &'static [Scene],
    cause: Cause,
}

const SURFACES: &[Scene] = &[Scene::Bicubic, Scene::ManySpans, Scene::Rational, Scene::Wave];

const FAULTS: &[Fault] = &[
    Fault {
        name: "the wrong sign of Eq. 6",
        replace: &[("((*term)[r - 1u] - (*term)[r]) * scale", "((*term)[r - 1u] + (*term)[r]) * scale")],
        scenes: SURFACES,
        cause: Cause::Derivative,
    },
    Fault {
        name: "S_u and S_v exchanged in the normal",
        replace: &[("cross(d.su, d.sv)", "cross(d.sv, d.su)")],
        scenes: SURFACES,
        cause: Cause::Derivative,
    },
    Fault {
        name: "a reversed face shown from its other side",
        replace: &[("(face.flags & REVERSED) != 0u", "false")],
        scenes: &[Scene::Reversed],
        cause: Cause::Derivative,
    },
    Fault {
        name: "a transposed control net",
        replace: &[
            (
                "face.points + (first.x + i) * face.count_v + first.y;",
                "face.points + first.x + i + first.y * face.count_v;",
            ),
            ("points[start + j]", "points[start + j * face.count_v]"),
        ],
        scenes: &[Scene::Bicubic, Scene::Wave],
        cause: Cause::ControlNet,
    },
    Fault {
        name: "span off by one",
        replace: &[("p, at.span.x);", "p, min(at.span.x + 1u, face.spans_u - 1u));")],
        scenes: &[Scene::ManySpans],
        cause: Cause::Span,
    },
    Fault {
        name: "span one too early",
        replace: &[("q, at.span.y);", "q, max(at.span.y, 1u) - 1u);")],
        scenes: &[Scene::ManySpans],
        cause: Cause::Span,
    },
    Fault {
        name: "swapped u and v",
        replace: &[("Parameters(in.span, in.uv),", "Parameters(in.span.yx, in.uv.yx),")],
        // Where there are as many spans along v as along u.
        scenes: &[Scene::Bicubic, Scene::Rational],
        cause: Cause::Parameters,
    },
    Fault {
        name: "swapped u and v in the evaluation alone",
        replace: &[
            ("basis(span_u.knots, p, at.uv.x,", "basis(span_u.knots, p, at.uv.y,"),
            ("basis(span_v.knots, q, at.uv.y,", "basis(span_v.knots, q, at.uv.x,"),
        ],
        scenes: &[Scene::Bicubic],
        cause: Cause::Parameters,
    },
    Fault {
        name: "missing rational division",
        replace: &[("if ((face.flags & RATIONAL) != 0u)", "if (false)")],
        scenes: &[Scene::Rational, Scene::Wave],
        cause: Cause::Rational,
    },
    Fault {
        name: "un-normalised normal",
        replace: &[("n = n / length;", "n = n * 1.0;")],
        scenes: SURFACES,
        cause: Cause::NormalLength,
    },
    Fault {
        name: "every normal called degenerate",
        replace: &[("if (is_regular(n_squared, su_squared, sv_squared))", "if (false)")],
        scenes: SURFACES,
        cause: Cause::DegenerateNormal,
    },
    Fault {
        name: "principal curvatures in the wrong order",
        replace: &[("vec2<f32>(mean + half, mean - half)", "vec2<f32>(mean - half, mean + half)")],
        scenes: SURFACES,
        cause: Cause::Curvature,
    },
    Fault {
        name: "the sum of the principal curvatures for their mean",
        replace: &[("(a + c) * 0.5", "(a + c)")],
        scenes: SURFACES,
        cause: Cause::Curvature,
    },
    Fault {
        name: "a frame that forgets the shear",
        replace: &[("dot(d.sv, e1) / length", "0.0")],
        scenes: &[Scene::Bicubic, Scene::Wave],
        cause: Cause::Curvature,
    },
    Fault {
        name: "the second derivative of a quotient without that of the weight",
        replace: &[(" - d.s * a_uu.w", "")],
        scenes: &[Scene::Rational, Scene::Wave],
        cause: Cause::Curvature,
    },
    Fault {
        name: "affine instead of perspective interpolation",
        replace: &[("@interpolate(perspective) uv", "@interpolate(linear) uv")],
        scenes: &[Scene::Steep],
        cause: Cause::Interpolation,
    },
    Fault {
        name: "parameters interpolated to three bits",
        replace: &[("Parameters(in.span, in.uv),", "Parameters(in.span, floor(in.uv * 8.0) / 8.0),")],
        scenes: SURFACES,
        cause: Cause::Interpolation,
    },
    Fault {
        name: "a picture moved by three pixels",
        replace: &[("out.uv = in.uv;", "out.uv = in.uv; out.clip.x = out.clip.x + 0.1 * out.clip.w;")],
        scenes: SURFACES,
        cause: Cause::Interpolation,
    },
    Fault {
        name: "wrong face offset",
        replace: &[("let face = faces[face_id];", "let face = faces[(face_id + 1u) % arrayLength(&faces)];")],
        scenes: &[Scene::Bicubic],
        cause: Cause::Face,
    },
    Fault {
        name: "a hit entered under the next face",
        replace: &[("vec4<u32>(face + 1u, ", "vec4<u32>((face + 1u) % arrayLength(&faces) + 1u, ")],
        scenes: &[Scene::Bicubic],
        cause: Cause::Face,
    },
    Fault {
        name: "depth that grows toward the eye",
        replace: &[("out.uv = in.uv;", "out.uv = in.uv; out.clip.z = out.clip.w - out.clip.z;")],
        scenes: &[Scene::Bicubic, Scene::ManySpans, Scene::Rational],
        cause: Cause::Depth,
    },
    Fault {
        name: "fragments of some faces thrown away",
        replace: &[(
            "f = fragment(in.face, place);",
            "if (in.face % 3u == 0u) { discard; } f = fragment(in.face, place);",
        )],
        scenes: &[Scene::Rational, Scene::Wave],
        cause: Cause::Coverage,
    },
    Fault {
        name: "the root of a negative number",
        replace: &[("out.position = d.s;", "out.position = d.s * sqrt(-1.0 - at.uv.x * at.uv.x);")],
        scenes: SURFACES,
        cause: Cause::NotFinite,
    },
    Fault {
        name: "a point moved aside",
        replace: &[("out.position = d.s;", "out.position = d.s + vec3<f32>(0.01, 0.002, -0.004);")],
        scenes: SURFACES,
        cause: Cause::Position,
    },
    Fault {
        name: "non-zero for even-odd",
        replace: &[("(left - first) % 2u == 1u", "(left - first) > 0u")],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "material and holes exchanged",
        replace: &[("(left - first) % 2u == 1u", "(left - first) % 2u == 0u")],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "an interval too far",
        replace: &[("let starts = ends + face.intervals + 1u;", "let starts = ends + face.intervals + 2u;")],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "the last edge of an interval forgotten",
        replace: &[("let end = u32(knots[starts + low + 1u]);", "let end = u32(knots[starts + low + 1u]) - 1u;")],
        scenes: &[Scene::Islands],
        cause: Cause::Trim,
    },
    Fault {
        name: "edges in the wrong order",
        replace: &[(
            "passes_left(points[middle], at, reach, inward)",
            "passes_left(points[first + end - 1u - middle], at, reach, inward)",
        )],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "edges bisected once",
        replace: &[("const BISECTIONS: u32 = 24u;", "const BISECTIONS: u32 = 1u;")],
        scenes: &[Scene::Islands],
        cause: Cause::Trim,
    },
    Fault {
        name: "a trim decided where the triangle is, not where the ray is",
        replace: &[("is_shown(face, at)", "is_shown(face, Footprint(f.whole, at.right, at.up, at.near_px, 0.0))")],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "faces drawn a quarter pixel beyond their edges",
        replace: &[("const NEAR_PX: f32 = 1.0 / 256.0;", "const NEAR_PX: f32 = 1.0 / 4.0;")],
        scenes: TRIMMED,
        cause: Cause::Trim,
    },
    Fault {
        name: "bisection to the wrong half",
        replace: &[("c.y <= y * c.z", "c.y > y * c.z")],
        scenes: &[Scene::Islands],
        cause: Cause::Trim,
    },
];

const TRIMMED: &[Scene] = &[Scene::Islands, Scene::Text];

/// Every fault on its scenes.
pub fn labelled() -> Vec<Labelled> {
    let mut all = vec![];
    for fault in FAULTS {
        let source = |variant: Variant| {
            fault.replace.iter().fold(wgsl::source(variant), |source, (from, to)| {
                assert!(source.contains(from), "{}: the source no longer says {from:?}", fault.name);
                source.replace(from, to)
            })
        };
        for scene in fault.scenes {
            let report = Shown::new(*scene).on_gpu(gpu::Overrides { source: Some(&source), ..Default::default() });
            all.push(Labelled { name: format!("{}, {scene:?}", fault.name), cause: fault.cause, report });
        }
    }
    for scene in [Scene::Bicubic, Scene::Rational] {
        let overrides = gpu::Overrides { depth: gpu::DepthOrder::Farthest, ..Default::default() };
        let report = Shown::new(scene).on_gpu(overrides);
        all.push(Labelled { name: format!("a reversed depth test, {scene:?}"), cause: Cause::Depth, report });
    }
    all
}
