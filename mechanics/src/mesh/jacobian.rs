//! Validity of a cell: a Jacobian that is positive everywhere inside it, and not only at its corners.
//!
//! x(r) maps the unit cell (cube, triangle times line, tetrahedron) to the cell, J = det ∂x/∂r.
//! For a hexahedron J is quadratic in each coordinate: 27 Bézier coefficients. Their minimum bounds J
//! from below and the eight at the corners are values of J. Halving the cell makes the bounds meet
//! as the square of the size; a coefficient <= 0 alone proves nothing.
//! For a wedge J is linear over the triangle and quadratic along the axis, so its minimum is that of
//! three parabolas, in closed form. For a tetrahedron J is constant, six volumes.
//!
//! Source: Johnen, Weill, Remacle, Robust and efficient validation of the linear hexahedral element,
//! Procedia Engineering 203 (2017) 271-283, section 3.

use super::{CellShape, Vector, VolumeMesh};

/// Halvings after which a cell is left undecided: its side is then a thousandth.
const MAX_HALVINGS: usize = 10;

/// Pieces that are kept at a time; a cell whose Jacobian is about zero on a whole surface reaches it.
const MAX_PIECES: usize = 4096;

type Coefficients = [f64; 27];

/// One for a tetrahedron, 9 for a wedge, 27 for a hexahedron.
pub type BezierCoefficients = arrayvec::ArrayVec<f64, 27>;

/// The smallest Jacobian of a cell in mm³ lies between `lower` and `upper`, and `upper` is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JacobianBounds {
    pub lower: f64,
    pub upper: f64,
    /// How many times the cell was halved to know.
    pub halvings: usize,
}

impl JacobianBounds {
    fn exactly(value: f64) -> Self {
        JacobianBounds { lower: value, upper: value, halvings: 0 }
    }

    /// The cell is the image of the unit cell without a fold.
    pub fn is_valid(&self) -> bool {
        self.lower > 0.0
    }

    /// The cell is folded or flat somewhere.
    pub fn is_inverted(&self) -> bool {
        self.upper <= 0.0
    }
}

/// Bounds just close enough to know the sign of the smallest Jacobian.
pub fn jacobian_sign(shape: CellShape, corners: &[Vector]) -> JacobianBounds {
    bounds(shape, corners, |bounds| bounds.is_valid() || bounds.is_inverted())
}

/// The smallest Jacobian inside a cell, to a millionth of the largest coefficient.
pub fn smallest_jacobian(shape: CellShape, corners: &[Vector]) -> JacobianBounds {
    let scale = match shape {
        CellShape::Hex8 => largest(&hexahedron_coefficients(corners)),
        CellShape::Wedge6 | CellShape::Tet4 => 0.0,
    };
    bounds(shape, corners, |bounds| bounds.upper - bounds.lower <= 1e-6 * scale)
}

impl VolumeMesh {
    /// The volume of a cell in mm³, negative where it is inverted as a whole.
    pub fn cell_volume(&self, cell: usize) -> f64 {
        let corners: Vec<Vector> = self.corners(cell).collect();
        signed_volume(self.cells.shape(cell), &corners)
    }
}

/// Volume of a cell in mm³, negative where it is inverted as a whole: the integral of J.
pub fn signed_volume(shape: CellShape, corners: &[Vector]) -> f64 {
    match shape {
        CellShape::Tet4 => tetrahedron_jacobian(corners) / 6.0,
        // The integral of a polynomial over the unit cell is the mean of its Bézier coefficients
        // times the volume of the unit cell.
        CellShape::Wedge6 => wedge_parabolas(corners).iter().flatten().sum::<f64>() / 18.0,
        CellShape::Hex8 => hexahedron_coefficients(corners).iter().sum::<f64>() / 27.0,
    }
}

