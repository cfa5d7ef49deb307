//! Integer arrays with many values: they are regions, or whoever asks for them is told why not.

use bytes::Bytes;
use facies::library::mesh_report::mesh_report;
use facies::library::meshes::parse_stored;
use facies::library::upload::{Statement, read_upload};
use facies::schema::Limits;
use mechanics::boundary::NodeSelection;
use mechanics::format::vtk::vtu;
use mechanics::format::{Mesh, ReadLimits, ReadMesh, VolumeOutput, read};
use mechanics::mesh::sample::block;
use mechanics::mesh::{ArrayUse, CellShape, Frame, Vector, VolumeMesh};
use mechanics::prediction::{Plan, RegionNames, Scene, SceneError, Settings};

use crate::samples::{TETRAHEDRON, ascii_vtu, surface, volume};
use crate::scenes::{case_of, material, set};

const SMALL: [usize; 3] = [5, 5, 5];

/// A block of hexahedra whose cells and nodes are numbered in the arrays `ids`.
fn numbered(cells: [usize; 3]) -> VolumeMesh {
    let mut mesh = block(Vector::new(100.0, 100.0, 100.0), cells, CellShape::Hex8);
    mesh.cell_labels.insert("ids".to_owned(), (0..mesh.cells.len() as i64).collect());
    mesh.node_labels.insert("ids".to_owned(), (0..mesh.nodes.len() as i64).collect());
    mesh
}

fn file_of(mesh: &VolumeMesh) -> Vec<u8> {
    vtu::write(&VolumeOutput::plain(mesh, Frame::Lps)).unwrap()
}

/// The file as a reader takes it that keeps arrays of at most so many values.
fn read_with(bytes: &[u8], label_values: u64) -> ReadMesh {
    read(bytes, &ReadLimits { label_values, ..ReadLimits::default() }).unwrap()
}

/// What is wrong with a case whose regions and whose fixed nodes are those of the arrays `ids`.
fn problems(mesh: VolumeMesh) -> Vec<SceneError> {
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.regions = Some(RegionNames { array: "ids".to_owned(), names: [].into() });
    case.fixed = vec![set("z_min"), NodeSelection::Label { array: "ids".to_owned(), value: 1 }];
    Scene::new(&case, &Plan::default(), &Settings::default())
        .map_or_else(|errors| errors.0, |_| vec![])
}

fn details(problems: Vec<SceneError>) -> Vec<(&'static str, String)> {
    problems.into_iter().map(|problem| (problem.code.name(), problem.detail)).collect()
}

fn both_ignored(most: u64) -> Vec<(&'static str, String)> {
    let why = |of: &str, distinct: u64, what: &str| {
        let detail = format!(
            "the {of} array \"ids\" holds {distinct} distinct values, at most {most} make {what}"
        );
        ("unknown-array", detail)
    };
    vec![why("cell", 125, "regions"), why("point", 216, "labels")]
}

#[test]
fn a_map_of_125_classes_makes_as_many_regions() {
    let mesh = volume(read_with(&file_of(&numbered(SMALL)), ReadLimits::default().label_values));
    assert_eq!(mesh.ignored.names(), Vec::<String>::new());
    let mut case = case_of(mesh, material(15.0, 0.3));
    let names = [(7, "muscle".to_owned()), (100, "muscle".to_owned())];
    case.regions = Some(RegionNames { array: "ids".to_owned(), names: names.into() });
    case.fixed = vec![set("z_min")];
    let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
    assert_eq!(scene.regions.len(), 124);
    let called = |cell: usize| scene.regions[scene.region_of_cell[cell] as usize].as_str();
    assert_eq!(
        [called(7), called(100), called(101), called(124)],
        ["muscle", "muscle", "101", "124"]
    );
}

#[test]
fn as_many_values_as_the_published_limit_are_kept_and_one_more_is_not() {
    let most = Limits::default().label_values;
    assert_eq!(u64::from(most), ReadLimits::default().label_values);
    let kept = |values: i64| {
        let mut mesh = block(Vector::new(100.0, 100.0, 100.0), [17, 17, 17], CellShape::Hex8);
        let labels = (0..mesh.cells.len() as i64).map(|cell| (cell * 7919) % values).collect();
        mesh.cell_labels.insert("ids".to_owned(), labels);
        volume(read(&file_of(&mesh), &ReadLimits::default()).unwrap())
            .cell_labels
            .contains_key("ids")
    };
    assert_eq!([kept(i64::from(most)), kept(i64::from(most) + 1)], [true, false]);
}

