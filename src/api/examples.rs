//! Examples of request bodies, for the pages of the OpenAPI description: all of the block in `examples/block`, with ids
//! as placeholders for those of a reader's meshes, cases and jobs.

use serde_json::{Map, Value, json};

pub const VOLUME: &str = "0199d3a0-0000-7000-8000-000000000001";
pub const BONE: &str = "0199d3a0-0000-7000-8000-000000000002";
pub const CASE: &str = "0199d3a0-0000-7000-8000-000000000003";
pub const PLAN: &str = "0199d3a0-0000-7000-8000-000000000004";
pub const SCAN: &str = "0199d3a0-0000-7000-8000-000000000006";
const SKIN: &str = "0199d3a0-0000-7000-8000-000000000007";
const SKULL: &str = "0199d3a0-0000-7000-8000-000000000008";
pub const JOB: &str = "0199d3a0-0000-7000-8000-000000000005";
/// Of a comparison job.
const COMPARISON: &str = "0199d3a0-0000-7000-8000-000000000009";

/// Writes examples beside the schema of every JSON body of the operations.
pub fn add(paths: &mut Value) {
    let items = paths.as_object_mut().into_iter().flat_map(Map::values_mut);
    for operation in items.filter_map(Value::as_object_mut).flat_map(Map::values_mut) {
        let name = operation["operationId"].as_str().unwrap_or_default().to_owned();
        let content = operation.pointer_mut("/requestBody/content/application~1json");
        let Some(content) = content.and_then(Value::as_object_mut) else { continue };
        let examples = of(&name).into_iter();
        let examples = examples.map(|(name, value)| (name.to_owned(), json!({ "value": value })));
        content.insert("examples".to_owned(), Value::Object(examples.collect()));
    }
}

/// The examples of an operation, each with its name.
fn of(operation: &str) -> Vec<(&'static str, Value)> {
    match operation {
        "create_case" => vec![("case", case()), ("scan to be meshed", scanned())],
        "check_case" => vec![("nothing moves", json!({})), ("plan", json!({ "plan": plan() }))],
        "create_plan" | "replace_plan" => vec![("movements", plan()), ("loads", loads())],
        "create_cohort" => vec![("cohort", cohort())],
        "apply_response" => vec![("plan", json!({ "plan": plan() }))],
        "create_job" => jobs(),
        "change_job" => {
            let tags = json!({"add": ["main"], "remove": ["draft"]});
            vec![("tags", json!({ "tags": tags }))]
        }
        "create_key" => {
            let scopes = ["read", "write", "run"];
            vec![("key", json!({"label": "planning station", "scopes": scopes, "days": 365}))]
        }
        "rotate_key" => vec![("rotation", json!({"overlap_h": 24}))],
        _ => Vec::new(),
    }
}

fn case() -> Value {
    json!({
        "schema": 1, "name": "block", "units": "mm", "frame": "LPS",
        "volume": VOLUME,
        "bones": [{"name": "mandible", "mesh": BONE}],
        "landmarks": {"pogonion": [60, 30, 20]},
        "regions": {"array": "layer", "names": {"0": "deep", "1": "skin"}},
        "skin": {"node_set": "skin"},
        "segments": [{"name": "mandible", "nodes": {"node_set": "mandible"}}],
        "fixed": [{"node_set": "skull"}],
        "materials": {
            "skin": {"young_modulus_kpa": 40, "poisson_ratio": 0.45},
            "*": {"young_modulus_kpa": 10, "poisson_ratio": 0.45},
        },
    })
}

fn scanned() -> Value {
    json!({
        "name": "head",
        "meshing": {
            "kind": "mesh", "scan": SCAN, "size": {"tetrahedra": 20_000},
            "osteotomy": {
                "cuts": [{"name": "le-fort-1", "point_mm": [60, 55, 60], "normal": [0, -0.24, 1]}],
                "segments": [{"name": "maxilla", "below": ["le-fort-1"]}],
            },
        },
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}},
    })
}

fn plan() -> Value {
    json!({
        "name": "jaw to the left",
        "frame": "LPS",
        "segments": [{
            "name": "mandible", "translation_mm": [4, 0, 1], "rotation_deg": [0, 5, 0], "pivot_mm": [40, 30, 0],
        }],
    })
}

fn loads() -> Value {
    json!({
        "segments": [{"name": "mandible", "translation_mm": [4, 0, 0]}],
        "loads": [
            {"gravity_m_per_s2": [0, 0, -9.81]},
            {"pressure_kpa": 0.1, "faces": {"node_set": "skin"}},
        ],
    })
}

/// Three operated blocks, the last with consent for comparison only.
fn cohort() -> Value {
    let id = |group: u32, number: u32| format!("0199d3a0-0000-7000-8000-0000000000{group}{number}");
    let member = |number: u32| {
        json!({
            "prediction": id(1, number), "actual": id(2, number), "name": format!("P{number}"),
            "comparisons": {"linear": id(3, number)},
        })
    };
    let mut members = [1, 2, 3].map(member);
    members[0]["class"] = "one_jaw".into();
    members[1]["matrix4x4"] = json!([1, 0, 0, 0.4, 0, 1, 0, -0.2, 0, 0, 1, 0, 0, 0, 0, 1]);
    members[2]["consent"] =
        json!({"statement": "consent form 4, errors only", "uses": ["compare"]});
    json!({
        "name": "one jaw, 2026",
        "consent": {"statement": "consent form 4, signed by each", "uses": ["learn", "compare"]},
        "members": members,
    })
}

