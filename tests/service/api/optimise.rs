//! Inverse planning over HTTP: plans found from where skin is wanted, verified, bounded, refused.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::helpers::{SMALL, Server, ask};

/// Points on the sides of the block, which are its skin.
fn landmarks() -> Vec<(String, [f64; 3])> {
    let mut points = Vec::new();
    for (index, across) in [10.0, 25.0, 33.0, 52.0].into_iter().enumerate() {
        let z = 8.0 + 4.0 * index as f64;
        points.extend([[0.0, across, z], [60.0, across, z], [across, 0.0, z], [across, 60.0, z]]);
    }
    points.into_iter().enumerate().map(|(n, point)| (format!("p{n}"), point)).collect()
}

async fn case(server: &Server) -> String {
    let mut document = SMALL.case();
    for (name, point) in landmarks() {
        document["landmarks"][name] = json!(point);
    }
    let answer = ask(server.post("/v1/cases").multipart(SMALL.form(&document))).await;
    answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
}

const PIVOT: [f64; 3] = [30.0, 80.0, 10.0];

fn bounds(mm: f64, degrees: f64) -> Value {
    let free = |end: f64| json!([[-end, end], [-end, end], [-end, end]]);
    json!({"bone": {"translation_mm": free(mm), "rotation_deg": free(degrees), "pivot_mm": PIVOT}})
}

fn spec(case: &str, targets: Value, bounds: Value) -> Value {
    json!({"kind": "optimise", "case": case, "targets": targets, "bounds": bounds})
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[tokio::test]
async fn a_point_of_the_skin_is_as_good_a_target_as_a_landmark_there() {
    let server = Server::start();
    let case = case(&server).await;
    let found = async |points: bool| {
        let target = |(name, at): (String, [f64; 3])| match points {
            true => json!({"point_mm": at, "displacement_mm": [1, null, 0.5]}),
            false => json!({"landmark": name, "displacement_mm": [1, null, 0.5]}),
        };
        let targets: Vec<Value> = landmarks().into_iter().map(target).collect();
        let job = server.job(&spec(&case, json!(targets), bounds(5.0, 0.0))).await;
        job.expect(StatusCode::OK)["results"]["optimisation"]["plan"].clone()
    };
    let (by_points, by_landmarks) = (found(true).await, found(false).await);
    assert_eq!(by_points, by_landmarks);
    assert!(by_points["segments"][0]["translation_mm"][0].as_f64().unwrap() > 0.5, "{by_points}");
    let both = json!([{"point_mm": [0, 10, 8], "landmark": "p0", "displacement_mm": [1, 0, 0]}]);
    let refused = server.job(&spec(&case, both, bounds(5.0, 0.0))).await;
    let problem = refused.problem(422, "validation-failed");
    assert_eq!(
        (&problem["errors"][0]["pointer"], &problem["errors"][0]["code"]),
        (&json!("/targets/0"), &json!("one-of"))
    );
}

#[tokio::test]
async fn a_plan_is_found_from_the_skin_it_makes_and_verified() {
    let server = Server::start();
    let case = case(&server).await;
    let (translation, rotation) = ([1.5, -0.7, 2.0], [7.0, -5.0, 11.0]);
    let plan = json!({"segments": [{"name": "bone", "translation_mm": translation,
        "rotation_deg": rotation, "pivot_mm": PIVOT}]});
    let predict = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": plan});
    let made = server.job(&predict).await.expect(StatusCode::OK);
    let moved = &made["results"]["statistics"]["landmarks"];
    let target = |(name, _): (String, [f64; 3])| json!({"landmark": name, "displacement_mm": moved[&name], "sigma_mm": 0.5});
    let targets: Vec<Value> = landmarks().into_iter().map(target).collect();

    let mut spec = spec(&case, json!(targets), bounds(10.0, 20.0));
    spec["outputs"] = json!(["skin.csv", "volume.vtu"]);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    assert_eq!(
        (&job["kind"], &job["status"], &job["case"]),
        (&json!("optimise"), &json!("successful"), &json!(case))
    );
    let results = &job["results"];
    assert_eq!(results["provenance"]["spec_hash"], job["spec_hash"]);
    let found = &results["optimisation"];
    let segment = &found["plan"]["segments"][0];
    // Both answers are solved to a relative residual of 1e-8, and the columns are stored in single precision.
    for (name, wanted) in [("translation_mm", translation), ("rotation_deg", rotation)] {
        for (found, wanted) in numbers(&segment[name]).into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-4, "{name}: {segment}");
        }
    }
    assert!(found["verified_difference_mm"].as_f64().unwrap() < 1e-5, "{found}");
    assert_eq!((&found["at_bound"], &found["undetermined"]), (&json!([]), &json!([])));
    assert_eq!(found["parameters"][5]["name"], "rotation_deg.z");
    assert_eq!(found["degrees_of_freedom"], 16 * 3 - 6);
    for target in found["targets"].as_array().unwrap() {
        assert_eq!(target["points"], 1);
        assert!(target["residual_mm"].as_f64().unwrap() < 1e-5, "{target}");
    }
    let errors = numbers(&found["standard_error"]);
    for (row, error) in errors.iter().enumerate() {
        let variance = found["covariance"][row][row].as_f64().unwrap();
        assert!((variance.sqrt() - error).abs() < 1e-12 * error && *error > 0.0);
    }

    // The files are those that a prediction of the plan writes.
    let predict = json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": found["plan"], "outputs": ["skin.csv"]});
    let again = server.job(&predict).await.expect(StatusCode::OK);
    assert_eq!(results["files"][0], again["results"]["files"][0]);
    assert_eq!(results["statistics"], again["results"]["statistics"]);
    assert_eq!(results["reaction_mn"], again["results"]["reaction_mn"]);
    let listed = ask(server.get("/v1/jobs?kind=optimise")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"][0]["id"], job["id"]);
    spec["tags"] = json!(["again"]);
    let known = server.job(&spec).await.expect(StatusCode::OK);
    assert_eq!((&known["id"], &known["deduplicated"]), (&job["id"], &json!(true)));
}