#[test]
fn a_selection_of_an_array_with_too_many_values_is_told_how_many_it_has() {
    let mesh = volume(read_with(&file_of(&numbered(SMALL)), 124));
    assert_eq!(details(problems(mesh)), both_ignored(124));
}

#[test]
fn an_array_that_no_file_had_is_told_from_one_that_was_ignored() {
    let problems =
        details(problems(block(Vector::new(100.0, 100.0, 100.0), SMALL, CellShape::Hex8)));
    let none = "the mesh has no integer cell array \"ids\"; it has none";
    assert_eq!(problems[0], ("unknown-array", none.to_owned()));
}

#[test]
fn an_array_of_vectors_that_is_asked_for_labels_is_told_for_what_it_is() {
    let mut mesh = block(Vector::new(100.0, 100.0, 100.0), SMALL, CellShape::Hex8);
    mesh.cell_vectors.insert("ids".to_owned(), vec![Vector::x(); mesh.cells.len()]);
    let none =
        "the mesh has no integer cell array \"ids\": \"ids\" holds vectors of cells; it has none";
    assert_eq!(details(problems(mesh))[0], ("unknown-array", none.to_owned()));
}

#[test]
fn a_mesh_that_was_stored_still_says_what_its_file_had() {
    let first = volume(read_with(&file_of(&numbered(SMALL)), 124));
    let again = volume(read(&file_of(&first), &ReadLimits::default()).unwrap());
    assert_eq!(again, first);
    assert_eq!(details(problems(again)), both_ignored(124));
}

#[test]
fn an_upload_reports_why_and_its_stored_form_keeps_it() {
    let bytes = Bytes::from(file_of(&numbered([17, 17, 17])));
    let upload = read_upload(&bytes, "sha".to_owned(), &Statement::default(), true).ok().unwrap();
    let report = serde_json::to_value(&upload.document.report).unwrap();
    assert_eq!(report["ignored_arrays"], serde_json::json!(["ids", "ids"]));
    let why = "holds 4913 distinct values, at most 4096 make regions";
    let cells = serde_json::json!({ "name": "ids", "of": "cell", "why": why });
    assert_eq!(report["ignored_because"][1], cells);
    let Mesh::Volume(stored) = parse_stored(&upload.row.bytes).unwrap().mesh else { panic!() };
    assert_eq!(stored.ignored.listed[1].why, why);
}

#[test]
fn bytes_that_an_earlier_bound_was_applied_to_are_another_mesh() {
    let identity = Statement::default().identity();
    assert!(identity.contains(&ReadLimits::default().label_values.to_string()), "{identity}");
}

#[test]
fn every_ignored_array_has_its_reason() {
    let array = |kind: &str, attributes: &str, text: &str| {
        format!("<DataArray type=\"{kind}\" {attributes} format=\"ascii\">{text}</DataArray>")
    };
    let more = [
        "<PointData>".to_owned(),
        array("Float32", "Name=\"real\"", "1 2 3 4"),
        array("Int32", "Name=\"pair\" NumberOfComponents=\"2\"", "1 2 3 4 5 6 7 8"),
        array("Float32", "Name=\"plane\" NumberOfComponents=\"2\"", "1 2 3 4 5 6 7 8"),
        array("Float32", "Name=\"nan\" NumberOfComponents=\"3\"", "nan 2 3 4 5 6 7 8 9 1 2 3"),
        array("Int32", "Name=\" \"", "1 2 3 4"),
        array("Int32", "Name=\"node_id\"", "1 2 3 4"),
        array("Bit", "Name=\"bits\"", "1 0 1 0"),
        "</PointData>".to_owned(),
    ];
    let whys = |cells: &[(u8, &[u32])]| {
        let bytes = ascii_vtu(&TETRAHEDRON, cells, &more.concat());
        let read = read(bytes.as_bytes(), &ReadLimits::default()).unwrap();
        let sentences: Vec<String> = read.ignored.listed.iter().map(ToString::to_string).collect();
        (sentences.join("\n"), read)
    };
    let of_a_volume = "the point array \"real\" holds floating-point numbers, not integers\n\
        the point array \"pair\" holds 2 integers each, and labels are one\n\
        the point array \"plane\" holds 2 floating-point numbers each, and vectors are three\n\
        the point array \"\" has no name\n\
        the point array \"bits\" holds neither integers nor floating-point numbers\n\
        the point array \"nan\" holds values that are not finite\n\
        the point array \"node_id\" numbers the nodes";
    assert_eq!(whys(&[(10, &[0, 1, 2, 3])]).0, of_a_volume);
    let (sentences, read) = whys(&[(5, &[0, 1, 2])]);
    assert!(sentences.contains("the point array \"nan\" belongs to a surface"), "{sentences}");
    assert_eq!(surface(read).node_ids, Some(vec![1, 2, 3, 4]));
}