/// One of each kind of job, and other frequent ones.
fn jobs() -> Vec<(&'static str, Value)> {
    [predictions(), meshings(), responses_and_plans(), studies()].concat()
}

fn predictions() -> Vec<(&'static str, Value)> {
    vec![
        (
            "predict",
            json!({
                "kind": "predict", "case": CASE, "plan": plan(), "method": "auto", "outputs": ["skin.vtp", "skin.glb"],
            }),
        ),
        ("predict a stored plan", json!({"kind": "predict", "case": CASE, "plan_id": PLAN})),
        (
            "predict with a membrane",
            json!({
                "kind": "predict", "case": CASE, "plan": plan(),
                "membrane": {"thickness_mm": 1.5, "young_modulus_kpa": 200, "poisson_ratio": 0.45},
                "materials": {"deep": {"young_modulus_kpa": 15}},
            }),
        ),
        (
            "compare",
            json!({
                "kind": "compare", "prediction": {"job": JOB}, "actual": {"mesh": BONE}, "align": {"method": "none"},
            }),
        ),
        (
            "cohort",
            json!({"kind": "cohort", "groups": {"fem_linear": [COMPARISON], "mtm": [COMPARISON]}, "subjects": ["first"]}),
        ),
        ("learn", json!({"kind": "learn", "virtual": {"patients": 3, "fineness": 1}})),
        (
            "reproduce",
            json!({
                "kind": "reproduce", "before": {"mesh": BONE}, "after": {"mesh": BONE},
                "base": {"mask": {"box_mm": [-200, -200, -200, 200, 200, 200]}},
                "segments": [{"name": "mandible", "before": {"mesh": BONE}}],
            }),
        ),
        (
            "conform",
            json!({
                "kind": "conform",
                "template": {"mesh": VOLUME, "skin": "skin", "segments": {"mandible": "mandible"}, "fixed": "skull"},
                "patient": {"skin": SKIN, "bone": SKULL},
                "landmarks": {"pogonion": {"template_mm": [0, -80, 10], "patient_mm": [3, -92, 14]}},
            }),
        ),
    ]
}

fn meshings() -> Vec<(&'static str, Value)> {
    vec![
        (
            "mesh from a scan",
            json!({
                "kind": "mesh",
                "scan": SCAN,
                "osteotomy": {
                    "cuts": [{"name": "le-fort-1", "point_mm": [60, 55, 60], "normal": [0, -0.24, 1]}],
                    "segments": [{"name": "maxilla", "below": ["le-fort-1"]}],
                },
                "size": {"tetrahedra": 100_000},
            }),
        ),
        (
            "mesh between surfaces",
            json!({
                "kind": "mesh",
                "surfaces": {"skin": SKIN, "bone": SKULL},
                "osteotomy": {
                    "cuts": [{"name": "le-fort-1", "point_mm": [60, 55, 60], "normal": [0, -0.24, 1]}],
                    "segments": [{"name": "maxilla", "below": ["le-fort-1"]}],
                },
                "size": {"tetrahedra": 20_000},
            }),
        ),
    ]
}

fn responses_and_plans() -> Vec<(&'static str, Value)> {
    let bounds = json!({"translation_mm": [[-10, 10], [0, 0], [-5, 5]]});
    vec![
        ("response", json!({"kind": "response", "case": CASE, "segments": ["mandible"]})),
        (
            "optimise",
            json!({
                "kind": "optimise", "case": CASE,
                "targets": [
                    {"nodes": {"node_set": "skin"}, "displacement_mm": [2, null, null]},
                    {"landmark": "pogonion", "displacement_mm": [3, 0, null], "sigma_mm": 0.5},
                ],
                "bounds": {"mandible": bounds},
            }),
        ),
    ]
}

fn studies() -> Vec<(&'static str, Value)> {
    vec![
        (
            "study",
            json!({
                "kind": "study", "scenes": ["slab", {"case": CASE, "name": "block"}],
                "plans": ["patch 4 mm", plan()], "methods": ["fem_linear", "mtm"], "elements": ["plain", "stabilised"],
                "levels": [0], "repeats": 1, "thresholds": {"p95_mm": 1.0},
            }),
        ),
        (
            "study of a sweep",
            json!({
                "kind": "study", "scenes": [{"case": CASE}], "plans": [plan()], "methods": ["fem_linear"],
                "sweep": {"*": {"young_modulus_kpa": [10, 20, 40], "poisson_ratio": [0.43, 0.47]}}, "repeats": 1,
            }),
        ),
        (
            "batch",
            json!({
                "kind": "batch", "truth": {"refine": 1, "element": "mean_dilatation"}, "repeats": 1,
                "items": [
                    {"case": CASE, "plan_id": PLAN, "method": "fem_linear", "label": "reference"},
                    {"case": CASE, "plan": plan(), "method": "fem_linear", "element": "plain"},
                ],
            }),
        ),
    ]
}
