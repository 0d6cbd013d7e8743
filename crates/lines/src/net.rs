//! The control net: what a surface is made of.

use crate::wire::{Wire, WireKind};
use scene::Model;
use std::collections::BTreeSet;

/// The rows and columns of control points of each surface that has a face, each once.
pub fn net(model: &Model) -> Vec<Wire> {
    let drawn: BTreeSet<usize> = model.faces().iter().map(|face| face.surface).collect();
    let of_surface = |number: usize| {
        let surface = &model.surfaces()[number];
        let [rows, columns] = surface.control_counts();
        let point = move |i: usize, j: usize| surface.points()[i * columns + j];
        let along_v = (0..rows).map(move |i| (0..columns).map(|j| point(i, j)).collect());
        let along_u = (0..columns).map(move |j| (0..rows).map(|i| point(i, j)).collect());
        along_v.chain(along_u).map(|points| Wire { kind: WireKind::Net, points })
    };
    drawn.into_iter().flat_map(of_surface).collect()
}
