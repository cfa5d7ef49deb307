//! Colours that people with colour-blindness can tell apart.

use std::sync::LazyLock;

/// Red, green and blue as stored in an image (sRGB).
pub type Rgb = [u8; 3];

/// Words and axes; words beside them; lines under marks; what pictures stand on. As `web/dist/assets/palette.css` has them, where they are
/// those of the page and of reports too (`tests/conventions/palette.rs`).
pub const INK: &str = "#22262b";
pub const FAINT_INK: &str = "#5b636d";
pub const GRID: &str = "#d9dce1";
pub const GROUND: &str = "#f3f4f6";
/// What is to be heeded, and what failed.
pub const WARN_INK: &str = "#6b4700";
pub const FAILED_INK: &str = "#a3262a";

/// Series of charts: Okabe and Ito, Color universal design, 2008, without yellow, which is faint on white; in an order in which
/// neighbours differ in lightness.
pub const SERIES: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#333333"];
/// The same for words: so much darker that they can be read on white.
pub(super) const SERIES_INK: [&str; 7] =
    ["#00639b", "#a84a00", "#00714f", "#9b4679", "#1d76ad", "#8a5f00", "#333333"];
/// The best compromises of a chart.
pub(super) const FRONT: &str = "#3a3f47";

/// The outline of what was, on skin and on maps: dark on light bands, and none of their colours.
pub const OUTLINE: Rgb = [0, 107, 60];

/// Bare skin, for the panels without values.
pub const SKIN: Rgb = [233, 196, 172];
/// What is seen of a surface from its back.
pub const BACK: Rgb = [168, 160, 154];

/// Magma from its light end, which leaves the unmoved face bright, to a purple on which shading is
/// still seen; lightness falls evenly. Source: van der Walt, Smith, matplotlib 1.5, 2015 (CC0).
const SEQUENCE: [Rgb; 7] = [
    [252, 253, 191],
    [254, 194, 135],
    [251, 135, 97],
    [229, 80, 100],
    [181, 54, 122],
    [129, 37, 129],
    [79, 18, 123],
];

/// Blue to orange, with light greys between, which colour blindness and print leave apart. Source: C. Brewer,
/// colorbrewer2.org (RdBu and PuOr, its warm half).
const SIGNED: [Rgb; 10] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [230, 235, 238],
    [240, 236, 230],
    [253, 200, 134],
    [241, 148, 60],
    [196, 91, 12],
    [127, 48, 4],
];

/// Okabe and Ito, Color universal design, 2008: those that stand for segments, in order.
pub const SEGMENTS: [Rgb; 5] =
    [[230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178]];
pub const FIXED: Rgb = [60, 60, 64];
pub const SLIDING: Rgb = [204, 121, 167];
pub const PRESCRIBED: Rgb = [213, 94, 0];
pub const FREE: Rgb = [222, 212, 203];

/// The colour at a fraction of the range; fractions outside [0, 1] get the colour of the nearer end.
pub fn sequential(fraction: f64) -> Rgb {
    along(&SEQUENCE, fraction)
}

fn along(stops: &[Rgb], fraction: f64) -> Rgb {
    let steps = (stops.len() - 1) as f64;
    let place = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) } * steps;
    let low = (place.floor() as usize).min(stops.len() - 2);
    let share = place - low as f64;
    [0, 1, 2].map(|channel| {
        let [from, to] = [stops[low][channel], stops[low + 1][channel]].map(f64::from);
        (from + (to - from) * share).round() as u8
    })
}

/// The colour of a signed value: 0 at minus the range, 1 at the range; a value of nothing is nearly white.
pub fn signed(fraction: f64) -> Rgb {
    along(&SIGNED, fraction)
}

/// The colour as `#rrggbb`.
pub fn hexadecimal([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Light intensity of a stored value, in [0, 1] (IEC 61966-2-1).
pub(super) fn to_linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Entries of the table from intensity to stored value, without the last.
const LEVELS: usize = 1 << 14;

/// The stored value of an intensity, clamped to what an image can store: the inverse of [`to_linear`],
/// from a table, because a picture asks millions of times.
pub(super) fn to_stored(intensity: f64) -> u8 {
    static STORED: LazyLock<Vec<u8>> = LazyLock::new(|| {
        (0..=LEVELS).map(|level| stored_value(level as f64 / LEVELS as f64)).collect()
    });
    STORED[(intensity.clamp(0.0, 1.0) * LEVELS as f64).round() as usize]
}

fn stored_value(intensity: f64) -> u8 {
    let value = if intensity <= 0.003_130_8 {
        intensity * 12.92
    } else {
        1.055 * intensity.powf(1.0 / 2.4) - 0.055
    };
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE L*, 0 for black and 100 for white.
    fn lightness(colour: Rgb) -> f64 {
        let [r, g, b] = colour.map(|value| to_linear(f64::from(value) / 255.0));
        116.0 * (0.2126 * r + 0.7152 * g + 0.0722 * b).cbrt() - 16.0
    }

    #[test]
    fn lightness_falls_evenly_along_the_sequence() {
        let steps: Vec<f64> = (0..12)
            .map(|step| {
                let [from, to] = [step, step + 1].map(|s| sequential(f64::from(s) / 12.0));
                lightness(from) - lightness(to)
            })
            .collect();
        let mean = steps.iter().sum::<f64>() / 12.0;
        // Even to a fifth: the table has seven entries and is joined by straight lines.
        assert!(
            mean > 5.0 && steps.iter().all(|step| (step / mean - 1.0).abs() < 0.25),
            "{steps:?}"
        );
    }

    #[test]
    fn words_of_series_are_dark_enough_to_be_read_on_white() {
        for colour in SERIES_INK {
            let channel = |at: usize| u8::from_str_radix(&colour[at..at + 2], 16).unwrap();
            let lightness = lightness([1, 3, 5].map(channel));
            // A contrast of 4.5 to white, as WCAG 2 has it.
            assert!(lightness < 49.9, "{colour}: {lightness}");
        }
    }

    #[test]
    fn a_stored_value_survives_the_way_to_light_and_back() {
        for value in 0..=255 {
            assert_eq!(to_stored(to_linear(f64::from(value) / 255.0)), value);
        }
    }

    #[test]
    fn fractions_outside_the_range_get_its_ends() {
        assert_eq!(sequential(-1.0), SEQUENCE[0]);
        assert_eq!(sequential(7.0), SEQUENCE[6]);
        assert_eq!(sequential(f64::NAN), SEQUENCE[0]);
    }
}
