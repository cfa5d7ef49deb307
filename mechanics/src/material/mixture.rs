//! A point that is several tissues at once, each to its share.
//!
//! By Voigt C = sum_i f_i C_i with sum_i f_i = 1: for isotropic tissue K = sum f_i K_i and mu = sum f_i mu_i, so
//! E = 9 K mu / (3 K + mu) and nu = (3 K - 2 mu) / (6 K + 2 mu) (docs/methods.md#tissue-from-images). All parts are strained alike,
//! which makes the stiffest mixture that the shares allow; the other rules take other means of K and mu. Density is that of the
//! shares. Of parts with fibres along one direction C is mixed as a whole (`transversely_isotropic`), by Voigt linear in lambda,
//! mu, dlam, dmu and beta.
//!
//! Source: the equivalent property of Kim et al. 2012 (Mass tensor), stated there for the shares of points;
//! that the constants are mixed and not E and nu themselves is a choice of ours.

use super::LinearElastic;
pub use super::mixing_rule::MixingRule;

/// The mixture of parts with these shares, which sum to 1, by a rule; there is at least one. Fibres, where parts have any, are
/// along one direction; laws of finite strain are left out. Muscle of 790 kPa in a tenth of fat of 3 kPa is 81.7, 3.33 or 5.24 kPa.
pub fn mixture(parts: &[(f64, LinearElastic)], rule: MixingRule) -> LinearElastic {
    let terms = |of: fn(&LinearElastic) -> f64| parts.iter().map(move |(f, part)| (*f, of(part)));
    let bulk = rule.mean(terms(LinearElastic::bulk_modulus));
    let shear = rule.mean(terms(LinearElastic::shear_modulus));
    // 9 K mu / (3 K + mu), whose products would leave the range of numbers for the softest tissue.
    let young_modulus = 9.0 * shear / (3.0 + shear / bulk);
    let poisson_ratio = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
    // nu lies between those of the parts, which rounding may overstep; E may be beyond theirs where they differ in
    // nu, and a law of 1e9 kPa is no tissue any more.
    let largest = parts.iter().map(|(_, part)| part.poisson_ratio()).fold(0.0, f64::max);
    let density = terms(LinearElastic::density).map(|(share, value)| share * value).sum::<f64>();
    let across = LinearElastic::new(
        young_modulus.clamp(1e-9, 1e9),
        poisson_ratio.clamp(0.0, largest),
        density.clamp(0.0, 100.0),
    )
    .expect("a mixture of valid tissues lies within the same bounds");
    across.with_mixed_fibres(parts, rule)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: [MixingRule; 3] = [MixingRule::Voigt, MixingRule::Reuss, MixingRule::Geometric];

    fn tissue(young_modulus: f64, poisson_ratio: f64, density: f64) -> LinearElastic {
        LinearElastic::new(young_modulus, poisson_ratio, density).unwrap()
    }

    #[test]
    fn both_moduli_and_the_density_are_linear_in_the_shares() {
        let (fat, muscle) = (tissue(3.0, 0.46, 0.9), tissue(300.0, 0.3, 1.1));
        for share in [0.0, 0.125, 0.5, 1.0] {
            let mixed = mixture(&[(1.0 - share, fat), (share, muscle)], MixingRule::Voigt);
            let linear =
                |of: fn(&LinearElastic) -> f64| (1.0 - share) * of(&fat) + share * of(&muscle);
            // Rounding of E and nu, which the moduli are taken from again.
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b, "{share}: {a} {b}");
            close(mixed.shear_modulus(), linear(LinearElastic::shear_modulus));
            close(mixed.bulk_modulus(), linear(LinearElastic::bulk_modulus));
            close(mixed.density(), linear(LinearElastic::density));
        }
    }

    #[test]
    fn the_stiffness_of_parts_with_fibres_is_linear_in_the_shares() {
        use super::super::{Fibre, FibreLaw};
        use nalgebra::{Matrix3, Vector3};
        let fibre = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
        let muscle = tissue(6.2, 0.49, 1.04).with_fibre(&fibre).unwrap();
        let fat = tissue(3.0, 0.46, 0.9);
        let along = Vector3::new(0.36, 0.48, -0.8);
        let strain = Matrix3::new(0.1, 0.02, -0.3, 0.02, -0.2, 0.05, -0.3, 0.05, 0.4);
        for share in [0.0, 0.1, 0.5, 1.0] {
            let mixed = mixture(&[(1.0 - share, fat), (share, muscle)], MixingRule::Voigt);
            let [a, b] = [fat, muscle].map(|part| part.tensor(&along).stress(&strain));
            let wanted = a * (1.0 - share) + b * share;
            let found = mixed.tensor(&along).stress(&strain);
            assert!((found - wanted).amax() < 1e-11 * wanted.amax(), "{share}: {found} {wanted}");
            assert!(mixed.tensor(&along).smallest_eigenvalue() > 0.0);
            let told = (1.0 - share) * 3.0 + share * 110.0;
            assert!((mixed.fibre_modulus().unwrap() - told).abs() < 1e-12);
        }
        assert!(!mixture(&[(0.5, fat), (0.5, fat)], MixingRule::Voigt).has_fibre());
    }

    #[test]
    fn a_tenth_of_muscle_in_fat_is_what_the_rule_makes_of_it() {
        let parts = [(0.1, tissue(790.0, 0.43, 1.06)), (0.9, tissue(3.0, 0.46, 0.92))];
        let of = |rule| mixture(&parts, rule);
        let voigt = of(MixingRule::Voigt);
        assert!((voigt.young_modulus() - 81.74).abs() < 0.005, "{}", voigt.young_modulus());
        assert!((voigt.poisson_ratio() - 0.43166).abs() < 5e-6, "{}", voigt.poisson_ratio());
        for (rule, known) in [(MixingRule::Reuss, 3.33), (MixingRule::Geometric, 5.24)] {
            let found = of(rule).young_modulus();
            assert!((found - known).abs() < 0.005, "{rule:?}: {found}");
        }
        assert!((voigt.density() - 0.934).abs() < 1e-12);
        for rule in RULES {
            let alone = mixture(&[(1.0, parts[0].1)], rule);
            assert!((alone.young_modulus() - 790.0).abs() < 1e-9, "{rule:?}");
        }
    }

    /// The stiffness and the compliance of tissue as 6 x 6 matrices about x, by pulling and shearing it.
    fn matrix(tissue: &LinearElastic) -> nalgebra::SMatrix<f64, 6, 6> {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let places = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
        let size = |place: usize| if place < 3 { 1.0 } else { half };
        let tensor = tissue.tensor(&nalgebra::Vector3::x());
        nalgebra::SMatrix::from_fn(|row, column| {
            let mut strain = nalgebra::Matrix3::zeros();
            let (i, j) = places[column];
            strain[(i, j)] = size(column);
            strain[(j, i)] = size(column);
            tensor.stress(&strain)[places[row]] * if row < 3 { 1.0 } else { 2.0 * half }
        })
    }

    #[test]
    fn parts_with_fibres_that_are_stressed_alike_add_up_their_strains() {
        use super::super::{Fibre, FibreLaw};
        let fibre = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
        let muscle = tissue(6.2, 0.49, 1.04).with_fibre(&fibre).unwrap();
        let fat = tissue(3.0, 0.46, 0.9);
        for share in [0.1, 0.5, 1.0] {
            let parts = [(1.0 - share, fat), (share, muscle)];
            let [a, b] = [fat, muscle].map(|part| matrix(&part));
            let [a, b] = [a, b].map(|own| own.try_inverse().unwrap());
            let known = (a * (1.0 - share) + b * share).try_inverse().unwrap();
            let found = matrix(&mixture(&parts, MixingRule::Reuss));
            assert!((found - known).amax() < 1e-9 * known.amax(), "{share}: {found} {known}");
            let log = |own: &LinearElastic| {
                let modes = matrix(own).symmetric_eigen();
                let logs = nalgebra::SMatrix::from_diagonal(&modes.eigenvalues.map(f64::ln));
                modes.eigenvectors * logs * modes.eigenvectors.transpose()
            };
            let known = log(&fat) * (1.0 - share) + log(&muscle) * share;
            let found = log(&mixture(&parts, MixingRule::Geometric));
            assert!((found - known).amax() < 1e-9, "{share}: {found} {known}");
        }
    }

    #[test]
    fn extreme_parts_still_mix_to_a_tissue() {
        let parts = [
            tissue(1e9, 0.0, 0.0),
            tissue(1e9, 0.499_999_999_999_999_9, 100.0),
            tissue(1e-9, 0.0, 0.0),
        ];
        for shares in [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.25, 0.75], [0.0, 0.0, 1.0]] {
            for rule in RULES {
                let mixed = mixture(&[0, 1, 2].map(|part| (shares[part], parts[part])), rule);
                assert!(mixed.young_modulus() > 0.0 && mixed.lambda().is_finite(), "{shares:?}");
            }
        }
    }
}
