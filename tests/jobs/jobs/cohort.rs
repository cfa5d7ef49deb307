//! Methods over a cohort of twins: the table, the boxes and the test that a paper shows.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use facies::jobs::{
    CohortInput, CompareInput, JobContext, JobInput, StoredMesh, StoredShape, work,
};
use facies::schema::Limits;
use facies::schema::cohort::result::{CohortPairDocument, CohortResultDocument};
use facies::schema::compare::result::ComparisonDocument;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

const TWINS: usize = 10;

/// The top of a block, lifted by so many mm.
fn skin(lifted: f64) -> StoredMesh {
    let mesh = block(Vector::new(60.0, 40.0, 20.0), [12, 8, 4], CellShape::Hex8);
    let mut skin: TriangleSurface = mesh.surface_of(&mesh.boundary_faces());
    let points = skin.points.clone();
    skin.triangles.retain(|t| t.iter().all(|&corner| points[corner as usize].z > 19.9));
    skin.points.iter_mut().for_each(|point| point.z += lifted);
    StoredMesh { frame: None, ..stored(StoredShape::Surface(skin.into()), None) }
}

/// What a method found of a twin, whose scan lies at 0.
fn comparison(error: f64) -> ComparisonDocument {
    let sources = Meshes(BTreeMap::from([
        ("predicted".to_owned(), skin(error)),
        ("scan".to_owned(), skin(0.0)),
    ]));
    let spec = json!({"prediction": {"mesh": "predicted"}, "actual": {"mesh": "scan"},
        "regions": {"left": {"box_mm": [-1, -1, -1, 30, 41, 41]}}});
    let spec = serde_json::from_value(spec).unwrap();
    let input = JobInput::Compare(CompareInput { job: None, queue_s: None, spec });
    let out = tempfile::tempdir().unwrap();
    let place = JobContext { sources: &sources, limits: &Limits::default(), out: out.path() };
    work(&input, &place, &Unobserved).unwrap().result.comparison.unwrap()
}

fn cohort(
    spec: Value,
    comparisons: &BTreeMap<String, ComparisonDocument>,
) -> Result<CohortResultDocument, String> {
    cohort_in(tempfile::tempdir().unwrap().path(), spec, comparisons)
}

fn cohort_in(
    out: &Path,
    spec: Value,
    comparisons: &BTreeMap<String, ComparisonDocument>,
) -> Result<CohortResultDocument, String> {
    let spec = serde_json::from_value(spec).unwrap();
    let comparisons = comparisons.clone();
    let actuals = BTreeMap::new();
    let input = CohortInput { job: None, queue_s: None, spec, cohort: None, comparisons, actuals };
    let input = JobInput::Cohort(input);
    let sources = Meshes(BTreeMap::new());
    let place = JobContext { sources: &sources, limits: &Limits::default(), out };
    let done = work(&input, &place, &Unobserved).map_err(|error| format!("{error:?}"))?;
    Ok(done.result.cohort.unwrap())
}

#[test]
fn lists_in_another_order_and_a_patient_who_stands_twice_are_reported() {
    let names = ["a 0", "a 1", "b 0", "b 1"];
    let comparisons: BTreeMap<String, ComparisonDocument> =
        names.map(|name| (name.to_owned(), comparison(0.5))).into();
    let told = |groups: Value| -> Vec<String> {
        let spec = serde_json::from_value(json!({"groups": groups})).unwrap();
        let actuals = names.map(|name| (name.to_owned(), name[2..].to_owned())).into();
        let comparisons = comparisons.clone();
        let input =
            CohortInput { job: None, queue_s: None, spec, cohort: None, comparisons, actuals };
        let (out, sources) = (tempfile::tempdir().unwrap(), Meshes(BTreeMap::new()));
        let place = JobContext { sources: &sources, limits: &Limits::default(), out: out.path() };
        let done = work(&JobInput::Cohort(input), &place, &Unobserved).unwrap();
        done.result.warnings.into_iter().map(|warning| warning.code).collect()
    };
    assert_eq!(told(json!({"a": ["a 0", "a 1"], "b": ["b 0", "b 1"]})), [""; 0]);
    assert_eq!(told(json!({"a": ["a 0", "a 1"], "b": ["b 1", "b 0"]})), ["subjects-differ"]);
    let twice = told(json!({"a": ["a 0", "a 1"], "b": ["b 0", "b 0"]}));
    assert_eq!(twice, ["subjects-differ", "subject-twice"]);
}

fn ids(method: &str) -> Vec<String> {
    (0..TWINS).map(|twin| format!("{method} {twin}")).collect()
}

