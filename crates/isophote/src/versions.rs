//! Two versions of a surface: how far the second is from the first, at each pixel that shows the first.
//!
//! `nearest` finds the point of the second version that is nearest to a place, `measured` asks it at every pixel, `report` says
//! what was found, as a document, a table and one plain line, and `page` as a page.

mod measured;
mod nearest;
mod page;
mod report;

pub use measured::{Measured, Place};
pub use nearest::{Foot, Nearest};
pub use page::page;
pub use report::Report;
