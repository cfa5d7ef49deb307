//! The fit of a template's sheets to the surfaces of a patient: a similarity, an affine map, and lattices from coarse to fine.

use super::affine::Affine;
use super::covering::{Covering, uncovered};
use super::deformation::Deformation;
use super::error::{ConformationError, SheetName};
use super::landmark::{self, Landmark, refuse_scale};
use super::lattice::{Aabb, Field, Lattice};
use super::matching::{MatchWeights, Target};
use super::pull::Pull;
use super::schedule::{BONE, LANDMARK, Level};
use super::sheet::Sheet;
use super::start::{self, Start};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, VolumeMesh, bounds_of};
use crate::progress::Progress;

/// Rounds of the affine map, and what keeps it near a similarity.
const AFFINE_ROUNDS: usize = 20;
const AFFINE_STIFFNESS: f64 = 1e-3;

/// Share of the template's skin that needs a partner after the affine map.
const FEWEST_PARTNERS: f64 = 0.5;

/// Distance of skins after the affine map as a share of the template's diagonal: 0.9 % between the shared faces.
const MOST_APART: f64 = 0.03;

/// Of the affine map's largest stretch to its smallest.
const MOST_STRETCHED: f64 = 1.5;

/// A mesh with its boundary on skin and bone.
#[derive(Clone, Copy, Debug)]
pub struct Template<'a> {
    pub mesh: &'a VolumeMesh,
    /// Nodes on the skin, and on bone.
    pub skin: &'a [u32],
    pub bone: &'a [u32],
}

/// What is known of a patient; lengths in mm. Landmarks alone will do, surfaces alone claim nothing about nodes.
#[derive(Clone, Copy, Debug)]
pub struct Patient<'a> {
    pub skin: Option<&'a TriangleSurface>,
    pub bone: Option<&'a TriangleSurface>,
    pub landmarks: &'a [Landmark],
}

/// A sheet of the template with the surface that it meets.
pub(super) struct Pair {
    pub sheet: Sheet,
    pub target: Target,
    pub covering: Covering,
}

/// The template's sheets with the surfaces that they meet.
pub(super) struct Surfaces<'a> {
    mesh: &'a VolumeMesh,
    pub skin: Option<Pair>,
    pub bone: Option<Pair>,
}

impl<'a> Surfaces<'a> {
    pub fn new(template: &Template<'a>, patient: &Patient) -> Result<Self, ConformationError> {
        let boundary = template.mesh.boundary_faces();
        let sheet = |nodes: &[u32]| Sheet::of(template.mesh, &boundary, nodes);
        let skin = pair(SheetName::Skin, sheet(template.skin), template.skin.len(), patient.skin)?;
        let bone = pair(SheetName::Bone, sheet(template.bone), template.bone.len(), patient.bone)?;
        Ok(Surfaces { mesh: template.mesh, skin, bone })
    }

    /// The map of a template to a patient by the lattices of some levels.
    pub fn fitted(
        &self,
        patient: &Patient,
        start: Start,
        levels: &[Level],
        progress: &dyn Progress,
    ) -> Result<Deformation, ConformationError> {
        let (skin, bone, landmarks) = (self.skin.as_ref(), self.bone.as_ref(), patient.landmarks);
        let affine = affinely(started(start, patient, skin.or(bone))?, skin, landmarks)?;
        if let Some(pair) = skin {
            refuse_other_shapes(pair, &affine)?;
        }
        let fitting = Fitting {
            skin: skin.map(|pair| pair.placed(&affine)),
            bone: bone.map(|pair| pair.placed(&affine)),
            landmarks: landmark_pulls(landmarks, &affine, LANDMARK),
            boxes: boxes(self.mesh, landmarks, &affine),
            progress,
        };
        let field = fitting.run(levels)?;
        Ok(Deformation { affine, field })
    }
}

fn pair(
    name: SheetName,
    sheet: Sheet,
    nodes: usize,
    surface: Option<&TriangleSurface>,
) -> Result<Option<Pair>, ConformationError> {
    let Some(surface) = surface else { return Ok(None) };
    if sheet.is_empty() {
        return Err(ConformationError::NoSheet { sheet: name, nodes });
    }
    let refused = |error| ConformationError::Surface { sheet: name, error };
    let (search, is_bone) =
        (SurfaceSearch::new(surface).map_err(refused)?, name == SheetName::Bone);
    let covered = if is_bone { None } else { uncovered(&search, surface) };
    let (target, covering) = match covered {
        None => (Target::new(search, surface, is_bone), Covering::default()),
        Some((skin, covering)) => {
            let search = SurfaceSearch::new(&skin).map_err(refused)?;
            (Target::new(search, &skin, is_bone), covering)
        }
    };
    Ok(Some(Pair { sheet, target, covering }))
}

fn started(
    start: Start,
    patient: &Patient,
    pair: Option<&Pair>,
) -> Result<Affine, ConformationError> {
    let by_landmarks = match start {
        Start::Landmarks => true,
        Start::Auto => patient.landmarks.len() >= landmark::FEWEST,
        Start::Inertia | Start::Boxes => false,
    };
    let surface = patient.skin.or(patient.bone);
    let (Some(pair), Some(surface), false) = (pair, surface, by_landmarks) else {
        return landmark::similarity(patient.landmarks);
    };
    let map = match start {
        Start::Boxes => start::by_boxes(&pair.sheet.surface, surface),
        Start::Auto | Start::Landmarks | Start::Inertia => {
            let or_boxes = start == Start::Auto;
            start::by_inertia(&pair.sheet.surface, surface, &pair.target, or_boxes)
        }
    };
    refuse_scale(map.matrix.determinant().cbrt())?;
    Ok(map)
}

