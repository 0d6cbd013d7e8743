//! What was judged, as pictures: of each pixel the share that it uses of what it is allowed, and why it differs.

use compare::{Cause, PairReport, PixelUse};
use gbuffer::{Picture, background};
use scene::Viewport;

/// A share of nought, and one of all; between them colours are mixed.
pub(super) const SHARE_ENDS: [[u8; 3]; 2] = [[222, 235, 247], [8, 48, 107]];

/// More than is allowed.
pub(super) const BEYOND: [u8; 3] = [255, 47, 208];

/// A pixel without a verdict, and one that agrees, among causes.
pub(super) const NO_VERDICT: [u8; 3] = [217, 164, 0];
pub(super) const AGREES: [u8; 3] = [214, 220, 226];

/// Colours of causes, the most frequent first; what is rarer shares the last.
const CAUSES: [[u8; 3]; 8] = [
    [215, 48, 39],
    [69, 117, 180],
    [26, 152, 80],
    [152, 78, 163],
    [255, 127, 0],
    [140, 86, 75],
    [23, 190, 207],
    [90, 90, 90],
];

/// The share of what is allowed that each pixel uses, in colours from [`SHARE_ENDS`]; [`BEYOND`] where it differs.
///
/// # Errors
/// Where the report is of a picture of another size.
pub(super) fn shares(pair: &PairReport, viewport: Viewport) -> Result<Picture, gbuffer::GBufferError> {
    painted(pair, viewport, |used| match (used.share, used.cause) {
        (_, Some(_)) => BEYOND,
        (None, None) => NO_VERDICT,
        (Some(share), None) => {
            let [low, high] = SHARE_ENDS;
            let mixed = |k: usize| f32::from(low[k]) + share.clamp(0.0, 1.0) * (f32::from(high[k]) - f32::from(low[k]));
            [0, 1, 2].map(|k| mixed(k).round() as u8)
        }
    })
}

/// Why each pixel differs, in the colours of [`legend`].
///
/// # Errors
/// Where the report is of a picture of another size.
pub(super) fn causes(pair: &PairReport, viewport: Viewport) -> Result<Picture, gbuffer::GBufferError> {
    let legend = legend(pair);
    painted(pair, viewport, |used| match used.cause {
        Some(cause) => legend.iter().find(|(own, ..)| *own == cause).map_or(BEYOND, |(_, _, colour)| *colour),
        None if used.share.is_none() => NO_VERDICT,
        None => AGREES,
    })
}

/// The causes of a pair with their counts and colours, the most frequent first.
pub(super) fn legend(pair: &PairReport) -> Vec<(Cause, usize, [u8; 3])> {
    let mut causes: Vec<(Cause, usize)> = pair.causes.iter().map(|(cause, count)| (*cause, *count)).collect();
    causes.sort_by_key(|(cause, count)| (std::cmp::Reverse(*count), *cause));
    let colour = |k: usize| CAUSES[k.min(CAUSES.len() - 1)];
    causes.into_iter().enumerate().map(|(k, (cause, count))| (cause, count, colour(k))).collect()
}

fn painted(
    pair: &PairReport,
    viewport: Viewport,
    colour: impl Fn(&PixelUse) -> [u8; 3],
) -> Result<Picture, gbuffer::GBufferError> {
    let rgb = pair.uses.iter().map(|used| used.as_ref().map_or(background(), &colour)).collect();
    Picture::new(viewport.width(), viewport.height(), rgb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gbuffer::{GBuffer, Hit};
    use raycast::Caster;
    use scene::Camera;
    use suite::stage::{Plan, Stage};

    /// The map's colours against the report's own counts, of a picture that is right and of one whose normals are wrong in a half.
    #[test]
    fn as_many_pixels_are_beyond_as_differ() {
        let model = models::builtin("teapot").expect("built in");
        let viewport = Viewport::new(48, 48).expect("a size");
        let camera = Camera::framing(&model, viewport);
        let stage = Stage::new(&model, camera, viewport, Plan::default()).expect("a stage");
        let caster = Caster::new(&model);
        let (rays, sound) = (stage.raycast(&caster), stage.raster());
        let flipped =
            |hit: &Hit| Hit { normal: nurbs::Normal::Regular(-hit.normal.unit().unwrap_or_default()), ..*hit };
        let hit = |x: usize, y: usize| if x < 24 { sound.get(x, y).copied() } else { sound.get(x, y).map(flipped) };
        let rows = (0..48).map(|y| (0..48).map(|x| hit(x, y)).collect());
        let wrong = GBuffer::from_rows(viewport, sound.meta().clone(), rows);
        for (buffer, differs) in [(&sound, false), (&wrong, true)] {
            let pair = stage.against_raycast(&caster, &rays, buffer).expect("comparable");
            assert_eq!(pair.differing() > 0, differs);
            let picture = shares(&pair, viewport).expect("of its size");
            let of = |colour: [u8; 3]| picture.rgb().iter().filter(|rgb| **rgb == colour).count();
            assert_eq!([of(BEYOND), of(NO_VERDICT)], [pair.differing(), pair.unbounded]);
            assert_eq!(picture.rgb().len() - of(background()), pair.covered);
            let causes = causes(&pair, viewport).expect("of its size");
            for (_, count, colour) in legend(&pair) {
                assert_eq!(causes.rgb().iter().filter(|rgb| **rgb == colour).count(), count);
            }
        }
    }
}
