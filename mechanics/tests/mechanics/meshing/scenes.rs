//! What is promised of meshes, held against many bodies that touch themselves at random.

use std::collections::{HashMap, HashSet};

use mechanics::mesh::crossing::self_crossings;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::meshing::{MeshingError, MeshingSettings, RegionShape, SizeField, SizeRegion, mesh};
use mechanics::progress::Unobserved;

use super::domains::{Body, Slit, balls, slit_ball};
use super::{assert_sound, surface, uniform};

/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        (bits ^ bits >> 31) as f64 / u64::MAX as f64
    }

    fn place(&mut self, half: f64) -> Vector {
        Vector::from([0, 1, 2].map(|_| (2.0 * self.next() - 1.0) * half))
    }
}

/// Two to sixteen balls, a ball with such holes, or a ball with gaps thinner than a cell.
fn scene(seed: u64) -> Body {
    let mut random = Random(seed);
    let count = 2 + (random.next() * 14.0) as usize;
    if seed % 3 == 2 {
        let slit = |_| Slit {
            normal: random.place(1.0).normalize(),
            offset: 6.0 * random.next() - 3.0,
            half_width: 0.05 + 0.7 * random.next(),
        };
        return slit_ball(15.0, (0..count / 4).map(slit).collect());
    }
    let list = (0..count).map(|_| (random.place(14.0), 1.5 + 6.0 * random.next()));
    let within = balls(list.collect());
    if seed.is_multiple_of(3) {
        return within;
    }
    let holes = within.parts.into_iter().next().unwrap().1;
    Body::skin(18.0, move |x| (18.0 - x.norm()).min(-holes(x)))
}

#[test]
fn meshes_of_random_balls_holes_and_gaps_are_sound() {
    let mut worst = [180.0_f64; 2];
    let (mut pinches, mut refused) = (0, 0);
    for seed in 0..42 {
        let body = scene(seed);
        let fine = SizeRegion {
            shape: RegionShape::Ball { centre: Vector::zeros(), radius: 5.0 },
            size: 1.0,
        };
        let graded = SizeField { coarsest: 5.0, regions: vec![fine], ..SizeField::uniform(1.0) };
        let graded = MeshingSettings { size: graded, ..MeshingSettings::default() };
        for (kind, settings) in [uniform(1.9), graded].into_iter().enumerate() {
            let tissue = match mesh(&body, &settings, &Unobserved) {
                // Of many balls the largest may be less than a third of all.
                Err(MeshingError::Scattered { .. }) => {
                    refused += 1;
                    continue;
                }
                meshed => meshed.unwrap(),
            };
            let angles = assert_sound(&tissue);
            worst[kind] = worst[kind].min(angles[0]).min(180.0 - angles[1]);
            pinches += tissue.report.copies + tissue.report.stepped_back + tissue.report.edges_cut;
        }
    }
    assert!(pinches > 5 && refused < 20, "{pinches} {refused}");
    assert!(worst[0] >= 12.0 && worst[1] >= 10.0, "{worst:?}");
}

/// Fans of triangles about each node that share no edge, and nodes at one place, as nodes in excess.
fn nodes_in_excess(surface: &TriangleSurface) -> usize {
    let mut around: HashMap<u32, Vec<[u32; 2]>> = HashMap::new();
    for [a, b, c] in &surface.triangles {
        for (node, next) in [(*a, [*b, *c]), (*b, [*c, *a]), (*c, [*a, *b])] {
            around.entry(node).or_default().push(next);
        }
    }
    let rings = |edges: &Vec<[u32; 2]>| {
        let after: HashMap<u32, u32> = edges.iter().map(|[from, to]| (*from, *to)).collect();
        let first = edges[0][0];
        let ring = std::iter::successors(Some(after[&first]), |at| Some(after[at]));
        usize::from(ring.take_while(|at| *at != first).count() + 1 < edges.len())
    };
    let place = |point: &Vector| [point.x, point.y, point.z].map(f64::to_bits);
    let places: HashSet<[u64; 3]> = surface.points.iter().map(place).collect();
    around.values().map(rings).sum::<usize>() + surface.points.len() - places.len()
}

#[test]
fn a_boundary_without_coincident_nodes_touches_and_crosses_itself_nowhere() {
    let mut mended = 0;
    for seed in 0..15 {
        let body = scene(seed);
        let settings = uniform(1.9);
        let Ok(as_made) = mesh(&body, &settings, &Unobserved) else { continue };
        let settings = MeshingSettings { part_copies: true, ..settings };
        let apart = mesh(&body, &settings, &Unobserved).unwrap();
        let angles = assert_sound(&apart);
        assert!(angles[0].min(180.0 - angles[1]) >= 5.0, "{seed}: {angles:?}");
        let boundary = surface(&apart);
        assert_eq!(self_crossings(&boundary, |_| true).count, 0, "{seed}");
        assert_eq!(nodes_in_excess(&boundary), 0, "{seed}");
        assert_eq!((apart.report.crossings, apart.report.voids_touching), (0, 0), "{seed}");
        mended += nodes_in_excess(&surface(&as_made));
    }
    assert!(mended > 2, "{mended}");
}
