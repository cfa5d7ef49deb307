//! Files that are wrong on purpose: one clear error each, before memory is taken for them.

use std::fmt::Write;
use std::io::Write as _;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use mechanics::format::{FilePosition, FormatError, Member, MeshFormat, ReadLimits, read};

use crate::samples::{
    GMSH_2, GMSH_4, OBJ, PLY, STL, TETRAHEDRON, TRIANGLE, VTK, ascii_vtu, binary_stl, code_of,
    error_of,
};

#[test]
fn an_stl_that_declares_more_than_it_holds_is_refused_with_both_numbers() {
    let huge = binary_stl(b"x", u32::MAX, &[TRIANGLE]);
    assert_eq!(error_of(&huge), "STL file, byte 84: 4294967295 triangles declared, 1 follow");
    let truncated = binary_stl(b"solid exported", 2, &[TRIANGLE]);
    assert_eq!(error_of(&truncated), "STL file, byte 84: 2 triangles declared, 1 follow");
}

#[test]
fn coordinates_that_are_not_finite_are_counted() {
    let mut triangle = TRIANGLE;
    triangle[1][0] = f32::NAN;
    let expected = FormatError::NonFinite { count: 1, first: vec![1] };
    let binary = read(&binary_stl(b"x", 1, &[triangle]), &ReadLimits::default());
    assert_eq!(binary, Err(expected));
    for word in ["nan", "inf", "-Infinity", "1e999"] {
        assert_eq!(code_of(STL.replace("100.5", word).as_bytes()), "mesh-nonfinite");
        assert_eq!(
            code_of(OBJ.replace("v 100 0", &format!("v {word} 0")).as_bytes()),
            "mesh-nonfinite"
        );
        assert_eq!(
            code_of(VTK.replace("100 0 0 ", &format!("{word} 0 0 ")).as_bytes()),
            "mesh-nonfinite"
        );
        assert_eq!(
            code_of(PLY.replace("0 0 100 41", &format!("0 0 {word} 41")).as_bytes()),
            "mesh-nonfinite"
        );
    }
    let far = OBJ.replace("v 100 0", "v 1e300 0");
    assert_eq!(code_of(far.as_bytes()), "mesh-limits");
    assert!(error_of(far.as_bytes()).starts_with("a coordinate is 1e300, and 1e15"));
}

#[test]
fn a_file_without_a_mesh_is_empty() {
    for nothing in [
        "",
        " \n\t ",
        "solid x\nendsolid x\n",
        "v 0 0 0\n",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"0\" NumberOfPolys=\"0\"/></PolyData></VTKFile>",
    ] {
        assert_eq!(code_of(nothing.as_bytes()), "mesh-empty", "{nothing}");
    }
    assert_eq!(code_of(&binary_stl(b"x", 0, &[])), "mesh-empty");
}

#[test]
fn text_that_ends_early_is_refused_with_its_line() {
    let truncated = &STL[..STL.find("100.5 -0").unwrap()];
    let error = read(truncated.as_bytes(), &ReadLimits::default()).unwrap_err();
    let FormatError::Parse { place, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(*place, FilePosition::Line(6));
    assert!(error.members().contains(&("line", Member::Count(6))));
}

#[test]
fn indices_beyond_the_points_are_refused_in_every_format() {
    for index in ["9", "0", "-9", "-99999999999999", "4294967297"] {
        let bytes = OBJ.replace("3/1", index);
        assert_eq!(code_of(bytes.as_bytes()), "mesh-index-out-of-range", "{index}");
    }
    for (text, from, to) in [
        (PLY, "4 0 1 2 3", "4 0 1 2 4"),
        (VTK, "4 0 1 2 3", "4 0 1 2 4"),
        (VTK, "4 0 1 2 3", "4 0 1 2 -1"),
        (GMSH_2, "7 -4 9\n$End", "7 -4 8\n$End"),
        (GMSH_4, "2 1 2 3 4", "2 1 2 3 5"),
        (GMSH_4, "2 1 2 3 4", "2 1 2 3 4294967300"),
    ] {
        let bytes = text.replace(from, to);
        assert_ne!(bytes, text);
        assert_eq!(code_of(bytes.as_bytes()), "mesh-index-out-of-range", "{to}");
    }
    let bytes = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 4])], "");
    let error = read(bytes.as_bytes(), &ReadLimits::default()).unwrap_err();
    assert_eq!(
        error.members(),
        [
            ("count", Member::Count(1)),
            ("first", Member::Counts(vec![0])),
            ("nodes", Member::Count(4)),
        ]
    );
}