/// The Jacobian at each corner, in mm³, with the edges divided by their lengths: between -1 and 1
/// before `regular` scales the regular cell to 1. Zero where an edge has no length.
pub fn scaled_jacobian(shape: CellShape, corners: &[Vector]) -> f64 {
    let worst = corner_edges(shape, corners)
        .map(|[a, b, c]| {
            let lengths = a.norm() * b.norm() * c.norm();
            if lengths > 0.0 { a.cross(&b).dot(&c) / lengths } else { 0.0 }
        })
        .fold(f64::INFINITY, f64::min);
    let regular = match shape {
        CellShape::Hex8 => 1.0,
        CellShape::Wedge6 => 2.0 / 3.0_f64.sqrt(),
        CellShape::Tet4 => 2.0_f64.sqrt(),
    };
    worst * regular
}

/// Each corner of a hexahedron with the ends of the three edges from it, right-handed in a valid cell.
pub const HEXAHEDRON_CORNERS: [[usize; 4]; 8] = [
    [0, 1, 3, 4],
    [1, 2, 0, 5],
    [2, 3, 1, 6],
    [3, 0, 2, 7],
    [4, 7, 5, 0],
    [5, 4, 6, 1],
    [6, 5, 7, 2],
    [7, 6, 4, 3],
];

/// For each corner of the cell the three edges from it, right-handed in a valid cell.
fn corner_edges(
    shape: CellShape,
    corners: &[Vector],
) -> impl Iterator<Item = [Vector; 3]> + use<'_> {
    const TETRAHEDRON: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 2, 0, 3], [2, 0, 1, 3], [3, 2, 1, 0]];
    const WEDGE: [[usize; 4]; 6] =
        [[0, 1, 2, 3], [1, 2, 0, 4], [2, 0, 1, 5], [3, 5, 4, 0], [4, 3, 5, 1], [5, 4, 3, 2]];
    let table: &[[usize; 4]] = match shape {
        CellShape::Tet4 => &TETRAHEDRON,
        CellShape::Wedge6 => &WEDGE,
        CellShape::Hex8 => &HEXAHEDRON_CORNERS,
    };
    table.iter().map(|&[from, a, b, c]| [a, b, c].map(|to| corners[to] - corners[from]))
}

/// Bézier coefficients of J, in mm³: all of them positive prove a cell valid, and each is affine in the place of each
/// single corner.
pub fn bezier_coefficients(shape: CellShape, corners: &[Vector]) -> BezierCoefficients {
    let mut coefficients = BezierCoefficients::new();
    match shape {
        CellShape::Tet4 => coefficients.push(tetrahedron_jacobian(corners)),
        CellShape::Wedge6 => coefficients.extend(wedge_parabolas(corners).into_iter().flatten()),
        CellShape::Hex8 => coefficients.extend(hexahedron_coefficients(corners)),
    }
    coefficients
}

fn bounds(
    shape: CellShape,
    corners: &[Vector],
    is_enough: impl Fn(&JacobianBounds) -> bool,
) -> JacobianBounds {
    match shape {
        CellShape::Tet4 => JacobianBounds::exactly(tetrahedron_jacobian(corners)),
        CellShape::Wedge6 => JacobianBounds::exactly(
            wedge_parabolas(corners)
                .map(lowest_of_parabola)
                .into_iter()
                .fold(f64::INFINITY, f64::min),
        ),
        CellShape::Hex8 => hexahedron_bounds(hexahedron_coefficients(corners), is_enough),
    }
}

fn hexahedron_bounds(
    coefficients: Coefficients,
    is_enough: impl Fn(&JacobianBounds) -> bool,
) -> JacobianBounds {
    let mut upper = lowest_corner(&coefficients);
    let mut pieces = vec![coefficients];
    let mut halvings = 0;
    loop {
        let lower = pieces.iter().map(smallest).fold(upper, f64::min);
        let bounds = JacobianBounds { lower, upper, halvings };
        if is_enough(&bounds) || halvings == MAX_HALVINGS || pieces.len() > MAX_PIECES {
            return bounds;
        }
        let halves: Vec<Coefficients> = pieces.iter().flat_map(eighths).collect();
        upper = halves.iter().map(lowest_corner).fold(upper, f64::min);
        // A piece that lies above a value already found does not hold the minimum.
        pieces = halves.into_iter().filter(|piece| smallest(piece) < upper).collect();
        halvings += 1;
    }
}

