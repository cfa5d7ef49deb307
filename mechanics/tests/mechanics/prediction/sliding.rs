//! docs/verification.md#v24, docs/verification.md#v25: bilateral sliding without friction, for every element and the mass-tensor.

use mechanics::boundary::NodeSelection;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::problem::Equilibrium;
use mechanics::prediction::{
    ContactKind, ElementChoice, Method, NodeClass, Plan, Prescribed, Scene, Settings, Sliding,
    SlidingNormal,
};
use mechanics::progress::Unobserved;
use nalgebra::Rotation3;

use crate::scenes::{case_of, exact, largest_error, material, set};

/// Every model that slides, with the cells it takes.
const MODELS: [(CellShape, ElementChoice, Method); 8] = [
    (CellShape::Tet4, ElementChoice::Plain, Method::FemLinear),
    (CellShape::Tet4, ElementChoice::Stabilised, Method::FemLinear),
    (CellShape::Tet4, ElementChoice::Quadratic, Method::FemLinear),
    (
        CellShape::Tet4,
        ElementChoice::Plain,
        Method::MassTensorTransverse(MassTensorSettings { iterations: Iterations::Fast }),
    ),
    (CellShape::Hex8, ElementChoice::Plain, Method::FemLinear),
    (CellShape::Hex8, ElementChoice::MeanDilatation, Method::FemLinear),
    (CellShape::Wedge6, ElementChoice::Plain, Method::FemLinear),
    (CellShape::Wedge6, ElementChoice::MeanDilatation, Method::FemLinear),
];

/// A block of 10 mm pressed by 5 % along z between sliding walls, turned by a rotation.
struct Pressed {
    scene: Scene,
    answer: Equilibrium,
    turn: Rotation3<f64>,
    /// The largest distance from the affine field in mm.
    error: f64,
}

impl Pressed {
    fn new(model: usize, nu: f64, walls: &[&str], turn: Rotation3<f64>) -> Self {
        let (shape, element, method) = MODELS[model].clone();
        let mut mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], shape);
        // The other direction gives way where it has no walls.
        let lateral = 0.05 * if walls.len() == 2 { nu / (1.0 - nu) } else { nu };
        let strain = |wall: &str| if walls.contains(&wall) { 0.0 } else { lateral };
        let strains = Vector::new(strain("x_max"), strain("y_max"), -0.05);
        let field = |x: &Vector| turn * (turn.inverse() * x).component_mul(&strains);
        mesh.nodes.iter_mut().for_each(|node| *node = turn * *node);
        mesh.node_vectors.insert("lid".to_owned(), mesh.nodes.iter().map(field).collect());
        let mut case = case_of(mesh, material(15.0, nu));
        let surface = |name: &&str| Sliding {
            nodes: set(name),
            normal: SlidingNormal::Surface,
            segment: None,
        };
        case.sliding = walls.iter().map(surface).collect();
        let below = SlidingNormal::Direction(turn * -Vector::z());
        case.sliding.push(Sliding { nodes: set("z_min"), normal: below, segment: None });
        let lid = Prescribed::FromArray { nodes: set("z_max"), array: "lid".to_owned() };
        let plan = Plan { prescribed: vec![lid], ..Plan::default() };
        let settings = Settings { method, element, ..exact() };
        let scene = Scene::new(&case, &plan, &settings).unwrap();
        let answer = scene.solve(&Unobserved).unwrap();
        let error = largest_error(&case.volume, &answer.displacement, field);
        Pressed { scene, answer, turn, error }
    }

    /// What the lid exerts, in mN.
    fn lid(&self) -> Vector {
        let constraints = self.scene.conditions.constraints.iter().zip(&self.answer.reactions);
        let classes = &self.scene.conditions.classes;
        let on_lid = constraints
            .filter(|(constraint, _)| classes[constraint.node as usize] == NodeClass::Prescribed);
        on_lid.map(|(_, force)| force).sum()
    }

    /// Mean pressure on the lid of 100 mm² for each strain, in kPa.
    fn modulus(&self) -> f64 {
        -self.lid().dot(&(self.turn * Vector::z())) / 100.0 / 0.05
    }
}

const FOUR_WALLS: [&str; 4] = ["x_min", "x_max", "y_min", "y_max"];
const TWO_WALLS: [&str; 2] = ["x_min", "x_max"];

