//! Known colours, invariances, bands, and the twin's text.

use super::*;
use crate::GBuffer;
use naga::front::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Handle, Literal, Module, TypeInner};
use scene::Projection;
use std::collections::BTreeSet;
use std::mem::{offset_of, size_of};

const WGSL: &str = include_str!("../../../../shaders/shade.wgsl");
const RUST: &str = include_str!("../shade.rs");

/// A camera that looks along −z with x to its right and y above, a light beside it, and a model of size 4, so that
/// curvatures are multiplied by 1.
fn uniform(kind: ShadeKind) -> ShadeUniform {
    uniform_of(Shading::new(kind).with_light(DVec3::Z).unwrap())
}

fn uniform_of(shading: Shading) -> ShadeUniform {
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
    shading.uniform(&camera, 4.0)
}

/// Seen from along +z.
fn input(normal: Vec3) -> ShadeInput {
    ShadeInput {
        normal,
        view: Vec3::new(0.0, 0.0, -1.0),
        uv01: Vec2::new(0.05, 0.05),
        face: 0,
        curved: 1,
        k1: 0.5,
        k2: -0.25,
        status: NormalStatus::Regular as u32,
    }
}

fn tilted(angle_deg: f64) -> Vec3 {
    let angle = angle_deg.to_radians();
    Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32)
}

fn colour(kind: ShadeKind, s: &ShadeInput) -> [u8; 3] {
    unorm8(shade_pixel(&uniform(kind), s))
}

/// Unit vectors all over the sphere, from a fixed linear congruential generator.
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    let mut state = 12345u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    std::iter::repeat_with(move || Vec3::new(next(), next(), next()))
        .filter(|v| (0.1..=1.0).contains(&v.length()))
        .map(Vec3::normalize)
        .take(count)
}

#[test]
fn phong_is_brightest_toward_the_light_and_nearly_black_at_the_silhouette() {
    // Linear light: base × (0.025 + 0.13 + 0.72) + 0.3, and base × 0.025; the square root is stored.
    assert_eq!(colour(ShadeKind::Phong, &input(Vec3::Z)), [211, 227, 239]);
    assert_eq!(colour(ShadeKind::Phong, &input(Vec3::X)), [27, 30, 33]);
}

#[test]
fn isophote_bands_alternate_between_white_and_a_hue_of_the_angle() {
    assert_eq!(colour(ShadeKind::Isophotes, &input(tilted(2.0))), [246, 245, 241]);
    // A quarter of the way from amber to red.
    assert_eq!(colour(ShadeKind::Isophotes, &input(tilted(7.0))), [238, 139, 48]);
    assert_eq!(colour(ShadeKind::Isophotes, &input(tilted(12.0))), [246, 245, 241]);
}

#[test]
fn zebra_is_light_straight_ahead_and_dark_in_the_next_stripe() {
    assert_eq!(colour(ShadeKind::Zebra, &input(Vec3::Z)), [246, 245, 241]);
    // The mirrored direction turns by twice the normal's angle: its component is sin 6° = 0.105, above 1 / 17.
    assert_eq!(colour(ShadeKind::Zebra, &input(tilted(3.0))), [36, 53, 88]);
    assert_eq!(colour(ShadeKind::Zebra, &input(tilted(-3.0))), [36, 53, 88]);
}

#[test]
fn normal_components_are_shown_from_nought_to_full() {
    assert_eq!(colour(ShadeKind::Normal, &input(Vec3::Z)), [128, 128, 255]);
    assert_eq!(colour(ShadeKind::Normal, &input(Vec3::NEG_X)), [0, 128, 128]);
}

#[test]
fn checker_changes_at_each_tenth_and_its_last_square_is_closed() {
    let at = |u, v| colour(ShadeKind::Checker, &ShadeInput { uv01: Vec2::new(u, v), ..input(Vec3::Z) });
    let (light, dark) = ([244, 236, 217], [42, 103, 114]);
    assert_eq!([at(0.05, 0.05), at(0.15, 0.05), at(0.15, 0.15)], [light, dark, light]);
    assert_eq!([at(0.0, 0.0), at(1.0, 1.0), at(1.0, 0.0)], [light, light, dark]);
}