/// Twin i is missed by .5 + .05 i mm by one method, and by (i + 1) / 50 mm less by the other, but for the last two.
fn twins() -> BTreeMap<String, ComparisonDocument> {
    let mut comparisons = BTreeMap::new();
    for twin in 0..TWINS {
        let error = 0.5 + 0.05 * twin as f64;
        let better = if twin < 8 { -0.02 } else { 0.02 } * (twin + 1) as f64;
        comparisons.insert(format!("mtm {twin}"), comparison(error));
        comparisons.insert(format!("fibres {twin}"), comparison(error + better));
    }
    comparisons
}

#[test]
fn ten_twins_give_a_table_boxes_and_an_exact_test() {
    let groups = json!({"mtm": ids("mtm"), "fibres": ids("fibres")});
    let found = cohort(json!({"groups": groups, "statistic": "mean"}), &twins()).unwrap();
    // One row for each subject, with mean, sd, p90 and p95: the shape of table 3 of Kim et al. 2012.
    let [fibres, mtm] = &found.groups[..] else { panic!("{:?}", found.groups) };
    assert_eq!((fibres.name.as_str(), mtm.name.as_str(), mtm.rows.len()), ("fibres", "mtm", TWINS));
    for (twin, row) in mtm.rows.iter().enumerate() {
        let error = 0.5 + 0.05 * twin as f64;
        assert_eq!(row.subject, (twin + 1).to_string());
        for value in [row.distances.mean, row.distances.p90, row.distances.p95] {
            assert!((value - error).abs() < 1e-9, "{row:?}");
        }
        assert!(row.distances.sd < 1e-6, "{row:?}");
    }
    let over = &mtm.over_subjects;
    for (value, wanted) in [
        (over.min, 0.5),
        (over.p25, 0.6125),
        (over.median, 0.725),
        (over.p75, 0.8375),
        (over.max, 0.95),
    ] {
        assert!((value - wanted).abs() < 1e-9, "{over:?}");
    }
    // Ranks 9 and 10 speak for mtm: W 36 and 19. Of 1024 signs 406 give a sum of 19 or less on one side.
    let [pair] = &found.pairs[..] else { panic!("{:?}", found.pairs) };
    assert_eq!((pair.first.as_str(), pair.second.as_str()), ("fibres", "mtm"));
    assert_eq!((pair.w_first_larger, pair.w_second_larger, pair.differing), (19.0, 36.0, 10));
    let below = (0..1024_u32).filter(|signs| {
        (0..10).filter(|rank| signs >> rank & 1 == 1).map(|rank| rank + 1).sum::<u32>() <= 19
    });
    let exact = 2.0 * below.count() as f64 / 1024.0;
    assert!((pair.p.unwrap() - exact).abs() < 1e-12 && pair.is_exact, "{pair:?} {exact}");
    assert_eq!(pair.smallest_p, 2.0 / 1024.0);
    // Half-way between both differences in the middle, whichever group comes first.
    assert!((pair.median_difference_mm + 0.07).abs() < 1e-9, "{pair:?}");
}

