//! The report of a study on the terminal.

use crate::jobs::study::MARKED;
use crate::jobs::study::cell_sizes::convergence_text;
use crate::jobs::study::files::REPORT_JSON;
use crate::schema::study::cell_sizes::CellSizesDocument;
use crate::schema::study::constants::ConstantMapDocument;
use crate::schema::study::report::{ReportDocument, RowDocument};

/// The most failing rows that are printed; the report has all.
const FAILING: usize = 20;

/// Rows with the codes of their warnings, what these say, the outcome, and the rows that keep it from being a pass.
pub(super) fn print_report(report: &ReportDocument) {
    for scene in &report.scenes {
        println!("\n{}: truth {}", scene.name, scene.truth);
        let rows = || report.rows.iter().filter(|row| row.scene == scene.name);
        if let Some(error) = &scene.truth_error_mm {
            println!(
                "  which is off by {:.4} mm itself (mean), {:.4} mm (p95)",
                error.mean, error.p95
            );
        }
        println!(
            "  {:<28} {:<24} {:<18} {:>5} {:>9} {:>9} {:>8} {:>8} {:>8}",
            "plan", "variant", "material", "level", "unknowns", "s", "mean mm", "p95 mm", "max mm"
        );
        rows().for_each(print_row);
        for (code, words) in MARKED {
            let told = rows().filter(|row| row.warnings.iter().any(|own| own == code)).count();
            if told > 0 {
                println!("  {code} ({told} of {} rows): {words}", rows().count());
            }
        }
        for skipped in report.skipped.iter().filter(|skipped| skipped.scene == scene.name) {
            println!("  {} has no row: {}", skipped.label, skipped.reason);
        }
    }
    for map in &report.constant_maps {
        print_map(map);
    }
    for of in &report.cell_sizes {
        print_cell_sizes(of);
    }
    println!("\noutcome    {}", report.verdict.outcome.name());
    let failing = &report.verdict.failing;
    for row in failing.iter().take(FAILING) {
        println!("failing    {}", row.sentence());
    }
    if failing.len() > FAILING {
        println!("failing    {} more in {REPORT_JSON}", failing.len() - FAILING);
    }
}

/// One face on meshes of several cell sizes.
fn print_cell_sizes(of: &CellSizesDocument) {
    println!("\n{} {} {}: cell sizes", of.series, of.plan, of.label);
    println!(
        "  {:<28} {:>8} {:>9} {:>9} {:>9} {:>12} {:>9}",
        "mesh", "cell mm", "cells", "unknowns", "s", "skin mean mm", "change %"
    );
    for mesh in &of.meshes {
        let change = mesh.change.map_or_else(String::new, |share| format!("{:.3}", 100.0 * share));
        println!(
            "  {:<28} {:>8.3} {:>9} {:>9} {:>9.3} {:>12.4} {change:>9}",
            mesh.scene, mesh.cell_mm, mesh.cells, mesh.unknowns, mesh.wall_s, mesh.skin_mean_mm
        );
    }
    println!("  {}", convergence_text(of));
}

/// The constants with which the skin is nearest to a scan.
fn print_map(map: &ConstantMapDocument) {
    println!("\n{} {}: {:.4} mm from the scan at best", map.plan, map.label, map.best.mean_mm);
    for (axis, value) in map.axes.iter().zip(&map.best.values) {
        let as_good: Vec<String> = axis.as_good.iter().map(f64::to_string).collect();
        println!("  {:<32} {value}; as good: {}", axis.words(), as_good.join(", "));
    }
}

fn print_row(row: &RowDocument) {
    let mark = if row.on_front { "*" } else { " " };
    let place =
        format!("{mark} {:<28} {:<24} {:<18} {:>5}", row.plan, row.label, row.material, row.level);
    match (&row.numbers, &row.error) {
        (Some(numbers), _) => println!(
            "{place} {:>9} {:>9.4} {:>8.4} {:>8.4} {:>8.4}  {}",
            numbers.unknowns,
            numbers.wall_s,
            numbers.mean_mm,
            numbers.p95_mm,
            numbers.max_mm,
            row.warnings.join(", ")
        ),
        (None, Some(error)) => println!("{place} {}: {}", error.kind, error.detail),
        (None, None) => println!("{place}"),
    }
}
