//! Muscles in cells: axes, shares, boxes and mixtures against numbers that are known.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use mechanics::conformation::angle_between;
use mechanics::domain::{ClosedSurface, SurfaceName};
use mechanics::image::SamplingRule;
use mechanics::material::mixture::MixingRule;
use mechanics::material::{Fibre, FibreLaw, LinearElastic};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector};
use mechanics::muscle::axis::mean_axis;
use mechanics::muscle::equivalent::{EquivalentTissue, rule_dependent_share};
use mechanics::muscle::lines::{MuscleLines, fibre_cells};
use mechanics::muscle::share::shares_inside;
use mechanics::muscle::strap::{box_surface, strap_of};
use nalgebra::Rotation3;

/// A closed tube of rings about a line, its ends closed by fans.
fn tube(
    rings: usize,
    around: usize,
    at: impl Fn(usize) -> (Vector, [Vector; 2]),
) -> TriangleSurface {
    let mut surface = TriangleSurface::default();
    for ring in 0..rings {
        let (centre, [u, v]) = at(ring);
        for k in 0..around {
            let (sin, cos) = (TAU * k as f64 / around as f64).sin_cos();
            surface.points.push(centre + u * cos + v * sin);
        }
    }
    let corner = |ring: usize, k: usize| (ring * around + k % around) as u32;
    for ring in 0..rings - 1 {
        for k in 0..around {
            let [a, b] = [corner(ring, k), corner(ring, k + 1)];
            let [c, d] = [corner(ring + 1, k), corner(ring + 1, k + 1)];
            surface.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    for (ring, is_first) in [(0, true), (rings - 1, false)] {
        let middle = surface.points.len() as u32;
        surface.points.push(at(ring).0);
        for k in 0..around {
            let [a, b] = [corner(ring, k), corner(ring, k + 1)];
            surface.triangles.push(if is_first { [middle, b, a] } else { [middle, a, b] });
        }
    }
    surface
}

fn ball(radius: f64, centre: Vector) -> TriangleSurface {
    tube(101, 200, |ring| {
        let (sin, cos) = (PI * (0.01 + 0.98 * ring as f64 / 100.0)).sin_cos();
        let [u, v] = [Vector::y(), Vector::z()].map(|axis| axis * (radius * sin));
        (centre - Vector::x() * (radius * cos), [u, v])
    })
}

#[test]
fn shares_of_a_ball_sum_to_its_volume() {
    let mesh = block(Vector::repeat(30.0), [10; 3], CellShape::Hex8);
    let centre = Vector::new(15.4, 14.3, 15.9);
    let shares = shares_inside(&mesh, &ball(10.0, centre), 0, 512).unwrap();
    let volume = shares.iter().sum::<f64>() * 27.0;
    assert!((volume / 4188.79 - 1.0).abs() < 5e-3, "{volume} mm3");
    assert!(shares.contains(&1.0) && shares[0] == 0.0);
    // Of tetrahedra of other sizes too.
    let mesh = block(Vector::repeat(30.0), [7; 3], CellShape::Tet4);
    let shares = shares_inside(&mesh, &ball(10.0, centre), 0, 512).unwrap();
    let volumes = (0..mesh.cells.len()).map(|cell| mesh.cell_volume_of(cell));
    let volume: f64 = shares.iter().zip(volumes).map(|(share, volume)| share * volume).sum();
    assert!((volume / 4188.79 - 1.0).abs() < 5e-3, "{volume} mm3");
    // A cap of a ball is open: it is refused by its name.
    let mut cap = ball(10.0, centre);
    cap.triangles.truncate(cap.triangles.len() / 6);
    let error =
        shares_inside(&mesh, &cap, 2, 64).err().map_or_else(String::new, |error| error.to_string());
    assert!(error.starts_with("muscle 3: "), "{error}");
}

#[test]
fn shares_are_counted_by_sample_points_also_where_cells_are_told_as_a_whole() {
    let mesh = block(Vector::repeat(30.0), [10; 3], CellShape::Hex8);
    let surface = ball(10.0, Vector::new(15.4, 14.3, 15.9));
    let inside = ClosedSurface::new(&surface, SurfaceName::Muscle(0)).unwrap();
    let rule = SamplingRule::new(64);
    let counted = |cell: usize| {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let mut count = 0;
        rule.for_each(CellShape::Hex8, &corners, |point| {
            count += usize::from(inside.contains(&point));
        });
        count as f64 / 64.0
    };
    let counted: Vec<f64> = (0..mesh.cells.len()).map(counted).collect();
    assert_eq!(shares_inside(&mesh, &surface, 0, 64).unwrap(), counted);
    let whole = inside.contains_ball(&Vector::new(15.4, 14.3, 15.9), 5.0);
    assert_eq!((whole, inside.contains_ball(&Vector::repeat(1.0), 1.0)), (Some(true), Some(false)));
}

/// Volumes by corners, for cells of flat faces.
trait CellVolume {
    fn cell_volume_of(&self, cell: usize) -> f64;
}

impl CellVolume for mechanics::mesh::VolumeMesh {
    fn cell_volume_of(&self, cell: usize) -> f64 {
        let corners: Vec<Vector> = self.corners(cell).collect();
        let [a, b, c] = [1, 2, 3].map(|corner| corners[corner] - corners[0]);
        a.cross(&b).dot(&c).abs() / 6.0
    }
}

/// A box of 40 x 10 x 5 mm, turned.
fn strap() -> (TriangleSurface, Vector) {
    let mesh = block(Vector::new(40.0, 10.0, 5.0), [8, 2, 1], CellShape::Hex8);
    let mut surface = mesh.surface_of(&mesh.boundary_faces());
    let turn = Rotation3::new(Vector::new(0.3, -0.7, 1.1));
    surface.points.iter_mut().for_each(|x| *x = turn * *x);
    (surface, turn * Vector::x())
}

#[test]
fn the_axis_of_a_strap_is_that_of_its_box_wherever_its_vertices_crowd() {
    let (mut surface, known) = strap();
    let found = strap_of(&surface, 0).unwrap();
    assert!(angle_between(&found.boxes[0].axis, &known).to_radians() < 1e-6);
    assert!(!found.is_broad() && found.broadness < 0.3, "{}", found.broadness);
    // 400 vertices more in a corner: the first triangle is divided about points ever nearer to one of its own.
    for _ in 0..400 {
        let [a, b, c] = surface.triangles[0];
        let [x, y, z] = [a, b, c].map(|corner| surface.points[corner as usize]);
        let new = surface.points.len() as u32;
        surface.points.push(x * 0.98 + y * 0.01 + z * 0.01);
        surface.triangles[0] = [a, b, new];
        surface.triangles.extend([[b, c, new], [c, a, new]]);
    }
    let crowded = strap_of(&surface, 0).unwrap();
    assert!(angle_between(&crowded.boxes[0].axis, &known).to_radians() < 1e-6);
    let mesh = block(Vector::new(40.0, 30.0, 3.0), [4, 3, 1], CellShape::Hex8);
    let plate = strap_of(&mesh.surface_of(&mesh.boundary_faces()), 0).unwrap();
    assert!(plate.is_broad(), "{}", plate.broadness);
    assert_eq!(strap_of(&TriangleSurface::default(), 1), None);
}

#[test]
fn boxes_of_a_quarter_arc_err_by_its_angle_over_their_number() {
    let rings = 241;
    let at = |ring: usize| {
        let (sin, cos) = (FRAC_PI_2 * ring as f64 / (rings - 1) as f64).sin_cos();
        let outwards = Vector::new(cos, sin, 0.0);
        (outwards * 30.0, [outwards * 0.2, -Vector::z() * 0.2])
    };
    let surface = tube(rings, 12, at);
    for (halvings, most, mean) in [(0, 45.0, 22.5), (1, 22.5, 11.25), (2, 11.25, 5.625)] {
        let found = strap_of(&surface, halvings).unwrap();
        assert_eq!(found.boxes.len(), 1 << halvings);
        let off = |ring: usize| {
            let (sin, cos) = (FRAC_PI_2 * ring as f64 / (rings - 1) as f64).sin_cos();
            let axis = found.axis_at(&at(ring).0).unwrap();
            angle_between(&axis, &Vector::new(-sin, cos, 0.0))
        };
        let all: Vec<f64> = (0..rings).map(off).collect();
        let largest = all.iter().copied().fold(0.0, f64::max);
        let average = all.iter().sum::<f64>() / rings as f64;
        assert!((largest - most).abs() < 0.8, "{halvings}: {largest}");
        assert!((average - mean).abs() < 0.3, "{halvings}: {average}");
    }
}

#[test]
fn a_mean_axis_has_no_sign_and_tells_where_fibres_cross() {
    let (x, y) = (Vector::x(), Vector::y() * 7.0);
    let alike = mean_axis([(1.0, x), (2.0, -x * 3.0)]).unwrap();
    assert!(angle_between(&alike.direction, &x) < 1e-9 && alike.crossing < 1e-12);
    let apart = mean_axis([(0.8, x), (0.2, y)]).unwrap();
    assert!((apart.crossing - 0.25).abs() < 1e-12 && !apart.is_crossing());
    assert!(angle_between(&apart.direction, &x) < 1e-9);
    assert!(mean_axis([(0.5, x), (0.5, y)]).unwrap().is_crossing());
    // Of vectors at four nodes that are off by 10 degrees to either side.
    let off = |degrees: f64| Rotation3::new(Vector::z() * degrees.to_radians()) * x;
    let nodes = [off(10.0), -off(-10.0), off(-10.0), off(10.0)].map(|axis| (1.0, axis));
    let mean = mean_axis(nodes).unwrap();
    assert!(angle_between(&mean.direction, &x) < 1e-9);
    assert!((mean.crossing - 10_f64.to_radians().tan().powi(2)).abs() < 1e-9, "{}", mean.crossing);
    assert_eq!(mean_axis([(1.0, Vector::zeros()), (0.0, x), (1.0, x * f64::NAN)]), None);
}

fn tissue(young_modulus: f64, poisson_ratio: f64) -> LinearElastic {
    LinearElastic::new(young_modulus, poisson_ratio, 1.0).unwrap()
}

#[test]
fn the_tissue_of_a_cell_with_a_tenth_of_muscle_depends_on_the_rule() {
    let parts = [(0.1, tissue(790.0, 0.43)), (0.9, tissue(3.0, 0.46))];
    let known =
        [(MixingRule::Voigt, 81.74), (MixingRule::Reuss, 3.33), (MixingRule::Geometric, 5.24)];
    for (rule, known) in known {
        let found = EquivalentTissue::new(&parts, rule);
        assert!((found.tissue.young_modulus() - known).abs() < 0.005, "{rule:?}: {found:?}");
        assert!((found.rule_ratio - 81.74 / 3.332).abs() < 0.02, "{}", found.rule_ratio);
    }
    let alone = EquivalentTissue::new(&[(1.0, tissue(3.0, 0.46))], MixingRule::Reuss);
    assert!((alone.tissue.young_modulus() - 3.0).abs() < 1e-9);
    assert!((alone.rule_ratio - 1.0).abs() < 1e-9);
    // Stiff along its fibres alone.
    let fibre = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
    let fibred = tissue(3.0, 0.46).with_fibre(&fibre).unwrap();
    let parts = [(0.5, fibred), (0.5, tissue(3.0, 0.46))];
    let found = EquivalentTissue::new(&parts, MixingRule::Voigt);
    assert!((found.rule_ratio - 56.5 * (0.5 / 110.0 + 0.5 / 3.0)).abs() < 1e-9, "{found:?}");
    let decided = rule_dependent_share([(2.0, 24.5), (6.0, 1.2), (2.0, 3.5)]);
    assert!((decided - 0.4).abs() < 1e-12);
    assert_eq!(rule_dependent_share([]), 0.0);
}

#[test]
fn cells_near_lines_take_the_tangent_of_the_nearest() {
    let mesh = block(Vector::new(30.0, 12.0, 12.0), [10, 4, 4], CellShape::Hex8);
    let strap = |name: &str, from: [f64; 3], to: [f64; 3]| MuscleLines {
        name: name.to_owned(),
        lines: vec![vec![from.into(), to.into()]],
    };
    // Along x through the middle of the block, and across its end.
    let muscles = [
        strap("long", [0.0, 6.0, 6.0], [30.0, 6.0, 6.0]),
        strap("short", [28.5, 0.0, 6.0], [28.5, 12.0, 6.0]),
    ];
    let near = fibre_cells(&mesh, &muscles, &[2.5, 2.5]);
    // Four cells about the line have their centroids at 1.5 * sqrt 2 mm, in each of ten slices; in the last all eight cells
    // beside z = 6 lie at 1.5 mm from the line across.
    let count = |muscle: usize| near.iter().filter(|own| own.muscle == muscle).count();
    assert_eq!((count(0), count(1), near.len()), (36, 8, 44));
    assert_eq!(near.iter().filter(|own| own.muscles == 2).count(), 4);
    for own in &near {
        let known = [Vector::x(), Vector::y()][own.muscle];
        assert!(angle_between(&own.axis, &known) < 1e-9 && own.distance <= 2.5, "{own:?}");
    }
    let degenerate =
        MuscleLines { name: "point".to_owned(), lines: vec![vec![Vector::zeros(); 2]] };
    assert!(fibre_cells(&mesh, &[degenerate], &[100.0]).is_empty());
}

#[test]
fn a_box_encloses_its_volume_and_faces_outwards_whichever_way_its_axes_turn() {
    let turned = Rotation3::new(Vector::new(0.4, -0.7, 1.1));
    let axes = [20.0, 5.0, 2.5].map(|size| size * Vector::x());
    let axes = [axes[0], Vector::y() * axes[1].x, Vector::z() * axes[2].x].map(|own| turned * own);
    for half_axes in [axes, [axes[1], axes[0], axes[2]]] {
        let surface = box_surface(Vector::new(7.0, -3.0, 2.0), half_axes);
        assert!((surface.signed_volume() - 2000.0).abs() < 1e-9, "{}", surface.signed_volume());
        let strap = strap_of(&surface, 0).unwrap();
        assert!(angle_between(&strap.boxes[0].axis, &axes[0]) < 1e-6 && !strap.is_broad());
    }
}
