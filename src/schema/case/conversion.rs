//! Conversion of a case document and its meshes to the numerics: one unit, one frame, checked values.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::document::{CaseDocument, FrameName, LengthUnit, NormalDocument};
use super::hounsfield::HounsfieldDocument;
use super::material::MaterialDocuments;
use super::merged::{Merged, PlacedMaterials, merge_materials};
use super::meshes::CaseMeshes;
use super::muscle::{MuscleContext, doubts, to_muscles};
use super::region::{check_regions, check_tissues, region_names};
use super::size::{USUAL_DIAGONAL_MM, units_suspect};
use crate::schema::code::ErrorCode;
use crate::schema::repair::{RepairedMesh, check_cells};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::{check_distinct, check_keys, check_tags};
use mechanics::boundary::{NodeClass, NodeSelection};
use mechanics::mesh::{Frame, TriangleSurface, Vector, VolumeMesh, Warning};
use mechanics::prediction::{
    Bone, Case, CaseSegment, Hounsfield, MuscleMixing, Sliding, SlidingNormal,
};
use mechanics::repair::RepairReport;

/// Farthest coordinate of a landmark in mm.
const FARTHEST_LANDMARK_MM: f64 = 1e8;

/// A case as the numerics take it.
pub struct ConvertedCase {
    pub case: Case,
    pub warnings: Vec<Warning>,
    /// Of its volume, if the document requests one.
    pub repair: Option<RepairReport>,
}

/// Classes of nodes, reserved: no segment may have these names.
const OF_CLASSES: [NodeClass; 4] =
    [NodeClass::Prescribed, NodeClass::Fixed, NodeClass::Sliding, NodeClass::Free];

impl CaseDocument {
    /// The case in mm with the materials of a spec over its own. Pointers start at `/case` and `/spec`.
    pub fn to_case(
        &self,
        meshes: &CaseMeshes,
        spec_materials: Option<&MaterialDocuments>,
        limits: &Limits,
        faults: &mut Faults,
    ) -> ConvertedCase {
        let at = Pointer::root().key("case");
        self.check_texts(&at, limits, faults);
        let frame_warning = self.check_frames(&at, meshes, faults);
        let volume = in_mm(&meshes.volume.mesh, self.units);
        let repair = self.repair.as_ref();
        let mended = repair.and_then(|own| own.mended(&volume, &at.key("repair"), faults));
        let volume = mended.as_ref().map_or(volume, |mended| mended.volume.clone());
        check_cells(&volume, self.repair.is_some(), &at, faults);
        let own = PlacedMaterials { at: at.key("materials"), materials: self.materials.as_ref() };
        let spec = PlacedMaterials {
            at: Pointer::root().key("spec").key("materials"),
            materials: spec_materials,
        };
        let Merged { materials, fibres, mut warnings } =
            merge_materials(&own, &spec, limits, faults);
        warnings.extend(frame_warning);
        warnings.extend(self.unmarked_image(meshes));
        warnings.extend(self.hounsfield.iter().flat_map(HounsfieldDocument::doubts));
        warnings.extend(doubts(&self.muscles));
        warnings.extend(unusual_size(&volume, self.units));
        warnings.extend(mended.as_ref().and_then(RepairedMesh::warning));
        let regions = self.regions.as_ref();
        let regions = regions.map(|own| own.to_names(&at.key("regions"), &volume, faults));
        if let Some(known) = region_names(&regions, &volume) {
            warnings.extend(spec.unused_default(&own, &known));
            check_tissues(&spec, self.hounsfield.as_ref(), &known, faults);
            check_regions(&[own, spec], &known, faults);
        }
        let (skin, skin_regions) = self.to_skin(&at, limits, faults);
        let surfaces = self.to_surfaces(meshes);
        let muscles_read_with = MuscleContext { limits, surfaces: Some(&surfaces) };
        let case = Case {
            frame: self.frame.into(),
            bones: self.to_bones(&at.key("bones"), meshes, limits, faults),
            landmarks: self.to_landmarks(&at.key("landmarks"), limits, faults),
            regions,
            skin,
            skin_regions,
            segments: self.to_segments(&at.key("segments"), limits, faults),
            fixed: self.to_fixed(&at.key("fixed"), limits, faults),
            allow_unfixed: self.allow_unfixed,
            sliding: self.to_sliding(&at.key("sliding"), limits, faults),
            hounsfield: self.to_hounsfield(&at.key("hounsfield"), meshes, limits, faults),
            muscles: to_muscles(&self.muscles, &at.key("muscles"), muscles_read_with, faults),
            muscle_mixing: self.to_muscle_mixing(&at.key("muscle_mixing"), faults),
            surfaces,
            materials,
            fibres,
            volume,
        };
        ConvertedCase { case, warnings, repair: mended.map(|mended| mended.report) }
    }

    fn check_texts(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        if self.schema != 1 {
            let detail = format!("schema {} is not known, only 1 is", self.schema);
            faults.add(&at.key("schema"), ErrorCode::OutOfRange, detail);
        }
        if let Some(name) = &self.name {
            faults.check_name(&at.key("name"), name, limits.name_characters as usize);
        }
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        if let Some(acquisition) = &self.acquisition {
            acquisition.check(&at.key("acquisition"), limits, faults);
        }
    }

