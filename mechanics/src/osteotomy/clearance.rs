//! Clearance of cuts from structures that must not be sawn.
//!
//! The distance of a line from the face of a cut is exact: 0 where it goes through bone that is sawn, else the least of
//! the distances of its points from the face, where their perpendiculars meet it, and of its pieces from the outline.
//! That of a surface is the least of its sides, likewise, and of the outline from its triangles: 0 where the outline goes through
//! one, or lies inside a closed surface. The width of the saw and the radius of the structure come off it.

use super::cut::{Cut, Plane};
use super::cut_face::CutFace;
use super::risk::Risk;
use crate::mesh::surface_edges::count_edges;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use rayon::prelude::*;

/// How far a structure is from where a saw goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Between the saw and the structure, in mm; negative where the saw enters it.
    pub distance: f64,
    /// The place of the structure that is nearest; of the outline where that lies inside it.
    pub at: Vector,
    /// Whether the structure meets the face of the cut.
    pub is_crossed: bool,
}

/// A place of the structure and its distance from the face.
type Nearest = (f64, Vector);

/// The clearance of a structure from the bone that a cut saws; `None` without any.
pub fn clearance(risk: &Risk, cut: &Cut, face: &CutFace) -> Option<Clearance> {
    let outline = Outline::new(cut.plane(), face);
    let edges = risk.edges();
    let of_edges = edges.par_iter().filter_map(|[from, to]| outline.nearest(*from, *to));
    let of_edges = of_edges.min_by(|a, b| a.0.total_cmp(&b.0));
    let of_outline = outline.nearest_to_surface(risk);
    let (distance, at) =
        of_edges.into_iter().chain(of_outline).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let saw = cut.kerf() / 2.0;
    Some(Clearance { distance: distance - saw - risk.radius, at, is_crossed: distance <= saw })
}

/// The face of a cut in the axes of its plane.
struct Outline<'a> {
    plane: &'a Plane,
    face: &'a CutFace,
    flat: Vec<Vec<[f64; 2]>>,
}

impl<'a> Outline<'a> {
    fn new(plane: &'a Plane, face: &'a CutFace) -> Self {
        let flat = |path: &Vec<Vector>| path.iter().map(|point| flat(plane, point)).collect();
        Outline { plane, face, flat: face.paths.iter().map(flat).collect() }
    }

