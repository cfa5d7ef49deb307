//! Places that hang together because the cubes of space that they are in are neighbours.

use super::Vector;
use super::disjoint_sets::DisjointSets;

/// For each place the number of its cluster, in the order of cubes; some numbers below the count may have no place.
pub struct Clusters {
    pub of_place: Vec<usize>,
    pub count: usize,
}

/// Clusters by cubes of a width in mm.
pub fn clusters(places: &[Vector], width: f64) -> Clusters {
    let cube = |place: &Vector| <[i64; 3]>::from((place / width).map(|x| x.floor() as i64));
    let mut cubes: Vec<[i64; 3]> = places.iter().map(cube).collect();
    cubes.sort_unstable();
    cubes.dedup();
    let mut joined = DisjointSets::new(cubes.len());
    for (number, [x, y, z]) in cubes.iter().enumerate() {
        for step in 0..27 {
            let near = [x + step % 3 - 1, y + step / 3 % 3 - 1, z + step / 9 - 1];
            if let Ok(other) = cubes.binary_search(&near) {
                joined.join(number as u32, other as u32);
            }
        }
    }
    let mut cluster = |place: &Vector| {
        let number = cubes.binary_search(&cube(place)).unwrap_or_default();
        joined.root(number as u32) as usize
    };
    let of_place = places.iter().map(&mut cluster).collect();
    Clusters { of_place, count: cubes.len() }
}
