//! Tests of the chart of speed and accuracy.

use super::super::drawing::Rectangle;
use super::super::ladder_content::LadderFailure;
use super::super::series::MethodSeries;
use super::*;
use crate::chart::drawing::Item;

fn mark(series: usize, level: u32, [wall_s, error_mm]: [f64; 2], on_front: bool) -> LadderMark {
    LadderMark { series, level, wall_s, error_mm, on_front, runs: Vec::new() }
}

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|name| (*name).to_owned()).collect()
}

fn series(list: &[&str]) -> Vec<MethodSeries> {
    let of = |name: &String| MethodSeries {
        name: name.clone(),
        label: format!("label of {name}"),
        method: "fem_linear".to_owned(),
    };
    names(list).iter().map(of).collect()
}

fn drawn(marks: &[LadderMark], failures: &[LadderFailure]) -> String {
    let series = series(&["fem <linear>", "msm", "warp & \"fit\""]);
    let notes = names(&["Reproduced by a command."]);
    let picture = LadderPicture {
        title: "a < b",
        subtitle: "c & d",
        series: &series,
        marks,
        failures,
        notes: &notes,
    };
    super::super::svg::svg(&picture.to_drawing(), picture.title)
}

/// Attributes of every element, read as XML.
fn read(svg: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = quick_xml::Reader::from_str(svg);
    let mut elements = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Start(start) | quick_xml::events::Event::Empty(start) => {
                let attributes = start.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    (attribute.key.as_ref().to_owned(), attribute.value.to_string())
                });
                elements.push((start.name().as_ref().to_owned(), attributes.collect()));
            }
            quick_xml::events::Event::Eof => return elements,
            _ => {}
        }
    }
}

fn count(svg: &str, class: &str) -> usize {
    svg.matches(&format!("<g class=\"{class}\"")).count()
}

#[test]
fn every_mark_run_and_failure_is_drawn() {
    let mut marks = vec![
        mark(0, 0, [0.1, 0.5], true),
        mark(0, 1, [1.0, 0.05], true),
        mark(1, 0, [2.0, 0.9], false),
    ];
    marks[2].runs = vec![[1.9, 0.8], [2.1, 1.0]];
    let failures = [
        LadderFailure { series: 1, level: 1, reason: "solver-diverged".into() },
        LadderFailure { series: 2, level: 0, reason: "method-not-available".into() },
    ];
    let svg = drawn(&marks, &failures);
    assert_eq!(["mark", "run", "failure", "front"].map(|class| count(&svg, class)), [3, 2, 2, 1]);
    for words in ["a &lt; b", "c &amp; d", "solver-diverged", "Reproduced by a command."] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(svg.contains("fem &lt;linear&gt;, level 1: 1 s, p95 error 0.050 mm"));
    assert_eq!(count(&drawn(&marks, &[]), "failure"), 0);
}

#[test]
fn what_a_mark_is_of_stands_at_it_and_the_legend_has_what_is_drawn() {
    let marks = [mark(0, 0, [0.1, 0.5], true), mark(0, 2, [1.0, 0.05], true)];
    let failures = [LadderFailure { series: 2, level: 0, reason: "diverged".into() }];
    let svg = drawn(&marks, &failures);
    let group = |class: &str, wanted: &[(&str, &str)]| {
        let has = |attributes: &[(String, String)], name: &str, value: &str| {
            attributes.iter().any(|(own, is)| own == name && is == value)
        };
        let groups = read(&svg).into_iter().map(|(_, attributes)| attributes);
        let own = groups.filter(|attributes| has(attributes, "class", class));
        own.filter(|of| wanted.iter().all(|(name, value)| has(of, name, value))).count()
    };
    let fem = ("data-label", "label of fem &lt;linear&gt;");
    for level in ["0", "2"] {
        let of = [fem, ("data-method", "fem_linear"), ("data-level", level)];
        assert_eq!(group("mark", &of), 1, "{svg}");
    }
    let of = [("data-label", "label of warp &amp; &quot;fit&quot;"), ("data-level", "0")];
    assert_eq!(group("failure", &of), 1);
    // "msm" has no mark: its symbol stays its own, and the legend is without it.
    assert_eq!((group("legend", &[]), group("legend", &[fem])), (2, 1));
}

