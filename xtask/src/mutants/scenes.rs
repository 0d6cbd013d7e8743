//! The scenes that mutants are shown on, cheap and telling ones first.

mod disc;
mod edges;
mod joints;
mod made;
mod quads;

use super::shown::{SIDE, Shown, framed};
use super::way::Way;
use compare::Claims;
use gbuffer::ShadeKind;
use glam::DVec3;
use isophote::stage::{Path, Plan};
use made::{builtin, cylinder, joined, of_two_degrees, orthographic, raised, reversed, stacked, transposed};
use nurbs::{KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Model, Projection, Viewport};

/// The part that techniques of grids have.
const GRIDS: &str = "grid/corner.wgsl";

/// Those of a way, in the order in which a mutant meets them.
pub fn scenes(Way { technique, path }: Way) -> Vec<Shown> {
    let scenes = match technique.claims() {
        _ if path != Path::Fragment => covers(),
        Claims::Chord if technique.parts().iter().any(|part| part.file == GRIDS) => {
            [triangles(), joints::joints(), disc::discs()].concat()
        }
        Claims::Chord => {
            [triangles(), joints::joints(), joints::close_joints(), edges::edges(), vec![disc::of_several_spans()]]
                .concat()
        }
        Claims::OnRay => {
            [hulls(), vec![quads::flat()], quads::behind_the_eye(), joints::joints()[4..].to_vec()].concat()
        }
    };
    let drawn = |mut shown: Shown| {
        shown.plan.technique = technique;
        shown.plan.path = path;
        // Poles on purpose: what has no bound is not what is tried.
        shown.plan.unbounded_share = 1.0;
        shown
    };
    scenes.into_iter().map(drawn).collect()
}

/// What shows the evaluation, the status of normals, and the interpolation over triangles.
fn triangles() -> Vec<Shown> {
    vec![
        Shown { shade: ShadeKind::Zebra, ..framed("weights and knots", builtin("rational"), Scheme::Specialised) },
        Shown {
            shade: ShadeKind::Gaussian,
            ..framed("degrees 5 and 2", builtin("quintic-quadratic"), Scheme::General)
        },
        Shown {
            shade: ShadeKind::Mean,
            ..framed("reversed and rational", reversed(builtin("torus")), Scheme::General)
        },
        Shown { shade: ShadeKind::Mean, ..framed("bent the other way", builtin("torus"), Scheme::Specialised) },
        Shown { shade: ShadeKind::Face, ..framed("many faces", builtin("teapot"), Scheme::Specialised) },
        Shown { shade: ShadeKind::Checker, ..framed("periodic knots", builtin("periodic"), Scheme::General) },
        Shown { shade: ShadeKind::Mean, ..framed("degree 8 along u", transposed(&of_degree_8()), Scheme::General) },
        Shown {
            shade: ShadeKind::Phong,
            ..orthographic(framed("degree 1", builtin("bilinear-quartic"), Scheme::General))
        },
        Shown { shade: ShadeKind::Gaussian, ..framed("weights along u alone", cylinder(), Scheme::General) },
        Shown { shade: ShadeKind::Phong, ..framed("poles", reversed(builtin("sphere")), Scheme::Specialised) },
        steep(),
        edge_on_centres(false),
        edge_on_centres(true),
        pole_on_a_centre(),
        beside_a_pole("beside a pole in v", false),
        beside_a_pole("beside a pole in u", true),
        strip("thin in u", false),
        strip("thin in v", true),
        cusp("slow in u", false),
        cusp("slow in v", true),
        framed("islands", builtin("islands"), Scheme::Specialised),
        framed("a word", builtin("text"), Scheme::General),
        framed("beside a whole face", joined(&builtin("cusp"), &cylinder()), Scheme::General),
        framed("across a seam", builtin("window"), Scheme::Specialised),
        vertex_normals(ShadeKind::Normal),
        vertex_normals(ShadeKind::Gaussian),
    ]
}

/// What shows the search for roots: folds, grazing views, poles, hulls that the near plane cuts, and hulls of all sizes.
fn hulls() -> Vec<Shown> {
    // In pictures that are no squares.
    let two_degrees = |name, columns, rows| {
        let viewport = Viewport::new(columns, rows).expect("a legal size");
        Shown { viewport, shade: ShadeKind::Face, ..framed(name, of_two_degrees(), Scheme::Specialised) }
    };
    let large = |shown: Shown, side| Shown { viewport: Viewport::new(side, side).expect("a legal size"), ..shown };
    vec![
        Shown { shade: ShadeKind::Zebra, ..framed("weights and knots", builtin("rational"), Scheme::Specialised) },
        framed("many faces", builtin("teapot"), Scheme::Specialised),
        Shown {
            shade: ShadeKind::Phong,
            ..orthographic(framed("no perspective", builtin("torus"), Scheme::Specialised))
        },
        pole_on_a_centre(),
        beside("grazing", "torus", [1.1, 0.2, 0.06], 45.0),
        beside("across waves", "surface", [0.5, 0.1, 0.03], 60.0),
        beside("within", "teapot", [0.02, 0.03, 0.05], 60.0),
        beside("within a wave", "surface", [0.02, 0.03, 0.05], 60.0),
        large(beside("close to a fold", "torus", [0.34, 0.02, 0.17], 20.0), 96),
        large(beside("close to two folds", "surface", [0.3, 0.3, 0.05], 20.0), 96),
        large(beside("large hulls", "rational", [0.0, -0.1, 0.6], 20.0), 96),
        framed("degrees 5 and 2", builtin("quintic-quadratic"), Scheme::General),
        framed("degrees 2 and 5", transposed(&builtin("quintic-quadratic")), Scheme::General),
        two_degrees("two degrees, wide", 96, 40),
        two_degrees("two degrees, tall", 40, 96),
    ]
}

