//! Map of failures: the outcome of each method as a parameter grows; one row for each method, one panel for each axis,
//! one small cell for each value. A wrong answer without a warning is what the eye must find first.

use super::colour::{FAINT_INK, INK, SERIES};
use super::drawing::{Document, Rectangle, Style, estimated_width, wrapped};
use super::svg::svg;

/// Outcome of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Good,
    Cautious,
    Warned,
    Refused,
    Failed,
    Wrong,
}

/// One thing that is turned up.
pub struct StabilityAxis {
    pub title: String,
    /// Empty where the values are words.
    pub unit: String,
    /// What counts as right, e.g. `right to 0.5 mm`.
    pub bound: String,
    pub values: Vec<String>,
    /// [row][value]; none where the value means nothing to the method.
    pub marks: Vec<Vec<Option<Mark>>>,
}

/// All axes for all methods.
pub struct StabilityMap<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// Names of the methods.
    pub rows: &'a [String],
    pub axes: &'a [StabilityAxis],
}

/// About that of a page, so that words stay as large as they are.
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 28.0;
const NAMES: f64 = 136.0;
const GAP: f64 = 22.0;
const CELL: [f64; 2] = [26.0, 20.0];
const ROW: f64 = 42.0;
/// Above the first row of a panel: its title, its unit, its bound, its values.
const PANEL_HEAD: f64 = 96.0;
/// The size of values, units and notes, and from one line of values to the next.
const SMALL: f64 = 12.0;
const VALUES: f64 = 16.0;
/// Room for the title of an axis with few values.
const NARROWEST: f64 = 150.0;

const LEGEND: [(Mark, &str); 6] = [
    (Mark::Good, "right"),
    (Mark::Cautious, "right, warns"),
    (Mark::Warned, "wrong, warns"),
    (Mark::Refused, "refuses, says where"),
    (Mark::Failed, "ends with an error"),
    (Mark::Wrong, "WRONG, AND SILENT"),
];

impl StabilityMap<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> String {
        let bands = self.bands();
        let room = WIDTH - 2.0 * MARGIN;
        let subtitle = wrapped(self.subtitle, room, Style::of(13.0));
        let head = 62.0 + 18.0 * subtitle.len() as f64;
        let legend = 40.0;
        let heights = bands.iter().map(|band| PANEL_HEAD + ROW * band.rows.len() as f64 + 16.0);
        let heights: Vec<f64> = heights.collect();
        let height = head + legend + heights.iter().sum::<f64>() + 8.0;
        let mut document = Document::new(WIDTH, height);
        document.text([MARGIN, 42.0], room, Style::of(22.0).bold(), self.title);
        for (line, words) in subtitle.iter().enumerate() {
            let y = 66.0 + 18.0 * line as f64;
            document.text([MARGIN, y], room, Style::of(13.0).faint(), words);
        }
        draw_legend(&mut document, head + 2.0);
        let mut top = head + legend;
        for (band, height) in bands.iter().zip(heights) {
            self.draw_band(&mut document, top, band);
            top += height;
        }
        svg(&document, self.title)
    }

    /// Axes side by side as far as there is room, and as long as most methods of a band have them. A method without any of them
    /// has no row there, and what no method has is not drawn.
    fn bands(&self) -> Vec<Band<'_>> {
        let mut bands: Vec<Band> = Vec::new();
        let mut x = f64::INFINITY;
        for axis in self.axes {
            let rows = axis.rows();
            if rows.is_empty() {
                continue;
            }
            let is_alike = |band: &Band| {
                let (fewer, more) =
                    (rows.len().min(band.rows.len()), rows.len().max(band.rows.len()));
                2 * fewer > more
            };
            if x + axis.width() > WIDTH - MARGIN || !bands.last().is_some_and(is_alike) {
                bands.push(Band::default());
                x = MARGIN + NAMES;
            }
            x += axis.width() + GAP;
            if let Some(band) = bands.last_mut() {
                band.axes.push(axis);
                band.rows.extend(rows);
                band.rows.sort_unstable();
                band.rows.dedup();
            }
        }
        bands
    }

    fn draw_band(&self, document: &mut Document, top: f64, band: &Band) {
        let first = top + PANEL_HEAD;
        let names = band.rows.iter().filter_map(|row| self.rows.get(*row));
        for (row, name) in names.enumerate() {
            let y = first + ROW * row as f64;
            if row % 2 == 0 {
                let stripe = Rectangle {
                    x: MARGIN - 8.0,
                    y: y - 5.0,
                    width: WIDTH - 2.0 * MARGIN + 16.0,
                    height: ROW,
                };
                document.rectangle(stripe, "#f4f5f7", 0.0);
            }
            let style = Style::of(12.0).bold();
            let lines = wrapped(name, NAMES - 10.0, style);
            for (line, words) in lines.iter().take(2).enumerate() {
                document.text([MARGIN, y + 14.0 + 15.0 * line as f64], NAMES - 10.0, style, words);
            }
        }
        let mut x = MARGIN + NAMES;
        for axis in &band.axes {
            axis.draw(document, [x, top], &band.rows);
            x += axis.width() + GAP;
        }
    }
}

