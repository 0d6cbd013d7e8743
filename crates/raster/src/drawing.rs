//! What is drawn, and how it is seen.

use pipeline::{PackedScene, View};
use scene::{Camera, Viewport};

/// What is computed at a fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Whether principal curvatures are.
    pub curvature: bool,
    /// Whether a hit's normal is the one interpolated from the corners (Kanai 2007, Fig. 3, left) instead of the
    /// surface's own at the fragment, where the technique has corners. All else stays.
    pub vertex_normals: bool,
}

/// What is drawn, and how it is seen.
#[derive(Debug, Clone, Copy)]
pub struct Drawing<'a> {
    /// The packed faces.
    pub scene: &'a PackedScene,
    /// How each face is seen: [`PackedScene::views`] of the same camera and viewport.
    pub views: &'a [View],
    /// The camera, for the rays of pixels.
    pub camera: &'a Camera,
    /// The pixels.
    pub viewport: Viewport,
    /// What is computed.
    pub options: Options,
}
