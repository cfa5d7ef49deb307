//! The example of a head: its files are what the program makes, and its pictures show a face.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput, nrrd};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::half_head::{HalfHead, half_head};
use mechanics::mesh::{Frame, Vector};

use crate::program::{block, facies, path, result, text};

/// 6912 tetrahedra.
const FINENESS: usize = 2;
/// Makes the files anew instead of comparing them.
const WRITE: &str = "FACIES_WRITE_EXAMPLES";

fn head() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/head")
}

/// Air, and tissue in shells around the middle of the head: bone, muscle and fat.
fn ct(low: Vector, high: Vector) -> Vec<u8> {
    const STEP_MM: f64 = 8.0;
    let size = ((high - low) / STEP_MM).map(|steps| steps.ceil() as usize + 3);
    let origin = low - Vector::repeat(STEP_MM);
    let middle = Vector::new(0.0, high.y, (low.z + high.z) / 2.0);
    let reach = (high - middle).component_mul(&Vector::new(1.0, 0.0, 1.0));
    let reach = Vector::new(reach.x, middle.y - low.y, reach.z);
    let mut values = Vec::new();
    for k in 0..size.z {
        for j in 0..size.y {
            for i in 0..size.x {
                let at = origin + Vector::new(i as f64, j as f64, k as f64) * STEP_MM - middle;
                values.push(match at.component_div(&reach).norm() {
                    depth if depth < 0.65 => 400,
                    depth if depth < 0.8 => 50,
                    depth if depth < 1.1 => -90,
                    _ => -1000,
                });
            }
        }
    }
    let steps = [Vector::x() * STEP_MM, Vector::y() * STEP_MM, Vector::z() * STEP_MM];
    let size = [size.x, size.y, size.z];
    let image = ImageVolume::new(size, Placement { origin, steps }, Voxels::I16(values)).unwrap();
    nrrd::write(&image, Frame::Lps)
}

/// The head, whose skin is what nothing holds: the cut through the head is none.
fn free_head() -> HalfHead {
    let mut head = half_head(FINENESS);
    let sets = &mut head.mesh.node_sets;
    let held: BTreeSet<u32> = ["rim", "skull"].iter().flat_map(|set| sets[*set].clone()).collect();
    sets.get_mut("skin").unwrap().retain(|node| !held.contains(node));
    head
}

fn files() -> Vec<(String, Vec<u8>)> {
    let head = free_head();
    let nodes = &head.mesh.nodes;
    let (low, high) = nodes
        .iter()
        .fold((nodes[0], nodes[0]), |(low, high), node| (low.inf(node), high.sup(node)));
    let volume = vtu::write(&VolumeOutput::plain(&head.mesh, Frame::Lps)).unwrap();
    let mut files = vec![("face.vtu".to_owned(), volume), ("ct.nrrd".to_owned(), ct(low, high))];
    for bone in ["mandible", "maxilla"] {
        let surface = SurfaceOutput::plain(&head.bones[bone], Frame::Lps);
        files.push((format!("{bone}.vtp"), vtp::write(&surface).unwrap()));
    }
    files
}

#[test]
fn the_meshes_of_the_head_are_those_that_the_program_makes() {
    for (name, bytes) in files() {
        let path = head().join(&name);
        if std::env::var_os(WRITE).is_some() {
            fs::write(&path, &bytes).unwrap();
        }
        let there = fs::read(&path).unwrap_or_default();
        assert!(there == bytes, "make {name} anew: {WRITE}=1 cargo test --test command head");
    }
}

#[test]
fn the_head_of_the_front_page_is_predicted_with_no_warning_but_that_of_its_coarse_mesh() {
    let out = tempfile::tempdir().unwrap();
    let (case, mesh, plan) =
        (head().join("case.json"), head().join("face.vtu"), head().join("plan.json"));
    let of_mesh = [
        "--mesh",
        path(&mesh),
        "--fixed",
        "skull",
        "--fixed",
        "rim",
        "--skin",
        "skin",
        "--frame",
        "LPS",
        "--young-modulus-kpa",
        "15",
        "--poisson-ratio",
        "0.45",
        "--plan",
        path(&plan),
    ];
    let expected = ["tolerance-not-met", "numerical-error-large"];
    for scene in [&["--case", path(&case)][..], &of_mesh] {
        let done = facies(&[&["predict"], scene, &["--out", path(out.path())]].concat());
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        let warnings = result(out.path()).warnings;
        let told: Vec<&str> = warnings.iter().map(|warning| warning.code.as_str()).collect();
        assert_eq!(told, expected, "{scene:?}");
    }
}

/// The pixels of the pictures in an SVG file, and how many of them are not background.
fn drawn(svg: &str) -> Vec<f64> {
    use base64::Engine;
    let images = svg.split("data:image/png;base64,").skip(1);
    let share = |image: &str| {
        let bytes = image.split('"').next().unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        let length = frame.color_type.samples();
        let pixels: Vec<&[u8]> = pixels[..frame.buffer_size()].chunks(length).collect();
        let drawn = pixels.iter().filter(|pixel| *pixel != &pixels[0]).count();
        drawn as f64 / pixels.len() as f64
    };
    images.map(share).collect()
}

#[test]
fn no_panel_of_the_pictures_of_an_example_is_empty() {
    for example in [head(), block()] {
        let out = tempfile::tempdir().unwrap();
        let case = example.join("case.json");
        let done = facies(&["predict", "--case", path(&case), "--out", path(out.path())]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        for picture in ["classes.svg", "displacement.svg"] {
            let shares = drawn(&fs::read_to_string(out.path().join(picture)).unwrap());
            let place = format!("{} {picture}", example.display());
            assert!(!shares.is_empty(), "{place}");
            assert!(shares.iter().all(|share| *share > 0.02), "{place}: {shares:?}");
        }
    }
}
