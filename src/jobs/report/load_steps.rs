//! Rest at the end of each load step, as a table.

use super::content::{Block, Section, Table};
use super::tables::{mm, texts};
use super::words::Words;
use crate::schema::predict::newton::LoadStepDocument;

/// None where no load steps were asked for; contact has columns where anything presses, and warnings where there are any.
pub fn load_steps(steps: &[LoadStepDocument], words: &Words) -> Option<Section> {
    let presses = steps.iter().any(|step| step.contact.is_some());
    let warns = steps.iter().any(|step| !step.warnings.is_empty());
    let row = |step: &LoadStepDocument| {
        let LoadStepDocument { rest, contact, .. } = step;
        let stable =
            step.is_stable.map_or("–", |is_stable| words.yes_or_no[usize::from(!is_stable)]);
        let mut row = vec![
            format!("{:.1} %", 100.0 * rest.share),
            rest.steps.to_string(),
            mm(rest.energy_mn_mm),
            mm(rest.least_det_f),
            stable.to_owned(),
        ];
        if presses {
            let (area, pressure) = contact
                .as_ref()
                .map_or((0.0, 0.0), |contact| (contact.area_mm2, contact.largest_pressure_kpa));
            row.extend([mm(area), mm(pressure)]);
        }
        if warns {
            row.push(step.warnings.join(", "));
        }
        row
    };
    let [columns @ .., area, pressure, warnings] = words.step_columns;
    let mut columns = texts(columns);
    if presses {
        columns.extend(texts([area, pressure]));
    }
    if warns {
        columns.extend(texts([warnings]));
    }
    let table = Table::new(columns, steps.iter().map(row).collect());
    (!steps.is_empty()).then(|| Section::new(words.load_steps, vec![Block::Table(table)]))
}

#[cfg(test)]
mod tests {
    use super::super::words::words;
    use super::*;
    use crate::schema::Language;
    use crate::schema::predict::newton::RestOnTheWayDocument;
    use crate::schema::predict::pressing::StepContactDocument;

    fn step(share: f64, contact: Option<StepContactDocument>) -> LoadStepDocument {
        let rest =
            RestOnTheWayDocument { share, energy_mn_mm: 12.345, least_det_f: 0.875, steps: 6 };
        LoadStepDocument {
            rest,
            relative_residual: 1e-9,
            is_stable: Some(true),
            bulk_in_cells: 0.0,
            cells_with_bulk: 0,
            warnings: Vec::new(),
            reaction_millinewton: Default::default(),
            contact,
        }
    }

    fn table(steps: &[LoadStepDocument], language: Language) -> Table {
        let mut section = load_steps(steps, words(language)).unwrap();
        let Block::Table(table) = section.blocks.remove(0) else { panic!("a table") };
        table
    }

    #[test]
    fn each_load_step_is_a_row_and_contact_has_columns_where_anything_presses() {
        assert!(load_steps(&[], words(Language::En)).is_none());
        let open = table(&[step(0.5, None), step(1.0, None)], Language::En);
        assert_eq!(open.columns.len(), 5);
        assert_eq!(open.rows[0], ["50.0 %", "6", "12.35", "0.88", "yes"]);
        let touch =
            StepContactDocument { points: 16, area_mm2: 100.0, largest_pressure_kpa: 0.604 };
        let pressed = table(&[step(0.5, None), step(1.0, Some(touch))], Language::De);
        assert_eq!(pressed.columns.len(), 7);
        assert_eq!(pressed.rows[0][5..], ["0.00", "0.00"]);
        assert_eq!(pressed.rows[1][4..], ["ja", "100.00", "0.60"]);
    }

    #[test]
    fn a_load_step_whose_answer_is_doubtful_says_why() {
        let warnings = vec!["bulk-in-all-cells".to_owned()];
        let doubtful = LoadStepDocument { warnings, ..step(1.0, None) };
        let found = table(&[step(0.5, None), doubtful], Language::En);
        assert_eq!(found.columns[4..], ["stable", "warnings"]);
        assert_eq!(found.rows[0][4..], ["yes", ""]);
        assert_eq!(found.rows[1][4..], ["yes", "bulk-in-all-cells"]);
    }
}
