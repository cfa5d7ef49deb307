//! A camera's scan of the face as skin over the bone of a CT: brought onto the skin that the CT shows, and refused where it does
//! not fit there.
//!
//! The registration is that of comparisons ([`IterativeClosestPoint`], robust against what differs), from landmarks or from where
//! the surfaces lie. What is left is measured from points spread over the scan to the skin of the CT, where this was in the field
//! of view. Two takes of one face, lying and upright, differ by 1 mm or so in the mean, faces of two people by more than twice as much.

use super::AnatomyError;
use super::skin_scan_error::{MOST_MEDIAN, OUTLIER_MM, SkinScanError};
use crate::domain::{ImageDomain, ImageOptions};
use crate::image::ImageVolume;
use crate::mesh::area_sampling::{self, AreaSample};
use crate::mesh::{ClosestPoint, SurfaceSearch, TriangleSurface, Vector, Warning};
use crate::osteotomy::bone_image::BoneImage;
use crate::osteotomy::label_surface::label_surface;
use crate::osteotomy::labelling::label_given;
use crate::osteotomy::{Osteotomy, SegmentRule};
use crate::progress::Progress;
use crate::registration::mirror::check_mirror;
use crate::registration::{
    AlignmentError, IterativeClosestPoint, RigidTransform, SphereOrBox, Start, align_points,
};

/// Points of the scan at which is measured what is left.
const POINTS: usize = 20_000;
/// More of the scan than this, as a share, may not lie farther away.
const MOST_OUTLIERS: f64 = 0.25;
/// A lower face is more than this, in mm²: 40 cm².
const LEAST_AREA: f64 = 4000.0;
/// Outliers are told from this share on.
const TELL: f64 = 0.05;
/// How far the scan may lie from the skin of the CT and still take its place, in mm; a jaw that is closed adds its way.
pub const REACH_MM: f64 = 10.0;
/// Within so much of the border of the scan both skins go over into each other, in mm.
pub const BLEND_MM: f64 = 10.0;
/// Voxels of the skin that a scan is brought onto: enough for half a mm.
const MOST_VOXELS: usize = 1 << 22;

/// Where the registration starts, and what decides it. Lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinScanRules {
    /// The same place on the scan and in the CT; none, or three and more.
    pub landmarks: Vec<[Vector; 2]>,
    /// Only the skin of the CT in it decides.
    pub mask: Option<SphereOrBox>,
}

/// A scan where it lies in the CT, and how well it fits.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedScan {
    pub surface: TriangleSurface,
    /// Of the scan into the frame of the CT.
    pub transform: RigidTransform,
    pub iterations: usize,
    pub left: ScanDeviation,
    /// Whether its triangles faced into the head, and were turned.
    pub was_inside_out: bool,
}

/// Distances from the scan to the skin of the CT, in mm, and areas in mm².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanDeviation {
    pub mean: f64,
    pub median: f64,
    pub p95: f64,
    /// The share farther away than [`OUTLIER_MM`], 0 to 1.
    pub outliers: f64,
    /// Of the scan within the field of view of the CT and within the mask: what was measured.
    pub area: f64,
    /// Of all of the scan.
    pub whole: f64,
}

/// The outer skin that a CT shows, a closed surface: where the image ends it is flat.
pub fn skin_of(
    image: &ImageVolume,
    options: &ImageOptions,
) -> Result<TriangleSurface, AnatomyError> {
    let small = crate::image::reduction::reduced(image, MOST_VOXELS);
    let small = small.map_err(crate::domain::ImageDomainError::from)?;
    let head = ImageDomain::head(&small, options)?;
    let name = SegmentRule { name: "head".to_owned(), ..SegmentRule::default() };
    let whole = Osteotomy::new(Vec::new(), vec![name]).map_err(SkinScanError::from)?;
    let head = BoneImage { image: &head, threshold: 0.0 };
    let labelled = label_given(&head, &whole, |_| Some(0))?;
    Ok(label_surface(&head, &whole, &labelled.labels, 0))
}

