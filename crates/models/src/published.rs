//! Models with the counts of published ones, for measurements beside theirs; what they show is ours.
//!
//! Geiger's aircraft and turbine and Concheiro's elephant were never published. What is like theirs: the numbers of faces, of
//! Bézier patches and of trim curves, each exactly, and the degrees. What is not: shapes, sizes, and which face has how many.
//!
//! Nothing is stored. A model takes about two kilobytes a surface while it is held: `info quilt-100000` peaks at 237 MB and
//! takes 0.8 s on one core, `info turbine` at 20 MB.

mod aircraft;
mod panel;
mod quilt;
mod tea;
#[cfg(test)]
mod tests;
mod turbine;

use nurbs::Surface;
use scene::{Face, Loop, Model};

pub use quilt::QUILTS;
pub use tea::{SCENES, TeaScene};

/// Names of these models, each with a line on whose counts it has.
pub const PUBLISHED: &[(&str, &str)] = &[
    ("aircraft", "an airliner with Geiger's counts: 158 trimmed faces, 3,157 bicubic patches, 6,134 cubic trim curves"),
    ("turbine", "a cut-open engine with the counts of Geiger's: 221 faces, 87,383 bicubic patches"),
    ("tea-s1", "Concheiro's scene S1: a cup, 26 bicubic patches"),
    ("tea-s2", "S2: a pot, 32 patches"),
    ("tea-s3", "S3: 10 cups, 260 patches"),
    ("tea-s4", "S4: 10 pots, 320 patches"),
    ("tea-s5", "S5: 20 cups, 520 patches"),
    ("tea-s6", "S6: 20 pots, 640 patches"),
    ("tea-s7", "S7: 30 cups, 780 patches"),
    ("tea-s8", "S8: a laid table, 811 patches, where Concheiro has an elephant of as many"),
    ("tea-s9", "S9: 30 pots, 960 patches"),
    ("tea-s10", "S10: 40 cups, 1,040 patches"),
    ("tea-s11", "S11: 40 pots, 1,280 patches"),
    ("tea-s12", "S12: 50 cups, 1,300 patches"),
    ("tea-s13", "S13: 50 pots, 1,600 patches"),
    ("tea-s14", "S14: 100 cups, 2,600 patches"),
    ("tea-s15", "S15: 100 pots, 3,200 patches"),
    ("tea-s16", "S16: ten laid tables, 8,110 patches, where Concheiro has ten elephants"),
    ("quilt-100", "a quilt of 100 bicubic patches, each a face"),
    ("quilt-300", "the same of 300"),
    ("quilt-1000", "the same of 1,000"),
    ("quilt-3000", "the same of 3,000"),
    ("quilt-10000", "the same of 10,000"),
    ("quilt-30000", "the same of 30,000"),
    ("quilt-100000", "the same of 100,000"),
];

/// The model of that name.
pub(crate) fn published(name: &str) -> Option<Model> {
    let surfaces = match name {
        "aircraft" => return Some(trimmed(name, aircraft::aircraft())),
        "turbine" => turbine::turbine(),
        _ => match SCENES.iter().find(|scene| scene.name == name) {
            Some(scene) => scene.surfaces(),
            None => quilt::quilt(QUILTS.iter().find(|(quilt, _)| *quilt == name)?.1),
        },
    };
    Some(Model::of_surfaces(name, surfaces).expect("each has a surface"))
}

fn trimmed(name: &str, faces: Vec<(Surface, Vec<Loop>)>) -> Model {
    let (surfaces, loops): (Vec<Surface>, Vec<Vec<Loop>>) = faces.into_iter().unzip();
    let faces = loops.into_iter().enumerate().map(|(k, loops)| Face { loops, ..Face::whole(k) }).collect();
    Model::new(name, surfaces, faces).expect("each face has its surface, and loops that bound a region")
}