    /// Frame marks in files must agree with the case and with each other.
    fn check_frames(
        &self,
        at: &Pointer,
        meshes: &CaseMeshes,
        faults: &mut Faults,
    ) -> Option<Warning> {
        let volume = [("volume", meshes.volume.frame)];
        let surfaces = meshes.surfaces.iter();
        let marks: Vec<(&str, Frame)> = volume
            .into_iter()
            .chain(surfaces.map(|(id, surface)| (id.as_str(), surface.frame)))
            .filter_map(|(id, mark)| Some((id, mark?)))
            .filter(|(_, mark)| *mark != Frame::Unspecified)
            .collect();
        let stated = self.frame != FrameName::Unspecified;
        let image = meshes.image.as_ref().and_then(|image| image.frame);
        let image = image.and_then(Frame::known).map(|mark| ("image", mark));
        // An image is turned to the frame of the others, so that its own mark only counts where it is alone.
        let (first_id, first) = marks.first().copied().or(image)?;
        let frame = if stated { self.frame.into() } else { first };
        for (id, mark) in marks.into_iter().filter(|(_, mark)| *mark != frame) {
            let other = if stated { "the case".to_owned() } else { format!("mesh {first_id}") };
            let detail = format!("mesh {id} is marked {mark}, {other} {frame}");
            faults.add(&at.key("frame"), ErrorCode::FrameConflict, detail);
        }
        (!stated).then(|| {
            Warning::new(
                "frame-unstated",
                format!("a mesh is marked {first}, the case states no frame; coordinates are used unchanged"),
            )
        })
    }

    /// An image without a frame beside meshes with one.
    fn unmarked_image(&self, meshes: &CaseMeshes) -> Option<Warning> {
        let (image, frame) = (meshes.image.as_ref()?, self.frame_of_meshes(meshes));
        let is_unmarked = image.frame.unwrap_or_default() == Frame::Unspecified;
        let detail = || {
            format!(
                "the image does not state which axes of the patient its own are, and is used as if they were {frame}: if not, \
                 it is turned or mirrored; upload it with its `frame`"
            )
        };
        (is_unmarked && frame != Frame::Unspecified)
            .then(|| Warning::new("image-place-doubtful", detail()))
    }

