//! A part of a surface is that part: same points at the same parameters, and no other domain.

use nurbs::Direction;

#[test]
fn a_part_of_a_surface_has_its_points() {
    for name in ["teapot", "weights-629", "islands", "sphere", "unclamped-rational"] {
        let model = models::builtin(name).expect("built in");
        let surface = &model.surfaces()[0];
        for direction in [Direction::U, Direction::V] {
            let (start, end) = surface.knots(direction).domain();
            let at = |share: f64| start + share * (end - start);
            let part = surface.restricted(direction, [at(0.3), at(0.8)]).expect("a part of the domain");
            assert_eq!(part.knots(direction).domain(), (at(0.3), at(0.8)));
            let [[u0, u1], [v0, v1]] = part.domain();
            for i in 0..=8 {
                for j in 0..=8 {
                    let (u, v) = (u0 + (u1 - u0) * i as f64 / 8.0, v0 + (v1 - v0) * j as f64 / 8.0);
                    let off = part.point(u, v).distance(surface.point(u, v));
                    assert!(off <= 1e-12 * surface.hull().diagonal(), "{name}: {off:e}");
                }
            }
            assert!(surface.restricted(direction, [at(0.5), at(1.5)]).is_err());
            assert!(surface.restricted(direction, [at(0.5), at(0.5)]).is_err());
        }
    }
}
