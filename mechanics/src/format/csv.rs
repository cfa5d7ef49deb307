//! CSV for spreadsheets and statistics programs: one row for each node of the skin.
//!
//! Numbers have as many digits as give the same f64 again. A name that a spreadsheet could take
//! for a formula starts with an apostrophe.

use std::fmt::Write;

use super::output::{ArrayValues, SurfaceOutput, TENSOR_COMPONENTS, WriteError};

const DISPLACEMENT: &str = "displacement_mm";

/// `node_id,x_mm,y_mm,z_mm`, then the arrays; `displacement_mm` becomes `ux_mm,uy_mm,uz_mm`.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let mut text = String::new();
    put_row(&mut text, header(output).iter().map(|name| cell(name)));
    for (number, point) in output.surface.points.iter().enumerate() {
        let node_ids = output.surface.node_ids.as_ref();
        let node_id = node_ids.map_or(number as u32, |ids| ids[number]);
        let mut row = vec![node_id.to_string()];
        row.extend(point.iter().map(digits));
        for array in &output.point_arrays {
            match array.values {
                ArrayValues::Reals(values) => row.push(digits(&values[number])),
                ArrayValues::Integers(values) => row.push(values[number].to_string()),
                ArrayValues::Vectors(values) => {
                    row.extend(values[number].iter().map(digits));
                }
                ArrayValues::Tensors(values) => row.extend(values[number].iter().map(digits)),
            }
        }
        put_row(&mut text, row.into_iter());
    }
    Ok(text.into_bytes())
}

/// The shortest text that reads as the same f64, with an exponent where that is shorter.
fn digits(value: &f64) -> String {
    format!("{value:?}")
}

fn header(output: &SurfaceOutput) -> Vec<String> {
    let mut names: Vec<String> = ["node_id", "x_mm", "y_mm", "z_mm"].map(Into::into).into();
    for array in &output.point_arrays {
        match array.values {
            ArrayValues::Vectors(_) if array.name == DISPLACEMENT => {
                names.extend(["ux_mm", "uy_mm", "uz_mm"].map(String::from));
            }
            ArrayValues::Vectors(_) => {
                names.extend(["x", "y", "z"].map(|axis| format!("{}_{axis}", array.name)));
            }
            ArrayValues::Tensors(_) => {
                names.extend(TENSOR_COMPONENTS.map(|of| format!("{}_{of}", array.name)));
            }
            ArrayValues::Reals(_) | ArrayValues::Integers(_) => names.push(array.name.to_string()),
        }
    }
    names
}

fn put_row(text: &mut String, cells: impl Iterator<Item = String>) {
    for (number, cell) in cells.enumerate() {
        let separator = if number > 0 { "," } else { "" };
        // Writing to a string does not fail.
        let _ = write!(text, "{separator}{cell}");
    }
    text.push_str("\r\n");
}

/// A text as one cell: never a formula, and quoted where it holds a separator.
pub fn cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    let text = if is_formula { format!("'{text}") } else { text.to_string() };
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::cell;

    #[test]
    fn a_formula_becomes_a_text() {
        assert_eq!(cell("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        assert_eq!(cell("@a,b"), "\"'@a,b\"");
        assert_eq!(cell("lower lip"), "lower lip");
        assert_eq!(cell("a\"b"), "\"a\"\"b\"");
    }
}