    /// The image in the frame of the case, and its windows.
    fn to_hounsfield(
        &self,
        at: &Pointer,
        meshes: &CaseMeshes,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<Hounsfield> {
        let document = self.hounsfield.as_ref()?;
        let tissues = document.to_tissues(at, limits, faults);
        let image = meshes.image.as_ref()?;
        let (from, to) = (image.frame.unwrap_or_default(), self.frame_of_meshes(meshes));
        Some(document.to_hounsfield(Arc::new(image.mesh.turned(from, to)), tissues))
    }

    /// Mixing of muscles into cells.
    fn to_muscle_mixing(&self, at: &Pointer, faults: &mut Faults) -> MuscleMixing {
        let Some(own) = self.muscle_mixing else { return MuscleMixing::default() };
        own.to_mixing(at, faults)
    }

    /// The frame of the case, or else the first frame mark of a mesh.
    fn frame_of_meshes(&self, meshes: &CaseMeshes) -> Frame {
        let surfaces = meshes.surfaces.values().map(|surface| surface.frame);
        let frames = [Some(self.frame.into()), meshes.volume.frame].into_iter().chain(surfaces);
        frames.flatten().find(|frame| *frame != Frame::Unspecified).unwrap_or_default()
    }

    /// Each surface by its id and by the name of its bone.
    fn to_surfaces(&self, meshes: &CaseMeshes) -> BTreeMap<String, Arc<TriangleSurface>> {
        let mut surfaces: BTreeMap<String, Arc<TriangleSurface>> = meshes
            .surfaces
            .iter()
            .map(|(id, surface)| (id.clone(), surface_in_mm(&surface.mesh, self.units)))
            .collect();
        for bone in &self.bones {
            if let Some(surface) = surfaces.get(&bone.mesh).cloned() {
                surfaces.insert(bone.name.trim().to_owned(), surface);
            }
        }
        surfaces
    }

    fn to_bones(
        &self,
        at: &Pointer,
        meshes: &CaseMeshes,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Vec<Bone> {
        faults.check_length(at, self.bones.len(), limits.list_entries as usize);
        let names = self.bones.iter().map(|bone| bone.name.as_str());
        check_distinct(names, at, faults);
        let mut bones = Vec::new();
        for (index, bone) in self.bones.iter().enumerate() {
            let place = at.index(index).key("name");
            faults.check_name(&place, &bone.name, limits.name_characters as usize);
            if !meshes.surfaces.contains_key(&bone.mesh) {
                let detail = format!("mesh `{}` is not a surface", bone.mesh);
                faults.add(&at.index(index).key("mesh"), ErrorCode::UnknownMesh, detail);
            }
            bones.push(Bone { name: bone.name.trim().to_owned(), surface: bone.mesh.clone() });
        }
        bones
    }

    fn to_landmarks(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> BTreeMap<String, Vector> {
        check_keys(&self.landmarks, at, limits, faults);
        for (name, position) in &self.landmarks {
            for (axis, &coordinate) in position.0.iter().enumerate() {
                let place = at.key(name).index(axis);
                let range = -FARTHEST_LANDMARK_MM..=FARTHEST_LANDMARK_MM;
                faults.check_range(&place, coordinate, range, "mm");
            }
        }
        let landmarks = self.landmarks.iter();
        landmarks.map(|(name, &position)| (name.clone(), Vector::from(position))).collect()
    }

    fn to_skin(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> (Option<NodeSelection>, BTreeMap<String, NodeSelection>) {
        let skin = self.skin.as_ref();
        let skin = skin.and_then(|skin| skin.to_selection(&at.key("skin"), limits, faults));
        let at = at.key("skin_regions");
        check_keys(&self.skin_regions, &at, limits, faults);
        let mut parts = BTreeMap::new();
        for (name, part) in &self.skin_regions {
            let place = at.key(name);
            if let Some(selection) = part.to_selection(&place, limits, faults) {
                parts.insert(name.clone(), selection);
            }
        }
        (skin, parts)
    }

    fn to_segments(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) -> Vec<CaseSegment> {
        faults.check_length(at, self.segments.len(), limits.list_entries as usize);
        let names = self.segments.iter().map(|segment| segment.name.as_str());
        check_distinct(names, at, faults);
        let mut segments = Vec::new();
        for (index, segment) in self.segments.iter().enumerate() {
            let at = at.index(index);
            faults.check_name(&at.key("name"), &segment.name, limits.name_characters as usize);
            let name = segment.name.trim().to_owned();
            if OF_CLASSES.iter().any(|class| class.name() == name) {
                let detail = format!(
                    "{name:?} is reserved for nodes that no segment moves, in counts and reactions: rename the segment"
                );
                faults.add(&at.key("name"), ErrorCode::BadName, detail);
            }
            let nodes = segment.nodes.to_selection(&at.key("nodes"), limits, faults);
            segments.extend(nodes.map(|nodes| CaseSegment { name, nodes }));
        }
        segments
    }

    fn to_fixed(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) -> Vec<NodeSelection> {
        faults.check_length(at, self.fixed.len(), limits.list_entries as usize);
        let fixed = self.fixed.iter().enumerate();
        fixed
            .filter_map(|(index, nodes)| nodes.to_selection(&at.index(index), limits, faults))
            .collect()
    }

    fn to_sliding(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) -> Vec<Sliding> {
        faults.check_length(at, self.sliding.len(), limits.list_entries as usize);
        let mut sliding = Vec::new();
        for (index, set) in self.sliding.iter().enumerate() {
            let at = at.index(index);
            let nodes = set.nodes.to_selection(&at.key("nodes"), limits, faults);
            let normal = match set.normal {
                NormalDocument::Word(_) => SlidingNormal::Surface,
                NormalDocument::Direction(direction) => {
                    match Vector::from(direction).try_normalize(1e-12) {
                        Some(unit) => SlidingNormal::Direction(unit),
                        None => {
                            let detail = "a direction needs a length above 0";
                            faults.add(&at.key("normal"), ErrorCode::OutOfRange, detail);
                            continue;
                        }
                    }
                }
            };
            let segment = set.segment.as_deref().map(|name| name.trim().to_owned());
            sliding.extend(nodes.map(|nodes| Sliding { nodes, normal, segment }));
        }
        sliding
    }
}

/// The centre of the bounding box of a mesh.
pub fn centre(volume: &VolumeMesh) -> Vector {
    let [low, high] = volume.bounds();
    (low + high) * 0.5
}

fn unusual_size(volume: &VolumeMesh, units: LengthUnit) -> Option<Warning> {
    let [low, high] = volume.bounds();
    let diagonal = (high - low).norm();
    if USUAL_DIAGONAL_MM.contains(&diagonal) {
        return None;
    }
    let (shortest, longest) = USUAL_DIAGONAL_MM.into_inner();
    let detail = format!(
        "the mesh is {diagonal:.4} mm across if its unit is {}; heads are {shortest} to {longest} mm",
        units.name()
    );
    Some(units_suspect(diagonal, detail))
}

fn in_mm(volume: &Arc<VolumeMesh>, units: LengthUnit) -> Arc<VolumeMesh> {
    if units == LengthUnit::Mm {
        return volume.clone();
    }
    // Vector arrays carry their unit in their name and are left alone.
    let mut scaled = (**volume).clone();
    for node in &mut scaled.nodes {
        *node *= units.in_mm();
    }
    Arc::new(scaled)
}

fn surface_in_mm(surface: &Arc<TriangleSurface>, units: LengthUnit) -> Arc<TriangleSurface> {
    if units == LengthUnit::Mm {
        return surface.clone();
    }
    let mut scaled = (**surface).clone();
    for point in &mut scaled.points {
        *point *= units.in_mm();
    }
    Arc::new(scaled)
}
