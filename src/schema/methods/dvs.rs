//! Dynamic volume spline: parameters and description. Times in s, stiffness in N/m.

use serde::{Deserialize, Serialize};
use serde_json::json;
use utoipa::ToSchema;

use super::document::{Description, ParameterDocument, parameter};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::spline::stepping::{Clock, Damping, Scheme};
use mechanics::model::spline::{Bone, ControlPoints, Stiffness, VolumeSpline};

/// The most steps within `duration_s`.
const MOST_STEPS: f64 = 1e6;

/// Along one axis.
const MOST_CONTROL_POINTS: f64 = 200.0;

/// Defaults of the lattice in N/m and N s/m (Ulusoy et al. 2010; docs/methods.md#volume-spline).
const LINK_STIFFNESS: f64 = 80.0;
const LINK_DAMPING: f64 = 1.0;

/// The coupling of control points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DvsStiffness {
    /// The elasticity of the tissue, from the materials of its regions.
    #[default]
    Galerkin,
    /// Equal links between neighbouring control points; materials are ignored except density, and rotation
    /// is resisted.
    Lattice,
}

/// The coupling of bone and spline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DvsBone {
    /// Springs pull constrained nodes to their prescribed positions.
    #[default]
    Springs,
    /// The control points nearest to constrained nodes are bone and move with these, by K_ff C_f = -K_fb C_b; `static` only.
    ControlPoints,
}

/// How equilibrium is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DvsStepping {
    /// Directly, without time steps.
    #[default]
    Static,
    /// First order, with damping of all modes.
    BackwardEuler,
    /// Second order, beta 1/4, gamma 1/2.
    Newmark,
    /// Symplectic Euler with lumped masses; refused above its stability limit.
    Explicit,
}

/// Parameters of the dynamic volume spline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DvsDocument {
    #[serde(default)]
    pub stiffness: DvsStiffness,
    /// Of the B-splines along every axis: 2 or 3.
    #[serde(default = "cubic")]
    #[schema(default = 3, minimum = 2, maximum = 3)]
    pub degree: u32,
    /// Spacing of control points along the principal axes of the tissue. Default: the finest of at least 1.5
    /// mean edges of the mesh with at most 4000 control points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.1, maximum = 1000.0)]
    pub control_spacing_mm: Option<f64>,
    /// Of the B-splines along each principal axis of the tissue, the longest first, 1 to 3 each, in place of `degree`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, min_items = 3, max_items = 3)]
    pub degrees: Option<[u32; 3]>,
    /// The number of control points along each principal axis of the tissue, the longest first, in place of
    /// `control_spacing_mm`: more than its degree, and 200 at most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, min_items = 3, max_items = 3)]
    pub control_points: Option<[u32; 3]>,
    #[serde(default)]
    pub bone: DvsBone,
    /// Penalty stiffness of fixed and moved nodes, relative to the tissue around a control point. A large one brings
    /// constrained nodes nearer to their prescribed positions, with less freedom beside them.
    #[serde(default = "default_hold")]
    #[schema(default = 5.0, minimum = 1.0, maximum = 1e6)]
    pub hold_weight: f64,
    #[serde(default)]
    pub stepping: DvsStepping,
    /// Time step. Default 0.01; only if `stepping` is not `static`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 10.0)]
    pub step_s: Option<f64>,
    /// Time at which the tissue has to be in equilibrium. Default 10; only if `stepping` is not `static`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-6, maximum = 1000.0)]
    pub duration_s: Option<f64>,
    /// Of a link between control points. Default 80; `lattice` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-3, maximum = 1e6)]
    pub stiffness_n_per_m: Option<f64>,
    /// Of a link between control points. Default 1; `lattice` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 1e6)]
    pub damping_n_s_per_m: Option<f64>,
    /// d_M of D = d_M M + d_K K. Default 0; `galerkin` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 1e6)]
    pub mass_damping_per_s: Option<f64>,
    /// d_K of D = d_M M + d_K K. Default 0.0125; `galerkin` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 1000.0)]
    pub stiffness_damping_s: Option<f64>,
}

fn cubic() -> u32 {
    3
}

fn default_hold() -> f64 {
    VolumeSpline::default().hold_weight
}

impl Default for DvsDocument {
    fn default() -> Self {
        DvsDocument {
            stiffness: DvsStiffness::Galerkin,
            degree: cubic(),
            control_spacing_mm: None,
            degrees: None,
            control_points: None,
            bone: DvsBone::Springs,
            hold_weight: default_hold(),
            stepping: DvsStepping::Static,
            step_s: None,
            duration_s: None,
            stiffness_n_per_m: None,
            damping_n_s_per_m: None,
            mass_damping_per_s: None,
            stiffness_damping_s: None,
        }
    }
}

