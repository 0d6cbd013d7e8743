//! A scene that mutants are shown on.

use super::way::Way;
use compare::Claims;
use gbuffer::{ShadeKind, Shading};
use isophote::stage::Plan;
use pipeline::Scheme;
use scene::{Camera, Model, Viewport};

/// A model, who looks, and how it is drawn.
#[derive(Clone)]
pub struct Shown {
    /// What a mutant must not get wrong here.
    pub name: &'static str,
    /// What is drawn.
    pub model: Model,
    /// Who looks.
    pub camera: Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// How it is drawn; technique and path are set by who draws.
    pub plan: Plan,
    /// Cells of a uniform tessellation in place of one by chord error.
    pub cells: Option<usize>,
    /// What the picture shaded in the fragment stage shows.
    pub shade: ShadeKind,
    /// Whether that picture is shaded by normals interpolated from the vertices, and nothing else is judged.
    pub vertex_normals: bool,
    /// Whether the model fills the picture, so that a pixel that shows nothing is a crack between two faces.
    pub fills: bool,
}

/// Width of isophotes' bands, degrees: the least there is, so that every threshold of the program stands for some.
const BAND_DEG: f64 = 2.5;

/// Side of the pictures.
pub const SIDE: usize = 40;

impl Shown {
    /// How what the fragment stage shades is coloured.
    pub fn shading(&self) -> Shading {
        Shading::new(self.shade).with_band_deg(BAND_DEG).expect("a legal width")
    }

    /// Who draws it.
    pub fn way(&self) -> Way {
        Way { technique: self.plan.technique, path: self.plan.path }
    }

    /// Whether mutants of a way's parts are shown on it. Those of the parts that all have are changed with the first; they are
    /// drawn by a search, too, where faces meet, and not on all scenes that its own parts ask for.
    pub fn is_of(&self, way: Way) -> bool {
        let is_shared = Way::all().next() == Some(way) && self.fills;
        self.way() == way || is_shared && self.plan.technique.claims() == Claims::OnRay
    }
}

/// Of the pictures.
pub fn viewport() -> Viewport {
    Viewport::new(SIDE, SIDE).expect("a legal size")
}

/// A model as it is framed.
pub fn framed(name: &'static str, model: Model, scheme: Scheme) -> Shown {
    let (viewport, plan) = (viewport(), Plan { scheme, chord_px: 0.5, ..Plan::default() });
    let camera = Camera::framing(&model, viewport);
    let shade = ShadeKind::Isophotes;
    Shown { name, model, camera, viewport, plan, cells: None, shade, vertex_normals: false, fills: false }
}
