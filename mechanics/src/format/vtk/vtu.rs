//! VTK XML unstructured grids: volume meshes, or surfaces where all cells are flat.

use super::array::Decoder;
use super::cells::{CellTable, as_vectors, decode_named};
use super::document::{DataArray, Document, Section};
use super::writer::{Numbers, VtkFile};
use crate::format::error::FormatError;
use crate::format::ignored_field;
use crate::format::limits::ReadLimits;
use crate::format::output::{VolumeOutput, WriteError};
use crate::format::parsed::Parsed;
use crate::format::scalar::{Scalar, node_number};
use crate::mesh::CellShape;

pub(in crate::format) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let document = Document::parse("VTU", bytes)?;
    limits.check_nodes(document.points)?;
    limits.check_elements(document.cells)?;
    let mut decoder = Decoder::new(&document, bytes.len(), limits);
    let mut parsed = Parsed::default();
    read_points_and_marks(&document, &mut decoder, &mut parsed)?;
    let (points, cells) = (document.points, document.cells);
    decode_named(&mut decoder, Section::PointData, points, &mut parsed.arrays)?;
    decode_named(&mut decoder, Section::CellData, cells, &mut parsed.arrays)?;
    if cells == 0 {
        return Ok(parsed);
    }
    let types = document.array(Section::Cells, "types")?;
    let table = CellTable {
        types: decoder.integers(types, cells, node_number)?,
        ends: read_ends(&document, &mut decoder, Section::Cells, cells)?,
        nodes: read_nodes(&document, &mut decoder, Section::Cells)?,
    };
    table.move_to(&mut parsed, limits, |detail| at_array(&document, types, &detail))?;
    parsed.note_trailing(decoder.trailing_bytes(), "the end of the document");
    Ok(parsed)
}

/// Points and the `SPACE` field, which both kinds of VTK XML files have alike.
pub(super) fn read_points_and_marks<'a>(
    document: &Document<'a>,
    decoder: &mut Decoder<'_, 'a>,
    parsed: &mut Parsed,
) -> Result<(), FormatError> {
    if let Some(points) = document.arrays_in(Section::Points).next() {
        parsed.points = as_vectors(&decoder.reals(points, document.points * 3)?);
    } else if document.points > 0 {
        document.array(Section::Points, "Points")?;
    }
    for array in document.arrays_in(Section::FieldData) {
        if array.name == "SPACE" && array.scalar.is_none() {
            let text = decoder.text(array)?;
            parsed.note_space_mark(&format!("SPACE={text}"));
            parsed.note_space_mark(&text);
        } else if array.name == ignored_field::FIELD && array.scalar == Some(Scalar::U8) {
            ignored_field::decode(&decoder.text(array)?, &mut parsed.arrays.ignored);
        } else {
            parsed.note_space_mark(&array.name);
            decoder.pass_over(array)?;
        }
    }
    Ok(())
}

pub(super) fn read_ends<'a>(
    document: &Document<'a>,
    decoder: &mut Decoder<'_, 'a>,
    section: Section,
    cells: u64,
) -> Result<Vec<u32>, FormatError> {
    let offsets = document.array(section, "offsets")?;
    decoder.integers(offsets, cells, node_number)
}

pub(super) fn read_nodes<'a>(
    document: &Document<'a>,
    decoder: &mut Decoder<'_, 'a>,
    section: Section,
) -> Result<Vec<u32>, FormatError> {
    let connectivity = document.array(section, "connectivity")?;
    decoder.all_integers(connectivity, None, node_number)
}

pub(super) fn at_array(
    document: &Document<'_>,
    array: &DataArray<'_>,
    detail: &str,
) -> FormatError {
    FormatError::Parse {
        format: document.format,
        place: crate::format::error::FilePosition::Offset(array.offset),
        detail: detail.to_string(),
    }
}

/// A volume mesh with everything that [`crate::format::read`] understands, so that reading gives it back.
///
/// Wedges are written with a positive Jacobian. VTK's quality filters agree with that and the
/// documentation of its wedge does not; meshio follows the documentation and swaps nodes as it reads.
pub fn write(output: &VolumeOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let mesh = output.mesh;
    let mut file = VtkFile::new("UnstructuredGrid");
    file.field_bytes(output.frame, &field_data(output));
    file.open(&format!(
        "Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"",
        mesh.nodes.len(),
        mesh.cells.len()
    ));
    file.section("Points", |file| {
        file.array("Points", 3, Numbers::Vectors(output.positions));
    });
    file.section("Cells", |file| write_cells(file, output));
    file.section("PointData", |file| write_point_data(file, output));
    file.section("CellData", |file| write_cell_data(file, output));
    file.close("Piece");
    Ok(file.finish())
}

/// The texts of the caller, and what the file of the mesh had that the mesh has not.
fn field_data(output: &VolumeOutput) -> Vec<(String, String)> {
    let ignored = ignored_field::encode(&output.mesh.ignored);
    let ignored = (!ignored.is_empty()).then(|| (ignored_field::FIELD.to_owned(), ignored));
    output.field_data.iter().cloned().chain(ignored).collect()
}

fn write_cells(file: &mut VtkFile, output: &VolumeOutput) {
    let (mut nodes, mut ends, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for (shape, cell) in output.mesh.cells.iter() {
        nodes.extend_from_slice(cell);
        ends.push(nodes.len() as u32);
        types.push(match shape {
            CellShape::Tet4 => 10_u8,
            CellShape::Hex8 => 12,
            CellShape::Wedge6 => 13,
        });
    }
    file.array("connectivity", 1, Numbers::Nodes(&nodes));
    file.array("offsets", 1, Numbers::Nodes(&ends));
    file.array("types", 1, Numbers::Bytes(&types));
}

fn write_point_data(file: &mut VtkFile, output: &VolumeOutput) {
    let mesh = output.mesh;
    file.named_values(&output.point_arrays);
    let is_taken = |name: &str| output.point_arrays.iter().any(|array| array.name == name);
    for (name, set) in &mesh.node_sets {
        file.set(&format!("set_{name}"), set, mesh.nodes.len());
    }
    for (name, labels) in mesh.node_labels.iter().filter(|(name, _)| !is_taken(name)) {
        file.array(name, 1, Numbers::Integers(labels));
    }
    for (name, vectors) in mesh.node_vectors.iter().filter(|(name, _)| !is_taken(name)) {
        file.array(name, 3, Numbers::Vectors(vectors));
    }
}

fn write_cell_data(file: &mut VtkFile, output: &VolumeOutput) {
    let mesh = output.mesh;
    file.named_values(&output.cell_arrays);
    let is_taken = |name: &str| output.cell_arrays.iter().any(|array| array.name == name);
    for (name, set) in &mesh.cell_sets {
        file.set(&format!("elset_{name}"), set, mesh.cells.len());
    }
    for (name, labels) in mesh.cell_labels.iter().filter(|(name, _)| !is_taken(name)) {
        file.array(name, 1, Numbers::Integers(labels));
    }
    for (name, vectors) in mesh.cell_vectors.iter().filter(|(name, _)| !is_taken(name)) {
        file.array(name, 3, Numbers::Vectors(vectors));
    }
}