#[test]
fn a_cohort_is_drawn_and_tabled_for_a_paper() {
    let groups = json!({"mtm": ids("mtm"), "with, fibres": ids("fibres")});
    let out = tempfile::tempdir().unwrap();
    let found = cohort_in(out.path(), json!({"groups": groups}), &twins()).unwrap();
    let table = fs::read_to_string(out.path().join("cohort.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 1 + 2 * TWINS);
    assert!(rows[0].starts_with("group,subject,points,mean_mm,sd_mm"), "{}", rows[0]);
    // The same numbers as the result, to the bit.
    let numbers: Vec<f64> = rows[1].split(',').skip(3).map(|own| own.parse().unwrap()).collect();
    let row = &found.groups[0].rows[0].distances;
    assert_eq!((numbers[0], numbers[1], numbers[10]), (row.mean, row.sd, row.max));
    assert!(rows[11].starts_with("\"with, fibres\",1,"), "{}", rows[11]);
    let picture = fs::read_to_string(out.path().join("cohort.svg")).unwrap();
    assert_eq!(picture.matches("class=\"group\"").count(), 2);
    assert_eq!(picture.matches("class=\"subject\"").count(), 2 * TWINS);
    for words in
        ["p = 0.43", "W 36 and 19 of 10 that differ", "mtm less with, fibres", "10 subjects"]
    {
        assert!(picture.contains(words), "{words}");
    }
    if let Ok(kept) = std::env::var("FACIES_TEST_PICTURES") {
        fs::write(Path::new(&kept).join("cohort.svg"), &picture).unwrap();
    }
}

#[test]
fn a_cohort_of_equals_has_no_p_and_five_subjects_cannot_reach_a_twentieth() {
    let comparisons = twins();
    let same = json!({"groups": {"a": ids("mtm"), "b": ids("mtm")}});
    let found = cohort(same, &comparisons).unwrap();
    assert_eq!((found.pairs[0].p, found.pairs[0].differing), (None, 0));
    let five =
        json!({"groups": {"a": &ids("mtm")[..5], "b": &ids("fibres")[..5]}, "region": "left"});
    let found = cohort(five, &comparisons).unwrap();
    assert_eq!((found.pairs[0].p, found.pairs[0].smallest_p), (Some(0.0625), 0.0625));
}

#[test]
fn a_cohort_says_which_comparison_does_not_serve() {
    let comparisons = twins();
    for (spec, at) in [
        (json!({"groups": {}}), "/spec/groups"),
        (json!({"groups": {"a": ["mtm 0"], "b": []}}), "/spec/groups/b"),
        (json!({"groups": {"a": ["mtm 0"]}, "subjects": ["x", "y"]}), "/spec/subjects"),
        (json!({"groups": {"a": ["mtm 0"]}, "distance": "tps_cp"}), "/spec/groups/a/0"),
        (json!({"groups": {"a": ["mtm 0"]}, "region": "lips"}), "/spec/groups/a/0"),
        (
            json!({"groups": {"a": ["mtm 0"]}, "distance": "node_wise", "region": "left"}),
            "/spec/region",
        ),
    ] {
        let refused = cohort(spec.clone(), &comparisons).unwrap_err();
        assert!(refused.contains(at), "{spec}: {refused}");
    }
}

#[test]
fn twins_are_modelled_in_four_ways_beside_what_happened_and_no_movement() {
    let none = BTreeMap::new();
    let found = cohort(json!({"virtual": {"patients": 3, "seed": 7}}), &none).unwrap();
    let names: Vec<&str> = found.groups.iter().map(|group| group.name.as_str()).collect();
    let variants = ["homogeneous", "muscles", "sliding", "muscles and sliding"];
    assert_eq!(names, [&variants[..], &["what happened", "no movement"]].concat());
    assert!(found.groups.iter().all(|group| group.rows.len() == 3));
    let mean = |group: usize, row: usize| found.groups[group].rows[row].distances.mean;
    for twin in 0..3 {
        // The errors of measuring are below every model, and every model below none.
        assert!((0.05..0.4).contains(&mean(4, twin)), "{}", mean(4, twin));
        for variant in 0..4 {
            assert!(mean(4, twin) < mean(variant, twin) && mean(variant, twin) < mean(5, twin));
        }
        // The same truth by two models: muscles and sliding change the answer.
        assert!((mean(0, twin) - mean(1, twin)).abs() > 1e-3);
        assert!((mean(0, twin) - mean(2, twin)).abs() > 1e-3);
    }
    assert_eq!(found.pairs.len(), 6);
    let tested = |pair: &CohortPairDocument| variants.contains(&pair.second.as_str());
    assert!(found.pairs.iter().all(|pair| pair.is_exact && tested(pair)), "{:?}", found.pairs);
    // With three twins no p is below a quarter.
    assert!(found.pairs.iter().all(|pair| pair.smallest_p == 0.25), "{:?}", found.pairs);
}

#[test]
fn what_is_wrong_with_twins_is_reported_before_any_is_made() {
    let none = BTreeMap::new();
    let twins = || json!({"patients": 3});
    for (spec, at) in [
        (json!({"virtual": {"patients": 2}}), "/spec/virtual/patients"),
        (json!({"virtual": {"patients": 26}}), "/spec/virtual/patients"),
        (json!({"virtual": {"patients": 3, "fineness": 3}}), "/spec/virtual/fineness"),
        (json!({"virtual": twins(), "groups": {"a": ["b"]}}), "`groups`, `cohort`, `virtual`"),
        (json!({"virtual": twins(), "region": "ear"}), "/spec/region"),
        (json!({"virtual": twins(), "distance": "tps_cp"}), "/spec/distance"),
        (json!({"virtual": twins(), "subjects": ["one"]}), "/spec/subjects"),
        (json!({"groups": {}}), "/spec/groups"),
    ] {
        let refused = cohort(spec.clone(), &none).unwrap_err();
        assert!(refused.contains(at), "{spec}: {refused}");
    }
}
