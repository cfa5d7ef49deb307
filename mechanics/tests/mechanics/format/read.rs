//! What the readers make of well-formed files.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mechanics::format::{MeshFormat, ReadLimits};
use mechanics::mesh::{CellShape, Frame, Vector};

use crate::samples::{
    GMSH_2, GMSH_4, OBJ, PLY, STL, TETRAHEDRON, VTK, ascii_vtu, code_of, error_of, one_of_each,
    read_default, surface, volume, warning_codes,
};

#[test]
fn every_sample_is_recognised_by_its_content_and_read() {
    for (name, bytes) in one_of_each() {
        let format = MeshFormat::sniff(&bytes).map(MeshFormat::name).unwrap_or("none");
        let start = name.split(' ').next().unwrap();
        let expected = match start {
            "vtk" => "VTK legacy",
            "gmsh" => "Gmsh",
            "nifti" => "NIfTI",
            "metaimage" if name != "metaimage pair" => "MetaImage",
            // A zip archive is read as what stands in it.
            "metaimage" => "DICOM",
            other => &other.to_uppercase(),
        };
        assert_eq!(format, expected, "{name}");
        assert_eq!(code_of(&bytes), "read", "{name}: {}", error_of(&bytes));
    }
}

#[test]
fn the_same_tetrahedron_is_read_from_every_volume_format() {
    for (name, bytes) in one_of_each() {
        if ["vtu ascii", "vtk", "vtk binary", "gmsh 4.1", "gmsh 2.2 binary"].contains(&name) {
            assert_is_the_tetrahedron(&bytes);
        }
    }
}

#[test]
fn a_byte_order_mark_and_leading_lines_do_not_matter() {
    let text = format!("\u{feff}\n\n{OBJ}");
    assert_eq!(code_of(text.as_bytes()), "read");
}

#[test]
fn legacy_vtk_gives_sets_labels_vectors_and_the_frame() {
    let read = read_default(VTK.as_bytes());
    assert_eq!(read.frame, Some(Frame::Ras));
    assert_eq!(read.ignored.names(), ["temperature"]);
    let mesh = volume(read);
    assert_eq!(mesh.node_sets["lower lip"], [1, 3]);
    assert_eq!(mesh.node_labels["tag"], [5, 5, 6, 6]);
    assert_eq!(mesh.cell_labels["band"], [2]);
    assert_eq!(mesh.node_vectors["u_mm"][3], Vector::repeat(0.5));
}

#[test]
fn gmsh_groups_of_surfaces_are_node_sets_and_those_of_volumes_cell_sets() {
    let two = volume(read_default(GMSH_2.as_bytes()));
    assert_eq!(two.node_sets["lower lip"], [1, 2, 3]);
    assert_eq!(two.cell_sets["fat"], [0]);
    assert_eq!(two.cell_labels["gmsh:physical"], [8]);
    assert_eq!(two.cells.nodes(0), [0, 1, 2, 3]);
    let four = volume(read_default(GMSH_4.as_bytes()));
    assert_eq!(four.node_sets["physical_2_4"], [1, 2, 3]);
    assert_eq!(four.cell_sets["fat"], [0]);
    assert_eq!(four.cell_sets["physical_3_2"], [0]);
}

#[test]
fn an_element_that_gmsh_repeats_for_each_of_its_groups_is_one_cell() {
    let repeated = "3 4 2 8 1 1000000000000 7 -4 9\n4 4 2 5 1 1000000000000 7 -4 9\n$End";
    let bytes = GMSH_2
        .replace("3 4 2 8 1 1000000000000 7 -4 9\n$End", repeated)
        .replace("$Elements\n3", "$Elements\n4");
    let mesh = volume(read_default(bytes.as_bytes()));
    assert_eq!(mesh.cells.len(), 1);
    assert_eq!((&mesh.cell_sets["fat"], &mesh.cell_sets["physical_3_5"]), (&vec![0], &vec![0]));
    assert_eq!(mesh.cell_labels["gmsh:physical"], [8]);
}

