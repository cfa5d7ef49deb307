//! Thresholds of a CT from its histogram: between air and skin, between soft tissue and bone.
//!
//! Between two modes the threshold is that of Otsu (1979), which puts it half-way between the means of both sides: on
//! coarse voxels, that is where the surface between two tissues passes (partial volume).

use super::volume::{ImageVolume, Voxels};

/// Width of a bin, in Hounsfield units.
const BIN: f64 = 10.0;
pub(super) const LOWEST: f64 = -1100.0;
const BINS: usize = 420;

/// Where the modes of air and soft tissue are looked for.
const AIR: [f64; 2] = [-1100.0, -800.0];
const SOFT: [f64; 2] = [0.0, 120.0];
/// Tissue begins here, with fat.
const FAT: f64 = -150.0;
/// Thin and spongy bone, which the threshold has to take, ends here; whatever is denser is bone in any case.
const BONE_END: f64 = 700.0;
/// Noise and vessels reach so far above the mode of soft tissue.
const ABOVE_SOFT: f64 = 150.0;

/// How often values of an image lie in each bin of 10 HU from -1100 HU; values above the last bin are counted in it, those below the first are padding
/// and not counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    counts: Vec<u64>,
}

/// Modes and thresholds of a CT of a head, in Hounsfield units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    pub air_mode: f64,
    pub soft_mode: f64,
    /// Between air and skin.
    pub skin: f64,
    /// Between soft tissue and bone.
    pub bone: f64,
}

impl Histogram {
    pub fn of(image: &ImageVolume) -> Histogram {
        let mut counts = vec![0; BINS];
        let mut count = |value: f64| {
            if value >= LOWEST {
                let bin = ((value - LOWEST) / BIN).floor().min((BINS - 1) as f64);
                counts[bin as usize] += 1;
            }
        };
        match image.voxels() {
            Voxels::I16(values) => values.iter().for_each(|&value| count(f64::from(value))),
            Voxels::F32(values) => values.iter().for_each(|&value| count(f64::from(value))),
        }
        Histogram { counts }
    }

    /// The middle of a bin.
    fn value(bin: usize) -> f64 {
        LOWEST + (bin as f64 + 0.5) * BIN
    }

    fn bins([from, to]: [f64; 2]) -> std::ops::Range<usize> {
        let bin = |value: f64| ((value - LOWEST) / BIN).round().clamp(0.0, BINS as f64) as usize;
        bin(from)..bin(to)
    }

    /// The middle of the fullest bin of a range; `None` where nothing lies in it.
    pub fn mode(&self, range: [f64; 2]) -> Option<f64> {
        let bins = Self::bins(range);
        let most = bins.clone().max_by_key(|&bin| (self.counts[bin], std::cmp::Reverse(bin)))?;
        (self.counts[most] > 0).then(|| Self::value(most))
    }

    /// The value of a range that parts it into two classes whose means differ most (Otsu 1979).
    pub fn otsu(&self, range: [f64; 2]) -> Option<f64> {
        let bins = Self::bins(range);
        let sum = |bins: std::ops::Range<usize>| {
            bins.fold((0.0, 0.0), |(count, sum), bin| {
                let n = self.counts[bin] as f64;
                (count + n, sum + n * Self::value(bin))
            })
        };
        let (all, total) = sum(bins.clone());
        let (mut below, mut sum_below) = (0.0, 0.0);
        let variances: Vec<f64> = bins
            .clone()
            .map(|bin| {
                below += self.counts[bin] as f64;
                sum_below += self.counts[bin] as f64 * Self::value(bin);
                let above = all - below;
                let apart = sum_below / below - (total - sum_below) / above;
                if below == 0.0 || above == 0.0 { 0.0 } else { below * above * apart * apart }
            })
            .collect();
        let most = variances.iter().copied().fold(0.0, f64::max);
        // Empty bins leave it as it is: the middle of them is taken.
        let is_most = |variance: &f64| *variance > 0.0 && *variance >= most * (1.0 - 1e-12);
        let first = variances.iter().position(is_most)?;
        let last = variances.iter().rposition(is_most)?;
        let middle = bins.start as f64 + (first + last) as f64 / 2.0;
        Some(LOWEST + (middle + 1.0) * BIN)
    }
}

impl Thresholds {
    /// `None` where there is no air or no soft tissue in the image, and where what parts them lies in tissue: values without slope
    /// and intercept have padding in the place of air and air in that of tissue.
    pub fn of(histogram: &Histogram) -> Option<Thresholds> {
        let air_mode = histogram.mode(AIR)?;
        let soft_mode = histogram.mode(SOFT)?;
        // Values of two kinds alone have nothing between their modes.
        let between = f64::midpoint(air_mode, soft_mode);
        let skin = histogram.otsu([air_mode, soft_mode]).unwrap_or(between);
        let bone = histogram.otsu([soft_mode, BONE_END]).unwrap_or(soft_mode);
        let bone = bone.max(soft_mode + ABOVE_SOFT);
        if skin >= FAT {
            return None;
        }
        Some(Thresholds { air_mode, soft_mode, skin, bone })
    }
}
