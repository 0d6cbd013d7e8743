//! Lines against a picture of pixels: between two neighbouring pixels of one sheet there is a line if, and only if, they are in
//! different bands.
//!
//! The picture knows nothing of lines: a ray a pixel, and the angle of its normal. A line that crosses the half pixel from a
//! centre to the next, where no band ends, is wrong; and so is a band that ends where no line crosses. So a line is within
//! half a pixel of its border, and a border of its line.

use gbuffer::{Hit, ShadeKind, Shading};
use glam::DVec2;
use isophote::sight::Sight;
use lines::{Family, draw, svg};
use raycast::Caster;
use scene::{Camera, Model, Viewport};
use std::collections::{BTreeMap, BTreeSet};

/// A line this near to a pixel's centre may be on either side of it, pixels: twice what chords are off.
const NEAR: f64 = 0.15;

/// Neighbours whose faces differ are one sheet up to this angle between their normals, radians: beyond it is an edge.
const EDGE: f64 = 0.1;

/// Steps between two pixels where line and picture differ.
const BETWEEN: usize = 64;

/// A level, hundredths of a degree, and the lines of it.
type Lines = BTreeMap<i64, Vec<Vec<DVec2>>>;

/// How often the way from a pixel's centre by a step to its neighbour is crossed.
type Crossed = BTreeMap<([usize; 2], [usize; 2]), usize>;

/// What was found of a picture and its lines.
#[derive(Debug, Default)]
struct Checked {
    /// Pairs of neighbours on one sheet, and those with a border between them, over all levels.
    pairs: usize,
    borders: usize,
    /// Pairs of pixels with something behind something.
    apart: usize,
    /// Where line and picture differ: level, place, whether there is a line.
    wrong: Vec<(i64, [usize; 2], bool)>,
}

struct Scene {
    model: Model,
    camera: Camera,
    viewport: Viewport,
    shading: Shading,
}

impl Scene {
    fn new(model: &str, side: usize) -> Self {
        let model = models::builtin(model).expect("built in");
        let viewport = Viewport::new(side, side).expect("a size");
        let camera = Camera::framing(&model, viewport);
        let shading = Shading::new(ShadeKind::Isophotes).with_band_deg(10.0).expect("a width");
        Self { model, camera, viewport, shading }
    }

    /// The lines as their file has them.
    fn lines(&self) -> Lines {
        let light = self.shading.light(&self.camera);
        let family = Family::Isophotes { light, degrees: self.shading.band_borders() };
        let eye = Sight::new(&self.model, self.camera, self.viewport);
        let drawing = draw(&self.model, &self.camera, self.viewport, &[family], &eye);
        assert!(drawing.unfinished.is_empty(), "{:?}", drawing.unfinished);
        let text = svg(&drawing, &self.camera, self.viewport, "test", false);
        let mut lines = Lines::new();
        for path in text.lines().filter(|line| line.starts_with("<path")) {
            let of = |name: &str| {
                let (_, rest) = path.split_once(&format!(" {name}=\"")).expect("an attribute");
                rest.split('"').next().expect("a value")
            };
            let level = (of("data-level").parse::<f64>().expect("a number") * 100.0).round() as i64;
            let place = |text: &str| {
                let (x, y) = text.split_once(' ').expect("two numbers");
                DVec2::new(x.parse().expect("a number"), y.parse().expect("a number"))
            };
            let places = of("d").split(['M', 'L']).filter(|text| !text.is_empty()).map(place).collect();
            lines.entry(level).or_default().push(places);
        }
        lines
    }

    fn check(&self, lines: &Lines) -> Checked {
        let caster = Caster::new(&self.model);
        let buffer = caster.render(&self.camera, self.viewport, &|_| ());
        let light = self.shading.light(&self.camera);
        let (width, height) = (self.viewport.width(), self.viewport.height());
        let mut checked = Checked::default();
        // Neighbours on one sheet.
        let mut sheets = vec![];
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            for (dx, dy) in [(1, 0), (0, 1)] {
                if width <= x + dx || height <= y + dy {
                    continue;
                }
                let (Some(a), Some(b)) = (buffer.get(x, y), buffer.get(x + dx, y + dy)) else { continue };
                let center = |x: usize, y: usize| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if self.is_one_sheet(center(x, y), a, center(x + dx, y + dy), b) {
                    sheets.push(([x, y], [dx, dy], angle(a, light), angle(b, light)));
                } else {
                    checked.apart += 1;
                }
            }
        }
        for degrees in self.shading.band_borders() {
            let level = (degrees * 100.0).round() as i64;
            let none = vec![];
            let (crossed, unsure) = crossings(lines.get(&level).unwrap_or(&none));
            for &([x, y], [dx, dy], a, b) in &sheets {
                if unsure.contains(&[x, y]) || unsure.contains(&[x + dx, y + dy]) {
                    continue;
                }
                let is_border = (a < degrees) != (b < degrees);
                let has_line = crossed.get(&([x, y], [dx, dy])).is_some_and(|count| count % 2 == 1);
                checked.pairs += 1;
                checked.borders += usize::from(is_border);
                if is_border != has_line && self.is_seen_between(&caster, [x, y], [dx, dy]) {
                    checked.wrong.push((level, [x, y], has_line));
                }
            }
        }
        checked
    }

    /// Whether rays between two neighbouring pixels meet one sheet all the way: a tip or a notch may be narrower than a pixel.
    fn is_seen_between(&self, caster: &Caster, [x, y]: [usize; 2], [dx, dy]: [usize; 2]) -> bool {
        let at = |k: usize| {
            let share = k as f64 / BETWEEN as f64;
            let [x, y] = [x as f64 + 0.5 + share * dx as f64, y as f64 + 0.5 + share * dy as f64];
            (DVec2::new(x, y), caster.first(&self.camera.ray(self.viewport, x, y)).hit)
        };
        let seen: Vec<_> = (0..=BETWEEN).map(at).collect();
        let [Some((_, Some(first))), Some((_, Some(last)))] = [seen.first(), seen.last()] else { return false };
        let whole = first.position.distance(last.position);
        seen.windows(2).all(|pair| {
            let [(pa, Some(a)), (pb, Some(b))] = pair else { return false };
            // A leap over what is hidden keeps its length, however short the steps are.
            a.position.distance(b.position) <= 0.5 * whole && self.is_one_sheet(*pa, a, *pb, b)
        })
    }

    /// Whether two neighbouring pixels show places that the surface leads from one to the other: on one face by S_u and S_v, on
    /// two by the tangent plane.
    fn is_one_sheet(&self, pa: DVec2, a: &Hit, pb: DVec2, b: &Hit) -> bool {
        let (Some(na), Some(nb)) = (a.normal.unit(), b.normal.unit()) else { return false };
        let step = b.position - a.position;
        if a.face == b.face {
            let leads = |from: &Hit| {
                let d = self.model.surface(a.face).first_derivatives(from.uv.x, from.uv.y);
                let way = d.su * (b.uv.x - a.uv.x) + d.sv * (b.uv.y - a.uv.y);
                way.distance(step) <= 0.25 * step.length()
            };
            return leads(a) && leads(b);
        }
        let promised = |from: &Hit, n: glam::DVec3, at: DVec2, other: &Hit| {
            let ray = self.camera.ray(self.viewport, at.x, at.y);
            let t = (from.position - ray.origin).dot(n) / ray.direction.dot(n);
            ray.at(t).distance(other.position) <= 0.25 * step.length()
        };
        na.angle_between(nb) <= EDGE && promised(a, na, pb, b) && promised(b, nb, pa, a)
    }
}