#[test]
fn equal_corners_of_an_stl_are_one_point() {
    let read = read_default(STL.as_bytes());
    assert_eq!(read.frame, Some(Frame::Lps));
    let skin = surface(read);
    assert_eq!(skin.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(skin.points[2], Vector::new(0.0, 100.5, 0.0));
}

#[test]
fn ply_properties_are_found_by_name() {
    let read = read_default(PLY.as_bytes());
    assert_eq!(read.frame, Some(Frame::Lps));
    assert_eq!(warning_codes(&read), ["cells-skipped", "polygons-triangulated"]);
    assert_eq!(read.ignored.names(), ["neighbours", "red"]);
    let skin = surface(read);
    assert_eq!(skin.points[1], Vector::new(100.0, 0.0, 0.0));
    assert_eq!(skin.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(skin.node_ids, Some(vec![40, 41, 42, 43]));
}

#[test]
fn obj_faces_may_count_from_the_end_and_name_texture_and_normal() {
    let read = read_default(OBJ.as_bytes());
    assert_eq!(read.frame, Some(Frame::Ras));
    assert_eq!(warning_codes(&read), ["cells-skipped"]);
    assert_eq!(surface(read).triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn flat_cells_beside_solid_ones_are_left_out_with_their_values() {
    let more = "<CellData><DataArray type=\"Int8\" Name=\"band\" format=\"ascii\">7 8 9</DataArray></CellData>";
    let cells: [(u8, &[u32]); 3] = [(5, &[0, 1, 2]), (10, &[0, 1, 2, 3]), (3, &[0, 1])];
    let read = read_default(ascii_vtu(&TETRAHEDRON, &cells, more).as_bytes());
    assert_eq!(warning_codes(&read), ["cells-skipped"]);
    assert_eq!(volume(read).cell_labels["band"], [8]);
}

#[test]
fn text_beyond_the_type_of_its_array_is_refused_with_the_array() {
    let with = |kind: &str, value: &str| {
        let more = format!(
            "<CellData><DataArray type=\"{kind}\" Name=\"band\" format=\"ascii\">{value}</DataArray></CellData>"
        );
        ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], &more)
    };
    for (kind, value) in [("Int32", "99999999999"), ("UInt8", "-1"), ("Int64", "1.5")] {
        let error = error_of(with(kind, value).as_bytes());
        let wanted = format!("array \"band\" of CellData: not a value of its type: {value:?}");
        assert!(error.contains(&wanted), "{error}");
    }
    assert_eq!(
        volume(read_default(with("Int64", "99999999999").as_bytes())).cell_labels["band"],
        [99_999_999_999]
    );
}

#[test]
fn vectors_of_cells_are_kept_with_their_cells_and_are_zero_where_they_were_not_finite() {
    let more = "<CellData><DataArray type=\"Float32\" Name=\"fibre\" NumberOfComponents=\"3\" format=\"ascii\">\
        7 7 7 0 1 -2 nan 0 0</DataArray></CellData>";
    let cells: [(u8, &[u32]); 3] = [(5, &[0, 1, 2]), (10, &[0, 1, 2, 3]), (10, &[0, 1, 2, 3])];
    let read = read_default(ascii_vtu(&TETRAHEDRON, &cells, more).as_bytes());
    assert_eq!(warning_codes(&read), ["cells-skipped", "array-nonfinite", "duplicate-cells"]);
    assert_eq!(read.ignored.names(), Vec::<String>::new());
    let fibres = &volume(read).cell_vectors["fibre"];
    assert_eq!(*fibres, [Vector::new(0.0, 1.0, -2.0), Vector::zeros()]);
}

#[test]
fn a_legacy_file_brings_vectors_of_cells_too() {
    let text = "# vtk DataFile Version 3.0\nmuscle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
        0 0 0 100 0 0 0 100 0 0 0 100\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n\
        CELL_DATA 1\nVECTORS fibre double\n0 3 4\n";
    let mesh = volume(read_default(text.as_bytes()));
    assert_eq!(mesh.cell_vectors["fibre"], [Vector::new(0.0, 3.0, 4.0)]);
}

#[test]
fn an_unstructured_grid_of_flat_cells_is_a_surface() {
    let cells: [(u8, &[u32]); 2] = [(5, &[0, 1, 2]), (9, &[0, 1, 3, 2])];
    let read = read_default(ascii_vtu(&TETRAHEDRON, &cells, "").as_bytes());
    assert_eq!(surface(read).triangles.len(), 3);
}

#[test]
fn arrays_that_number_things_are_ignored_and_named() {
    let dof_map: Vec<String> = (0..70).map(|n| n.to_string()).collect();
    let points: Vec<[f64; 3]> =
        (0..70).map(|n| if n < 4 { TETRAHEDRON[n] } else { [f64::from(n as u32); 3] }).collect();
    let array = |kind: &str, name: &str, text: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>")
    };
    let ones = vec!["1"; 70].join(" ");
    let more = [
        "<PointData>".to_string(),
        array("Int32", "element_id", &dof_map.join(" ")),
        array("Int32", "node_id", &ones),
        array("Float64", "temperature", &ones),
        array("UInt8", "set_all", &ones),
        "</PointData>".into(),
    ]
    .concat();
    let bytes = ascii_vtu(&points, &[(10, &[0, 1, 2, 3])], &more);
    let few = ReadLimits { label_values: 64, ..ReadLimits::default() };
    let read = mechanics::format::read(bytes.as_bytes(), &few).unwrap();
    assert_eq!(read.ignored.names(), ["temperature", "element_id", "node_id"]);
    assert_eq!(warning_codes(&read), ["unreferenced-nodes"]);
    let mesh = volume(read);
    assert_eq!(mesh.nodes.len(), 70, "nodes keep the numbers of the file");
    assert_eq!(mesh.node_sets["all"].len(), 70);
}

/// The tetrahedron with its arrays encoded by `encode`, which returns attributes and text.
fn encoded_vtu(
    file: &str,
    mut encode: impl FnMut(Vec<u8>) -> (String, String),
    tail: &[u8],
) -> Vec<u8> {
    let big = file.contains("BigEndian");
    let real = |value: &f64| {
        if big { value.to_be_bytes() } else { value.to_le_bytes() }
    };
    let whole = |value: i32| {
        if big { value.to_be_bytes() } else { value.to_le_bytes() }
    };
    let points = TETRAHEDRON.as_flattened().iter().flat_map(real).collect();
    let nodes = [0, 1, 2, 3].into_iter().flat_map(whole).collect();
    let ends = whole(4).to_vec();
    let mut array = |kind: &str, name: &str, components: u8, bytes: Vec<u8>| {
        let (attributes, text) = encode(bytes);
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" {attributes}>{text}</DataArray>"
        )
    };
    let head = format!(
        "<VTKFile type=\"UnstructuredGrid\" {file}><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>{}</Points><Cells>{}{}{}</Cells></Piece></UnstructuredGrid>",
        array("Float64", "Points", 3, points),
        array("Int32", "connectivity", 1, nodes),
        array("Int32", "offsets", 1, ends),
        array("UInt8", "types", 1, vec![10]),
    );
    [head.as_bytes(), tail, b"</VTKFile>"].concat()
}

