//! The sum of columns: one pass over them, a stretch of nodes at a time.
//!
//! u_n = sum_k a_k c_kn, sums in f64: f32 sums of columns of 100 mm would lose up to 1e-4 mm.

use crate::mesh::Vector;
use crate::plan::RigidMovement;

/// Numbers that are summed side by side: their sums stay in the first cache while columns stream past.
/// A multiple of 3, so that a stretch holds whole vectors.
const STRETCH: usize = 1536;

/// Columns that are added in one go, so that the sums are read and written once for all of them.
const TOGETHER: usize = 4;

/// What a plan is as a sum of columns: one movement of each segment, and the amounts of what acts inside, none of which is
/// nothing.
#[derive(Clone, Copy)]
pub struct Amounts<'a> {
    pub movements: &'a [RigidMovement],
    /// Of each of [`Response::inner`].
    pub inner: &'a [f64],
}

/// The displacement of each node; columns as [column][node][xyz], those of the segments first.
pub fn apply<T: Copy + Into<f64>>(
    segments: &[ResponseSegment],
    amounts: &Amounts,
    columns: &[T],
    nodes: usize,
) -> Vec<Vector> {
    let length = 3 * nodes;
    if length == 0 {
        return Vec::new();
    }
    // Twelve zeros for a segment that stays: its columns are passed over.
    let moved = segments.iter().zip(amounts.movements);
    let factors = moved.flat_map(|(segment, movement)| coefficients(movement, &segment.centre));
    let factors = factors.chain(amounts.inner.iter().copied());
    let terms: Vec<(f64, &[T])> =
        factors.zip(columns.chunks_exact(length)).filter(|(factor, _)| *factor != 0.0).collect();
    let mut displacement = Vec::with_capacity(nodes);
    let mut sums = [0.0; STRETCH];
    for begin in (0..length).step_by(STRETCH) {
        let end = (begin + STRETCH).min(length);
        let sums = &mut sums[..end - begin];
        sums.fill(0.0);
        for group in terms.chunks(TOGETHER) {
            match group {
                [(a, p), (b, q), (c, r), (d, s)] => {
                    let [p, q, r, s] = [p, q, r, s].map(|column| &column[begin..end]);
                    for ((((sum, &p), &q), &r), &s) in sums.iter_mut().zip(p).zip(q).zip(r).zip(s) {
                        let first = a * p.into() + b * q.into();
                        let second = c * r.into() + d * s.into();
                        *sum += first + second;
                    }
                }
                rest => {
                    for (factor, column) in rest {
                        for (sum, &value) in sums.iter_mut().zip(&column[begin..end]) {
                            *sum += factor * value.into();
                        }
                    }
                }
            }
        }
        displacement.extend(sums.chunks_exact(3).map(Vector::from_column_slice));
    }
    displacement
}

/// Columns for each segment.
pub const COLUMNS_PER_SEGMENT: usize = 12;

/// The movement of a segment that a response knows.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseSegment {
    pub name: String,
    /// From where x is measured, in mm.
    pub centre: Vector,
}

/// Internal loads, a column each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InnerLoad {
    /// Growth of a region, or of all tissue (`*`); its amount is eps_g, `prediction::linear_strain` of the volume change.
    Growth(String),
    /// A muscle; its amount is the stress in kPa.
    Muscle(String),
}

/// Skin displacement for a unit of each number of each segment's movement, and of what acts inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    pub segments: Vec<ResponseSegment>,
    /// A column each, after those of the segments.
    pub inner: Vec<InnerLoad>,
    /// The skin nodes, ascending.
    pub nodes: Vec<u32>,
    /// [column][node][xyz] in mm; column 12 s + 4 i + j of segment s multiplies (R - I)_ij for j < 3
    /// and t_i for j = 3.
    pub columns: Vec<f32>,
}

/// The twelve numbers of a movement about a centre: rows of R - I, each followed by its t.
pub fn coefficients(movement: &RigidMovement, centre: &Vector) -> [f64; COLUMNS_PER_SEGMENT] {
    let rotation = movement.rotation();
    let translation = movement.displacement(centre);
    std::array::from_fn(|k| match (k / 4, k % 4) {
        (i, 3) => translation[i],
        (i, j) => rotation[(i, j)] - f64::from(u8::from(i == j)),
    })
}

impl Response {
    /// The displacement of each skin node in mm, for one movement of each segment.
    pub fn apply(&self, movements: &[RigidMovement]) -> Vec<Vector> {
        self.apply_all(&Amounts { movements, inner: &[] })
    }

    /// The same with what acts inside.
    pub fn apply_all(&self, amounts: &Amounts) -> Vec<Vector> {
        apply(&self.segments, amounts, &self.columns, self.nodes.len())
    }
}