/// Brings a scan onto the skin of a CT.
pub fn fit(
    scan: &TriangleSurface,
    image: &ImageVolume,
    (options, rules): (&ImageOptions, &SkinScanRules),
    progress: &dyn Progress,
) -> Result<FittedScan, AnatomyError> {
    let whole = scan.area();
    if whole < LEAST_AREA {
        let [covered_cm2, whole_cm2] = [whole, whole].map(|mm2| mm2 / 100.0);
        return Err(SkinScanError::Small { covered_cm2, whole_cm2 }.into());
    }
    let skin = skin_of(image, options)?;
    let found = register(scan, &skin, rules, progress)?;
    let mut surface = scan.clone();
    surface.points.iter_mut().for_each(|point| *point = found.0.apply(point));
    let search = SurfaceSearch::new(&skin).map_err(AlignmentError::from);
    let search = search.map_err(SkinScanError::from)?;
    let samples = area_sampling::equal_areas(&surface, POINTS);
    let on_skin: Vec<ClosestPoint> = samples.iter().map(|x| search.closest(&x.point)).collect();
    let counts = |point: &Vector| {
        image.at(point).is_some() && rules.mask.as_ref().is_none_or(|mask| mask.holds(point))
    };
    let pairs = samples.iter().zip(&on_skin);
    let inside = pairs.clone().filter(|(sample, _)| counts(&sample.point));
    let left = measure(inside.map(|(_, closest)| closest.distance).collect(), samples.len(), whole);
    refuse(&left, rules.mask.is_some())?;
    // Most of a scan faces along the skin of the CT that is nearest to it.
    let along = |(sample, closest): (&AreaSample, &ClosestPoint)| {
        let normal = surface.area_vector(sample.triangle as usize).try_normalize(0.0);
        normal.unwrap_or_default().dot(&search.pseudo_normal(closest))
    };
    let near = pairs.filter(|(_, closest)| closest.distance <= OUTLIER_MM);
    let was_inside_out = near.map(along).sum::<f64>() < 0.0;
    if was_inside_out {
        surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    Ok(FittedScan { surface, transform: found.0, iterations: found.1, left, was_inside_out })
}

/// The movement of the scan, and after how many iterations it was found.
fn register(
    scan: &TriangleSurface,
    skin: &TriangleSurface,
    rules: &SkinScanRules,
    progress: &dyn Progress,
) -> Result<(RigidTransform, usize), SkinScanError> {
    let start = match rules.landmarks.is_empty() {
        true => Start::AsItLies,
        false => {
            let (from, to): (Vec<Vector>, Vec<Vector>) =
                rules.landmarks.iter().map(|&[scan, ct]| (scan, ct)).unzip();
            Start::Known(align_points(&from, &to)?.transform)
        }
    };
    let mask = rules.mask;
    let method = IterativeClosestPoint { mask, start, ..IterativeClosestPoint::default() };
    let found = method.align(skin, scan, progress).map_err(|error| match error {
        AlignmentError::EmptyMask => {
            let (low, high) = skin.bounds();
            SkinScanError::EmptyMask { low, high }
        }
        other => other.into(),
    })?;
    let mirror = check_mirror(skin, scan, mask.as_ref(), &found.transform)?;
    match mirror.looks_mirrored() {
        true => {
            let (plain, mirrored) = (mirror.rms, mirror.mirrored_rms);
            Err(SkinScanError::Mirrored { plain, mirrored })
        }
        false => Ok((found.transform, found.iterations)),
    }
}

/// Of the distances of those of all samples of equal area that count.
fn measure(mut distances: Vec<f64>, samples: usize, whole: f64) -> ScanDeviation {
    distances.sort_unstable_by(f64::total_cmp);
    let area = whole * distances.len() as f64 / samples.max(1) as f64;
    let count = distances.len().max(1) as f64;
    let at = |share: f64| distances.get((share * count) as usize).copied().unwrap_or(f64::INFINITY);
    ScanDeviation {
        mean: distances.iter().sum::<f64>() / count,
        median: at(0.5),
        p95: at(0.95),
        outliers: distances.iter().filter(|&&far| far > OUTLIER_MM).count() as f64 / count,
        area,
        whole,
    }
}

fn refuse(left: &ScanDeviation, has_mask: bool) -> Result<(), SkinScanError> {
    let [covered_cm2, whole_cm2] =
        [left.area * (1.0 - left.outliers), left.whole].map(|mm2| mm2 / 100.0);
    let small = || match has_mask {
        true => SkinScanError::SmallMask { covered_cm2, whole_cm2 },
        false => SkinScanError::Small { covered_cm2, whole_cm2 },
    };
    if left.area < LEAST_AREA {
        return Err(small());
    }
    if left.median > MOST_MEDIAN || left.outliers > MOST_OUTLIERS {
        let (median, percent) = (left.median, 100.0 * left.outliers);
        return Err(SkinScanError::Misfit { median, percent });
    }
    match left.area * (1.0 - left.outliers) < LEAST_AREA {
        true => Err(small()),
        false => Ok(()),
    }
}

/// What is to be told of a scan that fits: parts that do not, and bone that it leaves outside, in mm³.
pub fn told(found: &FittedScan, bone_outside: f64) -> Vec<Warning> {
    let left = &found.left;
    let percent = 100.0 * left.outliers;
    let apart = (left.outliers > TELL).then(|| {
        let detail = format!(
            "{percent:.0} % of the surface scan lies more than {OUTLIER_MM} mm from the skin of the CT (mean {:.2}, 95 % within \
             {:.2} mm): another expression, an open mouth, hair, or a scan of another time",
            left.mean, left.p95
        );
        let warning = Warning::new("skin-scan-apart", detail);
        warning.with("share", left.outliers).with("p95_mm", left.p95)
    });
    let ml = bone_outside / 1000.0;
    let bare = (ml > 0.1).then(|| {
        let detail = format!(
            "{ml:.1} ml of bone lie outside the surface scan, and have no tissue over them there"
        );
        Warning::new("bone-outside-skin", detail).with("volume_ml", ml)
    });
    let turned = found.was_inside_out.then(|| {
        let all = found.surface.triangles.len();
        let detail =
            format!("{all} triangles of the surface scan faced into the head, and were turned");
        Warning::new("surface-turned", detail).with("count", all as f64)
    });
    turned.into_iter().chain(apart).chain(bare).collect()
}