#[test]
fn a_polygon_has_at_most_64_corners() {
    let mut text = String::from("v 0 0 0\nv 100 0 0\nv 0 100 0\nf");
    for corner in 0..2_000_000 {
        write!(text, " {}", corner % 3 + 1).unwrap();
    }
    assert_eq!(error_of(text.as_bytes()), "2000000 corners in one polygon, and 64 is the limit");
    let list = PLY.replace("list uchar uint vertex_index", "list int int vertex_index");
    for (length, code) in [("65", "mesh-limits"), ("-1", "mesh-parse"), ("x", "mesh-parse")] {
        let bytes = list.replace("1 4 0 1 2 3", &format!("1 {length} 0 1 2 3"));
        assert_eq!(code_of(bytes.as_bytes()), code, "{length}");
    }
}

#[test]
fn a_decimal_comma_is_refused_with_a_hint() {
    let error = error_of(OBJ.replace("v 100 0 0", "v 100,5 0 0").as_bytes());
    assert_eq!(
        error,
        "OBJ file, line 5: expected a coordinate, found \"100,5\"; numbers need a decimal point, not a comma"
    );
    assert!(error_of(STL.replace("100.5", "100,5").as_bytes()).contains("comma"));
}

#[test]
fn counts_that_the_file_cannot_hold_are_refused() {
    let ply = |from: &str, to: &str| PLY.replace(from, to);
    assert_eq!(code_of(ply("vertex 4", "vertex 4000000000").as_bytes()), "mesh-limits");
    assert_eq!(code_of(ply("vertex 4", "vertex 4000000").as_bytes()), "mesh-parse");
    assert_eq!(code_of(ply("face 1", "face 9000000").as_bytes()), "mesh-parse");
    let endless = ply("element edge 1\r\n", "element edge 4000000000\r\nelement other 1\r\n");
    assert_eq!(code_of(endless.as_bytes()), "mesh-limits");
    let vtk = |from: &str, to: &str| code_of(VTK.replace(from, to).as_bytes());
    assert_eq!(vtk("POINTS 4", "POINTS 4000000000"), "mesh-limits");
    assert_eq!(vtk("POINTS 4", "POINTS 18446744073709551615"), "mesh-limits");
    assert_eq!(vtk("POINTS 4", "POINTS 4000000"), "mesh-parse");
    assert_eq!(vtk("CELLS 1 5", "CELLS 1 99999999999"), "mesh-parse");
    assert_eq!(vtk("FieldData 2", "FieldData 18446744073709551615"), "mesh-parse");
    assert_eq!(vtk("tag 1 4", "tag 18446744073709551615 4"), "mesh-parse");
    for (text, from, to) in [
        (GMSH_2, "$Nodes\n4", "$Nodes\n4000000"),
        (GMSH_2, "$Elements\n3", "$Elements\n9000000"),
        (GMSH_4, "1 4 1 4", "1 4000000 1 4"),
        (GMSH_4, "3 6 0 4", "3 6 0 9223372036854775807"),
        (GMSH_4, "2 8 2 1 5", "9223372036854775807 8 2 1 5"),
        (GMSH_4, "2 2 1 2", "9223372036854775807 2 1 2"),
        (GMSH_2, "$PhysicalNames\n2", "$PhysicalNames\n18446744073709551615"),
    ] {
        let bytes = text.replace(from, to);
        assert_ne!(bytes, text);
        assert_eq!(code_of(bytes.as_bytes()), "mesh-parse", "{to}");
    }
    let vtu = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "");
    for (points, code) in [("4000000000", "mesh-limits"), ("4000000", "mesh-parse")] {
        let bytes = vtu.replace("Points=\"4\"", &format!("Points=\"{points}\""));
        assert_eq!(code_of(bytes.as_bytes()), code);
    }
}