fn assert_is_the_tetrahedron(bytes: &[u8]) {
    let mesh = volume(read_default(bytes));
    assert_eq!(mesh.nodes, TETRAHEDRON.map(Vector::from));
    assert_eq!(mesh.cells.shape(0), CellShape::Tet4);
    assert_eq!(mesh.cells.nodes(0), [0, 1, 2, 3]);
}

/// The same of a VTU, which says what follows its end.
fn assert_is_the_tetrahedron_alone(bytes: &[u8]) {
    assert_is_the_tetrahedron(bytes);
    for (behind, told) in [("", None), (" \r\n\t", None), ("\nmore \n", Some(4.0))] {
        assert_eq!(trailing(&[bytes, behind.as_bytes()].concat()), told, "{behind:?}");
    }
}

/// How many bytes are told to follow the end of a file.
fn trailing(bytes: &[u8]) -> Option<f64> {
    let mut warnings = read_default(bytes).warnings.into_iter();
    warnings.find(|warning| warning.code == "trailing-bytes").map(|warning| warning.numbers[0].1)
}

#[test]
fn what_follows_the_end_of_text_is_told_unless_it_is_white_space_or_a_comment() {
    let vtu = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "");
    for (file, behind, told) in [
        (vtu.as_str(), "\n<!-- made by hand -->\n", None),
        (&vtu, "<!-- a --> <b/>", Some(4.0)),
        (&vtu, "\0\0", Some(2.0)),
        (PLY, " \r\n", None),
        (PLY, "0 1\r\n", Some(5.0)),
    ] {
        assert_eq!(trailing(format!("{file}{behind}").as_bytes()), told, "{behind:?}");
    }
}

#[test]
fn inline_base64_is_read_in_both_byte_orders_and_header_widths() {
    let binary = |text: String| ("format=\"binary\"".to_string(), text);
    let small = |bytes: Vec<u8>| {
        let length = (bytes.len() as u32).to_le_bytes();
        binary(STANDARD.encode([&length[..], &bytes].concat()))
    };
    assert_is_the_tetrahedron_alone(&encoded_vtu("byte_order=\"LittleEndian\"", small, b""));
    let big_apart = |bytes: Vec<u8>| {
        let length = STANDARD.encode((bytes.len() as u64).to_be_bytes());
        binary(format!("\n  {length}{}\n", STANDARD.encode(bytes)))
    };
    let file = "byte_order=\"BigEndian\" header_type=\"UInt64\"";
    assert_is_the_tetrahedron_alone(&encoded_vtu(file, big_apart, b""));
}

