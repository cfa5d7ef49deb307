//! Templates brought to patients over HTTP: the case that comes of it predicts with its muscles, and what is no such patient is
//! refused by name.

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput};
use mechanics::mesh::generic_face::{FaceSettings, GenericFace, LAYERS, Lips, generic_face};
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector};
use mechanics::muscle::strap::box_surface;
use reqwest::StatusCode;
use serde_json::{Map, Value, json};

use crate::helpers::{Server, ask};

fn face() -> GenericFace {
    generic_face(FaceSettings { lips: Lips::Open, fineness: 1, shape: CellShape::Hex8 })
}

/// The patient is larger, turned, and bent.
fn of_patient(x: &Vector) -> Vector {
    let (sin, cos) = 0.2_f64.sin_cos();
    let bent = Vector::new(x.x, x.y + 2.0 * (x.z * 0.04).sin(), x.z + 2.0 * (x.y * 0.05).sin());
    Vector::new(cos * bent.x - sin * bent.y, sin * bent.x + cos * bent.y, bent.z) * 1.08
}

/// The boundary faces between some nodes, on the patient.
fn surface_of(face: &GenericFace, sets: &[&str]) -> TriangleSurface {
    let mesh = &face.mesh;
    let has = |node: &u32| sets.iter().any(|set| mesh.node_sets[*set].binary_search(node).is_ok());
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|own| own.nodes().iter().all(has)).collect();
    let mut surface = mesh.surface_of(&faces);
    surface.points.iter_mut().for_each(|x| *x = of_patient(x));
    surface
}

async fn upload(server: &Server, bytes: Vec<u8>) -> String {
    let answer = server.upload(bytes).await;
    answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
}

async fn upload_surface(server: &Server, surface: &TriangleSurface) -> String {
    upload(server, vtp::write(&SurfaceOutput::plain(surface, Frame::Lps)).unwrap()).await
}

fn landmarks(face: &GenericFace) -> Map<String, Value> {
    let pair = |(name, x): (&String, &Vector)| {
        let places = [*x, of_patient(x)].map(|x| json!([x.x, x.y, x.z]));
        (name.clone(), json!({"template_mm": places[0], "patient_mm": places[1]}))
    };
    face.landmarks.iter().map(pair).collect()
}

fn muscles(face: &GenericFace) -> Vec<Value> {
    let line = |line: &Vec<Vector>| line.iter().map(|x| [x.x, x.y, x.z]).collect::<Vec<_>>();
    let muscle = |own: &mechanics::mesh::generic_face::FaceMuscle| {
        let lines: Vec<_> = own.lines.iter().map(line).collect();
        json!({"name": own.name, "lines_mm": lines, "within_mm": own.within})
    };
    face.muscles.iter().map(muscle).collect()
}

/// The face as a template, and a patient with skin and bone.
async fn spec(server: &Server, face: &GenericFace) -> Value {
    let volume = vtu::write(&VolumeOutput::plain(&face.mesh, Frame::Lps)).unwrap();
    let template = upload(server, volume).await;
    let skin = upload_surface(server, &surface_of(face, &["skin"])).await;
    let bone = upload_surface(server, &surface_of(face, &["maxilla", "mandible", "skull"])).await;
    let names = LAYERS.iter().enumerate().map(|(label, name)| (label.to_string(), json!(name)));
    let tissue = json!({"young_modulus_kpa": 15, "poisson_ratio": 0.45});
    let fibre = json!({"young_modulus_kpa": 30, "direction": [0, 0, 1]});
    let muscle = json!({"young_modulus_kpa": 6.2, "poisson_ratio": 0.45, "fibre": fibre});
    json!({
        "kind": "conform",
        "template": {
            "mesh": template, "skin": "skin", "fixed": "skull", "held": ["rim"],
            "segments": {"maxilla": "maxilla", "mandible": "mandible"},
            "sliding": [{"nodes": "lower_vestibule", "segment": "mandible"}],
            "skin_regions": {"chin": "chin"},
            "regions": {"array": "layer", "names": names.collect::<Map<_, _>>()},
            "materials": {"*": tissue, "muscle": muscle},
            "muscles": muscles(face),
        },
        "patient": {"skin": skin, "bone": bone},
        "landmarks": landmarks(face),
    })
}

