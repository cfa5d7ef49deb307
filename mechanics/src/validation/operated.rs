//! Plausibility of skins measured after operations whose points correspond to those of a prediction: whether one lies
//! elsewhere, is a mirror image, of before the operation or of another case; and whether a skin at rest is like others.

use super::suspicion::{MOVED, SKIN_MEDIAN, told_before_operation};
use crate::mesh::{Vector, Warning};
use crate::registration::mirror::MirrorCheck;
use crate::registration::{PointAlignment, RigidTransform, align_points};

/// A rigid movement explains what it makes so much smaller.
const EXPLAINED: f64 = 0.5;

/// In mm: predictions nearer than this to what was measured are of the case, whatever other cases are like.
const NEAR: f64 = 0.5;

/// In mm: skin that a plan moves less lies where it lay, if it is this share of all.
const STILL: f64 = 0.1;
const STILL_SHARE: f64 = 0.1;

/// In degrees: heads in one frame are not turned so far from each other.
const TURNED: f64 = 45.0;

/// The larger of two heads over the smaller.
const LARGER: f64 = 1.25;

/// The skin of a case, its points in one order and frame, in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OperatedSkin {
    pub at_rest: Vec<Vector>,
    pub predicted: Vec<Vector>,
    /// Measured after the operation.
    pub actual: Vec<Vector>,
    /// How far the bone goes that goes farthest.
    pub bone_movement: f64,
}

/// What speaks against the measured skin of a case among several, whose places are those of the slice.
pub fn suspicions(place: usize, skins: &[OperatedSkin]) -> Vec<Warning> {
    let Some(own) = skins.get(place) else { return Vec::new() };
    let before = own.before_operation();
    // What lies on the skin at rest is registered.
    let elsewhere = if before.is_none() { own.elsewhere() } else { None };
    let other = if before.is_none() { of_another(place, skins) } else { None };
    [before, elsewhere, own.mirrored(), other].into_iter().flatten().collect()
}

impl OperatedSkin {
    fn before_operation(&self) -> Option<Warning> {
        let points = self.at_rest.iter().zip(&self.predicted).zip(&self.actual);
        let moving = points.filter(|((rest, predicted), _)| (*predicted - *rest).norm() > MOVED);
        let [mut before, mut after, mut count] = [0.0; 3];
        for ((rest, predicted), actual) in moving {
            before += (actual - rest).norm_squared();
            after += (actual - predicted).norm_squared();
            count += 1.0;
        }
        let rms = |sum: f64| (sum / count).sqrt();
        if count > 0.0 { told_before_operation(rms(before), rms(after)) } else { None }
    }

    /// How far the skin or the bone goes that goes farthest.
    fn largest_movement(&self) -> f64 {
        let skin = self.at_rest.iter().zip(&self.predicted).map(|(a, b)| (a - b).norm());
        skin.fold(self.bone_movement, f64::max)
    }

    /// Root of the mean squared distance from the prediction of what was measured of skin that hardly moves, as it lies and once it is moved;
    /// zeros where that is less than a tenth of the skin.
    fn at_rest_off(&self, moved: &RigidTransform) -> [f64; 2] {
        let rest = self.at_rest.iter().zip(&self.predicted).zip(&self.actual);
        let still = rest.filter(|((rest, predicted), _)| (*predicted - *rest).norm() < STILL);
        let [mut as_it_lies, mut once_moved, mut count] = [0.0; 3];
        for ((_, predicted), actual) in still {
            as_it_lies += (actual - predicted).norm_squared();
            once_moved += (moved.apply(actual) - predicted).norm_squared();
            count += 1.0;
        }
        let is_enough = count >= STILL_SHARE * self.actual.len() as f64;
        [as_it_lies, once_moved].map(|sum| if is_enough { (sum / count).sqrt() } else { 0.0 })
    }

