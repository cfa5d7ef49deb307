//! Landmarks: points of the template whose place on the patient is known, and whether they can be pairs.

use super::affine::Affine;
use super::error::ConformationError;
use crate::mesh::{Vector, VolumeMesh, bounds_of};
use crate::registration::{PointAlignment, align_points};

/// What a similarity may leave of landmarks, as a share of their spread: two faces of the shared data leave 0.1.
const MOST_LEFT: f64 = 0.3;

/// Beyond this share more than a pair of them is wrong.
const NO_PAIRS: f64 = 0.6;

/// Sides are swapped when a mirror image leaves less than this share.
const MIRRORED: f64 = 0.5;

/// Landmarks whose mirror image leaves at most this share of their spread more lie in one plane.
const PLANAR: f64 = 0.01;

/// Two landmarks are exchanged when that leaves less than this share of what they are apart.
const EXCHANGED: f64 = 0.5;

/// An exchange puts each of the two nearer to where it belongs, by this share at least of what it was left.
const EACH_EXCHANGED: f64 = 0.75;

/// Landmarks left by at least this share of what a misplaced one is may be misplaced with it; so many of them are named.
const WITH_IT: f64 = 0.5;
const MOST_NAMED: usize = 8;

/// So many triples of landmarks are tried for one that most agree with.
const MOST_TRIPLES: usize = 2048;

/// In mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    pub name: String,
    pub template: Vector,
    pub patient: Vector,
}

/// Three determine a similarity.
pub(super) const FEWEST: usize = 3;

/// The similarity of least squares between landmarks, if they can be pairs.
pub(super) fn similarity(landmarks: &[Landmark]) -> Result<Affine, ConformationError> {
    if landmarks.len() < FEWEST {
        let needed = FEWEST;
        return Err(ConformationError::FewLandmarks { landmarks: landmarks.len(), needed });
    }
    let from: Vec<Vector> = landmarks.iter().map(|landmark| landmark.template).collect();
    let to: Vec<Vector> = landmarks.iter().map(|landmark| landmark.patient).collect();
    let Fitted { map, aligned, scale, spread } = fitted(&from, &to)?;
    refuse_scale(scale)?;
    refuse_mirrored(&aligned, spread)?;
    if aligned.rms <= NO_PAIRS * spread {
        refuse_exchanges(landmarks, &map)?;
    }
    if aligned.rms > MOST_LEFT * spread {
        refuse_permuted(landmarks, aligned.rms, spread)?;
    }
    refuse_misfitting(landmarks, &map, aligned.rms, spread)?;
    Ok(map)
}

/// A similarity of least squares, and what it leaves.
struct Fitted {
    map: Affine,
    aligned: PointAlignment,
    scale: f64,
    /// Of the second points, in mm.
    spread: f64,
}

fn fitted(from: &[Vector], to: &[Vector]) -> Result<Fitted, ConformationError> {
    let [(from_middle, from_size), (to_middle, spread)] = [from, to].map(spread);
    let scale = spread / from_size;
    let scaled: Vec<Vector> = from.iter().map(|x| (x - from_middle) * scale).collect();
    let aligned = align_points(&scaled, to).map_err(ConformationError::Landmarks)?;
    let matrix = aligned.transform.rotation * scale;
    let map = Affine { matrix, shift: to_middle - matrix * from_middle };
    Ok(Fitted { map, aligned, scale, spread })
}

