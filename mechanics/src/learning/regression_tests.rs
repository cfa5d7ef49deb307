use super::*;
use crate::learning::features::{Distance, FeatureSpace, Features};
use crate::learning::hill_climb::{ClimbEnd, hill_climb};
use crate::learning::pairs::{blended, dot};

/// docs/verification.md#v32.
const X: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]];
const Y: [[f64; 1]; 3] = [[1.0], [2.0], [4.0]];

fn l1(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}

fn left_out<const N: usize>(x: &[[f64; 2]], y: &[[f64; N]]) -> LeaveOneOut {
    let answers: Vec<&[f64]> = y.iter().map(|y| y.as_slice()).collect();
    let distances = Pairs::of(x.len(), |i, j| l1(&x[i], &x[j]));
    LeaveOneOut::new(distances, Pairs::centred_products(&answers))
}

fn answer<const N: usize>(x: &[[f64; 2]], y: &[[f64; N]], query: [f64; 2], s: f64) -> Vec<f64> {
    let distances: Vec<f64> = x.iter().map(|x| l1(x, &query)).collect();
    let answers: Vec<&[f64]> = y.iter().map(|y| y.as_slice()).collect();
    blended(&weights(&distances, s), &answers)
}

#[test]
fn three_points_give_the_numbers_of_v32() {
    for (s, expected) in [(0.5, 1.6584473458), (1.0, 1.8884060087), (2.0, 2.0817413440)] {
        let found = answer(&X, &Y, [0.5, 0.5], s)[0];
        assert!((found - expected).abs() < 5e-11, "{s}: {found}");
    }
    let left_out = left_out(&X, &Y);
    for (s, expected) in [(0.5, 1.8909993), (1.0, 1.8471989), (2.0, 1.8252781), (10.0, 1.8530184)] {
        assert!((left_out.rmse(s) - expected).abs() < 5e-8, "{s}: {}", left_out.rmse(s));
    }
    let best = left_out.best_width();
    assert_eq!(best.end, WidthEnd::Inside);
    assert!((best.width - 2.05).abs() < 0.01 && (best.rmse - 1.825256).abs() < 5e-7, "{best:?}");
}

#[test]
fn the_papers_climb_ends_at_2_05_after_105_steps_and_never_selects() {
    let left_out = left_out(&X, &Y);
    let climb = hill_climb(|s| left_out.rmse(s), 10_000);
    assert_eq!((climb.steps, climb.end), (105, ClimbEnd::Alternates));
    assert!((climb.width - 2.05).abs() < 1e-12);
    // Both neighbours are worse, and the step is no smaller than it was: the rule has no fixed point.
    let [below, above] = [-0.01, 0.01].map(|step| left_out.rmse(climb.width + step));
    assert!(below > climb.rmse && above > climb.rmse);
}

#[test]
fn of_a_thousand_features_the_papers_climb_does_not_begin() {
    // L1 sums over many features are large: at a width of 1 only the nearest case is left, and no step changes that.
    let far: Vec<[f64; 2]> = X.iter().map(|x| x.map(|x| 1e4 * x)).collect();
    let left_out = left_out(&far, &Y);
    let climb = hill_climb(|s| left_out.rmse(s), 10_000);
    assert_eq!((climb.steps, climb.end), (0, ClimbEnd::Flat));
    let best = left_out.best_width();
    assert!(best.rmse < climb.rmse - 1e-3 && (best.width / 2.05e4 - 1.0).abs() < 0.01);
}

