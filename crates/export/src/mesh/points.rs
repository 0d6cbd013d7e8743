//! Points that several faces share: which of them are one, and where it is.

use glam::DVec3;

/// Points, some of which have been joined (Tarjan 1975, by halving of paths).
#[derive(Default)]
pub(super) struct Points {
    parents: Vec<usize>,
    places: Vec<DVec3>,
}

impl Points {
    /// A new point.
    pub fn add(&mut self, place: DVec3) -> usize {
        self.parents.push(self.parents.len());
        self.places.push(place);
        self.parents.len() - 1
    }

    /// Makes two points one; the earlier one's place stays.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.parents[a.max(b)] = a.min(b);
    }

    /// The first of those that a point is one with.
    pub fn of(&mut self, mut point: usize) -> usize {
        while self.parents[point] != point {
            self.parents[point] = self.parents[self.parents[point]];
            point = self.parents[point];
        }
        point
    }

    /// Where the first of those that a point is one with stands.
    pub fn place(&mut self, point: usize) -> DVec3 {
        let first = self.of(point);
        self.places[first]
    }

    /// The places of points that are the first of their kind, and the number among these of each point.
    pub fn settled(mut self) -> (Vec<DVec3>, Vec<u32>) {
        let (mut places, mut numbers) = (vec![], vec![u32::MAX; self.parents.len()]);
        for point in 0..self.parents.len() {
            let first = self.of(point);
            if numbers[first] == u32::MAX {
                numbers[first] = places.len() as u32;
                places.push(self.places[first]);
            }
            numbers[point] = numbers[first];
        }
        (places, numbers)
    }
}
