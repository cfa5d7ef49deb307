//! Scales with round numbers.

use super::colour::INK;
use super::drawing::{Document, Rectangle, Style};

/// Ticks at 1, 2 or 5 times a power of ten, from 0 to the first one at or above the maximum.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    pub ticks: Vec<f64>,
    decimals: usize,
}

/// At most so many steps between 0 and the maximum.
const MOST_STEPS: f64 = 6.0;

impl Scale {
    /// A scale that covers [0, maximum]; of nothing, or nothing finite, it covers [0, 1].
    pub fn covering(maximum: f64) -> Self {
        let maximum = if maximum.is_finite() && maximum > 1e-9 { maximum } else { 1.0 };
        let power = (maximum / MOST_STEPS).log10().floor();
        let step = [1.0, 2.0, 5.0, 10.0, 20.0]
            .into_iter()
            .map(|multiple| multiple * 10f64.powf(power))
            .find(|step| maximum / step <= MOST_STEPS * (1.0 + 1e-9))
            .unwrap_or(maximum);
        let decimals = (-(step * (1.0 + 1e-9)).log10().floor()).max(0.0) as usize;
        let steps = (maximum / step - 1e-9).ceil() as usize;
        let round = |value: f64| {
            let unit = 10f64.powi(decimals as i32);
            (value * unit).round() / unit
        };
        Scale { ticks: (0..=steps).map(|tick| round(tick as f64 * step)).collect(), decimals }
    }

    pub fn maximum(&self) -> f64 {
        self.ticks.last().copied().unwrap_or(1.0)
    }

    /// A tick with as many decimals as all of them need.
    pub fn label(&self, tick: f64) -> String {
        format!("{tick:.*}", self.decimals)
    }
}

/// The largest round length (1, 2 or 5 times a power of ten) of at most `room`.
fn round_length(room: f64) -> f64 {
    let power = 10f64.powf(room.max(1e-9).log10().floor());
    [5.0, 2.0, 1.0]
        .into_iter()
        .map(|multiple| multiple * power)
        .find(|&length| length <= room)
        .unwrap_or(power)
}

/// A bar of a round length at the right of a strip over a panel, with its length beside it.
pub fn write_scale_bar(document: &mut Document, strip: Rectangle, units_per_millimetre: f64) {
    let length = round_length(strip.width / 4.0 / units_per_millimetre);
    let (right, y) = (strip.x + strip.width - 12.0, strip.y + strip.height / 2.0 + 3.0);
    let left = right - length * units_per_millimetre;
    document.stroke(&[[left, y - 4.0], [left, y], [right, y], [right, y - 4.0]], INK, 1.2);
    let style = Style::of(12.0).faint().end();
    document.text([left - 6.0, y + 3.0], strip.width / 4.0, style, &format!("{length} mm"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_cover_the_range() {
        for maximum in [0.013, 0.5, 0.93, 1.0, 4.749, 6.0, 6.32, 9.99, 26.0, 1234.0] {
            let scale = Scale::covering(maximum);
            let step = scale.ticks[1];
            let mantissa = step / 10f64.powf((step * 1.000_001).log10().floor());
            assert!([1.0, 2.0, 5.0].iter().any(|m| (m - mantissa).abs() < 1e-6), "{step}");
            assert!(scale.ticks[0] == 0.0 && scale.maximum() >= maximum * (1.0 - 1e-9));
            assert!(scale.maximum() - step < maximum, "no more ticks than needed");
            assert!((3..=7).contains(&scale.ticks.len()), "{:?}", scale.ticks);
            for &tick in &scale.ticks {
                assert_eq!(scale.label(tick).parse::<f64>(), Ok(tick));
            }
        }
    }

    #[test]
    fn nothing_to_measure_gives_a_scale_of_one() {
        for nothing in [0.0, f64::NAN, f64::INFINITY, -3.0] {
            assert_eq!(Scale::covering(nothing).maximum(), 1.0);
        }
    }

    #[test]
    fn a_round_length_fits_its_room() {
        assert_eq!([7.0, 49.9, 50.0, 0.3].map(round_length), [5.0, 20.0, 50.0, 0.2]);
    }
}
