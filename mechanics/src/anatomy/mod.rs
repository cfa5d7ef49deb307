//! Anatomical model: from a CT or surfaces and the cuts of an operation to a mesh of the soft tissue with its node sets.
//!
//! [`part_bone`] parts bone into segments ([`osteotomy`](crate::osteotomy)); [`build`] does the rest: the tissue of a
//! [`domain`](crate::domain), between skin and bone, is meshed ([`meshing`](crate::meshing)), and each of its nodes gets a
//! class by the bone that it lies on. The mesh that comes out has the node sets that a case names: one for each segment,
//! `fixed`, `skin`, and parts of the skin.

pub mod closed_jaw;
mod closing;
mod face;
mod given_landmarks;
pub mod label_bone;
pub mod left_out;
pub mod loose;
pub mod region;
mod size;
pub mod skin_scan;
mod skin_scan_error;
pub mod surfaces;
mod thin_bone;
pub mod whole_bone;

pub use closing::Closing;
pub use given_landmarks::GivenLandmarks;
pub use skin_scan_error::SkinScanError;
pub use whole_bone::WholeBone;

use std::collections::BTreeMap;

use rayon::prelude::*;

use thin_bone::join_thin_bone;

use crate::domain::{Boundary, Domain, ImageDomainError, ImageOptions, SurfaceDomainError};
use crate::image::ImageVolume;
use crate::mesh::enclosed::Enclosed;
use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh, Warning};
use crate::meshing::{MeshingError, MeshingReport, MeshingSettings, TissueMesh, mesh};
use crate::osteotomy::bone_image::BoneImage;
use crate::osteotomy::classes::{BoneContact, ClassRules, NodeClasses, TissueBoundary, classify};
use crate::osteotomy::contact::Contact;
use crate::osteotomy::label_error::extent;
use crate::osteotomy::label_surface::label_surface;
use crate::osteotomy::labelling::{FoundSegment, Labelled, label};
use crate::osteotomy::teeth::{ENAMEL_HU, MUCOSA_MM, Teeth};
use crate::osteotomy::{LabelError, Osteotomy, Owner};
use crate::progress::Progress;

/// Bone this far behind a node, in lengths of a voxel's diagonal, is the bone that the node lies on.
const BEHIND: f64 = 1.5;
/// Of a scan, voxels of bone farther from a node are not what it lies on: the walls of airways and cavities beside bone count as
/// bone of the body, and reach farther.
const WALL_VOXELS: f64 = 1.0;

/// How a scan or surfaces become a mesh. Lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnatomyRules {
    /// Of scans.
    pub image: ImageOptions,
    /// Of scans; of surfaces the hollows alone.
    pub whole_bone: WholeBone,
    pub osteotomy: Osteotomy,
    /// A segment that is moved before anything is meshed, beside a skin that was scanned by itself.
    pub closing: Option<Closing>,
    /// The sizes of cells are those of the settings, refined around segments that move.
    pub meshing: MeshingSettings,
    /// Nodes on bone this near to others that move otherwise are free.
    pub band_mm: f64,
    /// Whether tissue is fixed where the scan ends.
    pub scan_ends_fixed: bool,
    /// Only tissue about this near to segments is meshed, in mm; all of it where nothing is said.
    pub around_segments_mm: Option<f64>,
    /// Whether tissue slides on the teeth of segments, and is joined to the rest of their bone only.
    pub teeth_slide: bool,
    /// Says how the head stands; without it no landmarks are looked for.
    pub frame: Frame,
    /// Landmarks that are not looked for, because they are known; cells are fine about them.
    pub landmarks: Option<GivenLandmarks>,
}

/// Bone in its segments.
#[derive(Clone, Debug, PartialEq)]
pub struct PartedBone {
    pub labelled: Labelled,
    /// A closed surface for each segment, in their order.
    pub surfaces: Vec<TriangleSurface>,
    /// Volume and centre of each segment where the surfaces are those of a file, with what is open, doubled or hollow in them.
    pub given: Vec<Enclosed>,
    /// Those that tissue slides on, with the mucosa around them; none where surfaces show no enamel.
    pub teeth: Option<Teeth>,
    /// Nodes of a wall of bone from which all voxels of bone are farther, in edges of voxels, lie on none; infinite where the wall is
    /// that of given surfaces.
    pub wall_voxels: f64,
}

