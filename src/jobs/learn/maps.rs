//! Where methods err: the mean error of each at each point of the skin, as a file.

use super::gather::Gathered;
use crate::jobs::failure::JobError;
use mechanics::format::vtk::vtp;
use mechanics::format::{ArrayValues, NamedValues, SurfaceOutput};
use mechanics::learning::validation::{Column, Validated};

/// The name of the file.
pub const ERRORS_FILE: &str = "errors.vtp";

/// The skin of the first case at rest, with an array `mean_error_METHOD_mm` for each method over the cases, nested where it is learned.
pub fn error_maps(gathered: &Gathered, validated: &[Validated]) -> Result<Vec<u8>, JobError> {
    let nested = validated.iter().map(|own| &own.nested);
    let columns: Vec<&Column> = gathered.mechanical.iter().chain(nested).collect();
    let names: Vec<String> = columns.iter().map(|column| array(&column.name)).collect();
    let mut output = SurfaceOutput::plain(&gathered.face, gathered.frame);
    output.point_arrays = columns
        .iter()
        .zip(&names)
        .map(|(column, name)| NamedValues { name, values: ArrayValues::Reals(&column.points) })
        .collect();
    Ok(vtp::write(&output)?)
}

/// `fem_linear + GRNN` as the name of an array: `mean_error_fem_linear_GRNN_mm`.
fn array(method: &str) -> String {
    let words = method.split(|letter: char| !letter.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    format!("mean_error_{}_mm", words.join("_"))
}