/// The affine map that follows from a start by matches of the skin and by landmarks.
fn affinely(
    mut affine: Affine,
    skin: Option<&Pair>,
    landmarks: &[Landmark],
) -> Result<Affine, ConformationError> {
    let weights = MatchWeights { along: 1.0, across: 0.1, always: 10.0, back: 0.0 };
    let rounds = if skin.is_some() || landmarks.len() >= 4 { AFFINE_ROUNDS } else { 0 };
    for _ in 0..rounds {
        let weight = 1.0 / landmarks.len().max(1) as f64;
        let mut pulls = landmark_pulls(landmarks, &affine, weight);
        if let Some(pair) = skin {
            let now = pair.sheet.placed(&affine);
            pulls.extend(pair.target.pulls(&now, &now.surface, &weights).map_err(skin_error)?);
        }
        let Some(step) = Affine::fitted(&pulls, AFFINE_STIFFNESS) else { break };
        affine = affine.then(&step);
    }
    Ok(affine)
}

fn skin_error(error: crate::mesh::SearchError) -> ConformationError {
    ConformationError::Surface { sheet: SheetName::Skin, error }
}

fn refuse_other_shapes(pair: &Pair, affine: &Affine) -> Result<(), ConformationError> {
    let stretches = affine.matrix.singular_values();
    let ratio = stretches.max() / stretches.min();
    if ratio > MOST_STRETCHED {
        return Err(ConformationError::Stretched { ratio, most: MOST_STRETCHED });
    }
    let now = pair.sheet.placed(affine).surface;
    let [partners, points] = pair.target.partners(&now);
    if (partners as f64) < FEWEST_PARTNERS * points as f64 {
        return Err(ConformationError::FewPartners { partners, points });
    }
    let mut distances = pair.target.distances(&now.points);
    distances.sort_by(f64::total_cmp);
    let median = distances[distances.len() / 2];
    let (low, high) = now.bounds();
    let size = (high - low).norm();
    match median <= MOST_APART * size {
        true => Ok(()),
        false => {
            let (share, most) = (100.0 * median / size, 100.0 * MOST_APART);
            Err(ConformationError::NoSuchFace { median, share, size, most })
        }
    }
}

fn landmark_pulls(landmarks: &[Landmark], affine: &Affine, weight: f64) -> Vec<Pull> {
    let pull = |one: &Landmark| Pull::to_point(affine.apply(&one.template), one.patient, weight);
    landmarks.iter().map(pull).collect()
}

/// The boxes of cells and landmarks after an affine map.
fn boxes(mesh: &VolumeMesh, landmarks: &[Landmark], affine: &Affine) -> Vec<Aabb> {
    let moved: Vec<Vector> = mesh.nodes.iter().map(|x| affine.apply(x)).collect();
    let around = |nodes: &[u32]| bounds_of(nodes.iter().map(|&node| &moved[node as usize]));
    let cells = mesh.cells.iter().filter_map(|(_, nodes)| around(nodes));
    let points = landmarks.iter().map(|one| [affine.apply(&one.template); 2]);
    cells.chain(points).collect()
}

impl Pair {
    fn placed(&self, affine: &Affine) -> PlacedPair<'_> {
        PlacedPair { sheet: self.sheet.placed(affine), target: &self.target }
    }
}

/// A sheet after the affine map, with the surface that it meets.
struct PlacedPair<'a> {
    sheet: Sheet,
    target: &'a Target,
}

/// A free-form deformation in the making.
struct Fitting<'a> {
    skin: Option<PlacedPair<'a>>,
    bone: Option<PlacedPair<'a>>,
    landmarks: Vec<Pull>,
    boxes: Vec<Aabb>,
    progress: &'a dyn Progress,
}

impl Fitting<'_> {
    fn run(&self, levels: &[Level]) -> Result<Field, ConformationError> {
        let rounds: usize = levels.iter().map(|level| level.rounds).sum();
        let mut done = 0;
        let coarsest = levels.first().map_or(1.0, |level| level.spacing);
        let mut field = Field::zero(Lattice::around(&self.boxes, coarsest));
        for level in levels {
            let mut next = self.on_lattice(&field, level.spacing);
            for _ in 0..level.rounds {
                if self.progress.is_cancelled() {
                    return Err(ConformationError::Cancelled { rounds: done });
                }
                let pulls = self.pulls(&field, level)?;
                next = next.fitted(&pulls, level.bending);
                field = next.clone();
                done += 1;
                self.progress.step(done, rounds);
            }
        }
        Ok(field)
    }

    /// The field on a lattice of a spacing, or nothing on a coarser one.
    fn on_lattice(&self, field: &Field, spacing: f64) -> Field {
        let mut next = field.clone();
        if spacing > field.lattice.spacing {
            next = Field::zero(Lattice::around(&self.boxes, spacing));
        }
        while next.lattice.spacing > 1.5 * spacing {
            next = next.refined(&self.boxes);
        }
        next
    }

    fn pulls(&self, field: &Field, level: &Level) -> Result<Vec<Pull>, ConformationError> {
        let mut pulls = self.landmarks.clone();
        let skin = self.skin.iter().map(|pair| (pair, SheetName::Skin, level.weights));
        let weights = MatchWeights { along: BONE, back: 0.0, ..level.weights };
        let bone = self.bone.iter().filter(|_| level.with_bone || self.skin.is_none());
        let bone = bone.map(|pair| (pair, SheetName::Bone, weights));
        for (pair, sheet, weights) in skin.chain(bone) {
            let now = pair.sheet.moved(|x| x + field.at(x));
            let found = pair.target.pulls(&pair.sheet, &now, &weights);
            pulls.extend(found.map_err(|error| ConformationError::Surface { sheet, error })?);
        }
        Ok(pulls)
    }
}