/// Soft tissue that is ready to be a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Anatomy {
    /// With node sets: a name for each segment, `sliding_NAME` for its teeth, `fixed`, `skin`, and `skin_NAME` for parts of
    /// the skin.
    pub volume: VolumeMesh,
    pub meshing: MeshingReport,
    pub bone: Labelled,
    pub classes: NodeClasses,
    /// A closed surface for each segment, in their order.
    pub bones: Vec<TriangleSurface>,
    /// Volume and centre of each: what its surface encloses; of surfaces of a file what lies in them.
    pub solids: Vec<Enclosed>,
    /// Landmarks of the skin on its mid-plane, in mm.
    pub landmarks: BTreeMap<String, Vector>,
    /// The names of the node sets that are parts of the skin.
    pub skin_regions: Vec<String>,
    pub warnings: Vec<Warning>,
}

/// Why a scan or surfaces give no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnatomyError {
    #[error(transparent)]
    Image(#[from] ImageDomainError),
    #[error(transparent)]
    Surface(#[from] SurfaceDomainError),
    #[error(transparent)]
    Bone(#[from] LabelError),
    #[error(transparent)]
    SkinScan(#[from] SkinScanError),
    #[error(transparent)]
    Meshing(#[from] MeshingError),
    #[error(
        "no boundary of the tissue is outer skin: nothing around it is air by the thresholds, as where values are not \
         Hounsfield units; {tissue_ml:.0} ml are taken for tissue"
    )]
    NoSkin { tissue_ml: f64 },
}

/// Parts the bone of a scan into its segments.
pub fn part_bone(scan: &ImageVolume, rules: &AnatomyRules) -> Result<PartedBone, AnatomyError> {
    let bone = BoneImage { image: scan, threshold: rules.image.bone_threshold };
    let parted = parted(&bone, &rules.osteotomy)?;
    let teeth = || Teeth::new(&bone, &parted.labelled.labels, ENAMEL_HU, MUCOSA_MM);
    let teeth = rules.teeth_slide.then(teeth);
    Ok(PartedBone { teeth, ..parted })
}

fn parted(bone: &BoneImage<'_>, osteotomy: &Osteotomy) -> Result<PartedBone, AnatomyError> {
    let labelled = label(bone, osteotomy)?;
    let surfaces = surfaces_of(bone, osteotomy, &labelled);
    let (given, wall_voxels) = (Vec::new(), WALL_VOXELS);
    Ok(PartedBone { labelled, surfaces, given, teeth: None, wall_voxels })
}

impl PartedBone {
    /// Volume, in mm³, and centre, in mm, of each segment: what its surface encloses; of surfaces of a file what lies in them.
    pub fn solids(&self) -> Vec<Enclosed> {
        if !self.given.is_empty() {
            return self.given.clone();
        }
        let solid = |(found, surface): (&FoundSegment, &TriangleSurface)| {
            let of_voxels = Enclosed { volume_mm3: found.volume_mm3, centre: found.centre };
            surface.enclosed().unwrap_or(of_voxels)
        };
        self.labelled.segments.iter().zip(&self.surfaces).map(solid).collect()
    }
}

/// A closed surface for each segment, in their order.
fn surfaces_of(
    bone: &BoneImage<'_>,
    osteotomy: &Osteotomy,
    labelled: &Labelled,
) -> Vec<TriangleSurface> {
    let surface = |segment| label_surface(bone, osteotomy, &labelled.labels, segment);
    (0..labelled.segments.len()).into_par_iter().map(surface).collect()
}

/// Builds the model of a body whose bone is parted. The same body and rules give the same bits on any number of threads.
pub fn build(
    domain: &dyn Domain,
    bone: PartedBone,
    rules: &AnatomyRules,
    progress: &dyn Progress,
) -> Result<Anatomy, AnatomyError> {
    let solids = bone.solids();
    let PartedBone { labelled: bone, surfaces: bones, teeth, wall_voxels, .. } = bone;
    let mut settings = rules.meshing.clone();
    settings.size.regions.extend(size::around_segments(&bone, settings.size.finest));
    let finest = settings.size.finest;
    let about_landmarks = rules.landmarks.iter().flat_map(|given| given.fine(finest));
    settings.size.regions.extend(about_landmarks);
    let tissue = mesh(domain, &settings, progress)?;
    let skin = tissue.nodes_on(Boundary::Skin);
    if skin.is_empty() {
        return Err(AnatomyError::NoSkin { tissue_ml: tissue.report.volume / 1000.0 });
    }
    let (classes, bare) = classes(&tissue, domain, (&bone, wall_voxels), teeth.as_ref(), rules);
    let mut warnings = classes.warnings.clone();
    warnings.extend(off_bone(&classes));
    warnings.extend(left_out::left_out_of_mesh(&tissue.report));
    warnings.extend(left_out::thinner_than_cells(&tissue.report));
    warnings.extend(left_out::gaps_closed(&tissue.report));
    warnings.extend(left_out::touching_itself(&tissue.report));
    warnings.extend(bare);
    if rules.teeth_slide && teeth.is_none() && !bone.segments.is_empty() {
        warnings.push(teeth_joined());
    }
    let fine = &rules.meshing.size.regions;
    warnings.extend(size::without_tissue(fine, &tissue.volume, tissue.report.finest));
    warnings.extend(bone.segments.is_empty().then(uncut));
    warnings.extend(touching(&bone));
    warnings.extend(missed(&bone, &rules.osteotomy));
    let face = face::face(&tissue.volume, &skin, rules.frame, rules.landmarks.as_ref());
    warnings.extend(face.warnings);
    let TissueMesh { mut volume, report, .. } = tissue;
    let names: Vec<String> = bone.segments.iter().map(|segment| segment.name.clone()).collect();
    volume.node_sets = classes.node_sets(&names);
    warnings.extend(names.iter().filter_map(|name| unmeshed(name, &volume)));
    volume.node_sets.insert("skin".to_owned(), skin);
    let skin_regions = face.regions.keys().cloned().collect();
    let sets = face.regions.into_iter().map(|(name, nodes)| (format!("skin_{name}"), nodes));
    volume.node_sets.extend(sets);
    let landmarks = face.landmarks;
    let meshing = report;
    Ok(Anatomy { volume, meshing, bone, classes, bones, solids, landmarks, skin_regions, warnings })
}

/// Cuts at which nothing is parted: planes beside the bone, or between bones that do not touch. A line of pieces is one cut, which
/// may begin and end beyond the bone: it is reported where all of it does.
fn missed(bone: &Labelled, osteotomy: &Osteotomy) -> Vec<Warning> {
    let mut cuts: Vec<(&str, Vec<usize>)> = Vec::new();
    for (number, cut) in osteotomy.cuts().iter().enumerate() {
        match cuts.iter_mut().find(|(name, _)| cut.chain().is_some() && *name == cut.line_name()) {
            Some((_, pieces)) => pieces.push(number),
            None => cuts.push((cut.line_name(), vec![number])),
        }
    }
    cuts.retain(|(_, pieces)| !bone.is_parted_by(osteotomy, pieces[0]));
    let extent = extent(bone.labels.bone_box().as_ref());
    let warning = |(name, pieces): &(&str, Vec<usize>)| {
        let count = pieces.len();
        let of = if count > 1 { format!(" with any of its {count} pieces") } else { String::new() };
        let in_scan = pieces.iter().any(|&cut| bone.labels.is_met_by(&osteotomy.cuts()[cut]));
        let place = if in_scan { "" } else { ", and lies outside the image of the bone" };
        let detail = format!(
            "cut `{name}` meets no bone of a segment{of}{place}: {extent}; is it in the same frame?"
        );
        Warning::new("cut-meets-no-bone", detail).with("pieces", count as f64)
    };
    cuts.iter().map(warning).collect()
}

/// Bone of which nothing can be moved.
fn uncut() -> Warning {
    let detail = "no cuts and no segments were given: all bone stays, and no plan can move any of it; state the cuts and segments of \
                  `osteotomy`, or bones as `surfaces.bones`, and mesh again";
    Warning::new("no-cuts", detail)
}

/// Surfaces, and label maps without teeth, do not tell teeth from bone.
fn teeth_joined() -> Warning {
    let detail = "teeth cannot be distinguished from bone: tissue is joined to the teeth of segments, and does not slide on them";
    Warning::new("teeth-joined", detail)
}

/// A segment that no node of the mesh lies on.
fn unmeshed(name: &str, volume: &VolumeMesh) -> Option<Warning> {
    let has_nodes = volume.node_sets.get(name).is_some_and(|nodes| !nodes.is_empty());
    let detail = format!("no node of the mesh lies on segment `{name}`: plans cannot move it");
    (!has_nodes).then(|| Warning::new("segment-without-nodes", detail))
}

/// Nodes on what ends tissue as bone does, without bone behind it.
fn off_bone(classes: &NodeClasses) -> Option<Warning> {
    let nodes = classes.without_bone;
    let detail = format!(
        "{nodes} nodes lie on the wall of an airway or a cavity beside bone, or on bone too thin for its voxels, with no bone right \
         behind them: they are joined to none, and are free"
    );
    (nodes > 0).then(|| Warning::new("nodes-off-bone", detail).with("nodes", nodes as f64))
}

/// Segments that touch other bone where nothing is cut, as teeth that meet do. Bone that stays touches sawdust and what is loose
/// everywhere.
fn touching(bone: &Labelled) -> Vec<Warning> {
    let name = |owner: Owner| match owner {
        Owner::Segment(segment) => format!("segment `{}`", bone.segments[segment].name),
        Owner::Rest | Owner::Sawn | Owner::Loose => "bone that stays".to_owned(),
    };
    let is_of_segment =
        |contact: &&Contact| contact.between.iter().any(|owner| matches!(owner, Owner::Segment(_)));
    let contacts = bone.contacts.iter().filter(|contact| contact.cut.is_none());
    let contacts = contacts.filter(is_of_segment);
    let warning = |contact: &Contact| {
        let [one, other] = contact.between.map(name);
        let [x, y, z] = contact.centre.into();
        let detail = format!(
            "{one} and {other} touch without a cut on {:.0} mm² around ({x:.0}, {y:.0}, {z:.0}) mm, and are parted where \
             the bone is faintest",
            contact.area_mm2
        );
        Warning::new("bones-touch", detail).with("area_mm2", contact.area_mm2)
    };
    contacts.map(warning).collect()
}

fn classes(
    tissue: &TissueMesh,
    domain: &dyn Domain,
    (bone, wall_voxels): (&Labelled, f64),
    teeth: Option<&Teeth>,
    rules: &AnatomyRules,
) -> (NodeClasses, Vec<Warning>) {
    // Where boundaries meet, bone holds.
    let order = [Boundary::Bone, Boundary::Cut, Boundary::Skin, Boundary::Airway];
    let first = |set: &crate::meshing::BoundarySet| {
        order.into_iter().find(|&boundary| set.contains(boundary))
    };
    let mut marks: Vec<Option<Boundary>> = tissue.boundaries.iter().map(first).collect();
    let reach = BEHIND * bone.labels.placement().steps.iter().sum::<Vector>().norm();
    let slides = |place: &Vector| teeth.is_some_and(|teeth| teeth.near(place));
    let contact = BoneContact {
        behind: &|place, normal| bone.labels.nearest_within(place, normal, reach, wall_voxels),
        slides: &slides,
    };
    let class_rules = ClassRules {
        // Any two segments may be moved differently by some plan.
        movements: (1..=bone.segments.len() as u32).collect(),
        band_mm: rules.band_mm,
        scan_ends_fixed: rules.scan_ends_fixed,
        fixed_above: None,
    };
    let boundary = TissueBoundary { mesh: &tissue.volume, marks: &marks };
    let mut classes = classify(boundary, &contact, &class_rules);
    // Skin beside bone stays free where no bone is behind it.
    let is_skin = |(mark, set): (&mut Option<Boundary>, &crate::meshing::BoundarySet)| {
        if set.contains(Boundary::Skin) {
            *mark = Some(Boundary::Skin);
        }
    };
    marks.iter_mut().zip(&tissue.boundaries).for_each(is_skin);
    let boundary = TissueBoundary { mesh: &tissue.volume, marks: &marks };
    let bare = join_thin_bone(boundary, domain, (bone, &slides), (&class_rules, &mut classes));
    (classes, bare)
}