impl DvsDocument {
    /// The method of the numerics.
    pub fn to_method(self, at: &Pointer, faults: &mut Faults) -> VolumeSpline {
        self.check(at, faults);
        let stiffness = match self.stiffness {
            DvsStiffness::Galerkin => Stiffness::Galerkin,
            DvsStiffness::Lattice => {
                Stiffness::Lattice(self.stiffness_n_per_m.unwrap_or(LINK_STIFFNESS))
            }
        };
        VolumeSpline {
            degrees: self.degrees().map(|degree| degree as usize),
            control: match (self.control_points, self.control_spacing_mm) {
                (Some(counts), _) => ControlPoints::Counted(counts.map(|count| count as usize)),
                (None, Some(spacing)) => ControlPoints::Spaced(spacing),
                (None, None) => ControlPoints::Chosen,
            },
            bone: match self.bone {
                DvsBone::Springs => Bone::Springs,
                DvsBone::ControlPoints => Bone::ControlPoints,
            },
            hold_weight: self.hold_weight,
            damping: self.damping(&stiffness),
            stiffness,
            clock: self.clock(at, faults),
        }
    }

    fn degrees(&self) -> [u32; 3] {
        self.degrees.unwrap_or([self.degree; 3])
    }

    fn check_lattice(&self, at: &Pointer, faults: &mut Faults) {
        faults.check_range(&at.key("degree"), f64::from(self.degree), 2.0..=3.0, "");
        let degrees = self.degrees();
        if self.degrees.is_some() {
            if self.degree != cubic() {
                faults.check_one_of(at, 2, "`degree`, `degrees`");
            }
            for (axis, degree) in degrees.into_iter().enumerate() {
                let place = at.key("degrees").index(axis);
                faults.check_range(&place, f64::from(degree), 1.0..=3.0, "");
            }
        }
        if let Some(counts) = self.control_points {
            if self.control_spacing_mm.is_some() {
                faults.check_one_of(at, 2, "`control_points`, `control_spacing_mm`");
            }
            for (axis, (count, degree)) in counts.into_iter().zip(degrees).enumerate() {
                let place = at.key("control_points").index(axis);
                let least = f64::from(degree) + 1.0;
                faults.check_range(&place, f64::from(count), least..=MOST_CONTROL_POINTS, "");
            }
        }
        if self.bone == DvsBone::ControlPoints && self.stepping != DvsStepping::Static {
            let detail = "control points of bone need `stepping` `static`";
            faults.add(&at.key("bone"), ErrorCode::MethodMismatch, detail);
        }
    }

    /// In ms; links of stiffness k and damping d have D = d/k K.
    fn damping(&self, stiffness: &Stiffness) -> Damping {
        match stiffness {
            Stiffness::Galerkin => {
                let usual = VolumeSpline::default().damping;
                let of_stiffness = self.stiffness_damping_s.map(|damping| damping * 1e3);
                Damping {
                    mass: self.mass_damping_per_s.map_or(usual.mass, |damping| damping / 1e3),
                    stiffness: of_stiffness.unwrap_or(usual.stiffness),
                }
            }
            Stiffness::Lattice(links) => {
                let damping = self.damping_n_s_per_m.unwrap_or(LINK_DAMPING);
                Damping { mass: 0.0, stiffness: 1e3 * damping / links }
            }
        }
    }

    fn clock(&self, at: &Pointer, faults: &mut Faults) -> Option<Clock> {
        let scheme = match self.stepping {
            DvsStepping::Static => return None,
            DvsStepping::BackwardEuler => Scheme::BackwardEuler,
            DvsStepping::Newmark => Scheme::Newmark,
            DvsStepping::Explicit => Scheme::Explicit,
        };
        let (step, end) = (self.step_s.unwrap_or(0.01), self.duration_s.unwrap_or(10.0));
        let steps = end / step;
        if steps > MOST_STEPS {
            let detail =
                format!("{end} s in steps of {step} s are {steps:.0} steps, above {MOST_STEPS:.0}");
            faults.add(&at.key("step_s"), ErrorCode::OutOfRange, detail);
        }
        Some(Clock { scheme, step: step * 1e3, end: end * 1e3 })
    }

