//! The equations of tissue at rest at finite strain against the matrices of linear elasticity.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::sync::Arc;

use super::Tissue;
use crate::boundary::Constraint;
use crate::material::LinearElastic;
use crate::material::hyperelastic::{Law, NeoHookean};
use crate::mesh::sample::block;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::dofs::{Constrained, DofMap, nodes_of_cells, number};
use crate::model::fem::assembly;
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::fem::displacement_pressure::{PressureCells, couple, shear_stiffness};
use crate::model::fem::finite_strain::elements::{CellBulkModulus, Elements};
use crate::model::fem::finite_strain::fibres::FibreField;
use crate::model::fem::finite_strain::problem::{Advance, FiniteStrain};
use crate::progress::Unobserved;
use crate::solver::Tolerance;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::sparse_rows::{Entry, SparseRows};

/// A distorted block.
fn mesh() -> VolumeMesh {
    let mut mesh = block(Vector::new(9.0, 7.0, 5.0), [3, 3, 2], CellShape::Tet4);
    for x in &mut mesh.nodes {
        *x += Vector::new((1.3 * x.y).sin(), (0.9 * x.z).cos(), (1.1 * x.x).sin()) * 0.2;
    }
    mesh
}

fn material() -> LinearElastic {
    LinearElastic::new(15.0, 0.46, 1.0).unwrap()
}

/// The same nodes and cells at finite strain.
struct AtRest {
    mesh: VolumeMesh,
    constraints: Vec<Constraint>,
    cell_numbers: Vec<u16>,
}

impl AtRest {
    fn new() -> AtRest {
        let mesh = mesh();
        let held = mesh.node_sets["z_min"].iter();
        let constraints = held.map(|&node| Constraint::at(node, Vector::zeros())).collect();
        let cell_numbers = vec![0; mesh.cells.len()];
        AtRest { mesh, constraints, cell_numbers }
    }

    fn dof_map(&self) -> DofMap {
        number(&nodes_of_cells(&self.mesh), &self.mesh.nodes, &self.constraints)
    }

    fn linear<'a>(&'a self, materials: &'a [LinearElastic]) -> assembly::Tissue<'a> {
        assembly::Tissue::isotropic(&self.mesh, materials, &self.cell_numbers, |_| Dilatation::Mean)
    }

    fn problem<'a>(&'a self, laws: &'a [Law], stabilised: bool) -> FiniteStrain<'a> {
        FiniteStrain {
            mesh: &self.mesh,
            nodes: &self.mesh.nodes,
            laws,
            law_of_cell: &self.cell_numbers,
            pressure_of_cell: &self.cell_numbers,
            elements: Elements { stabilised, mean_dilatation: true, quadratic: false },
            fibres: FibreField { of_law: &[], of_cell: &[] },
            membrane: None,
            inner: Arc::default(),
            constraints: &self.constraints,
            tolerance: Tolerance { relative_residual: 1e-8, memory_mb: 1e4 },
            near: None,
            with_states: false,
            advance: Advance::InSteps(NonZeroU32::MIN),
        }
    }
}

