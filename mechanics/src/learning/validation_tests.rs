//! What validation shows on cohorts whose truth is known.

use std::collections::BTreeMap;

use super::cohort::{Cohort, LearningCase, Pool};
use super::curve::learning_curve;
use super::features::{Distance, Features};
use super::learner::{Learner, Method, Target};
use super::model::{LearnedModel, PreoperativeCase, Refusal};
use super::validation::{Column, validate};
use crate::draws::Draws;
use crate::study::paired::{Equality, ZeroRule, signed_rank};

const POINTS: usize = 12;

const CORRECTED: Method = Method { learner: Learner::Regression, target: Target::Residual };

const CORRECTED_BY_MODES: Method =
    Method { learner: Learner::DeformationModel, target: Target::Residual };

/// Cases of two numbers x: mechanics knows the movement but for `missed` (x) and noise.
fn cohort(count: usize, missed: impl Fn([f64; 2]) -> f64, noise: f64, seed: u64) -> Cohort {
    let mut draws = Draws::of(seed, 0);
    let mut case = |number: usize| {
        let x = [draws.between(-1.0, 1.0), draws.between(-1.0, 1.0)];
        let wave = |k: usize| ((k + 1) as f64 * 0.7).sin();
        let predicted: Vec<f64> =
            (0..3 * POINTS).map(|k| 5.0 * (x[0] * wave(k) + x[1] * wave(2 * k))).collect();
        let actual = predicted.iter().enumerate();
        let actual = actual
            .map(|(k, told)| told + missed(x) * wave(k + 3) + noise * draws.normal())
            .collect();
        LearningCase {
            name: number.to_string(),
            class: (if x[0] < 0.0 { "left" } else { "right" }).to_owned(),
            features: Features { blocks: vec![x.to_vec()] },
            bone: x.to_vec(),
            predicted,
            actual,
        }
    };
    let cases = (0..count).map(&mut case).collect();
    let regions = BTreeMap::from([("lips".to_owned(), vec![0, 1, 2])]);
    Cohort::new(cases, regions, "linear").expect("a cohort")
}

fn mechanics(cohort: &Cohort) -> Column {
    let told: Vec<Vec<f64>> = cohort.cases.iter().map(|case| case.predicted.clone()).collect();
    Column::of("linear", &told, cohort)
}

#[test]
fn what_mechanics_misses_in_the_same_way_is_learned() {
    let cohort = cohort(40, |x| 2.0 + x[0], 0.05, 3);
    let [before, after] = [mechanics(&cohort), validate(&cohort, CORRECTED, Distance::L1).nested];
    assert!(after.mean() < 0.4 * before.mean(), "{} of {}", after.mean(), before.mean());
    assert!(after.region("lips") < before.region("lips") && after.region("chin").is_none());
}

#[test]
fn errors_of_points_are_means_over_cases_whose_mean_is_that_of_the_column() {
    let cohort = cohort(5, |x| 2.0 + x[0], 0.05, 3);
    let column = mechanics(&cohort);
    let of_point = |point: usize| {
        let apart = |case: &LearningCase| {
            let at = 3 * point..3 * point + 3;
            let both = case.predicted[at.clone()].iter().zip(&case.actual[at]);
            both.map(|(told, actual)| (told - actual).powi(2)).sum::<f64>().sqrt()
        };
        cohort.cases.iter().map(apart).sum::<f64>() / 5.0
    };
    assert_eq!(column.points.len(), cohort.cases[0].actual.len() / 3);
    for (point, error) in column.points.iter().enumerate() {
        assert!((error - of_point(point)).abs() < 1e-12, "point {point}");
    }
    let mean = column.points.iter().sum::<f64>() / column.points.len() as f64;
    assert!((mean - column.mean()).abs() < 1e-12);
}

#[test]
fn what_mechanics_misses_by_chance_makes_learning_harm() {
    let cohort = cohort(11, |_| 0.0, 1.0, 5);
    let [before, after] = [mechanics(&cohort), validate(&cohort, CORRECTED, Distance::L1).nested];
    assert!(after.mean() > before.mean(), "{} of {}", after.mean(), before.mean());
}