fn tetrahedron_jacobian(corners: &[Vector]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|corner| corners[corner] - corners[0]);
    a.cross(&b).dot(&c)
}

/// For each vertical edge of a wedge the Bézier coefficients of J along it.
fn wedge_parabolas(corners: &[Vector]) -> [[f64; 3]; 3] {
    // Twice the area vector of the triangle halfway between two layers, by polarisation.
    let edges =
        [0, 3].map(|base| [corners[base + 1] - corners[base], corners[base + 2] - corners[base]]);
    let area = |low: usize, high: usize| edges[low][0].cross(&edges[high][1]);
    let areas = [area(0, 0), (area(0, 1) + area(1, 0)) * 0.5, area(1, 1)];
    [0, 1, 2].map(|vertex| areas.map(|area| area.dot(&(corners[vertex + 3] - corners[vertex]))))
}

fn lowest_of_parabola([start, middle, end]: [f64; 3]) -> f64 {
    let curvature = start - 2.0 * middle + end;
    let ends = start.min(end);
    if curvature > 0.0 && middle < ends {
        ends.min((start * end - middle * middle) / curvature)
    } else {
        ends
    }
}

/// J of a hexahedron; coefficient (a, b, c) at a + 3 b + 9 c.
fn hexahedron_coefficients(corners: &[Vector]) -> Coefficients {
    // VTK counts around the bottom and around the top; here x is fastest, then y, then z.
    const PLACE: [[usize; 2]; 2] = [[0, 1], [3, 2]];
    let node = |i: usize, j: usize, k: usize| corners[PLACE[j][i] + 4 * k];
    let along_x = |j: usize, k: usize| node(1, j, k) - node(0, j, k);
    let along_y = |i: usize, k: usize| node(i, 1, k) - node(i, 0, k);
    let along_z = |i: usize, j: usize| node(i, j, 1) - node(i, j, 0);
    let mut coefficients = [0.0; 27];
    // The product of two linear Bézier forms: the middle coefficient is shared by two products.
    let weight = |sum: usize| if sum == 1 { 0.5 } else { 1.0 };
    for bits in 0..64 {
        let [i, j, k, l, m, n] = [0, 1, 2, 3, 4, 5].map(|bit| (bits >> bit) & 1);
        let (a, b, c) = (k + m, i + n, j + l);
        let volume = along_x(i, j).cross(&along_y(k, l)).dot(&along_z(m, n));
        coefficients[a + 3 * b + 9 * c] += weight(a) * weight(b) * weight(c) * volume;
    }
    coefficients
}

/// The coefficients on the eight halves-in-every-direction, by de Casteljau's rule.
fn eighths(coefficients: &Coefficients) -> [Coefficients; 8] {
    let mut pieces = [*coefficients; 8];
    for (number, piece) in pieces.iter_mut().enumerate() {
        for (axis, step) in [1, 3, 9].into_iter().enumerate() {
            let upper_half = (number >> axis) & 1 == 1;
            halve(piece, step, upper_half);
        }
    }
    pieces
}

fn halve(piece: &mut Coefficients, step: usize, upper_half: bool) {
    let starts = (0..27_usize).filter(|place| (place / step).is_multiple_of(3));
    for start in starts {
        let [a, b, c] = [0, 1, 2].map(|i| piece[start + i * step]);
        let middle = 0.25 * a + 0.5 * b + 0.25 * c;
        let half = if upper_half { [middle, 0.5 * (b + c), c] } else { [a, 0.5 * (a + b), middle] };
        for (i, value) in half.into_iter().enumerate() {
            piece[start + i * step] = value;
        }
    }
}

fn smallest(coefficients: &Coefficients) -> f64 {
    coefficients.iter().copied().fold(f64::INFINITY, f64::min)
}

fn largest(coefficients: &Coefficients) -> f64 {
    coefficients.iter().map(|value| value.abs()).fold(0.0, f64::max)
}

fn lowest_corner(coefficients: &Coefficients) -> f64 {
    [0, 2, 6, 8, 18, 20, 24, 26]
        .map(|place| coefficients[place])
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}
