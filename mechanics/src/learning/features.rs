//! Features of a case: blocks of numbers of one unit each, standardised by what they are in the training cases.
//!
//! x = (x_1 / m_1, x_2 / m_2, ...),  m_b the mean length of block b over the training cases. A block that is zero in all of
//! them says nothing and is left out. Blocks are standardised as wholes, so that places where nothing happens are not
//! blown up to the size of those where something does.

use super::pairs::Pairs;

/// How far features are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// The sum of absolute differences (Zhang et al. 2016).
    L1,
    /// The Euclidean norm.
    L2,
}

/// The blocks of one case, in the same order in all cases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    pub blocks: Vec<Vec<f64>>,
}

/// Cases by what their blocks are apart, before anything is standardised.
#[derive(Clone, Debug)]
pub struct FeatureSpace {
    distance: Distance,
    /// By block, for each case.
    lengths: Vec<Vec<f64>>,
    /// By block.
    between: Vec<Pairs>,
}

impl Distance {
    fn of(self, first: &[f64], second: &[f64]) -> f64 {
        self.length(first.iter().zip(second).map(|(a, b)| a - b))
    }

    fn length(self, values: impl Iterator<Item = f64>) -> f64 {
        match self {
            Distance::L1 => values.map(f64::abs).sum(),
            Distance::L2 => values.map(|value| value * value).sum::<f64>().sqrt(),
        }
    }
}

impl Features {
    /// What each block of these is apart from that of another case.
    pub fn apart(&self, other: &Features, distance: Distance) -> Vec<f64> {
        self.blocks.iter().zip(&other.blocks).map(|(a, b)| distance.of(a, b)).collect()
    }
}

/// Divisors of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Standard {
    pub distance: Distance,
    /// Mean lengths of the blocks in the training cases.
    pub lengths: Vec<f64>,
}

impl Standard {
    /// How far cases are apart whose blocks are this far apart.
    pub fn of(&self, apart: impl IntoIterator<Item = f64>) -> f64 {
        let blocks = apart.into_iter().zip(&self.lengths).filter(|(_, length)| **length > 0.0);
        self.distance.length(blocks.map(|(apart, length)| apart / length))
    }
}

impl FeatureSpace {
    pub fn new(cases: &[Features], distance: Distance) -> Self {
        let blocks = 0..cases.first().map_or(0, |own| own.blocks.len());
        let length =
            |own: &Features, block: usize| distance.length(own.blocks[block].iter().copied());
        let between = |block: usize| {
            Pairs::of(cases.len(), |i, j| {
                distance.of(&cases[i].blocks[block], &cases[j].blocks[block])
            })
        };
        FeatureSpace {
            distance,
            lengths: blocks
                .clone()
                .map(|block| cases.iter().map(|own| length(own, block)).collect())
                .collect(),
            between: blocks.map(between).collect(),
        }
    }

    /// Means over training cases.
    pub fn standard(&self, training: &[usize]) -> Standard {
        let mean = |lengths: &Vec<f64>| {
            training.iter().map(|&case| lengths[case]).sum::<f64>() / training.len() as f64
        };
        Standard { distance: self.distance, lengths: self.lengths.iter().map(mean).collect() }
    }

    /// Among training cases, standardised by them.
    pub fn distances(&self, training: &[usize]) -> Pairs {
        let standard = self.standard(training);
        Pairs::of(training.len(), |i, j| self.apart(&standard, training[i], training[j]))
    }

    /// Of a case from training cases, standardised by those.
    pub fn row(&self, case: usize, training: &[usize]) -> Vec<f64> {
        let standard = self.standard(training);
        training.iter().map(|&other| self.apart(&standard, case, other)).collect()
    }

    fn apart(&self, standard: &Standard, first: usize, second: usize) -> f64 {
        standard.of(self.between.iter().map(|block| block.at(first, second)))
    }
}