#[test]
fn modes_that_are_chosen_by_leaving_out_harm_less_than_those_of_variance() {
    let by_variance =
        Method { learner: Learner::DeformationModelByVariance, target: Target::Residual };
    let of = |cohort: &Cohort| {
        [CORRECTED_BY_MODES, by_variance].map(|own| validate(cohort, own, Distance::L1))
    };
    let noise = cohort(30, |_| 0.0, 1.0, 5);
    let [chosen, variance] = of(&noise);
    let mechanics = mechanics(&noise).mean();
    // The mean of 29 noises adds 1.7 % to noise.
    assert!(chosen.nested.mean() < 1.05 * mechanics, "{} of {mechanics}", chosen.nested.mean());
    assert!(variance.nested.mean() > chosen.nested.mean(), "{}", variance.nested.mean());
    assert!(variance.modes.expect("a model of modes").count > 10);
    // What follows bone is found.
    let [chosen, _] = of(&cohort(30, |x| 2.0 * x[0], 0.01, 5));
    assert!(chosen.nested.mean() < 0.1 && chosen.modes.expect("modes").count >= 1);
    assert!(variance.plain.is_none() && chosen.plain.is_some());
}

#[test]
fn what_another_class_misses_is_not_what_ones_own_does() {
    // Cases to the left are missed by 2 mm one way, those to the right the other way.
    let cohort = cohort(30, |x| 2.0 * x[0].signum(), 0.05, 3);
    let validated = validate(&cohort, CORRECTED, Distance::L1);
    let other = validated.other_classes.expect("two classes");
    let before = mechanics(&cohort).mean();
    assert!(validated.nested.mean() < 0.7 * before);
    assert!(other.column.mean() > 1.8 * before, "{} of {before}", other.column.mean());
    assert!(other.is_refused.iter().filter(|own| **own).count() > 10);
    let curve = learning_curve(&cohort, CORRECTED, Distance::L1, Pool::OtherClasses, 1);
    let fewest = cohort.smallest_pool(Pool::OtherClasses);
    assert_eq!(curve.last().map(|point| point.cases), Some(fewest));
    assert!(curve.iter().all(|point| point.error > before));
    // In one class there is no other.
    let mut one = cohort;
    one.cases.iter_mut().for_each(|case| case.class = "one".to_owned());
    assert_eq!(validate(&one, CORRECTED, Distance::L1).other_classes, None);
    assert!(learning_curve(&one, CORRECTED, Distance::L1, Pool::OtherClasses, 1).is_empty());
}

#[test]
fn tuning_on_the_held_out_case_flatters() {
    let gains: Vec<f64> = (0..20)
        .map(|seed| {
            let own = validate(&cohort(11, |x| x[0] * x[1], 0.7, seed), CORRECTED, Distance::L1);
            own.nested.mean() - own.plain.expect("a width is tuned").mean()
        })
        .collect();
    assert!(gains.iter().sum::<f64>() > 0.0, "{gains:?}");
}

#[test]
fn a_held_out_case_has_no_part_in_its_own_prediction() {
    let original = cohort(12, |x| 2.0 * x[1], 0.1, 9);
    let mut changed = original.clone();
    changed.cases[4].actual.iter_mut().for_each(|value| *value += 100.0);
    for method in Method::ALL {
        let [one, other] = [&original, &changed].map(|own| validate(own, method, Distance::L2));
        for (a, b) in one.displacement[4].iter().zip(&other.displacement[4]) {
            // Products are taken from a mean that the change moves: rounding.
            assert!((a - b).abs() < 1e-6, "{method:?}: {a} {b}");
        }
        assert_ne!(one.displacement[5], other.displacement[5]);
    }
}