#[test]
fn the_front_only_ever_goes_right_and_down() {
    let marks = [
        mark(0, 0, [3.0, 0.02], true),
        mark(0, 1, [0.1, 0.5], true),
        mark(1, 0, [0.02, 2.0], true),
        mark(1, 1, [5.0, 3.0], false),
    ];
    let svg = drawn(&marks, &[]);
    let group = svg.split("<g class=\"front\">").nth(1).unwrap();
    let steps = group.split("<path d=\"M").nth(2).unwrap().split('"').next().unwrap();
    let corners: Vec<Vec<f64>> = steps
        .split('L')
        .map(|corner| corner.split(' ').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert!(corners.len() >= 7, "{corners:?}");
    for pair in corners.windows(2) {
        let (right, down) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        assert!(right >= 0.0 && down >= 0.0 && (right == 0.0) != (down == 0.0), "{pair:?}");
    }
}

#[test]
fn odd_numbers_leave_a_picture_that_can_be_drawn() {
    for odd in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        let marks = [
            mark(0, 0, [odd, 0.5], true),
            mark(1, 0, [0.1, odd], true),
            mark(9, 0, [1.0, 1.0], false),
        ];
        let svg = drawn(&marks, &[]);
        for (element, attributes) in read(&svg) {
            for (name, value) in attributes {
                let ours = !value.contains("sans-serif") && name != "class";
                let broken = value.contains("NaN") || value.contains("inf");
                assert!(!ours || !broken, "{odd}: {element} {name} {value}");
            }
        }
    }
    assert!(!drawn(&[], &[]).contains("NaN"));
}

#[test]
fn everything_lies_inside_the_picture() {
    let marks: Vec<LadderMark> = (0..60)
        .map(|n| {
            mark(n % 3, (n % 2) as u32, [1.07f64.powi(n as i32), 0.9f64.powi(n as i32)], n % 4 == 0)
        })
        .collect();
    let failures: Vec<LadderFailure> = (0..9)
        .map(|n| LadderFailure { series: n % 3, level: 0, reason: "a long reason ".repeat(20) })
        .collect();
    let svg = drawn(&marks, &failures);
    let elements = read(&svg);
    let number = |attributes: &[(String, String)], wanted: &str| {
        let found = attributes.iter().find(|(name, _)| name == wanted);
        found.and_then(|(_, value)| value.parse::<f64>().ok())
    };
    let height = number(&elements[0].1, "height").unwrap();
    for (element, attributes) in &elements {
        if element == "text" {
            let [x, y] = ["x", "y"].map(|name| number(attributes, name).unwrap());
            assert!((0.0..=WIDTH).contains(&x) && (-1.0..=height).contains(&y), "{x} {y}");
        }
    }
}

#[test]
fn captions_lie_over_no_mark_and_over_no_caption() {
    // A cloud that is dense where captions used to stand: in the lower left corner and at the right end.
    let marks: Vec<LadderMark> = (0..40)
        .map(|n| {
            let (across, upwards) = (f64::from(n % 8), f64::from(n / 8));
            let place = [1e-3 * 3.0_f64.powf(across), 2e-3 * 4.0_f64.powf(upwards)];
            mark(n as usize % 3, (n % 2) as u32, place, n == 0)
        })
        .collect();
    let series = series(&["linear FEM, stabilised", "springs", "mass-tensor, damped Jacobi"]);
    let picture = LadderPicture {
        title: "t",
        subtitle: "s",
        series: &series,
        marks: &marks,
        failures: &[],
        notes: &[],
    };
    let layout = Layout::of(&picture);
    let plot = layout.plot;
    let is_inside = |at: &[f64; 2]| {
        (plot.x..plot.x + plot.width).contains(&at[0])
            && (plot.y..plot.y + plot.height).contains(&at[1])
    };
    let document = picture.to_drawing();
    let captions: Vec<Rectangle> = document
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Text { at, style, words, .. } if is_inside(at) => {
                let (width, height) = (estimated_width(words, *style) * 0.93, style.size * 1.25);
                Some(Rectangle { x: at[0] - width / 2.0, y: at[1] - 0.76 * height, width, height })
            }
            _ => None,
        })
        .collect();
    assert!(!captions.is_empty());
    for (index, caption) in captions.iter().enumerate() {
        for mark in &marks {
            let [x, y] = layout.place(mark.wall_s, mark.error_mm);
            let beside = x + 6.0 < caption.x
                || caption.x + caption.width < x - 6.0
                || y + 6.0 < caption.y
                || caption.y + caption.height < y - 6.0;
            assert!(beside, "a caption lies over the mark at {x:.0}, {y:.0}");
        }
        for other in &captions[..index] {
            let beside = other.x + other.width <= caption.x + 1e-9
                || caption.x + caption.width <= other.x + 1e-9
                || other.y + other.height <= caption.y + 1e-9
                || caption.y + caption.height <= other.y + 1e-9;
            assert!(beside);
        }
    }
}
