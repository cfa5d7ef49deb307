//! Binary glTF for viewers: metres, +Y up, with the way back to the frame of the case.
//!
//! LPS          (x, y, z) mm -> (x, z, −y) / 1000 m      up = superior, towards the viewer = anterior
//! RAS          (x, y, z) mm -> (−x, z, y) / 1000 m      the same directions
//! unspecified  as LPS
//!
//! Vertices stand in the order of the surface's points, and so do the values of its arrays: an array `name_mm` of
//! numbers or vectors is the attribute `_NAME_MM`, in mm and in the frame of the case.
//!
//! Source: glTF 2.0 specification, Khronos Group, sections 3.4 (units and axes), 3.7.2 (meshes; attributes of an
//! application begin with a low line) and 4.4 (GLB).

use serde_json::{Map, Value, json};

use super::output::{ArrayValues, NamedValues, SurfaceOutput, WriteError};
use crate::mesh::{Frame, Vector};

const MILLIMETRES_PER_METRE: f64 = 1000.0;

/// Bytes of an index and of an f32.
const NUMBER_BYTES: usize = 4;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Rows of the matrix from the frame of the case to the axes of glTF, without the scale.
fn axes(frame: Frame) -> [[f64; 3]; 3] {
    match frame {
        Frame::Lps | Frame::Unspecified => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        Frame::Ras => [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    }
}

/// Row-major, from metres in glTF axes to mm in the frame of the case.
fn back_to_case(frame: Frame) -> [f64; 16] {
    let axes = axes(frame);
    let mut matrix = [0.0; 16];
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        // The inverse of a rotation is its transpose; adding zero turns -0 into 0.
        matrix[row * 4 + column] = axes[column][row] * MILLIMETRES_PER_METRE + 0.0;
    }
    matrix[15] = 1.0;
    matrix
}

fn turned(vector: Vector, frame: Frame) -> [f64; 3] {
    axes(frame).map(|row| Vector::from(row).dot(&vector))
}

/// A block of the binary chunk: so many f32 for each vertex.
struct Attribute {
    name: String,
    kind: &'static str,
    values: Vec<f32>,
}

impl Attribute {
    fn vectors(name: &str, values: impl Iterator<Item = [f32; 3]>) -> Self {
        Attribute { name: name.to_owned(), kind: "VEC3", values: values.flatten().collect() }
    }

    /// An array of the points; integers and tensors have no place in glTF.
    fn of_array(array: &NamedValues) -> Option<Self> {
        let name = attribute_name(array.name);
        match array.values {
            ArrayValues::Reals(values) => {
                let values = values.iter().map(|&value| value as f32).collect();
                Some(Attribute { name, kind: "SCALAR", values })
            }
            ArrayValues::Vectors(values) => {
                let values = values.iter().map(|v| [v.x as f32, v.y as f32, v.z as f32]);
                Some(Attribute::vectors(&name, values))
            }
            ArrayValues::Tensors(_) | ArrayValues::Integers(_) => None,
        }
    }
}

/// How glTF calls an array of ours.
fn attribute_name(array: &str) -> String {
    let upper = array.to_ascii_uppercase();
    format!("_{}", upper.replace(|c: char| !c.is_ascii_alphanumeric(), "_"))
}

/// A surface with normals and its arrays, and with colours where the caller gives them.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let attributes = attributes(output);
    let corners = output.surface.triangles.as_flattened();
    let mut binary: Vec<u8> = corners.iter().flat_map(|corner| corner.to_le_bytes()).collect();
    for attribute in &attributes {
        binary.extend(attribute.values.iter().flat_map(|value| value.to_le_bytes()));
    }
    let scene = document(output, &attributes);
    Ok(container(&scene.to_string(), binary))
}

/// Positions first.
fn attributes(output: &SurfaceOutput) -> Vec<Attribute> {
    let surface = output.surface;
    let in_metres =
        |point: &Vector| turned(*point, output.frame).map(|c| (c / MILLIMETRES_PER_METRE) as f32);
    let unit = |normal: Vector| {
        // glTF asks for unit normals, also where the triangles of a point cancel.
        let normal = normal.try_normalize(0.5).unwrap_or_else(Vector::z);
        turned(normal, output.frame).map(|c| c as f32)
    };
    let mut attributes = vec![
        Attribute::vectors("POSITION", surface.points.iter().map(in_metres)),
        Attribute::vectors("NORMAL", surface.point_normals().into_iter().map(unit)),
    ];
    attributes.extend(output.colours.map(|colours| {
        Attribute::vectors("COLOR_0", colours.iter().map(|colour| colour.map(linear)))
    }));
    attributes.extend(output.point_arrays.iter().filter_map(Attribute::of_array));
    attributes
}

