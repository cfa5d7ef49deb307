//! Rigorous bounds of a cubic B-spline over a box: the coefficients of its polynomial pieces bound it.
//!
//! Between eight voxel centres the spline is one tricubic polynomial. Its 64 Bernstein coefficients are means of the 64
//! B-spline coefficients around it, and every value lies between the smallest and the largest of them (Farin, Curves and
//! Surfaces for CAGD, 5th edition, 2002, sections 4.3 and 8.5: along an axis b0 = (c0 + 4 c1 + c2) / 6,
//! b1 = (2 c1 + c2) / 3, b2 = (c1 + 2 c2) / 3, b3 = (c1 + 4 c2 + c3) / 6). A pyramid of these bounds over blocks
//! of 1 (2 for large images), 2, 4, ... pieces answers for a box of any size in few steps.

use rayon::prelude::*;

use super::lines::Size;
use super::spline::CubicSpline;

/// A box of more blocks than this along an axis is asked of the next coarser level.
const MOST_BLOCKS: usize = 4;
/// Images of more voxels keep no bounds of single pieces, which would take more memory than the spline.
const LARGE: usize = 1 << 22;

/// The smallest and the largest value of each channel, or what bounds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range<const N: usize> {
    pub low: [f32; N],
    pub high: [f32; N],
}

impl<const N: usize> Range<N> {
    const EMPTY: Self = Range { low: [f32::INFINITY; N], high: [f32::NEG_INFINITY; N] };

    fn with(mut self, other: &Self) -> Self {
        for channel in 0..N {
            self.low[channel] = self.low[channel].min(other.low[channel]);
            self.high[channel] = self.high[channel].max(other.high[channel]);
        }
        self
    }

    fn with_value(self, value: [f32; N]) -> Self {
        self.with(&Range { low: value, high: value })
    }

    /// Wider by more than the rounding of means.
    fn with_rounding_margin(mut self) -> Self {
        for channel in 0..N {
            let slack = 1e-6 * self.low[channel].abs().max(self.high[channel].abs());
            self.low[channel] -= slack;
            self.high[channel] += slack;
        }
        self
    }
}

/// Ranges of all blocks of one size.
#[derive(Clone, Debug)]
struct Level<const N: usize> {
    size: Size,
    blocks: Vec<Range<N>>,
}

/// The pyramid of one spline.
#[derive(Clone, Debug)]
pub struct SplineRanges<const N: usize> {
    /// Polynomial pieces along each axis.
    pieces: Size,
    /// The binary logarithm of the pieces of a block of the first level along an axis.
    finest: usize,
    levels: Vec<Level<N>>,
}

impl<const N: usize> SplineRanges<N> {
    pub fn new(spline: &CubicSpline<N>) -> Self {
        let pieces = spline.size().map(|size| size - 1);
        let finest = usize::from(spline.coefficients().len() > LARGE);
        let mut levels = vec![single_pieces(spline, pieces, 1 << finest)];
        while let Some(level) = levels.last().filter(|level| level.blocks.len() > 1) {
            let next = halved(level);
            levels.push(next);
        }
        SplineRanges { pieces, finest, levels }
    }

    /// Bounds of the spline over a box given by its lowest and highest place, in voxels; beyond the border over the nearest
    /// places on it.
    pub fn over(&self, low: [f64; 3], high: [f64; 3]) -> Range<N> {
        let piece = |place: [f64; 3]| -> Size {
            std::array::from_fn(|axis| (place[axis].max(0.0) as usize).min(self.pieces[axis] - 1))
        };
        let (from, to) = (piece(low), piece(high));
        let blocks = |level: usize| {
            let along = |axis: usize| {
                let shift = level + self.finest;
                (to[axis] >> shift).saturating_sub(from[axis] >> shift) + 1
            };
            along(0).max(along(1)).max(along(2))
        };
        let fits = (0..self.levels.len()).find(|&level| blocks(level) <= MOST_BLOCKS);
        let number = fits.unwrap_or(self.levels.len() - 1);
        let level = &self.levels[number];
        let [from, to] =
            [from, to].map(|corner| corner.map(|index| index >> (number + self.finest)));
        let mut range = Range::EMPTY;
        for z in from[2]..=to[2] {
            for y in from[1]..=to[1] {
                let start = (z * level.size[1] + y) * level.size[0];
                let row = &level.blocks[start + from[0]..=start + to[0]];
                range = row.iter().fold(range, Range::with);
            }
        }
        range
    }
}

/// Ranges of blocks of so many pieces along each axis.
fn single_pieces<const N: usize>(spline: &CubicSpline<N>, pieces: Size, block: usize) -> Level<N> {
    let size = pieces.map(|pieces| pieces.div_ceil(block));
    let mut blocks = vec![Range::EMPTY; size.iter().product()];
    blocks.par_chunks_mut(size[0] * size[1]).enumerate().for_each(|(layer, blocks)| {
        for z in layer * block..((layer + 1) * block).min(pieces[2]) {
            add_layer(spline, pieces, z, &mut |[x, y]: [usize; 2], range: Range<N>| {
                let slot = &mut blocks[y / block * size[0] + x / block];
                *slot = slot.with(&range);
            });
        }
    });
    Level { size, blocks }
}

