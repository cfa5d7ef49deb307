//! Convergence over cell sizes as a table and as a picture.

use std::fmt::Write;

use super::words::{in_words, scene_in_words, variant_in_words};
use crate::schema::study::cell_sizes::CellSizesDocument;
use crate::schema::study::report::ReportDocument;
use mechanics::chart::{CellSizesPicture, CellSizesSeries};
use mechanics::format::csv::cell;

pub const CELL_SIZES_CSV: &str = "cell-sizes.csv";

/// A row for each mesh of each series, numbers in full.
pub fn cell_sizes_csv(report: &ReportDocument) -> String {
    let mut text = "series,plan,material,label,scene,cell_mm,cells,unknowns,wall_s,skin_mean_mm,change,order,limit_mm,\
                    fit_rms_mm,settled_mm\r\n"
        .to_owned();
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for of in &report.cell_sizes {
        let names = [&of.series, &of.plan, &of.material, &of.label].map(|name| cell(name));
        for mesh in &of.meshes {
            let numbers = [
                mesh.cell_mm.to_string(),
                mesh.cells.to_string(),
                mesh.unknowns.to_string(),
                mesh.wall_s.to_string(),
                mesh.skin_mean_mm.to_string(),
                number(mesh.change),
                number(of.order),
                number(of.limit_mm),
                number(of.fit_rms_mm),
                number(of.settled_mm),
            ];
            let (names, scene) = (names.join(","), cell(&mesh.scene));
            // Writing to a text cannot fail.
            let _ = write!(text, "{names},{scene},{}\r\n", numbers.join(","));
        }
    }
    text
}

/// Every series and plan once, in the order of the report, each for a picture with all its models.
pub fn cell_size_groups(report: &ReportDocument) -> Vec<[&str; 3]> {
    let mut groups: Vec<[&str; 3]> = Vec::new();
    for of in &report.cell_sizes {
        let group = [of.series.as_str(), of.plan.as_str(), of.material.as_str()];
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}

/// The SVG of a series on one plan and material.
pub fn cell_sizes_chart(report: &ReportDocument, group: [&str; 3]) -> String {
    let [series, plan, material] = group;
    let is_own = |of: &&CellSizesDocument| {
        [of.series.as_str(), of.plan.as_str(), of.material.as_str()] == group
    };
    let own: Vec<&CellSizesDocument> = report.cell_sizes.iter().filter(is_own).collect();
    let drawn = own.iter().map(|of| CellSizesSeries {
        name: variant_in_words(&of.label),
        points: of.meshes.iter().map(|mesh| [mesh.cell_mm, mesh.skin_mean_mm]).collect(),
        fit: of.order.zip(of.limit_mm).map(|(order, limit)| [limit, order]),
        fitted: of.fit_meshes.unwrap_or_default() as usize,
    });
    let mut notes = vec![
        "Dashed: m* + c h^p, fitted to the finest meshes; beside it m* in mm and p. Cell size: edge of a cube with the volume of six \
         tetrahedra, two wedges or one hexahedron in the mean."
            .to_owned(),
    ];
    notes.extend(own.iter().map(|of| convergence_text(of)));
    let series_of: Vec<CellSizesSeries> = drawn.collect();
    let picture = CellSizesPicture {
        title: &format!("Convergence over cell sizes: {}", scene_in_words(series)),
        subtitle: &in_words(&format!("{plan}, {material}")),
        series: &series_of,
        notes: &notes,
    };
    picture.to_svg()
}

/// Summary of a series.
pub fn convergence_text(of: &CellSizesDocument) -> String {
    let fit = match (of.order, of.limit_mm, of.fit_rms_mm) {
        (Some(order), Some(limit), Some(rms)) => {
            let finest = of.meshes.last().map_or(limit, |mesh| mesh.skin_mean_mm);
            format!(
                "order {order:.2} to {limit:.4} mm by the {} finest meshes, which are off that by {rms:.4} mm (rms); the finest \
                 is {:.2} % from the limit",
                of.fit_meshes.unwrap_or_default(),
                100.0 * ((finest - limit) / limit).abs()
            )
        }
        _ => "no order".to_owned(),
    };
    let settled = match of.settled_mm {
        Some(size) => format!("from {size:.2} mm on no mesh changes the skin by more than .3 %"),
        None => "the finest step changes the skin by more than .3 %".to_owned(),
    };
    format!("{}: {fit}; {settled}.", variant_in_words(&of.label))
}