    /// A warning where what was measured is farther from the prediction than anything moves, or a rigid movement brings it there.
    fn elsewhere(&self) -> Option<Warning> {
        let apart = || self.actual.iter().zip(&self.predicted).map(|(a, b)| (a - b).norm());
        let count = self.actual.len().max(1) as f64;
        let mean = apart().sum::<f64>() / count;
        let rms = (apart().map(|own| own * own).sum::<f64>() / count).sqrt();
        let found = align_points(&self.actual, &self.predicted).ok();
        let left = found.as_ref().map_or(rms, |found| found.rms);
        let [still, still_left] =
            found.map_or([0.0; 2], |found| self.at_rest_off(&found.transform));
        let largest = self.largest_movement();
        let is_far = mean > largest.max(NEAR);
        let is_rigid = left < EXPLAINED * rms && rms - left > SKIN_MEDIAN;
        let is_still_off = still_left < EXPLAINED * still && still - still_left > NEAR;
        let detail = format!(
            "the skin measured after the operation is {mean:.2} mm from the prediction in the mean, where the plan moves nothing by more than {largest:.2} mm, and {left:.2} mm (rms) once it is moved rigidly onto it: is it of this patient, in the frame and unit of the case, and registered onto it (`matrix4x4`)?"
        );
        let warning = Warning::new("unregistered-suspect", detail)
            .with("mean_error_mm", mean)
            .with("largest_movement_mm", largest)
            .with("rms_mm", rms)
            .with("rms_aligned_mm", left);
        (is_far || is_rigid || is_still_off).then_some(warning)
    }

    fn mirrored(&self) -> Option<Warning> {
        let PointAlignment { rms, mirrored_rms, .. } =
            align_points(&self.actual, &self.predicted).ok()?;
        let detail = format!(
            "a mirror image of the measured skin fits the prediction to {mirrored_rms:.2} mm, itself only to {rms:.2} mm: left and right are swapped"
        );
        let warning = Warning::new("mirrored?", detail)
            .with("rms_mm", rms)
            .with("mirrored_rms_mm", mirrored_rms);
        MirrorCheck { rms, mirrored_rms }.looks_mirrored().then_some(warning)
    }
}

/// A warning where the prediction of another case has the shape of what was measured, and the own one has not.
fn of_another(place: usize, skins: &[OperatedSkin]) -> Option<Warning> {
    let own = &skins[place];
    let left = |other: &OperatedSkin| Some(align_points(&own.actual, &other.predicted).ok()?.rms);
    let rms = left(own).filter(|rms| *rms > NEAR)?;
    let others = skins.iter().enumerate().filter(|(other, _)| *other != place);
    let others = others.filter_map(|(other, skin)| Some((other, left(skin)?)));
    let (other, least) = others.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let detail = format!(
        "the skin measured after the operation has the shape of the prediction of case {} (from 1) of those learned from, {least:.2} mm (rms), and not of its own, {rms:.2} mm: are the scans of two patients swapped?",
        other + 1
    );
    let warning = Warning::new("another-person-suspect", detail)
        .with("rms_mm", rms)
        .with("other_rms_mm", least)
        .with("other_case", (other + 1) as f64);
    (least < EXPLAINED * rms).then_some(warning)
}

/// A warning where a skin at rest is turned from those of all other cases, whose points correspond, or much larger or smaller.
pub fn unlike_skins(own: &[Vector], others: &[&[Vector]]) -> Option<Warning> {
    let mut nearest: Option<(f64, f64)> = None;
    for other in others {
        // Points on a line say nothing of turning.
        let found = align_points(other, own).ok()?;
        let (turned, ratio) = (found.transform.angle().to_degrees(), extent(own) / extent(other));
        if turned < TURNED && (1.0 / LARGER..LARGER).contains(&ratio) {
            return None;
        }
        if nearest.is_none_or(|(least, _)| turned < least) {
            nearest = Some((turned, ratio));
        }
    }
    let (turned, ratio) = nearest?;
    let detail = format!(
        "the skin of the case at rest is turned by {turned:.0} degrees from the nearest that was learned from, and {ratio:.2} times as large: movements and what mechanics misses have other directions or lengths there; is its mesh in the frame and unit of the others?"
    );
    let warning = Warning::new("skin-unlike-learned", detail);
    Some(warning.with("turned_deg", turned).with("times_as_large", ratio))
}