/// Names landmarks that are where others are said to be, however far they spoil the similarity of all: the similarity that
/// most of them agree on tells who belongs where.
fn refuse_permuted(landmarks: &[Landmark], rms: f64, spread: f64) -> Result<(), ConformationError> {
    let near = MOST_LEFT * spread;
    let Some(map) = agreed(landmarks, near) else { return Ok(()) };
    let all = || 0..landmarks.len();
    let apart = |from: usize, to: usize| left_of(&landmarks[from], &landmarks[to].patient, &map);
    let wrong: Vec<usize> = all().filter(|&own| apart(own, own) > near).collect();
    let place_of = |&own: &usize| {
        let nearest = wrong.iter().min_by(|a, b| apart(own, **a).total_cmp(&apart(own, **b)));
        nearest.copied().filter(|&place| apart(own, place) <= near)
    };
    let Some(places) = wrong.iter().map(place_of).collect::<Option<Vec<usize>>>() else {
        return Ok(());
    };
    let mut taken = places.clone();
    taken.sort_unstable();
    if wrong.is_empty() || taken != wrong {
        return Ok(());
    }
    let mut to: Vec<Vector> = landmarks.iter().map(|own| own.patient).collect();
    for (&own, &place) in wrong.iter().zip(&places) {
        to[own] = landmarks[place].patient;
    }
    let from: Vec<Vector> = landmarks.iter().map(|own| own.template).collect();
    let after = fitted(&from, &to)?.aligned.rms;
    let name = |at: usize| landmarks[at].name.clone();
    if let (&[one, other], true) = (&wrong[..], after < rms) {
        let (one, other) = (name(one), name(other));
        return Err(ConformationError::Exchanged { one, other, apart: rms, exchanged: after });
    }
    let pairs = wrong.iter().zip(&places);
    let told = pairs.map(|(&own, &place)| format!("{:?} at {:?}", name(own), name(place)));
    let names = told.collect::<Vec<_>>().join(", ");
    Err(ConformationError::Permuted { names, rms, after })
}

/// The similarity with which most landmarks agree to a distance in mm, from those of three of them; nothing where no more than
/// half of them, or fewer than four, agree with any.
fn agreed(landmarks: &[Landmark], near: f64) -> Option<Affine> {
    let count = landmarks.len();
    let triples = (0..count)
        .flat_map(|a| (a + 1..count).flat_map(move |b| (b + 1..count).map(move |c| [a, b, c])));
    // All of them up to 24 landmarks, and evenly chosen ones of more.
    let every = (count * (count - 1) * (count - 2) / 6).div_ceil(MOST_TRIPLES);
    let of = |members: &[usize]| {
        let places = |of: fn(&Landmark) -> Vector| -> Vec<Vector> {
            members.iter().map(|&member| of(&landmarks[member])).collect()
        };
        fitted(&places(|own| own.template), &places(|own| own.patient)).ok()
    };
    let mut best: (Vec<usize>, f64) = (Vec::new(), f64::INFINITY);
    for triple in triples.step_by(every) {
        let Some(map) = of(&triple).filter(|own| refuse_scale(own.scale).is_ok()) else { continue };
        let left = |at: &usize| left_of(&landmarks[*at], &landmarks[*at].patient, &map.map);
        let agree: Vec<usize> = (0..count).filter(|at| left(at) <= near).collect();
        let sum: f64 = agree.iter().map(left).sum();
        if agree.len() > best.0.len() || agree.len() == best.0.len() && sum < best.1 {
            best = (agree, sum);
        }
    }
    let (members, _) = best;
    let is_most = members.len() >= 4 && 2 * members.len() > count;
    is_most.then(|| of(&members)).flatten().map(|own| own.map)
}

pub(super) fn refuse_scale(scale: f64) -> Result<(), ConformationError> {
    match (0.5..=2.0).contains(&scale) {
        true => Ok(()),
        false => Err(ConformationError::Scale { scale }),
    }
}

fn refuse_mirrored(aligned: &PointAlignment, spread: f64) -> Result<(), ConformationError> {
    let (rms, mirrored) = (aligned.rms, aligned.mirrored_rms);
    if mirrored < MIRRORED * rms {
        return Err(ConformationError::Mirrored { rms, mirrored });
    }
    let degrees = aligned.transform.angle().to_degrees();
    match mirrored - rms < PLANAR * spread && degrees > 90.0 {
        true => Err(ConformationError::SidesUndecided { degrees }),
        false => Ok(()),
    }
}

/// Refuses a landmark of the template that lies farther from it than it is large.
pub(super) fn refuse_distant(
    landmarks: &[Landmark],
    mesh: &VolumeMesh,
) -> Result<(), ConformationError> {
    let Some([low, high]) = bounds_of(&mesh.nodes) else { return Ok(()) };
    let size = (high - low).norm();
    for Landmark { name, template, .. } in landmarks {
        let distance = (template - template.sup(&low).inf(&high)).norm();
        if distance > size {
            let name = name.clone();
            return Err(ConformationError::FarFromTemplate { name, distance, size });
        }
    }
    Ok(())
}

