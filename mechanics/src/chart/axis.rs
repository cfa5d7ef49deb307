//! Logarithmic axes: every power of ten has the same length.

/// A range of positive numbers on a stretch of the picture.
#[derive(Clone, Copy, Debug)]
pub struct LogAxis {
    /// The numbers at the ends.
    pub low: f64,
    pub high: f64,
    /// Where the ends are drawn.
    pub from: f64,
    pub to: f64,
}

/// A place of an axis that is marked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    /// Whether it is labelled; the others are fine lines.
    pub labelled: bool,
}

/// Powers of ten below which 2 and 5 are labelled as well.
const FEW_DECADES: f64 = 1.7;

/// How far a range goes beyond its values, and its ends at least from each other.
const AIR: f64 = 1.5;
const LEAST_RATIO: f64 = 10.0;

impl LogAxis {
    /// A range that holds all values with some air, at least a power of ten, drawn between two places; without values it is
    /// around 1. Values that are not positive and finite count as the nearer end of what can be drawn.
    pub fn covering(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let (low, high) = values
            .map(drawable)
            .fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low <= high { (low, high) } else { (1.0, 1.0) };
        let air = f64::max(AIR, (LEAST_RATIO * low / high).sqrt());
        LogAxis { low: low / air, high: high * air, from: ends[0], to: ends[1] }
    }

    /// Where a value is drawn; values outside the range at the nearer end.
    pub fn place(&self, value: f64) -> f64 {
        let share = (drawable(value) / self.low).ln() / (self.high / self.low).ln();
        self.from + (self.to - self.from) * share.clamp(0.0, 1.0)
    }

    /// Whole multiples of powers of ten inside the range, ascending.
    pub fn ticks(&self) -> Vec<Tick> {
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().floor() as i32;
        let is_short = (self.high / self.low).log10() < FEW_DECADES;
        let mut ticks = Vec::new();
        for power in first..=last {
            for digit in 1..=9 {
                // A quotient of whole numbers is the double nearest to the decimal: 0.003 and no 0.0030000000000000005.
                let scale = 10f64.powi(power.abs());
                let digits = f64::from(digit);
                let value = if power < 0 { digits / scale } else { digits * scale };
                let labelled = digit == 1 || (is_short && (digit == 2 || digit == 5));
                if (self.low..=self.high).contains(&value) {
                    ticks.push(Tick { value, labelled });
                }
            }
        }
        ticks
    }
}

/// The nearest number that has a place on a logarithmic axis.
fn drawable(value: f64) -> f64 {
    if value.is_nan() { MOST } else { value.clamp(LEAST, MOST) }
}

const LEAST: f64 = 1e-6;
const MOST: f64 = 1e6;

/// A mark in words.
pub(super) fn numbers([wall_s, error_mm]: [f64; 2]) -> String {
    format!("{}, p95 error {error_mm:.3} mm", duration(rounded(wall_s)))
}

/// Two significant digits.
fn rounded(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10f64.powf(value.log10().floor() - 1.0);
    (value / unit).round() * unit
}

/// A time in the unit that it is spoken of in.
pub(super) fn duration(seconds: f64) -> String {
    let neat = |value: f64| format!("{}", (value * 1e6).round() / 1e6);
    match seconds {
        s if s < 0.001 => format!("{} µs", neat(s * 1e6)),
        s if s < 1.0 => format!("{} ms", neat(s * 1e3)),
        s => format!("{} s", neat(s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_power_of_ten_is_as_long_as_the_others() {
        let axis = LogAxis { low: 0.01, high: 10.0, from: 100.0, to: 400.0 };
        for (value, place) in [(0.01, 100.0), (0.1, 200.0), (1.0, 300.0), (10.0, 400.0)] {
            assert!((axis.place(value) - place).abs() < 1e-9);
        }
        let labelled: Vec<f64> =
            axis.ticks().iter().filter(|tick| tick.labelled).map(|tick| tick.value).collect();
        assert_eq!(labelled, [0.01, 0.1, 1.0, 10.0]);
        assert_eq!(axis.ticks().len(), 28);
    }

    #[test]
    fn a_short_range_has_more_labels_and_odd_values_have_a_place() {
        let axis = LogAxis::covering([0.3, 2.0].into_iter(), [0.0, 100.0]);
        let labelled: Vec<f64> =
            axis.ticks().iter().filter(|tick| tick.labelled).map(|tick| tick.value).collect();
        assert_eq!(labelled, [0.2, 0.5, 1.0, 2.0]);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
            assert!((0.0..=100.0).contains(&axis.place(value)), "{value}");
        }
        let one = LogAxis::covering([0.3].into_iter(), [0.0, 100.0]);
        assert!((one.high / one.low - 10.0).abs() < 1e-9 && (one.place(0.3) - 50.0).abs() < 1e-9);
        let empty = LogAxis::covering(std::iter::empty(), [0.0, 100.0]);
        assert!(empty.place(0.7).is_finite() && empty.low > 0.0 && empty.high.is_finite());
    }
}