#[test]
fn hues_of_faces_follow_the_golden_ratio() {
    assert_eq!(colour(ShadeKind::Face, &input(Vec3::Z)), [87, 209, 136]);
    let ratio = (5f64.sqrt() - 1.0) / 2.0;
    for face in [0u32, 1, 2, 1000, 4_000_000_000] {
        // Red, green and blue of a full hue, without the whole of the colour's own formula.
        let hue = (1.0 - ratio + f64::from(face) * ratio).fract() * 6.0;
        let green = (2.0 - (hue - 2.0).abs()).clamp(0.0, 1.0);
        let tint = 0.05 * f64::from(face % 2);
        let found = f64::from(face_colour(face).y);
        // 24 bits of the hue are kept, and the ratio itself is rounded to 32 bits and multiplied by the face.
        let tolerance = 6.0 * (f64::from(face) * 2f64.powi(-32) + 2f64.powi(-22));
        assert!((found - (0.36 + tint + 0.46 * green)).abs() <= tolerance, "face {face}");
    }
}

#[test]
fn curvatures_of_half_the_scale_have_the_middle_colours_and_nought_is_white() {
    let sphere = ShadeInput { k1: -1.0, k2: -1.0, ..input(Vec3::Z) };
    assert_eq!(colour(ShadeKind::Mean, &sphere), [86, 151, 207]);
    assert_eq!(colour(ShadeKind::Gaussian, &sphere), [233, 130, 100]);
    let saddle = ShadeInput { k1: 1.0, k2: -1.0, ..input(Vec3::Z) };
    assert_eq!(colour(ShadeKind::Mean, &saddle), [247, 246, 244]);
    assert_eq!(colour(ShadeKind::Gaussian, &saddle), [86, 151, 207]);
}

#[test]
fn curvature_maps_do_not_depend_on_the_unit() {
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
    for kind in [ShadeKind::Gaussian, ShadeKind::Mean] {
        let shade_in = |unit: f32| {
            let s = ShadeInput { k1: 0.5 / unit, k2: -2.0 / unit, ..input(Vec3::Z) };
            shade_pixel(&Shading::new(kind).uniform(&camera, f64::from(4.0 * unit)), &s)
        };
        // Powers of two, so that nothing is rounded.
        assert_eq!(shade_in(1.0), shade_in(1024.0));
    }
}

#[test]
fn an_undefined_normal_is_magenta_and_an_unknown_curvature_grey() {
    for kind in ShadeKind::ALL {
        let undefined = ShadeInput { status: STATUS_UNDEFINED, normal: Vec3::NAN, ..input(Vec3::Z) };
        assert_eq!(colour(kind, &undefined), [255, 0, 255]);
        let limit = ShadeInput { status: NormalStatus::Limit as u32, curved: 0, ..input(Vec3::Z) };
        assert_eq!(colour(kind, &limit) == [115; 3], kind.needs_curvature());
    }
}

#[test]
fn two_sided_kinds_do_not_change_by_a_bit_when_the_normal_is_flipped() {
    for kind in ShadeKind::ALL {
        let uniform = uniform_of(Shading::new(kind));
        let mut changed = 0;
        for (normal, view) in directions(2000).zip(directions(2001).skip(1)) {
            let s = ShadeInput { normal, view, ..input(normal) };
            let flipped = ShadeInput { normal: -normal, k1: -s.k2, k2: -s.k1, ..s };
            changed += usize::from(shade_pixel(&uniform, &s) != shade_pixel(&uniform, &flipped));
        }
        let one_sided = matches!(kind, ShadeKind::Normal | ShadeKind::Mean);
        assert_eq!(changed, if one_sided { 2000 } else { 0 }, "{}", kind.name());
    }
}

#[test]
fn colours_stay_within_nought_and_one() {
    for kind in ShadeKind::ALL {
        let uniform = uniform_of(Shading::new(kind));
        for (i, (normal, view)) in directions(2000).zip(directions(2001).skip(1)).enumerate() {
            let s = ShadeInput { normal, view, face: i as u32, k1: 1e30, k2: -1e30, ..input(normal) };
            let colour = shade_pixel(&uniform, &s);
            assert!(colour.iter().all(|x| (-1e-6..=1.0 + 1e-6).contains(x)), "{} {colour:?}", kind.name());
        }
    }
}

