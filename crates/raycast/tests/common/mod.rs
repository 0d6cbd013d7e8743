//! Surfaces and rays for the tests.

#![allow(dead_code, reason = "each test file uses some of it")]

use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, Surface};
use raycast::{AllHits, Caster};
use scene::{FaceId, Model, Ray};

/// Numbers in [0, 1), the same on every machine (Steele & Vigna 2021, splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let d = DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if d.length() <= 1.0 && d.length() > 0.01 {
                return d.normalize();
            }
        }
    }
}

pub fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction: direction.normalize(), near: 0.0 }
}

pub fn bezier_knots(degree: usize) -> KnotVector {
    KnotVector::new(degree, [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat()).unwrap()
}

pub fn one(surface: Surface) -> Model {
    Model::of_surfaces("test", vec![surface]).unwrap()
}

/// A whole circle's knots, points of the unit circle's square and weights: four quadratic arcs.
fn circle() -> (KnotVector, Vec<DVec2>, Vec<f64>) {
    let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0]).unwrap();
    let points = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let h = 0.5f64.sqrt();
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { h }).collect();
    (knots, points.iter().map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect(), weights)
}

/// A profile in the half plane (distance from the z axis, z), turned about the axis; u goes around.
pub fn turned(profile_knots: KnotVector, profile: &[DVec2], profile_weights: &[f64], center: DVec3) -> Surface {
    let (knots, around, weights) = circle();
    let mut points = vec![];
    let mut all = vec![];
    for (c, w) in around.iter().zip(&weights) {
        for (p, v) in profile.iter().zip(profile_weights) {
            points.push(center + DVec3::new(c.x * p.x, c.y * p.x, p.y));
            all.push(w * v);
        }
    }
    Surface::new(knots, profile_knots, points, Some(all)).unwrap()
}

/// A whole sphere with both poles collapsed.
pub fn sphere(radius: f64, center: DVec3) -> Surface {
    let h = 0.5f64.sqrt();
    let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
    let profile =
        [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)].map(|(x, z)| DVec2::new(f64::from(x), f64::from(z)) * radius);
    turned(knots, &profile, &[1.0, h, 1.0, h, 1.0], center)
}

/// A torus about the z axis.
pub fn torus(major: f64, minor: f64, center: DVec3) -> Surface {
    let (knots, points, weights) = circle();
    let profile: Vec<DVec2> = points.iter().map(|p| DVec2::new(major + minor * p.x, minor * p.y)).collect();
    turned(knots, &profile, &weights, center)
}

/// A cylinder about the z axis from z = −half to z = half.
pub fn cylinder(radius: f64, half: f64, center: DVec3) -> Surface {
    turned(bezier_knots(1), &[DVec2::new(radius, -half), DVec2::new(radius, half)], &[1.0, 1.0], center)
}

/// A bilinear patch from its corners at (0,0), (0,1), (1,0), (1,1).
pub fn bilinear(corners: [DVec3; 4]) -> Surface {
    Surface::new(bezier_knots(1), bezier_knots(1), corners.to_vec(), None).unwrap()
}

