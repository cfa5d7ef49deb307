//! Mesh files that are wrong on purpose, through HTTP: one clear answer each, and nothing kept.
//! The first word of a name is the row of the list of bad inputs that it stands for.

use reqwest::StatusCode;

use crate::helpers::{SMALL, Server, ask};
use crate::samples::{
    GMSH_2, OBJ, PLY, STL, TETRAHEDRON, TRIANGLE, VTK, ascii_vtu, binary_stl, one_of_each,
};

fn changed(text: &str, from: &str, to: &str) -> Vec<u8> {
    let bytes = text.replace(from, to);
    assert_ne!(bytes, text, "{from} is not in the sample");
    bytes.into_bytes()
}

fn vtu(text: &str, from: &str, to: &str) -> Vec<u8> {
    let whole = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], text);
    changed(&whole, from, to)
}

fn nan_triangle() -> Vec<u8> {
    let mut triangle = TRIANGLE;
    triangle[1][0] = f32::NAN;
    binary_stl(b"x", 1, &[triangle])
}

fn surfaces() -> Vec<(&'static str, Vec<u8>, u16, &'static str)> {
    let flat = [[[0.0_f32; 3]; 3]];
    vec![
        ("1 a count of 2^32-1", binary_stl(b"x", u32::MAX, &[TRIANGLE]), 422, "mesh-parse"),
        ("2 one triangle short", binary_stl(b"x", 2, &[TRIANGLE]), 422, "mesh-parse"),
        ("5 text cut off in a facet", STL[..90].into(), 422, "mesh-parse"),
        ("6 nan as text", changed(STL, "100.5", "nan"), 422, "mesh-nonfinite"),
        ("7 nan as bits", nan_triangle(), 422, "mesh-nonfinite"),
        ("8 nothing", vec![], 422, "mesh-empty"),
        ("8 blanks", b" \n\t ".to_vec(), 422, "mesh-empty"),
        ("8 no triangles", binary_stl(b"x", 0, &[]), 422, "mesh-empty"),
        ("9 triangles without area", binary_stl(b"x", 1, &flat), 422, "mesh-degenerate"),
        ("19 index beyond", changed(OBJ, "3/1", "9"), 422, "mesh-index-out-of-range"),
        ("19 index 0", changed(OBJ, "3/1", "0"), 422, "mesh-index-out-of-range"),
        ("19 index before", changed(OBJ, "3/1", "-9"), 422, "mesh-index-out-of-range"),
        (
            "21 65 corners",
            format!("v 0 0 0\nv 9 0 0\nv 0 9 0\nf{}", " 1 2 3".repeat(22)).into(),
            422,
            "mesh-limits",
        ),
        ("22 decimal comma", changed(OBJ, "v 100 0", "v 100,5 0"), 422, "mesh-parse"),
        (
            "24 4e9 vertices",
            changed(PLY, "element vertex 4\r", "element vertex 4000000000\r"),
            422,
            "mesh-limits",
        ),
    ]
}

fn volumes() -> Vec<(&'static str, Vec<u8>, u16, &'static str)> {
    let inverted = ascii_vtu(
        &[[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0], [0.0, 0.0, -100.0]],
        &[(10, &[0, 1, 2, 3]), (10, &[0, 1, 2, 4])],
        "",
    );
    let twice = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3]), (10, &[0, 1, 2, 3])], "");
    let pyramid = ascii_vtu(&TETRAHEDRON, &[(14, &[0, 1, 2, 3, 0])], "");
    let long = "x".repeat(10_000);
    let named = format!(
        "<PointData><DataArray type=\"Int32\" Name=\"set_{long}\" format=\"ascii\">1 1 0 0</DataArray></PointData>"
    );
    vec![
        ("29 4e9 points", changed(VTK, "POINTS 4", "POINTS 4000000000"), 422, "mesh-limits"),
        (
            "29 2^64-1 points",
            changed(VTK, "POINTS 4", "POINTS 18446744073709551615"),
            422,
            "mesh-limits",
        ),
        (
            "30 4e9 points",
            vtu("", "NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000\""),
            422,
            "mesh-limits",
        ),
        (
            "30 two points more",
            vtu("", "NumberOfPoints=\"4\"", "NumberOfPoints=\"6\""),
            422,
            "mesh-parse",
        ),
        (
            "32 an entity",
            vtu("", "<VTKFile", "<!DOCTYPE x [<!ENTITY a SYSTEM \"/etc/passwd\">]><VTKFile"),
            422,
            "mesh-parse",
        ),
        ("35 a pyramid", pyramid.into(), 422, "mesh-parse"),
        ("36 some inverted", inverted.into(), 422, "mesh-inverted-elements"),
        ("37 every cell twice", twice.into(), 422, "mesh-degenerate"),
        (
            "40 a name of 10 kB",
            ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], &named).into(),
            422,
            "mesh-limits",
        ),
        (
            "46 5.1 million points",
            vtu("", "NumberOfPoints=\"4\"", "NumberOfPoints=\"5100000\""),
            422,
            "mesh-limits",
        ),
    ]
}

