//! The moved tissue and the moved bones as files.

use super::muscles::CellMuscles;
use super::skin::ContactArrays;
use super::stress::{StressArrays, strain_measure};
use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{
    ArrayValues, NamedValues, SurfaceOutput, VolumeInLps, VolumeOutput, WriteError,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::prediction::{Case, ImagedTissue, Prediction, Scene};

/// `segment` of a point of a fixed bone.
const NO_SEGMENT: i64 = -1;

/// `hounsfield_mean` of a cell that extends beyond the image.
const NO_IMAGE: f64 = -32768.0;

/// `volume.vtu`: predicted positions, and the deformation of each cell. In LPS if the case is in RAS: 3D Slicer reads a
/// frame from a string array only, which meshio refuses, and assumes LPS without one.
pub fn encode_volume(
    scene: &Scene,
    prediction: &Prediction,
    frame: Frame,
    field_data: &[(String, String)],
) -> Result<Vec<u8>, WriteError> {
    let written = VolumeInLps::new(&scene.mesh, frame);
    let (mesh, frame) = (&*written.mesh, written.frame);
    let displacement = turned(&written, &prediction.displacement);
    let positions: Vec<Vector> =
        mesh.nodes.iter().zip(&displacement).map(|(node, moved)| node + moved).collect();
    let magnitude: Vec<f64> = displacement.iter().map(Vector::norm).collect();
    let node_id: Vec<i64> = (0..mesh.nodes.len() as i64).collect();
    let region: Vec<i64> = scene.region_of_cell.iter().map(|&region| i64::from(region)).collect();
    let det_f: Vec<f64> = prediction.deformation.iter().map(|cell| cell.det_f).collect();
    let strain: Vec<Vector> =
        prediction.deformation.iter().map(|cell| Vector::from(cell.principal_strain())).collect();
    let imaged = scene.imaged.as_ref().map(|imaged| ImagedArrays::new(scene, imaged));
    let named = |name, values| NamedValues { name, values };
    let mut field_data = field_data.to_vec();
    field_data.push(("region_names".to_owned(), scene.regions.join("\n")));
    let mut cell_arrays = vec![
        named("region", ArrayValues::Integers(&region)),
        named("det_f", ArrayValues::Reals(&det_f)),
        named("principal_strain", ArrayValues::Vectors(&strain)),
    ];
    if let Some(imaged) = &imaged {
        field_data.push(("tissue_names".to_owned(), imaged.names.join("\n")));
        cell_arrays.extend(imaged.arrays());
    }
    let muscles = CellMuscles::of(scene);
    if let Some(muscles) = &muscles {
        field_data.push(("muscle_names".to_owned(), muscles.names.join("\n")));
        cell_arrays.extend(muscles.arrays());
    }
    let mut point_arrays = vec![
        named("displacement_mm", ArrayValues::Vectors(&displacement)),
        named("displacement_magnitude_mm", ArrayValues::Reals(&magnitude)),
        named("node_id", ArrayValues::Integers(&node_id)),
    ];
    let stress = StressArrays::new(scene, prediction, &written);
    if let Some(stress) = &stress {
        field_data
            .push(("strain_measure".to_owned(), strain_measure(prediction).name().to_owned()));
        cell_arrays.extend(stress.of_cells());
        point_arrays.extend(stress.of_nodes());
    }
    let error = prediction.numerical_error.as_ref().ok();
    let missing = error.map(|error| turned(&written, &error.missing));
    let error =
        missing.as_ref().map(|missing| missing.iter().map(Vector::norm).collect::<Vec<f64>>());
    if let (Some(missing), Some(error)) = (&missing, &error) {
        point_arrays.push(named("numerical_error_mm", ArrayValues::Reals(error)));
        point_arrays.push(named("missing_mm", ArrayValues::Vectors(missing)));
    }
    let contact = ContactArrays::new(prediction, 0..mesh.nodes.len() as u32);
    point_arrays.extend(contact.iter().flat_map(ContactArrays::arrays));
    vtu::write(&VolumeOutput {
        mesh,
        positions: &positions,
        frame,
        point_arrays,
        cell_arrays,
        field_data,
    })
}

/// Vectors in the written frame.
fn turned(written: &VolumeInLps, vectors: &[Vector]) -> Vec<Vector> {
    vectors.iter().map(|vector| written.turned(vector)).collect()
}

/// Image data of each cell: its mean, -32768 if the cell extends beyond the image; the number of
/// its tissue in `tissue_names`, -1 if it keeps the material of its region; and the resulting stiffness.
struct ImagedArrays {
    names: Vec<String>,
    mean: Vec<f64>,
    tissue: Vec<i64>,
    young_modulus: Vec<f64>,
}

impl ImagedArrays {
    fn new(scene: &Scene, imaged: &ImagedTissue) -> Self {
        let material = |&material: &u16| scene.materials[material as usize].young_modulus();
        ImagedArrays {
            names: imaged.tissues.iter().map(|(name, _)| name.clone()).collect(),
            mean: imaged.mean.iter().map(|mean| mean.unwrap_or(NO_IMAGE)).collect(),
            tissue: imaged.tissue_of_cell.iter().map(|t| t.map_or(-1, i64::from)).collect(),
            young_modulus: scene.material_of_cell.iter().map(material).collect(),
        }
    }

    fn arrays(&self) -> [NamedValues<'_>; 3] {
        let named = |name, values| NamedValues { name, values };
        [
            named("hounsfield_mean", ArrayValues::Reals(&self.mean)),
            named("tissue", ArrayValues::Integers(&self.tissue)),
            named("young_modulus_kpa", ArrayValues::Reals(&self.young_modulus)),
        ]
    }
}

/// `bones.vtp`: every bone of the case as moved by its segment. `segment` counts the segments named in
/// the field data; it is -1 on bones that stay.
pub fn encode_bones(
    case: &Case,
    scene: &Scene,
    gaps: Option<&[f64]>,
    field_data: &[(String, String)],
) -> Result<Vec<u8>, WriteError> {
    let mut moved = TriangleSurface::default();
    let mut displacement = Vec::new();
    let mut segment = Vec::new();
    for bone in &case.bones {
        let Some(surface) = case.surfaces.get(&bone.surface) else {
            continue;
        };
        let number = scene.segment(&bone.name);
        let first = moved.points.len() as u32;
        for point in &surface.points {
            let by = number.map_or_else(Vector::zeros, |number| {
                scene.segments[number].movement.displacement(point)
            });
            moved.points.push(point + by);
            displacement.push(by);
            segment.push(number.map_or(NO_SEGMENT, |number| number as i64));
        }
        let triangles = surface.triangles.iter();
        moved.triangles.extend(triangles.map(|triangle| triangle.map(|point| point + first)));
    }
    let names: Vec<&str> = scene.segments.iter().map(|segment| segment.name.as_str()).collect();
    let mut output = SurfaceOutput::plain(&moved, case.frame);
    output.field_data = field_data.to_vec();
    output.field_data.push(("segment_names".to_owned(), names.join("\n")));
    output.point_arrays = vec![
        NamedValues { name: "displacement_mm", values: ArrayValues::Vectors(&displacement) },
        NamedValues { name: "segment", values: ArrayValues::Integers(&segment) },
    ];
    let gaps = gaps.map(ArrayValues::Reals);
    output.point_arrays.extend(gaps.map(|values| NamedValues { name: "gap_mm", values }));
    vtp::write(&output)
}