async fn ended(server: &Server, spec: &Value) -> Value {
    let posted = server.job(spec).await.json();
    server.ended(posted["id"].as_str().unwrap_or_else(|| panic!("{posted}"))).await
}

#[tokio::test]
async fn a_template_with_muscles_becomes_a_case_that_smiles() {
    let server = Server::start();
    let face = face();
    let job = ended(&server, &spec(&server, &face).await).await;
    assert_eq!(job["status"], "successful", "{job}");
    let found = &job["results"]["conformation"];
    assert!(found["skin"]["rms_mm"].as_f64() < Some(0.3), "{}", found["skin"]);
    assert_eq!(found["after_repair"]["inverted"], 0);
    assert!(found["check"]["classes"]["joined"]["mandible"].as_u64() > Some(50), "{found}");
    let told = found["muscles"].as_array().unwrap();
    assert_eq!(told.len(), face.muscles.len());
    for muscle in told {
        let ratio =
            muscle["length_mm"].as_f64().unwrap() / muscle["template_length_mm"].as_f64().unwrap();
        assert!((1.0..1.16).contains(&ratio), "{muscle}");
        assert!((muscle["widening"].as_f64().unwrap() - 1.08).abs() < 0.06, "{muscle}");
        assert!(muscle["beside_other_map"]["mean_deg"].as_f64().unwrap() < 15.0, "{muscle}");
    }
    let case = &found["case"];
    assert_eq!(case["volume"], job["results"]["kept"][0]["mesh"]);
    assert_eq!(case["materials"]["muscle"]["fibre"]["array"], "fibres_muscle");
    let kept = ask(server.post("/v1/cases").json(case)).await.expect(StatusCode::CREATED);

    let pull =
        |side: &str| json!({"muscle": format!("zygomaticus_major_{side}"), "stress_kpa": 10});
    let plan = json!({"activations": [pull("left"), pull("right")]});
    let asked = json!({"kind": "predict", "case": kept["id"], "plan": plan});
    let predicted = ended(&server, &asked).await;
    assert_eq!(predicted["status"], "successful", "{predicted}");
    let corner = &predicted["results"]["statistics"]["landmarks"]["cheilion_left"];
    // Left and up, in the frame of the patient, which is turned by 0.2 about z.
    let at = |axis: usize| corner[axis].as_f64().unwrap();
    let left = 0.2_f64.cos() * at(0) + 0.2_f64.sin() * at(1);
    assert!(left > 0.2 && at(2) > 0.2, "{corner}");
}

#[tokio::test]
async fn a_template_that_lies_far_from_a_skin_without_its_sides_is_told() {
    let server = Server::start();
    let face = face();
    let mut asked = spec(&server, &face).await;
    // Too few for any of them to be doubted, which takes long where the surfaces do not fit.
    let some = landmarks(&face).into_iter().step_by(7).collect::<Map<_, _>>();
    asked["landmarks"] = some.into();
    let whole = ended(&server, &asked).await;
    let is_apart = |job: &Value| {
        let warnings = job["results"]["warnings"].as_array().unwrap().iter();
        warnings.filter(|own| own["code"] == "template-apart").cloned().collect::<Vec<_>>()
    };
    assert_eq!(whole["status"], "successful", "{whole}");
    assert!(is_apart(&whole).is_empty(), "{whole}");
    // The sides of the head are missing in the scan.
    let mut front = surface_of(&face, &["skin"]);
    let (sin, cos) = 0.2_f64.sin_cos();
    let across = |x: &Vector| (cos * x.x + sin * x.y).abs() / 1.08;
    let points = front.points.clone();
    front.triangles.retain(|own| own.iter().all(|&corner| across(&points[corner as usize]) < 55.0));
    asked["patient"]["skin"] = json!(upload_surface(&server, &front).await);
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    let [told] = &is_apart(&job)[..] else { panic!("{job}") };
    assert!(told["skin_p95_mm"].as_f64() > Some(2.0), "{told}");
}

