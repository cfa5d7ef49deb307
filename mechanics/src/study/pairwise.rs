//! Variants of a study against each other, scene by scene.
//!
//! Rows of two variants belong together where scene, plan, material and level are the same. The difference of a
//! scene is the mean over its rows: plans, materials and meshes of one scene are no independent trials, and
//! counted each they would make any difference look certain. So the n of the test is the number of scenes.

use std::collections::BTreeMap;

use super::paired::{Equality, PairedError, SignedRank, ZeroRule, signed_rank};
use super::report::{Outcome, Row, Solved};

/// Differences of errors in mm that are none: a hundred times what solving to the usual residual leaves open.
pub const EQUAL_WITHIN_MM: f64 = 1e-4;
/// The p that readers are used to ask for.
const USUAL_P: f64 = 0.05;

/// Which error is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Mean,
    P95,
}

/// Two variants on the scenes that both of them solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairwise {
    pub first: String,
    pub second: String,
    pub measure: Measure,
    pub scenes: usize,
    /// Pairs of rows behind the differences of the scenes.
    pub rows: usize,
    /// Pairs of rows that are left out because one of them failed.
    pub unsolved: usize,
    /// Pairs of rows that are left out because the truth of one has contact and that of the other has none.
    pub other_truths: usize,
    /// Of first minus second over the scenes.
    pub median_difference_mm: f64,
    /// The test of the scenes, zeros left out before the ranking, and the p where they leave after it.
    pub test: Result<(SignedRank, f64), PairedError>,
}

/// Every two variants, in the order in which rows name them.
pub fn compare_variants(rows: &[Row]) -> Vec<Pairwise> {
    let mut labels: Vec<&str> = Vec::new();
    for row in rows {
        if !labels.contains(&row.label.as_str()) {
            labels.push(&row.label);
        }
    }
    let mut found = Vec::new();
    for (index, first) in labels.iter().enumerate() {
        for second in &labels[index + 1..] {
            for measure in [Measure::P95, Measure::Mean] {
                found.push(compare(rows, [first, second], measure));
            }
        }
    }
    found
}

/// Key that two rows of a pair share.
type PairKey<'a> = (&'a str, &'a str, &'a str, u32);

fn of_label<'a>(rows: &'a [Row], label: &str) -> BTreeMap<PairKey<'a>, &'a Outcome> {
    let place = |row: &'a Row| (&*row.scene, &*row.plan, &*row.material, row.level);
    let own = rows.iter().filter(|row| row.label == label);
    own.map(|row| (place(row), &row.outcome)).collect()
}

fn compare(rows: &[Row], [first, second]: [&str; 2], measure: Measure) -> Pairwise {
    let of = |solved: &Solved| match measure {
        Measure::Mean => solved.error.mean,
        Measure::P95 => solved.error.p95,
    };
    let others = of_label(rows, second);
    let mut scenes: BTreeMap<&str, Vec<[f64; 2]>> = BTreeMap::new();
    let (mut unsolved, mut other_truths) = (0, 0);
    for (place, outcome) in of_label(rows, first) {
        match (outcome, others.get(&place)) {
            (Outcome::Solved(a), Some(Outcome::Solved(b)))
                if a.truth_contact != b.truth_contact =>
            {
                other_truths += 1;
            }
            (Outcome::Solved(a), Some(Outcome::Solved(b))) => {
                scenes.entry(place.0).or_default().push([of(a), of(b)]);
            }
            (_, Some(_)) => unsolved += 1,
            (_, None) => {}
        }
    }
    let mean = |pairs: &Vec<[f64; 2]>, side: usize| {
        pairs.iter().map(|pair| pair[side]).sum::<f64>() / pairs.len() as f64
    };
    let [a, b] = [0, 1].map(|side| scenes.values().map(|p| mean(p, side)).collect::<Vec<f64>>());
    Pairwise {
        first: first.to_owned(),
        second: second.to_owned(),
        measure,
        scenes: scenes.len(),
        rows: scenes.values().map(Vec::len).sum(),
        unsolved,
        other_truths,
        median_difference_mm: median(a.iter().zip(&b).map(|(a, b)| a - b).collect()),
        test: both_rules(&a, &b),
    }
}

fn both_rules(first: &[f64], second: &[f64]) -> Result<(SignedRank, f64), PairedError> {
    let by = |zeros| signed_rank(first, second, Equality { within: EQUAL_WITHIN_MM, zeros });
    Ok((by(ZeroRule::Wilcox)?, by(ZeroRule::Pratt)?.two_sided_p))
}

/// The middle value, or the mean of the two in the middle; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}

impl Measure {
    pub fn name(self) -> &'static str {
        match self {
            Measure::Mean => "mean_mm",
            Measure::P95 => "p95_mm",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Measure::Mean => "mean error",
            Measure::P95 => "p95 error",
        }
    }
}

impl Pairwise {
    /// What the numbers allow to say, and no more: chance is weighed only where so few scenes can weigh it.
    pub fn sentence(&self) -> String {
        let Pairwise { first, second, scenes, .. } = self;
        let test = match &self.test {
            Ok((test, _)) => test,
            Err(PairedError::NoDifference { .. }) => {
                return format!(
                    "{first} and {second} have the same {} to {EQUAL_WITHIN_MM} mm on {}",
                    self.measure.words(),
                    counted(*scenes, "scene")
                );
            }
            Err(PairedError::Empty) if self.other_truths > 0 => {
                return format!(
                    "{first} and {second} are not compared: the truth of one has contact, that of the other has none"
                );
            }
            Err(error) => return format!("{first} and {second} are not compared: {error}"),
        };
        let smaller = if self.median_difference_mm <= 0.0 { first } else { second };
        let larger = if smaller == first { second } else { first };
        let difference = self.median_difference_mm.abs();
        let kind = if test.exact { "exact" } else { "approximate" };
        let p = test.two_sided_p;
        let observed = format!(
            "{smaller} has the smaller {} than {larger} by {difference:.3} mm in the median of {}; two-sided {kind} p = {}",
            self.measure.words(),
            counted(*scenes, "scene"),
            short(p)
        );
        let differing = counted(test.differing, "differing scene");
        if test.smallest_p > USUAL_P {
            return format!(
                "{observed}, and no p below {} is possible with {differing}: too few to tell a difference from chance",
                short(test.smallest_p)
            );
        }
        let meaning = if p < USUAL_P {
            "on scenes like these such a difference would seldom come by chance"
        } else {
            "no difference is shown, which does not show that there is none"
        };
        format!(
            "{observed} (the smallest possible with {differing} is {}): {meaning}",
            short(test.smallest_p)
        )
    }
}

/// What a reader of many comparisons has to know; none where there is at most one.
pub fn many_comparisons(comparisons: &[Pairwise]) -> Option<String> {
    let tested = comparisons.iter().filter(|comparison| comparison.test.is_ok()).count();
    (tested > 1).then(|| {
        format!(
            "{tested} comparisons are made and p is not adjusted for their number: where nothing differs, up to {:.1} of them come out below {USUAL_P} by chance",
            USUAL_P * tested as f64
        )
    })
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A probability with three significant digits.
fn short(p: f64) -> String {
    let digits = (2.0 - p.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{p:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