#[test]
fn appended_data_is_read_raw_and_as_base64() {
    let mut raw = b"<AppendedData encoding=\"raw\">\n_".to_vec();
    let start = raw.len();
    let file = "byte_order=\"LittleEndian\" header_type=\"UInt32\"";
    let appended =
        |offset: usize| (format!("format=\"appended\" offset=\"{offset}\""), String::new());
    let head = encoded_vtu(
        file,
        |bytes| {
            let offset = raw.len() - start;
            raw.extend((bytes.len() as u32).to_le_bytes());
            raw.extend(bytes);
            appended(offset)
        },
        b"",
    );
    raw.extend(b"</AppendedData>");
    let end = head.len() - b"</VTKFile>".len();
    let file_of_raw = [&head[..end], &raw, b"</VTKFile>"].concat();
    assert_is_the_tetrahedron_alone(&file_of_raw);
    assert_eq!(trailing(&file_of_raw.repeat(2)), Some(file_of_raw.len() as f64));

    let mut text = String::new();
    let head = encoded_vtu(
        file,
        |bytes| {
            let offset = text.len();
            let length = (bytes.len() as u32).to_le_bytes();
            text.push_str(&STANDARD.encode([&length[..], &bytes].concat()));
            appended(offset)
        },
        b"",
    );
    let tail = format!("<AppendedData encoding=\"base64\">_{text}</AppendedData></VTKFile>");
    assert_is_the_tetrahedron_alone(&[&head[..end], tail.as_bytes()].concat());
}

#[test]
fn cells_that_are_all_inverted_are_reordered_and_a_mixture_is_refused() {
    let inverted = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 2, 1, 3])], "");
    let read = read_default(inverted.as_bytes());
    assert_eq!(warning_codes(&read), ["cells-reordered"]);
    assert!(volume(read).cell_jacobian(0).is_valid());
    let cells: [(u8, &[u32]); 2] = [(10, &[0, 1, 2, 3]), (10, &[0, 2, 1, 3])];
    let mixture = ascii_vtu(&TETRAHEDRON, &cells, "");
    assert_eq!(error_of(mixture.as_bytes()), "1 of 2 tet4 cells are inverted or flat");
    assert_eq!(code_of(mixture.as_bytes()), "mesh-inverted-elements");
}

#[test]
fn a_wedge_in_the_other_order_of_vtk_is_turned_without_a_word() {
    let points = [
        [0.0, 0.0, 0.0],
        [100.0, 0.0, 0.0],
        [0.0, 100.0, 0.0],
        [0.0, 0.0, 50.0],
        [100.0, 0.0, 50.0],
        [0.0, 100.0, 50.0],
    ];
    let read = read_default(ascii_vtu(&points, &[(13, &[0, 2, 1, 3, 5, 4])], "").as_bytes());
    assert_eq!(read.warnings, []);
    let mesh = volume(read);
    assert_eq!(mesh.cells.nodes(0), [0, 1, 2, 3, 4, 5]);
    assert!(mesh.cell_jacobian(0).is_valid());
}

#[test]
fn a_hexahedron_with_a_dented_corner_is_kept_with_a_warning() {
    let mut points = vec![
        [0.0, 0.0, 0.0],
        [100.0, 0.0, 0.0],
        [100.0, 100.0, 0.0],
        [0.0, 100.0, 0.0],
        [0.0, 0.0, 100.0],
        [100.0, 0.0, 100.0],
        [100.0, 100.0, 100.0],
        [0.0, 100.0, 100.0],
    ];
    // A corner pushed just through the plane of its three neighbours.
    points[6] = [65.0, 65.0, 65.0];
    let nodes: Vec<u32> = (0..8).collect();
    let read = read_default(ascii_vtu(&points, &[(12, &nodes)], "").as_bytes());
    assert_eq!(warning_codes(&read), ["dented-cells"]);
}

#[test]
fn a_cell_that_stands_twice_is_reported() {
    let points = [[0.0; 3], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0], [9.0, 9.0, 9.0]];
    let once: [(u8, &[u32]); 2] = [(10, &[0, 1, 2, 3]), (10, &[1, 2, 3, 4])];
    let twice: [(u8, &[u32]); 3] = [once[0], once[1], (10, &[1, 2, 0, 3])];
    let read = |cells: &[(u8, &[u32])]| read_default(ascii_vtu(&points, cells, "").as_bytes());
    assert_eq!(warning_codes(&read(&once)), [""; 0]);
    assert_eq!(warning_codes(&read(&twice)), ["duplicate-cells"]);
}
