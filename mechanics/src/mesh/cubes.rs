//! Points by the cube of space that they are in, to find those near a place.

use std::collections::HashMap;

use super::Vector;

/// Numbered points in cubes as wide as one searches.
#[derive(Clone, Debug, PartialEq)]
pub struct Cubes {
    width: f64,
    numbers: HashMap<[i64; 3], Vec<u32>>,
}

impl Cubes {
    /// `width` is positive, in mm.
    pub fn new(width: f64, points: impl Iterator<Item = (u32, Vector)>) -> Cubes {
        let mut cubes = Cubes { width, numbers: HashMap::new() };
        for (number, point) in points {
            cubes.numbers.entry(cubes.cube(&point)).or_default().push(number);
        }
        cubes
    }

    /// The numbers of all points at most a width away, and of some farther ones.
    pub fn around(&self, place: &Vector) -> impl Iterator<Item = u32> + '_ {
        let [x, y, z] = self.cube(place);
        let cubes = (0..27).map(move |n| [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1]);
        cubes.filter_map(|cube| self.numbers.get(&cube)).flatten().copied()
    }

    fn cube(&self, place: &Vector) -> [i64; 3] {
        [0, 1, 2].map(|axis| (place[axis] / self.width).floor() as i64)
    }
}