    /// Whether the perpendicular of a point meets the face: by the parity of the sides to its right.
    fn is_over(&self, point: &Vector) -> bool {
        let [x, y] = flat(self.plane, point);
        let mut is_over = false;
        for path in &self.flat {
            for (a, b) in path.iter().zip(path.iter().cycle().skip(1)) {
                let spans = (a[1] > y) != (b[1] > y);
                if spans && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) {
                    is_over = !is_over;
                }
            }
        }
        is_over
    }

    /// The place of a piece of a line that is nearest to the face.
    fn nearest(&self, from: Vector, to: Vector) -> Option<Nearest> {
        let heights = [from, to].map(|point| self.plane.height(&point));
        if (heights[0] > 0.0) != (heights[1] > 0.0) {
            let through = from + (to - from) * (heights[0] / (heights[0] - heights[1]));
            if self.is_over(&through) {
                return Some((0.0, through));
            }
        }
        let ends = [(from, heights[0]), (to, heights[1])].into_iter();
        let over = ends.filter(|(end, _)| self.is_over(end)).map(|(end, h)| (h.abs(), end));
        let sides = self.face.paths.iter().flat_map(|path| {
            let ends = path.iter().zip(path.iter().cycle().skip(1));
            ends.map(|(a, b)| between([from, to], [*a, *b]))
        });
        over.chain(sides).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Outline<'_> {
    /// The place of a surface that is nearest to the outline; none of a line.
    fn nearest_to_surface(&self, risk: &Risk) -> Option<Nearest> {
        let (points, triangles) = (risk.points.clone(), risk.triangles.clone());
        let surface = TriangleSurface { points, triangles, node_ids: None };
        let search = SurfaceSearch::new(&surface).ok().filter(|_| !risk.triangles.is_empty())?;
        let is_closed = count_edges(&surface.sorted_sides()).open == 0;
        // Positive where its triangles turn outwards.
        let volume: f64 = (0..surface.triangles.len())
            .map(|triangle| surface.corners(triangle))
            .map(|[a, b, c]| a.dot(&b.cross(&c)))
            .sum();
        let ends = |path: &Vec<Vector>| -> Vec<[Vector; 2]> {
            let ends = path.iter().zip(path.iter().cycle().skip(1));
            ends.map(|(a, b)| [*a, *b]).collect()
        };
        let sides: Vec<[Vector; 2]> = self.face.paths.iter().flat_map(ends).collect();
        let of = |[a, b]: &[Vector; 2]| -> Nearest {
            let closest = search.closest(a);
            if is_closed && volume * search.signed_distance(a, &closest) < 0.0 {
                return (0.0, *a);
            }
            let mut corners =
                (0..surface.triangles.len()).map(|triangle| surface.corners(triangle));
            let met = corners.find_map(|corners| through(corners, *a, *b));
            met.map_or((closest.distance, closest.point), |at| (0.0, at))
        };
        sides.par_iter().map(of).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Where a straight way goes through a triangle. Source: Möller and Trumbore, Fast, minimum storage ray/triangle intersection,
/// Journal of Graphics Tools 2 (1997).
fn through([a, b, c]: [Vector; 3], from: Vector, to: Vector) -> Option<Vector> {
    let (way, one, other) = (to - from, b - a, c - a);
    let across = way.cross(&other);
    let volume = one.dot(&across);
    if volume == 0.0 {
        return None;
    }
    let apart = from - a;
    let u = apart.dot(&across) / volume;
    let turned = apart.cross(&one);
    let (v, share) = (way.dot(&turned) / volume, other.dot(&turned) / volume);
    let is_in = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&share);
    is_in.then(|| from + way * share)
}

fn flat(plane: &Plane, point: &Vector) -> [f64; 2] {
    plane.axes().map(|axis| (point - plane.point()).dot(&axis))
}

/// The distance of two pieces of lines, and the place of the first that is nearest.
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.9.
fn between([p, p_end]: [Vector; 2], [q, q_end]: [Vector; 2]) -> Nearest {
    let (along, other, apart) = (p_end - p, q_end - q, p - q);
    let (a, e) = (along.norm_squared(), other.norm_squared());
    let (b, c, f) = (along.dot(&other), along.dot(&apart), other.dot(&apart));
    let part =
        |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    // On the line of the second, then on each as far as both reach.
    let denominator = a * e - b * b;
    let mut s = if denominator > 1e-12 * a * e { part(b * f - c * e, denominator) } else { 0.0 };
    let t = part(b * s + f, e);
    s = part(b * t - c, a);
    let t = part(b * s + f, e);
    let at = p + along * s;
    ((at - (q + other * t)).norm(), at)
}

#[cfg(test)]
mod tests {
    use super::super::cut_face::cut_faces;
    use super::super::{CutSide, Extent, Osteotomy, SegmentRule, Side};
    use super::*;
    use crate::mesh::sample::block;
    use crate::mesh::{CellShape, VolumeMesh};

    /// Half of a block of 40 x 30 x 20 mm, below a cut of a saw of that width halfway up.
    fn halved(kerf: f64) -> (Osteotomy, TriangleSurface) {
        let height = 10.0 - kerf / 2.0;
        let mesh = block(Vector::new(40.0, 30.0, height), [20, 15, 5], CellShape::Hex8);
        let surface = mesh.surface_of(&mesh.boundary_faces());
        let plane = Plane::new(Vector::new(5.0, 5.0, 10.0), Vector::z()).unwrap();
        let cut = Cut::new("cut", plane, None, kerf).unwrap();
        let sides = vec![CutSide { cut: 0, side: Side::Below }];
        let segment = SegmentRule { name: "half".to_owned(), sides, seeds: Vec::new() };
        (Osteotomy::new(vec![cut], vec![segment]).unwrap(), surface)
    }

    #[test]
    fn a_cut_goes_around_the_bone_that_it_saws_and_has_its_area() {
        let (osteotomy, surface) = halved(1.0);
        let faces = cut_faces(&osteotomy, &[surface], 0.5);
        let [face] = &faces[..] else { panic!("{faces:?}") };
        assert!((face.area - 1200.0).abs() < 1e-9 && face.paths.len() == 1, "{}", face.area);
        assert!(face.paths[0].iter().all(|point| (point.z - 10.0).abs() < 1e-12));
        // A tube has a path of its own around its hole.
        let mesh = block(Vector::new(30.0, 30.0, 10.0), [3, 3, 2], CellShape::Hex8);
        let mut tube = VolumeMesh { nodes: mesh.nodes.clone(), ..VolumeMesh::default() };
        for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
            let middle = mesh.corners(cell).sum::<Vector>() / 8.0;
            if (middle.xy() - nalgebra::Vector2::repeat(15.0)).norm() > 1.0 {
                tube.cells.push(shape, nodes);
            }
        }
        let surface = tube.surface_of(&tube.boundary_faces());
        let faces = cut_faces(&osteotomy, &[surface], 0.5);
        assert!((faces[0].area - 800.0).abs() < 1e-9 && faces[0].paths.len() == 2);
    }

    #[test]
    fn a_plane_that_does_not_reach_the_segment_and_a_bounded_cut_beside_it_saw_nothing() {
        let (osteotomy, mut surface) = halved(0.0);
        surface.points.iter_mut().for_each(|point| point.z -= 1.0);
        assert!(cut_faces(&osteotomy, std::slice::from_ref(&surface), 0.5).is_empty());
        surface.points.iter_mut().for_each(|point| point.z += 1.0);
        let plane = Plane::new(Vector::new(90.0, 5.0, 10.0), Vector::z()).unwrap();
        let disc = Some(Extent::Disc { radius: 20.0 });
        let cut = Cut::new("cut", plane, disc, 0.0).unwrap();
        let segment =
            SegmentRule { seeds: vec![Vector::zeros()], ..osteotomy.segments()[0].clone() };
        let beside = Osteotomy::new(vec![cut], vec![segment]).unwrap();
        assert!(cut_faces(&beside, &[surface], 0.5).is_empty());
    }

    #[test]
    fn clearances_are_those_of_lines_from_a_rectangle() {
        let (osteotomy, surface) = halved(1.0);
        let face = &cut_faces(&osteotomy, &[surface], 0.5)[0];
        let cut = &osteotomy.cuts()[0];
        let of = |points: &[[f64; 3]], radius: f64| {
            let points = points.iter().map(|&point| Vector::from(point)).collect();
            let triangles = Vec::new();
            let risk = Risk { name: "nerve".to_owned(), points, triangles, radius, clearance: 2.0 };
            clearance(&risk, cut, face).unwrap()
        };
        // Above the face, and nearest in the middle of a bent line: 4 mm, less half a saw and the radius.
        let above = of(&[[10.0, 5.0, 16.0], [20.0, 15.0, 14.0], [30.0, 5.0, 16.0]], 1.5);
        assert!((above.distance - (4.0 - 0.5 - 1.5)).abs() < 1e-12 && !above.is_crossed);
        assert!((above.at - Vector::new(20.0, 15.0, 14.0)).norm() < 1e-12);
        // Beside it, along an edge: 3 mm off and 4 mm up.
        let beside = of(&[[43.0, -50.0, 14.0], [43.0, 80.0, 14.0]], 0.0);
        assert!((beside.distance - (5.0 - 0.5)).abs() < 1e-12, "{beside:?}");
        // Through the plane beside the bone, and through the bone.
        let passing = of(&[[50.0, 15.0, 0.0], [50.0, 15.0, 30.0]], 0.0);
        assert!((passing.distance - 9.5).abs() < 1e-12 && !passing.is_crossed, "{passing:?}");
        let through = of(&[[20.0, 15.0, 0.0], [20.0, 15.0, 30.0]], 1.0);
        assert!((through.distance + 1.5).abs() < 1e-12 && through.is_crossed, "{through:?}");
        // Within the width of the saw, though not through its middle.
        let sawn = of(&[[5.0, 5.0, 10.3], [35.0, 25.0, 10.3]], 0.0);
        assert!((sawn.distance + 0.2).abs() < 1e-12 && sawn.is_crossed, "{sawn:?}");
    }
    /// A sphere by parallels and meridians, with a point at each pole.
    fn sphere(centre: [f64; 3], radius: f64) -> Risk {
        let (rows, columns) = (60_u32, 120_u32);
        let place = |row: u32, column: u32| {
            let down = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let around = 2.0 * std::f64::consts::PI * f64::from(column) / f64::from(columns);
            let flat = down.sin();
            let out = Vector::new(flat * around.cos(), flat * around.sin(), down.cos());
            Vector::from(centre) + out * radius
        };
        let mut points = vec![place(0, 0)];
        points.extend((1..rows).flat_map(|row| (0..columns).map(move |column| place(row, column))));
        points.push(place(rows, 0));
        let last = points.len() as u32 - 1;
        let at = |row: u32, column: u32| match row {
            0 => 0,
            row if row == rows => last,
            row => 1 + (row - 1) * columns + column % columns,
        };
        let mut triangles = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                triangles.extend((row > 0).then_some([a, c, b]));
                triangles.extend((row + 1 < rows).then_some([b, c, d]));
            }
        }
        Risk { name: "root".to_owned(), points, triangles, radius: 0.0, clearance: 2.0 }
    }

    #[test]
    fn clearances_are_those_of_spheres_from_a_rectangle() {
        let (osteotomy, surface) = halved(1.0);
        let face = &cut_faces(&osteotomy, &[surface], 0.5)[0];
        let of = |centre: [f64; 3], radius: f64| {
            clearance(&sphere(centre, radius), &osteotomy.cuts()[0], face).unwrap()
        };
        // The rectangle of 40 x 30 mm at a height of 10 mm: the distance of the middle, less the radius and half a saw.
        for (centre, radius, apart, most) in [
            // Above the face, where the pole is a point of the surface.
            ([20.0, 15.0, 16.0], 3.0, 6.0, 1e-9),
            // Beside an edge, and beyond a corner; flat triangles lie up to 0.005 mm inside.
            ([43.0, 15.0, 14.0], 3.0, 5.0, 0.01),
            ([43.0, 34.0, 22.0], 3.0, 13.0, 0.01),
        ] {
            let found = of(centre, radius);
            let wanted = apart - radius - 0.5;
            assert!((found.distance - wanted).abs() < most, "{centre:?}: {found:?}");
            assert!(!found.is_crossed);
            let on = (found.at - Vector::from(centre)).norm();
            assert!((on - radius).abs() < 0.01, "{found:?}");
        }
        // Through the face, through its outline only, and around all of it.
        for (centre, radius) in
            [([20.0, 15.0, 11.0], 3.0), ([41.0, 15.0, 10.0], 3.0), ([20.0, 15.0, 10.0], 100.0)]
        {
            let found = of(centre, radius);
            assert!(found.is_crossed && (found.distance + 0.5).abs() < 1e-12, "{found:?}");
        }
        let thick = Risk { radius: 1.5, ..sphere([20.0, 15.0, 16.0], 3.0) };
        let found = clearance(&thick, &osteotomy.cuts()[0], face).unwrap();
        assert!((found.distance - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn an_outline_that_goes_through_one_large_triangle_crosses_it() {
        let (osteotomy, surface) = halved(1.0);
        let face = &cut_faces(&osteotomy, &[surface], 0.5)[0];
        // Upright at x = 20, with its corners far beyond the face.
        let points = [[20.0, -200.0, -300.0], [20.0, 230.0, -300.0], [20.0, 15.0, 400.0]];
        let wall = Risk {
            name: "wall".to_owned(),
            points: points.map(Vector::from).to_vec(),
            triangles: vec![[0, 1, 2]],
            radius: 0.0,
            clearance: 1.0,
        };
        let found = clearance(&wall, &osteotomy.cuts()[0], face).unwrap();
        assert!(found.is_crossed && (found.distance + 0.5).abs() < 1e-12, "{found:?}");
    }
}