#[test]
fn a_sphere_has_as_many_isophote_bands_as_ninety_degrees_have_widths() {
    for (band_deg, bands) in [(5.0, 18), (2.5, 36), (7.0, 13), (30.0, 3), (90.0, 1)] {
        let shading = Shading::new(ShadeKind::Isophotes).with_band_deg(band_deg).unwrap();
        let uniform = uniform_of(shading.with_light(DVec3::Z).unwrap());
        let mut seen = BTreeSet::new();
        for i in 0..9000 {
            let angle_deg = (f64::from(i) + 0.5) / 100.0;
            let band = isophote_band(&uniform, isophote_cosine(&uniform, &input(tilted(angle_deg))));
            // The angle itself, in f64; all samples are 0.005° or more from an edge, where f32 resolves 0.002°.
            let nearest_edge = (angle_deg / band_deg).round() * band_deg;
            if band_deg > 2.5 || (angle_deg - nearest_edge).abs() > 0.004 {
                assert_eq!(f64::from(band), (angle_deg / band_deg).floor(), "{angle_deg}° in bands of {band_deg}°");
            }
            seen.insert(band as u32);
        }
        assert_eq!(seen, (0..bands).collect());
        assert_eq!(uniform.bands, bands as f32);
    }
}

#[test]
fn a_band_edge_within_tolerance_allows_the_colours_of_both_sides() {
    let uniform = uniform(ShadeKind::Isophotes);
    let both = |a, b| [a, b].map(|angle| unorm8(shade_pixel(&uniform, &input(tilted(angle)))));
    let [below, above] = both(39.0, 41.0);
    // 0.001° at 40° is a cosine of 1.1e-5.
    assert_eq!(shade_tolerant(&uniform, &input(tilted(39.999)), 2e-5), [below, above]);
    assert_eq!(shade_tolerant(&uniform, &input(tilted(40.001)), 2e-5), [above, below]);
    assert_eq!(shade_tolerant(&uniform, &input(tilted(39.999)), 1e-6), [below]);
    assert_eq!(shade_tolerant(&uniform, &input(tilted(41.0)), 2e-5), [above]);
    // All bands: white and nine hues.
    assert_eq!(shade_tolerant(&uniform, &input(tilted(45.0)), 2.0).len(), 10);
}

#[test]
fn zebra_and_checker_allow_both_tones_at_an_edge_only() {
    let zebra = uniform(ShadeKind::Zebra);
    // The component of the first edge is 1 / 17.
    let edge_deg = (1.0f64 / 17.0).asin().to_degrees() / 2.0;
    assert_eq!(shade_tolerant(&zebra, &input(tilted(edge_deg)), 1e-6).len(), 2);
    assert_eq!(shade_tolerant(&zebra, &input(tilted(edge_deg + 0.1)), 1e-6).len(), 1);
    let checker = uniform(ShadeKind::Checker);
    let at = |u, v| shade_tolerant(&checker, &ShadeInput { uv01: Vec2::new(u, v), ..input(Vec3::Z) }, 1e-6);
    assert_eq!([at(0.3, 0.25).len(), at(0.25, 0.3).len(), at(0.25, 0.25).len()], [2, 2, 1]);
    // The ends of the domain are no edges.
    assert_eq!([at(0.0, 0.25).len(), at(1.0, 0.25).len()], [1, 1]);
}

#[test]
fn a_tolerance_allows_nothing_else_where_the_colour_is_continuous() {
    for kind in ShadeKind::ALL {
        if !matches!(kind, ShadeKind::Isophotes | ShadeKind::Zebra | ShadeKind::Checker) {
            let s = input(tilted(40.0));
            assert_eq!(shade_tolerant(&uniform(kind), &s, 0.5), [colour(kind, &s)]);
        }
    }
}

#[test]
fn illegal_bands_and_lights_are_refused() {
    let shading = Shading::new(ShadeKind::Isophotes);
    for degrees in [0.0, -5.0, 2.4, 90.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(shading.with_band_deg(degrees), Err(GBufferError::BandWidth { .. })), "{degrees}");
    }
    for light in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert!(matches!(shading.with_light(light), Err(GBufferError::Light { .. })));
    }
}

#[test]
fn names_of_kinds_are_read_back() {
    for kind in ShadeKind::ALL {
        assert_eq!(ShadeKind::from_name(kind.name()), Some(kind));
    }
    assert_eq!(ShadeKind::from_name("plaid"), None);
}

#[test]
fn colours_are_rounded_to_the_nearest_of_256() {
    assert_eq!(unorm8([0.0, 1.0, 0.5]), [0, 255, 128]);
    assert_eq!(unorm8([-1.0, 2.0, f32::NAN]), [0, 255, 0]);
    for i in 0..=255u8 {
        assert_eq!(unorm8([f32::from(i) / 255.0; 3]), [i; 3]);
    }
}