/// Axes side by side.
#[derive(Default)]
struct Band<'a> {
    axes: Vec<&'a StabilityAxis>,
    /// Methods that have one of them, by their places.
    rows: Vec<usize>,
}

impl StabilityAxis {
    /// The methods that a value means something to, by their places.
    fn rows(&self) -> Vec<usize> {
        let marks = self.marks.iter().enumerate();
        marks.filter(|(_, marks)| marks.iter().any(Option::is_some)).map(|(row, _)| row).collect()
    }

    fn width(&self) -> f64 {
        (CELL[0] * self.values.len() as f64).max(NARROWEST)
    }

    fn draw(&self, document: &mut Document, [x, top]: [f64; 2], rows: &[usize]) {
        let room = self.width() + GAP - 4.0;
        document.text([x, top + 16.0], room, Style::of(14.0).bold(), &self.title);
        let about: Vec<&str> = [&self.unit, &self.bound]
            .into_iter()
            .map(String::as_str)
            .filter(|s| !s.is_empty())
            .collect();
        for (line, words) in about.iter().enumerate() {
            let at = [x, top + 33.0 + 15.0 * line as f64];
            document.text(at, room, Style::of(SMALL).faint(), words);
        }
        let first = top + PANEL_HEAD;
        self.draw_values(document, [x, first - 6.0]);
        let own = rows.iter().filter_map(|row| self.marks.get(*row)).enumerate();
        for (row, marks) in own.filter(|(_, marks)| marks.iter().any(Option::is_some)) {
            let y = first + ROW * row as f64;
            for (place, mark) in marks.iter().enumerate() {
                let at = [x + CELL[0] * place as f64, y];
                if let Some(mark) = mark.filter(|mark| *mark != Mark::Wrong) {
                    draw_mark(document, at, mark);
                }
            }
            // Above their neighbours, which they overlap.
            for (place, _) in
                marks.iter().enumerate().filter(|(_, mark)| **mark == Some(Mark::Wrong))
            {
                draw_mark(document, [x + CELL[0] * place as f64, y], Mark::Wrong);
            }
            let style = match marks.contains(&Some(Mark::Wrong)) {
                true => Style::of(SMALL).bold(),
                false => Style::of(SMALL).faint(),
            };
            document.text([x, y + CELL[1] + 12.0], room, style, &self.note(marks));
        }
    }