/// The acute angle between normal and light, degrees.
fn angle(hit: &Hit, light: glam::DVec3) -> f64 {
    let n = hit.normal.unit().expect("`is_one_sheet` asks for it");
    n.dot(light).abs().clamp(0.0, 1.0).acos().to_degrees()
}

/// How often lines cross the way from each pixel's centre to the next, and the pixels whose centre a line is too near to.
fn crossings(lines: &[Vec<DVec2>]) -> (Crossed, BTreeSet<[usize; 2]>) {
    let mut crossed = Crossed::new();
    let mut unsure = BTreeSet::new();
    for pair in lines.iter().flat_map(|line| line.windows(2)) {
        // In pixels' centres.
        let [a, b] = [pair[0] - 0.5, pair[1] - 0.5];
        for axis in [0, 1] {
            let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
            for k in low.ceil() as i64..=high.floor() as i64 {
                let row = k as f64;
                // What ends on a row is counted once.
                if !(low < row && row <= high) {
                    continue;
                }
                let across = a.lerp(b, (row - a[axis]) / (b[axis] - a[axis]))[1 - axis];
                let (before, nearest) = (across.floor(), across.round());
                if k < 0 || before < 0.0 {
                    continue;
                }
                let pixel =
                    |along: f64| if axis == 0 { [k as usize, along as usize] } else { [along as usize, k as usize] };
                let step = if axis == 0 { [0, 1] } else { [1, 0] };
                *crossed.entry((pixel(before), step)).or_insert(0) += 1;
                if (across - nearest).abs() < NEAR {
                    unsure.insert(pixel(nearest));
                }
            }
        }
    }
    (crossed, unsure)
}

#[test]
fn between_neighbouring_pixels_is_a_line_exactly_where_bands_differ() {
    for (name, side, least) in [("teapot", 200, 1500), ("cap", 120, 300), ("fold", 120, 300)] {
        let scene = Scene::new(name, side);
        let lines = scene.lines();
        let checked = scene.check(&lines);
        let Checked { pairs, borders, apart, wrong } = &checked;
        // Most of the picture is looked at.
        assert!(10 * apart * scene.shading.band_borders().len() < *pairs, "{name}: {apart} pairs of {pairs} are apart");
        assert!(*borders >= least, "{name}: {borders} borders");
        assert!(wrong.is_empty(), "{name}: {wrong:?}");
    }
}

#[test]
fn lines_that_are_moved_left_out_or_of_another_level_are_caught() {
    let scene = Scene::new("cap", 120);
    let lines = scene.lines();
    let moved = |by: DVec2| -> Lines {
        let line = |line: &Vec<DVec2>| line.iter().map(|p| *p + by).collect();
        lines.iter().map(|(level, of)| (*level, of.iter().map(line).collect())).collect()
    };
    let wrong = |lines: &Lines| scene.check(lines).wrong.len();
    assert_eq!(wrong(&lines), 0);
    assert!(0 < wrong(&moved(DVec2::new(0.7, 0.0))), "moved to the right");
    assert!(0 < wrong(&moved(DVec2::new(0.0, -0.7))), "moved up");
    let longest = |(level, of): (&i64, &Vec<Vec<DVec2>>)| (of.iter().map(Vec::len).sum::<usize>(), *level);
    let (_, level) = lines.iter().map(longest).max().expect("lines");
    let mut without = lines.clone();
    without.remove(&level);
    assert!(0 < wrong(&without), "one is left out");
    let next = lines.keys().copied().find(|other| level < *other).expect("another level");
    let mut other = lines.clone();
    let of = other.remove(&level).expect("it is there");
    other.entry(next).or_default().extend(of);
    assert!(0 < wrong(&other), "one has another level");
}