/// A model of two faces over [2, 6] × [−1, 1], and a hit on one of them.
fn model_and_hit(face: u32) -> (Model, Hit) {
    let knots = |a, b| nurbs::KnotVector::new(1, vec![a, a, b, b]).unwrap();
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
    let surface = nurbs::Surface::new(knots(2.0, 6.0), knots(-1.0, 1.0), points, None).unwrap();
    let hit = Hit {
        face: scene::FaceId(face),
        uv: glam::DVec2::new(3.0, 0.5),
        local: None,
        t: 5.0,
        position: DVec3::new(3.0, 0.0, 1.0),
        normal: nurbs::Normal::Regular(DVec3::Z),
        curvature: Some(crate::PrincipalCurvatures { k1: 1e300, k2: -1e300 }),
        edge: None,
    };
    (Model::of_surfaces("two", vec![surface.clone(), surface]).unwrap(), hit)
}

#[test]
fn a_hits_parameters_are_taken_over_its_domain_and_its_view_along_the_ray() {
    let (model, hit) = model_and_hit(1);
    let ray = Ray { origin: DVec3::ZERO, direction: DVec3::new(0.6, 0.0, -0.8), near: 0.0 };
    let s = ShadeInput::new(&hit, &model, &ray).unwrap();
    assert_eq!((s.uv01, s.view), (Vec2::new(0.25, 0.75), Vec3::new(0.6, 0.0, -0.8)));
    assert_eq!((s.k1, s.k2, s.curved), (f32::MAX, f32::MIN, 1));
    assert_eq!(ShadeInput::new(&Hit { curvature: None, ..hit }, &model, &ray).unwrap().curved, 0);
}

#[test]
fn a_buffer_is_shaded_pixel_by_pixel_and_a_strange_face_refused() {
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
    let viewport = scene::Viewport::new(2, 1).unwrap();
    let shading = Shading::new(ShadeKind::Normal);
    for face in [0, 2] {
        let (model, hit) = model_and_hit(face);
        let meta = crate::Meta::new("test", "by hand", &model, &camera);
        let buffer = GBuffer::from_rows(viewport, meta, [vec![None, Some(hit)]]);
        match buffer.shaded(&shading, &model, &camera) {
            Ok(picture) => assert_eq!((face, picture.rgb()), (0, &[background(), [128, 128, 255]][..])),
            Err(e) => assert!(matches!(e, GBufferError::NoSuchFace { x: 1, y: 0, face: 2, count: 2 })),
        }
    }
}

#[test]
fn isophotes_have_a_legend_of_their_bands() {
    for kind in ShadeKind::ALL {
        assert_eq!(Shading::new(kind).legend(90).is_some(), kind == ShadeKind::Isophotes);
    }
    let bands = Shading::new(ShadeKind::Isophotes).legend(1000).unwrap();
    let strip: Vec<[u8; 3]> = (0..1000).map(|y| bands.pixel(0, y)).filter(|c| *c != background()).collect();
    assert_eq!(strip.windows(2).filter(|pair| pair[0] != pair[1]).count(), 17);
}