/// What shows who covers a pixel, and who is nearest there: triangles of all sizes, some cut by the near plane, some of faces
/// with trims, in pictures that are no squares.
fn covers() -> Vec<Shown> {
    let coarse = |shown: Shown| Shown { plan: Plan { chord_px: 8.0, ..shown.plan }, ..shown };
    let wide = |shown: Shown| Shown { viewport: Viewport::new(70, 40).expect("a legal size"), ..shown };
    let trimmed = |name, model| framed(name, builtin(model), Scheme::Specialised);
    let fine = |shown: Shown| Shown { plan: Plan { chord_px: 1.0 / 64.0, ..shown.plan }, ..shown };
    let with_edges = |shown: Shown| Shown { plan: Plan { edges: true, ..shown.plan }, ..shown };
    let stack = joined(&builtin("islands"), &raised(stacked(&builtin("islands"), 8)));
    let curved = vec![
        wide(Shown { shade: ShadeKind::Face, ..framed("many faces", builtin("teapot"), Scheme::Specialised) }),
        wide(framed("two degrees", of_two_degrees(), Scheme::Specialised)),
        steep(),
        edge_on_centres(false),
        edge_on_centres(true),
        coarse(wide(beside("within", "teapot", [0.02, 0.03, 0.05], 60.0))),
        coarse(wide(beside("across waves", "surface", [0.5, 0.1, 0.03], 60.0))),
        wide(beside("grazing", "torus", [1.1, 0.2, 0.06], 45.0)),
        fine(framed("small triangles through each other", builtin("teapot"), Scheme::Specialised)),
        vertex_normals(ShadeKind::Normal),
        trimmed("islands", "islands"),
        coarse(trimmed("large faces with trims", "window")),
        framed("a word", builtin("text"), Scheme::General),
        with_edges(trimmed("edges of islands", "islands")),
        // More questions than there is room for, of two degrees.
        framed("a stack of faces with trims", stack, Scheme::Specialised),
    ];
    [quads::behind_the_eye(), quads::cut_and_counted(), curved].concat()
}

/// Curved along v alone, of degree 8: more knots than come before those of a file's first span.
fn of_degree_8() -> Model {
    (4..8).fold(builtin("bilinear-quartic"), |model, _| raised(model))
}

/// A model seen from a place that is so many times its size from its middle.
fn beside(name: &'static str, model: &str, eye: [f64; 3], fov_deg: f64) -> Shown {
    let model = builtin(model);
    let (center, size) = (model.hull().center(), model.hull().diagonal());
    let projection = Projection::Perspective { fov_deg };
    let eye = center + size * DVec3::from_array(eye);
    let camera = Camera::look_at(eye, center, DVec3::Z, projection).expect("legal");
    Shown { camera, ..framed(name, model, Scheme::Specialised) }
}

/// A flat bilinear square over [−1, 1]² with u along −x and v along y, so that u = 1 on its left edge in the picture and
/// v = 1 on its upper; where `mirrored`, both are 0 there. The last span of either parameter is too short for f32, and
/// the knots go on after it.
fn square(mirrored: bool) -> Model {
    const TINY: f64 = 1e-12;
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0 - TINY, 1.0, 1.5]).expect("legal");
    let along = [-1.0, 1.0 - 2.0 * TINY, 1.0];
    let sign = if mirrored { -1.0 } else { 1.0 };
    let points = along.into_iter().flat_map(|x| along.map(|y| sign * DVec3::new(-x, y, 0.0))).collect();
    let surface = Surface::new(knots(), knots(), points, None).expect("legal");
    Model::of_surfaces("square", vec![surface]).expect("one face")
}

/// Two large triangles seen at a steep angle: depth varies by a factor of ten within each.
fn steep() -> Shown {
    let projection = Projection::Perspective { fov_deg: 70.0 };
    let camera = Camera::look_at(DVec3::new(0.0, -1.2, 0.35), DVec3::ZERO, DVec3::Z, projection).expect("legal");
    let shade = ShadeKind::Zebra;
    Shown { camera, cells: Some(1), shade, ..framed("steep perspective", square(false), Scheme::General) }
}