/// glTF stores linear colours. Source: IEC 61966-2-1.
fn linear(srgb: u8) -> f32 {
    let value = f32::from(srgb) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn document(output: &SurfaceOutput, attributes: &[Attribute]) -> Value {
    let points = output.surface.points.len();
    let indices = output.surface.triangles.len() * 3;
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR"}),
    ];
    let mut length = indices * NUMBER_BYTES;
    let mut views = vec![view(0, length, ELEMENT_ARRAY_BUFFER)];
    let mut named = Map::new();
    for attribute in attributes {
        let accessor = accessors.len();
        let bytes = attribute.values.len() * NUMBER_BYTES;
        views.push(view(length, bytes, ARRAY_BUFFER));
        length += bytes;
        accessors.push(json!({"bufferView": accessor, "componentType": FLOAT, "count": points, "type": attribute.kind}));
        named.insert(attribute.name.clone(), json!(accessor));
    }
    let [low, high] = bounds(&attributes[0].values);
    accessors[1]["min"] = json!(low);
    accessors[1]["max"] = json!(high);
    let extras = extras(output);
    json!({
        "asset": {"version": "2.0", "generator": "facies"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "skin", "extras": &extras}],
        "meshes": [{"primitives": [{"attributes": named, "indices": 0, "material": 0}]}],
        "materials": [{
            "doubleSided": true,
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8},
        }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": length}],
        "extras": extras,
    })
}

fn view(offset: usize, length: usize, target: u32) -> Value {
    json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "target": target})
}

/// The lowest and the highest of each coordinate.
fn bounds(positions: &[f32]) -> [[f32; 3]; 2] {
    let (positions, _) = positions.as_chunks::<3>();
    let empty = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    positions.iter().fold(empty, |[low, high], position| {
        let axes = [0, 1, 2];
        [
            axes.map(|axis| low[axis].min(position[axis])),
            axes.map(|axis| high[axis].max(position[axis])),
        ]
    })
}

/// The way back to the case, and the texts of the caller. They stand at the node too, because
/// viewers keep those and drop the ones of the file.
fn extras(output: &SurfaceOutput) -> Value {
    let mut extras = json!({
        "frame": output.frame.name(),
        "units": "mm",
        "matrix4x4_to_case_row_major": back_to_case(output.frame),
    });
    if let Some(scale) = &output.colour_scale {
        extras["colours"] = json!({
            "array": scale.array,
            "attribute": attribute_name(scale.array),
            "range": [scale.low, scale.high],
        });
    }
    for (name, text) in &output.field_data {
        extras[name] = json!(text);
    }
    extras
}

/// Twelve bytes of header and two chunks, each padded to four bytes.
fn container(document: &str, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = document.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + binary.len();
    let mut bytes = Vec::with_capacity(length);
    bytes.extend(b"glTF");
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_superior_and_anterior_faces_the_viewer_in_both_frames() {
        let superior = Vector::z();
        assert_eq!(turned(superior, Frame::Lps), [0.0, 1.0, 0.0]);
        assert_eq!(turned(superior, Frame::Ras), [0.0, 1.0, 0.0]);
        assert_eq!(turned(-Vector::y(), Frame::Lps), [0.0, 0.0, 1.0]);
        assert_eq!(turned(Vector::y(), Frame::Ras), [0.0, 0.0, 1.0]);
        // The left of the patient is +x in LPS and -x in RAS.
        assert_eq!(turned(Vector::x(), Frame::Lps), turned(-Vector::x(), Frame::Ras));
    }

    #[test]
    fn the_matrix_leads_back_to_the_case() {
        let point = Vector::new(1.0, 2.0, 3.0);
        for frame in [Frame::Lps, Frame::Ras, Frame::Unspecified] {
            let metres = Vector::from(turned(point, frame)) / MILLIMETRES_PER_METRE;
            let matrix = nalgebra::Matrix4::from_row_slice(&back_to_case(frame));
            let back = matrix.transform_point(&metres.into()).coords;
            // Rounding of one division and one product.
            assert!((back - point).norm() < 1e-15 * 1e2, "{frame}: {back}");
        }
    }
}