    fn check(&self, at: &Pointer, faults: &mut Faults) {
        self.check_lattice(at, faults);
        faults.check_range(&at.key("hold_weight"), self.hold_weight, 1.0..=1e6, "");
        let is_lattice = self.stiffness == DvsStiffness::Lattice;
        let moves = self.stepping != DvsStepping::Static;
        let spacing = self.control_spacing_mm;
        let optional = [
            ("control_spacing_mm", spacing, 0.1..=1000.0, "mm", true, ""),
            ("step_s", self.step_s, 1e-9..=10.0, "s", moves, "a `stepping` in time"),
            ("duration_s", self.duration_s, 1e-6..=1000.0, "s", moves, "a `stepping` in time"),
            ("stiffness_n_per_m", self.stiffness_n_per_m, 1e-3..=1e6, "N/m", is_lattice, LATTICE),
            ("damping_n_s_per_m", self.damping_n_s_per_m, 0.0..=1e6, "N s/m", is_lattice, LATTICE),
            (
                "mass_damping_per_s",
                self.mass_damping_per_s,
                0.0..=1e6,
                "1/s",
                !is_lattice,
                GALERKIN,
            ),
            (
                "stiffness_damping_s",
                self.stiffness_damping_s,
                0.0..=1e3,
                "s",
                !is_lattice,
                GALERKIN,
            ),
        ];
        for (name, value, range, unit, has_use, user) in optional {
            let Some(value) = value else { continue };
            faults.check_range(&at.key(name), value, range, unit);
            if !has_use {
                let detail = format!("`{name}` is for {user}, which this spec does not have");
                faults.add(&at.key(name), ErrorCode::MethodMismatch, detail);
            }
        }
    }
}

const LATTICE: &str = "`stiffness` `lattice`";
const GALERKIN: &str = "`stiffness` `galerkin`";

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "dynamic volume spline: B-splines over a lattice of control points",
        assumptions: &[
            "displacement is smooth, with continuous second derivatives for degree 3: steep changes beside the \
                edge of a bone are smeared over about two control spacings",
            "bone is between control points: constrained nodes are pulled to their positions, or the control points \
                nearest to them move instead; the warning `held-nodes-missed` has the remainder",
            "galerkin: small strain and linear elastic regions, without remedy for locking above a Poisson \
                ratio of 0.49; gaps narrower than a control spacing, such as between the lips, are bridged",
            "lattice: control points are connected by equal links, by component: tissue has no Poisson \
                ratio and no regions, and resists rotation, with the warning `rotation-resisted`",
            "equilibrium does not depend on mass and damping: time steps converge to that of `static`",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.dvs",
            "spec.materials",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: parameters(),
    }
}

fn parameters() -> Vec<ParameterDocument> {
    let chosen = "the finest of at least 1.5 mean edges that leaves at most 4000 control points";
    vec![
        parameter(
            "stiffness",
            "coupling of control points",
            json!("galerkin"),
            "galerkin | lattice",
        ),
        parameter("degree", "of the B-splines", json!(3), "2 | 3"),
        parameter("control_spacing_mm", "between control points", json!(chosen), "[0.1, 1000]"),
        parameter("degrees", "of each axis", json!("`degree`"), "1 to 3 each"),
        parameter(
            "control_points",
            "along each axis",
            json!("as many as `control_spacing_mm` says"),
            "above the degree, to 200",
        ),
        parameter(
            "bone",
            "springs that pull constrained nodes, or control points that move with them",
            json!("springs"),
            "springs | control_points",
        ),
        parameter(
            "hold_weight",
            "penalty stiffness of fixed and moved nodes, relative to the tissue at a control point",
            json!(5.0),
            "[1, 1e6]",
        ),
        parameter(
            "stepping",
            "time stepping; explicit steps above 4 / (c + sqrt(c^2 + 4 omega^2)) are refused, c the \
                damping and omega the frequency of the fastest mode",
            json!("static"),
            "static | backward_euler | newmark | explicit",
        ),
        parameter("step_s", "length of a step in time", json!(0.01), "[1e-9, 10]"),
        parameter("duration_s", "time of equilibrium", json!(10.0), "[1e-6, 1000]"),
        parameter("stiffness_n_per_m", "of a link, lattice only", json!(80.0), "[1e-3, 1e6]"),
        parameter("damping_n_s_per_m", "of a link, lattice only", json!(1.0), "[0, 1e6]"),
        parameter("mass_damping_per_s", "D = d_M M + d_K K, galerkin only", json!(0.0), "[0, 1e6]"),
        parameter("stiffness_damping_s", "the same", json!(0.0125), "[0, 1000]"),
    ]
}
