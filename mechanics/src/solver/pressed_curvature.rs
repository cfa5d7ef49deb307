//! Second-order condition of a mixed solution: whether the Schur complement S = K + B^T C^-1 B of the displacements is
//! positive definite, so that the energy is at a minimum.
//!
//! Conjugate gradients on S under the multigrid cycle of K: a direction without positive curvature ends them (Steihaug 1983).
//! S is stiffer than K by the bulk modulus, so they take more iterations the nearer Poisson's ratio is to 1/2.

use super::conjugate_gradient::StoppingCriterion;
use super::lanes::Lanes;
use super::mixed_system::MixedSystem;
use super::vector::{axpby, dot, norm, ratio, update};
use super::{SolverError, Unknowns, tell};
use crate::progress::Progress;

/// Residual of C^-1 as a part of the one that is wanted of S. From nothing, conjugate gradients approach v C^-1 v from below with the
/// square of what is left, so that a curvature is off by less than 1e-8 of itself.
const SHARP: f64 = 0.01;

/// Iterations after which C^-1 is not met.
const MOST_OF_MASS: usize = 300;

type Vectors = Vec<Lanes<f64, 3, 1>>;

/// Whether S is positive definite along all that iterations meet on the way to a load; none where they end before they meet it.
pub fn is_positive_definite(
    system: &MixedSystem,
    load: &Unknowns,
    criterion: StoppingCriterion,
    progress: &dyn Progress,
) -> Result<Option<bool>, SolverError> {
    let multigrid = system.solver.hierarchy(system.stiffness, progress)?;
    let mut workspace = multigrid.workspace::<1>();
    let mut r: Vectors = load.iter().map(|values| values.map(|value| [value])).collect();
    system.stiffness.zero_constrained(&mut r);
    let wanted = criterion.relative_residual;
    let scale = norm(r.as_flattened())[0];
    let zeros = || vec![[[0.0]; 3]; r.len()];
    let (mut x, mut p) = (zeros(), zeros());
    let mut rho = 0.0;
    let mut last: Option<(f64, Vectors)> = None;
    for iteration in 1..=criterion.most_iterations {
        let correction = multigrid.apply(&r, &mut workspace);
        let z = correction.values.as_flattened();
        // Conjugate to the last direction, whatever the cycle rounds (Golub, Ye 1999).
        let factor = last.as_ref().map_or(0.0, |(step, product)| {
            let along = dot(product.as_flattened(), z)[0] * correction.scale[0];
            ratio(-step * along, rho)
        });
        axpby(p.as_flattened_mut(), &[factor], z, &correction.scale);
        rho = dot(r.as_flattened(), p.as_flattened())[0];
        let Some(product) = product(system, &p, SHARP * wanted) else { return Ok(None) };
        let curvature = dot(p.as_flattened(), product.as_flattened())[0];
        if !curvature.is_finite() || !rho.is_finite() {
            return Err(SolverError::NotFinite);
        }
        if curvature <= 0.0 {
            return Ok(Some(false));
        }
        let (own, rest, step) = (x.as_flattened_mut(), r.as_flattened_mut(), rho / curvature);
        let left = update(own, rest, &[step], p.as_flattened(), product.as_flattened());
        let residual = ratio(left[0], scale);
        last = Some((step, product));
        tell(progress, iteration, residual, wanted)?;
        if residual <= wanted {
            return Ok(Some(true));
        }
    }
    Ok(None)
}

/// S u, with C^-1 to a relative residual; none where that is not met.
fn product(system: &MixedSystem, u: &Vectors, relative_residual: f64) -> Option<Vectors> {
    let coupling = system.coupling;
    let mut product = vec![[[0.0]; 3]; u.len()];
    system.stiffness.multiply(u, &mut product);
    let mut volumes = vec![[0.0]; coupling.mass.len()];
    coupling.divergence.contract(u, &mut volumes);
    let p = by_compliance(system, &volumes, relative_residual)?;
    coupling.gradient.add_expanded(&p, &mut product);
    system.stiffness.zero_constrained(&mut product);
    Some(product)
}

/// C^-1 v, by conjugate gradients under the diagonal.
fn by_compliance(
    system: &MixedSystem,
    v: &[[f64; 1]],
    relative_residual: f64,
) -> Option<Vec<[f64; 1]>> {
    let compliance = &system.coupling.compliance;
    let diagonal = |row: usize| -> f64 {
        compliance.row(row).find(|(column, _)| *column == row).map_or(1.0, |(_, value)| *value)
    };
    let diagonal: Vec<f64> = (0..v.len()).map(diagonal).collect();
    let scale = norm(v)[0];
    let mut x = vec![[0.0]; v.len()];
    if scale == 0.0 {
        return Some(x);
    }
    let mut r = v.to_vec();
    let conditioned = |r: &[[f64; 1]]| -> Vec<[f64; 1]> {
        r.iter().zip(&diagonal).map(|([r], own)| [r / own]).collect()
    };
    let mut p = conditioned(&r);
    let mut rho = dot(&r, &p)[0];
    let mut product = vec![[0.0]; v.len()];
    for _ in 0..MOST_OF_MASS {
        compliance.multiply(&p, &mut product);
        let step = rho / dot(&p, &product)[0];
        if update(&mut x, &mut r, &[step], &p, &product)[0] <= relative_residual * scale {
            return Some(x);
        }
        let z = conditioned(&r);
        let next = dot(&r, &z)[0];
        p.iter_mut().zip(&z).for_each(|([p], [z])| *p = z + next / rho * *p);
        rho = next;
    }
    None
}
