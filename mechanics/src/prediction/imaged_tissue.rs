//! Tissue of the cells of a mesh from an image.

/// Image values on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct ImagedTissue {
    /// For each cell the mean of its sample points; `None` where one of them lies outside.
    pub mean: Vec<Option<f64>>,
    /// For each cell the tissue with the largest part in it, by its number; `None` where it is that of its region.
    pub tissue_of_cell: Vec<Option<u16>>,
    /// By name, in the order of the case.
    pub tissues: Vec<(String, TissueShare)>,
    /// What keeps the material of its region.
    pub region: TissueShare,
    /// Cells that reach beyond the image.
    pub outside: usize,
}

/// How much of a mesh a tissue is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TissueShare {
    /// Cells that are of it, be it in part.
    pub cells: usize,
    /// Of the volume of the mesh.
    pub volume_share: f64,
}
