//! Which places of two borders correspond, with a proof.
//!
//! The place of border B that corresponds to C_A(s) is the foot of the perpendicular: C_B(r) with (C_A(s) − C_B(r)) · C_B'(r) = 0.
//! Both borders are cut at places that correspond, the *pins*: their ends, the cuts of A with their feet on B, and those of B
//! with the places of A that have their feet there. Between two pins stands a [`Tube`]: all pairs (s, r) with |r − r̃(s)| ≤ δ, r̃ a polynomial through
//! the pins. Two things are known of it:
//!
//! * It holds a path from pin to pin on which s and r run through all values. So the greatest distance of its pairs is at least
//!   the Hausdorff distance of the two curves, both ways.
//! * Where [`Tube::is_foot`], it holds the foot of every s, by Newton's argument: with F(s, r) the product above and |F_r| ≥ m
//!   on the tube, |F(s, r̃(s))| ≤ m δ makes F change its sign within.
//!
//! Where that is not shown, δ is so wide that the tube holds every r between the pins.

use crate::border::{Along, Border};
use crate::taylor::{ORDER, Taylor, UNIT, Vector, difference, dot};
use glam::DVec3;

/// Cuts of the two borders that correspond up to this share of the border's length are one pin.
const SAME_PIN: f64 = 1e-9;

/// How often δ is widened before the tube takes all between the pins.
const WIDENINGS: usize = 2;

/// A stretch of B that is this much longer than that of A is more than its feet: one border ends before the other.
const MUCH_LONGER: f64 = 2.0;

/// Roundings on the way from feet to a polynomial through them.
const PINS: f64 = 64.0;

/// What is kept of |F_r|, beside what is proven, when a first δ is guessed.
const GUESS: f64 = 0.5;

/// A stretch between two pins, on one piece of each border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// From and to, parameters of A.
    pub s: [f64; 2],
    /// From and to, parameters of B.
    pub r: [f64; 2],
    /// Indices of the pieces.
    pub pieces: [usize; 2],
}

/// Two borders that run the same way along an edge.
#[derive(Clone, Copy)]
pub struct Pair<'a, 'm> {
    /// A.
    pub a: &'a Border<'m>,
    /// B.
    pub b: &'a Border<'m>,
}

/// Both borders over a stretch, as functions of τ from −1 to 1.
pub struct Tube {
    /// s(τ): linear.
    pub s: Taylor,
    /// r(τ), with δ.
    pub r: Taylor,
    /// The borders there.
    pub sides: [Along; 2],
    /// C_A − C_B.
    pub apart: Vector,
    /// Whether it holds the feet.
    pub is_foot: bool,
}

impl Pair<'_, '_> {
    /// The stretches between pins, in order.
    pub fn stretches(&self) -> Vec<Stretch> {
        let pins = self.pins();
        let stretch = |pair: &[[f64; 2]]| {
            let [[s0, r0], [s1, r1]] = [pair[0], pair[1]];
            let pieces = [self.a.index(0.5 * (s0 + s1)), self.b.index(0.5 * (r0 + r1))];
            Stretch { s: [s0, s1], r: [r0, r1], pieces }
        };
        pins.windows(2).map(stretch).collect()
    }

    fn pins(&self) -> Vec<[f64; 2]> {
        let (a, b) = (self.a, self.b);
        let same = SAME_PIN * a.length().max(b.length());
        let guess = |from: &Border, to: &Border, t: f64| to.at_length(from.length_to(t) / from.length() * to.length());
        let cuts = |border: &Border| (1..border.count()).map(|i| i as f64).collect::<Vec<_>>();
        let on_a = cuts(a).into_iter().map(|s| [s, b.foot(a.at(s).position, guess(a, b, s))]).collect::<Vec<_>>();
        let on_b = cuts(b).into_iter().map(|r| {
            // From the foot on A, which is near even where the guess is not.
            let (place, guess) = (b.at(r), guess(b, a, r));
            [r, a.with_foot(&place, a.foot(place.position, guess))]
        });
        let on_b = on_b.collect::<Vec<_>>();
        let (mut next_a, mut next_b) = (on_a.iter().peekable(), on_b.iter().peekable());
        let mut pins = vec![[0.0, 0.0]];
        loop {
            let last = pins[pins.len() - 1];
            let pin = match (next_a.peek(), next_b.peek()) {
                (None, None) => break,
                (Some(&&[s, r]), None) => {
                    next_a.next();
                    [s, r]
                }
                (None, Some(&&[r, s])) => {
                    next_b.next();
                    [s, r]
                }
                (Some(&&[s_a, r_a]), Some(&&[r_b, s_b])) => {
                    let is_same = (a.length_to(s_a) - a.length_to(s_b)).abs() <= same;
                    // A cut of one before, and behind, one of the other: they are one, off their feet by what is between.
                    if is_same || (s_a < s_b) != (r_a < r_b) {
                        next_a.next();
                        next_b.next();
                        [s_a, r_b]
                    } else if s_a < s_b {
                        next_a.next();
                        [s_a, r_a.min(r_b)]
                    } else {
                        next_b.next();
                        [s_b.min(s_a), r_b]
                    }
                }
            };
            pins.push([pin[0].max(last[0]), pin[1].max(last[1])]);
        }
        pins.push([a.end(), b.end()]);
        pins
    }

