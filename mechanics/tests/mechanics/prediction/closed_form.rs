//! Answers known in closed form: docs/verification.md#v7, docs/verification.md#v9, docs/verification.md#v10.

use std::collections::BTreeMap;

use mechanics::material::LinearElastic;
use mechanics::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use mechanics::mesh::{CellShape, Vector};
use mechanics::prediction::{
    ElementChoice, Load, Plan, Prescribed, RegionNames, Settings, Sliding, SlidingNormal,
};

use crate::scenes::{SHAPES, case_of, constraint, exact, material, set, solve};

/// The thick sphere of V.7 at cells of about 3 mm: mean radial displacement of the outer surface.
fn outer_displacement(nu: f64, element: ElementChoice) -> f64 {
    let mut mesh = thick_sphere_octant(
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 4, cells_along: 16 },
        CellShape::Hex8,
    );
    let radial = mesh.nodes.iter().map(|x| x.normalize() * 2.0).collect();
    mesh.node_vectors.insert("radial".to_owned(), radial);
    let inner = Prescribed::FromArray { nodes: set("inner"), array: "radial".to_owned() };
    let symmetry = [
        constraint("x_min", [Some(0.0), None, None]),
        constraint("y_min", [None, Some(0.0), None]),
        constraint("z_min", [None, None, Some(0.0)]),
    ];
    let plan = Plan { prescribed: [vec![inner], symmetry.to_vec()].concat(), ..Plan::default() };
    let case = case_of(mesh, material(15.0, nu));
    let settings = Settings { element, ..Settings::default() };
    let prediction = solve(&case, &plan, &settings);
    let outer = case.volume.node_set("outer").unwrap();
    let radial = |&node: &u32| {
        prediction.displacement[node as usize].dot(&case.volume.nodes[node as usize].normalize())
    };
    outer.iter().map(radial).sum::<f64>() / outer.len() as f64
}

#[test]
fn a_thick_sphere_of_mean_dilatation_hexahedra_moves_as_the_closed_form() {
    let expected =
        [(0.0, 1.93133), (0.3, 1.65441), (0.43, 1.49180), (0.46, 1.44919), (0.49, 1.40436)];
    for (nu, exact) in expected {
        let found = outer_displacement(nu, ElementChoice::Auto);
        assert!((found / exact - 1.0).abs() < 0.005, "nu {nu}: {found} instead of {exact}");
    }
}

#[test]
fn young_s_modulus_alone_changes_no_displacement() {
    let displaced = |young_modulus: f64| {
        let mesh = block(Vector::new(20.0, 10.0, 6.0), [5, 4, 3], CellShape::Hex8);
        let plan = Plan {
            prescribed: vec![
                constraint("x_min", [Some(0.0); 3]),
                constraint("x_max", [Some(1.0), None, Some(2.0)]),
            ],
            ..Plan::default()
        };
        solve(&case_of(mesh, material(young_modulus, 0.46)), &plan, &exact()).displacement
    };
    let (soft, stiff) = (displaced(1.0), displaced(1000.0));
    let largest = soft.iter().map(|u| u.norm()).fold(0.0, f64::max);
    for (a, b) in soft.iter().zip(&stiff) {
        assert!((a - b).norm() < 1e-10 * largest);
    }
}

#[test]
fn two_layers_in_series_share_the_displacement_by_compliance() {
    for shape in SHAPES {
        let mut mesh = block(Vector::new(5.0, 5.0, 30.0), [2, 2, 6], shape);
        let labels = (0..mesh.cells.len())
            .map(|cell| {
                let height: f64 = mesh.corners(cell).map(|x| x.z).sum();
                i64::from(height / mesh.cells.nodes(cell).len() as f64 > 10.0)
            })
            .collect();
        mesh.cell_labels.insert("layer".to_owned(), labels);
        let mut case = case_of(mesh, material(15.0, 0.0));
        let names = BTreeMap::from([(1, "stiff".to_owned())]);
        case.regions = Some(RegionNames { array: "layer".to_owned(), names });
        case.materials.insert("stiff".to_owned(), material(300.0, 0.0));
        let plan = Plan {
            prescribed: vec![
                constraint("z_min", [Some(0.0); 3]),
                constraint("z_max", [Some(0.0), Some(0.0), Some(1.0)]),
            ],
            ..Plan::default()
        };
        let prediction = solve(&case, &plan, &exact());
        for (x, u) in case.volume.nodes.iter().zip(&prediction.displacement) {
            if (x.z - 10.0).abs() < 1e-9 {
                assert!((u.z - 10.0 / 11.0).abs() < 1e-10, "{shape:?}: {}", u.z);
            }
        }
    }
}

