//! Energy of a change of volume, U(J), in kPa.

/// How the energy grows with the volume; K is the bulk modulus in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Volumetric {
    /// K/4 (J^2 - 1 - 2 ln J): convex in J, and without bound at J = 0.
    Barrier(f64),
    /// K/2 ln^2 J.
    Logarithmic(f64),
}

/// U, U' and U''.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfVolume {
    pub energy: f64,
    pub first: f64,
    pub second: f64,
}

/// U = c/2 ln^2 J + m/2 r^2 with r = 3 (J^2 - 1) / (J^2 + 4 J + 1): ln J up to the fourth order about J = 1, and between -3
/// and 3, so that a point which has m taken from it keeps its barrier against collapse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VolumeEnergy {
    /// c in kPa.
    pub logarithmic: f64,
    /// m in kPa.
    pub bounded: f64,
}

impl VolumeEnergy {
    /// In kPa, at rest.
    pub fn bulk_modulus(self) -> f64 {
        self.logarithmic + self.bounded
    }

    #[inline]
    pub fn at(self, j: f64) -> OfVolume {
        let log = Volumetric::Logarithmic(self.logarithmic).at(j);
        let below = j * j + 4.0 * j + 1.0;
        let r = 3.0 * (j * j - 1.0) / below;
        let first = 12.0 * (j * j + j + 1.0) / (below * below);
        let second = -12.0 * (((2.0 * j + 3.0) * j + 6.0) * j + 7.0) / below.powi(3);
        OfVolume {
            energy: log.energy + 0.5 * self.bounded * r * r,
            first: log.first + self.bounded * r * first,
            second: log.second + self.bounded * (first * first + r * second),
        }
    }
}

impl Volumetric {
    #[inline]
    pub(super) fn at(self, j: f64) -> OfVolume {
        match self {
            Volumetric::Barrier(bulk) => OfVolume {
                energy: 0.25 * bulk * (j * j - 1.0 - 2.0 * j.ln()),
                first: 0.5 * bulk * (j - 1.0 / j),
                second: 0.5 * bulk * (1.0 + 1.0 / (j * j)),
            },
            Volumetric::Logarithmic(bulk) => OfVolume {
                energy: 0.5 * bulk * j.ln().powi(2),
                first: bulk * j.ln() / j,
                second: bulk * (1.0 - j.ln()) / (j * j),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_energy_of_volume_is_that_of_ln_j_near_rest_and_its_bounded_part_stays_bounded() {
        let (both, log) = (
            VolumeEnergy { logarithmic: 7.0, bounded: 4.0 },
            VolumeEnergy { logarithmic: 11.0, bounded: 0.0 },
        );
        for j in [0.99, 1.01] {
            let (both, log) = (both.at(j), log.at(j));
            assert!((both.energy - log.energy).abs() < 1e-10 * 4.0);
            assert!((both.first - log.first).abs() < 1e-8 * 4.0, "{both:?} {log:?}");
        }
        for j in [0.05, 0.6, 1.7, 30.0] {
            let step = 1e-5 * j;
            let (below, at, above) = (both.at(j - step), both.at(j), both.at(j + step));
            let first = (above.energy - below.energy) / (2.0 * step);
            let second = (above.first - below.first) / (2.0 * step);
            assert!((first - at.first).abs() < 1e-6 * at.first.abs(), "{j}");
            assert!((second - at.second).abs() < 1e-6 * at.second.abs(), "{j}");
        }
        let bounded = VolumeEnergy { logarithmic: 0.0, bounded: 4.0 };
        assert!([1e-9, 1e9].into_iter().all(|j| bounded.at(j).energy <= 0.5 * 4.0 * 9.0));
    }
}
