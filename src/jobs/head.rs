//! A head by its landmarks before, planned, performed and predicted: measures against norms, and symmetry.

use std::collections::BTreeMap;

use crate::schema::case::bone_landmark::BoneLandmarkOfCaseDocument;
use crate::schema::case::norm::{NormDocument, NormDocuments};
use crate::schema::predict::planned::{
    MeasureDocument, NormOfMeasureDocument, SymmetryDocument, TissueName,
};
use mechanics::cephalometry::{
    Landmarks, MEASURES, Measure, MidSagittal, NORMS, Symmetric, Tissue, z_score,
};
use mechanics::mesh::Vector;

type NamedPoints = BTreeMap<String, Vector>;
/// The planned position of a point of a segment of this name; none if it stays.
type SegmentMotion<'a> = &'a dyn Fn(&str, &Vector) -> Option<Vector>;
type BoneLandmarks = BTreeMap<String, BoneLandmarkOfCaseDocument>;

/// Landmarks of bone in mm.
#[derive(Default)]
pub struct Bone {
    pub before: NamedPoints,
    pub planned: Option<NamedPoints>,
    pub performed: Option<NamedPoints>,
}

/// Landmarks of skin in mm.
#[derive(Default)]
pub struct Skin {
    pub before: NamedPoints,
    pub predicted: Option<NamedPoints>,
}

/// A head by its landmarks, with norms that replace built-in ones.
pub struct Head {
    pub bone: Bone,
    pub skin: Skin,
    pub norms: NormDocuments,
}

/// A value or similar at each stage.
struct Stages<T> {
    before: T,
    planned: Option<T>,
    predicted: Option<T>,
    performed: Option<T>,
}

impl Bone {
    /// Before the operation.
    pub fn before(landmarks: &BoneLandmarks) -> Self {
        let places = landmarks.iter();
        let before = places.map(|(name, own)| (name.clone(), own.position_mm.into())).collect();
        Bone { before, ..Bone::default() }
    }

    /// With the values after the planned movements.
    pub fn planned(self, landmarks: &BoneLandmarks, moved: SegmentMotion) -> Self {
        Bone { planned: Some(taken(landmarks, moved)), ..self }
    }

    /// With the values after the operation.
    pub fn performed(self, landmarks: &BoneLandmarks, moved: SegmentMotion) -> Self {
        Bone { performed: Some(taken(landmarks, moved)), ..self }
    }
}

/// Each landmark moved with its segment.
fn taken(landmarks: &BoneLandmarks, moved: SegmentMotion) -> NamedPoints {
    let taken = |(name, own): (&String, &BoneLandmarkOfCaseDocument)| {
        let at = Vector::from(own.position_mm);
        let moved = own.segment.as_deref().and_then(|segment| moved(segment.trim(), &at));
        (name.clone(), moved.unwrap_or(at))
    };
    landmarks.iter().map(taken).collect()
}

impl Head {
    /// A function of landmarks at each stage; none if undefined before.
    fn at<T>(&self, tissue: Tissue, of: impl Fn(&Landmarks) -> Option<T>) -> Option<Stages<T>> {
        let after =
            |places: &Option<NamedPoints>| places.as_ref().and_then(|own| of(&Landmarks(own)));
        Some(match tissue {
            Tissue::Bone => Stages {
                before: of(&Landmarks(&self.bone.before))?,
                planned: after(&self.bone.planned),
                predicted: None,
                performed: after(&self.bone.performed),
            },
            Tissue::Skin => Stages {
                before: of(&Landmarks(&self.skin.before))?,
                planned: None,
                predicted: after(&self.skin.predicted),
                performed: None,
            },
        })
    }

    /// Every measure whose landmarks are all given.
    pub fn measures(&self) -> Vec<MeasureDocument> {
        MEASURES.iter().filter_map(|measure| self.measure(measure)).collect()
    }

    fn measure(&self, measure: &Measure) -> Option<MeasureDocument> {
        let stages = self.at(measure.tissue, |landmarks| measure.of(landmarks))?;
        Some(MeasureDocument {
            name: measure.name.to_owned(),
            unit: measure.unit.name().to_owned(),
            tissue: name_of(measure.tissue),
            source: measure.source.to_owned(),
            norm: self.norm(measure.name).map(|norm| against(&norm, &stages)),
            before: stages.before,
            planned: stages.planned,
            predicted: stages.predicted,
            performed: stages.performed,
        })
    }

    /// The norm of the case, or else the built-in one.
    fn norm(&self, measure: &str) -> Option<NormDocument> {
        let built_in = NORMS.iter().find(|norm| norm.measure == measure);
        let built_in = built_in.map(|norm| NormDocument {
            mean: norm.mean,
            sd: norm.sd,
            source: norm.source.to_owned(),
        });
        self.norms.get(measure).cloned().or(built_in)
    }

    /// Every pair and every midline landmark, relative to the mid-sagittal plane before the operation: that of bone, or else that
    /// of the skin; none without either.
    pub fn symmetry(&self) -> Vec<SymmetryDocument> {
        let (bone, skin) = (Landmarks(&self.bone.before), Landmarks(&self.skin.before));
        let of_bone = MidSagittal::of(&bone).map(|plane| (Tissue::Bone, plane));
        let of_skin = || MidSagittal::of_skin(&skin).map(|plane| (Tissue::Skin, plane));
        let Some(plane) = of_bone.or_else(of_skin) else { return Vec::new() };
        let own_of_skin = skin.symmetric().into_iter().map(|own| (Tissue::Skin, own));
        let all = bone.symmetric().into_iter().map(|own| (Tissue::Bone, own)).chain(own_of_skin);
        all.filter_map(|(tissue, own)| self.symmetric(&plane, tissue, &own)).collect()
    }

    fn symmetric(
        &self,
        (of_plane, plane): &(Tissue, MidSagittal),
        tissue: Tissue,
        own: &Symmetric,
    ) -> Option<SymmetryDocument> {
        let stages = self.at(tissue, |landmarks| plane.asymmetry(own, landmarks))?;
        Some(SymmetryDocument {
            landmark: own.name.clone(),
            tissue: name_of(tissue),
            plane: name_of(*of_plane),
            before: stages.before.into(),
            planned: stages.planned.map(Into::into),
            predicted: stages.predicted.map(Into::into),
            performed: stages.performed.map(Into::into),
        })
    }
}

fn name_of(tissue: Tissue) -> TissueName {
    match tissue {
        Tissue::Bone => TissueName::Bone,
        Tissue::Skin => TissueName::Skin,
    }
}

fn against(norm: &NormDocument, stages: &Stages<f64>) -> NormOfMeasureDocument {
    let z = |value: f64| z_score(value, norm.mean, norm.sd);
    NormOfMeasureDocument {
        mean: norm.mean,
        sd: norm.sd,
        source: norm.source.clone(),
        before_z: z(stages.before),
        planned_z: stages.planned.map(z),
        predicted_z: stages.predicted.map(z),
        performed_z: stages.performed.map(z),
    }
}
