//! Meshes: stored once, by content, without what their headers say.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use facies::schema::wire::canonical::sha256_hex;
use mechanics::format::{Mesh, ReadLimits, read};
use reqwest::StatusCode;
use reqwest::multipart::{Form, Part};
use sha2::{Digest, Sha256, Sha512};

use crate::helpers::{SMALL, Server, ask};

const HEADS_STL: &str = "solid Jane Roe 1970 SPACE=LPS
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 100 0 0
vertex 0 100 0
endloop
endfacet
endsolid Jane Roe
";

#[tokio::test]
async fn an_upload_whose_bytes_others_delete_meanwhile_is_stored() {
    let server = Server::start();
    let bytes = SMALL.vtu();
    let upload = async || {
        let request = server.post("/v1/meshes?units=mm").body(bytes.clone());
        ask(request.header("content-type", "application/vnd.vtk.xml")).await
    };
    for round in 0..20 {
        let uploads = [upload(), upload(), upload()].into_iter().map(async |upload| {
            let stored = upload.await;
            assert!(stored.status.is_success(), "{round}: {}", stored.status);
            let mesh: serde_json::Value = serde_json::from_slice(&stored.bytes).unwrap();
            ask(server.delete(&format!("/v1/meshes/{}", mesh["id"].as_str().unwrap()))).await
        });
        futures::future::join_all(uploads).await;
    }
}

#[tokio::test]
async fn an_upload_is_reported_and_the_same_bytes_are_the_same_mesh() {
    let server = Server::start();
    let bytes = SMALL.vtu();
    let upload = || {
        let request = server.post("/v1/meshes?units=mm&frame=LPS&role=volume");
        request.header("content-type", "application/vnd.vtk.xml").body(bytes.clone())
    };
    let first = ask(upload()).await;
    let mesh = first.expect(StatusCode::CREATED);
    let id = mesh["id"].as_str().unwrap();
    assert_eq!(first.header("location"), format!("/v1/meshes/{id}"));
    assert_eq!(mesh["sha256"], sha256_hex(&bytes));
    assert_eq!(mesh["bytes"], bytes.len());
    let report = &mesh["report"];
    assert_eq!((&report["kind"], &report["nodes"]), (&"volume".into(), &125.into()));
    assert_eq!(report["cells"]["hex8"], 64);
    assert_eq!(report["node_sets"]["z_min"], 25);
    let second = ask(upload()).await;
    let mesh = second.expect(StatusCode::OK);
    assert_eq!(mesh["id"], id);
    let other_unit = server.post("/v1/meshes?units=m&allow_any_scale=true");
    let other_unit =
        other_unit.header("content-type", "application/octet-stream").body(bytes.clone());
    assert_ne!(ask(other_unit).await.expect(StatusCode::CREATED)["id"], id);

    let shown = ask(server.get(&format!("/v1/meshes/{id}"))).await;
    assert_eq!(shown.expect(StatusCode::OK), mesh);
    let tag = shown.header("etag");
    let known = ask(server.get(&format!("/v1/meshes/{id}")).header("if-none-match", tag)).await;
    assert_eq!(known.status, StatusCode::NOT_MODIFIED);

    let deleted = ask(server.delete(&format!("/v1/meshes/{id}"))).await;
    assert_eq!(deleted.status, StatusCode::NO_CONTENT);
    ask(server.get(&format!("/v1/meshes/{id}"))).await.problem(410, "gone");
    ask(server.delete(&format!("/v1/meshes/{id}"))).await.problem(410, "gone");
    ask(upload()).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn a_stored_mesh_comes_back_as_it_was_understood() {
    let server = Server::start();
    let mesh = server.upload(SMALL.vtu()).await.expect(StatusCode::CREATED);
    let content = format!("/v1/meshes/{}/content", mesh["id"].as_str().unwrap());
    let original = read(&SMALL.vtu(), &ReadLimits::default()).unwrap().mesh;
    let volume = ask(server.get(&content)).await;
    assert_eq!(volume.header("content-type"), "application/vnd.vtk.xml");
    assert_eq!(read(&volume.bytes, &ReadLimits::default()).unwrap().mesh, original);
    for format in ["vtp", "stl", "ply"] {
        let answer = ask(server.get(&format!("{content}?format={format}"))).await;
        assert_eq!(answer.status, StatusCode::OK, "{format}");
        assert!(answer.header("content-disposition").ends_with(&format!(".{format}\"")));
        let surface = read(&answer.bytes, &ReadLimits::default()).unwrap().mesh;
        let Mesh::Surface(surface) = surface else { panic!("{format} is a volume") };
        assert_eq!(surface.triangles.len(), 6 * 16 * 2, "{format}");
    }
    let unknown = ask(server.get(&format!("{content}?format=obj"))).await;
    unknown.problem(400, "invalid-parameter");
    let surface = ask(server.get(&format!("{content}?format=stl"))).await;
    let surface = server.upload(surface.bytes).await.expect(StatusCode::CREATED);
    let content = format!("/v1/meshes/{}/content", surface["id"].as_str().unwrap());
    let volume = ask(server.get(&format!("{content}?format=vtu"))).await;
    volume.problem(422, "format-not-available");
}

#[tokio::test]
async fn names_in_headers_stay_behind_and_the_frame_is_kept() {
    let server = Server::start();
    let request = server.post("/v1/meshes").header("content-type", "model/stl").body(HEADS_STL);
    let mesh = ask(request).await.expect(StatusCode::CREATED);
    assert_eq!(mesh["report"]["space"], "LPS");
    let content = format!("/v1/meshes/{}/content", mesh["id"].as_str().unwrap());
    for format in ["vtp", "stl", "ply"] {
        let file = ask(server.get(&format!("{content}?format={format}"))).await;
        let text = String::from_utf8_lossy(&file.bytes).into_owned();
        assert!(!text.contains("Jane"), "{format}: {text}");
        let marked = read(&file.bytes, &ReadLimits::default()).unwrap().frame;
        assert_eq!(marked.map(|frame| frame.name()), Some("LPS"), "{format}");
    }
    let kept = walk(server.path());
    assert!(kept.iter().all(|bytes| !contains(bytes, b"Jane")), "nothing on disk names her");
}

fn walk(folder: &std::path::Path) -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(walk(&path));
        } else {
            files.push(std::fs::read(path).unwrap());
        }
    }
    files
}

