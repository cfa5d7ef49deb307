//! `facies materials`: the materials of the literature that a case may name.

use clap::Args;

use super::failure::CommandError;
use crate::schema::case::preset::MaterialList;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON, as `GET /v1/materials` answers it
    #[arg(long)]
    json: bool,
}

/// Prints each preset with its source, state and what speaks against it, then the moduli that are reported beside them.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let all = MaterialList::all();
    if arguments.json {
        let text = serde_json::to_string_pretty(&all)
            .map_err(|error| CommandError::Usage(error.to_string()))?;
        println!("{text}");
        return Ok(());
    }
    for preset in &all.presets {
        let source = &preset.source;
        println!("{}", preset.name.name());
        println!("  {}", preset.tissue);
        println!("  {} {}, {}", source.authors, source.year, source.place);
        println!("  {}", preset.state);
        if let Some(doubt) = &preset.doubt {
            println!("  doubt: {doubt}");
        }
        if preset.needs_course {
            println!("  needs `fibre.direction` or `fibre.array` beside it");
        }
    }
    let table = &all.measured_in;
    println!(
        "\nYoung's modulus in kPa as reported ({} {}, {}):",
        table.authors, table.year, table.place
    );
    for modulus in &all.measured {
        let (tissue, source) = (&modulus.tissue, &modulus.source);
        println!("  {tissue:<12} {source:<16} {} to {}", modulus.from_kpa, modulus.to_kpa);
    }
    Ok(())
}
