//! Field of view: where the head reaches the border of the image.

use super::head::Head;
use crate::mesh::Warning;

/// Touching the border by less is none, in mm².
const LEAST: f64 = 100.0;

pub(super) fn finding(head: &Head<'_>) -> Option<Warning> {
    let mut warning = Warning::new("field-of-view-cut", "");
    let mut words = Vec::new();
    for axis in 0..3 {
        for grows in [false, true] {
            let area = area(head, axis, grows);
            if area > LEAST {
                let side = side(head, axis, grows);
                words.push(format!("{} over {:.0} cm2", side.words, area / 100.0));
                warning = warning.with(side.number, area);
            }
        }
    }
    warning.detail = format!("the head reaches the border of the image: {}", words.join(", "));
    (!words.is_empty()).then_some(warning)
}

/// What of the head lies in the first or the last layer along an axis, in mm².
fn area(head: &Head<'_>, axis: usize, grows: bool) -> f64 {
    let grid = head.grid;
    let wanted = if grows { grid.size[axis] - 1 } else { 0 };
    let inside = head.skin.head.inside.iter().enumerate().filter(|(_, inside)| **inside);
    let count = inside.filter(|(voxel, _)| grid.index(*voxel)[axis] == wanted).count();
    count as f64 * grid.voxel_volume() / grid.spacing[axis]
}

struct Side {
    words: &'static str,
    number: &'static str,
}

/// The words for a side, by the direction in LPS that it lies in.
fn side(head: &Head<'_>, axis: usize, grows: bool) -> Side {
    let direction = head.image.directions()[axis] * if grows { 1.0 } else { -1.0 };
    let largest = direction.iamax();
    let (words, number) = match (largest, direction[largest] > 0.0) {
        (0, true) => ("on the left", "left_mm2"),
        (0, false) => ("on the right", "right_mm2"),
        (1, true) => ("at the back", "back_mm2"),
        (1, false) => ("in front", "front_mm2"),
        (_, true) => ("at the top", "top_mm2"),
        (_, false) => ("at the bottom", "bottom_mm2"),
    };
    Side { words, number }
}
