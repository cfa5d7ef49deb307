//! Rigid movements as text for navigation: a row-major matrix, and ITK's transform file with its inverse direction.
//!
//! A matrix here moves bone: x' = R x + t in mm. ITK and what is built on it, such as 3D Slicer, keep in a transform
//! file what resampling needs: from the place after the movement to the place before it, in LPS. So the file holds
//! the inverse, R^T and -R^T t. Numbers are written so that reading them gives the same bits.

use std::fmt::Write;

use nalgebra::Matrix3;

use super::{MovementError, RigidMovement};
use crate::mesh::Vector;

const HEADER: &str = "#Insight Transform File V1.0";

/// No head is that far from anything, and what is within it can be turned about any centre.
const FARTHEST_MM: f64 = 1e9;

/// Why a text is no rigid movement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TransformTextError {
    #[error("the text begins with {found:?}, and a transform file with {HEADER:?}")]
    Header { found: String },
    #[error("the line of {what} is missing")]
    Missing { what: &'static str },
    #[error("the file holds {found} transforms, and has to hold one")]
    Several { found: usize },
    #[error("{what} are {wanted} numbers, here are {found}")]
    Count { what: &'static str, wanted: usize, found: usize },
    #[error("{text:?} is no number from -{FARTHEST_MM:e} to {FARTHEST_MM:e}")]
    Number { text: String },
    #[error(transparent)]
    Movement(#[from] MovementError),
}

impl RigidMovement {
    /// Row-major, last row 0 0 0 1.
    pub fn matrix4(&self) -> [f64; 16] {
        let (r, t) = (self.rotation(), self.translation());
        std::array::from_fn(|place| match (place / 4, place % 4) {
            (3, column) => f64::from(u8::from(column == 3)),
            (row, 3) => t[row],
            (row, column) => r[(row, column)],
        })
    }

    /// Four lines of four numbers, which move bone.
    pub fn to_matrix_text(&self, comment: &str) -> String {
        let mut text = format!("# {comment}\n# direction: moves bone, x' = R x + t in mm\n");
        for row in self.matrix4().chunks(4) {
            let row: Vec<String> = row.iter().map(f64::to_string).collect();
            let _ = writeln!(text, "{}", row.join(" "));
        }
        text
    }

    /// Reads what [`RigidMovement::to_matrix_text`] wrote, to the bit.
    pub fn from_matrix_text(text: &str) -> Result<Self, TransformTextError> {
        let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        let numbers = numbers(&lines.collect::<Vec<_>>().join(" "))?;
        let found = numbers.len();
        let entries: [f64; 16] = numbers.try_into().map_err(|_| TransformTextError::Count {
            what: "the entries of a matrix",
            wanted: 16,
            found,
        })?;
        Ok(RigidMovement::from_matrix4(&entries)?)
    }

    /// A transform file of this movement, which has to be in LPS.
    pub fn to_itk_text(&self, comment: &str) -> String {
        let resampling = self.inverse();
        let (r, t) = (resampling.rotation(), resampling.translation());
        let entries = (0..9).map(|place| r[(place / 3, place % 3)]).chain(t.iter().copied());
        let entries: Vec<String> = entries.map(|entry| entry.to_string()).collect();
        format!(
            "{HEADER}\n# {comment}\n# direction: resampling, the inverse of what moves bone; LPS, mm\n#Transform 0\n\
             Transform: AffineTransform_double_3_3\nParameters: {}\nFixedParameters: 0 0 0\n",
            entries.join(" ")
        )
    }

    /// The movement of bone of a transform file of one rigid transform.
    pub fn from_itk_text(text: &str) -> Result<Self, TransformTextError> {
        let first = text.lines().next().unwrap_or_default();
        if first.trim() != HEADER {
            return Err(TransformTextError::Header { found: first.to_owned() });
        }
        let found = text.lines().filter(|line| line.trim().starts_with("Transform:")).count();
        if found > 1 {
            return Err(TransformTextError::Several { found });
        }
        let parameters = itk_numbers(text, "Parameters:", 12)?;
        let centre = itk_numbers(text, "FixedParameters:", 3)?;
        let rotation = Matrix3::from_fn(|row, column| parameters[3 * row + column]);
        let centre = Vector::new(centre[0], centre[1], centre[2]);
        let translation = Vector::new(parameters[9], parameters[10], parameters[11]);
        // ITK turns about its centre; one at the origin changes no digit.
        let translation = match centre == Vector::zeros() {
            true => translation,
            false => translation + centre - rotation * centre,
        };
        Ok(RigidMovement::new(rotation, translation)?.inverse())
    }
}

fn itk_numbers(
    text: &str,
    what: &'static str,
    wanted: usize,
) -> Result<Vec<f64>, TransformTextError> {
    let line = text.lines().find_map(|line| line.trim().strip_prefix(what));
    let found = numbers(line.ok_or(TransformTextError::Missing { what })?)?;
    match found.len() == wanted {
        true => Ok(found),
        false => Err(TransformTextError::Count { what, wanted, found: found.len() }),
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, TransformTextError> {
    let number = |word: &str| {
        let number = word.parse().ok().filter(|number: &f64| number.abs() <= FARTHEST_MM);
        number.ok_or_else(|| TransformTextError::Number { text: word.to_owned() })
    };
    text.split_whitespace().map(number).collect()
}
