//! Rigid movements as text for navigation: a row-major matrix, and ITK's transform file with its inverse direction.
//!
//! A matrix here moves bone: x' = R x + t in mm. ITK and what is built on it, such as 3D Slicer, keep in a transform
//! file what resampling needs: from the place after the movement to the place before it, in LPS. So the file holds
//! the inverse, R^T and -R^T t. Numbers are written so that reading them gives the same bits.

use std::fmt::Write;

use super::RigidMovement;

const HEADER: &str = "#Insight Transform File V1.0";

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
}
