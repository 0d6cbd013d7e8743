//! Cutting lines where a question about their places has another answer.
//!
//! Places are asked every half pixel along a line, and between two different answers the change is sought by halving. What
//! changes and changes back within half a pixel may be missed.

use crate::frame::Frame;
use crate::place::Place;
use scene::Model;

/// The way from one question to the next, pixels.
const STEP: f64 = 0.5;

/// The most questions for a chord.
const MOST_STEPS: f64 = 4096.0;

/// Halvings of the way between two answers: what is left is 1e-9 pixels.
const HALVINGS: u32 = 29;

/// The runs of a line's places with one answer each, in order; two neighbours share the place of the change.
pub fn runs(line: &[Place], model: &Model, frame: &Frame, asked: impl Fn(&Place) -> bool) -> Vec<(bool, Vec<Place>)> {
    let Some(first) = line.first() else { return vec![] };
    let mut answer = asked(first);
    let mut all = vec![];
    let mut run = vec![*first];
    for pair in line.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let length = frame.distance(from.position, to.position);
        let steps = (length / STEP).ceil().clamp(1.0, MOST_STEPS) as usize;
        let mut before = 0.0;
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            let place = if k == steps { *to } else { from.toward(to, share, model) };
            let next = asked(&place);
            if next != answer {
                let (mut low, mut high) = (before, share);
                // Between two joined ends there is nothing, and on a seam (u, v) jumps there.
                let halvings = if length <= frame.joint() { 0 } else { HALVINGS };
                for _ in 0..halvings {
                    let middle = 0.5 * (low + high);
                    if asked(&from.toward(to, middle, model)) == answer { low = middle } else { high = middle }
                }
                let change = if halvings == 0 { *from } else { from.toward(to, low, model) };
                run.push(change);
                all.push((answer, std::mem::replace(&mut run, vec![change])));
                answer = next;
            }
            before = share;
        }
        run.push(*to);
    }
    all.push((answer, run));
    all
}