/// The largest difference of two matrices over the largest entry.
fn difference(one: &HalfMatrix<f64, 3>, other: &HalfMatrix<f64, 3>) -> f64 {
    let entries = |matrix: &HalfMatrix<f64, 3>| -> BTreeMap<(usize, usize), [[f64; 3]; 3]> {
        let rows = 0..matrix.rows();
        let row = |row| matrix.lower_row(row).map(move |(column, block)| ((row, column), *block));
        rows.flat_map(row).collect()
    };
    let (one, other) = (entries(one), entries(other));
    assert!(one.keys().eq(other.keys()));
    let largest = one.values().flatten().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let pairs = one.values().flatten().flatten().zip(other.values().flatten().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// The entries of a matrix by other numbers of its rows and columns.
fn entries<T: Entry>(
    matrix: &SparseRows<T>,
    row_of: impl Fn(usize) -> usize,
    column_of: impl Fn(usize) -> usize,
) -> BTreeMap<(usize, usize), T> {
    let (row_of, column_of) = (&row_of, &column_of);
    let row = |row: usize| {
        matrix.row(row).map(move |(column, value)| ((row_of(row), column_of(column)), *value))
    };
    (0..matrix.rows()).flat_map(row).collect()
}

fn law(of: &LinearElastic) -> Law {
    Law::NeoHookean(NeoHookean { lambda: of.lambda(), mu: of.shear_modulus() })
}

#[test]
fn the_tangent_of_plain_tetrahedra_at_rest_is_the_linear_stiffness() {
    let (scene, materials) = (AtRest::new(), [material()]);
    let (dof_map, laws) = (scene.dof_map(), [law(&materials[0])]);
    let linear = scene.linear(&materials).assemble(&dof_map, &Unobserved).unwrap().unwrap();
    let problem = scene.problem(&laws, false);
    let kept = CellBulkModulus::in_pressed(0.0, vec![false; scene.mesh.cells.len()]);
    let tissue = Tissue::new(&problem, &dof_map, &kept).unwrap();
    let tangent = tissue.at(&tissue.rest, &[], None).tangent(&Unobserved).unwrap();
    let off = difference(&linear, &tangent);
    assert!(off < 1e-14, "{off:e}");
}

/// K, B and C, with all of the bulk modulus in the pressures. With a share of it in the cells K has that share more.
#[test]
fn matrices_of_tetrahedra_with_pressures_at_rest_are_those_of_linear_elasticity() {
    let (scene, materials) = (AtRest::new(), [material()]);
    let (dof_map, laws) = (scene.dof_map(), [law(&materials[0])]);
    let linear = scene.linear(&materials);
    let stiffness = shear_stiffness(&linear, &dof_map, &Unobserved).unwrap().unwrap();
    let cells = PressureCells::new(&linear, &dof_map);
    let constrained = Constrained { constraints: &scene.constraints, dof_map: &dof_map };
    let coupling = couple(&linear, &constrained, &cells).unwrap();

    let problem = scene.problem(&laws, true);
    let kept = CellBulkModulus::in_pressed(1.0, vec![false; scene.mesh.cells.len()]);
    let tissue = Tissue::new(&problem, &dof_map, &kept).unwrap();
    let mut pressures = tissue.pressures(&problem, &kept, BTreeMap::new()).unwrap();
    let p = vec![0.0; pressures.count()];
    let deformed = tissue.at(&tissue.rest, &p, Some(&pressures));
    let off = difference(&stiffness, &deformed.tangent(&Unobserved).unwrap());
    assert!(off < 1e-14, "K: {off:e}");
    let with_bulk = CellBulkModulus::in_pressed(1.0, vec![true; scene.mesh.cells.len()]);
    let stiffer = Tissue::new(&problem, &dof_map, &with_bulk).unwrap();
    let tangent = stiffer.at(&stiffer.rest, &p, Some(&pressures)).tangent(&Unobserved).unwrap();
    assert!(difference(&stiffness, &tangent) > 0.1);

    // Pressures are numbered in another order: each by the row of its node.
    let rows_of = |numbers: &mut dyn Iterator<Item = ([u32; 4], [u32; 4])>| {
        let pairs = numbers.flat_map(|(rows, own)| rows.into_iter().zip(own));
        pairs.map(|(row, own)| (own as usize, row as usize)).collect::<BTreeMap<usize, usize>>()
    };
    let simplices = &tissue.simplices.cells;
    let own: Vec<(usize, [u32; 4])> = pressures.numbers().collect();
    let of_finite = rows_of(&mut own.into_iter().map(|(cell, own)| (simplices[cell].rows, own)));
    let of_linear = rows_of(&mut cells.rows.iter().copied().zip(cells.pressures.iter().copied()));
    assert_eq!(of_finite.len(), of_linear.len());
    let at_rest = pressures.coupling_at(&|simplex| deformed.gradients(simplex));
    let pressures_of = |matrix: &SparseRows<f64>, of: &BTreeMap<usize, usize>| {
        entries(matrix, |row| of[&row], |column| of[&column])
    };
    let compliances = [
        pressures_of(&coupling.compliance, &of_linear),
        pressures_of(&at_rest.compliance, &of_finite),
    ];
    assert!(compliances[0].keys().eq(compliances[1].keys()));
    for (a, b) in compliances[0].values().zip(compliances[1].values()) {
        assert!((a - b).abs() < 1e-14, "C: {a} {b}");
    }
    let divergences = [
        entries(&coupling.divergence, |row| of_linear[&row], |node| node),
        entries(&at_rest.divergence, |row| of_finite[&row], |node| node),
    ];
    assert!(divergences[0].keys().eq(divergences[1].keys()));
    for (a, b) in divergences[0].values().zip(divergences[1].values()) {
        let apart = (Vector::from(*a) - Vector::from(*b)).norm();
        assert!(apart < 1e-13, "B: {apart:e}");
    }
}
