//! Reference solutions of a study.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::compare::align::{AlignDocument, AlignMethod, AlignReference, align};
use crate::schema::methods::ElementName;
use crate::schema::predict::result::ProvenanceDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::prediction::{MethodKind, Rung};
use mechanics::study::Strain;

/// Each further level multiplies the cells by eight.
const MOST_LEVEL: u32 = 4;

/// Of a spline.
const FEWEST_LANDMARKS: usize = 5;

/// No skin moves farther, in mm.
const FARTHEST_MM: f64 = 100.0;

/// The truth (reference): exactly one of `refine` with `element`, `closed_form`, `job`, and `mesh` with `align`,
/// `moved_by_more_than_mm`, `metric` with `landmarks_mm`, and `noise_mm`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TruthDocument {
    /// Finite elements with every edge of level 0 halved this many times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0, maximum = 4)]
    pub refine: Option<u32>,
    /// Of `refine`. Default: of `fem_linear` `quadratic` if all cells are tetrahedra, else `mean_dilatation`; of
    /// `fem_nonlinear` the usual one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub element: Option<ElementName>,
    /// Of `refine`. A linear reference is wrong for large movements. Default: `fem_linear`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub method: Option<TruthMethodName>,
    /// The formula of the scene; `true` or absent.
    #[serde(default, skip_serializing_if = "is_false")]
    pub closed_form: bool,
    /// The skin that this job predicted, for a study of one case with one plan and one material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// A surface of the skin of one case after one plan, such as a scan after the operation: errors
    /// are distances between it and the predicted skin, both ways, where the skin moves and both exist.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh: Option<String>,
    /// Of `mesh` onto the skin of the case, by anything but `icp`, which would remove the differences between
    /// results. Default: `none`.
    #[serde(default, skip_serializing_if = "is_default", deserialize_with = "align")]
    #[schema(value_type = AlignReference, required = false)]
    pub align: AlignDocument,
    /// Of `mesh`: only skin counts that some result moves by more than this. Default: 0.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 100.0)]
    pub moved_by_more_than_mm: Option<f64>,
    /// Of `mesh`: the distance of a result from it. Default: `both`.
    #[serde(default, skip_serializing_if = "is_both")]
    pub metric: TruthMetric,
    /// Of `mesh` with a `metric` of `tps_cp`, by their names in the case: their positions on the scan, before alignment.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks_mm: BTreeMap<String, Triple>,
    /// Of `mesh`: root mean square distance left by its registration. Default: that of `align` if it
    /// fits `surfaces` or `landmarks`, else unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 100.0)]
    pub noise_mm: Option<f64>,
}

/// The distance of a result from a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TruthMetric {
    /// Closest points, from the skin to the scan and back.
    #[default]
    Both,
    /// Corresponding points: by the node ids of both, or in their order if the triangles are the same.
    NodeWise,
    /// Thin-plate spline of landmarks and closest point: from a point of the skin to that of the scan which is closest to where the
    /// spline takes it.
    TpsCp,
}

fn is_both(metric: &TruthMetric) -> bool {
    *metric == TruthMetric::Both
}

/// The method of a computed reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TruthMethodName {
    FemLinear,
    /// At finite strain, each tissue with its law.
    FemNonlinear,
}

impl TruthMethodName {
    /// That of a prediction, by its provenance: the model that `auto` chose, or else the method.
    pub fn of(provenance: &ProvenanceDocument) -> Option<Self> {
        let named = |name: &String| Rung::ALL.into_iter().find(|rung| rung.name() == name);
        let chosen = provenance.model.as_ref().and_then(named).map(Strain::of_rung);
        let named = |name: &String| MethodKind::ALL.iter().find(|kind| kind.name() == name);
        let stated = || provenance.method.as_ref().and_then(named).map(|kind| Strain::of(*kind));
        chosen.or_else(stated).map(|strain| match strain {
            Strain::Small => TruthMethodName::FemLinear,
            Strain::Finite => TruthMethodName::FemNonlinear,
        })
    }