#[test]
fn a_zebra_has_as_many_stripes_as_asked_and_may_be_turned() {
    let projection = Projection::Orthographic { height: 2.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
    let zebra = Shading::new(ShadeKind::Zebra);
    assert!([0, 1001].into_iter().all(|count| zebra.with_stripes(count).is_err()));
    let uniform = zebra.with_stripes(31).unwrap().uniform(&camera, 1.0);
    assert_eq!((uniform.stripes, uniform.axis), (31.0, camera.right().as_vec3().to_array()));
    let turned = zebra.with_stripes_turned(std::f64::consts::FRAC_PI_2).uniform(&camera, 1.0);
    let above = camera.above().as_vec3();
    assert!(above.distance(Vec3::from_array(turned.axis)) < 1e-6, "a quarter turn lays the stripes down");
}

// The twin.

fn module() -> Module {
    wgsl::parse_str(WGSL).unwrap_or_else(|e| panic!("{}", e.emit_to_string(WGSL)))
}

#[test]
fn twin_is_valid_wgsl() {
    let module = module();
    Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
}

/// The numbers of a constant expression, in order.
fn numbers(module: &Module, expression: Handle<Expression>) -> Vec<f64> {
    match &module.global_expressions[expression] {
        Expression::Literal(Literal::F32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::U32(n)) => vec![f64::from(*n)],
        Expression::Compose { components, .. } => components.iter().flat_map(|&c| numbers(module, c)).collect(),
        other => panic!("a constant made by {other:?}"),
    }
}

#[test]
fn twin_has_the_same_constants() {
    let vector = |v: Vec3| v.to_array().map(f64::from).to_vec();
    let integer = |n: u32| vec![f64::from(n)];
    let number = |x: f32| vec![f64::from(x)];
    let mut expected = vec![
        ("KIND_PHONG", integer(KIND_PHONG)),
        ("KIND_ISOPHOTES", integer(KIND_ISOPHOTES)),
        ("KIND_ZEBRA", integer(KIND_ZEBRA)),
        ("KIND_NORMAL", integer(KIND_NORMAL)),
        ("KIND_CHECKER", integer(KIND_CHECKER)),
        ("KIND_FACE", integer(KIND_FACE)),
        ("KIND_GAUSSIAN", integer(KIND_GAUSSIAN)),
        ("KIND_MEAN", integer(KIND_MEAN)),
        ("STATUS_UNDEFINED", integer(STATUS_UNDEFINED)),
        ("BACKGROUND", vector(BACKGROUND)),
        ("UNDEFINED_COLOUR", vector(UNDEFINED_COLOUR)),
        ("UNKNOWN_COLOUR", vector(UNKNOWN_COLOUR)),
        ("PHONG_BASE", vector(PHONG_BASE)),
        ("PHONG_AMBIENT", number(PHONG_AMBIENT)),
        ("PHONG_HEADLIGHT", number(PHONG_HEADLIGHT)),
        ("PHONG_DIFFUSE", number(PHONG_DIFFUSE)),
        ("PHONG_SPECULAR", number(PHONG_SPECULAR)),
        ("PHONG_RIM", number(PHONG_RIM)),
        ("LIGHT_TONE", vector(LIGHT_TONE)),
        ("DARK_TONE", vector(DARK_TONE)),
        ("ANGLE_0", vector(ANGLE_0)),
        ("ANGLE_1", vector(ANGLE_1)),
        ("ANGLE_2", vector(ANGLE_2)),
        ("ANGLE_3", vector(ANGLE_3)),
        ("CHECKER_LIGHT", vector(CHECKER_LIGHT)),
        ("CHECKER_DARK", vector(CHECKER_DARK)),
        ("NEGATIVE_2", vector(NEGATIVE_2)),
        ("NEGATIVE_1", vector(NEGATIVE_1)),
        ("NOUGHT", vector(NOUGHT)),
        ("POSITIVE_1", vector(POSITIVE_1)),
        ("POSITIVE_2", vector(POSITIVE_2)),
        ("GREATEST_CURVATURE", number(GREATEST_CURVATURE)),
        ("RELIEF_FLOOR", number(RELIEF_FLOOR)),
    ];
    let module = module();
    let named = module
        .constants
        .iter()
        .map(|(_, c)| (c.name.as_deref().expect("a constant of WGSL has a name"), numbers(&module, c.init)));
    let mut found: Vec<_> = named.collect();
    let by_name = |a: &(&str, Vec<f64>), b: &(&str, Vec<f64>)| a.0.cmp(b.0);
    found.sort_by(by_name);
    expected.sort_by(by_name);
    assert_eq!(found, expected);
}

#[test]
fn twin_has_the_same_functions_in_the_same_order() {
    let names = |text: &'static str| -> Vec<&str> {
        let plain = text.lines().map(|l| l.strip_prefix("pub(crate) ").unwrap_or(l));
        plain.filter_map(|l| l.strip_prefix("fn ")).filter_map(|l| l.split_once('(')).map(|(n, _)| n).collect()
    };
    assert_eq!(names(WGSL), names(RUST));
    assert!(names(WGSL).contains(&"shade"));
}

#[test]
fn twin_lays_out_the_uniform_alike() {
    let module = module();
    let (_, record) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("ShadeUniform")).unwrap();
    let TypeInner::Struct { members, span } = &record.inner else { panic!("a struct") };
    let found: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
    let expected = vec![
        ("light", offset_of!(ShadeUniform, light)),
        ("kind", offset_of!(ShadeUniform, kind)),
        ("axis", offset_of!(ShadeUniform, axis)),
        ("stripes", offset_of!(ShadeUniform, stripes)),
        ("squares", offset_of!(ShadeUniform, squares)),
        ("bands", offset_of!(ShadeUniform, bands)),
        ("curvature_scale", offset_of!(ShadeUniform, curvature_scale)),
        ("padding", offset_of!(ShadeUniform, padding)),
        ("thresholds", offset_of!(ShadeUniform, thresholds)),
    ];
    assert_eq!(found, expected);
    assert_eq!(*span as usize, size_of::<ShadeUniform>());
}
