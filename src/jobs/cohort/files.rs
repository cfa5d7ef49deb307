//! The files of a cohort beside its result: `cohort.svg`, box plots with tests, and `cohort.csv`, a row for each subject.

use crate::schema::cohort::document::{CohortDistance, CohortStatistic};
use crate::schema::cohort::result::{
    CohortGroupDocument, CohortPairDocument, CohortResultDocument, CohortRowDocument,
};
use mechanics::chart::{BoxesGroup, BoxesPicture};
use mechanics::format::csv::cell;

/// Names and media types.
pub(super) const PICTURE: (&str, &str) = ("cohort.svg", "image/svg+xml");
pub(super) const TABLE: (&str, &str) = ("cohort.csv", "text/csv; charset=utf-8");

/// More pairs than those of four groups are listed below the boxes only.
const MOST_BRACKETS: usize = 6;

/// A row for each subject of each group; distances in mm, in full.
pub(super) fn table(found: &CohortResultDocument) -> String {
    let mut text = "group,subject,points,mean_mm,sd_mm,rms_mm,min_mm,p25_mm,median_mm,p75_mm,p90_mm,p95_mm,p99_mm,max_mm\r\n".to_owned();
    for group in &found.groups {
        for CohortRowDocument { subject, distances: d } in &group.rows {
            let names = [cell(&group.name), cell(subject), d.count.to_string()].join(",");
            let numbers =
                [d.mean, d.sd, d.rms, d.min, d.p25, d.median, d.p75, d.p90, d.p95, d.p99, d.max];
            let numbers = numbers.map(|number| number.to_string()).join(",");
            text += &format!("{names},{numbers}\r\n");
        }
    }
    text
}

/// A box for each group, a dot for each subject, and the tests of the pairs.
pub(super) fn picture(found: &CohortResultDocument) -> String {
    let CohortResultDocument { distance, statistic, groups, pairs, .. } = found;
    let boxes: Vec<BoxesGroup> = groups.iter().map(|group| boxed(*statistic, group)).collect();
    let number = |name: &str| groups.iter().position(|group| group.name == name);
    let bracket = |pair: &CohortPairDocument| {
        Some(([number(&pair.first)?, number(&pair.second)?], p_value(pair)))
    };
    let brackets: Vec<([usize; 2], String)> = pairs.iter().filter_map(bracket).collect();
    let shown = if brackets.len() <= MOST_BRACKETS { brackets.as_slice() } else { &[] };
    let subjects = groups.iter().map(|group| group.rows.len()).max().unwrap_or(0);
    let (statistic, distance) = (statistic_name(*statistic), distance_name(*distance));
    let mut notes = vec![
        "Box: quartiles and median; whiskers: smallest and largest; dots: subjects. p: Wilcoxon signed rank, two-sided, not corrected for \
         the number of pairs."
            .to_owned(),
    ];
    notes.extend(pairs.iter().map(told));
    BoxesPicture {
        title: &format!("Distance of the prediction from the scan: {statistic} of each subject"),
        subtitle: &format!("{subjects} subjects, {distance}"),
        value_name: &format!("{statistic}, mm"),
        groups: &boxes,
        pairs: shown,
        notes: &notes,
    }
    .to_svg()
}

fn boxed(statistic: CohortStatistic, group: &CohortGroupDocument) -> BoxesGroup {
    let over = &group.over_subjects;
    let value = |row: &CohortRowDocument| (row.subject.clone(), statistic.of(&row.distances));
    BoxesGroup {
        name: group.name.clone(),
        five: [over.min, over.p25, over.median, over.p75, over.max],
        values: group.rows.iter().map(value).collect(),
    }
}

/// Two significant digits.
fn p_value(pair: &CohortPairDocument) -> String {
    match pair.p {
        None => "equal".to_owned(),
        Some(p) if p < 0.001 => "p < 0.001".to_owned(),
        Some(p) if p < 0.1 => format!("p = {p:.3}"),
        Some(p) => format!("p = {p:.2}"),
    }
}

fn told(pair: &CohortPairDocument) -> String {
    let CohortPairDocument { first, second, differing, .. } = pair;
    let way = if pair.is_exact { "exact" } else { "approximated" };
    format!(
        "{first} less {second}: median {:.3} mm; W {} and {} of {differing} that differ; {} ({way}; smallest possible {:.2e})",
        pair.median_difference_mm,
        pair.w_first_larger,
        pair.w_second_larger,
        p_value(pair),
        pair.smallest_p
    )
}

fn statistic_name(statistic: CohortStatistic) -> &'static str {
    match statistic {
        CohortStatistic::Mean => "mean",
        CohortStatistic::Rms => "rms",
        CohortStatistic::Median => "median",
        CohortStatistic::P90 => "p90",
        CohortStatistic::P95 => "p95",
        CohortStatistic::Max => "largest",
    }
}

fn distance_name(distance: CohortDistance) -> &'static str {
    match distance {
        CohortDistance::ClosestPoint => "closest points both ways, by area",
        CohortDistance::NodeWise => "points of the same number",
        CohortDistance::TpsCp => "closest points after a thin-plate spline of landmarks",
    }
}