    /// Over the cells: in two lines by turns where they have no room in one.
    fn draw_values(&self, document: &mut Document, [x, foot]: [f64; 2]) {
        let style = Style::of(SMALL).middle();
        let fits = |words: &String| estimated_width(words, style) <= CELL[0] - 5.0;
        let has_room = self.values.iter().all(fits);
        for (place, words) in self.values.iter().enumerate() {
            let middle = x + CELL[0] * (place as f64 + 0.5);
            let is_upper = !has_room && place % 2 == 1;
            let y = if is_upper { foot - VALUES } else { foot };
            document.text([middle, y], 2.0 * CELL[0], style, words);
            if is_upper {
                document.stroke(&[[middle, y + 4.0], [middle, foot + 4.0]], FAINT_INK, 0.8);
            }
        }
    }

    /// Where the method is first silently wrong, or else where it first has no right answer, or else where it first
    /// warns.
    fn note(&self, marks: &[Option<Mark>]) -> String {
        let first = |wanted: &dyn Fn(Mark) -> bool| {
            let place = marks.iter().position(|mark| mark.is_some_and(wanted));
            place.and_then(|place| Some((self.values.get(place)?, marks[place]?)))
        };
        let not_right = |mark: Mark| !matches!(mark, Mark::Good | Mark::Cautious);
        let not_good = |mark: Mark| mark != Mark::Good;
        let worst = first(&|mark| mark == Mark::Wrong).or_else(|| first(&not_right));
        match worst.or_else(|| first(&not_good)) {
            Some((value, Mark::Wrong)) => format!("SILENTLY WRONG at {value}"),
            Some((value, Mark::Cautious)) => format!("warns from {value}"),
            Some((value, Mark::Warned)) => format!("wrong, warns from {value}"),
            Some((value, Mark::Refused)) => format!("refuses from {value}"),
            Some((value, Mark::Failed)) => format!("fails from {value}"),
            _ => "right throughout".to_owned(),
        }
    }
}

fn draw_legend(document: &mut Document, top: f64) {
    let mut x = MARGIN;
    for (mark, words) in LEGEND {
        draw_mark(document, [x, top], mark);
        let style = if mark == Mark::Wrong { Style::of(SMALL).bold() } else { Style::of(SMALL) };
        document.text([x + CELL[0] + 6.0, top + 15.0], 160.0, style, words);
        x += CELL[0] + 20.0 + 0.9 * estimated_width(words, style);
    }
}

