//! Why a mesh has no array of a name.

use super::VolumeMesh;
use super::ignored::ArrayUse;
use super::ignored::ValuesOf;

use super::ignored::listed;

impl VolumeMesh {
    /// What is said of an array that is asked for and not there: why it was ignored, or what there is instead.
    pub fn missing_array(&self, wanted: ArrayUse, name: &str) -> String {
        let (what, of, known) = match wanted {
            ArrayUse::PointLabels => {
                ("integer point array", ValuesOf::Points, listed(self.node_labels.keys()))
            }
            ArrayUse::CellLabels => {
                ("integer cell array", ValuesOf::Cells, listed(self.cell_labels.keys()))
            }
            ArrayUse::PointVectors => {
                ("point array of 3 components", ValuesOf::Points, listed(self.node_vectors.keys()))
            }
            ArrayUse::CellVectors => {
                ("cell array of 3 components", ValuesOf::Cells, listed(self.cell_vectors.keys()))
            }
        };
        match self.ignored.find(of, name) {
            Some(array) => array.to_string(),
            None => format!("the mesh has no {what} {name:?}; it has: {known}"),
        }
    }
}
