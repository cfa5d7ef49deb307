//! The table of learning in the shape of table 1 of Zhang et al. 2016: a row for each patient, with the class of surgery, the
//! largest movement of bone and the error of each method.

use crate::schema::learn::result::LearningDocument;
use mechanics::format::csv::cell;

/// The name of the file.
pub const TABLE_FILE: &str = "learning.csv";

/// Means over the skin in mm and their 95th percentiles, patient by patient, and the means of all in the last row.
pub fn table_csv(found: &LearningDocument) -> String {
    let errors = found.table.iter().flat_map(|own| {
        ["mean_mm", "p95_mm"].map(|statistic| cell(&format!("{} {statistic}", own.name)))
    });
    let heads = ["patient", "class", "largest_bone_movement_mm"].map(str::to_owned);
    let mut rows: Vec<Vec<String>> = vec![heads.into_iter().chain(errors).collect()];
    for (place, patient) in found.patients.iter().enumerate() {
        let of_case = found.table.iter().flat_map(|own| {
            own.cases.get(place).map(|case| [case.mean, case.p95]).into_iter().flatten()
        });
        let numbers = std::iter::once(patient.largest_bone_movement_mm).chain(of_case);
        let names = [cell(&patient.name), cell(&patient.class)];
        rows.push(names.into_iter().chain(numbers.map(|own| own.to_string())).collect());
    }
    let largest = found.patients.iter().map(|own| own.largest_bone_movement_mm).sum::<f64>();
    let of_all = found.table.iter().flat_map(|own| [own.mean, own.p95]);
    let numbers = std::iter::once(largest / found.patients.len().max(1) as f64).chain(of_all);
    let names = ["mean".to_owned(), String::new()];
    rows.push(names.into_iter().chain(numbers.map(|own| own.to_string())).collect());
    rows.iter().map(|row| row.join(",") + "\n").collect()
}