#[tokio::test]
async fn muscles_with_a_surface_or_a_box_become_surfaces_of_the_patient() {
    let server = Server::start();
    let face = face();
    let mut asked = spec(&server, &face).await;
    let half_axes = [[-8.0, -14.0, -12.0], [2.6, -1.5, 0.0], [0.8, 1.4, -2.2]];
    let centre = [30.0, -62.0, -8.0];
    let solid = box_surface(Vector::from(centre), half_axes.map(Vector::from));
    let surface = upload_surface(&server, &solid).await;
    let strap = json!({"young_modulus_kpa": 6.2, "poisson_ratio": 0.45});
    asked["template"]["muscles"] = json!([
        {"name": "as_box", "box_mm": {"centre": centre, "half_axes": half_axes}, "material": strap},
        {"name": "as_surface", "surface": surface, "direction": [8, 14, 12]},
        {"name": "again", "surface": surface, "boxes": 2},
    ]);
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    let found = &job["results"]["conformation"];
    let told = found["muscles"].as_array().unwrap();
    assert_eq!(told.len(), 3);
    for muscle in told {
        let volume = |member: &str| muscle[member].as_f64().unwrap();
        let ratio = volume("volume_ml") / volume("template_volume_ml");
        assert!((ratio / 1.08_f64.powi(3) - 1.0).abs() < 0.12, "{muscle}");
        assert_eq!(muscle["lines"], 0);
    }
    // Each is a mesh of the tenant, the same content once.
    let case = &found["case"];
    let of = |index: usize| case["muscles"][index]["surface"].as_str().unwrap().to_owned();
    assert_eq!([of(0), of(0)], [of(1), of(2)]);
    assert_eq!(case["muscles"][0].get("box_mm"), None);
    assert_eq!(case["muscles"][1]["array"], "fibres_as_surface");
    let mesh = ask(server.get(&format!("/v1/meshes/{}", of(0)))).await.expect(StatusCode::OK);
    assert_eq!(mesh["role"], "muscle", "{mesh}");
    let kept = ask(server.post("/v1/cases").json(case)).await.expect(StatusCode::CREATED);
    let pull = |name: &str| json!({"activations": [{"muscle": name, "stress_kpa": 10}]});
    let mut moved = Vec::new();
    for name in ["as_box", "as_surface"] {
        let plan = pull(name);
        let asked =
            json!({"kind": "predict", "case": kept["id"], "plan": plan, "method": "fem_linear"});
        let predicted = ended(&server, &asked).await;
        assert_eq!(predicted["status"], "successful", "{predicted}");
        let corner = &predicted["results"]["statistics"]["landmarks"]["cheilion_left"];
        let along = corner.as_array().unwrap().iter().map(|value| value.as_f64().unwrap().powi(2));
        moved.push(along.sum::<f64>().sqrt());
    }
    // The axis of the box and the direction that went with the tissue are nearly the same.
    assert!((moved[0] / moved[1] - 1.0).abs() < 0.1, "{moved:?}");

    // A surface that lies elsewhere has no tissue in it, and is refused before anything is fitted.
    let mut away = solid.clone();
    away.points.iter_mut().for_each(|x| x.x += 500.0);
    let away = upload_surface(&server, &away).await;
    asked["template"]["muscles"] = json!([{"name": "away", "surface": away}]);
    let refused = server.job(&asked).await.expect(StatusCode::UNPROCESSABLE_ENTITY);
    let at = refused["errors"][0]["pointer"].as_str().unwrap();
    assert!(at.starts_with("/template/muscles/0"), "{refused}");
}

