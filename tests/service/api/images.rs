//! Images: kept in the library of meshes, used by cases, erased with them.

use mechanics::format::{Mesh, ReadLimits, nrrd, read};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::{Frame, Vector};
use reqwest::StatusCode;
use reqwest::multipart::Part;
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask, spec};
use crate::samples::scans::{Coding, dicom_slices, one_of_each, series, small_scan};
use crate::samples::{NRRD, VOXELS, nrrd as file};

fn sample() -> Vec<u8> {
    file(NRRD, &VOXELS.map(i16::to_le_bytes).concat())
}

/// Around the block of the tests: `low` HU up to x = 30 and 100 HU beyond.
fn around_the_block(low: i16) -> Vec<u8> {
    let placement = Placement {
        origin: Vector::new(-0.5, -1.0, -1.0),
        steps: [Vector::x(), Vector::y() * 62.0, Vector::z() * 32.0],
    };
    let values = (0..62 * 4).map(|n| if n % 62 > 30 { 100 } else { low }).collect();
    let image = ImageVolume::new([62, 2, 2], placement, Voxels::I16(values)).unwrap();
    nrrd::write(&image, Frame::Unspecified)
}

fn case() -> Value {
    let mut case = SMALL.case();
    case["hounsfield"] = json!({"image": "ct", "samples": 8, "tissues": [
        {"name": "muscle", "from_hu": 50, "to_hu": 150,
         "material": {"young_modulus_kpa": 300, "poisson_ratio": 0.4}}]});
    case
}

#[tokio::test]
async fn an_image_is_reported_and_comes_back_without_the_name_of_the_patient() {
    let server = Server::start();
    let request = server.post("/v1/meshes").header("content-type", "application/x-nrrd");
    let image = ask(request.body(sample())).await.expect(StatusCode::CREATED);
    assert_eq!((&image["format"], &image["report"]["kind"]), (&json!("nrrd"), &json!("image")));
    assert_eq!(image["report"]["space"], "LPS");
    let report = &image["report"]["image"];
    assert_eq!(
        (&report["size"], &report["spacing_mm"]),
        (&json!([3, 2, 4]), &json!([30.0, 40.0, 20.0]))
    );
    assert_eq!((&report["lowest_hu"], &report["highest_hu"]), (&json!(-1000.0), &json!(3000.0)));
    let id = image["id"].as_str().unwrap();
    assert_eq!(server.upload(sample()).await.expect(StatusCode::OK)["id"], id);

    let content = format!("/v1/meshes/{id}/content");
    let answer = ask(server.get(&content)).await;
    assert_eq!(answer.header("content-type"), "application/x-nrrd");
    assert!(!String::from_utf8_lossy(&answer.bytes).contains("Jane"));
    let again = read(&answer.bytes, &ReadLimits::default()).unwrap();
    let Mesh::Image(again) = again.mesh else { panic!("an image was expected") };
    assert_eq!(*again.voxels(), Voxels::I16(VOXELS.to_vec()));
    for format in ["vtu", "vtp", "stl", "ply"] {
        let answer = ask(server.get(&format!("{content}?format={format}"))).await;
        answer.problem(422, "format-not-available");
    }
    let mesh = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let mesh = mesh["id"].as_str().unwrap();
    let answer = ask(server.get(&format!("/v1/meshes/{mesh}/content?format=nrrd"))).await;
    answer.problem(422, "format-not-available");
}

#[tokio::test]
async fn scans_of_every_format_come_through_the_same_door_and_are_kept_without_names() {
    let server = Server::start();
    for (name, bytes) in one_of_each() {
        let kind = match name.split(' ').next().unwrap() {
            "nifti" => "application/x-nifti",
            "metaimage" => "application/x-metaimage",
            _ => "application/zip",
        };
        let request = server.post("/v1/meshes").header("content-type", kind).body(bytes);
        let scan = ask(request).await.expect(StatusCode::CREATED);
        assert_eq!(scan["report"]["kind"], "image", "{name}");
        assert_eq!(scan["report"]["image"]["spacing_mm"][2], 2.5, "{name}: {scan}");
        assert!(name.starts_with(scan["format"].as_str().unwrap()), "{name}: {scan}");
        let id = scan["id"].as_str().unwrap();
        let kept = ask(server.get(&format!("/v1/meshes/{id}/content"))).await;
        assert_eq!(kept.header("content-type"), "application/x-nrrd");
        let kept = read(&kept.bytes, &ReadLimits::default()).unwrap();
        let Mesh::Image(kept) = kept.mesh else { panic!("an image was expected") };
        let Voxels::I16(values) = kept.voxels() else { panic!("16 bits were expected") };
        assert!(small_scan().values.starts_with(values), "{name}");
    }
}

#[tokio::test]
async fn a_series_that_is_no_image_is_refused_with_its_numbers_and_without_names() {
    let server = Server::start();
    let mut slices = dicom_slices(&small_scan(), Coding::Explicit);
    slices[3].position[2] += 10.0;
    slices.remove(1);
    let problem = server.upload(series(&slices)).await.problem(422, "mesh-parse");
    assert_eq!(problem["format"], "DICOM");
    let detail = problem["detail"].as_str().unwrap();
    assert!(
        detail.contains("slices are missing") || detail.contains("not evenly spaced"),
        "{detail}"
    );
    assert!(!problem.to_string().contains("Roe"), "{problem}");
    slices.iter_mut().for_each(|slice| slice.syntax = Some("1.2.840.10008.1.2.4.90"));
    let problem = server.upload(series(&slices)).await.problem(422, "mesh-parse");
    assert!(problem["detail"].as_str().unwrap().contains("JPEG 2000 Lossless"), "{problem}");
}