#[test]
fn arrays_beyond_a_hundred_are_counted_and_the_report_lists_no_more() {
    let mut more = "<PointData>".to_owned();
    for number in 0..150 {
        more += &format!(
            "<DataArray type=\"Float32\" Name=\"t{number}\" format=\"ascii\">1 2 3 4</DataArray>"
        );
    }
    let bytes = ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], &(more + "</PointData>"));
    let report = mesh_report(&read(bytes.as_bytes(), &ReadLimits::default()).unwrap());
    assert_eq!(report.ignored_because.len(), 100);
    assert_eq!(report.ignored_arrays.len(), 101);
    assert_eq!(report.ignored_arrays[100], "and 50 more");
}

#[test]
fn the_label_arrays_of_a_file_hold_no_more_values_together_than_a_report_can_list() {
    let mut mesh = block(Vector::new(100.0, 100.0, 100.0), SMALL, CellShape::Hex8);
    for number in 0..20 {
        mesh.cell_labels.insert(format!("ids {number:02}"), (0..125).collect());
    }
    let mesh = volume(read_with(&file_of(&mesh), 125));
    assert_eq!((mesh.cell_labels.len(), mesh.ignored.listed.len()), (16, 4));
    let why = "the cell array \"ids 16\" is one too many: with it the label arrays hold 2125 distinct \
        values, at most 2000 are kept";
    assert_eq!(mesh.ignored.listed[0].to_string(), why);
}

#[test]
fn more_regions_than_are_numbered_are_refused_and_none_is_taken_for_another() {
    let mut mesh = block(Vector::new(100.0, 100.0, 100.0), [33, 32, 32], CellShape::Hex8);
    mesh.cell_labels.insert("ids".to_owned(), (0..mesh.cells.len() as i64).collect());
    let problems = details(problems(mesh));
    let detail = "33792 regions; at most 32768 are distinguished".to_owned();
    assert_eq!(problems[0], ("too-many-regions", detail));
}

/// What is said of a fixed set that is not there.
fn of_a_missing_set(mesh: VolumeMesh, name: &str) -> String {
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed = vec![set(name)];
    let found = Scene::new(&case, &Plan::default(), &Settings::default());
    details(found.map_or_else(|errors| errors.0, |_| vec![]))[0].1.clone()
}

#[test]
fn a_set_that_is_not_there_is_answered_with_the_arrays_that_are_and_how_they_select() {
    let mut mesh = block(Vector::new(100.0, 100.0, 100.0), SMALL, CellShape::Hex8);
    mesh.node_sets.clear();
    let none = of_a_missing_set(mesh.clone(), "skull");
    assert!(none.contains("it has none; an integer point array `set_NAME` makes one"), "{none}");
    let labels = (0..mesh.nodes.len() as i64).map(|node| node % 3);
    mesh.node_labels.insert("tag".to_owned(), labels.collect());
    let other = of_a_missing_set(mesh.clone(), "skull");
    assert!(other.contains("it has none; its integer point arrays"), "{other}");
    assert!(other.ends_with("select nodes by `array` with `value`: tag"), "{other}");
    let array = of_a_missing_set(mesh.clone(), "tag");
    assert!(array.ends_with("by `array` with `value`, one of 0, 1, 2"), "{array}");
    mesh.node_sets.insert("side".to_owned(), vec![0]);
    let set = mesh.missing_array(ArrayUse::PointLabels, "set_side");
    assert!(set.ends_with("as the node set \"side\": select it by `node_set`"), "{set}");
}
