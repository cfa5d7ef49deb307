//! Lattice of control points over a box around the tissue, and the positions of the tissue in it.
//!
//! S(u, v, w) = sum_mnp C_mnp N_m(u) N_n(v) N_p(w)   (Ulusoy et al. 2010, eq. 1)
//!
//! u, v, w are lengths in mm along the axes of the box: the principal axes of the tissue's volume, so that
//! a turned scene has the turned box. At rest C_mnp are the Greville points, for which S(x) = x; what is
//! solved for are the displacements of control points, u(x) = sum_j N_j(x) d_j. Control points none of
//! whose functions reaches tissue are left out, which changes no displacement of tissue.

use nalgebra::Matrix3;

use super::basis::{Basis, Local};
use super::tissue_points::TissuePoint;
use crate::mesh::{EMPTY_BOUNDS, Vector, VolumeMesh, bounds_of};
use crate::solver::element_connectivity::ElementConnectivity;

/// The spacing chosen is this many mean edges of the mesh at least: the points at which tissue is
/// integrated then fill every span.
const FINEST_IN_EDGES: f64 = 1.5;

/// The spacing chosen leaves at most this many control points, which a factorisation takes seconds for.
const CHOSEN_POINTS: usize = 4000;

/// Two second moments of the volume closer than this share of the largest tell no axes apart.
const SAME_MOMENT: f64 = 1e-6;

/// A frame with an origin.
#[derive(Clone, Debug)]
pub struct Frame {
    pub origin: Vector,
    /// One axis a column.
    pub axes: Matrix3<f64>,
}

/// Where a point lies: its span by the number among those with tissue, and the functions along each axis.
#[derive(Clone, Copy, Debug)]
pub struct LatticeCoordinates {
    pub span: usize,
    pub values: [Local; 3],
    pub gradients: [Local; 3],
}

/// How many control points there are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ControlPoints {
    /// The finest of at least 1.5 mean edges of the mesh that leaves at most 4000 of them.
    #[default]
    Chosen,
    /// So many mm apart, as nearly as whole spans allow.
    Spaced(f64),
    /// So many along each principal axis, the longest first; one more than the degree at least.
    Counted([usize; 3]),
}

/// Control points and the spans of the lattice that hold tissue.
pub struct Lattice {
    pub frame: Frame,
    pub bases: [Basis; 3],
    /// The key of each span with tissue, ascending.
    spans: Vec<u64>,
    /// The control points of each span, first axis fastest.
    pub connectivity: ElementConnectivity,
    /// Control points at rest, in the frame.
    pub points: Vec<Vector>,
    /// For each the numbers along the axes.
    pub indices: Vec<[u32; 3]>,
}

impl Frame {
    /// The principal axes of the volume that the points stand for, about its centre.
    pub fn principal(points: &[TissuePoint]) -> Frame {
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        let sum = points.iter().fold(Vector::zeros(), |sum, p| sum + p.position * p.volume);
        let origin = sum / volume;
        let moments = points.iter().fold(Matrix3::zeros(), |sum: Matrix3<f64>, point| {
            let arm = point.position - origin;
            sum + arm * arm.transpose() * point.volume
        });
        Frame { origin, axes: unique_axes(&moments) }
    }

    /// The coordinates of a point along the axes.
    pub fn local(&self, point: &Vector) -> Vector {
        self.axes.transpose() * (point - self.origin)
    }
}

/// Eigenvectors, those of the largest moment first and right-handed. Where moments coincide, the axes
/// among them are those nearest to the axes of the coordinates.
fn unique_axes(moments: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = moments.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let value = |k: usize| eigen.eigenvalues[order[k]];
    let axis = |k: usize| eigen.eigenvectors.column(order[k]).into_owned();
    let same = |k: usize| value(k) - value(k + 1) < SAME_MOMENT * value(0);
    // The coordinate axis nearest to a plane, laid into it.
    let nearest = |normal: &Vector| {
        let unit = normal.iamin();
        let along = Vector::from_fn(|i, _| if i == unit { 1.0 } else { 0.0 });
        (along - normal * normal.dot(&along)).normalize()
    };
    let (first, third) = match (same(0), same(1)) {
        (true, true) => return Matrix3::identity(),
        (true, false) => (nearest(&axis(2)), axis(2)),
        (false, true) => {
            let second = nearest(&axis(0));
            (axis(0), axis(0).cross(&second))
        }
        (false, false) => (axis(0), axis(2)),
    };
    Matrix3::from_columns(&[first, third.cross(&first), third])
}

