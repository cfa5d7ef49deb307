//! The report of an uploaded mesh or image.

use std::collections::BTreeMap;

use crate::schema::mesh::{IgnoredArrayDocument, ImageReport, MeshKind, MeshReport};
use crate::schema::{CornerPair, Triple, WarningDocument};
use mechanics::format::{Mesh, ReadMesh};
use mechanics::image::{ImageVolume, LabelMap, Voxels, scan_report};
use mechanics::mesh::check::several_components;
use mechanics::mesh::conformity::cells_do_not_match;
use mechanics::mesh::connectivity::Faces;
use mechanics::mesh::quality::quality;
use mechanics::mesh::{Frame, IgnoredArray, VolumeMesh, Warning};

/// An image that is smaller, in mm along any axis, shows no head.
const HEAD_MM: f64 = 80.0;
/// One with fewer voxels along any axis does not either.
const HEAD_VOXELS: usize = 16;
/// Segmentation programs make no more regions.
const MOST_REGIONS: usize = 500;

/// Content of a mesh file, in the units of the file.
pub fn mesh_report(read: &ReadMesh) -> MeshReport {
    let mut warnings: Vec<Warning> = read.warnings.clone();
    let (kind, (low, high), nodes, triangles) = match &read.mesh {
        Mesh::Volume(volume) => {
            let faces = Faces::new(volume);
            let boundary = volume.boundary_of(&faces);
            warnings.extend(several_components(volume, &faces));
            warnings.extend(cells_do_not_match(volume, &boundary));
            let triangles = boundary.iter().map(|face| face.nodes().len() - 2).sum();
            (MeshKind::Volume, volume.bounds().into(), volume.nodes.len(), triangles)
        }
        Mesh::Surface(surface) => {
            let (points, triangles) = (surface.points.len(), surface.triangles.len());
            (MeshKind::Surface, surface.bounds(), points, triangles)
        }
        Mesh::Image(image) => (MeshKind::Image, image.bounds(), 0, 0),
    };
    let mut report = MeshReport {
        kind,
        nodes: nodes as u64,
        cells: BTreeMap::new(),
        triangles: triangles as u64,
        bounding_box: CornerPair([low.x, low.y, low.z, high.x, high.y, high.z]),
        diagonal: (high - low).norm(),
        space: read.frame.map(Into::into),
        node_sets: BTreeMap::new(),
        cell_sets: BTreeMap::new(),
        node_labels: BTreeMap::new(),
        cell_labels: BTreeMap::new(),
        node_vectors: Vec::new(),
        cell_vectors: Vec::new(),
        ignored_arrays: read.ignored.names(),
        ignored_because: read.ignored.listed.iter().map(ignored).collect(),
        min_quality: None,
        image: None,
        warnings: warnings.iter().map(WarningDocument::from).collect(),
        meshing: Vec::new(),
    };
    match &read.mesh {
        Mesh::Volume(volume) => describe(volume, &mut report),
        Mesh::Image(image) => {
            report.image = Some(image_report(image));
            report.warnings.extend(findings(image, read.frame.unwrap_or_default()));
        }
        Mesh::Surface(_) => {}
    }
    report
}

fn ignored(array: &IgnoredArray) -> IgnoredArrayDocument {
    IgnoredArrayDocument {
        name: array.name.clone(),
        of: array.of.name().to_owned(),
        why: array.why.clone(),
    }
}

fn image_report(image: &ImageVolume) -> ImageReport {
    let (lowest_hu, highest_hu) = image.range();
    let kept_as = match image.voxels() {
        Voxels::I16(_) => "int16",
        Voxels::F32(_) => "float32",
    };
    ImageReport {
        size: image.size().iter().map(|&size| size as u64).collect(),
        spacing_mm: Triple(image.spacing()),
        origin_mm: image.placement().origin.into(),
        directions: image.directions().map(Triple::from).to_vec(),
        lowest_hu,
        highest_hu,
        kept_as: kept_as.to_owned(),
    }
}

/// What a technician should know of a scan; nothing of an image that is none of a head.
fn findings(image: &ImageVolume, frame: Frame) -> Vec<WarningDocument> {
    let (size, spacing) = (image.size(), image.spacing());
    let is_head = (0..3)
        .all(|axis| size[axis] >= HEAD_VOXELS && size[axis] as f64 * spacing[axis] >= HEAD_MM);
    if !is_head || is_label_map(image) {
        return Vec::new();
    }
    scan_report(image, frame).findings.iter().map(WarningDocument::from).collect()
}

/// Few whole numbers from 0: regions, and no measurement.
fn is_label_map(image: &ImageVolume) -> bool {
    image.range().0 >= 0.0
        && LabelMap::of(image).is_ok_and(|map| map.regions().len() <= MOST_REGIONS)
}

fn describe(volume: &VolumeMesh, report: &mut MeshReport) {
    let mut cells: BTreeMap<&str, u64> = BTreeMap::new();
    for (shape, _) in volume.cells.iter() {
        *cells.entry(shape.name()).or_default() += 1;
    }
    report.cells = cells.into_iter().map(|(shape, count)| (shape.to_owned(), count)).collect();
    report.node_sets = sizes(&volume.node_sets);
    report.cell_sets = sizes(&volume.cell_sets);
    report.node_labels = values(&volume.node_labels);
    report.cell_labels = values(&volume.cell_labels);
    report.min_quality = Some(quality(volume).smallest_scaled_jacobian);
    report.node_vectors = volume.node_vectors.keys().cloned().collect();
    report.cell_vectors = volume.cell_vectors.keys().cloned().collect();
}

fn sizes(sets: &BTreeMap<String, Vec<u32>>) -> BTreeMap<String, u64> {
    sets.iter().map(|(name, members)| (name.clone(), members.len() as u64)).collect()
}

/// The distinct values of each array, ascending.
fn values(arrays: &BTreeMap<String, Vec<i64>>) -> BTreeMap<String, Vec<i64>> {
    let distinct = |labels: &Vec<i64>| {
        let mut values = labels.clone();
        // Neighbours are often alike, which leaves little to sort.
        values.dedup();
        values.sort_unstable();
        values.dedup();
        values
    };
    arrays.iter().map(|(name, labels)| (name.clone(), distinct(labels))).collect()
}
