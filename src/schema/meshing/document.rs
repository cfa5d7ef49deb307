//! The spec of a meshing: the scan, the label map or the surfaces, what of them is tissue and bone, what is cut, and how fine the mesh is.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::labels::LabelsDocument;
use super::skin_scan::SkinScanDocument;
use super::surfaces::SurfacesDocument;
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
use mechanics::mesh::Frame;
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::osteotomy::Osteotomy;

/// `mesh`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeshingKind {
    #[default]
    Mesh,
}

/// A volume mesh of the soft tissue in a CT or between surfaces, with a node set for each bone segment that an operation
/// cuts loose: exactly one of `scan`, `labels` and `surfaces`.
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
    /// Beside a scan: a surface scan of the face, which takes the place of the skin of the CT.
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
    pub thresholds_hu: HounsfieldThresholdsDocument,
    /// Absent: no bone is cut, and all of it is fixed that is no segment already.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub osteotomy: Option<OsteotomyDocument>,
    /// The frame of the osteotomy, and of surfaces whose files name none. Default: LPS where the scan or the surfaces say
    /// how they lie, whichever way they are stored; else the axes of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub frame: Option<FrameName>,
    #[serde(default)]
    pub size: MeshSizeDocument,
    /// Absent: all of the head that the scan shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<RegionDocument>,
    /// Whether nodes may share a place, where tissue touches itself at a point or along an edge. Gmsh and TetGen read a mesh
    /// only where none do; the surfaces are then apart by a little.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub coincident_nodes: bool,
    /// Whether tissue is fixed where the scan ends.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub scan_ends_fixed: bool,
    /// Whether tissue slides on the teeth of segments and their mucosa. Where it does not, it is joined to them.
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
            thresholds_hu: HounsfieldThresholdsDocument::default(),
            osteotomy: None,
            frame: None,
            size: MeshSizeDocument::default(),
            region: None,
            coincident_nodes: yes(),
            scan_ends_fixed: yes(),
            teeth_slide: yes(),
            budget: BudgetDocument::default(),
            tags: Vec::new(),
        }
    }
}

/// Values between which an image shows soft tissue, in Hounsfield units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HounsfieldThresholdsDocument {
    /// Below this there is air.
    #[serde(default = "usual_skin")]
    #[schema(default = -300.0)]
    pub skin: f64,
    /// From this on there is bone.
    #[serde(default = "usual_bone")]
    #[schema(default = 250.0)]
    pub bone: f64,
}

fn usual_skin() -> f64 {
    ImageOptions::default().skin_threshold
}

fn usual_bone() -> f64 {
    ImageOptions::default().bone_threshold
}

impl Default for HounsfieldThresholdsDocument {
    fn default() -> Self {
        HounsfieldThresholdsDocument { skin: usual_skin(), bone: usual_bone() }
    }
}

/// How fine the mesh is: about so many tetrahedra, or cells of a length; fine around segments, coarse far from them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshSizeDocument {
    /// Default: 300000, where no length is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1000, maximum = 4000000)]
    pub tetrahedra: Option<u64>,
    /// The edge of the finest cubes of the lattice, in mm; each holds twelve tetrahedra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.5, maximum = 50.0)]
    pub finest_mm: Option<f64>,
    /// How many times as large cells may be far from segments.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1.0, maximum = 16.0)]
    pub coarsening: Option<f64>,
}

/// The part of the head that is meshed. Tissue beyond it is left out, and what remains ends there as where the scan ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionDocument {
    /// All tissue this near to segments of the osteotomy, in mm, and little beyond.
    #[schema(minimum = 10.0, maximum = 300.0)]
    pub around_segments_mm: f64,
}

/// Where nothing else is said.
const USUAL_TETRAHEDRA: u64 = 300_000;
/// Uniform at first: the estimate of the size of a mesh is best there.
const USUAL_COARSENING: f64 = 4.0;

impl MeshingDocument {
    /// Every mesh that it names, with its place in the document that stands at a place.
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