#[test]
fn five_points_have_no_width_of_their_own() {
    // The smaller the better: no width of its own.
    let x = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];
    let y = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.5]];
    let left_out = left_out(&x, &y);
    let expected = [
        (0.0, 0.760117),
        (0.25, 0.768880),
        (0.5, 0.824697),
        (1.0, 0.928200),
        (2.0, 1.020767),
        (f64::INFINITY, 1.145644),
    ];
    for (s, expected) in expected {
        assert!((left_out.rmse(s) - expected).abs() < 5e-7, "{s}: {}", left_out.rmse(s));
    }
    let best = left_out.best_width();
    assert_eq!((best.width, best.end), (0.0, WidthEnd::NearestNeighbour));
    let found = answer(&x, &y, [0.5, 0.25], 0.5);
    for (found, expected) in found.iter().zip([0.5268100415, 0.2820078953, 0.0089366805]) {
        assert!((found - expected).abs() < 5e-11, "{found}");
    }
}

#[test]
fn a_width_of_nothing_is_the_nearest_case_and_an_infinite_one_the_mean() {
    let query = [0.9, 0.2];
    assert_eq!(answer(&X, &Y, query, 0.0), [2.0]);
    assert!((answer(&X, &Y, query, 1e-3)[0] - 2.0).abs() < 1e-12);
    let mean = 7.0 / 3.0;
    assert!((answer(&X, &Y, query, f64::INFINITY)[0] - mean).abs() < 1e-15);
    assert!((answer(&X, &Y, query, 1e9)[0] - mean).abs() < 1e-8);
    // Two that are equally near share.
    assert_eq!(answer(&X, &Y, [0.5, 0.0], 0.0), [1.5]);
}

#[test]
fn where_features_say_nothing_the_mean_is_found() {
    let x = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]];
    let alternating = [[1.0], [-1.0], [1.0], [-1.0]];
    let best = left_out(&x, &alternating).best_width();
    assert_eq!((best.width, best.end), (f64::INFINITY, WidthEnd::Mean));
}

#[test]
fn features_and_width_scaled_alike_give_the_same() {
    // docs/verification.md#v33: what theta does to deviatoric stress the width takes back, so that theta cannot better
    // a regression whose width is searched.
    let [plain, scaled] = [1.0, 0.37].map(|c| left_out(&X.map(|x| x.map(|x| c * x)), &Y));
    for s in [0.5, 2.0, 7.0] {
        assert!((plain.rmse(s) - scaled.rmse(0.37 * s)).abs() < 1e-12);
        let far = answer(&X.map(|x| x.map(|x| 0.37 * x)), &Y, [0.185, 0.185], 0.37 * s);
        assert!((answer(&X, &Y, [0.5, 0.5], s)[0] - far[0]).abs() < 1e-12);
    }
    let [plain, scaled] = [plain, scaled].map(|own| own.best_width());
    assert!((plain.rmse - scaled.rmse).abs() < 1e-12);
    assert!((scaled.width / plain.width - 0.37).abs() < 1e-5);
}

#[test]
fn theta_over_all_features_changes_no_prediction_once_features_are_standardised() {
    let cases = |theta: f64| -> Vec<Features> {
        X.iter().map(|x| Features { blocks: vec![x.map(|x| theta * x).to_vec()] }).collect()
    };
    for distance in [Distance::L1, Distance::L2] {
        let [plain, other] = [1.0, 0.9].map(|theta| {
            let space = FeatureSpace::new(&cases(theta), distance);
            space.distances(&[0, 1, 2])
        });
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            assert!((plain.at(i, j) - other.at(i, j)).abs() < 1e-12);
        }
    }
}

#[test]
fn errors_from_products_are_those_of_the_vectors() {
    let left_out = left_out(&X, &[[1.0, 5.0], [2.0, -1.0], [4.0, 0.5]]);
    let y: [&[f64]; 3] = [&[1.0, 5.0], &[2.0, -1.0], &[4.0, 0.5]];
    let w = weights(&[1.0, 3.0], 0.7);
    let missed: Vec<f64> =
        blended(&w, &[y[0], y[2]]).iter().zip(y[1]).map(|(a, b)| a - b).collect();
    assert!((left_out.squared_error(1, 0.7) - dot(&missed, &missed)).abs() < 1e-12);
}