#[tokio::test]
async fn a_bound_that_stops_the_plan_is_reported_and_its_parameter_is_not_free() {
    let server = Server::start();
    let case = case(&server).await;
    // The bone would have to move farther than 1 mm along y; along z it is held.
    let targets = json!([{"nodes": {"node_set": "y_max"}, "displacement_mm": [0.1, 1.5, null], "sigma_mm": 0.2}]);
    let bounds = json!({"bone": {"translation_mm": [[-2, 2], [-1, 1], [0, 0]]}});
    let job = server.job(&spec(&case, targets, bounds)).await.expect(StatusCode::OK);
    let found = &job["results"]["optimisation"];
    assert_eq!(
        found["at_bound"],
        json!([{"segment": "bone", "name": "translation_mm.y", "value": 1.0, "bound": "upper"}])
    );
    let moved = numbers(&found["plan"]["segments"][0]["translation_mm"]);
    assert!(moved[0] > 0.0 && moved[0] < 2.0 && moved[1..] == [1.0, 0.0], "{moved:?}");
    let free = &found["parameters"];
    assert_eq!((free.as_array().unwrap().len(), &free[0]["name"]), (1, &json!("translation_mm.x")));
    let residual = found["targets"][0]["residual_mm"].as_f64().unwrap();
    let largest = found["targets"][0]["largest_mm"].as_f64().unwrap();
    assert!(residual > 0.1 && largest >= residual && largest < 1.5, "{found}");
    // 5 x 5 nodes on that side, of which those at the bottom and the top are held and no skin.
    assert_eq!(
        (&found["targets"][0]["points"], &found["degrees_of_freedom"]),
        (&json!(15), &json!(29))
    );
    let chi_squared = found["chi_squared"].as_f64().unwrap();
    assert!((chi_squared - 15.0 * (residual / 0.2).powi(2)).abs() < 1e-9 * chi_squared);
}

