//! Spec of a meshing: the scan, the label map or the surfaces, their tissue and bone, the cuts, and the cell sizes.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::labels::LabelsDocument;
use super::landmarks::SkinLandmarksDocument;
use super::size::MeshSizeDocument;
use super::skin_scan::SkinScanDocument;
use super::surfaces::SurfacesDocument;
use super::thresholds::ThresholdsReference;
use super::whole_bone::WholeBoneDocument;
use crate::schema::case::document::FrameName;
use crate::schema::code::ErrorCode;
use crate::schema::osteotomy::OsteotomyDocument;
use crate::schema::osteotomy::conversion::{PlannedOsteotomy, given_segments};
use crate::schema::plan::document::PlanDocument;
use crate::schema::plan::movement::MovementContext;
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::anatomy::{AnatomyRules, Closing};
use mechanics::domain::ImageOptions;
use mechanics::image::ImageVolume;
use mechanics::mesh::Frame;
use mechanics::meshing::MeshingSettings;
use mechanics::osteotomy::Osteotomy;

/// `mesh`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeshingKind {
    #[default]
    Mesh,
}

/// A volume mesh of the soft tissue in a CT or between surfaces, with a node set for each bone segment of an
/// osteotomy: exactly one of `scan`, `labels` and `surfaces`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshingDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: MeshingKind,
    /// The CT: the id of an uploaded image, in Hounsfield units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub scan: Option<String>,
    /// Beside a scan: a surface scan of the face, which replaces the skin of the CT.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin_scan: Option<Box<SkinScanDocument>>,
    /// Instead of a scan: a label map, whose regions of tissue are those of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub labels: Option<LabelsDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub surfaces: Option<SurfacesDocument>,
    /// Of a scan.
    #[serde(default)]
    pub thresholds_hu: ThresholdsReference,
    /// Of a scan or of surfaces. Absent: bone is exactly the voxels above its threshold, or what lies between the walls of its
    /// surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub whole_bone: Option<WholeBoneDocument>,
    /// Absent: no bone is cut, and all bone that is no segment is fixed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub osteotomy: Option<OsteotomyDocument>,
    /// The frame of the osteotomy, and of surfaces without a frame mark. Default: LPS if the scan or the surfaces state
    /// their orientation, in whichever frame they are stored; else the axes of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub frame: Option<FrameName>,
    #[serde(default)]
    pub size: MeshSizeDocument,
    /// Known landmarks of the skin. Absent: they are detected on its profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub landmarks: Option<SkinLandmarksDocument>,
    /// Absent: the whole field of view of the scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<RegionDocument>,
    /// Whether nodes may coincide, where tissue touches itself at a point or along an edge. Gmsh and TetGen read a mesh
    /// only if none do; the surfaces are then slightly apart.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub coincident_nodes: bool,
    /// Whether tissue is fixed where the scan ends.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub scan_ends_fixed: bool,
    /// Whether tissue slides on the teeth of segments and their mucosa. Otherwise it is joined to them.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub teeth_slide: bool,
    #[serde(default)]
    pub budget: BudgetDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

fn yes() -> bool {
    true
}

impl Default for MeshingDocument {
    fn default() -> Self {
        MeshingDocument {
            kind: MeshingKind::Mesh,
            scan: None,
            skin_scan: None,
            labels: None,
            surfaces: None,
            thresholds_hu: ThresholdsReference::default(),
            whole_bone: None,
            osteotomy: None,
            frame: None,
            size: MeshSizeDocument::default(),
            landmarks: None,
            region: None,
            coincident_nodes: yes(),
            scan_ends_fixed: yes(),
            teeth_slide: yes(),
            budget: BudgetDocument::default(),
            tags: Vec::new(),
        }
    }
}

/// The part of the head that is meshed. Tissue beyond it is omitted; its boundary there is treated as the end of the scan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionDocument {
    /// All tissue within this distance of segments of the osteotomy, in mm, and little beyond.
    #[schema(minimum = 10.0, maximum = 300.0)]
    pub around_segments_mm: f64,
}

