//! Axes of the map of failures that every method has; those of some methods are in `own_axes`.

use super::axis::FINER;
use super::axis::FINER_OF_ITS_STRAIN;
use super::axis::RING;
use super::axis::TENTH_OF_MOVEMENT;
use super::axis::default_case;
use super::axis::fine_finite_strain_truth;
use super::axis::finer;
use super::axis::found;
use super::axis::material;
use super::axis::moved;
use super::axis::numbers;
use super::axis::values;
use super::scenes::{
    CELL, LEVELS, POISSON_RATIO, YOUNG_MODULUS, around_ball, jaw, layer, on_bone, set, shape_for,
    shift, swelling, tissue, with_region,
};
use super::{Axis, Refusal, Truth, own_axes};
use crate::mesh::{CellShape, Vector};
use crate::plan::{PlannedSegment, RigidMovement};
use crate::prediction::{Case, CaseSegment};
use std::sync::Arc;

pub fn every() -> Vec<Axis> {
    let mut axes = vec![
        poisson_ratio(),
        movement(),
        rotation(),
        sliding(),
        aspect(),
        stiffness_contrast(),
        jump(),
        loose_parts(),
        contradiction(),
    ];
    axes.extend(own_axes::every());
    axes
}

/// Half of the least mean error that published systems report against patients.
const HALF_A_MILLIMETRE: f64 = 0.5;

// Poisson's ratio.

fn poisson_ratio() -> Axis {
    Axis {
        name: "poisson_ratio",
        title: "Poisson ratio",
        unit: "",
        scene: "layer of 12 mm, patch of 16 x 16 mm moved by (1, 0, 2) mm",
        reference: FINER_OF_ITS_STRAIN,
        bound_mm: TENTH_OF_MOVEMENT,
        values: numbers(&[0.3, 0.4, 0.45, 0.46, 0.49, 0.499, 0.4999, 0.5]),
        probe: |nu, variant| {
            found(case_of_nu(nu, shape_for(&variant.settings))?, jaw(shift(moved())), variant)
        },
        truth: |nu| finer(case_of_nu(nu, CellShape::Tet4), jaw(shift(moved()))),
        finite_truth: Some(|nu, laws| {
            fine_finite_strain_truth(case_of_nu(nu, CellShape::Tet4), jaw(shift(moved())), laws)
        }),
    }
}

fn case_of_nu(nu: f64, shape: CellShape) -> Result<Case, Refusal> {
    Ok(on_bone(layer(&LEVELS, RING, shape), tissue(material(YOUNG_MODULUS, nu, "*")?)))
}

// Movement.

/// Poisson's ratio of the sphere: it swells as if incompressible to 0.1 %.
const NEARLY_INCOMPRESSIBLE: f64 = 0.499;

fn movement() -> Axis {
    Axis {
        name: "movement",
        title: "Movement",
        unit: "mm",
        scene: "octant of a thick sphere, radii 60 and 72 mm, nu 0.499, its inner wall pushed outwards",
        reference: "closed form of finite elasticity at constant volume",
        bound_mm: HALF_A_MILLIMETRE,
        values: numbers(&[1.0, 2.0, 5.0, 8.0, 12.0, 16.0, 20.0, 25.0]),
        probe: |by, variant| {
            let material = material(YOUNG_MODULUS, NEARLY_INCOMPRESSIBLE, "*")?;
            let (case, plan) = swelling(by, material, shape_for(&variant.settings));
            found(case, plan, variant)
        },
        truth: swollen,
        finite_truth: Some(|by, _| swollen(by)),
    }
}

fn swollen(by: f64) -> Truth {
    Truth::Formula(Box::new(move |x| {
        let r = x.norm();
        let cubed = r.powi(3) + (60.0 + by).powi(3) - 60.0_f64.powi(3);
        x * (cubed.cbrt() / r - 1.0)
    }))
}

// Rotation.

fn rotation() -> Axis {
    Axis {
        name: "rotation",
        title: "Rotation",
        unit: "deg",
        scene: "layer of 12 mm on one bone, which turns about an axis 40 mm below",
        reference: "symmetry: all tissue turns with its only bone",
        bound_mm: HALF_A_MILLIMETRE,
        values: numbers(&[1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0]),
        probe: |degrees, variant| {
            let mut case = default_case(&LEVELS, RING, shape_for(&variant.settings))?;
            case.segments[0].nodes = set("base");
            case.fixed.clear();
            case.allow_unfixed = true;
            found(case, jaw(rotated(degrees)), variant)
        },
        truth: turned,
        finite_truth: Some(|degrees, _| turned(degrees)),
    }
}