#[tokio::test]
async fn muscles_go_by_landmarks_where_that_is_asked_for() {
    let server = Server::start();
    let face = face();
    let mut asked = spec(&server, &face).await;
    asked["muscles_by"] = json!("landmarks");
    asked["patient"] = json!({});
    let job = ended(&server, &asked).await;
    assert_eq!(job["status"], "successful", "{job}");
    // A muscle that ends in a landmark has its end there: the spline meets all of them.
    asked["template"]["muscles"] = json!([{"name": "thread", "lines_mm": [[
        asked["landmarks"]["cheilion_left"]["template_mm"],
        asked["landmarks"]["zygion_left"]["template_mm"],
    ]]}]);
    let job = ended(&server, &asked).await;
    let line = &job["results"]["conformation"]["case"]["muscles"][0]["lines_mm"][0];
    let line = line.as_array().unwrap_or_else(|| panic!("{job}"));
    for (name, found) in [("cheilion_left", &line[0]), ("zygion_left", &line[line.len() - 1])] {
        for axis in 0..3 {
            let known = &asked["landmarks"][name]["patient_mm"][axis];
            let off = found[axis].as_f64().unwrap() - known.as_f64().unwrap();
            assert!(off.abs() < 1e-5, "{name} {found}");
        }
    }
    let two: Map<String, Value> = landmarks(&face).into_iter().take(2).collect();
    asked["landmarks"] = Value::Object(two);
    let problem = server.job(&asked).await.problem(422, "alignment-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/muscles_by", "{problem}");
}

#[tokio::test]
async fn a_template_of_which_no_case_can_be_made_is_refused_with_the_place() {
    let server = Server::start();
    let sound = spec(&server, &face()).await;
    let refused = async |change: &dyn Fn(&mut Value), at: &str, code: &str| {
        let mut asked = sound.clone();
        change(&mut asked["template"]);
        let answer = server.job(&asked).await;
        let problem = answer.expect(StatusCode::UNPROCESSABLE_ENTITY);
        let fault = &problem["errors"][0];
        assert_eq!((&fault["pointer"], &fault["code"]), (&json!(at), &json!(code)), "{problem}");
    };
    let far = |own: &mut Value| own["muscles"][0]["lines_mm"] = json!([[[900, 0, 0], [910, 0, 0]]]);
    refused(&far, "/template/muscles/0/lines_mm", "empty-selection").await;
    let twice = |own: &mut Value| own["muscles"][1]["name"] = own["muscles"][0]["name"].clone();
    refused(&twice, "/template/muscles/1/name", "duplicate-name").await;
    let point = |own: &mut Value| own["muscles"][0]["lines_mm"] = json!([[[0, 0, 0]]]);
    refused(&point, "/template/muscles/0/lines_mm/0", "missing-field").await;
    let soft = |own: &mut Value| own["materials"]["muscle"]["young_modulus_kpa"] = json!(-1);
    refused(&soft, "/template/materials/muscle/young_modulus_kpa", "out-of-range").await;
    let region = |own: &mut Value| own["materials"]["brain"] = own["materials"]["*"].clone();
    refused(&region, "/template/materials/brain", "unknown-region").await;
    let array = |own: &mut Value| own["regions"]["array"] = json!("tissue_of");
    refused(&array, "/template/regions/array", "unknown-array").await;
    let held = |own: &mut Value| own["held"] = json!(["rim", "neck"]);
    refused(&held, "/template/held/1", "unknown-set").await;
    let sliding = |own: &mut Value| own["sliding"][0]["nodes"] = json!("gums");
    refused(&sliding, "/template/sliding/0/nodes", "unknown-set").await;
    let wall = |own: &mut Value| own["sliding"][0]["segment"] = json!("teeth");
    refused(&wall, "/template/sliding/0/segment", "unknown-segment").await;
}

/// A conformation to a skin alone.
fn to_skin(sound: &Value, skin: &str) -> Value {
    let mut asked = sound.clone();
    asked["patient"] = json!({"skin": skin});
    asked["landmarks"] = json!({});
    asked
}