fn contains(bytes: &[u8], wanted: &[u8]) -> bool {
    bytes.windows(wanted.len()).any(|window| window == wanted)
}

#[tokio::test]
async fn a_form_with_one_part_is_an_upload() {
    let server = Server::start();
    let form = || Form::new().part("file", Part::bytes(SMALL.vtu()).file_name("../../etc/passwd"));
    let request = server.post("/v1/meshes").multipart(form());
    ask(request).await.expect(StatusCode::CREATED);
    let two = form().part("other", Part::text("x"));
    ask(server.post("/v1/meshes").multipart(two)).await.problem(400, "malformed-multipart");
    let none = server.post("/v1/meshes").multipart(Form::new());
    ask(none).await.problem(400, "malformed-multipart");
}

#[tokio::test]
async fn a_body_that_differs_from_its_digest_is_refused() {
    let server = Server::start();
    let bytes = SMALL.vtu();
    let digest = STANDARD.encode(Sha256::digest(&bytes));
    let upload = |digest: &str| {
        let request = server.post("/v1/meshes").header("content-type", "application/octet-stream");
        ask(request.header("content-digest", digest).body(bytes.clone()))
    };
    let wrong = STANDARD.encode(Sha256::digest(b"other"));
    upload(&format!("sha-256=:{wrong}:")).await.problem(400, "digest-mismatch");
    upload("sha-256=:AAAA:").await.problem(400, "invalid-parameter");
    upload("sha-256=x").await.problem(400, "invalid-parameter");
    let listed = ask(server.get("/v1/meshes")).await;
    listed.problem(405, "method-not-allowed");
    upload(&format!("sha-256=:{digest}:")).await.expect(StatusCode::CREATED);
    let wide = |bytes: &[u8]| format!("sha-512=:{}:", STANDARD.encode(Sha512::digest(bytes)));
    upload(&wide(b"other")).await.problem(400, "digest-mismatch");
    upload(&wide(&bytes)).await.expect(StatusCode::OK);

    // A form is digested as a whole, with what follows its last part; a document as it is.
    let form = [
        &b"--x\r\nContent-Disposition: form-data; name=\"m\"\r\n\r\n"[..],
        &bytes,
        b"\r\n--x--\r\nend",
    ];
    let send = |path: &str, kind: &str, digest: String, body: Vec<u8>| {
        let request = server.post(path).header("content-type", kind.to_owned());
        ask(request.header("content-digest", digest).body(body))
    };
    let (form, kind) = (form.concat(), "multipart/form-data; boundary=x");
    let cut = wide(&form[..form.len() - 3]);
    send("/v1/meshes", kind, cut, form.clone()).await.problem(400, "digest-mismatch");
    send("/v1/meshes", kind, wide(&form), form.clone()).await.expect(StatusCode::OK);
    let (job, kind) = (b"{}".to_vec(), "application/json");
    let refused = send("/v1/jobs", kind, wide(b"[]"), job.clone()).await;
    refused.problem(400, "digest-mismatch");
    send("/v1/jobs", kind, wide(&job), job).await.problem(422, "validation-failed");
}

#[tokio::test]
async fn a_scale_that_no_head_has_is_refused_with_the_unit_that_fits() {
    let server = Server::start();
    let metres = HEADS_STL.replace("100", "0.1");
    let upload = |query: &str| {
        let request = server.post(&format!("/v1/meshes{query}"));
        ask(request.header("content-type", "model/stl").body(metres.clone()))
    };
    let problem = upload("").await.problem(422, "units-suspect");
    assert_eq!(problem["suggested_units"], "m");
    let meant = upload("?allow_any_scale=true").await.expect(StatusCode::CREATED);
    assert_eq!(meant["report"]["warnings"][0]["code"], "units-suspect");
    let right = upload("?units=m").await.expect(StatusCode::CREATED);
    assert!(right["report"].get("warnings").is_none_or(|warnings| {
        warnings.as_array().unwrap().iter().all(|warning| warning["code"] != "units-suspect")
    }));
}