impl MeshingDocument {
    /// Every mesh that it names, with its place below that of the document.
    pub fn mesh_references_mut(&mut self, root: &Pointer) -> Vec<(Pointer, &mut String)> {
        let scan = self.scan.iter_mut().map(|scan| (root.key("scan"), scan));
        let at = root.key("skin_scan").key("mesh");
        let skin = self.skin_scan.iter_mut().map(|skin| (at.clone(), &mut skin.mesh));
        let skin: Vec<_> = skin.collect();
        let at = root.key("labels").key("image");
        let labels = self.labels.iter_mut().map(|labels| (at.clone(), &mut labels.image));
        let labels: Vec<_> = labels.collect();
        let at = root.key("surfaces");
        let surfaces = self.surfaces.iter_mut().flat_map(|surfaces| surfaces.references_mut(&at));
        scan.chain(skin).chain(labels).chain(surfaces).collect()
    }

    /// The ids of the meshes that it names, in their order.
    pub fn mesh_ids(mut self) -> Vec<String> {
        self.mesh_references_mut(&Pointer::root()).into_iter().map(|(_, id)| id.clone()).collect()
    }

    /// The settings of the numerics for a scan, or for surfaces without an image, in that frame; pointers start at `/spec`.
    pub fn to_rules(
        &self,
        (image, scan): (Option<&ImageVolume>, Frame),
        limits: &Limits,
        faults: &mut Faults,
    ) -> AnatomyRules {
        let at = Pointer::root().key("spec");
        let thresholds = self.thresholds_hu.to_values(image, &at.key("thresholds_hu"), faults);
        self.budget.check(&at.key("budget"), limits, faults);
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        self.check_skin_scan(&at, limits, faults);
        self.check_labels(&at, limits, faults);
        self.check_surfaces(&at, limits, faults);
        self.check_frame(&at, scan, faults);
        let planned = self.to_osteotomy(&at, scan, limits, faults);
        let osteotomy = planned.as_ref().map(|planned| &planned.osteotomy);
        let closing = self.closing(&at, osteotomy, (scan, limits), faults);
        let around_segments_mm = self.region.map(|region| region.around_segments_mm);
        if let Some(margin) = around_segments_mm {
            let at = at.key("region").key("around_segments_mm");
            faults.check_range(&at, margin, 10.0..=300.0, "mm");
            if self.osteotomy.is_none() {
                let detail = "there are no segments without an osteotomy";
                faults.add(&at, ErrorCode::UnknownSegment, detail);
            }
        }
        let mirrored = self.is_mirrored(scan);
        let meshing = self.size.to_settings(&at.key("size"), mirrored, limits, faults);
        let landmarks = self.landmarks.as_ref();
        let landmarks = landmarks
            .and_then(|given| given.to_given(&at.key("landmarks"), scan, mirrored, faults));
        let image = ImageOptions {
            skin_threshold: thresholds.skin,
            bone_threshold: thresholds.bone,
            ..ImageOptions::default()
        };
        let whole_bone = self.whole_bone.unwrap_or_default();
        AnatomyRules {
            image,
            whole_bone: whole_bone.to_rules(&at.key("whole_bone"), faults),
            band_mm: planned.as_ref().map_or(0.0, |planned| planned.free_band_mm),
            closing,
            osteotomy: planned.map(|planned| planned.osteotomy).unwrap_or_default(),
            meshing: MeshingSettings { part_copies: !self.coincident_nodes, ..meshing },
            around_segments_mm,
            scan_ends_fixed: self.scan_ends_fixed,
            teeth_slide: self.teeth_slide,
            frame: scan,
            landmarks,
        }
    }

    /// Refuses places in a frame that is not known to be that of the body; those of an osteotomy are checked with it.
    fn check_frame(&self, at: &Pointer, scan: Frame, faults: &mut Faults) {
        let Some(frame) = self.frame.map(Frame::from).filter(|_| self.osteotomy.is_none()) else {
            return;
        };
        if frame != scan && [frame, scan].contains(&Frame::Unspecified) {
            let detail = format!(
                "the document is in frame {frame}, what is meshed in {scan}: state the `frame` of the one without (for a scan on the \
                 command line, `--frame LPS`; else that of its upload)"
            );
            faults.add(&at.key("frame"), ErrorCode::FrameConflict, detail);
        }
    }

