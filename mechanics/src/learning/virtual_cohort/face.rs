//! Shapes of virtual faces: the half head of the program under seven modes of shape, each of a normal amplitude.

use crate::draws::Draws;
use crate::mesh::half_head::half_head;
use crate::mesh::{Vector, VolumeMesh};

/// Layers of nodes from bone to skin.
const SHEETS: usize = 5;

/// A face with its amplitudes, in standard deviations within 2.
pub fn face(fineness: usize, draws: &mut Draws) -> VolumeMesh {
    let mut mesh = half_head(fineness).mesh;
    let thickness = 1.0 + 0.1 * draws.usual();
    thicken(&mut mesh.nodes, thickness);
    let shape = FaceModes::drawn(draws);
    mesh.nodes.iter_mut().for_each(|point| *point = shape.at(point));
    mesh
}

/// Amplitudes of six modes of shape, in standard deviations within 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceModes([f64; 6]);

/// Tissue so many times as thick, over the same bone.
fn thicken(nodes: &mut [Vector], factor: f64) {
    let sheet = nodes.len() / SHEETS;
    let (bone, rest) = nodes.split_at_mut(sheet);
    for (place, point) in rest.iter_mut().enumerate() {
        let below = bone[place % sheet];
        *point = below + (*point - below) * factor;
    }
}

impl FaceModes {
    pub fn drawn(draws: &mut Draws) -> Self {
        FaceModes(std::array::from_fn(|_| draws.usual()))
    }

    /// Where a point of the face is: width, height and depth by 3 %, the lower face by 3 mm, the chin by 2 mm, and the midline by
    /// 1.5 mm.
    pub fn at(&self, point: &Vector) -> Vector {
        let [width, height, depth, lower, chin, aside] = self.0;
        let bell =
            |value: f64, middle: f64, spread: f64| (-((value - middle) / spread).powi(2)).exp();
        let below_nose = 1.0 / (1.0 + ((point.z + 55.0) / 12.0).exp());
        let moved = Vector::new(
            1.5 * aside * bell(point.z, -65.0, 35.0),
            -2.0 * chin * bell(point.z, -78.0, 20.0) * bell(point.x, 0.0, 35.0),
            -3.0 * lower * below_nose,
        );
        let scales = Vector::new(1.0 + 0.03 * width, 1.0 + 0.03 * depth, 1.0 + 0.03 * height);
        point.component_mul(&scales) + moved
    }
}
