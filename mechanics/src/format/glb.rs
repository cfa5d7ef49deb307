//! Binary glTF for viewers: metres, +Y up, with the way back to the frame of the case.
//!
//! LPS          (x, y, z) mm -> (x, z, −y) / 1000 m      up = superior, towards the viewer = anterior
//! RAS          (x, y, z) mm -> (−x, z, y) / 1000 m      the same directions
//! unspecified  as LPS
//!
//! Source: glTF 2.0 specification, Khronos Group, sections 3.4 (units and axes), 3.7.2 (meshes)
//! and 4.4 (GLB).

use serde_json::{Value, json};

use super::output::{SurfaceOutput, WriteError};
use crate::mesh::{Frame, Vector};

const MILLIMETRES_PER_METRE: f64 = 1000.0;

/// Bytes of the interleaved blocks for one point: position, normal, colour as f32.
const VECTOR_BYTES: usize = 12;

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

/// A surface with normals, and with colours where the caller gives them.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let surface = output.surface;
    let mut binary: Vec<u8> =
        surface.triangles.as_flattened().iter().flat_map(|corner| corner.to_le_bytes()).collect();
    let index_bytes = binary.len();
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &point in &surface.points {
        let position = turned(point, output.frame).map(|c| (c / MILLIMETRES_PER_METRE) as f32);
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
        put(&mut binary, position);
    }
    for normal in surface.point_normals() {
        // glTF asks for unit normals, also where the triangles of a point cancel.
        let normal = normal.try_normalize(0.5).unwrap_or_else(Vector::z);
        put(&mut binary, turned(normal, output.frame).map(|c| c as f32));
    }
    for colour in output.colours.unwrap_or_default() {
        put(&mut binary, colour.map(linear));
    }
    let views = views(index_bytes, surface.points.len(), output.colours.is_some());
    let scene = document(output, &views, (low, high));
    Ok(container(&scene.to_string(), binary))
}

fn put(binary: &mut Vec<u8>, values: [f32; 3]) {
    binary.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// glTF stores linear colours. Source: IEC 61966-2-1.
fn linear(srgb: u8) -> f32 {
    let value = f32::from(srgb) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Offset, length and target of each part of the binary chunk.
fn views(index_bytes: usize, points: usize, has_colours: bool) -> Vec<(usize, usize, u32)> {
    let vectors = points * VECTOR_BYTES;
    let blocks = if has_colours { 3 } else { 2 };
    let indices = (0, index_bytes, ELEMENT_ARRAY_BUFFER);
    let others = (0..blocks).map(|block| (index_bytes + block * vectors, vectors, ARRAY_BUFFER));
    std::iter::once(indices).chain(others).collect()
}

fn document(
    output: &SurfaceOutput,
    views: &[(usize, usize, u32)],
    (low, high): ([f32; 3], [f32; 3]),
) -> Value {
    let points = output.surface.points.len();
    let indices = output.surface.triangles.len() * 3;
    let vector = |view: usize| json!({"bufferView": view, "componentType": FLOAT, "count": points, "type": "VEC3"});
    let mut position = vector(1);
    position["min"] = json!(low);
    position["max"] = json!(high);
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR"}),
        position,
        vector(2),
    ];
    let mut attributes = json!({"POSITION": 1, "NORMAL": 2});
    if output.colours.is_some() {
        accessors.push(vector(3));
        attributes["COLOR_0"] = json!(3);
    }
    let length: usize = views.iter().map(|(_, length, _)| length).sum();
    let buffer_views = views.iter().map(|(offset, length, target)| {
        json!({"buffer": 0, "byteOffset": offset, "byteLength": length, "target": target})
    });
    let extras = extras(output);
    json!({
        "asset": {"version": "2.0", "generator": "facies"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "skin", "extras": &extras}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 0, "material": 0}]}],
        "materials": [{
            "doubleSided": true,
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8},
        }],
        "accessors": accessors,
        "bufferViews": buffer_views.collect::<Vec<_>>(),
        "buffers": [{"byteLength": length}],
        "extras": extras,
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