/// Calls `each` with the range of every piece of a layer.
fn add_layer<const N: usize>(
    spline: &CubicSpline<N>,
    pieces: Size,
    z: usize,
    each: &mut impl FnMut([usize; 2], Range<N>),
) {
    let [nx, ny, _] = spline.padded_size();
    let coefficient =
        |x: usize, y: usize, k: usize| spline.coefficients()[((z + k) * ny + y) * nx + x];
    // Bernstein along the third axis, B-spline along the others.
    let layers: Vec<[[f32; N]; 4]> = (0..nx * ny)
        .map(|n| bernstein(std::array::from_fn(|k| coefficient(n % nx, n / nx, k))))
        .collect();
    let mut rows = vec![[[[0.0; N]; 4]; 4]; nx];
    for y in 0..pieces[1] {
        for (x, row) in rows.iter_mut().enumerate() {
            *row = std::array::from_fn(|k| {
                bernstein(std::array::from_fn(|j| layers[(y + j) * nx + x][k]))
            });
        }
        for x in 0..pieces[0] {
            each([x, y], piece_range(&rows[x..]));
        }
    }
}

/// The range of a piece from the four columns of coefficients around it, Bernstein along the second and third axis.
fn piece_range<const N: usize>(columns: &[[[[f32; N]; 4]; 4]]) -> Range<N> {
    let mut range = Range::EMPTY;
    let places = (0..4).flat_map(|k| (0..4).map(move |j| (k, j)));
    for (k, j) in places {
        let along = bernstein(std::array::from_fn(|i| columns[i][k][j]));
        range = along.into_iter().fold(range, Range::with_value);
    }
    range.with_rounding_margin()
}

/// B-spline coefficients around an interval to Bernstein coefficients on it.
fn bernstein<const N: usize>([a, b, c, d]: [[f32; N]; 4]) -> [[f32; N]; 4] {
    let mut found = [[0.0; N]; 4];
    for n in 0..N {
        let [a, b, c, d] = [a[n], b[n], c[n], d[n]];
        found[0][n] = (a + 4.0 * b + c) * (1.0 / 6.0);
        found[1][n] = (2.0 * b + c) * (1.0 / 3.0);
        found[2][n] = (b + 2.0 * c) * (1.0 / 3.0);
        found[3][n] = (b + 4.0 * c + d) * (1.0 / 6.0);
    }
    found
}

/// Blocks twice as long along each axis.
fn halved<const N: usize>(finer: &Level<N>) -> Level<N> {
    let fine = finer.size;
    let size = fine.map(|size| size.div_ceil(2));
    let mut blocks = vec![Range::EMPTY; size.iter().product()];
    for (n, range) in finer.blocks.iter().enumerate() {
        let [x, y, z] = [n % fine[0], n / fine[0] % fine[1], n / (fine[0] * fine[1])];
        let slot = &mut blocks[((z / 2) * size[1] + y / 2) * size[0] + x / 2];
        *slot = slot.with(range);
    }
    Level { size, blocks }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part in [0, 1) for each number.
    fn part(n: usize, step: f64) -> f64 {
        ((n + 1) as f64 * step).fract()
    }

    #[test]
    fn no_value_in_a_box_leaves_its_range() {
        let size = [9, 20, 33];
        let count = size.iter().product();
        let noise = (0..count).map(|n: usize| (part(n, 0.618_034) * 1000.0) as f32).collect();
        let ramp = (0..count).map(|n: usize| (n / 180) as f32).collect();
        let spline = CubicSpline::new(size, [noise, ramp]);
        let ranges = SplineRanges::new(&spline);
        for n in 0..2000 {
            let steps = [0.754_878, 0.569_840, 0.430_16];
            let extent = 0.2 + 12.0 * part(n, 0.324_7).powi(3);
            let low =
                std::array::from_fn(|axis| part(n, steps[axis]) * (size[axis] + 2) as f64 - 1.5);
            let high = low.map(|low: f64| low + extent);
            let range = ranges.over(low, high);
            for m in 0..20 {
                let place = std::array::from_fn(|axis| {
                    (low[axis] + extent * part(m + n, steps[2 - axis]))
                        .clamp(0.0, (size[axis] - 1) as f64)
                });
                let within = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]));
                if !within {
                    continue;
                }
                let value = spline.at(place);
                for (channel, value) in value.iter().enumerate() {
                    // Weights sum to one but for rounding.
                    let (low, high) = (range.low[channel] - 1e-3, range.high[channel] + 1e-3);
                    assert!((f64::from(low)..=f64::from(high)).contains(value), "{place:?}");
                }
            }
        }
    }

    #[test]
    fn the_range_of_a_ramp_is_that_of_the_pieces_in_its_box() {
        let size = [65, 6, 6];
        let ramp = (0..65 * 36).map(|n: usize| (n % 65) as f32).collect();
        let ranges = SplineRanges::new(&CubicSpline::new(size, [ramp]));
        let found = ranges.over([30.2, 1.0, 1.0], [32.8, 2.0, 2.0]);
        // Rounding to f32.
        assert!(
            (found.low[0] - 30.0).abs() < 1e-4 && (found.high[0] - 33.0).abs() < 1e-4,
            "{found:?}"
        );
    }
}
