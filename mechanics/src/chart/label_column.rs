//! Labels in a column beside a plot: each as near as there is room to the height that it belongs to, with a line that leads
//! there from its mark.

use super::drawing::{Document, Paint, Style, wrapped};
use super::symbol::Symbol;

/// A label of the column.
pub struct ColumnLabel {
    /// The end of what it names, at the left of the column.
    pub at: [f64; 2],
    /// None names a dashed line.
    pub symbol: Option<Symbol>,
    pub words: String,
}

const LINE: f64 = 16.0;
/// From the plot to the labels' symbols, where lines lead from one to the other, and from these to the words.
const LEADERS: f64 = 22.0;
const SYMBOL: f64 = 24.0;

/// Draws labels from `left` on in so much room and between two heights.
pub fn write_labels(
    document: &mut Document,
    labels: &[ColumnLabel],
    [left, room]: [f64; 2],
    ends: [f64; 2],
) {
    let style = Style::of(12.5);
    let lines = |label: &ColumnLabel| wrapped(&label.words, room - LEADERS - SYMBOL, style);
    let lines: Vec<Vec<String>> = labels.iter().map(lines).collect();
    let heights: Vec<f64> = lines.iter().map(|own| LINE * own.len() as f64 + 2.0).collect();
    let wanted: Vec<f64> = labels.iter().map(|label| label.at[1]).collect();
    let tops = spread(&wanted, &heights, ends);
    for (((label, lines), top), height) in labels.iter().zip(&lines).zip(tops).zip(heights) {
        let middle = top + height / 2.0;
        let symbol = label.symbol.unwrap_or_else(Symbol::neutral);
        let elbow = [[left + 4.0, label.at[1]], [left + LEADERS - 4.0, middle]];
        document.stroke(&[label.at, elbow[0], elbow[1]], symbol.colour, 0.9);
        match label.symbol {
            Some(symbol) => symbol.draw(document, [left + LEADERS + 6.0, middle], 5.0, 1.0),
            None => {
                let steps = format!("M{:.1} {middle:.1}h19", left + LEADERS - 4.0);
                document.path(&steps, Paint { dashes: "5 4", ..Paint::line(symbol.colour, 1.3) });
            }
        }
        for (line, words) in lines.iter().enumerate() {
            let y = top + LINE * (line as f64 + 0.8);
            let at = [left + LEADERS + SYMBOL - 6.0, y];
            document.text(at, room, style.coloured(symbol.ink()), words);
        }
    }
}

/// Labels that touch each other.
struct Group {
    labels: f64,
    height: f64,
    /// The sum of where the labels would have the top of the group.
    wished: f64,
    top: f64,
}

/// The tops of labels whose middles want to stand at these heights: none over another and all within the ends as far as these have
/// room, and moved as little as that takes: those that touch each other by the mean of what they want.
fn spread(wanted: &[f64], heights: &[f64], [top, foot]: [f64; 2]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let within = |wished: f64, height: f64| wished.min(foot - height).max(top);
    let mut groups: Vec<Group> = Vec::new();
    for &label in &order {
        let (height, wished) = (heights[label], wanted[label] - heights[label] / 2.0);
        let mut last = Group { labels: 1.0, height, wished, top: within(wished, height) };
        while let Some(above) = groups.pop_if(|above| above.top + above.height > last.top) {
            let (labels, height) = (above.labels + last.labels, above.height + last.height);
            let wished = above.wished + last.wished - above.height * last.labels;
            last = Group { labels, height, wished, top: within(wished / labels, height) };
        }
        groups.push(last);
    }
    let mut tops = vec![0.0; wanted.len()];
    let mut left = order.into_iter();
    for group in groups {
        let mut next = group.top;
        for label in left.by_ref().take(group.labels as usize) {
            tops[label] = next;
            next += heights[label];
        }
    }
    tops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stay_where_there_is_room_and_share_it_where_there_is_none() {
        let tops = |wanted: &[f64]| spread(wanted, &vec![10.0; wanted.len()], [0.0, 100.0]);
        assert_eq!(tops(&[50.0, 15.0]), [45.0, 10.0]);
        assert_eq!(tops(&[50.0, 50.0, 50.0]), [35.0, 45.0, 55.0]);
        // The third pushes the two above it, which touch already.
        assert_eq!(tops(&[50.0, 50.0, 56.0]), [37.0, 47.0, 57.0]);
        assert_eq!(tops(&[99.0, 100.0]), [80.0, 90.0]);
        assert_eq!(tops(&[0.0, 1.0, 2.0]), [0.0, 10.0, 20.0]);
        assert!(tops(&[]).is_empty());
        assert_eq!(spread(&[50.0, 50.0], &[20.0, 10.0], [0.0, 100.0]), [32.5, 52.5]);
    }
}