#[test]
fn more_nodes_than_the_limit_are_refused() {
    let limits = ReadLimits { nodes: 3, ..ReadLimits::default() };
    for text in [OBJ, PLY, STL, VTK, GMSH_2, GMSH_4] {
        let error = read(text.as_bytes(), &limits).unwrap_err();
        assert_eq!(error.to_string(), "4 nodes, and 3 is the limit");
        assert_eq!(error.code(), "mesh-limits");
    }
}

fn binary_vtu(points: &str, file: &str) -> Vec<u8> {
    let text = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "");
    let start = text.find("format=\"ascii\"").unwrap();
    let end = text.find("</DataArray>").unwrap();
    let head =
        text[..start].replace("\"UnstructuredGrid\">", &format!("\"UnstructuredGrid\" {file}>"));
    format!("{head}{points}{}", &text[end..]).into_bytes()
}

const ZLIB: &str = "compressor=\"vtkZLibDataCompressor\"";

fn compressed(header: &[u32], data: &[u8]) -> String {
    let header: Vec<u8> = header.iter().flat_map(|n| n.to_le_bytes()).collect();
    format!("format=\"binary\">{}{}", STANDARD.encode(header), STANDARD.encode(data))
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn block_headers_that_lie_are_refused() {
    let data = zlib(&[0; 96]);
    let stored = data.len() as u32;
    for (header, code) in [
        (vec![1, 96, 0, stored], "mesh-inverted-elements or flat"),
        (vec![1, 95, 0, stored], "mesh-parse"),
        (vec![1, 97, 0, stored], "mesh-parse"),
        (vec![1, 96, 0, stored + 100], "mesh-parse"),
        (vec![1, 96, 0, stored - 2], "mesh-parse"),
        (vec![1, 96, 0, 0], "mesh-parse"),
        (vec![u32::MAX, 96, 0, stored], "mesh-parse"),
        (vec![u32::MAX, u32::MAX, u32::MAX], "mesh-parse"),
        (vec![1, 15 << 20, 0, stored], "mesh-parse"),
        (vec![1, u32::MAX, 0, stored], "decompression-limit"),
        (vec![0], "mesh-parse"),
        (vec![], "mesh-parse"),
    ] {
        let found = code_of(&binary_vtu(&compressed(&header, &data), ZLIB));
        let expected = if code.ends_with("flat") { "mesh-degenerate" } else { code };
        assert_eq!(found, expected, "{header:?}");
    }
}

#[test]
fn an_array_nobody_asks_for_counts_towards_the_decoded_size_too() {
    let zeros = zlib(&vec![0; 64 << 20]);
    let header = [1, 64 << 20, 0, zeros.len() as u32];
    let array = format!(
        "<CellData><DataArray type=\"Float64\" Name=\"x\" {}</DataArray></CellData>",
        compressed(&header, &zeros)
    );
    let text = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], &array);
    let text = text.replace("\"UnstructuredGrid\">", &format!("\"UnstructuredGrid\" {ZLIB}>"));
    let floor = |bytes| ReadLimits { decoded_floor_bytes: bytes, ..ReadLimits::default() };
    assert_eq!(
        read(text.as_bytes(), &floor(16 << 20)).unwrap_err().to_string(),
        "the arrays decode to 67108864 bytes or more, and 16777216 bytes is the limit"
    );
    assert!(read(text.as_bytes(), &floor(65 << 20)).is_ok());
}