/// Root of the mean squared distance of points from their middle.
fn extent(points: &[Vector]) -> f64 {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector>() / count;
    (points.iter().map(|point| (point - middle).norm_squared()).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    /// A bent sheet of 8 by 8 points, 70 mm wide, of a shape of its own.
    fn sheet(number: usize) -> Vec<Vector> {
        let point = |place: usize| {
            let (x, y) = ((place % 8) as f64 * 10.0, (place / 8) as f64 * 10.0);
            let wave = (0.05 * number as f64 * x).sin() + 0.002 * x * x - 0.03 * y;
            Vector::new(x, y * (1.0 + 0.1 * number as f64), 5.0 * wave)
        };
        (0..64).map(point).collect()
    }

    /// Moved by up to 4 mm, of which mechanics misses a quarter.
    fn operated(number: usize) -> OperatedSkin {
        let at_rest = sheet(number);
        let moved = |share: f64| -> Vec<Vector> {
            let of = |point: &Vector| point + Vector::new(0.0, 0.0, 4.0 * share * point.x / 70.0);
            at_rest.iter().map(of).collect()
        };
        OperatedSkin { predicted: moved(0.75), actual: moved(1.0), at_rest, bone_movement: 4.0 }
    }

    fn codes(change: impl Fn(&mut OperatedSkin)) -> Vec<&'static str> {
        let mut skins: Vec<OperatedSkin> = (0..3).map(operated).collect();
        change(&mut skins[1]);
        suspicions(1, &skins).iter().map(|warning| warning.code).collect()
    }

    #[test]
    fn what_was_measured_of_the_patient_after_the_operation_is_not_suspected() {
        assert!(codes(|_| ()).is_empty());
    }

    #[test]
    fn skins_of_before_of_another_frame_unit_side_or_patient_are_suspected() {
        assert_eq!(codes(|own| own.actual = own.at_rest.clone()), ["before-operation-suspect"]);
        let far = |own: &mut OperatedSkin| own.actual.iter_mut().for_each(|p| p.x += 60.0);
        assert_eq!(codes(far), ["unregistered-suspect"]);
        let near = |own: &mut OperatedSkin| own.actual.iter_mut().for_each(|p| p.y += 0.9);
        assert_eq!(codes(near), ["unregistered-suspect"]);
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), 0.17);
        let turned = |own: &mut OperatedSkin| own.actual.iter_mut().for_each(|p| *p = turn * *p);
        assert_eq!(codes(turned), ["unregistered-suspect"]);
        let metres = |own: &mut OperatedSkin| own.actual.iter_mut().for_each(|p| *p *= 1e-3);
        assert!(codes(metres).contains(&"unregistered-suspect"));
        let mirrored = |own: &mut OperatedSkin| own.actual.iter_mut().for_each(|p| p.x = -p.x);
        assert!(codes(mirrored).contains(&"mirrored?"));
        assert!(codes(|own| own.actual = operated(2).actual).contains(&"another-person-suspect"));
    }

    #[test]
    fn a_skin_is_unlike_others_where_it_is_turned_or_of_another_size() {
        let (own, other) = (sheet(0), sheet(1));
        assert_eq!(unlike_skins(&own, &[&other]), None);
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), std::f64::consts::FRAC_PI_2);
        let turned: Vec<Vector> = own.iter().map(|point| turn * point).collect();
        let told = unlike_skins(&turned, &[&other]).unwrap();
        assert!((told.numbers[0].1 - 90.0).abs() < 5.0, "{told:?}");
        let larger: Vec<Vector> = own.iter().map(|point| point * 1.5).collect();
        assert!(unlike_skins(&larger, &[&other]).is_some());
        // One of them that is as large is enough.
        assert_eq!(unlike_skins(&larger, &[&other, &larger]), None);
        assert_eq!(unlike_skins(&own, &[]), None);
    }
}