fn refuse_misfitting(
    landmarks: &[Landmark],
    map: &Affine,
    rms: f64,
    spread: f64,
) -> Result<(), ConformationError> {
    if rms <= MOST_LEFT * spread {
        return Ok(());
    }
    let left = landmarks.iter().map(|one| (left_of(one, &one.patient, map), one.name.as_str()));
    let (left, worst) = left.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    let share = 100.0 * rms / spread;
    Err(ConformationError::Unlike { rms, share, spread, worst: worst.to_owned(), left })
}

fn refuse_exchanges(landmarks: &[Landmark], map: &Affine) -> Result<(), ConformationError> {
    for (number, one) in landmarks.iter().enumerate() {
        for other in &landmarks[..number] {
            let apart = left_of(one, &one.patient, map).hypot(left_of(other, &other.patient, map));
            let exchanged =
                left_of(one, &other.patient, map).hypot(left_of(other, &one.patient, map));
            // Landmarks nearer to each other than faces differ could be either.
            let far = (one.patient - other.patient).norm();
            if exchanged < EXCHANGED * apart && apart > far {
                let half = std::f64::consts::FRAC_1_SQRT_2;
                let (apart, exchanged) = (apart * half, exchanged * half);
                refuse_misplaced(landmarks, [one, other], map, WITH_IT * apart)?;
                let (one, other) = (other.name.clone(), one.name.clone());
                return Err(ConformationError::Exchanged { one, other, apart, exchanged });
            }
        }
    }
    Ok(())
}

/// Refuses one of two landmarks that is nearer to the other's place than to its own, where the other belongs: an exchange puts
/// both right. Where most landmarks agree with a similarity to so many mm, that tells, which misplaced ones do not pull.
fn refuse_misplaced(
    landmarks: &[Landmark],
    [one, other]: [&Landmark; 2],
    map: &Affine,
    near: f64,
) -> Result<(), ConformationError> {
    let agreed = agreed(landmarks, near);
    let map = agreed.as_ref().unwrap_or(map);
    let is_put_right = |own: &Landmark, place: &Landmark| {
        let [at_own, at_place] = [own, place].map(|at| left_of(own, &at.patient, map));
        at_place < EACH_EXCHANGED * at_own
    };
    if is_put_right(one, other) && is_put_right(other, one) {
        return Ok(());
    }
    let left = |own: &Landmark| left_of(own, &own.patient, map);
    let pair = if left(one) > left(other) { [one, other] } else { [other, one] };
    Err(misplaced(landmarks, pair, map))
}

fn misplaced(
    landmarks: &[Landmark],
    [own, place]: [&Landmark; 2],
    map: &Affine,
) -> ConformationError {
    let left = left_of(own, &own.patient, map);
    let beside = landmarks.iter().filter(|other| other.name != own.name);
    let mut with_it: Vec<(f64, &str)> = beside
        .map(|other| (left_of(other, &other.patient, map), other.name.as_str()))
        .filter(|(other, _)| *other >= WITH_IT * left)
        .collect();
    with_it.sort_by(|a, b| b.0.total_cmp(&a.0));
    let named = with_it.iter().take(MOST_NAMED);
    let named: Vec<String> =
        named.map(|(left, name)| format!("{name:?} by {left:.1} mm")).collect();
    let others = match &named[..] {
        [] => String::new(),
        named => {
            format!(" Left by half of that or more, and perhaps wrong too: {}.", named.join(", "))
        }
    };
    ConformationError::Misplaced {
        name: own.name.clone(),
        left,
        place: place.name.clone(),
        near: left_of(place, &own.patient, map),
        others,
    }
}

fn left_of(landmark: &Landmark, patient: &Vector, map: &Affine) -> f64 {
    (map.apply(&landmark.template) - patient).norm()
}

/// The mean of points and the root of their mean squared distance from it, in mm.
pub(super) fn spread(points: &[Vector]) -> (Vector, f64) {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector>() / count;
    let squares: f64 = points.iter().map(|point| (point - middle).norm_squared()).sum();
    (middle, (squares / count).sqrt().max(f64::MIN_POSITIVE))
}