impl Lattice {
    /// Functions of a degree along each principal axis, the longest first, over the box around the tissue.
    pub fn fit(
        mesh: &VolumeMesh,
        points: &[TissuePoint],
        degrees: [usize; 3],
        control: ControlPoints,
    ) -> Lattice {
        let frame = Frame::principal(points);
        let of_cells = mesh.cells.iter().flat_map(|(_, nodes)| nodes);
        let of_cells = of_cells.map(|&node| frame.local(&mesh.nodes[node as usize]));
        let [low, high] = bounds_of(of_cells).unwrap_or(EMPTY_BOUNDS);
        let basis = |axis: usize, spans: usize| {
            Basis::clamped(degrees[axis], spans, [low[axis], high[axis]])
        };
        let bases = |spacing: f64| {
            let spans = |axis: usize| ((high[axis] - low[axis]) / spacing).round().max(1.0);
            [0, 1, 2].map(|axis| basis(axis, spans(axis) as usize))
        };
        let seen: Vec<Vector> = (mesh.cells.iter().flat_map(|(_, nodes)| nodes))
            .map(|&node| mesh.nodes[node as usize])
            .chain(points.iter().map(|point| point.position))
            .map(|point| frame.local(&point))
            .collect();
        match control {
            ControlPoints::Spaced(spacing) => return Lattice::over(frame, bases(spacing), &seen),
            ControlPoints::Counted(counts) => {
                let spans = |axis: usize| counts[axis].saturating_sub(degrees[axis]).max(1);
                let bases = [0, 1, 2].map(|axis| basis(axis, spans(axis)));
                return Lattice::over(frame, bases, &seen);
            }
            ControlPoints::Chosen => {}
        }
        let mut spacing = FINEST_IN_EDGES * mean_edge(mesh);
        loop {
            let lattice = Lattice::over(frame.clone(), bases(spacing), &seen);
            let count = lattice.points.len();
            if count <= CHOSEN_POINTS {
                return lattice;
            }
            // Points go with the second to third power of the spacing: layers are thin.
            spacing *= (count as f64 / CHOSEN_POINTS as f64).powf(0.4).max(1.02);
        }
    }

    fn over(frame: Frame, bases: [Basis; 3], seen: &[Vector]) -> Lattice {
        let mut spans: Vec<u64> = seen.iter().map(|local| span_key(&bases, local)).collect();
        spans.sort_unstable();
        spans.dedup();
        let mut keys: Vec<u64> =
            spans.iter().flat_map(|&span| control_keys(&bases, span)).collect();
        keys.sort_unstable();
        keys.dedup();
        let mut connectivity = ElementConnectivity::default();
        for &span in &spans {
            let number = |key| keys.partition_point(|other| *other < key) as u32;
            connectivity.push(control_keys(&bases, span).map(number));
        }
        let greville = [0, 1, 2].map(|axis: usize| bases[axis].greville());
        let indices: Vec<[u32; 3]> = keys.iter().map(|&key| unpacked(key)).collect();
        let at = |index: &[u32; 3]| Vector::from_fn(|k, _| greville[k][index[k] as usize]);
        Lattice {
            points: indices.iter().map(at).collect(),
            frame,
            bases,
            spans,
            connectivity,
            indices,
        }
    }

