//! Techniques `grid` and `zones`: faults in their vertex stage and kernels are found.

use compare::{Cause, PairReport, Verdict};
use isophote::stage::{Plan, Stage};
use pipeline::wgsl::{self, Variant};
use raycast::Caster;
use scene::{Camera, Viewport};
use techniques::Technique;
use techniques::grid::Grid;
use techniques::zones::ByZones;

/// A fault: whose, what is replaced by what, and a cause that the comparison may name.
struct Fault {
    name: &'static str,
    technique: &'static dyn Technique,
    replace: [&'static str; 2],
    causes: &'static [Cause],
}

const FAULTS: &[Fault] = &[
    Fault {
        name: "a border has a level less on one side",
        technique: &Grid,
        replace: ["snapped(t[along], border.level)", "snapped(t[along], max(border.level, 1u) - 1u)"],
        causes: &[Cause::Coverage, Cause::Depth, Cause::Interpolation],
    },
    Fault {
        name: "borders are not stitched",
        technique: &Grid,
        replace: ["snapped(t[along], border.level)", "t[along]"],
        causes: &[Cause::Coverage, Cause::Depth, Cause::Interpolation],
    },
    Fault {
        name: "a shared border runs backwards",
        technique: &Grid,
        replace: [
            "border.start + t[along] * (border.end - border.start)",
            "border.end + t[along] * (border.start - border.end)",
        ],
        causes: &[Cause::Coverage, Cause::Depth, Cause::Interpolation],
    },
    Fault {
        name: "a transposed grid",
        technique: &Grid,
        replace: ["corner_at(tile.grid, at.x, at.y)", "corner_at(tile.grid, at.y, at.x)"],
        causes: &[Cause::Coverage, Cause::Depth, Cause::Interpolation],
    },
    Fault {
        name: "levels for an error eight times as large",
        technique: &Grid,
        replace: ["product(asked.error_px, pixel)", "product(8.0 * asked.error_px, pixel)"],
        causes: &[Cause::Coverage, Cause::Depth, Cause::Interpolation],
    },
    Fault {
        name: "what is left of the middle is not drawn",
        technique: &Grid,
        replace: ["plus(wide, x)", "x"],
        causes: &[Cause::Coverage, Cause::Depth],
    },
    Fault {
        name: "each grid loses a tile to the one before",
        technique: &Grid,
        replace: ["before += own;", "before += max(own, 1u) - 1u;"],
        causes: &[Cause::Coverage, Cause::Depth],
    },
    Fault {
        name: "tiles across are taken for tiles along",
        technique: &Grid,
        replace: ["((k / across) << row.side)", "((k % across) << row.side)"],
        causes: &[Cause::Coverage, Cause::Depth],
    },
    Fault {
        name: "zones without their overlap",
        technique: &ByZones,
        replace: [
            "zone.yz + vec2<u32>(k / ACROSS, k % ACROSS)",
            "zone.yz + min(vec2<u32>(k / ACROSS, k % ACROSS), vec2<u32>(SIDE - 1u))",
        ],
        causes: &[Cause::Coverage, Cause::Depth],
    },
    Fault {
        name: "a wrong stride from zone to zone",
        technique: &ByZones,
        replace: ["k % columns * SIDE", "k % columns * (SIDE - 1u)"],
        causes: &[Cause::Coverage, Cause::Depth],
    },
];

/// What the pairs with the GPU say of the teapot: its patches have many levels.
fn judged(technique: &'static dyn Technique, overrides: gpu::Overrides) -> [PairReport; 2] {
    let device = gpu::Device::open(None).expect("a GPU adapter: `apt-get install mesa-vulkan-drivers libvulkan1`");
    let model = models::builtin("teapot").expect("built in");
    let viewport = Viewport::new(160, 120).expect("a legal size");
    // Coarse, so that a border that is not the same from either side leaves a gap that pixels see.
    let plan = Plan { technique, chord_px: 2.0, ..Plan::default() };
    let stage = Stage::new(&model, Camera::framing(&model, viewport), viewport, plan).expect("a stage");
    let caster = Caster::new(&model);
    let on_gpu = stage.gpu(&device, None, overrides).expect("the GPU draws").gbuffer;
    [
        stage.against_raycast(&caster, &stage.raycast(&caster), &on_gpu).expect("comparable"),
        stage.against_raster(&stage.raster(), &on_gpu).expect("comparable"),
    ]
}

#[test]
fn the_sources_as_they_are_agree() {
    for technique in [&Grid as &'static dyn Technique, &ByZones] {
        let pairs = judged(technique, gpu::Overrides::default());
        assert!(pairs.iter().all(|pair| pair.verdict == Verdict::Agree), "{technique:?}");
    }
}

#[test]
fn faults_of_the_tessellators_are_found_and_named() {
    for Fault { name, technique, replace: [from, to], causes } in FAULTS {
        let source = |variant: Variant| {
            let source = wgsl::source(variant);
            assert!(source.contains(from), "{name}: the source no longer says {from:?}");
            source.replace(from, to)
        };
        let pairs = judged(*technique, gpu::Overrides { source: Some(&source), ..Default::default() });
        let found: Vec<Option<Cause>> = pairs.iter().map(PairReport::main_cause).collect();
        println!("{name}: {found:?}");
        assert!(pairs.iter().any(|pair| pair.verdict == Verdict::Differ), "{name} is not found");
        let is_named = |cause: &Option<Cause>| cause.is_none_or(|cause| causes.contains(&cause));
        assert!(found.iter().all(is_named), "{name}: {found:?}");
    }
}