fn turned(degrees: f64) -> Truth {
    Truth::Formula(Box::new(move |x| rotated(degrees).displacement(x)))
}

fn rotated(degrees: f64) -> RigidMovement {
    let angles = Vector::new(0.0, degrees.to_radians(), 0.0);
    RigidMovement::about_pivot(angles, Vector::new(0.0, 0.0, -40.0), Vector::zeros())
}

// Sliding on a curved wall.

fn sliding() -> Axis {
    Axis {
        name: "sliding",
        title: "Sliding on a ball",
        unit: "deg",
        scene: "octant of a thick sphere, radii 60 and 72 mm, nu 0.43, that slides on the ball in it; its face at \
            x = 0 turns about z",
        reference: "symmetry: all tissue turns with that face",
        bound_mm: HALF_A_MILLIMETRE,
        values: numbers(&[1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0]),
        probe: |degrees, variant| {
            let material = material(YOUNG_MODULUS, POISSON_RATIO, "*")?;
            let case = around_ball(material, shape_for(&variant.settings));
            found(case, jaw(about_z(degrees)), variant)
        },
        truth: rotated_about_z,
        finite_truth: Some(|degrees, _| rotated_about_z(degrees)),
    }
}

fn rotated_about_z(degrees: f64) -> Truth {
    Truth::Formula(Box::new(move |x| about_z(degrees).displacement(x)))
}

fn about_z(degrees: f64) -> RigidMovement {
    let angles = Vector::new(0.0, 0.0, degrees.to_radians());
    RigidMovement::about_pivot(angles, Vector::zeros(), Vector::zeros())
}

// Flat and folded cells.

fn aspect() -> Axis {
    Axis {
        name: "aspect",
        title: "Flat, then folded cells",
        unit: "thickness / width",
        scene: "the layer of `poisson_ratio`, nu 0.43, with one more layer of cells in it, ever thinner",
        reference: FINER,
        bound_mm: TENTH_OF_MOVEMENT,
        values: values(&[
            (0.5, "0.5"),
            (1e-1, "1e-1"),
            (1e-2, "1e-2"),
            (1e-3, "1e-3"),
            (1e-4, "1e-4"),
            (1e-5, "1e-5"),
            (1e-6, "1e-6"),
            (0.0, "0"),
            (-0.1, "-0.1"),
        ]),
        probe: |aspect, variant| {
            let levels = [0.0, 4.0, 4.0 + CELL * aspect, 8.0, 12.0];
            let case = default_case(&levels, RING, shape_for(&variant.settings))?;
            found(case, jaw(shift(moved())), variant)
        },
        truth: |aspect| match aspect {
            0.5 => finer(default_case(&LEVELS, RING, CellShape::Tet4), jaw(shift(moved()))),
            flatter if flatter > 0.0 => Truth::First { times: 1.0 },
            _ => Truth::Impossible,
        },
        finite_truth: None,
    }
}

// Stiffness contrast.

fn stiffness_contrast() -> Axis {
    Axis {
        name: "stiffness_contrast",
        title: "Stiffness contrast",
        unit: "times 15 kPa",
        scene: "the layer of `poisson_ratio`, nu 0.43, its middle third ever stiffer",
        reference: FINER_OF_ITS_STRAIN,
        bound_mm: TENTH_OF_MOVEMENT,
        values: values(&[
            (1.0, "1"),
            (1e1, "1e1"),
            (1e2, "1e2"),
            (1e3, "1e3"),
            (1e4, "1e4"),
            (1e5, "1e5"),
            (1e6, "1e6"),
        ]),
        probe: |contrast, variant| {
            let case = stiff_case(contrast, shape_for(&variant.settings))?;
            found(case, jaw(shift(moved())), variant)
        },
        truth: |contrast| finer(stiff_case(contrast, CellShape::Tet4), jaw(shift(moved()))),
        finite_truth: Some(|contrast, laws| {
            let case = stiff_case(contrast, CellShape::Tet4);
            fine_finite_strain_truth(case, jaw(shift(moved())), laws)
        }),
    }
}

fn stiff_case(contrast: f64, shape: CellShape) -> Result<Case, Refusal> {
    let mut case = with_region(default_case(&LEVELS, RING, shape)?, 1, "stiff");
    let stiff = material(YOUNG_MODULUS * contrast, POISSON_RATIO, "stiff")?;
    case.materials.insert("stiff".to_owned(), stiff);
    Ok(case)
}

// A jump between moved and held nodes.

