//! Check of parsed files: the one conversion, after any reader, to a valid mesh.

use rayon::prelude::*;

use super::arrays::{Arrays, SurfaceArrays, checked_name, insert, is_finite};
use super::error::{FormatError, Offenders};
use super::limits::ReadLimits;
use super::surface_cleaning::clean;
use super::{Mesh, MeshFormat, ReadMesh};
use crate::mesh::check::referenced;
use crate::mesh::duplicate_cells::{cells_of_two_shapes, duplicate_cells};
use crate::mesh::orientation::CellJacobian;
use crate::mesh::{
    CellShape, Cells, Frame, TriangleSurface, ValuesOf, Vector, VolumeMesh, Warning,
};

/// Products of three coordinates must stay far from overflow; a micrometre file of a scanner with
/// a far origin reaches 1e10.
const LARGEST_COORDINATE: f64 = 1e15;

/// Content of a parsed file. With any cell it is a volume mesh, otherwise a surface.
#[derive(Default)]
pub(super) struct Parsed {
    pub points: Vec<Vector>,
    pub cells: Cells,
    pub triangles: Vec<[u32; 3]>,
    /// Polygons with more than three corners that became triangles.
    pub polygons_cut: u64,
    pub arrays: Arrays,
    pub node_sets: Vec<(String, Vec<u32>)>,
    pub cell_sets: Vec<(String, Vec<u32>)>,
    pub frame: Option<Frame>,
    pub warnings: Vec<Warning>,
}

impl Parsed {
    /// Adds a polygon as triangles that share its first corner.
    pub fn push_polygon(
        &mut self,
        corners: &[u32],
        limits: &ReadLimits,
    ) -> Result<(), FormatError> {
        limits.check_corners(corners.len() as u64)?;
        let [first, others @ ..] = corners else {
            return Ok(());
        };
        for pair in others.windows(2) {
            self.triangles.push([*first, pair[0], pair[1]]);
        }
        self.polygons_cut += u64::from(corners.len() > 3);
        limits.check_triangles(self.triangles.len() as u64)
    }

    /// Remembers the frame that a header line, a comment or a field names as `SPACE=…`.
    pub fn note_space_mark(&mut self, text: &str) {
        let upper = text.to_ascii_uppercase();
        let Some(at) = upper.find("SPACE=") else {
            return;
        };
        let value = &upper[at + "SPACE=".len()..];
        let length =
            value.find(|character: char| !character.is_ascii_alphanumeric()).unwrap_or(value.len());
        self.frame = self.frame.or(Frame::from_name(&value[..length]));
    }

    /// Says that parts of the file were left out, if there were any.
    pub fn note_skipped(&mut self, count: u64, what: &str) {
        if count > 0 {
            let detail = format!("{count} {what} were skipped");
            let warning = Warning::new("cells-skipped", detail).with("count", count as f64);
            self.warnings.push(warning);
        }
    }

    /// Says that bytes follow the last one that the file declares, if any do.
    pub fn note_trailing(&mut self, bytes: u64, last: &str) {
        if bytes > 0 {
            let warning = Warning::new("trailing-bytes", format!("{bytes} bytes follow {last}"));
            self.warnings.push(warning.with("bytes", bytes as f64));
        }
    }

    /// Checks the whole and sorts it into a mesh.
    pub fn into_mesh(
        mut self,
        format: MeshFormat,
        limits: &ReadLimits,
    ) -> Result<ReadMesh, FormatError> {
        limits.check_nodes(self.points.len() as u64)?;
        limits.check_cells(self.cells.len() as u64)?;
        limits.check_triangles(self.triangles.len() as u64)?;
        if self.cells.is_empty() && self.triangles.is_empty() {
            return Err(self.empty());
        }
        self.check_coordinates()?;
        self.check_indices()?;
        self.warn_of_cut_polygons();
        let mut of_points = SurfaceArrays::default();
        let mesh = if self.cells.is_empty() {
            Mesh::Surface(self.take_surface(&mut of_points)?)
        } else {
            Mesh::Volume(self.take_volume(limits)?)
        };
        let ignored = match &mesh {
            Mesh::Volume(volume) => volume.ignored.clone(),
            Mesh::Surface(_) | Mesh::Image(_) => self.arrays.take_ignored(limits),
        };
        let (frame, warnings) = (self.frame, self.warnings);
        Ok(ReadMesh { format, mesh, frame, ignored, of_points, warnings })
    }