#[tokio::test]
async fn a_case_comes_with_its_image_and_takes_it_along_when_it_is_erased() {
    let server = Server::start();
    let form = |low| SMALL.form(&case()).part("ct", Part::bytes(around_the_block(low)));
    let kept = ask(server.post("/v1/cases").multipart(form(0))).await.expect(StatusCode::CREATED);
    let muscle = &kept["check"]["imaged"]["tissues"]["muscle"];
    assert_eq!((&muscle["cells"], &muscle["volume_share"]), (&json!(32), &json!(0.5)));
    let id = kept["id"].as_str().unwrap();
    let image = kept["case"]["hounsfield"]["image"].as_str().unwrap();
    ask(server.get(&format!("/v1/meshes/{image}"))).await.expect(StatusCode::OK);
    ask(server.delete(&format!("/v1/meshes/{image}"))).await.problem(409, "conflict-in-use");

    let job = server.job(&spec(id, 2.0)).await.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    assert_eq!(job["results"]["statistics"]["imaged"]["tissues"]["muscle"]["cells"], 32);
    // Another image is another job, and another response.
    let other = ask(server.post("/v1/cases").multipart(form(60))).await.expect(StatusCode::CREATED);
    let stiffer =
        server.job(&spec(other["id"].as_str().unwrap(), 2.0)).await.expect(StatusCode::OK);
    assert_ne!(stiffer["spec_hash"], job["spec_hash"]);
    let moved =
        |job: &Value| job["results"]["statistics"]["skin"]["nodes"]["mean"].as_f64().unwrap();
    assert!((moved(&stiffer) - moved(&job)).abs() > 1e-6, "half of it is softer");

    let response =
        server.job(&json!({"kind": "response", "case": id})).await.expect(StatusCode::OK);
    assert_eq!(response["status"], "successful", "{response}");
    let plan = json!({"plan": {"segments": [{"name": "bone", "translation_mm": [2, 0, 0]}]}});
    let applied = ask(server.post(&format!("/v1/cases/{id}/response/apply")).json(&plan)).await;
    let applied = applied.expect(StatusCode::OK);
    // A response carries single precision.
    let (largest, of_job) =
        (&applied["max_mm"], &job["results"]["statistics"]["skin"]["nodes"]["max"]);
    assert!(
        (largest.as_f64().unwrap() - of_job.as_f64().unwrap()).abs() < 1e-4,
        "{largest} {of_job}"
    );

    let erased = server.delete(&format!("/v1/cases/{id}")).header("if-match", "\"1\"");
    assert_eq!(ask(erased).await.status, StatusCode::NO_CONTENT);
    ask(server.get(&format!("/v1/meshes/{image}"))).await.problem(410, "gone");
}

#[tokio::test]
async fn an_image_that_comes_with_a_case_does_not_take_its_frame_for_its_own() {
    let server = Server::start();
    let told = async |case: Value, image: Option<Part>| {
        let form = SMALL.form(&case);
        let form = match image {
            Some(image) => form.part("ct", image),
            None => form,
        };
        let kept = ask(server.post("/v1/cases").multipart(form)).await.expect(StatusCode::CREATED);
        let warnings = kept["check"]["warnings"].as_array().unwrap().clone();
        warnings.iter().filter(|told| told["code"] == "image-place-doubtful").count()
    };
    let mut marked = case();
    marked["frame"] = json!("LPS");
    assert_eq!(told(marked.clone(), Some(Part::bytes(around_the_block(0)))).await, 1);
    let request = server.post("/v1/meshes?frame=LPS").header("content-type", "application/x-nrrd");
    let image = ask(request.body(around_the_block(0))).await.expect(StatusCode::CREATED);
    marked["hounsfield"]["image"] = image["id"].clone();
    assert_eq!(told(marked, None).await, 0);
}

#[tokio::test]
async fn an_image_is_no_mesh_of_a_case_nor_of_a_comparison() {
    let server = Server::start();
    let image = server.upload(around_the_block(0)).await.expect(StatusCode::CREATED);
    let mesh = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let wrong = async |change: &dyn Fn(&mut Value), pointer: &str| {
        let mut case = case();
        case["volume"] = mesh["id"].clone();
        case["hounsfield"]["image"] = image["id"].clone();
        change(&mut case);
        let answer = ask(server.post("/v1/cases").json(&case)).await;
        let problem = answer.problem(422, "validation-failed");
        let error = &problem["errors"][0];
        assert_eq!((&error["code"], &error["pointer"]), (&json!("wrong-mesh"), &json!(pointer)));
    };
    wrong(&|case| case["volume"] = image["id"].clone(), "/volume").await;
    wrong(&|case| case["hounsfield"]["image"] = mesh["id"].clone(), "/hounsfield/image").await;
    let bone = json!([{"name": "jaw", "mesh": image["id"]}]);
    wrong(&|case| case["bones"] = bone.clone(), "/bones/0/mesh").await;
    let compare = json!({"kind": "compare", "prediction": {"mesh": mesh["id"]},
                         "actual": {"mesh": image["id"]}});
    let problem = server.job(&compare).await.problem(422, "validation-failed");
    let error = &problem["errors"][0];
    assert_eq!((&error["code"], &error["pointer"]), (&json!("wrong-mesh"), &json!("/actual/mesh")));
}

#[tokio::test]
async fn a_header_that_points_to_another_file_is_refused_with_its_line() {
    let server = Server::start();
    let detached = NRRD.replace("kinds: domain", "data file: /etc/passwd\nkinds: domain");
    let problem = server.upload(detached).await.problem(422, "mesh-parse");
    assert_eq!((&problem["format"], &problem["line"]), (&json!("NRRD"), &json!(8)));
}