    pub fn strain(self) -> Strain {
        match self {
            TruthMethodName::FemLinear => Strain::Small,
            TruthMethodName::FemNonlinear => Strain::Finite,
        }
    }
}

fn is_false(value: &bool) -> bool {
    !value
}

fn is_default(align: &AlignDocument) -> bool {
    *align == AlignDocument::default()
}

impl TruthDocument {
    /// Adds its faults, except those that need scenes and meshes.
    pub(super) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let forms =
            [self.refine.is_some(), self.closed_form, self.job.is_some(), self.mesh.is_some()];
        let given = forms.into_iter().filter(|&form| form).count();
        faults.check_one_of(at, given, "`refine`, `closed_form`, `job`, `mesh`");
        let of_refine = [("element", self.element.is_some()), ("method", self.method.is_some())];
        for (name, _) in of_refine.into_iter().filter(|(_, given)| *given && self.refine.is_none())
        {
            faults.add(
                &at.key(name),
                ErrorCode::WrongType,
                format!("`{name}` belongs to `refine`"),
            );
        }
        let refine = f64::from(self.refine.unwrap_or_default());
        faults.check_range(&at.key("refine"), refine, 0.0..=f64::from(MOST_LEVEL), "");
        let of_mesh = [
            ("align", !is_default(&self.align)),
            ("moved_by_more_than_mm", self.moved_by_more_than_mm.is_some()),
            ("noise_mm", self.noise_mm.is_some()),
            ("metric", !is_both(&self.metric)),
            ("landmarks_mm", !self.landmarks_mm.is_empty()),
        ];
        for (name, _) in of_mesh.into_iter().filter(|(_, given)| *given && self.mesh.is_none()) {
            let detail = format!("`{name}` belongs to `mesh`");
            faults.add(&at.key(name), ErrorCode::WrongType, detail);
        }
        let (place, count) = (at.key("landmarks_mm"), self.landmarks_mm.len());
        faults.check_length(&place, count, limits.map_entries as usize);
        match (self.metric, count) {
            (TruthMetric::TpsCp, 0..FEWEST_LANDMARKS) => {
                let detail = format!(
                    "a thin-plate spline needs {FEWEST_LANDMARKS} landmarks, not coplanar, here are {count}; four of them fit \
                     every affine map, so that a wrong one would not be detected"
                );
                faults.add(&place, ErrorCode::AlignmentFailed, detail);
            }
            (TruthMetric::TpsCp, _) | (_, 0) => {}
            (TruthMetric::Both | TruthMetric::NodeWise, _) => {
                let detail = "landmarks are read where `metric` is `tps_cp`";
                faults.add(&place, ErrorCode::UnknownField, detail);
            }
        }
        self.align.check(&at.key("align"), limits, faults);
        if self.align.method == AlignMethod::Icp {
            let detail = "fitted to each result the scan shows no difference between them: align it by `surfaces`, \
                          such as bone, by `landmarks` or by a `matrix`";
            faults.add(&at.key("align").key("method"), ErrorCode::AlignmentFailed, detail);
        }
        let lengths =
            [("moved_by_more_than_mm", self.moved_by_more_than_mm), ("noise_mm", self.noise_mm)];
        for (name, length) in lengths {
            faults.check_range(&at.key(name), length.unwrap_or(0.0), 0.0..=FARTHEST_MM, "mm");
        }
    }

    /// Every mesh that it names, with its place.
    pub fn mesh_references_mut(&mut self, at: &Pointer) -> Vec<(Pointer, &mut String)> {
        let mut found: Vec<(Pointer, &mut String)> =
            self.mesh.as_mut().map(|mesh| (at.key("mesh"), mesh)).into_iter().collect();
        found.extend(self.align.surfaces_mut(&at.key("align")));
        found
    }
}
