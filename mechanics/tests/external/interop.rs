//! Files for other programs and files from them.
//!
//! `tests/interop/run` calls these tests with `FACIES_INTEROP` set to a folder: what is written to
//! `from_facies` is read there by vtk, meshio, trimesh and SimpleITK, and what these write to `from_others` is
//! read here. Every file has a plain JSON description beside it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{
    ArrayValues, Mesh, NamedValues, SurfaceOutput, VolumeInLps, VolumeOutput, csv, glb, ply, stl,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use mechanics::plan::RigidMovement;
use serde_json::{Value, json};

use crate::samples::{mixed_mesh, read_default};
use crate::support::external::{Missing, trials};
use crate::support::transforms;

trials! {
    samples_of_every_written_format_lie_ready_for_other_programs
    files_of_other_programs_hold_what_these_wrote
    transforms_of_other_programs_move_bone_back_along_their_own_way
    a_sample_file_reads_as_its_description
}

fn interop_folder() -> Option<PathBuf> {
    std::env::var_os("FACIES_INTEROP").map(PathBuf::from)
}

fn describe_volume(mesh: &VolumeMesh, frame: Frame) -> Value {
    let cells: Vec<Value> =
        mesh.cells.iter().map(|(shape, nodes)| json!([shape.name(), nodes])).collect();
    let named = |fields: &BTreeMap<String, Vec<Vector>>| -> BTreeMap<String, Value> {
        fields.iter().map(|(name, values)| (name.clone(), vectors(values))).collect()
    };
    json!({
        "frame": frame.name(),
        "points": vectors_of(&mesh.nodes),
        "cells": cells,
        "node_sets": mesh.node_sets,
        "cell_sets": mesh.cell_sets,
        "node_labels": mesh.node_labels,
        "cell_labels": mesh.cell_labels,
        "node_vectors": named(&mesh.node_vectors),
        "cell_vectors": named(&mesh.cell_vectors),
    })
}

fn vectors(values: &[Vector]) -> Value {
    json!(vectors_of(values))
}

fn vectors_of(values: &[Vector]) -> Vec<[f64; 3]> {
    values.iter().map(|value| [value.x, value.y, value.z]).collect()
}

fn describe_surface(surface: &TriangleSurface, frame: Frame) -> Value {
    json!({
        "frame": frame.name(),
        "points": vectors_of(&surface.points),
        "triangles": surface.triangles,
        "node_ids": surface.node_ids,
    })
}

fn put(folder: &Path, name: &str, bytes: &[u8]) {
    fs::write(folder.join(name), bytes).unwrap();
}

fn put_json(folder: &Path, name: &str, value: &Value) {
    put(folder, name, &serde_json::to_vec_pretty(value).unwrap());
}

fn samples_of_every_written_format_lie_ready_for_other_programs() {
    let temporary = || PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("interop");
    let folder = interop_folder().unwrap_or_else(temporary).join("from_facies");
    fs::create_dir_all(&folder).unwrap();
    put_volumes(&folder);
    put_surfaces(&folder);
    put_movement(&folder);
    let count = fs::read_dir(&folder).unwrap().count();
    assert!(count >= 10, "{count} files");
}

