//! VTK XML poly data: surfaces.

use super::array::Decoder;
use super::cells::decode_named;
use super::document::{Document, Section};
use super::vtu::{at_array, read_ends, read_nodes, read_points_and_marks};
use super::writer::{Numbers, VtkFile};
use crate::format::error::FormatError;
use crate::format::limits::ReadLimits;
use crate::format::output::{SurfaceOutput, WriteError};
use crate::format::parsed::Parsed;
use crate::mesh::ValuesOf;

pub(in crate::format) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let document = Document::parse("VTP", bytes)?;
    limits.check_nodes(document.points)?;
    limits.check_triangles(document.cells)?;
    let mut decoder = Decoder::new(&document, bytes.len(), limits);
    let mut parsed = Parsed::default();
    read_points_and_marks(&document, &mut decoder, &mut parsed)?;
    let points = document.points;
    decode_named(&mut decoder, Section::PointData, points, &mut parsed.arrays)?;
    for array in document.arrays_in(Section::CellData) {
        decoder.pass_over(array)?;
        parsed.arrays.ignore_of_surface(ValuesOf::Cells, &array.name);
    }
    note_other_cells(&document, &mut decoder, &mut parsed)?;
    if document.cells > 0 {
        read_polygons(&document, &mut decoder, &mut parsed, limits)?;
    }
    parsed.note_trailing(decoder.trailing_bytes(), "the end of the document");
    Ok(parsed)
}

fn read_polygons<'a>(
    document: &Document<'a>,
    decoder: &mut Decoder<'_, 'a>,
    parsed: &mut Parsed,
    limits: &ReadLimits,
) -> Result<(), FormatError> {
    let ends = read_ends(document, decoder, Section::Polys, document.cells)?;
    let nodes = read_nodes(document, decoder, Section::Polys)?;
    let mut start = 0;
    for (polygon, &end) in ends.iter().enumerate() {
        let Some(corners) = nodes.get(start as usize..end as usize) else {
            let array = document.array(Section::Polys, "offsets")?;
            let detail = format!("polygon {polygon} does not lie within the connectivity");
            return Err(at_array(document, array, &detail));
        };
        parsed.push_polygon(corners, limits)?;
        start = end;
    }
    Ok(())
}

/// Vertices, lines and strips have no place in a surface; they are counted by their offsets.
fn note_other_cells<'a>(
    document: &Document<'a>,
    decoder: &mut Decoder<'_, 'a>,
    parsed: &mut Parsed,
) -> Result<(), FormatError> {
    for (section, what) in [
        (Section::Verts, "points"),
        (Section::Lines, "lines"),
        (Section::Strips, "triangle strips"),
    ] {
        for array in document.arrays_in(section) {
            if array.name == "offsets" {
                let offsets = decoder.all_integers(array, None, |offset| offset)?;
                parsed.note_skipped(offsets.len() as u64, what);
            } else {
                decoder.pass_over(array)?;
            }
        }
    }
    Ok(())
}

/// A surface with its arrays; `node_id` is written where the surface knows its nodes.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let surface = output.surface;
    let mut file = VtkFile::new("PolyData");
    file.field_strings(output.frame, &output.field_data);
    file.open(&format!(
        "Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\"",
        surface.points.len(),
        surface.triangles.len()
    ));
    file.section("Points", |file| {
        file.array("Points", 3, Numbers::Vectors(&surface.points));
    });
    file.section("Polys", |file| {
        let nodes = surface.triangles.as_flattened();
        let ends: Vec<u32> = (1..=surface.triangles.len() as u32).map(|n| n * 3).collect();
        file.array("connectivity", 1, Numbers::Nodes(nodes));
        file.array("offsets", 1, Numbers::Nodes(&ends));
    });
    file.section("PointData", |file| {
        if let Some(node_ids) = &surface.node_ids {
            file.array("node_id", 1, Numbers::Nodes(node_ids));
        }
        file.named_values(&output.point_arrays);
        if let Some(colours) = output.colours {
            file.array("colour_rgb", 3, Numbers::Bytes(colours.as_flattened()));
        }
    });
    file.close("Piece");
    Ok(file.finish())
}
