//! Result of a meshing.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::cuts::CutPathDocument;
use super::skin_scan::FittedScanDocument;
use super::thresholds::HounsfieldThresholdsDocument;
use crate::schema::Triple;
use crate::schema::case::document::CaseDocument;
use crate::schema::predict::check::CheckDocument;
use mechanics::anatomy::Anatomy;
use mechanics::mesh::enclosed::Enclosed;
use mechanics::meshing::{Angles, Gap, LostPiece};
use mechanics::osteotomy::labelling::FoundSegment;

/// A mesh made from a scan, and a case of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshingResultDocument {
    pub nodes: u64,
    pub tetrahedra: u64,
    pub volume_ml: f64,
    /// The edge of the finest cubes of the lattice.
    pub finest_mm: f64,
    pub dihedral_angles_deg: AnglesDocument,
    pub segments: Vec<FoundSegmentDocument>,
    /// Of a scan: the thresholds between air, tissue and bone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub thresholds_hu: Option<HounsfieldThresholdsDocument>,
    /// Cuts through their bone, for navigation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cuts: Vec<CutPathDocument>,
    /// The registration of the surface scan that is the skin, and its fit to that of the CT.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin_scan: Option<FittedScanDocument>,
    /// The number of nodes in each node set.
    pub node_sets: BTreeMap<String, u64>,
    /// Nodes on bone that are free because neighbours move differently.
    pub free_beside_cuts: u64,
    /// Gaps thinner than a cell that were filled with tissue, such as closed lips; the largest first.
    pub gaps_closed: Vec<GapDocument>,
    /// Tissue thinner than a cell that the mesh lacks, in connected pieces; the largest first.
    pub sheets_lost: Vec<LostSheetDocument>,
    /// Landmarks of the skin, detected or stated, in mm: `pogonion`, `sublabiale`, `subnasale`, `pronasale`. Empty where none were
    /// found.
    #[serde(default)]
    pub landmarks_mm: BTreeMap<String, Triple>,
    /// Disconnected tissue that was omitted.
    pub dropped_ml: f64,
    /// A case of the mesh, ready to be stored and predicted on.
    pub case: CaseDocument,
    /// Its boundary conditions before any segment moves, if a stored case waits for the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub check: Option<CheckDocument>,
}

/// Angles between the faces of tetrahedra, in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AnglesDocument {
    pub smallest: f64,
    /// The 0.1 % quantile.
    pub thousandth: f64,
    /// The 1 % quantile.
    pub hundredth: f64,
    pub largest: f64,
}

/// A segment found in the bone of the scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FoundSegmentDocument {
    pub name: String,
    /// What its surface encloses; of a bone that was given as a surface without what belongs to a bone that lies in it.
    pub volume_ml: f64,
    /// The centre of mass of what `volume_ml` counts.
    pub centre_mm: Triple,
    /// Bone on its sides of the cuts that is not connected with it, by voxels.
    pub left_ml: f64,
}

/// Tissue in no cell, because cells are too large there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LostSheetDocument {
    /// The place of it that is nearest to its middle.
    pub centre_mm: Triple,
    /// Along x, y and z.
    pub extent_mm: Triple,
    #[serde(default)]
    pub volume_ml: f64,
}

/// Air that is tissue in the mesh, because cells are too large there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct GapDocument {
    pub centre_mm: Triple,
    /// Along x, y and z.
    pub extent_mm: Triple,
    /// Edges of the lattice that cross it.
    pub edges: u64,
}

const MM3_IN_ML: f64 = 1000.0;

impl MeshingResultDocument {
    pub fn new(anatomy: &Anatomy, case: CaseDocument) -> Self {
        let report = &anatomy.meshing;
        let [x, y, z] = anatomy.bone.labels.placement().steps;
        let voxel = x.dot(&y.cross(&z)).abs();
        let segment = |(found, solid): (&FoundSegment, &Enclosed)| FoundSegmentDocument {
            name: found.name.clone(),
            volume_ml: solid.volume_mm3 / MM3_IN_ML,
            centre_mm: solid.centre.into(),
            left_ml: found.left.voxels as f64 * voxel / MM3_IN_ML,
        };
        let sets = anatomy.volume.node_sets.iter();
        MeshingResultDocument {
            nodes: report.nodes as u64,
            tetrahedra: report.tetrahedra as u64,
            volume_ml: report.volume / MM3_IN_ML,
            finest_mm: report.finest,
            dihedral_angles_deg: (&report.angles).into(),
            segments: anatomy.bone.segments.iter().zip(&anatomy.solids).map(segment).collect(),
            thresholds_hu: None,
            cuts: Vec::new(),
            skin_scan: None,
            node_sets: sets.map(|(name, nodes)| (name.clone(), nodes.len() as u64)).collect(),
            free_beside_cuts: anatomy.classes.in_band as u64,
            gaps_closed: report.gaps_closed.iter().map(GapDocument::from).collect(),
            sheets_lost: report.pieces_lost.iter().map(LostSheetDocument::from).collect(),
            landmarks_mm: (anatomy.landmarks.iter())
                .map(|(name, &place)| (name.clone(), place.into()))
                .collect(),
            dropped_ml: report.dropped_volume() / MM3_IN_ML,
            case,
            check: None,
        }
    }
}

impl From<&Angles> for AnglesDocument {
    fn from(angles: &Angles) -> Self {
        AnglesDocument {
            smallest: angles.smallest,
            thousandth: angles.thousandth,
            hundredth: angles.hundredth,
            largest: angles.largest,
        }
    }
}

impl From<&LostPiece> for LostSheetDocument {
    fn from(piece: &LostPiece) -> Self {
        LostSheetDocument {
            centre_mm: piece.at.into(),
            extent_mm: (piece.high - piece.low).into(),
            volume_ml: piece.volume / MM3_IN_ML,
        }
    }
}

impl From<&Gap> for GapDocument {
    fn from(gap: &Gap) -> Self {
        GapDocument {
            centre_mm: gap.centre.into(),
            extent_mm: (gap.high - gap.low).into(),
            edges: gap.edges as u64,
        }
    }
}