#[test]
fn tractions_and_pressures_and_gravity_balance_with_the_reactions() {
    let mesh = block(Vector::new(4.0, 5.0, 6.0), [2, 2, 3], CellShape::Wedge6);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("z_min"));
    let loads = [
        (
            Load::Traction { faces: set("z_max"), traction: Vector::new(1.0, 2.0, 3.0) },
            Vector::new(20.0, 40.0, 60.0),
        ),
        (Load::Pressure { faces: set("x_max"), pressure: 2.0 }, Vector::new(-60.0, 0.0, 0.0)),
        (Load::Gravity { acceleration: Vector::new(0.0, 0.0, -0.01) }, Vector::new(0.0, 0.0, -1.2)),
        (
            Load::Force { nodes: set("z_max"), force: Vector::new(0.0, 1.0, 0.0) },
            Vector::new(0.0, 9.0, 0.0),
        ),
    ];
    for (load, total) in loads {
        let plan = Plan { loads: vec![load.clone()], ..Plan::default() };
        let reaction = solve(&case, &plan, &exact()).reactions["fixed"];
        assert!((reaction + total).norm() < 1e-10 * total.norm(), "{load:?}: {reaction}");
    }
}

#[test]
fn a_load_on_held_nodes_alone_is_reported() {
    let mesh = block(Vector::new(4.0, 5.0, 6.0), [2, 2, 3], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("z_min"));
    let told = |load: Load| {
        let plan = Plan { loads: vec![load], ..Plan::default() };
        let warnings = solve(&case, &plan, &Settings::default()).warnings;
        warnings.iter().any(|warning| warning.code == "load-on-held")
    };
    for (side, wanted) in [("z_min", true), ("z_max", false), ("x_min", false)] {
        let force = Vector::new(0.0, 0.0, 5.0);
        assert_eq!(told(Load::Force { nodes: set(side), force }), wanted, "{side}");
        assert_eq!(told(Load::Traction { faces: set(side), traction: force }), wanted, "{side}");
        assert_eq!(told(Load::Pressure { faces: set(side), pressure: 1.0 }), wanted, "{side}");
    }
}

/// The top has seven rows of three nodes: one of them fills no face, two do. The bottom is held.
#[test]
fn a_force_at_nodes_without_a_face_is_reported() {
    let mut mesh = block(Vector::new(4.0, 5.0, 6.0), [2, 6, 3], CellShape::Hex8);
    let top: Vec<u32> = mesh.node_sets["z_max"].clone();
    let mut add = |name: &str, nodes: Vec<u32>| mesh.node_sets.insert(name.to_owned(), nodes);
    add("point", vec![top[4]]);
    add("row", top[3..6].to_vec());
    add("rows", top[..6].to_vec());
    add("rows and a node beside", top[..7].to_vec());
    add("rows and one apart", [&top[..6], &top[18..]].concat());
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("z_min"));
    let told = |nodes: &str| {
        let loads = vec![Load::Force { nodes: set(nodes), force: Vector::new(0.0, 0.0, 5.0) }];
        let plan = Plan { loads, ..Plan::default() };
        let warnings = solve(&case, &plan, &Settings::default()).warnings;
        let told = warnings.iter().find(|warning| warning.code == "point-force")?;
        Some(told.numbers[0].1)
    };
    let points = ["point", "row", "rows and one apart"];
    assert_eq!(points.map(told), [Some(1.0), Some(3.0), Some(3.0)]);
    assert_eq!(["rows", "rows and a node beside", "z_max", "z_min"].map(told), [None; 4]);
}

