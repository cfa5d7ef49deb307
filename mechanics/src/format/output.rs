//! Input of the writers, and why they may refuse it.

use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};

use super::arrays::is_finite;

/// One value for each point or cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArrayValues<'a> {
    Reals(&'a [f64]),
    Vectors(&'a [Vector]),
    /// Symmetric tensors: xx, yy, zz, xy, yz, xz, the order of VTK.
    Tensors(&'a [[f64; 6]]),
    Integers(&'a [i64]),
}

impl ArrayValues<'_> {
    pub fn len(&self) -> usize {
        match self {
            ArrayValues::Reals(values) => values.len(),
            ArrayValues::Vectors(values) => values.len(),
            ArrayValues::Tensors(values) => values.len(),
            ArrayValues::Integers(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn components(&self) -> usize {
        match self {
            ArrayValues::Vectors(_) => 3,
            ArrayValues::Tensors(_) => 6,
            ArrayValues::Reals(_) | ArrayValues::Integers(_) => 1,
        }
    }

    fn nonfinite(&self) -> usize {
        match self {
            ArrayValues::Reals(values) => values.iter().filter(|v| !v.is_finite()).count(),
            ArrayValues::Vectors(values) => values.iter().filter(|v| !is_finite(**v)).count(),
            ArrayValues::Tensors(values) => {
                values.iter().filter(|tensor| tensor.iter().any(|v| !v.is_finite())).count()
            }
            ArrayValues::Integers(_) => 0,
        }
    }
}

/// What the components of a symmetric tensor are called, in their order.
pub(super) const TENSOR_COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];

/// An array with its name; the unit belongs into the name, as in `displacement_mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedValues<'a> {
    pub name: &'a str,
    pub values: ArrayValues<'a>,
}

/// The values that colours stand for; values beyond the ends have the colour of the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale<'a> {
    /// The name of an array of the points.
    pub array: &'a str,
    /// In the unit of the array.
    pub low: f64,
    pub high: f64,
}

/// A surface to write, points in mm.
#[derive(Clone, Debug)]
pub struct SurfaceOutput<'a> {
    pub surface: &'a TriangleSurface,
    pub frame: Frame,
    /// One value for each point, beside the `node_id` of the surface itself.
    pub point_arrays: Vec<NamedValues<'a>>,
    /// One sRGB colour for each point.
    pub colours: Option<&'a [[u8; 3]]>,
    /// What the colours stand for.
    pub colour_scale: Option<ColourScale<'a>>,
    /// Texts beside the frame, by name.
    pub field_data: Vec<(String, String)>,
}

/// A volume mesh to write. Arrays here replace arrays of the mesh that have the same name.
#[derive(Clone, Debug)]
pub struct VolumeOutput<'a> {
    pub mesh: &'a VolumeMesh,
    /// Where the nodes are written, in mm: those of the mesh, or displaced ones.
    pub positions: &'a [Vector],
    pub frame: Frame,
    pub point_arrays: Vec<NamedValues<'a>>,
    pub cell_arrays: Vec<NamedValues<'a>>,
    /// Texts beside the frame, by name.
    pub field_data: Vec<(String, String)>,
}

/// Why nothing was written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WriteError {
    #[error("{count} values of {array:?} are not finite")]
    NonFinite { array: String, count: usize },
    #[error("{array:?} has {have} values for {wanted} points or cells")]
    Length { array: String, have: usize, wanted: usize },
    #[error("the surface has no triangles")]
    Empty,
    #[error("two arrays are called {array:?}")]
    Duplicate { array: String },
}

impl SurfaceOutput<'_> {
    /// The surface alone, without arrays or colours.
    pub fn plain(surface: &TriangleSurface, frame: Frame) -> SurfaceOutput<'_> {
        SurfaceOutput {
            surface,
            frame,
            point_arrays: Vec::new(),
            colours: None,
            colour_scale: None,
            field_data: Vec::new(),
        }
    }

    pub(super) fn check(&self) -> Result<(), WriteError> {
        let points = self.surface.points.len();
        if self.surface.triangles.is_empty() {
            return Err(WriteError::Empty);
        }
        check_array("points", ArrayValues::Vectors(&self.surface.points), points)?;
        if let Some(node_ids) = &self.surface.node_ids {
            check_length("node_id", node_ids.len(), points)?;
        }
        if let Some(colours) = self.colours {
            check_length("colours", colours.len(), points)?;
        }
        let own = self.surface.node_ids.iter().map(|_| "node_id");
        check_names(own.chain(self.point_arrays.iter().map(|array| array.name)))?;
        let mut arrays = self.point_arrays.iter();
        arrays.try_for_each(|array| check_array(array.name, array.values, points))
    }
}

impl VolumeOutput<'_> {
    /// The mesh as it is, with all its sets and labels: reading gives it back.
    pub fn plain(mesh: &VolumeMesh, frame: Frame) -> VolumeOutput<'_> {
        VolumeOutput {
            mesh,
            positions: &mesh.nodes,
            frame,
            point_arrays: Vec::new(),
            cell_arrays: Vec::new(),
            field_data: Vec::new(),
        }
    }

    pub(super) fn check(&self) -> Result<(), WriteError> {
        let (nodes, cells) = (self.mesh.nodes.len(), self.mesh.cells.len());
        check_array("points", ArrayValues::Vectors(self.positions), nodes)?;
        check_names(self.point_arrays.iter().map(|array| array.name))?;
        check_names(self.cell_arrays.iter().map(|array| array.name))?;
        for array in &self.point_arrays {
            check_array(array.name, array.values, nodes)?;
        }
        for array in &self.cell_arrays {
            check_array(array.name, array.values, cells)?;
        }
        for (name, vectors) in &self.mesh.node_vectors {
            check_array(name, ArrayValues::Vectors(vectors), nodes)?;
        }
        for (name, vectors) in &self.mesh.cell_vectors {
            check_array(name, ArrayValues::Vectors(vectors), cells)?;
        }
        for (name, labels) in &self.mesh.node_labels {
            check_length(name, labels.len(), nodes)?;
        }
        for (name, labels) in &self.mesh.cell_labels {
            check_length(name, labels.len(), cells)?;
        }
        Ok(())
    }
}

fn check_length(array: &str, have: usize, wanted: usize) -> Result<(), WriteError> {
    if have == wanted {
        return Ok(());
    }
    Err(WriteError::Length { array: array.into(), have, wanted })
}

fn check_array(array: &str, values: ArrayValues, wanted: usize) -> Result<(), WriteError> {
    check_length(array, values.len(), wanted)?;
    match values.nonfinite() {
        0 => Ok(()),
        count => Err(WriteError::NonFinite { array: array.into(), count }),
    }
}

fn check_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), WriteError> {
    let mut seen = std::collections::BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(WriteError::Duplicate { array: name.into() });
        }
    }
    Ok(())
}
