//! Triangular prisms cut into tetrahedra along given diagonals.

/// A prism over the triangle of its first three nodes, whose other three lie above them: from there the first three are
/// seen counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prism {
    pub low: [u32; 3],
    pub high: [u32; 3],
    /// The diagonal of each side, from corner i to corner i + 1: it rises, from the low i to the high i + 1, or falls.
    pub rises: [bool; 3],
}

impl Prism {
    /// Three tetrahedra; none where the diagonals run in a circle, which no three tetrahedra have.
    pub fn tetrahedra(&self) -> Option<[[u32; 4]; 3]> {
        let Prism { low, high, rises } = *self;
        // The low corner at which two diagonals begin.
        let k = (0..3).find(|&k| rises[k] && !rises[(k + 2) % 3])?;
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let top = [low[k], high[0], high[1], high[2]];
        Some(if rises[next] {
            [top, [low[0], low[1], low[2], high[last]], [low[k], low[next], high[last], high[next]]]
        } else {
            [top, [low[0], low[1], low[2], high[next]], [low[k], low[last], high[last], high[next]]]
        })
    }

    /// The tetrahedra around a node in its middle.
    pub fn around(&self, centre: u32) -> [[u32; 4]; 8] {
        let Prism { low, high, rises } = *self;
        let mut faces = [[low[0], low[1], low[2]]; 8];
        faces[1] = [high[0], high[2], high[1]];
        for i in 0..3 {
            let next = (i + 1) % 3;
            let [a, b, c, d] = [low[i], low[next], high[next], high[i]];
            let two = if rises[i] { [[a, c, b], [a, d, c]] } else { [[a, d, b], [b, d, c]] };
            faces[2 + 2 * i] = two[0];
            faces[3 + 2 * i] = two[1];
        }
        faces.map(|[a, b, c]| [a, b, c, centre])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vector;
    use crate::meshing::shape::determinant;

    const CORNERS: [[f64; 3]; 7] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [0.3, 0.3, 0.5],
    ];

    fn volumes(tetrahedra: &[[u32; 4]]) -> Vec<f64> {
        let at = |node: u32| Vector::from(CORNERS[node as usize]);
        tetrahedra.iter().map(|tet| determinant(&tet.map(at)) / 6.0).collect()
    }

    fn prism(bits: u32) -> Prism {
        let rises = [0, 1, 2].map(|side| bits >> side & 1 == 1);
        Prism { low: [0, 1, 2], high: [3, 4, 5], rises }
    }

    #[test]
    fn a_prism_is_three_tetrahedra_the_right_way_round_with_the_diagonals_asked_for() {
        for bits in 1..7 {
            let prism = prism(bits);
            let tetrahedra = prism.tetrahedra().unwrap();
            assert!(volumes(&tetrahedra).iter().all(|volume| (volume - 1.0 / 6.0).abs() < 1e-15));
            for side in 0..3 {
                let next = (side + 1) % 3;
                let ends = if prism.rises[side] { [side, 3 + next] } else { [next, 3 + side] };
                let has = |tet: &[u32; 4]| ends.iter().all(|&end| tet.contains(&(end as u32)));
                assert!(tetrahedra.iter().any(has), "{bits} {side}");
            }
        }
    }

    #[test]
    fn a_prism_with_diagonals_in_a_circle_is_filled_about_its_middle() {
        for bits in [0, 7] {
            assert_eq!(prism(bits).tetrahedra(), None);
        }
        for bits in 0..8 {
            let volumes = volumes(&prism(bits).around(6));
            assert!(volumes.iter().all(|&volume| volume > 0.0), "{bits}: {volumes:?}");
            assert!((volumes.iter().sum::<f64>() - 0.5).abs() < 1e-15);
        }
    }
}