fn others() -> Vec<(&'static str, Vec<u8>, u16, &'static str)> {
    let kind = "unsupported-media-type";
    vec![
        ("41 glb", b"glTF\x02\0\0\0\xff\xff\xff\xff".to_vec(), 415, kind),
        ("43 png", b"\x89PNG\r\n\x1a\n".to_vec(), 415, kind),
        ("43 pdf", b"%PDF-1.7".to_vec(), 415, kind),
        ("43 html", b"<!DOCTYPE html><html></html>".to_vec(), 415, kind),
        ("43 json", b"{}".to_vec(), 415, kind),
        ("45 zip", b"PK\x03\x04../../x".to_vec(), 415, kind),
    ]
}

#[tokio::test]
async fn every_bad_mesh_has_one_clear_answer_and_leaves_nothing() {
    let server = Server::start();
    for (name, bytes, status, code) in surfaces().into_iter().chain(volumes()).chain(others()) {
        let problem = server.upload(bytes).await.problem_of(name, status, code);
        assert!(problem.to_string().len() < 4096, "{name}");
    }
    let blobs = std::fs::read_dir(server.path().join("blobs")).unwrap().count();
    assert_eq!(blobs, 0);
    let log = std::fs::read_dir(server.path().join("tmp")).unwrap().count();
    assert_eq!(log, 0);
    server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn what_can_be_mended_is_stored_and_reported() {
    let server = Server::start();
    let mut trailing = binary_stl(b"x", 1, &[TRIANGLE]);
    trailing.extend([0; 7]);
    let reversed = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 2, 1, 3])], "");
    let with_spare = ascii_vtu(
        &[[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0], [9.0, 9.0, 9.0]],
        &[(10, &[0, 1, 2, 3])],
        "",
    );
    let quads = "v 0 0 0\nv 90 0 0\nv 90 90 0\nv 0 90 0\nl 1 2\nf 1 2 3 4\n".to_owned();
    for (name, bytes, code) in [
        ("3 trailing bytes", trailing, "trailing-bytes"),
        ("23 quads", quads.into_bytes(), "polygons-triangulated"),
        ("36 all inverted", reversed.into_bytes(), "cells-reordered"),
        ("39 spare nodes", with_spare.into_bytes(), "unreferenced-nodes"),
    ] {
        let mesh = server.upload(bytes).await.expect(StatusCode::CREATED);
        let warnings = mesh["report"]["warnings"].as_array().unwrap();
        assert!(warnings.iter().any(|warning| warning["code"] == code), "{name}: {mesh}");
    }
    // 4: the length of a binary file says more than a header that starts with "solid".
    let solid = binary_stl(b"solid exported", 1, &[TRIANGLE]);
    server.upload(solid).await.expect(StatusCode::CREATED);
    // 20: a material library is never opened. 27, 28, 34: the variants of the formats.
    let named = changed(OBJ, "f ", "mtllib ../../../../etc/passwd\nf ");
    server.upload(named).await.expect(StatusCode::CREATED);
    for (name, bytes) in one_of_each() {
        let answer = server.upload(bytes).await;
        assert!(answer.status.is_success(), "{name}: {:?}", String::from_utf8_lossy(&answer.bytes));
    }
    assert!(GMSH_2.contains("1000000000000"), "34: node numbers far apart are among them");
}

#[tokio::test]
async fn a_frame_that_contradicts_the_file_is_refused() {
    let server = Server::start();
    let request = server.post("/v1/meshes?frame=RAS").header("content-type", "model/stl").body(STL);
    ask(request).await.problem_of("17", 422, "frame-conflict");
    let case = serde_json::json!({"schema": 1, "units": "mm", "frame": "RAS", "volume": "block"});
    let marked = crate::samples::ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "<PointData/>");
    let marked = marked.replace(
        "<UnstructuredGrid>",
        "<UnstructuredGrid><FieldData><DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</DataArray></FieldData>",
    );
    let form = reqwest::multipart::Form::new().text("case", case.to_string()).text("block", marked);
    ask(server.post("/v1/cases").multipart(form)).await.problem_of("17", 422, "frame-conflict");
}

#[tokio::test]
async fn a_compressed_body_is_refused_before_it_is_opened() {
    let server = Server::start();
    for encoding in ["gzip", "deflate", "br", "zstd"] {
        let request = server.post("/v1/meshes").header("content-type", "model/stl");
        let answer = ask(request.header("content-encoding", encoding).body(STL)).await;
        answer.problem_of("44", 415, "unsupported-media-type");
        assert_eq!(answer.header("accept-encoding"), "identity");
    }
}
