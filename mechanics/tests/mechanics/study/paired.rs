//! Wilcoxon's signed rank test and the comparison of variants (docs/verification.md#v40, docs/verification.md#v44).

use mechanics::study::paired::{Equality, PairedError, SignedRank, ZeroRule, signed_rank};
use mechanics::study::pairwise::{Measure, compare_variants, many_comparisons};
use mechanics::study::report::Solved;
use mechanics::study::{Errors, Outcome, Row};

/// Printed numbers have two to four decimals; their differences are rounded in the sixteenth digit.
const PRINTED: f64 = 1e-9;

fn test(first: &[f64], second: &[f64], zeros: ZeroRule) -> SignedRank {
    signed_rank(first, second, Equality { within: PRINTED, zeros }).unwrap()
}

fn wilcox(first: &[f64], second: &[f64]) -> SignedRank {
    test(first, second, ZeroRule::Wilcox)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean distance to the postoperative skin in mm of six patients: Ulusoy et al. 2010, table I.
mod volume_spline {
    pub const SPLINE: [f64; 6] = [1.1, 1.3, 1.2, 1.3, 4.6, 1.3];
    pub const CONVENTIONAL: [f64; 6] = [3.1, 3.1, 1.4, 1.3, 4.9, 1.1];
}

/// Four patients, homogeneous or with muscles, fixed or sliding: Kim et al. 2012, table 3.
mod mass_tensor {
    pub const MEAN: [[f64; 4]; 4] = [
        [2.50, 3.25, 2.03, 3.23],
        [2.21, 2.68, 1.80, 3.10],
        [2.07, 2.11, 1.75, 2.43],
        [1.21, 2.14, 1.58, 2.56],
    ];
    pub const P90: [[f64; 4]; 4] = [
        [4.10, 5.13, 3.01, 4.25],
        [3.39, 4.00, 2.61, 4.27],
        [3.68, 3.42, 2.61, 3.46],
        [2.15, 3.42, 2.58, 3.39],
    ];
    pub const P95: [[f64; 4]; 4] = [
        [4.40, 5.85, 3.38, 4.48],
        [4.16, 4.65, 2.87, 4.51],
        [4.39, 4.06, 2.78, 3.67],
        [2.90, 4.04, 2.84, 3.62],
    ];
}

/// Eleven patients, three models, and the largest movement of bone: Zhang et al. 2016, table 1
/// (docs/methods.md#papers has all three).
mod rubin_bodner {
    pub const MOVED: [f64; 11] = [
        11.6847, 6.1581, 7.3624, 7.2343, 8.3622, 10.5866, 13.4578, 7.3898, 10.5032, 6.1608, 13.6617,
    ];
    pub const STATISTICAL: [f64; 11] =
        [3.6352, 1.8381, 5.0321, 2.9817, 2.2543, 3.3946, 3.8809, 4.5982, 3.1190, 2.1845, 3.3014];
    pub const LINEAR: [f64; 11] =
        [1.3241, 0.8054, 1.2456, 0.7389, 0.8567, 0.9391, 1.1490, 0.8845, 0.9978, 0.9531, 0.9821];
    pub const IMPROVED: [f64; 11] =
        [0.9484, 0.5632, 0.7096, 0.6345, 0.4521, 0.7784, 0.7840, 0.4738, 0.7914, 0.8463, 0.7566];
}

#[test]
fn the_means_of_the_papers_follow_from_their_tables() {
    // As many decimals as the papers print.
    let close = |found: f64, printed: f64| assert!((found - printed).abs() < 5e-5, "{found}");
    close(mean(&volume_spline::SPLINE), 1.8);
    close(mean(&volume_spline::CONVENTIONAL), 2.4833);
    for (row, printed) in mass_tensor::MEAN.iter().zip([2.7525, 2.4475, 2.09, 1.8725]) {
        close(mean(row), printed);
    }
    for (row, printed) in mass_tensor::P95.iter().zip([4.5275, 4.0475, 3.725, 3.35]) {
        close(mean(row), printed);
    }
    use rubin_bodner::{IMPROVED, LINEAR, MOVED, STATISTICAL};
    for (row, printed) in
        [(MOVED, 9.3238), (STATISTICAL, 3.2927), (LINEAR, 0.9888), (IMPROVED, 0.7035)]
    {
        close(mean(&row), printed);
    }
}

#[test]
fn four_pairs_with_one_sign_give_an_eighth() {
    let found = wilcox(&[2.0, 3.0, 4.0, 5.0], &[1.0, 1.0, 1.0, 1.0]);
    assert_eq!((found.positive, found.negative, found.differing), (10.0, 0.0, 4));
    assert_eq!((found.two_sided_p, found.effect, found.exact), (0.125, 1.0, true));
    let turned = wilcox(&[1.0; 4], &[2.0, 3.0, 4.0, 5.0]);
    assert_eq!((turned.positive, turned.effect, turned.two_sided_p), (0.0, -1.0, 0.125));
}

#[test]
fn the_smallest_p_is_what_one_sign_throughout_gives() {
    for (pairs, smallest) in [(4, 0.125), (5, 0.0625), (6, 0.03125), (11, 0.000_976_562_5)] {
        let first: Vec<f64> = (1..=pairs).map(f64::from).collect();
        let found = wilcox(&first, &vec![0.0; pairs as usize]);
        assert_eq!((found.two_sided_p, found.smallest_p), (smallest, smallest));
        // Ties do not lower it.
        let tied = wilcox(&vec![1.0; pairs as usize], &vec![0.0; pairs as usize]);
        assert_eq!(tied.two_sided_p, smallest);
    }
}

#[test]
fn four_patients_cannot_show_that_muscles_or_sliding_help() {
    let [plain, muscles, sliding, both] = mass_tensor::MEAN;
    for (a, b) in
        [(plain, muscles), (plain, sliding), (plain, both), (muscles, sliding), (muscles, both)]
    {
        assert_eq!(wilcox(&a, &b).two_sided_p, 0.125);
    }
    let last = wilcox(&sliding, &both);
    assert_eq!((last.positive, last.two_sided_p), (7.0, 0.625));

    let [plain, muscles, sliding, both] = mass_tensor::P90;
    assert_eq!(wilcox(&plain, &muscles).two_sided_p, 0.25);
    // Of four patients one shows no difference.
    let [muscles_sliding, sliding_both] = [wilcox(&muscles, &sliding), wilcox(&sliding, &both)];
    assert_eq!((muscles_sliding.differing, muscles_sliding.two_sided_p), (3, 0.5));
    assert_eq!((sliding_both.differing, sliding_both.two_sided_p), (3, 0.25));
}

#[test]
fn pooled_over_both_contacts_eight_pairs_give_what_four_cannot() {
    let [plain, muscles, sliding, both] = mass_tensor::MEAN;
    let pooled = |a: [f64; 4], b: [f64; 4]| [a, b].concat();
    let of_sliding = wilcox(&pooled(plain, muscles), &pooled(sliding, both));
    assert_eq!(of_sliding.two_sided_p, 2.0 / 256.0);
    let of_muscles = wilcox(&pooled(plain, sliding), &pooled(muscles, both));
    assert_eq!((of_muscles.negative, of_muscles.two_sided_p), (3.5, 12.0 / 256.0));
}

#[test]
fn zeros_and_ties_are_ranked_by_both_conventions() {
    use volume_spline::{CONVENTIONAL, SPLINE};
    let left_out = test(&CONVENTIONAL, &SPLINE, ZeroRule::Wilcox);
    assert_eq!((left_out.pairs, left_out.differing, left_out.negative), (6, 5, 1.5));
    assert_eq!((left_out.two_sided_p, left_out.positive), (0.1875, 13.5));
    let ranked = test(&CONVENTIONAL, &SPLINE, ZeroRule::Pratt);
    assert_eq!((ranked.differing, ranked.negative, ranked.two_sided_p), (5, 2.5, 0.1875));
    // (13.5 - 1.5) / 15 and (17.5 - 2.5) / 20.
    assert_eq!((left_out.effect, ranked.effect), (0.8, 0.75));
}

#[test]
fn eleven_patients_of_one_sign_give_the_smallest_p_of_eleven() {
    use rubin_bodner::{IMPROVED, LINEAR, STATISTICAL};
    for (a, b) in [(LINEAR, IMPROVED), (STATISTICAL, LINEAR), (STATISTICAL, IMPROVED)] {
        let found = wilcox(&a, &b);
        assert_eq!((found.positive, found.two_sided_p), (66.0, 0.000_976_562_5));
    }
}

/// Whole numbers spread over both signs, with ties where `step` is small.
fn spread(pairs: usize, step: usize) -> Vec<f64> {
    (0..pairs).map(|k| ((k * 7919 % 101) / step) as f64 - 30.0 / step as f64).collect()
}

#[test]
fn counting_by_sums_is_counting_all_subsets() {
    for (pairs, step) in [(1, 1), (6, 1), (9, 9), (12, 20)] {
        let first = spread(pairs, step);
        let found = wilcox(&first, &vec![0.0; pairs]);
        let mut sizes: Vec<f64> = first.iter().map(|d| d.abs()).filter(|&d| d > 0.0).collect();
        sizes.sort_by(f64::total_cmp);
        let rank = |size: f64| {
            let (below, upto) =
                (sizes.partition_point(|&s| s < size), sizes.partition_point(|&s| s <= size));
            (below + upto + 1) as f64 / 2.0
        };
        let ranks: Vec<f64> = sizes.iter().map(|&size| rank(size)).collect();
        let smaller = found.positive.min(found.negative);
        let subsets = 1u32 << ranks.len();
        let few = (0..subsets).filter(|subset| {
            let chosen = ranks.iter().enumerate().filter(|(k, _)| subset >> k & 1 == 1);
            chosen.map(|(_, rank)| rank).sum::<f64>() <= smaller
        });
        let wanted = (2.0 * few.count() as f64 / f64::from(subsets)).min(1.0);
        assert_eq!(found.two_sided_p, wanted, "{pairs} pairs");
    }
}

/// Two-sided p of a sum of ranks of n pairs without ties, by counting sums.
fn counted(pairs: usize, sum: usize) -> f64 {
    let mut share = vec![0.0; pairs * (pairs + 1) / 2 + 1];
    share[0] = 1.0;
    for rank in 1..=pairs {
        for total in (0..share.len()).rev() {
            let with = if total >= rank { share[total - rank] } else { 0.0 };
            share[total] = 0.5 * (share[total] + with);
        }
    }
    2.0 * share[..=sum].iter().sum::<f64>()
}

#[test]
fn above_twenty_five_pairs_the_normal_distribution_is_near_enough_to_the_counted_one() {
    for (pairs, sum) in [(26, 98), (26, 130), (30, 137), (60, 600)] {
        let mut first: Vec<f64> = (1..=pairs).map(|rank| rank as f64).collect();
        let mut left = sum;
        for rank in (1..=pairs).rev() {
            if rank <= left {
                first[rank - 1] = -first[rank - 1];
                left -= rank;
            }
        }
        let found = wilcox(&first, &vec![0.0; pairs]);
        assert_eq!((found.negative, found.exact), (sum as f64, false));
        // The tails of the normal distribution are heavier by some hundredths, more so farther out.
        let wanted = counted(pairs, sum);
        assert!((found.two_sided_p / wanted - 1.0).abs() < 0.05, "{} {wanted}", found.two_sided_p);
    }
    // n = 30, W = 137 is the last entry with p at most 0.05 of the usual table.
    assert!((counted(30, 137) - 0.0497).abs() < 5e-5);
    let ties = wilcox(&spread(60, 10), &[0.0; 60]);
    assert!(!ties.exact && ties.two_sided_p > 0.0 && ties.two_sided_p < 1.0);
}

#[test]
fn nothing_to_compare_is_an_error_and_never_a_number() {
    let usual = Equality { within: 0.0, zeros: ZeroRule::Wilcox };
    assert_eq!(signed_rank(&[], &[], usual), Err(PairedError::Empty));
    let same = signed_rank(&[1.0, 2.0], &[1.0, 2.0], usual);
    assert_eq!(same, Err(PairedError::NoDifference { pairs: 2 }));
    let uneven = signed_rank(&[1.0], &[], usual);
    assert_eq!(uneven, Err(PairedError::NotPaired { first: 1, second: 0 }));
    let broken = signed_rank(&[1.0, f64::NAN], &[0.0, 0.0], usual);
    assert_eq!(broken, Err(PairedError::NotFinite { index: 1 }));
}

fn row(scene: &str, plan: &str, label: &str, error: Option<f64>) -> Row {
    let errors = |mm: f64| Errors { mean: mm / 2.0, p95: mm, max: 2.0 * mm };
    let outcome = match error {
        Some(mm) => Outcome::Solved(Box::new(Solved {
            unknowns: 1,
            iterations: 1,
            wall_s: 1.0,
            repeats: 1,
            peak_mb: None,
            skin_mean_mm: 1.0,
            error: errors(mm),
            closest_point: errors(mm),
            regions: Default::default(),
            numerical_error: None,
            linearity_error: None,
            effectivity: None,
            chosen: None,
            smallest_det_f: 1.0,
            truth_error: None,
            truth_contact: false,
            covered_share: None,
            warnings: Vec::new(),
        })),
        None => Outcome::Failed { code: "solver-diverged".into(), detail: "it did".into() },
    };
    Row {
        scene: scene.into(),
        plan: plan.into(),
        method: label.into(),
        label: label.into(),
        element: String::new(),
        material: "case".into(),
        level: 0,
        outcome,
    }
}

#[test]
fn plans_of_one_scene_count_as_one_trial() {
    let mut rows = Vec::new();
    for scene in ["a", "b", "c"] {
        for (plan, size) in [("1 mm", 1.0), ("2 mm", 2.0), ("8 mm", 8.0)] {
            rows.push(row(scene, plan, "near", Some(0.1 * size)));
            rows.push(row(scene, plan, "far", Some(0.3 * size)));
        }
    }
    let found = compare_variants(&rows);
    assert_eq!(found.len(), 2);
    let p95 = &found[0];
    assert_eq!((p95.measure, p95.scenes, p95.rows, p95.unsolved), (Measure::P95, 3, 9, 0));
    let (test, pratt) = p95.test.unwrap();
    // Nine pairs of one sign would give 0.004.
    assert_eq!((test.two_sided_p, pratt, test.effect), (0.25, 0.25, -1.0));
    assert!((p95.median_difference_mm + 0.2 * 11.0 / 3.0).abs() < 1e-12);
    let sentence = p95.sentence();
    assert_eq!(
        sentence,
        "near has the smaller p95 error than far by 0.733 mm in the median of 3 scenes; two-sided exact p = 0.25, \
         and no p below 0.25 is possible with 3 differing scenes: too few to tell a difference from chance"
    );
    assert!(many_comparisons(&found).unwrap().starts_with("2 comparisons"));
}

#[test]
fn failed_rows_leave_their_pair_and_equal_methods_are_called_equal() {
    let rows = [
        row("a", "p", "fem", Some(0.2)),
        row("a", "p", "mtm", Some(0.2 + 1e-9)),
        row("b", "p", "fem", Some(0.2)),
        row("b", "p", "mtm", None),
    ];
    let found = &compare_variants(&rows)[0];
    assert_eq!((found.scenes, found.rows, found.unsolved), (1, 1, 1));
    assert_eq!(found.test, Err(PairedError::NoDifference { pairs: 1 }));
    assert_eq!(found.sentence(), "fem and mtm have the same p95 error to 0.0001 mm on 1 scene");
    assert!(many_comparisons(&compare_variants(&rows)).is_none());
    let none = &compare_variants(&[rows[2].clone(), rows[3].clone()])[0];
    assert_eq!(none.test, Err(PairedError::Empty));
    assert!(none.sentence().contains("not compared"));
}

#[test]
fn enough_scenes_are_weighed_and_still_claim_nothing_beyond_themselves() {
    let scenes: Vec<String> = (0..6).map(|n| format!("case {n}")).collect();
    let with = |second: &dyn Fn(usize) -> f64| {
        let rows: Vec<Row> = scenes
            .iter()
            .enumerate()
            .flat_map(|(n, scene)| {
                [row(scene, "p", "one", Some(1.0)), row(scene, "p", "two", Some(second(n)))]
            })
            .collect();
        compare_variants(&rows)[0].sentence()
    };
    let differing = with(&|n| 1.1 + 0.1 * n as f64);
    assert!(
        differing.contains("p = 0.0312 (the smallest possible with 6 differing scenes is 0.0312)"),
        "{differing}"
    );
    assert!(differing.ends_with("would seldom come by chance"));
    let mixed = with(&|n| if n % 2 == 0 { 1.1 + 0.01 * n as f64 } else { 0.9 - 0.01 * n as f64 });
    assert!(mixed.ends_with("no difference is shown, which does not show that there is none"));
    for sentence in [differing, mixed] {
        assert!(!sentence.contains("prove") && !sentence.contains("significant"));
    }
}
