//! Variants of a study: scenes with plans and a truth, crossed with methods, materials and mesh levels.

use std::collections::{BTreeMap, BTreeSet};

use crate::material::LinearElastic;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh};
use crate::prediction::{
    Accepted, Case, ElementChoice, FibreDirection, Growth, Laws, Method, MethodKind, Plan, Rung,
    Settings,
};
use crate::validation::{Alignment, LandmarkPair};

/// Every scene with every variant, or with its own, and with every material, plan and level.
pub struct Study {
    pub scenes: Vec<StudyScene>,
    pub variants: Vec<Variant>,
    /// The scenes and variants that belong together, by their places; all with all where there is none.
    pub pairs: BTreeSet<(usize, usize)>,
    /// Level n halves every edge n times.
    pub levels: Vec<u32>,
    /// Solves of each row, of which the median time is reported; at least 1. Rows that take long are solved
    /// less often: see [`super::report::Solved::repeats`].
    pub repeats: usize,
    /// No row is begun once the study has taken this long, in s; infinite where it may take its time.
    pub budget_s: f64,
    /// A solve that takes longer is given up, in s; infinite where it may take its time.
    pub row_s: f64,
}

impl Study {
    /// The variants that a scene is solved with.
    pub fn variants_of(&self, scene: usize) -> impl Iterator<Item = &Variant> {
        let all = self.pairs.is_empty();
        let variants = self.variants.iter().enumerate();
        let own = variants.filter(move |(at, _)| all || self.pairs.contains(&(scene, *at)));
        own.map(|(_, variant)| variant)
    }
}

/// A case with the plans that move it, and what is held for true.
pub struct StudyScene {
    pub name: String,
    pub case: Case,
    /// At least one, each with its name.
    pub plans: Vec<(String, Plan)>,
    /// At least one.
    pub materials: Vec<Materials>,
    pub truth: Truth,
}

/// Materials of all regions, under a name for the row.
#[derive(Clone, Default)]
pub struct Materials {
    pub name: String,
    pub by_region: BTreeMap<String, LinearElastic>,
    /// Courses of fibres over those of the case.
    pub fibres: BTreeMap<String, FibreDirection>,
    /// Of tissues that an image shows, over those of the case, by their names.
    pub tissues: BTreeMap<String, LinearElastic>,
    /// Changes of volume by region, over those of a plan; `*` over all of them.
    pub growth: Vec<Growth>,
}

impl StudyScene {
    /// Its plans as they are of some materials.
    pub(super) fn plans_of(&self, materials: &Materials) -> Vec<(String, Plan)> {
        self.plans.iter().map(|(name, plan)| (name.clone(), materials.plan(plan))).collect()
    }
}

impl Materials {
    /// A plan with the changes of volume of these.
    pub(super) fn plan(&self, plan: &Plan) -> Plan {
        let is_of =
            |other: &Growth, own: &Growth| other.region == "*" || other.region == own.region;
        let is_own = |own: &Growth| self.growth.iter().any(|other| is_of(other, own));
        let mut plan = plan.clone();
        plan.growth.retain(|own| !is_own(own));
        plan.growth.extend(self.growth.iter().cloned());
        plan
    }
}

/// A model under a name for the row.
#[derive(Clone)]
pub struct Variant {
    /// The method as documents call it.
    pub method: String,
    /// What tells this variant from others of the same method; the method where nothing does.
    pub label: String,
    pub settings: Settings,
    /// The error that chooses the model, where the settings are those of its cheapest one (`predict_adequately`); its time is
    /// that of a row.
    pub accepted: Option<Accepted>,
    /// Whether a failure says nothing against a study: only of the program's own variants, whatever a client's are
    /// called.
    pub may_fail: bool,
}

/// Where the displacement that errors are measured against comes from.
pub enum Truth {
    ClosedForm(ClosedForm),
    /// Finite elements on the mesh of level 0 with every edge halved `times` times.
    Refined {
        times: u32,
        /// One that the method of this strain has.
        element: ElementChoice,
        strain: Strain,
    },
    /// A displacement from elsewhere.
    Known {
        /// In mm, at each skin node of level 0.
        displacement: Vec<Vector>,
        /// None where it is not known what it takes for strain.
        strain: Option<Strain>,
    },
    /// A surface that shows where the skin went, but not which point went where.
    Scan(Box<Scan>),
}

/// Strain measure of a reference solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strain {
    /// Linear finite elements: no truth where movements are large.
    #[default]
    Small,
    /// Nonlinear finite elements, each tissue with its law.
    Finite,
}

/// A scanned surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    pub surface: TriangleSurface,
    /// Onto the skin of the case. By anything but that skin itself: a scan that is fitted to each answer shows no
    /// difference between them.
    pub alignment: Alignment,
    /// Only triangles of the skin count that an answer moves by more than this in the mean of their corners, in mm.
    pub moved_by_more_than: f64,
    /// Root of the mean squared distance that the registration left, in mm. Default: what the alignment leaves.
    pub noise: Option<f64>,
    pub metric: ScanMetric,
}

/// How the distance of an answer from a scan is measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ScanMetric {
    /// Closest points, both ways.
    #[default]
    BothWays,
    /// Of points of the same number: the scan has the points of the skin.
    NodeWise,
    /// By thin-plate spline and closest point ([`crate::validation::warped_distances`]): landmarks at rest on the skin of the case, which go
    /// with each answer, and where the scan has them before it is aligned, in mm.
    Landmarks(Vec<LandmarkPair>),
}

/// A formula of linear elasticity, and the walls between which it holds.
pub struct ClosedForm {
    /// In mm at a point of the scene, for a plan and materials of the scene.
    pub displacement: fn(&Vector, &Plan, &Materials) -> Vector,
    /// Brings the nodes of a refined mesh onto the walls: new nodes lie on chords of curved ones.
    pub walls: fn(&mut VolumeMesh),
}

impl Strain {
    /// Finite where a method has laws of finite strain.
    pub fn of(method: MethodKind) -> Self {
        match method.properties().laws {
            Laws::AtRest => Strain::Small,
            Laws::SaintVenantKirchhoff | Laws::Any => Strain::Finite,
        }
    }

    /// That of an answer with an estimate of what linearity leaves out, or without.
    pub fn of_rung(rung: Rung) -> Self {
        match rung {
            Rung::Linear | Rung::Corrected => Strain::Small,
            Rung::SecondOrder
            | Rung::SecondOrderCorrected
            | Rung::FiniteStrain
            | Rung::FiniteStrainCorrected => Strain::Finite,
        }
    }

    /// The method of finite elements with this strain.
    pub fn method(self) -> Method {
        match self {
            Strain::Small => Method::FemLinear,
            Strain::Finite => Method::FemNonlinear,
        }
    }
}

impl Truth {
    /// What it takes for strain; none of surfaces from elsewhere, and of displacements from elsewhere where that is not known.
    pub fn strain(&self) -> Option<Strain> {
        match self {
            Truth::ClosedForm(_) => Some(Strain::Small),
            Truth::Refined { strain, .. } => Some(*strain),
            Truth::Known { strain, .. } => *strain,
            Truth::Scan(_) => None,
        }
    }
}