fn put_volumes(folder: &Path) {
    let mesh = mixed_mesh();
    for frame in [Frame::Lps, Frame::Ras] {
        let written = VolumeInLps::new(&mesh, frame);
        let plain = VolumeOutput::plain(&written.mesh, written.frame);
        let stem = format!("mixed_{}", frame.name());
        put(folder, &format!("{stem}.vtu"), &vtu::write(&plain).unwrap());
        let mut description = describe_volume(&written.mesh, written.frame);
        description["in_case"] = json!({"frame": frame.name(), "points": vectors(&mesh.nodes)});
        put_json(folder, &format!("{stem}.json"), &description);
    }

    let displacement: Vec<Vector> = mesh.nodes.iter().map(|node| node * 0.01).collect();
    let positions: Vec<Vector> = mesh.nodes.iter().map(|node| node * 1.01).collect();
    let node_id: Vec<i64> = (0..mesh.nodes.len() as i64).collect();
    let output = VolumeOutput {
        positions: &positions,
        point_arrays: vec![
            NamedValues { name: "displacement_mm", values: ArrayValues::Vectors(&displacement) },
            NamedValues { name: "node_id", values: ArrayValues::Integers(&node_id) },
        ],
        cell_arrays: vec![NamedValues {
            name: "det_f",
            values: ArrayValues::Reals(&[1.0, 0.99, 1.0 / 3.0]),
        }],
        field_data: vec![("provenance".into(), "{\"modèle\": \"fem_linear\"}".into())],
        ..VolumeOutput::plain(&mesh, Frame::Unspecified)
    };
    put(folder, "result.vtu", &vtu::write(&output).unwrap());
    let mut description = describe_volume(&mesh, Frame::Unspecified);
    description["points"] = vectors(&positions);
    description["point_arrays"] =
        json!({"displacement_mm": vectors(&displacement), "node_id": node_id});
    description["cell_arrays"] = json!({"det_f": [1.0, 0.99, 1.0 / 3.0]});
    description["field_data"] = json!({"provenance": "{\"modèle\": \"fem_linear\"}"});
    put_json(folder, "result.json", &description);
}

fn put_surfaces(folder: &Path) {
    let mesh = mixed_mesh();
    let skin = mesh.surface_of(&mesh.boundary_faces());
    let displacement: Vec<Vector> = skin.points.iter().map(|point| point / 7.0).collect();
    let magnitude: Vec<f64> = displacement.iter().map(Vector::norm).collect();
    let side: Vec<i64> = (0..skin.points.len() as i64).map(|point| point % 3 - 1).collect();
    let colours: Vec<[u8; 3]> =
        (0..skin.points.len() as u8).map(|point| [point * 20, 255 - point, 7]).collect();
    for frame in [Frame::Lps, Frame::Ras] {
        let output = SurfaceOutput {
            point_arrays: vec![
                NamedValues {
                    name: "displacement_mm",
                    values: ArrayValues::Vectors(&displacement),
                },
                NamedValues {
                    name: "displacement_magnitude_mm",
                    values: ArrayValues::Reals(&magnitude),
                },
                NamedValues { name: "side", values: ArrayValues::Integers(&side) },
            ],
            colours: Some(&colours),
            field_data: vec![("provenance".into(), "{\"modèle\": \"fem_linear\"}".into())],
            ..SurfaceOutput::plain(&skin, frame)
        };
        let stem = format!("skin_{}", frame.name());
        put(folder, &format!("{stem}.vtp"), &vtp::write(&output).unwrap());
        put(folder, &format!("{stem}.stl"), &stl::write(&output).unwrap());
        put(folder, &format!("{stem}.ply"), &ply::write(&output).unwrap());
        put(folder, &format!("{stem}.glb"), &glb::write(&output).unwrap());
        put(folder, &format!("{stem}.csv"), &csv::write(&output).unwrap());
        let mut description = describe_surface(&skin, frame);
        description["point_arrays"] = json!({
            "displacement_mm": vectors(&displacement),
            "displacement_magnitude_mm": magnitude,
            "side": side,
        });
        description["colours"] = json!(colours);
        description["field_data"] = json!({"provenance": "{\"modèle\": \"fem_linear\"}"});
        put_json(folder, &format!("{stem}.json"), &description);
    }
}

/// A movement of bone for navigation: where it takes some places, and the files that are to say so.
fn put_movement(folder: &Path) {
    let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
    let pivot = Vector::new(3.0, 40.0, -50.0);
    let movement = RigidMovement::about_pivot(angles, pivot, Vector::new(6.5, -3.7, 5.0));
    let places = [[10.0, -12.0, 20.0], [-31.0, 4.5, -7.0], [0.0; 3]].map(Vector::from);
    let moved: Vec<Vector> = places.iter().map(|at| movement.apply(at)).collect();
    put(folder, "movement.tfm", movement.to_itk_text("mandible").as_bytes());
    put(folder, "movement.txt", movement.to_matrix_text("mandible").as_bytes());
    let description = json!({
        "matrix4x4": movement.matrix4(),
        "places": vectors_of(&places),
        "moved": vectors_of(&moved),
    });
    put_json(folder, "movement.json", &description);
}