fn jump() -> Axis {
    Axis {
        name: "jump",
        title: "Jump to held bone",
        unit: "mm, one cell of 4",
        scene: "the layer of `poisson_ratio`, nu 0.43, held all around its patch beyond one cell of 4 mm",
        reference: "linear finite elements, quadratic, every edge halved: what linearity leaves out is not seen",
        bound_mm: HALF_A_MILLIMETRE,
        values: numbers(&[0.5, 1.0, 2.0, 3.0, 4.0, 8.0, 16.0, 25.0]),
        probe: |by, variant| {
            let case = default_case(&LEVELS, CELL, shape_for(&variant.settings))?;
            found(case, jaw(shift(Vector::x() * by)), variant)
        },
        truth: |by| match by {
            0.5 => {
                finer(default_case(&LEVELS, CELL, CellShape::Tet4), jaw(shift(Vector::x() * by)))
            }
            more => Truth::First { times: more / 0.5 },
        },
        finite_truth: None,
    }
}

// Parts that hang on too little.

fn loose_parts() -> Axis {
    Axis {
        name: "loose_parts",
        title: "Floating parts",
        unit: "nodes shared",
        scene: "the layer of `poisson_ratio`, nu 0.43, and one more tetrahedron that shares nodes with it",
        reference: FINER,
        bound_mm: TENTH_OF_MOVEMENT,
        values: values(&[(3.0, "3"), (2.0, "2"), (1.0, "1"), (0.0, "0")]),
        probe: |shared, variant| {
            let case = case_with_part(shared as usize, shape_for(&variant.settings))?;
            found(case, jaw(shift(moved())), variant)
        },
        truth: |shared| match shared >= 3.0 {
            true => finer(case_with_part(shared as usize, CellShape::Tet4), jaw(shift(moved()))),
            false => Truth::Impossible,
        },
        finite_truth: None,
    }
}

/// A tetrahedron stands on three nodes in the middle of the skin, the first `shared` of them the skin's own.
fn case_with_part(shared: usize, shape: CellShape) -> Result<Case, Refusal> {
    let mut case = default_case(&LEVELS, RING, shape)?;
    let mesh = Arc::make_mut(&mut case.volume);
    let foot = [Vector::zeros(), Vector::x(), Vector::x() + Vector::y()];
    let mut nodes = Vec::new();
    for (corner, at) in foot.into_iter().enumerate() {
        let at = at * CELL + Vector::new(0.0, 0.0, 12.0);
        let own = mesh.nodes.iter().position(|x| (x - at).norm() < 1e-9);
        nodes.push(match own.filter(|_| corner < shared) {
            Some(own) => own as u32,
            None => push_node(&mut mesh.nodes, at + Vector::new(0.0, 0.0, 1.0)),
        });
    }
    nodes.push(push_node(&mut mesh.nodes, Vector::new(3.0, 1.0, 15.0)));
    mesh.cells.push(CellShape::Tet4, &nodes);
    mesh.cell_labels.values_mut().for_each(|labels| labels.push(2));
    Ok(case)
}

fn push_node(nodes: &mut Vec<Vector>, at: Vector) -> u32 {
    nodes.push(at);
    nodes.len() as u32 - 1
}

// Two movements of one node.

fn contradiction() -> Axis {
    Axis {
        name: "contradiction",
        title: "Segments at odds",
        unit: "mm apart at one node",
        scene: "the layer of `poisson_ratio`, nu 0.43, one node of its patch held by a second segment too",
        reference: FINER,
        bound_mm: TENTH_OF_MOVEMENT,
        values: values(&[
            (0.0, "0"),
            (1e-12, "1e-12"),
            (1e-6, "1e-6"),
            (1e-3, "1e-3"),
            (1.0, "1"),
            (25.0, "25"),
        ]),
        probe: |apart, variant| {
            let mut case = default_case(&LEVELS, RING, shape_for(&variant.settings))?;
            let mesh = Arc::make_mut(&mut case.volume);
            let shared = mesh.node_sets["patch"][0];
            mesh.node_sets.insert("shared".to_owned(), vec![shared]);
            case.segments.push(CaseSegment { name: "chin".to_owned(), nodes: set("shared") });
            let mut plan = jaw(shift(moved()));
            let movement = shift(moved() + Vector::y() * apart);
            plan.segments.push(PlannedSegment { name: "chin".to_owned(), movement });
            found(case, plan, variant)
        },
        // A nanometre is a difference of rounding.
        truth: |apart| match apart {
            0.0 => finer(default_case(&LEVELS, RING, CellShape::Tet4), jaw(shift(moved()))),
            rounding if rounding < 1e-9 => Truth::First { times: 1.0 },
            _ => Truth::Impossible,
        },
        finite_truth: None,
    }
}