    /// Where a point with these coordinates in the frame lies; `None` where no tissue is.
    pub fn place(&self, local: &Vector) -> Option<LatticeCoordinates> {
        let key = span_key(&self.bases, local);
        let span = self.spans.binary_search(&key).ok()?;
        let along = unpacked(key);
        let each = |function: fn(&Basis, usize, f64) -> Local| {
            [0, 1, 2].map(|k: usize| function(&self.bases[k], along[k] as usize, local[k]))
        };
        Some(LatticeCoordinates {
            span,
            values: each(Basis::values),
            gradients: each(Basis::gradients),
        })
    }

    /// The numbers along the axes of a span with tissue.
    pub fn span(&self, span: usize) -> [u32; 3] {
        unpacked(self.spans[span])
    }

    /// Functions of a span along each axis.
    pub fn orders(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis: usize| self.bases[axis].degree() + 1)
    }

    /// Functions of a span.
    pub fn members(&self) -> usize {
        self.orders().iter().product()
    }

    /// Displacement at a place from those of control points, along the axes of the frame.
    pub fn displacement(&self, place: &LatticeCoordinates, of_control: &[Vector]) -> Vector {
        let members = self.connectivity.row(place.span).iter();
        let values = place.products(self.orders());
        members.zip(values).fold(Vector::zeros(), |sum, (&control, value)| {
            sum + of_control[control as usize] * value
        })
    }

    /// Pairs of neighbouring control points, the lower number first.
    pub fn links(&self) -> Vec<[u32; 2]> {
        let keys: Vec<u64> = self.indices.iter().map(|&index| packed(index)).collect();
        let mut links = Vec::with_capacity(3 * keys.len());
        for (number, index) in self.indices.iter().enumerate() {
            for axis in 0..3 {
                let mut next = *index;
                next[axis] += 1;
                if let Ok(other) = keys.binary_search(&packed(next)) {
                    links.push([number as u32, other as u32]);
                }
            }
        }
        links
    }
}

impl LatticeCoordinates {
    /// N_m(u) N_n(v) N_p(w), first axis fastest.
    pub fn products(&self, [a, b, c]: [usize; 3]) -> impl Iterator<Item = f64> + '_ {
        let [u, v, w] = &self.values;
        let lines = w[..c].iter().flat_map(move |z| v[..b].iter().map(move |y| y * z));
        lines.flat_map(move |line| u[..a].iter().map(move |x| x * line))
    }

    /// Gradients of the products along the axes of the frame.
    pub fn gradients(&self, [m, n, p]: [usize; 3]) -> impl Iterator<Item = Vector> + '_ {
        let ([u, v, w], [du, dv, dw]) = (&self.values, &self.gradients);
        (0..m * n * p).map(move |at| {
            let (a, b, c) = (at % m, at / m % n, at / m / n);
            Vector::new(du[a] * v[b] * w[c], u[a] * dv[b] * w[c], u[a] * v[b] * dw[c])
        })
    }
}

/// Bits of a key that each axis has.
const BITS: u32 = 21;

fn packed([a, b, c]: [u32; 3]) -> u64 {
    (u64::from(c) << (2 * BITS)) | (u64::from(b) << BITS) | u64::from(a)
}

fn unpacked(key: u64) -> [u32; 3] {
    [0, BITS, 2 * BITS].map(|shift| (key >> shift) as u32 & ((1 << BITS) - 1))
}

fn span_key(bases: &[Basis; 3], local: &Vector) -> u64 {
    packed([0, 1, 2].map(|axis: usize| bases[axis].span(local[axis]) as u32))
}

fn control_keys(bases: &[Basis; 3], span: u64) -> impl Iterator<Item = u64> {
    let [m, n, p] = [0, 1, 2].map(|axis: usize| bases[axis].degree() as u32 + 1);
    let [a, b, c] = unpacked(span);
    (0..m * n * p).map(move |at| packed([a + at % m, b + at / m % n, c + at / m / n]))
}

fn mean_edge(mesh: &VolumeMesh) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (shape, nodes) in mesh.cells.iter() {
        for [a, b] in shape.edges() {
            let [a, b] = [nodes[*a], nodes[*b]].map(|node| mesh.nodes[node as usize]);
            sum += (a - b).norm();
            count += 1.0;
        }
    }
    sum / count
}