/// The square's left and upper edges run a thousandth of a pixel inside a row and a column of pixel centres. Corners that
/// snap to 1/256 pixel cover those centres nevertheless, and interpolation there leaves the domain.
fn edge_on_centres(mirrored: bool) -> Shown {
    let pixel = 4.0 / SIDE as f64;
    let shift = (0.5 + 1.0 / 1024.0) * pixel;
    let target = DVec3::new(-shift, shift, 0.0);
    let projection = Projection::Orthographic { height: 4.0 };
    let camera = Camera::look_at(target + DVec3::Z * 4.0, target, DVec3::Y, projection).expect("legal");
    let name = if mirrored { "the domain's start" } else { "the domain's end" };
    Shown { camera, cells: Some(1), ..framed(name, square(mirrored), Scheme::General) }
}

/// The sphere's pole, whose normal is undefined in f32, lies exactly on a pixel's centre.
fn pole_on_a_centre() -> Shown {
    let projection = Projection::Orthographic { height: 2.5 };
    let camera = Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, projection).expect("legal");
    let viewport = Viewport::new(SIDE + 1, SIDE + 1).expect("a legal size");
    Shown { camera, viewport, ..framed("a pole on a centre", builtin("sphere"), Scheme::General) }
}

/// A millionth of a pixel's breadth of a sphere: |S_u| there is rounding error, far below what counts as collapsed.
fn beside_a_pole(name: &'static str, exchanged: bool) -> Shown {
    let sphere = builtin("sphere");
    let model = if exchanged { transposed(&sphere) } else { sphere };
    let projection = Projection::Orthographic { height: 1e-7 };
    let camera = Camera::look_at(DVec3::Z * 4.0, DVec3::Z, DVec3::Y, projection).expect("legal");
    Shown { camera, cells: Some(64), ..framed(name, model, Scheme::General) }
}

/// A strip six units long and so thin that in local units |S_u| is 1.2e-6 and |S_v| 1.5: neither collapsed nor, at a
/// right angle, parallel; u and v are exchanged where `exchanged`.
fn strip(name: &'static str, exchanged: bool) -> Shown {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    let points = [(-2.4e-6, -3.0), (-2.4e-6, 3.0), (2.4e-6, -3.0), (2.4e-6, 3.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let surface = Surface::new(knots(), knots(), points.to_vec(), None).expect("legal");
    let plain = Model::of_surfaces("strip", vec![surface]).expect("one face");
    let model = if exchanged { transposed(&plain) } else { plain };
    let projection = Projection::Orthographic { height: 1.2e-5 };
    let camera = Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, projection).expect("legal");
    Shown { camera, cells: Some(1), ..framed(name, model, Scheme::General) }
}

/// A diamond S(u, v) = v³ c(u) about its own centre, where f32 keeps every digit however near the centre it comes. The
/// picture shows nothing but the places where |S_u| is between one and two times the length that counts as collapsed;
/// u and v are exchanged where `transposed`.
///
/// In local units |S_u| = 2 √2 v³. The tessellation's first row of cells ends at v = 2⁻⁶, and is flat: |x| + |y| there is
/// 2⁻¹² v, so that the band of |S_u| from 2⁻²⁰ to 2⁻¹⁹ is at |x| + |y| from 1.7e-6 to 2.1e-6.
fn cusp(name: &'static str, transposed: bool) -> Shown {
    let knots = |degree, knots: &[f64]| KnotVector::new(degree, knots.to_vec()).expect("legal");
    let around = knots(1, &[0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0]);
    let outward = knots(3, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    let corners = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::X];
    let surface = if transposed {
        let rows = [DVec3::ZERO; 15].into_iter().chain(corners).collect();
        Surface::new(outward, around, rows, None)
    } else {
        let rows = corners.into_iter().flat_map(|corner| [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, corner]).collect();
        Surface::new(around, outward, rows, None)
    };
    let model = Model::of_surfaces(name, vec![surface.expect("legal")]).expect("one face");
    let target = DVec3::new(0.95e-6, 0.95e-6, 0.0);
    let projection = Projection::Orthographic { height: 1.8e-7 };
    let camera = Camera::look_at(target + DVec3::Z, target, DVec3::Y, projection).expect("legal");
    Shown { camera, cells: Some(64), ..framed(name, model, Scheme::General) }
}

/// A dome that fills the picture, cut coarsely, so that normals of its vertices are unlike those of its fragments.
fn vertex_normals(shade: ShadeKind) -> Shown {
    let model = builtin("unclamped");
    let (center, size) = (model.hull().center(), model.hull().diagonal());
    let projection = Projection::Perspective { fov_deg: 12.0 };
    let eye = center + size * DVec3::new(0.1, -0.2, 1.0);
    let camera = Camera::look_at(eye, center, DVec3::Y, projection).expect("legal");
    let shown = framed("normals of vertices", model, Scheme::Specialised);
    Shown { camera, cells: Some(4), shade, vertex_normals: true, fills: true, ..shown }
}
