//! Meshes so far from the origin that files of single precision place their points coarsely.

use mechanics::mesh::{VolumeMesh, Warning};

/// Steps between the positions of such a file that count, in mm: a tenth of what discretisation leaves of good meshes.
const COARSE_MM: f64 = 0.01;

/// Binary digits of a number of single precision after the first.
const DIGITS: i32 = 23;

/// The warning of a mesh, in mm, whose farthest coordinate single precision has in steps above a hundredth of a millimetre.
pub(super) fn far_from_origin(mesh: &VolumeMesh) -> Option<Warning> {
    let farthest = mesh.bounds().iter().map(|corner| corner.amax()).fold(1.0, f64::max);
    let step = 2.0_f64.powi(farthest.log2().floor() as i32 - DIGITS);
    let detail = format!(
        "the mesh reaches {farthest:.4e} mm from the origin along an axis: `skin.stl` and `skin.glb` have positions of single precision, \
         there in steps of {step:.3} mm; other files and all statistics are exact. Move the mesh to the origin"
    );
    let warning = || Warning::new("far-from-origin", detail).with("farthest_mm", farthest);
    (step > COARSE_MM).then(|| warning().with("step_mm", step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mechanics::mesh::sample::block;
    use mechanics::mesh::{CellShape, Vector};

    #[test]
    fn a_mesh_is_far_where_neighbours_in_single_precision_are_a_hundredth_of_a_millimetre_apart() {
        let told = |shift: f64| {
            let mut mesh = block(Vector::repeat(80.0), [1, 1, 1], CellShape::Hex8);
            mesh.nodes.iter_mut().for_each(|x| x.y += shift);
            far_from_origin(&mesh).map(|warning| warning.numbers)
        };
        assert_eq!(told(0.0), None);
        assert_eq!(told(1e5), None);
        let far = told(-1e7).expect("ten kilometres");
        // The distance of the number of single precision from the next one.
        let next = f32::from_bits(1e7_f32.to_bits() + 1) - 1e7_f32;
        assert_eq!(far, [("farthest_mm", 1e7), ("step_mm", f64::from(next))]);
        assert!(told(2e5).is_some());
    }
}
