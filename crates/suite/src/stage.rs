//! A model, seen: how it is drawn (`plan`), by whom (`drawn`), and whether the pictures agree (`judged`, `shaded`).

mod drawn;
mod judged;
mod plan;
mod shaded;

pub use drawn::{OnGpu, Original, Rendered, Stage};
pub use judged::Rays;
pub use plan::{Path, Plan};
pub use shaded::ShadedReport;