#[test]
fn bands_hold_what_they_say_to_three_points() {
    for method in [CORRECTED, CORRECTED_BY_MODES] {
        for (count, seeds) in [(11, 30), (30, 4)] {
            let mut held = 0.0;
            for seed in 0..seeds {
                let cohort = cohort(count, |x| 1.0 + x[0], 0.5, seed);
                let coverage = validate(&cohort, method, Distance::L1).coverage.expect("enough");
                held += coverage / seeds as f64;
            }
            assert!((held - 0.8).abs() < 0.03, "{method:?}, {count}: {held}");
        }
    }
    assert_eq!(validate(&cohort(9, |_| 1.0, 0.5, 1), CORRECTED, Distance::L1).coverage, None);
}

#[test]
fn more_cases_teach_more_until_noise_is_all_that_is_left() {
    let cohort = cohort(60, |x| 2.0 + x[0] + x[1], 0.05, 3);
    let curve = learning_curve(&cohort, CORRECTED, Distance::L1, Pool::Others, 1);
    let sizes: Vec<usize> = curve.iter().map(|point| point.cases).collect();
    assert_eq!(sizes, [3, 5, 8, 10, 15, 20, 30, 45, 59]);
    assert!(curve[8].error < 0.6 * curve[0].error, "{curve:?}");
}

#[test]
fn a_case_unlike_all_others_is_refused_with_its_distance() {
    let cohort = cohort(30, |x| 2.0 + x[0], 0.05, 3);
    let model = LearnedModel::new(&cohort, CORRECTED, Distance::L1);
    let predicted = vec![0.0; 3 * POINTS];
    let ask = |x: f64| {
        let features = Features { blocks: vec![vec![x, x]] };
        model.correct(PreoperativeCase {
            features: &features,
            bone: &[x, x],
            predicted: &predicted,
        })
    };
    let found = ask(0.1).expect("it is in the middle of the cases");
    assert!(found.distance <= model.fitted.farthest && found.displacement.len() == 3 * POINTS);
    match ask(5.0) {
        Err(Refusal::OutOfDistribution { distance, farthest, .. }) => assert!(distance > farthest),
        other => panic!("{other:?}"),
    }
    let features = Features { blocks: vec![vec![0.0; 3]] };
    let other_mesh = model.correct(PreoperativeCase {
        features: &features,
        bone: &[0.0; 2],
        predicted: &predicted,
    });
    let what = "a feature";
    assert_eq!(other_mesh, Err(Refusal::OtherMesh { what, found: 3, expected: 2 }));
}

/// Zhang et al. 2016, table 1: E of SDM, LFEM and RBM in mm.
const TABLE_1: [[f64; 3]; 11] = [
    [3.6352, 1.3241, 0.9484],
    [1.8381, 0.8054, 0.5632],
    [5.0321, 1.2456, 0.7096],
    [2.9817, 0.7389, 0.6345],
    [2.2543, 0.8567, 0.4521],
    [3.3946, 0.9391, 0.7784],
    [3.8809, 1.1490, 0.7840],
    [4.5982, 0.8845, 0.4738],
    [3.1190, 0.9978, 0.7914],
    [2.1845, 0.9531, 0.8463],
    [3.3014, 0.9821, 0.7566],
];

#[test]
fn the_papers_table_has_its_means_and_the_smallest_p_of_eleven() {
    let column = |which: usize| TABLE_1.map(|row| row[which]);
    let mean = |values: [f64; 11]| values.iter().sum::<f64>() / 11.0;
    for (which, expected) in [(0, 3.2927), (1, 0.9888), (2, 0.7035)] {
        assert!((mean(column(which)) - expected).abs() < 5e-5);
    }
    let b_max = [
        11.6847, 6.1581, 7.3624, 7.2343, 8.3622, 10.5866, 13.4578, 7.3898, 10.5032, 6.1608, 13.6617,
    ];
    assert!((mean(b_max) - 9.3238).abs() < 5e-5);
    let equality = Equality { within: 0.0, zeros: ZeroRule::Wilcox };
    for (first, second) in [(1, 2), (0, 1), (0, 2)] {
        let test = signed_rank(&column(first), &column(second), equality).expect("they differ");
        // All eleven are better: no eleven pairs can give less, and the paper states no test at all.
        assert_eq!((test.positive, test.two_sided_p), (66.0, 0.0009765625));
        assert_eq!(test.smallest_p, test.two_sided_p);
    }
}