#[tokio::test]
async fn a_position_is_reached_and_what_one_point_cannot_decide_is_named() {
    let server = Server::start();
    let case = case(&server).await;
    // p5 rests at (60, 25, 12).
    let targets = json!([{"landmark": "p5", "position_mm": [60.4, null, 11.5]}]);
    let mut spec = spec(&case, targets, bounds(10.0, 10.0));
    spec["verify"] = json!(false);
    let job = server.job(&spec).await.expect(StatusCode::OK);
    let results = &job["results"];
    let found = &results["optimisation"];
    assert!(found["targets"][0]["residual_mm"].as_f64().unwrap() < 1e-6, "{found}");
    assert_eq!(found["undetermined"].as_array().unwrap().len(), 4, "{found}");
    assert_eq!(
        found["parameters"].as_array().unwrap().len(),
        found["standard_error"].as_array().unwrap().len()
    );

    // Without the full solution there is the skin, and nothing of the inside.
    assert!(found.get("verified_difference_mm").is_none());
    assert_eq!(results["reaction_mn"], json!({}));
    let names: Vec<&str> = results["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["skin.vtp", "skin.glb"]);
    assert!(results["provenance"]["solver"]["relative_residual"].as_f64().unwrap() <= 1e-8);
    let moved =
        json!({"kind": "predict", "method": "fem_linear", "case": case, "plan": found["plan"]});
    let solved = server.job(&moved).await.expect(StatusCode::OK);
    let largest = |results: &Value| results["statistics"]["skin"]["nodes"]["max"].as_f64().unwrap();
    assert!((largest(results) - largest(&solved["results"])).abs() < 1e-5);
    let landmark = numbers(&solved["results"]["statistics"]["landmarks"]["p5"]);
    assert!((landmark[0] - 0.4).abs() < 1e-5 && (landmark[2] + 0.5).abs() < 1e-5, "{landmark:?}");
}

#[tokio::test]
async fn time_that_runs_out_fails_the_job() {
    let server = Server::start();
    let case = case(&server).await;
    let targets = json!([{"landmark": "p5", "displacement_mm": [1, null, null]}]);
    let mut spec = spec(&case, targets, bounds(10.0, 10.0));
    spec["budget"] = json!({"wall_s": 0.001});
    let job = server.job(&spec).await.expect(StatusCode::CREATED);
    let ended = server.ended(job["id"].as_str().unwrap()).await;
    assert_eq!(
        (&ended["status"], &ended["error"]["type"]),
        (&json!("failed"), &json!("budget-exceeded"))
    );
}

/// Name, what is put into a spec, the code of the problem, the pointer of its first mistake.
type Row = (&'static str, Value, &'static str, &'static str);

fn target(change: Value) -> Value {
    let mut target = json!({"landmark": "p5", "displacement_mm": [1, 0, 0]});
    let members = target.as_object_mut().unwrap();
    members.extend(change.as_object().unwrap().clone());
    members.retain(|_, member| *member != json!("left out"));
    json!({"targets": [{"landmark": "p4", "displacement_mm": [0, null, 0]}, target]})
}

fn bound(change: Value) -> Value {
    let mut bounds = bounds(10.0, 10.0);
    let members = bounds["bone"].as_object_mut().unwrap();
    members.extend(change.as_object().unwrap().clone());
    members.retain(|_, member| *member != json!("left out"));
    json!({ "bounds": bounds })
}

fn bad_targets() -> Vec<Row> {
    let selected = |nodes: Value| target(json!({"landmark": "left out", "nodes": nodes}));
    let (invalid, at) = ("validation-failed", "/targets/1");
    vec![
        ("no target", json!({"targets": []}), invalid, "/targets"),
        ("neither", target(json!({"landmark": "left out"})), invalid, at),
        ("both", target(json!({"nodes": {"node_set": "y_max"}})), invalid, at),
        ("unknown landmark", target(json!({"landmark": "nose"})), invalid, "/targets/1/landmark"),
        ("no place", target(json!({"displacement_mm": "left out"})), invalid, at),
        ("two places", target(json!({"position_mm": [1, 2, 3]})), invalid, at),
        (
            "nothing wanted",
            target(json!({"displacement_mm": [null, null, null]})),
            invalid,
            "/targets/1/displacement_mm",
        ),
        (
            "far",
            target(json!({"displacement_mm": [0, 101, 0]})),
            invalid,
            "/targets/1/displacement_mm/1",
        ),
        (
            "far place",
            target(json!({"displacement_mm": "left out", "position_mm": [900, 0, 0]})),
            invalid,
            "/targets/1/position_mm",
        ),
        ("sigma 0", target(json!({"sigma_mm": 0})), invalid, "/targets/1/sigma_mm"),
        ("sigma -1", target(json!({"sigma_mm": -1})), invalid, "/targets/1/sigma_mm"),
        ("unknown set", selected(json!({"node_set": "nose"})), invalid, "/targets/1/nodes"),
        (
            "not on the skin",
            selected(json!({"node_set": "z_min"})),
            "empty-selection",
            "/targets/1/nodes",
        ),
        ("no selection", selected(json!({})), invalid, "/targets/1/nodes"),
        (
            "no such surface",
            selected(json!({"surface": uuid::Uuid::now_v7(), "within_mm": 1})),
            invalid,
            "/targets/1/nodes/surface",
        ),
        ("misspelt", target(json!({"weight": 2})), invalid, "/targets/1/weight"),
    ]
}

fn bad_bounds() -> Vec<Row> {
    let invalid = "validation-failed";
    let free = |end: f64| json!([[-end, end], [-end, end], [-end, end]]);
    let held = json!([[0, 0], [0, 0], [0, 0]]);
    vec![
        ("no bounds", json!({"bounds": {}}), invalid, "/bounds"),
        (
            "nothing free",
            bound(json!({"translation_mm": held, "rotation_deg": [[1, 1], [0, 0], [0, 0]]})),
            invalid,
            "/bounds",
        ),
        (
            "reversed",
            bound(json!({"translation_mm": [[0, 0], [2, 1], [0, 0]]})),
            invalid,
            "/bounds/bone/translation_mm/1",
        ),
        (
            "beyond 90 degrees",
            bound(json!({"rotation_deg": free(91.0)})),
            invalid,
            "/bounds/bone/rotation_deg/0/0",
        ),
        (
            "beyond 100 mm",
            bound(json!({"translation_mm": [[0, 101], [0, 0], [0, 0]]})),
            invalid,
            "/bounds/bone/translation_mm/0/1",
        ),
        (
            "corner beyond 100 mm",
            bound(json!({"translation_mm": free(60.0)})),
            "plan-out-of-range",
            "/bounds/bone/translation_mm",
        ),
        ("no pivot", bound(json!({"pivot_mm": "left out"})), invalid, "/bounds/bone/pivot_mm"),
        (
            "two numbers",
            bound(json!({"translation_mm": [[0, 1], [0, 1]]})),
            invalid,
            "/bounds/bone/translation_mm",
        ),
        (
            "unknown segment",
            json!({"bounds": {"nose": {"translation_mm": free(1.0)}}}),
            "unknown-segment",
            "/bounds/nose",
        ),
        ("unknown method", json!({"method": "msm"}), "method-not-available", "/method"),
        (
            "inside without verify",
            json!({"verify": false, "outputs": ["volume.vtu"]}),
            invalid,
            "/outputs/0",
        ),
        ("time 0", json!({"budget": {"wall_s": 0}}), invalid, "/budget/wall_s"),
        ("unknown case", json!({"case": uuid::Uuid::now_v7()}), invalid, "/case"),
        ("unknown field", json!({"plan": {}}), invalid, "/plan"),
    ]
}

fn tissue(bounds: Value) -> Value {
    json!({ "tissue_bounds": bounds })
}

fn bad_tissue() -> Vec<Row> {
    let invalid = "validation-failed";
    vec![
        (
            "reversed loss",
            tissue(json!({"*": {"volume_change": [0.1, -0.1]}})),
            invalid,
            "/tissue_bounds/*/volume_change",
        ),
        (
            "more than half lost",
            tissue(json!({"*": {"volume_change": [-0.6, 0]}})),
            invalid,
            "/tissue_bounds/*/volume_change/0",
        ),
        (
            "ratio of 0.5",
            tissue(json!({"*": {"poisson_ratio": [0.3, 0.5]}})),
            invalid,
            "/tissue_bounds/*/poisson_ratio/1",
        ),
        (
            "negative ratio",
            tissue(json!({"*": {"poisson_ratio": [-1.5, 0.4]}})),
            invalid,
            "/tissue_bounds/*/poisson_ratio/0",
        ),
        (
            "no modulus",
            tissue(json!({"*": {"young_modulus_kpa": [0, 10]}})),
            invalid,
            "/tissue_bounds/*/young_modulus_kpa/0",
        ),
        (
            "three numbers",
            tissue(json!({"*": {"poisson_ratio": [0.3, 0.4, 0.45]}})),
            invalid,
            "/tissue_bounds/*/poisson_ratio",
        ),
        (
            "unknown constant",
            tissue(json!({"*": {"density": [1, 2]}})),
            invalid,
            "/tissue_bounds/*/density",
        ),
        (
            "region that does not grow",
            tissue(json!({"fat": {"volume_change": [-0.1, 0.1]}})),
            invalid,
            "/tissue_bounds/fat",
        ),
        (
            "region without a ratio",
            tissue(json!({"fat": {"poisson_ratio": [0.3, 0.4]}})),
            invalid,
            "/tissue_bounds/fat",
        ),
        (
            "ratio of nothing",
            tissue(json!({"*": {"poisson_ratio": [0.3, 0.4]},
                          "tissue": {"poisson_ratio": [0.3, 0.4]}})),
            "empty-selection",
            "/tissue_bounds/*",
        ),
        (
            "stated twice",
            json!({"growth": [{"region": "*", "volume_change": 0.1}],
                   "tissue_bounds": {"*": {"volume_change": [-0.1, 0.1]}}}),
            invalid,
            "/tissue_bounds/*/volume_change",
        ),
        (
            "all held",
            json!({"bounds": {"bone": {"translation_mm": [[1, 1], [0, 0], [0, 0]]}},
                   "tissue_bounds": {"*": {"poisson_ratio": [0.4, 0.4]}}}),
            invalid,
            "/bounds",
        ),
    ]
}

#[tokio::test]
async fn constants_of_all_regions_are_those_of_a_region_with_a_material_of_its_own_too() {
    let server = Server::start();
    let case = case(&server).await;
    let target =
        |(_, at): (String, [f64; 3])| json!({"point_mm": at, "displacement_mm": [1, null, 0.5]});
    let targets: Vec<Value> = landmarks().into_iter().map(target).collect();
    let mut spec = spec(&case, json!(targets), bounds(5.0, 0.0));
    spec["materials"] = json!({"tissue": {"young_modulus_kpa": 7, "poisson_ratio": 0.4}});
    spec["tissue_bounds"] = json!({"*": {"poisson_ratio": [0.42, 0.44]}});
    let job = server.job(&spec).await.expect(StatusCode::OK);
    let own = &job["results"]["optimisation"]["materials"]["tissue"];
    let ratio = own["poisson_ratio"].as_f64().unwrap();
    assert!((0.42..=0.44).contains(&ratio), "{own}");
    assert_eq!(own["young_modulus_kpa"], 7.0, "{own}");
}

#[tokio::test]
async fn what_an_operation_did_comes_back_with_the_tissue_that_was_lost_and_its_ratio() {
    let server = Server::start();
    let case = case(&server).await;
    let (moved, loss, nu) = ([1.5, -0.7, 2.0], -0.08, 0.41);
    let done = json!({"kind": "predict", "method": "fem_linear", "case": case,
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": nu}},
        "plan": {"segments": [{"name": "bone", "translation_mm": moved}],
                 "growth": [{"region": "*", "volume_change": loss}]}});
    let done = server.job(&done).await.expect(StatusCode::OK);
    let after = &done["results"]["statistics"]["landmarks"];
    let target = |(name, at): (String, [f64; 3])| {
        let place: Vec<f64> = numbers(&after[&name]).iter().zip(at).map(|(u, at)| at + u).collect();
        json!({"point_mm": at, "position_mm": place, "sigma_mm": 0.3})
    };
    let targets: Vec<Value> = landmarks().into_iter().map(target).collect();
    let found = async |tissue: Value| {
        let mut spec = spec(&case, json!(targets), bounds(5.0, 0.0));
        spec["tissue_bounds"] = json!({ "*": tissue });
        let job = server.job(&spec).await.expect(StatusCode::OK);
        let warnings = job["results"]["warnings"].as_array().unwrap();
        let codes: Vec<String> =
            warnings.iter().map(|own| own["code"].as_str().unwrap().to_owned()).collect();
        (job["results"]["optimisation"].clone(), codes)
    };

    let free = json!({"volume_change": [-0.4, 0.4], "poisson_ratio": [0.2, 0.49]});
    let (both, codes) = found(free).await;
    let planned = numbers(&both["plan"]["segments"][0]["translation_mm"]);
    for (found, done) in planned.iter().zip(moved) {
        assert!((found - done).abs() < 1e-3, "{both}");
    }
    let growth = &both["plan"]["growth"][0];
    let ratio = both["materials"]["*"]["poisson_ratio"].as_f64().unwrap();
    assert_eq!(
        (&growth["region"], both["plan"]["growth"].as_array().unwrap().len()),
        (&json!("*"), 1)
    );
    assert!((growth["volume_change"].as_f64().unwrap() - loss).abs() < 1e-3, "{both}");
    assert!((ratio - nu).abs() < 1e-3, "{both}");
    let names: Vec<Value> = both["parameters"].as_array().unwrap()[3..]
        .iter()
        .map(|own| json!([own["region"], own["name"], own.get("segment")]))
        .collect();
    assert_eq!(names, [json!(["*", "volume_change", null]), json!(["*", "poisson_ratio", null])]);
    let correlation = both["correlation"].as_array().unwrap();
    assert!((correlation[4][4].as_f64().unwrap() - 1.0).abs() < 1e-12, "{both}");
    assert_eq!(correlation[3][4], correlation[4][3]);
    assert_eq!(both["degrees_of_freedom"], 16 * 3 - 5);
    assert!(both["residual_factor"].as_f64().unwrap() < 1e-3, "{both}");
    // The plan with growth and materials is solved in full.
    assert!(both["verified_difference_mm"].as_f64().unwrap() < 1e-4, "{both}");
    let is_told = |code: &str, codes: &[String]| codes.iter().any(|own| own == code);
    assert!(!is_told("growth-left-out", &codes), "{codes:?}");

    // Without loss the ratio is another one, and that is said.
    let (alone, codes) = found(json!({"poisson_ratio": [0.2, 0.49]})).await;
    let shifted = alone["materials"]["*"]["poisson_ratio"].as_f64().unwrap();
    assert!(is_told("growth-left-out", &codes) && (shifted - nu).abs() > 0.02, "{alone}");
    assert!(alone["residual_factor"].as_f64().unwrap() > 0.1, "{alone}");

    // What nothing tells is said too.
    let (modulus, codes) =
        found(json!({"volume_change": [-0.4, 0.4], "young_modulus_kpa": [1, 100]})).await;
    assert!(is_told("constant-not-determined", &codes), "{codes:?}");
    assert_eq!(modulus["undetermined"][0][0]["name"], "young_modulus_kpa", "{modulus}");
}

#[tokio::test]
async fn every_bad_target_and_bound_is_refused_with_its_place() {
    let server = Server::start_with(&["--workers", "0"]);
    let case = case(&server).await;
    for (name, change, code, pointer) in
        bad_targets().into_iter().chain(bad_bounds()).chain(bad_tissue())
    {
        let targets = json!([{"landmark": "p5", "displacement_mm": [1, 0, 0]}]);
        let mut spec = spec(&case, targets, bounds(10.0, 10.0));
        spec.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        let answer = ask(server.post("/v1/jobs").json(&spec)).await;
        let problem = answer.problem_of(name, 422, code);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{name}: {problem}");
    }
    let listed = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(listed["items"], json!([]), "nothing was accepted");
}