    fn empty(&self) -> FormatError {
        let skipped: Vec<&str> = self.warnings.iter().map(|w| w.detail.as_str()).collect();
        let mut detail = format!("{} points, no cells and no triangles", self.points.len());
        if !skipped.is_empty() {
            detail = format!("{detail}; {}", skipped.join(", "));
        }
        FormatError::Empty { detail }
    }

    fn check_coordinates(&mut self) -> Result<(), FormatError> {
        let mut nonfinite = Offenders::default();
        let mut largest = 0.0_f64;
        for (node, point) in self.points.iter().enumerate() {
            if !is_finite(*point) {
                nonfinite.add(node);
            }
            largest = largest.max(point.amax());
        }
        if nonfinite.count > 0 {
            return Err(FormatError::NonFinite { count: nonfinite.count, first: nonfinite.first });
        }
        if largest > LARGEST_COORDINATE {
            return Err(FormatError::Far { coordinate: largest, limit: LARGEST_COORDINATE });
        }
        Ok(())
    }

    fn check_indices(&self) -> Result<(), FormatError> {
        let nodes = self.points.len() as u64;
        let is_wrong = |corners: &[u32]| corners.iter().any(|&corner| u64::from(corner) >= nodes);
        let mut wrong = Offenders::default();
        if self.cells.is_empty() {
            for (triangle, corners) in self.triangles.iter().enumerate() {
                if is_wrong(corners) {
                    wrong.add(triangle);
                }
            }
        } else {
            for (cell, (_, corners)) in self.cells.iter().enumerate() {
                if is_wrong(corners) {
                    wrong.add(cell);
                }
            }
        }
        if wrong.count > 0 {
            return Err(FormatError::IndexOutOfRange {
                count: wrong.count,
                first: wrong.first,
                nodes,
            });
        }
        Ok(())
    }

    fn warn_of_cut_polygons(&mut self) {
        if self.polygons_cut > 0 && self.cells.is_empty() {
            let detail = format!("{} polygons were cut into triangles", self.polygons_cut);
            let warning = Warning::new("polygons-triangulated", detail);
            self.warnings.push(warning.with("count", self.polygons_cut as f64));
        }
    }

    fn take_surface(
        &mut self,
        of_points: &mut SurfaceArrays,
    ) -> Result<TriangleSurface, FormatError> {
        let mut surface = TriangleSurface {
            points: std::mem::take(&mut self.points),
            triangles: std::mem::take(&mut self.triangles),
            node_ids: None,
        };
        *of_points = self.arrays.move_to_surface(&mut surface);
        for (name, _) in self.node_sets.drain(..) {
            self.arrays.ignore_of_surface(ValuesOf::Points, &name);
        }
        for (name, _) in self.cell_sets.drain(..) {
            self.arrays.ignore_of_surface(ValuesOf::Cells, &name);
        }
        clean(&mut surface, &mut self.warnings)?;
        self.warn_of_unreferenced(surface.points.len(), surface.triangles.iter().flatten());
        Ok(surface)
    }

    fn take_volume(&mut self, limits: &ReadLimits) -> Result<VolumeMesh, FormatError> {
        let mut mesh = VolumeMesh {
            nodes: std::mem::take(&mut self.points),
            cells: std::mem::take(&mut self.cells),
            ..VolumeMesh::default()
        };
        for (name, nodes) in self.node_sets.drain(..) {
            insert(&mut mesh.node_sets, checked_name(&name, limits)?, nodes)?;
        }
        for (name, cells) in self.cell_sets.drain(..) {
            insert(&mut mesh.cell_sets, checked_name(&name, limits)?, cells)?;
        }
        let Parsed { arrays, warnings, .. } = self;
        arrays.move_to_volume(&mut mesh, warnings, limits)?;
        mesh.ignored = arrays.take_ignored(limits);
        for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
            orient(&mut mesh, shape, warnings)?;
        }
        warnings.extend(duplicate_cells(&mesh));
        warnings.extend(cells_of_two_shapes(&mesh));
        let referenced = mesh.cells.iter().flat_map(|(_, nodes)| nodes);
        self.warn_of_unreferenced(mesh.nodes.len(), referenced);
        Ok(mesh)
    }

    fn warn_of_unreferenced<'a>(&mut self, nodes: usize, named: impl Iterator<Item = &'a u32>) {
        let count = referenced(nodes, named).iter().filter(|named| !**named).count();
        if count > 0 {
            let detail =
                format!("{count} nodes belong to no cell or triangle; they stay where they are");
            let warning = Warning::new("unreferenced-nodes", detail);
            self.warnings.push(warning.with("count", count as f64));
        }
    }
}