#[test]
fn a_bar_under_its_own_weight_shortens_by_half_of_what_its_weight_on_top_would_do() {
    let mesh = block(Vector::new(3.0, 3.0, 30.0), [1, 1, 10], CellShape::Hex8);
    let density = 1.04;
    let case = case_of(mesh, LinearElastic::new(15.0, 0.0, density).unwrap());
    let plan = Plan {
        prescribed: vec![constraint("z_min", [Some(0.0); 3])],
        loads: vec![Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81e-3) }],
        ..Plan::default()
    };
    let prediction = solve(&case, &plan, &exact());
    let top = case.volume.node_set("z_max").unwrap()[0];
    let expected = -density * 9.81e-3 * 30.0 * 30.0 / (2.0 * 15.0);
    assert!((prediction.displacement[top as usize].z - expected).abs() < 1e-12);
}

#[test]
fn each_condition_tells_the_force_that_it_exerts_on_a_block_that_is_pulled() {
    // Stretched by 5 % along x between walls across y, free across z: plane stress without lateral strain.
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    let wall =
        |name: &str| Sliding { nodes: set(name), normal: SlidingNormal::Surface, segment: None };
    case.sliding = ["x_min", "y_min", "y_max", "z_min"].map(wall).into();
    let pulled =
        |by: f64| Prescribed::Uniform { nodes: set("x_max"), displacement: [Some(by), None, None] };
    let plan = Plan { prescribed: vec![pulled(2.0)], ..Plan::default() };
    let found = solve(&case, &plan, &exact()).condition_reactions;
    // E / (1 - nu^2) 0.05 on 200 mm2, and nu times that stress on 400 mm2.
    let along = 15.0 / (1.0 - 0.09) * 0.05 * 200.0;
    let across = 0.3 * 15.0 / (1.0 - 0.09) * 0.05 * 400.0;
    for (pointer, force) in [
        ("/case/sliding/0", Vector::new(-along, 0.0, 0.0)),
        ("/case/sliding/1", Vector::new(0.0, -across, 0.0)),
        ("/case/sliding/2", Vector::new(0.0, across, 0.0)),
        ("/case/sliding/3", Vector::zeros()),
        ("/plan/prescribed/0", Vector::new(along, 0.0, 0.0)),
    ] {
        let of = found.iter().find(|of| of.pointer == pointer).unwrap();
        assert!((of.force - force).norm() < 1e-8 * along, "{pointer}: {} {force}", of.force);
    }
    assert_eq!(found.iter().map(|of| of.nodes).collect::<Vec<_>>(), [9, 15, 15, 15, 9]);
}

#[test]
fn a_wall_pushes_along_its_normal_where_a_component_that_is_not_across_it_is_held_too() {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed = vec![set("x_min")];
    let normal = SlidingNormal::Direction(Vector::new(1.0, 1.0, 0.0));
    case.sliding = vec![Sliding { nodes: set("x_max"), normal, segment: None }];
    let pulled = Prescribed::Uniform { nodes: set("x_max"), displacement: [Some(1.0), None, None] };
    let plan = Plan { prescribed: vec![pulled], ..Plan::default() };
    let found = solve(&case, &plan, &exact()).condition_reactions;
    let force = |pointer: &str| found.iter().find(|of| of.pointer == pointer).unwrap().force;
    let (wall, pulled) = (force("/case/sliding/0"), force("/plan/prescribed/0"));
    let most = pulled.norm();
    assert!((wall.x - wall.y).abs() < 1e-8 * most && wall.z.abs() < 1e-8 * most, "{wall}");
    assert!(pulled.yz().norm() < 1e-8 * most, "{pulled}");
    let sum: Vector = found.iter().map(|of| of.force).sum();
    assert!(wall.norm() > 0.1 * most && sum.norm() < 1e-8 * most, "{wall} {pulled} {sum}");
}
