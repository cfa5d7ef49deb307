//! What is written is what is read.

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{
    ArrayValues, Mesh, NamedValues, ReadLimits, SurfaceOutput, VolumeOutput, WriteError, csv, glb,
    ply, read, stl,
};
use mechanics::mesh::{CellShape, Cells, Frame, TriangleSurface, Vector, VolumeMesh};

use crate::samples::{closed_surface, mixed_mesh, read_default, surface, volume};

#[test]
fn a_volume_mesh_written_as_vtu_reads_as_itself() {
    let mesh = mixed_mesh();
    for frame in [Frame::Lps, Frame::Ras, Frame::Unspecified] {
        let bytes = vtu::write(&VolumeOutput::plain(&mesh, frame)).unwrap();
        let back = read_default(&bytes);
        assert_eq!(back.frame, Some(frame));
        assert_eq!(back.ignored.names(), Vec::<String>::new());
        assert_eq!(back.warnings, []);
        assert_eq!(back.mesh, Mesh::Volume(mesh.clone()));
    }
}

#[test]
fn a_mesh_of_several_blocks_and_of_exactly_one_reads_as_itself() {
    // 2^18 bytes are a block: 32768 labels fill one exactly.
    for nodes in [32_768, 70_000] {
        let point = |node: u32| Vector::new(f64::from(node).sin(), f64::from(node).cos(), 0.1);
        let mut mesh =
            VolumeMesh { nodes: (0..nodes).map(point).collect(), ..VolumeMesh::default() };
        mesh.nodes[0..4].copy_from_slice(&[
            Vector::zeros(),
            Vector::x() * 100.0,
            Vector::y(),
            Vector::z(),
        ]);
        let mut cells = Cells::default();
        cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
        mesh.cells = cells;
        let labels = (0..i64::from(nodes)).map(|node| node % 60);
        mesh.node_labels.insert("tag".into(), labels.collect());
        let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Lps)).unwrap();
        assert_eq!(volume(read_default(&bytes)), mesh);
    }
}

#[test]
fn a_surface_written_as_vtp_or_ply_reads_as_itself() {
    let skin = closed_surface();
    let output = SurfaceOutput::plain(&skin, Frame::Ras);
    for bytes in [vtp::write(&output).unwrap(), ply::write(&output).unwrap()] {
        let back = read_default(&bytes);
        assert_eq!(back.frame, Some(Frame::Ras));
        assert_eq!(back.mesh, Mesh::Surface(skin.clone()));
    }
}

#[test]
fn a_surface_written_as_stl_reads_as_itself_rounded_to_32_bits() {
    let skin = closed_surface();
    let bytes = stl::write(&SurfaceOutput::plain(&skin, Frame::Lps)).unwrap();
    assert_eq!(bytes.len(), 84 + 50 * 4);
    let back = read_default(&bytes);
    assert_eq!(back.frame, Some(Frame::Lps));
    let back = surface(back);
    assert_eq!(back.node_ids, None);
    for triangle in 0..4 {
        let rounded = skin.corners(triangle).map(|c| c.map(|x| f64::from(x as f32)));
        assert_eq!(back.corners(triangle), rounded);
    }
}

#[test]
fn displaced_positions_and_results_stand_beside_what_the_mesh_had() {
    let mesh = mixed_mesh();
    let moved: Vec<Vector> = mesh.nodes.iter().map(|node| node * 1.01).collect();
    let displacement: Vec<Vector> = mesh.nodes.iter().map(|node| node * 0.01).collect();
    let det_f = [1.0, 0.99, 1.01];
    let replaced: Vec<Vector> = mesh.nodes.iter().map(|_| Vector::z()).collect();
    let output = VolumeOutput {
        mesh: &mesh,
        positions: &moved,
        frame: Frame::Lps,
        point_arrays: vec![
            NamedValues { name: "displacement_mm", values: ArrayValues::Vectors(&displacement) },
            NamedValues { name: "u_mm", values: ArrayValues::Vectors(&replaced) },
        ],
        cell_arrays: vec![NamedValues { name: "det_f", values: ArrayValues::Reals(&det_f) }],
        field_data: vec![("note".into(), "pas <un> dispositif médical".into())],
    };
    let back = read_default(&vtu::write(&output).unwrap());
    assert_eq!(back.ignored.names(), ["det_f"]);
    let back = volume(back);
    assert_eq!(back.nodes, moved);
    assert_eq!(back.node_vectors["displacement_mm"], displacement);
    assert_eq!(back.node_vectors["u_mm"], replaced);
    assert_eq!(back.node_sets, mesh.node_sets);
}