/// A random surface: degrees 1 to 5, up to three spans, from smooth to folded, polynomial or rational to 1 : 1000.
pub fn random_surface(random: &mut Random) -> Surface {
    let (p, q) = (1 + random.below(5), 1 + random.below(5));
    let tiny = random.below(8) == 0;
    let mut knots = |p: usize| {
        let mut k = vec![0.0; p + 1];
        let mut t = 0.0;
        for _ in 0..random.below(3) {
            t += if tiny && random.below(2) == 0 { 1e-9 } else { random.between(0.1, 1.0) };
            for _ in 0..1 + random.below(p) {
                k.push(t);
            }
        }
        t += random.between(0.1, 1.0);
        k.extend(vec![t; p + 1]);
        KnotVector::new(p, k).unwrap()
    };
    let (ku, kv) = (knots(p), knots(q));
    let (nu, nv) = (ku.control_count(), kv.control_count());
    let rough = [0.05, 0.3, 1.0][random.below(3)];
    let size = [1e-3, 1.0, 1e3][random.below(3)];
    let center = match random.below(4) {
        0 => random.direction() * [1e6, 1e9][random.below(2)],
        _ => random.direction() * size,
    };
    let mut points = vec![];
    for i in 0..nu {
        for j in 0..nv {
            let (x, y) = (i as f64 / (nu - 1) as f64 - 0.5, j as f64 / (nv - 1) as f64 - 0.5);
            points.push(
                center
                    + size * (DVec3::new(x, y, 0.4 * (x * 3.0).sin() * y) + rough * random.direction() * random.unit()),
            );
        }
    }
    let weights = match random.below(3) {
        0 => None,
        1 => Some((0..nu * nv).map(|_| random.between(0.5, 2.0)).collect()),
        _ => Some((0..nu * nv).map(|_| 10f64.powf(random.between(0.0, 3.0))).collect()),
    };
    Surface::new(ku, kv, points, weights).unwrap()
}

/// How far a hit may be off the ray: the caster's own bound, and for a check in world coordinates their half ulps.
pub fn allowed(caster: &Caster, ray: &Ray, face: FaceId, uv: DVec2) -> f64 {
    let surface = caster.model().surface(face);
    let d = surface.first_derivatives(uv.x, uv.y);
    let coordinates = d.s.abs().max_element() + ray.origin.abs().max_element();
    // Beside a knot the other span's derivative counts as well, in tiny spans that of some ulp away.
    let grain = [-8.0, 0.0, 8.0].into_iter().fold(0.0, |most: f64, k| {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let (du, dv) = (uv.x.abs() * f64::EPSILON, uv.y.abs() * f64::EPSILON);
        let d = surface.first_derivatives((uv.x + k * du).clamp(u0, u1), (uv.y + k * dv).clamp(v0, v1));
        most.max(d.su.length() * du + d.sv.length() * dv)
    });
    caster.residual_bound(ray, face) + 4.0 * f64::EPSILON * coordinates + 5.0 * grain
}

/// Checks what holds for every list of hits: order, near, and that each lies on the ray and on its surface.
pub fn check(caster: &Caster, ray: &Ray, all: &AllHits) {
    assert!(all.hits.windows(2).all(|w| (w[0].t, w[0].face) <= (w[1].t, w[1].face)), "ascending");
    for hit in &all.hits {
        assert!(hit.t >= ray.near);
        let surface = caster.model().surface(hit.face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        assert!((u0..=u1).contains(&hit.uv.x) && (v0..=v1).contains(&hit.uv.y), "inside the domain: {hit:?}");
        let local = hit.local.expect("the caster knows the span");
        let span = [(Direction::U, local.span[0]), (Direction::V, local.span[1])].map(|(direction, number)| {
            surface.knots(direction).spans().nth(number as usize).expect("a span of the surface")
        });
        assert_eq!(hit.position, surface.inspect_local(span, local.uv).derivatives.s);
        let residual = hit.position.distance(ray.at(hit.t));
        let allowed = allowed(caster, ray, hit.face, hit.uv);
        assert!(residual <= allowed, "{residual:e} off the ray, {allowed:e} allowed: {hit:?}");
        // The parameters in the knot domain name the same place, by evaluation of another kind.
        let global = surface.first_derivatives_on(span[0], span[1], hit.uv.x, hit.uv.y).s.distance(ray.at(hit.t));
        assert!(global <= 2.0 * allowed, "{global:e} off the ray at {}, {allowed:e} allowed: {hit:?}", hit.uv);
    }
    let first = caster.first(ray);
    match (first.hit, all.hits.first()) {
        (Some(a), Some(b)) => assert_eq!((a.face, a.t), (b.face, b.t)),
        (None, None) => {}
        (a, b) => panic!("first says {a:?}, all says {b:?}"),
    }
}