#[test]
fn every_element_between_sliding_walls_resists_with_its_confined_modulus() {
    let tables =
        [(0.3_f64, 20.1923_f64, 16.4835_f64), (0.46, 69.3493, 19.0259), (0.49, 256.7114, 19.7394)];
    for (nu, confined, between_two) in tables {
        // The tables have four digits; what is found is held against the formulas behind them.
        let oedometric = 15.0 * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let plane_strain = 15.0 / (1.0 - nu * nu);
        assert!((oedometric - confined).abs() < 1e-4 && (plane_strain - between_two).abs() < 1e-4);
        for (number, model) in MODELS.iter().enumerate() {
            let modulus =
                |walls: &[&str]| Pressed::new(number, nu, walls, Rotation3::identity()).modulus();
            let found = [modulus(&FOUR_WALLS), modulus(&TWO_WALLS), modulus(&[])];
            for (found, exact) in found.into_iter().zip([oedometric, plane_strain, 15.0]) {
                assert!((found / exact - 1.0).abs() < 1e-9, "{model:?} nu {nu}: {found} {exact}");
            }
        }
    }
}

#[test]
fn sliding_walls_at_any_angle_hold_across_and_leave_free_along() {
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    for (number, model) in MODELS.iter().enumerate() {
        for walls in [&FOUR_WALLS[..], &TWO_WALLS] {
            let straight = Pressed::new(number, 0.46, walls, Rotation3::identity());
            let turned = Pressed::new(number, 0.46, walls, turn);
            assert!((turned.modulus() / straight.modulus() - 1.0).abs() < 1e-9, "{model:?}");
            for (u, v) in straight.answer.displacement.iter().zip(&turned.answer.displacement) {
                assert!((turn * u - v).norm() < 1e-9 * 0.5, "{model:?}: {u} {v}");
            }
            assert!(turned.error < 1e-10, "{model:?}: {:.2e}", turned.error);
            turned.check_walls(model);
        }
    }
}

impl Pressed {
    /// Walls exert nothing along themselves, nodes on them do not leave them, and everything balances: a
    /// hidden force along a wall would be missing in the sums.
    fn check_walls(&self, model: &(CellShape, ElementChoice, Method)) {
        let scale = self.lid().norm();
        let (mut force, mut moment) = (Vector::zeros(), Vector::zeros());
        for (constraint, reaction) in
            self.scene.conditions.constraints.iter().zip(&self.answer.reactions)
        {
            let place = self.scene.mesh.nodes[constraint.node as usize];
            force += reaction;
            moment += place.cross(reaction);
            if self.scene.conditions.classes[constraint.node as usize] != NodeClass::Sliding {
                continue;
            }
            let u = self.answer.displacement[constraint.node as usize];
            for axis in 0..3 {
                let direction = constraint.axes().column(axis);
                let wrong = match axis < constraint.count() {
                    true => u.dot(&direction).abs() / 0.5,
                    false => reaction.dot(&direction).abs() / scale,
                };
                assert!(wrong < 1e-10, "{model:?}: {wrong:.2e}");
            }
        }
        let tangential = force - self.turn * Vector::z() * force.dot(&(self.turn * Vector::z()));
        assert!(tangential.norm() < 1e-10 * scale, "{model:?}: {tangential}");
        assert!(force.norm() < 1e-10 * scale && moment.norm() < 1e-9 * scale, "{model:?}: {force}");
    }
}

#[test]
fn without_contact_sliding_nodes_go_free() {
    let mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 2, 2], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed = vec![set("z_min")];
    let selection: NodeSelection = set("x_max");
    case.sliding =
        vec![Sliding { nodes: selection, normal: SlidingNormal::Surface, segment: None }];
    let lid = crate::scenes::constraint("z_max", [Some(0.0), Some(0.0), Some(-0.5)]);
    let plan = Plan { prescribed: vec![lid], ..Plan::default() };
    let bulge = |contact: ContactKind| {
        let scene = Scene::new(&case, &plan, &Settings { contact, ..exact() }).unwrap();
        let u = scene.solve(&Unobserved).unwrap().displacement;
        let wall = case.volume.node_sets["x_max"].iter();
        wall.map(|&node| u[node as usize].x.abs()).fold(0.0, f64::max)
    };
    let [held, free] = [ContactKind::Sliding, ContactKind::None].map(bulge);
    assert!(held < 1e-12 && free > 0.05, "{held} {free}");
}