    /// Whether x and y change sign between the document and the meshed body.
    fn is_mirrored(&self, scan: Frame) -> bool {
        self.frame.is_some_and(|frame| Frame::from(frame) != scan)
    }

    fn check_skin_scan(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(skin) = &self.skin_scan else { return };
        let at = at.key("skin_scan");
        skin.check(&at, limits, faults);
        if self.scan.is_none() {
            let detail = "a surface scan replaces the skin of a CT, and there is no `scan`; between surfaces it is `surfaces.skin` itself";
            faults.add(&at, ErrorCode::NoScan, detail);
        }
    }

    fn closing(
        &self,
        at: &Pointer,
        osteotomy: Option<&Osteotomy>,
        (scan, limits): (Frame, &Limits),
        faults: &mut Faults,
    ) -> Option<Closing> {
        let jaw = self.skin_scan.as_ref()?.jaw.as_ref()?;
        let none = Osteotomy::default();
        let context =
            MovementContext { mirrored_axes: self.is_mirrored(scan), centre: None, limits };
        let at = at.key("skin_scan").key("jaw");
        jaw.to_closing(&at, osteotomy.unwrap_or(&none), &context, faults)
    }

    fn check_labels(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(labels) = &self.labels else { return };
        labels.check(&at.key("labels"), limits, faults);
        self.check_without_scan(at, "a label map has no values that thresholds part", faults);
        if self.whole_bone.is_some() {
            let detail = "only bone of a scan or of surfaces is made whole";
            faults.add(&at.key("whole_bone"), ErrorCode::NoScan, detail);
        }
        if self.osteotomy.is_some() && !labels.segments().is_empty() {
            let detail = "bone of `labels` that has a name is a segment already: omit the names to have it cut";
            faults.add(&at.key("osteotomy"), ErrorCode::OneOf, detail);
        }
    }

    /// Refuses members that only a scan has.
    fn check_without_scan(&self, at: &Pointer, detail: &str, faults: &mut Faults) {
        if self.thresholds_hu != ThresholdsReference::default() {
            faults.add(&at.key("thresholds_hu"), ErrorCode::NoScan, detail);
        }
        if self.region.is_some() {
            let detail = "only a scan is meshed in part";
            faults.add(&at.key("region"), ErrorCode::NoScan, detail);
        }
    }

    fn check_surfaces(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(surfaces) = &self.surfaces else { return };
        surfaces.check(&at.key("surfaces"), limits, faults);
        self.check_without_scan(at, "surfaces have no values that thresholds part", faults);
        if self.whole_bone.is_some_and(|whole| whole.closing_mm > 0.0) {
            let detail = "only gaps in the bone of a scan are closed; surfaces have `fill_holes`";
            faults.add(&at.key("whole_bone").key("closing_mm"), ErrorCode::NoScan, detail);
        }
        if self.osteotomy.is_some() && !surfaces.bones.is_empty() {
            let detail = "`surfaces.bones` are segments already: give all bone as `surfaces.bone` to have it cut";
            faults.add(&at.key("osteotomy"), ErrorCode::OneOf, detail);
        }
    }

    fn to_osteotomy(
        &self,
        at: &Pointer,
        scan: Frame,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<PlannedOsteotomy> {
        let bones = self.surfaces.iter().flat_map(|surfaces| &surfaces.bones);
        let names: Vec<&str> = bones.map(|bone| bone.name.trim()).collect();
        let labelled = self.labels.as_ref().map(LabelsDocument::segments).unwrap_or_default();
        if !labelled.is_empty() {
            return given_segments(&labelled, &at.key("labels").key("classes"), faults);
        }
        if !names.is_empty() {
            return given_segments(&names, &at.key("surfaces").key("bones"), faults);
        }
        let mut plan = PlanDocument {
            osteotomy: self.osteotomy.clone(),
            frame: self.frame,
            ..PlanDocument::default()
        };
        plan.take_osteotomy(at, scan, limits, faults)
    }

    /// Everything that determines the mesh, for the hash: no tags, no budget.
    pub fn content(&self) -> Value {
        let mut plain = self.clone();
        plain.tags.clear();
        plain.budget = BudgetDocument::default();
        canonical::to_value(&plain)
    }
}
