//! The direction of a light, by a place in the picture.

use glam::{DVec2, DVec3};
use scene::Viewport;

/// Toward the light (right, up, to the viewer; unit length) that makes a ball, which fills the picture, brightest at `at`, pixels from
/// the top left corner. Beyond the ball the light stands beside it.
pub fn toward(viewport: Viewport, at: DVec2) -> DVec3 {
    let size = DVec2::new(viewport.width() as f64, viewport.height() as f64);
    let from_middle = (2.0 * at - size) / size.min_element();
    let across = DVec2::new(from_middle.x, -from_middle.y);
    let across = across / across.length().max(1.0);
    across.extend((1.0 - across.length_squared()).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_stands_where_the_mouse_is() {
        let viewport = Viewport::new(200, 100).expect("a size");
        assert_eq!(toward(viewport, DVec2::new(100.0, 50.0)), DVec3::Z);
        let right = toward(viewport, DVec2::new(125.0, 50.0));
        assert!(right.x == 0.5 && right.y == 0.0 && (right.z - 0.75f64.sqrt()).abs() < 1e-12, "{right}");
        // Rows count downward, and a light counts upward.
        assert!(toward(viewport, DVec2::new(100.0, 10.0)).y > 0.0);
        let corner = toward(viewport, DVec2::ZERO);
        assert!(corner.z.abs() < 1e-7 && (corner.length() - 1.0).abs() < 1e-12 && corner.x < 0.0, "{corner}");
    }
}