/// The folder of what other programs wrote, and one of its lists.
fn from_others(list: &str) -> Result<(PathBuf, Vec<Value>), Missing> {
    let why = "FACIES_INTEROP is not set; tests/interop/run sets it".to_owned();
    let folder = interop_folder().ok_or(Missing { why, required_by: None })?.join("from_others");
    let list = serde_json::from_slice(&fs::read(folder.join(list)).unwrap()).unwrap();
    Ok((folder, list))
}

/// Who resamples goes from where bone came to back to where it was, and what is read moves bone.
fn transforms_of_other_programs_move_bone_back_along_their_own_way() -> Result<(), Missing> {
    let (folder, list) = from_others("movements.json")?;
    assert!(list.len() >= 3, "{} files", list.len());
    for expected in list {
        let file = expected["file"].as_str().unwrap();
        let text = fs::read_to_string(folder.join(file)).unwrap();
        let movement = transforms::of_itk_text(&text);
        let places = |name: &str| -> Vec<[f64; 3]> {
            serde_json::from_value(expected[name].clone()).unwrap()
        };
        for (at, moved) in places("places").into_iter().zip(places("moved")) {
            let off = movement.apply(&Vector::from(at)) - Vector::from(moved);
            assert!(off.norm() < 1e-11, "{file}: {off}");
        }
    }
    Ok(())
}

fn files_of_other_programs_hold_what_these_wrote() -> Result<(), Missing> {
    let (folder, list) = from_others("list.json")?;
    assert!(list.len() > 50, "{} files", list.len());
    for expected in list {
        let file = expected["file"].as_str().unwrap();
        let bytes = fs::read(folder.join(file)).unwrap();
        let found = mechanics::format::read(&bytes, &Default::default());
        let read = found.unwrap_or_else(|error| panic!("{file}: {error}"));
        let frame = read.frame;
        let description = match read.mesh {
            Mesh::Volume(mesh) => describe_volume(&mesh, Frame::Unspecified),
            Mesh::Surface(surface) => describe_surface(&surface, Frame::Unspecified),
            Mesh::Image(_) => panic!("an image among the meshes"),
        };
        for (key, wanted) in expected["mesh"].as_object().unwrap() {
            let tolerance = expected["tolerance"].as_f64().unwrap();
            let found = match key.as_str() {
                "frame" => json!(frame.map(Frame::name)),
                key => description[key].clone(),
            };
            assert!(
                is_equal(wanted, &found, tolerance),
                "{file}, {key}: {wanted} written, {found} read"
            );
        }
    }
    Ok(())
}

/// Equal, numbers up to a part of themselves.
fn is_equal(wanted: &Value, found: &Value, tolerance: f64) -> bool {
    match (wanted, found) {
        (Value::Number(wanted), Value::Number(found)) => {
            let (wanted_real, found_real) = (wanted.as_f64().unwrap(), found.as_f64().unwrap());
            wanted.as_i64().is_some() && wanted.as_i64() == found.as_i64()
                || (wanted_real - found_real).abs() <= tolerance * wanted_real.abs()
        }
        (Value::Array(wanted), Value::Array(found)) => {
            wanted.len() == found.len()
                && wanted.iter().zip(found).all(|(one, other)| is_equal(one, other, tolerance))
        }
        (Value::Object(wanted), Value::Object(found)) => {
            wanted.len() == found.len()
                && wanted.iter().all(|(key, value)| {
                    found.get(key).is_some_and(|other| is_equal(value, other, tolerance))
                })
        }
        _ => wanted == found,
    }
}

fn a_sample_file_reads_as_its_description() {
    let mesh = mixed_mesh();
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Lps)).unwrap();
    let Mesh::Volume(back) = read_default(&bytes).mesh else {
        panic!("a surface was read");
    };
    let description = describe_volume(&mesh, Frame::Lps);
    assert!(is_equal(&description, &describe_volume(&back, Frame::Lps), 0.0));
    let mut other = back;
    other.nodes[3].y *= 1.0 + 1e-15;
    assert!(!is_equal(&description, &describe_volume(&other, Frame::Lps), 0.0));
}
