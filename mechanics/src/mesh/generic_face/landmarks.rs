//! Landmarks of the generic face: 12 in the middle and 10 pairs, as many as Kim et al. 2012 map muscles by.

use std::collections::BTreeMap;

use super::super::Vector;
use super::shape::{FaceShape, LIP_ROW, Lip};

/// The farthest point in a direction among those of the middle line between two rows.
struct Extreme {
    name: &'static str,
    rows: [f64; 2],
    direction: [f64; 3],
}

const FORWARD: [f64; 3] = [0.0, -1.0, 0.0];
const BACK: [f64; 3] = [0.0, 1.0, 0.0];

const EXTREMES: [Extreme; 9] = [
    Extreme { name: "glabella", rows: [49.0, 52.0], direction: FORWARD },
    Extreme { name: "nasion", rows: [44.0, 48.5], direction: BACK },
    Extreme { name: "pronasale", rows: [34.5, 41.0], direction: FORWARD },
    Extreme { name: "subnasale", rows: [30.5, 34.5], direction: BACK },
    Extreme { name: "labrale_superius", rows: [27.9, 31.0], direction: FORWARD },
    Extreme { name: "labrale_inferius", rows: [23.5, 27.1], direction: FORWARD },
    Extreme { name: "sulcus_mentolabialis", rows: [19.5, 24.0], direction: BACK },
    Extreme { name: "pogonion", rows: [14.0, 19.5], direction: FORWARD },
    Extreme { name: "menton", rows: [10.0, 14.0], direction: [0.0, -1.0, -4.0] },
];

/// By row and degrees to the left.
const PAIRS: [(&str, f64, f64); 10] = [
    ("endocanthion", 46.2, 13.2),
    ("exocanthion", 46.2, 34.0),
    ("orbitale", 43.6, 26.0),
    ("zygion", 42.5, 78.0),
    ("alare", 36.6, 12.0),
    ("subalare", 33.6, 9.5),
    ("crista_philtri", 29.4, 4.4),
    ("cheilion", LIP_ROW, 22.9),
    ("mid_cheek", 33.0, 45.0),
    ("gonion", 19.0, 80.0),
];

/// How finely the middle line is searched.
const STEPS: usize = 400;

pub(super) fn of(shape: &FaceShape) -> BTreeMap<String, Vector> {
    let mut found = BTreeMap::new();
    for extreme in &EXTREMES {
        if let Some(point) = extreme.of(shape) {
            found.insert(extreme.name.to_owned(), point);
        }
    }
    for (name, lip) in [("stomion_superius", Lip::Upper), ("stomion_inferius", Lip::Lower)] {
        found.insert(name.to_owned(), shape.on_skin(LIP_ROW, 0.0, lip));
    }
    found.insert("trichion".to_owned(), shape.on_skin(53.5, 0.0, Lip::Upper));
    for (name, row, degrees) in PAIRS {
        let left = shape.on_skin(row, f64::to_radians(degrees), Lip::Upper);
        found.insert(format!("{name}_left"), left);
        found.insert(format!("{name}_right"), Vector::new(-left.x, left.y, left.z));
    }
    found
}

impl Extreme {
    fn of(&self, shape: &FaceShape) -> Option<Vector> {
        let [from, to] = self.rows;
        let row = |step: usize| from + (to - from) * step as f64 / STEPS as f64;
        let direction = Vector::from(self.direction);
        (0..=STEPS)
            .map(|step| shape.on_skin(row(step), 0.0, Lip::Upper))
            .max_by(|a, b| a.dot(&direction).total_cmp(&b.dot(&direction)))
    }
}