    /// The rules of the path for a scan or surfaces in that frame; pointers start at `/spec`.
    pub fn to_rules(&self, scan: Frame, limits: &Limits, faults: &mut Faults) -> AnatomyRules {
        let at = Pointer::root().key("spec");
        let HounsfieldThresholdsDocument { skin, bone } = self.thresholds_hu;
        let thresholds = at.key("thresholds_hu");
        faults.check_range(&thresholds.key("skin"), skin, -1e6..=1e6, "HU");
        faults.check_range(&thresholds.key("bone"), bone, -1e6..=1e6, "HU");
        if skin >= bone {
            let detail =
                format!("tissue lies between {skin} HU and {bone} HU, which has to be larger");
            faults.add(&thresholds, ErrorCode::OutOfRange, detail);
        }
        self.budget.check(&at.key("budget"), limits, faults);
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        self.check_skin_scan(&at, limits, faults);
        self.check_labels(&at, limits, faults);
        self.check_surfaces(&at, limits, faults);
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
        let meshing = self.size.to_settings(&at.key("size"), limits, faults);
        let image =
            ImageOptions { skin_threshold: skin, bone_threshold: bone, ..ImageOptions::default() };
        AnatomyRules {
            image,
            band_mm: planned.as_ref().map_or(0.0, |planned| planned.free_band_mm),
            closing,
            osteotomy: planned.map(|planned| planned.osteotomy).unwrap_or_default(),
            meshing: MeshingSettings { part_copies: !self.coincident_nodes, ..meshing },
            around_segments_mm,
            scan_ends_fixed: self.scan_ends_fixed,
            teeth_slide: self.teeth_slide,
            frame: scan,
        }
    }

    fn check_skin_scan(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(skin) = &self.skin_scan else { return };
        let at = at.key("skin_scan");
        skin.check(&at, limits, faults);
        if self.scan.is_none() {
            let detail = "a surface scan takes the place of the skin of a CT, and there is no `scan`; between surfaces it is `surfaces.skin` itself";
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
        let mirrored_axes = self.frame.is_some_and(|frame| Frame::from(frame) != scan);
        let context = MovementContext { mirrored_axes, centre: None, limits };
        let at = at.key("skin_scan").key("jaw");
        jaw.to_closing(&at, osteotomy.unwrap_or(&none), &context, faults)
    }

    fn check_labels(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(labels) = &self.labels else { return };
        labels.check(&at.key("labels"), limits, faults);
        self.check_without_scan(at, "a label map has no values that thresholds part", faults);
        if self.osteotomy.is_some() && !labels.segments().is_empty() {
            let detail = "bone of `labels` that has a name is a segment already: leave the names out to have it cut";
            faults.add(&at.key("osteotomy"), ErrorCode::OneOf, detail);
        }
    }

    /// Refuses what only a scan has.
    fn check_without_scan(&self, at: &Pointer, detail: &str, faults: &mut Faults) {
        if self.thresholds_hu != HounsfieldThresholdsDocument::default() {
            faults.add(&at.key("thresholds_hu"), ErrorCode::NoScan, detail);
        }
        if self.region.is_some() {
            let detail = "only what a scan shows is meshed in part";
            faults.add(&at.key("region"), ErrorCode::NoScan, detail);
        }
    }

    fn check_surfaces(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(surfaces) = &self.surfaces else { return };
        surfaces.check(&at.key("surfaces"), limits, faults);
        self.check_without_scan(at, "surfaces have no values that thresholds part", faults);
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

    /// What decides the mesh, for the hash: no tags, no budget.
    pub fn content(&self) -> Value {
        let mut plain = self.clone();
        plain.tags.clear();
        plain.budget = BudgetDocument::default();
        canonical::to_value(&plain)
    }
}

impl MeshSizeDocument {
    fn to_settings(self, at: &Pointer, limits: &Limits, faults: &mut Faults) -> MeshingSettings {
        let coarsening = self.coarsening.unwrap_or(USUAL_COARSENING);
        faults.check_range(&at.key("coarsening"), coarsening, 1.0..=16.0, "");
        let finest = self.finest_mm.unwrap_or(2.0);
        faults.check_range(&at.key("finest_mm"), finest, 0.5..=50.0, "mm");
        let tetrahedra = match (self.tetrahedra, self.finest_mm) {
            (None, None) => Some(USUAL_TETRAHEDRA),
            (tetrahedra, _) => tetrahedra,
        };
        if let Some(tetrahedra) = tetrahedra {
            let most = limits.mesh_cells as f64;
            faults.check_range(&at.key("tetrahedra"), tetrahedra as f64, 1e3..=most, "");
            faults.check_one_of(
                at,
                1 + usize::from(self.finest_mm.is_some()),
                "`tetrahedra`, `finest_mm`",
            );
        }
        MeshingSettings {
            size: SizeField::graded(finest, finest * coarsening),
            target: tetrahedra.map(|count| count as usize),
            most_tetrahedra: limits.mesh_cells as usize,
            ..MeshingSettings::default()
        }
    }
}
