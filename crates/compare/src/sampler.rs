//! A reference renderer that answers between pixels, too.

use gbuffer::Hit;

/// A reference renderer that can be asked at any position of the picture, in pixels, not only at pixels' centres.
pub trait Sampler: Sync {
    /// What it sees there.
    fn first(&self, x: f64, y: f64) -> Option<Hit>;

    /// All that it draws there, hidden layers too; of a renderer that cannot tell, what it sees.
    fn layers(&self, x: f64, y: f64) -> Vec<Hit> {
        self.first(x, y).into_iter().collect()
    }
}