#[test]
fn csv_has_units_in_its_header_and_digits_that_give_the_same_number() {
    let skin = closed_surface();
    let displacement = [Vector::new(0.1, -1.0 / 3.0, 1e-300); 4];
    let output = SurfaceOutput {
        point_arrays: vec![
            NamedValues { name: "displacement_mm", values: ArrayValues::Vectors(&displacement) },
            NamedValues { name: "=HYPERLINK(1)", values: ArrayValues::Integers(&[1, 2, 3, 4]) },
        ],
        ..SurfaceOutput::plain(&skin, Frame::Lps)
    };
    let text = String::from_utf8(csv::write(&output).unwrap()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    assert_eq!(lines[0], "node_id,x_mm,y_mm,z_mm,ux_mm,uy_mm,uz_mm,'=HYPERLINK(1)");
    let last: Vec<&str> = lines[4].split(',').collect();
    assert_eq!(last[0], "17");
    assert_eq!(last[3].parse::<f64>().unwrap(), 100.0 / 3.0);
    assert_eq!(last[5].parse::<f64>().unwrap(), -1.0 / 3.0);
    assert_eq!(last[6].parse::<f64>().unwrap(), 1e-300);
    assert_eq!(last[7], "4");
}

#[test]
fn glb_holds_metres_with_exact_bounds_and_the_way_back() {
    let skin = closed_surface();
    let output = SurfaceOutput {
        colours: Some(&[[255, 0, 128]; 4]),
        ..SurfaceOutput::plain(&skin, Frame::Lps)
    };
    let bytes = glb::write(&output).unwrap();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
    let json_bytes = number(12);
    let scene: serde_json::Value = serde_json::from_slice(&bytes[20..20 + json_bytes]).unwrap();
    assert_eq!(scene["extras"]["frame"], "LPS");
    assert_eq!(scene["nodes"][0]["extras"], scene["extras"]);
    assert_eq!(
        scene["extras"]["matrix4x4_to_case_row_major"],
        serde_json::json!([
            1000.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1000.0, 0.0, 0.0, 1000.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            1.0
        ])
    );
    let position = &scene["accessors"][1];
    // z of 100/3 mm is up: y of glTF, in metres and 32 bits.
    let up = f64::from((100.0 / 3.0 / 1000.0) as f32);
    let found = position["max"][1].as_f64().unwrap();
    assert_eq!(found as f32, up as f32);
    assert_eq!(position["min"][2].as_f64().unwrap() as f32, -0.1_f32);
    let binary = 20 + json_bytes + 8;
    assert_eq!(scene["buffers"][0]["byteLength"], bytes.len() - binary);
    assert_eq!(scene["accessors"][0]["count"], 12);
}

#[test]
fn a_number_that_is_not_finite_is_never_written() {
    let skin = closed_surface();
    let values = [0.0, f64::NAN, f64::INFINITY, 1.0];
    let output = SurfaceOutput {
        point_arrays: vec![NamedValues {
            name: "signed_distance_mm",
            values: ArrayValues::Reals(&values),
        }],
        ..SurfaceOutput::plain(&skin, Frame::Lps)
    };
    let refused = Err(WriteError::NonFinite { array: "signed_distance_mm".into(), count: 2 });
    for write in [vtp::write, stl::write, ply::write, glb::write, csv::write] {
        assert_eq!(write(&output), refused);
    }
    let mesh = mixed_mesh();
    let moved = vec![Vector::repeat(f64::NAN); mesh.nodes.len()];
    let output = VolumeOutput { positions: &moved, ..VolumeOutput::plain(&mesh, Frame::Lps) };
    assert!(matches!(vtu::write(&output), Err(WriteError::NonFinite { count: 11, .. })));
}

#[test]
fn an_array_of_the_wrong_length_or_with_a_taken_name_is_not_written() {
    let skin = closed_surface();
    let array = |name, values| NamedValues { name, values: ArrayValues::Reals(values) };
    let with =
        |point_arrays| SurfaceOutput { point_arrays, ..SurfaceOutput::plain(&skin, Frame::Lps) };
    let short = with(vec![array("a", &[0.0; 3])]);
    assert!(matches!(vtp::write(&short), Err(WriteError::Length { have: 3, wanted: 4, .. })));
    let twice = with(vec![array("node_id", &[0.0; 4])]);
    assert!(matches!(ply::write(&twice), Err(WriteError::Duplicate { .. })));
}

#[test]
fn a_surface_without_triangles_is_not_written() {
    let nothing = TriangleSurface::default();
    let output = SurfaceOutput::plain(&nothing, Frame::Lps);
    for write in [vtp::write, stl::write, ply::write, glb::write, csv::write] {
        assert_eq!(write(&output), Err(WriteError::Empty));
    }
}

#[test]
fn names_of_people_do_not_survive_writing() {
    let header = b"Mustermann^Erika 1970 SPACE=LPS";
    let bytes = crate::samples::binary_stl(header, 1, &[crate::samples::TRIANGLE]);
    let mesh = read(&bytes, &ReadLimits::default()).unwrap();
    let (frame, skin) = (mesh.frame.unwrap(), surface(mesh));
    let stored = vtp::write(&SurfaceOutput::plain(&skin, frame)).unwrap();
    let text = String::from_utf8_lossy(&stored);
    assert!(!text.contains("Mustermann"));
    assert_eq!(read_default(&stored).frame, Some(Frame::Lps));
}