    /// The two halves of a stretch; the pin between is a foot. The border that is much longer is cut at its middle, else A.
    pub fn halves(&self, stretch: &Stretch) -> [Stretch; 2] {
        let Stretch { s: [s0, s1], r: [r0, r1], pieces: [on_a, on_b] } = *stretch;
        let chord =
            |border: &Border, on, from, to| border.at_on(on, from).position.distance(border.at_on(on, to).position);
        let (middle_s, middle_r) = (0.5 * (s0 + s1), 0.5 * (r0 + r1));
        let [s, r] = if MUCH_LONGER * chord(self.a, on_a, s0, s1) < chord(self.b, on_b, r0, r1) {
            [self.a.with_foot_on(on_a, &self.b.at_on(on_b, middle_r), middle_s, stretch.s), middle_r]
        } else {
            [middle_s, self.foot(stretch, middle_s, middle_r)]
        };
        [Stretch { s: [s0, s], r: [r0, r], ..*stretch }, Stretch { s: [s, s1], r: [r, r1], ..*stretch }]
    }

    /// The foot of a place of A, on the stretch.
    fn foot(&self, stretch: &Stretch, s: f64, guess: f64) -> f64 {
        let [on_a, on_b] = stretch.pieces;
        self.b.foot_on(on_b, self.a.at_on(on_a, s).position, guess, stretch.r)
    }

    /// The tube of a stretch; `None` where a border has no bound there.
    pub fn tube(&self, stretch: &Stretch) -> Option<Tube> {
        let [s0, s1] = stretch.s;
        let [r0, r1] = stretch.r;
        let [on_a, on_b] = stretch.pieces;
        let s = Taylor::between(s0, s1);
        let first = self.a.along(on_a, s.plus(-(on_a as f64)))?;
        let second = |r: Taylor| self.b.along(on_b, r.plus(-(on_b as f64)));
        let r = self.feet(stretch);
        let residual = second(r).map(|side| (dot(&apart(&first, &side), &side.motion[0]).magnitude(), side));
        let mut width = residual.as_ref().map_or(f64::INFINITY, |(f, side)| {
            let speed = dot(&side.motion[0], &side.motion[0]).middle();
            f / (GUESS * speed) + PINS * UNIT * r0.abs().max(r1.abs())
        });
        for _ in 0..WIDENINGS {
            let is_useful = width < r1 - r0;
            let Some((residual, _)) = residual.as_ref().filter(|_| is_useful) else { break };
            let wide = r.widened(width);
            let Some(side) = second(wide) else { break };
            let apart = apart(&first, &side);
            let [velocity, acceleration] = &side.motion;
            let least = -(-dot(velocity, velocity)).peak().upper;
            let lost = dot(&apart, &apart).peak().upper.sqrt() * dot(acceleration, acceleration).peak().upper.sqrt();
            let slope = least - lost * (1.0 + 8.0 * UNIT);
            let needed = residual / slope;
            if 0.0 < slope && needed <= width {
                return Some(Tube { s, r: wide, sides: [first, side], apart, is_foot: true });
            }
            width = if 0.0 < slope { 1.5 * needed } else { f64::INFINITY };
        }
        let all = Taylor::ball(0.5 * (r0 + r1), 0.5 * (r1 - r0) * (1.0 + 4.0 * UNIT) + 2.0 * UNIT * r1.abs());
        let side = second(all)?;
        Some(Tube { s, r: all, apart: apart(&first, &side), sides: [first, side], is_foot: false })
    }

    /// The polynomial through the pins, and between them through the feet at Chebyshev's points.
    fn feet(&self, stretch: &Stretch) -> Taylor {
        let [s0, s1] = stretch.s;
        let [r0, r1] = stretch.r;
        let nodes: [f64; ORDER + 1] = std::array::from_fn(|i| match i {
            0 => -1.0,
            ORDER => 1.0,
            _ => -libm::cos(std::f64::consts::PI * i as f64 / ORDER as f64),
        });
        // Newton's divided differences.
        let mut table: [f64; ORDER + 1] = [0.0; ORDER + 1];
        for (i, node) in nodes.iter().enumerate() {
            let share = 0.5 * (1.0 + node);
            table[i] = match i {
                0 => r0,
                ORDER => r1,
                _ => self.foot(stretch, s0 + (s1 - s0) * share, r0 + (r1 - r0) * share),
            };
        }
        for k in 1..=ORDER {
            for i in (k..=ORDER).rev() {
                table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - k]);
            }
        }
        let mut polynomial = [0.0; ORDER + 1];
        for k in (0..=ORDER).rev() {
            for i in (0..=ORDER).rev() {
                let lower = if i == 0 { 0.0 } else { polynomial[i - 1] };
                polynomial[i] = lower - polynomial[i] * nodes[k];
            }
            polynomial[0] += table[k];
        }
        Taylor::new(polynomial, 0.0)
    }
}

fn apart(first: &Along, second: &Along) -> Vector {
    let offset: DVec3 = first.origin - second.origin;
    let between = difference(&first.surface.s, &second.surface.s);
    // The difference of the origins is itself rounded.
    let shift = |axis: usize| between[axis].plus(offset[axis]).widened(UNIT * offset[axis].abs());
    [shift(0), shift(1), shift(2)]
}