/// Makes all cells of one shape right-handed when all are left-handed, and refuses a mixture.
fn orient(
    mesh: &mut VolumeMesh,
    shape: CellShape,
    warnings: &mut Vec<Warning>,
) -> Result<(), FormatError> {
    let of_shape = (0..mesh.cells.len()).into_par_iter();
    let of_shape = of_shape.filter(|&cell| mesh.cells.shape(cell) == shape);
    let jacobians: Vec<(usize, CellJacobian)> =
        of_shape.map(|cell| (cell, mesh.cell_jacobian(cell))).collect();
    let count = |is: fn(&CellJacobian) -> bool| {
        jacobians.iter().filter(|(_, jacobian)| is(jacobian)).count() as u64
    };
    let all = jacobians.len() as u64;
    let reversed = count(CellJacobian::is_reversed);
    let flat = count(|jacobian| jacobian.gauss_min == 0.0 && jacobian.gauss_max == 0.0);
    let dented = count(|jacobian| {
        let is_usable = jacobian.is_valid() || jacobian.is_reversed();
        is_usable && jacobian.corner_min <= 0.0 && jacobian.corner_max >= 0.0
    });
    let mut invalid = Offenders::default();
    for (cell, _) in jacobians.iter().filter(|(_, jacobian)| !jacobian.is_valid()) {
        invalid.add(*cell);
    }
    if all > 0 && flat == all {
        return Err(FormatError::Degenerate { what: "cells", count: all });
    }
    if all > 0 && reversed == all {
        reverse_all(mesh, shape);
        // The documentation of VTK and its quality filters disagree about wedges, and meshio
        // follows the former, so that neither order of their nodes is a mistake.
        if shape != CellShape::Wedge6 {
            let detail =
                format!("all {all} {} cells were inverted and are reordered", shape.name());
            warnings.push(Warning::new("cells-reordered", detail).with("count", all as f64));
        }
    } else if invalid.count > 0 && is_repairable(shape, (invalid.count, reversed), all) {
        let detail = format!(
            "{} of {all} {} cells are inverted or flat at a Gauss point: a case takes this mesh with `repair` only",
            invalid.count,
            shape.name()
        );
        warnings.push(Warning::new("repair-needed", detail).with("count", invalid.count as f64));
    } else if invalid.count > 0 {
        return Err(FormatError::InvertedElements {
            shape: shape.name(),
            count: invalid.count,
            of: all,
            first: invalid.first,
        });
    }
    if dented > 0 {
        let detail = format!(
            "{dented} {} cells have a corner with a Jacobian of zero or less; they are valid at their Gauss points",
            shape.name()
        );
        warnings.push(Warning::new("dented-cells", detail).with("count", dented as f64));
    }
    Ok(())
}

/// Whether a repair may mend cells of a shape that no stiffness can be formed of: few, and none that is only numbered the other way
/// round.
fn is_repairable(shape: CellShape, (invalid, reversed): (u64, u64), all: u64) -> bool {
    let has_corners_to_spare = match shape {
        CellShape::Hex8 | CellShape::Wedge6 => true,
        CellShape::Tet4 => false,
    };
    has_corners_to_spare && reversed == 0 && 10 * invalid <= all
}

fn reverse_all(mesh: &mut VolumeMesh, shape: CellShape) {
    for cell in 0..mesh.cells.len() {
        if mesh.cells.shape(cell) == shape {
            mesh.reverse_cell(cell);
        }
    }
}