/// The pointer and the sentence of a conformation that fails.
async fn failed(server: &Server, asked: &Value) -> (String, String) {
    let job = ended(server, asked).await;
    assert_eq!(
        (&job["status"], &job["error"]["type"]),
        (&json!("failed"), &json!("alignment-failed")),
        "{job}"
    );
    let text = |place: &str| job.pointer(place).and_then(Value::as_str).unwrap().to_owned();
    (text("/error/errors/0/pointer"), text("/error/detail"))
}

#[tokio::test]
async fn landmarks_that_are_swapped_or_exchanged_are_named() {
    let server = Server::start();
    let sound = spec(&server, &face()).await;
    let mut swapped = sound.clone();
    for (name, pair) in sound["landmarks"].as_object().unwrap() {
        let other = match (name.strip_suffix("_left"), name.strip_suffix("_right")) {
            (Some(stem), _) => format!("{stem}_right"),
            (None, Some(stem)) => format!("{stem}_left"),
            (None, None) => continue,
        };
        swapped["landmarks"][&other]["patient_mm"] = pair["patient_mm"].clone();
    }
    let (at, detail) = failed(&server, &swapped).await;
    assert_eq!(at, "/landmarks");
    assert!(detail.contains("left and right are swapped"), "{detail}");

    let mut exchanged = sound.clone();
    let pair = ["cheilion_left", "zygion_left"];
    for (one, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
        exchanged["landmarks"][one]["patient_mm"] = sound["landmarks"][other]["patient_mm"].clone();
    }
    let (at, detail) = failed(&server, &exchanged).await;
    assert_eq!(at, "/landmarks");
    let both = pair.iter().all(|name| detail.contains(&format!("\"{name}\"")));
    assert!(both && detail.contains("exchanged"), "{detail}");

    // All of them in the order of other names.
    let mut permuted = sound.clone();
    let names: Vec<&String> = sound["landmarks"].as_object().unwrap().keys().collect();
    for (index, name) in names.iter().enumerate() {
        let other = names[(index * 7 + 5) % names.len()];
        permuted["landmarks"][*name]["patient_mm"] =
            sound["landmarks"][other]["patient_mm"].clone();
    }
    let (at, detail) = failed(&server, &permuted).await;
    assert_eq!(at, "/landmarks");
    assert!(detail.contains("no pairs"), "{detail}");
}

#[tokio::test]
async fn a_patient_in_metres_half_a_head_and_what_is_no_face_are_named() {
    let server = Server::start();
    let face = face();
    let sound = spec(&server, &face).await;
    let skin = surface_of(&face, &["skin"]);
    let mut metres = skin.clone();
    metres.points.iter_mut().for_each(|x| *x /= 1000.0);
    let asked = to_skin(&sound, &upload_surface(&server, &metres).await);
    let (at, detail) = failed(&server, &asked).await;
    assert!(at == "/patient" && detail.contains("not in mm"), "{at}: {detail}");

    let mut half = skin.clone();
    let axis = of_patient(&Vector::new(1.0, 0.0, 0.0)) - of_patient(&Vector::zeros());
    let is_left = |corner: &u32| skin.points[*corner as usize].dot(&axis) > 0.0;
    half.triangles.retain(|corners| corners.iter().all(is_left));
    let asked = to_skin(&sound, &upload_surface(&server, &half).await);
    let (at, detail) = failed(&server, &asked).await;
    assert!(at == "/patient/skin" && detail.contains("missing"), "{at}: {detail}");

    // A ball as large as a head.
    let mut ball = skin;
    ball.points.iter_mut().for_each(|x| *x = x.normalize() * 90.0);
    let asked = to_skin(&sound, &upload_surface(&server, &ball).await);
    let (at, detail) = failed(&server, &asked).await;
    assert_eq!(at, "/patient/skin");
    assert!(
        detail.contains("this is no such face") || detail.contains("or this is none"),
        "{detail}"
    );
}