#[test]
fn appended_data_beyond_the_end_is_refused() {
    let head = binary_vtu("format=\"appended\" offset=\"4000000000\">", "header_type=\"UInt32\"");
    let head = String::from_utf8(head).unwrap();
    assert!(error_of(head.as_bytes()).contains("lies beyond the data"));
    let tail = head
        .replace("</VTKFile>", "<AppendedData encoding=\"raw\">_abcdefgh</AppendedData></VTKFile>");
    assert!(error_of(tail.as_bytes()).contains("lies beyond the data"));
    let near = tail.replace("4000000000", "2");
    assert!(error_of(near.as_bytes()).contains("bytes declared, at most"));
}

#[test]
fn entities_and_deep_nesting_are_refused() {
    let vtu = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "");
    let laughs = format!(
        "<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]>{}",
        vtu.replacen("ascii\">0", "ascii\">&b;", 1)
    );
    assert!(error_of(laughs.as_bytes()).contains("document types are refused"));
    let external = vtu.replacen("ascii\">0", "ascii\">&xxe;", 1);
    assert!(error_of(external.as_bytes()).contains("entities"));
    let deep = vtu.replace("<Points>", &("<a>".repeat(200_000) + "<Points>"));
    assert!(error_of(deep.as_bytes()).contains("nested deeper than 32"));
    let many =
        vtu.replace("<Points>", &("<FieldData>".to_string() + &"<DataArray/>".repeat(200_000)));
    assert!(error_of(many.as_bytes()).contains("more than 10000 arrays"));
}

#[test]
fn cells_that_are_not_supported_are_named() {
    let nodes: Vec<u32> = vec![0; 10];
    let cells: [(u8, &[u32]); 3] = [(24, &nodes), (14, &nodes[..5]), (10, &[0, 1, 2, 3])];
    let bytes = ascii_vtu(&TETRAHEDRON, &cells, "");
    assert_eq!(
        error_of(bytes.as_bytes()),
        "the file holds cells that are not supported: pyramid (VTK cell type 14), quadratic tetrahedron (VTK cell type 24)"
    );
    let gmsh = GMSH_2.replace("3 4 2 8 1 1000000000000", "3 7 2 8 1 7 1000000000000");
    assert!(error_of(gmsh.as_bytes()).ends_with("pyramid"));
    assert_eq!(code_of(gmsh.as_bytes()), "mesh-parse");
}

#[test]
fn names_that_are_too_long_or_stand_twice_are_refused() {
    let named = |name: &str| {
        let array = format!(
            "<DataArray type=\"Int8\" Name=\"{name}\" format=\"ascii\">1 0 0 1</DataArray>"
        );
        let more = format!(
            "<PointData>{array}<DataArray type=\"Int8\" Name=\" set_jaw\" format=\"ascii\">0 0 0 1</DataArray></PointData>"
        );
        ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], &more)
    };
    assert_eq!(code_of(named("set_lèvre inférieure").as_bytes()), "read");
    assert_eq!(code_of(named(&"x".repeat(10_000)).as_bytes()), "mesh-limits");
    assert!(
        error_of(named("set_jaw ").as_bytes()).contains("two sets or arrays are called \"jaw\"")
    );
    assert!(error_of(named("a&#10;b").as_bytes()).contains("control character"));
}

#[test]
fn files_of_other_kinds_are_distinguished_by_their_content() {
    let others: [(&[u8], &str); 9] = [
        (b"\x89PNG\r\n\x1a\n\0\0", "PNG"),
        (b"%PDF-1.7\n", "PDF"),
        (b"<!DOCTYPE html><html></html>", "HTML"),
        (b"<html><body>", "HTML"),
        (b"\x1f\x8b\x08\0", "gzip"),
        (b"glTF\x02\0\0\0", "glTF"),
        (b"<VTKFile type=\"ImageData\">", "XML"),
        (b"{\"a\":1}", "JSON"),
        (b"hello, world", "expected one of"),
    ];
    for (bytes, kind) in others {
        assert_eq!(MeshFormat::sniff(bytes), None);
        assert_eq!(code_of(bytes), "unsupported-format");
        assert!(error_of(bytes).contains(kind), "{}", error_of(bytes));
    }
}
