//! Cell tables of VTK, shared by the XML and the legacy readers.
//!
//! Source: VTK File Formats, docs.vtk.org, figure "Linear cell types found in VTK".

use super::array::Decoder;
use super::document::Section;
use crate::format::arrays::{self, Arrays, NamedArray, Values};
use crate::format::error::FormatError;
use crate::format::limits::ReadLimits;
use crate::format::parsed::Parsed;
use crate::format::scalar::Scalar;
use crate::mesh::{CellShape, ValuesOf, Vector};

/// Meaning of a VTK cell type.
enum Kind {
    Solid(CellShape),
    Polygon,
    /// Points and lines, which no mesh here consists of.
    Thin,
    Unsupported,
}

impl Kind {
    fn of(vtk_type: u32) -> Kind {
        match vtk_type {
            1..=4 => Kind::Thin,
            5 | 7 | 9 => Kind::Polygon,
            10 => Kind::Solid(CellShape::Tet4),
            12 => Kind::Solid(CellShape::Hex8),
            13 => Kind::Solid(CellShape::Wedge6),
            _ => Kind::Unsupported,
        }
    }
}

fn type_name(vtk_type: u32) -> String {
    let name = match vtk_type {
        0 => "empty cell",
        6 => "triangle strip",
        8 => "pixel",
        11 => "voxel",
        14 => "pyramid",
        21 => "quadratic edge",
        22 => "quadratic triangle",
        23 => "quadratic quad",
        24 => "quadratic tetrahedron",
        25 => "quadratic hexahedron",
        26 => "quadratic wedge",
        27 => "quadratic pyramid",
        28 => "biquadratic quad",
        29 => "triquadratic hexahedron",
        34 => "biquadratic triangle",
        42 => "polyhedron",
        _ => return format!("VTK cell type {vtk_type}"),
    };
    format!("{name} (VTK cell type {vtk_type})")
}

/// Cells by type, with their nodes one after the other.
pub(super) struct CellTable {
    pub types: Vec<u32>,
    /// Where the nodes of each cell end.
    pub ends: Vec<u32>,
    pub nodes: Vec<u32>,
}

/// Why a table makes no sense; the reader adds the place.
pub(super) type TableError = String;

impl CellTable {
    /// The nodes of a cell, or why there are none.
    fn cell(&self, cell: usize) -> Result<&[u32], TableError> {
        let start = if cell == 0 { 0 } else { self.ends[cell - 1] };
        let range = start as usize..self.ends[cell] as usize;
        let have = self.nodes.len();
        self.nodes
            .get(range)
            .ok_or_else(|| format!("cell {cell} does not lie within the {have} nodes listed"))
    }

    /// Puts the cells into the mesh: the solid ones, or the polygons where there are no others.
    /// Cell arrays keep the values of the cells that stay.
    pub fn move_to(
        self,
        parsed: &mut Parsed,
        limits: &ReadLimits,
        bad: impl Fn(TableError) -> FormatError,
    ) -> Result<(), FormatError> {
        self.check_types()?;
        let is_solid = |vtk_type: &u32| matches!(Kind::of(*vtk_type), Kind::Solid(_));
        let has_solids = self.types.iter().any(is_solid);
        let mut kept = Vec::new();
        for (cell, &vtk_type) in self.types.iter().enumerate() {
            let nodes = self.cell(cell).map_err(&bad)?;
            match Kind::of(vtk_type) {
                Kind::Solid(shape) if nodes.len() == shape.node_count() => {
                    parsed.cells.push(shape, nodes);
                    kept.push(cell);
                }
                Kind::Solid(shape) => {
                    let (name, have) = (shape.name(), nodes.len());
                    return Err(bad(format!("cell {cell} is a {name} with {have} nodes")));
                }
                Kind::Polygon if !has_solids => {
                    parsed.push_polygon(nodes, limits)?;
                    kept.push(cell);
                }
                _ => {}
            }
        }
        limits.check_cells(parsed.cells.len() as u64)?;
        let skipped = (self.types.len() - kept.len()) as u64;
        let what = match has_solids {
            true => "cells of lower dimension beside the volume cells",
            false => "points and lines",
        };
        parsed.note_skipped(skipped, what);
        if skipped > 0 {
            keep_values(&mut parsed.arrays.cells, &kept);
        }
        Ok(())
    }

    fn check_types(&self) -> Result<(), FormatError> {
        let mut unsupported = std::collections::BTreeSet::new();
        for &vtk_type in &self.types {
            if matches!(Kind::of(vtk_type), Kind::Unsupported) && unsupported.len() < 20 {
                unsupported.insert(vtk_type);
            }
        }
        if unsupported.is_empty() {
            return Ok(());
        }
        Err(FormatError::UnsupportedCells {
            types: unsupported.into_iter().map(type_name).collect(),
        })
    }
}

/// Where cells of old legacy files end: they list `[count, node, node, …]` for each.
pub(super) fn split_counted_lists(
    numbers: &[u32],
    cells: u64,
) -> Result<(Vec<u32>, Vec<u32>), TableError> {
    let mut ends = Vec::with_capacity(cells.min(numbers.len() as u64) as usize);
    let mut nodes = Vec::with_capacity(numbers.len());
    let mut rest = numbers;
    while let Some((&count, after)) = rest.split_first() {
        let Some((cell, after)) = after.split_at_checked(count as usize) else {
            let (cell, have) = (ends.len(), after.len());
            return Err(format!("cell {cell} has {count} nodes, {have} numbers are left"));
        };
        nodes.extend_from_slice(cell);
        ends.push(nodes.len() as u32);
        rest = after;
    }
    if ends.len() as u64 != cells {
        return Err(format!("{cells} cells declared, {} found", ends.len()));
    }
    Ok((ends, nodes))
}

fn keep_values(arrays: &mut [NamedArray], kept: &[usize]) {
    for array in arrays {
        match &mut array.values {
            Values::Integers(values) => *values = chosen(values, kept),
            Values::Vectors(values) => *values = chosen(values, kept),
        }
    }
}

fn chosen<T: Copy>(values: &[T], kept: &[usize]) -> Vec<T> {
    kept.iter().filter_map(|&cell| values.get(cell).copied()).collect()
}

/// Decodes the arrays of a section that a mesh may want, one tuple for each of `count` elements.
pub(super) fn decode_named(
    decoder: &mut Decoder<'_, '_>,
    section: Section,
    count: u64,
    arrays: &mut Arrays,
) -> Result<(), FormatError> {
    let document = decoder.document();
    let of = match section {
        Section::PointData => ValuesOf::Points,
        _ => ValuesOf::Cells,
    };
    for array in document.arrays_in(section) {
        let is_integer = array.scalar.is_some_and(Scalar::is_integer);
        if !arrays.wants(of, &array.name, arrays::Kind::of(array.scalar, array.components)) {
            decoder.pass_over(array)?;
            continue;
        }
        let values = match is_integer {
            true => Values::Integers(decoder.integers(array, count, |v| v)?),
            false => Values::Vectors(as_vectors(&decoder.reals(array, count * 3)?)),
        };
        let named = NamedArray { name: array.name.clone(), values };
        match of {
            ValuesOf::Points => arrays.points.push(named),
            ValuesOf::Cells => arrays.cells.push(named),
        }
    }
    Ok(())
}

/// Triples of numbers as vectors.
pub(super) fn as_vectors(values: &[f64]) -> Vec<Vector> {
    values.chunks_exact(3).map(Vector::from_column_slice).collect()
}