/// A cell with its sign, so that colour says nothing alone (colours after Okabe and Ito, see `colour`).
fn draw_mark(document: &mut Document, [x, y]: [f64; 2], mark: Mark) {
    let [width, height] = [CELL[0] - 2.0, CELL[1]];
    let cell = Rectangle { x: x + 1.0, y, width, height };
    let (cx, cy) = (x + CELL[0] / 2.0, y + height / 2.0);
    let sign = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|[dx, dy]| [cx + dx, cy + dy]).collect()
    };
    match mark {
        Mark::Good => {
            document.rectangle(cell, "#c5e8dc", 3.0);
            document.stroke(&sign(&[[-4.5, 0.5], [-1.5, 4.0], [5.0, -4.0]]), "#00664b", 2.0);
        }
        Mark::Cautious => {
            document.rectangle(cell, "#f7dfa5", 3.0);
            document.stroke(&sign(&[[-4.5, 0.5], [-1.5, 4.0], [5.0, -4.0]]), "#6b4a00", 2.0);
        }
        Mark::Warned => {
            document.rectangle(cell, SERIES[5], 3.0);
            document.stroke(&sign(&[[0.0, -6.0], [0.0, 1.5]]), INK, 2.6);
            document.stroke(&sign(&[[0.0, 5.8], [0.0, 6.0]]), INK, 2.6);
        }
        Mark::Refused => {
            document.rectangle(cell, "#a9cbe6", 3.0);
            document.stroke(&sign(&[[-5.5, 0.0], [5.5, 0.0]]), "#0b3c5d", 3.0);
        }
        Mark::Failed => {
            document.rectangle(cell, "#56606b", 3.0);
            document.stroke(&sign(&[[-4.0, -4.0], [4.0, 4.0]]), "#ffffff", 2.2);
            document.stroke(&sign(&[[-4.0, 4.0], [4.0, -4.0]]), "#ffffff", 2.2);
        }
        Mark::Wrong => {
            let around = Rectangle {
                x: cell.x - 3.0,
                y: cell.y - 3.0,
                width: width + 6.0,
                height: height + 6.0,
            };
            document.rectangle(around, "#000000", 2.0);
            document.rectangle(cell, "#e0003c", 0.0);
            document.stroke(&sign(&[[-5.0, -6.0], [5.0, 6.0]]), "#ffffff", 3.6);
            document.stroke(&sign(&[[-5.0, 6.0], [5.0, -6.0]]), "#ffffff", 3.6);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(marks: Vec<Option<Mark>>) -> String {
        let values = (0..marks.len()).map(|value| format!("v{value}")).collect();
        let axis = StabilityAxis {
            title: "Movement".to_owned(),
            unit: "mm".to_owned(),
            bound: String::new(),
            values,
            marks: vec![marks],
        };
        let rows = ["plain".to_owned()];
        StabilityMap { title: "map", subtitle: "", rows: &rows, axes: &[axis] }.to_svg()
    }

    #[test]
    fn a_silent_error_is_named_before_every_warning() {
        let [good, cautious] = [Mark::Good, Mark::Cautious].map(Some);
        let [warned, wrong] = [Mark::Warned, Mark::Wrong].map(Some);
        assert!(drawn(vec![good, warned, wrong]).contains("SILENTLY WRONG at v2"));
        assert!(drawn(vec![cautious, good, warned]).contains("wrong, warns from v2"));
        assert!(drawn(vec![good, cautious]).contains(">warns from v1"));
        assert!(drawn(vec![good, good]).contains("right throughout"));
    }

    #[test]
    fn what_means_nothing_to_a_method_has_no_row_and_what_means_nothing_to_any_no_panel() {
        let axis = |title: &str, marks| StabilityAxis {
            title: title.to_owned(),
            unit: String::new(),
            bound: String::new(),
            values: vec!["1".to_owned()],
            marks,
        };
        let good = || vec![Some(Mark::Good)];
        let axes = [
            axis("Movement", vec![good(), good(), good()]),
            axis("Fibres", vec![vec![None], good(), vec![None]]),
            axis("Nothing", vec![vec![None]; 3]),
        ];
        let rows = ["linear", "fibred", "springs"].map(str::to_owned);
        let map = StabilityMap { title: "map", subtitle: "", rows: &rows, axes: &axes };
        let bands = map.bands();
        assert_eq!(
            bands.iter().map(|band| band.rows.clone()).collect::<Vec<_>>(),
            [vec![0, 1, 2], vec![1]]
        );
        let svg = map.to_svg();
        assert_eq!(
            ["linear", "fibred", "springs"].map(|row| svg.matches(&format!(">{row}<")).count()),
            [1, 2, 1]
        );
        assert!(svg.contains("Fibres") && !svg.contains("Nothing"));
        assert_eq!(svg.matches("right throughout").count(), 4);
    }

    #[test]
    fn axes_that_do_not_fit_side_by_side_go_below_each_other() {
        let axis = || StabilityAxis {
            title: String::new(),
            unit: String::new(),
            bound: String::new(),
            values: vec![String::new(); 9],
            marks: vec![vec![Some(Mark::Good); 9]],
        };
        let axes: Vec<StabilityAxis> = (0..8).map(|_| axis()).collect();
        let map = StabilityMap { title: "", subtitle: "", rows: &[], axes: &axes };
        let bands: Vec<usize> = map.bands().iter().map(|band| band.axes.len()).collect();
        assert_eq!(bands.iter().sum::<usize>(), 8);
        assert!(bands.iter().all(|axes| (1..=3).contains(axes)), "{bands:?}");
    }
}
