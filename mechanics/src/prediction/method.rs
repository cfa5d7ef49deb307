//! Methods: their names, their settings, and the one table of their properties.

use super::element_choice::{EVERY_SHAPE, ElementChoice, TETRAHEDRA};
use super::listed::listed;
use crate::material::LinearElastic;
use crate::material::hyperelastic::{Fibres, Law, SaintVenantKirchhoff};
use crate::mesh::CellShape;
use crate::model::fem::mass_tensor::MassTensorSettings;
use crate::model::mass_spring::MassSpringSettings;
use crate::model::spline::{Stiffness, VolumeSpline};
use crate::model::thickness_warp::ThicknessWarp;

listed! {
    /// A model, without what it has to be told; in the order of lists.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MethodKind {
        FemLinear,
        FemNonlinear,
        MassTensor,
        MassTensorTransverse,
        MassTensorNonlinear,
        MassSpring,
        VolumeSpline,
        ThicknessWarp,
    }
}

/// The model, with what only it has to be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Method {
    /// Linear finite elements at small strain.
    #[default]
    FemLinear,
    /// Hyperelastic finite elements at finite strain.
    FemNonlinear,
    /// Springs along the edges of tetrahedra.
    MassSpring(MassSpringSettings),
    /// The energy of plain linear tetrahedra, brought to rest as its settings say.
    MassTensor(MassTensorSettings),
    /// The mass-tensor of tetrahedra with fibres: force = V g_j.C.g_k u, the plain finite element, brought to rest as its
    /// settings say.
    MassTensorTransverse(MassTensorSettings),
    /// The mass-tensor with the full Green strain: Saint Venant-Kirchhoff tetrahedra.
    MassTensorNonlinear,
    /// A lattice of control points over the tissue.
    VolumeSpline(VolumeSpline),
    /// Tissue that rides on the nearest bone.
    ThicknessWarp(ThicknessWarp),
}

/// Entities that the unknowns of a method displace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknowns {
    /// Nodes of finite elements.
    Elements,
    /// Nodes tied by springs.
    Springs,
    /// Control points beside the mesh.
    ControlPoints,
    /// There are none: displacement follows from that of the bones.
    None,
}

/// Which laws of finite strain a method knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Laws {
    /// None: tissue is what its law is at rest.
    AtRest,
    /// That of Saint Venant and Kirchhoff, of the constants that any other one has at rest.
    SaintVenantKirchhoff,
    Any,
}

impl Laws {
    /// The law that tissue follows at finite strain, and its fibres.
    pub(super) fn of(self, tissue: &LinearElastic) -> (Law, Option<Fibres>) {
        match self {
            Laws::SaintVenantKirchhoff => {
                let (lambda, mu) = (tissue.lambda(), tissue.shear_modulus());
                (Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu }), None)
            }
            Laws::AtRest | Laws::Any => {
                let tissue = tissue.hyperelastic();
                (tissue.law, tissue.fibres)
            }
        }
    }
}

/// Properties of a method: a row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodProperties {
    /// As documents call it.
    pub name: &'static str,
    /// As sentences call it.
    pub title: &'static str,
    pub unknowns: Unknowns,
    /// What a client may choose; empty where there are no elements.
    pub elements: &'static [ElementChoice],
    /// What is used where a client chooses nothing.
    pub usual_element: ElementChoice,
    /// The shapes of cells it takes.
    pub cells: &'static [CellShape],
    /// Whether the displacement of several rigid movements is a sum of twelve columns for each.
    pub is_linear: bool,
    /// Whether strain is the symmetric part of the displacement gradient, so that turning is taken for stretching.
    pub is_small_strain: bool,
    /// Which laws of finite strain it knows; fibres that only pull with them.
    pub laws: Laws,
    /// Whether its tissue may be stiffer along fibres than across them.
    pub knows_fibres: bool,
    /// Whether it is made for tissue with fibres.
    pub expects_fibres: bool,
    /// Whether the skin may be a membrane of its own.
    pub knows_membrane: bool,
    /// Whether forces may act.
    pub knows_loads: bool,
    /// Whether tissue may grow, and muscles pull.
    pub knows_inner_stress: bool,
    /// Whether tissue may be kept from passing through what it touches.
    pub knows_contact: bool,
    /// Whether stress and strain of its cells can be given.
    pub gives_stress: bool,
}

const FEM_LINEAR: MethodProperties = MethodProperties {
    name: "fem_linear",
    title: "the linear finite element method",
    unknowns: Unknowns::Elements,
    elements: ElementChoice::ALL,
    usual_element: ElementChoice::Auto,
    cells: EVERY_SHAPE,
    is_linear: true,
    is_small_strain: true,
    laws: Laws::AtRest,
    knows_fibres: true,
    expects_fibres: false,
    knows_membrane: true,
    knows_loads: true,
    knows_inner_stress: true,
    knows_contact: true,
    gives_stress: true,
};

const FEM_NONLINEAR: MethodProperties = MethodProperties {
    name: "fem_nonlinear",
    title: "the nonlinear finite element method",
    unknowns: Unknowns::Elements,
    elements: ElementChoice::ALL,
    usual_element: ElementChoice::Stabilised,
    cells: EVERY_SHAPE,
    is_linear: false,
    is_small_strain: false,
    laws: Laws::Any,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: true,
    knows_loads: true,
    knows_inner_stress: true,
    knows_contact: true,
    gives_stress: true,
};

const MASS_TENSOR: MethodProperties = MethodProperties {
    name: "mtm",
    title: "the mass-tensor model",
    unknowns: Unknowns::Elements,
    elements: &[ElementChoice::Auto, ElementChoice::Plain],
    usual_element: ElementChoice::Plain,
    cells: TETRAHEDRA,
    // With its own iterations each solve stands for itself.
    is_linear: false,
    is_small_strain: true,
    laws: Laws::AtRest,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: true,
    knows_loads: true,
    knows_inner_stress: true,
    knows_contact: false,
    gives_stress: true,
};

const MASS_TENSOR_TRANSVERSE: MethodProperties = MethodProperties {
    name: "mtm_ti",
    title: "the mass-tensor model",
    unknowns: Unknowns::Elements,
    elements: &[ElementChoice::Auto, ElementChoice::Plain],
    usual_element: ElementChoice::Plain,
    cells: TETRAHEDRA,
    is_linear: true,
    is_small_strain: true,
    laws: Laws::AtRest,
    knows_fibres: true,
    expects_fibres: true,
    knows_membrane: true,
    knows_loads: true,
    knows_inner_stress: true,
    knows_contact: true,
    gives_stress: true,
};

const MASS_TENSOR_NONLINEAR: MethodProperties = MethodProperties {
    name: "mtm_nonlinear",
    title: "the nonlinear mass-tensor model",
    unknowns: Unknowns::Elements,
    elements: &[ElementChoice::Auto, ElementChoice::Plain],
    usual_element: ElementChoice::Plain,
    cells: TETRAHEDRA,
    is_linear: false,
    is_small_strain: false,
    laws: Laws::SaintVenantKirchhoff,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: false,
    knows_loads: true,
    knows_inner_stress: false,
    knows_contact: false,
    gives_stress: false,
};

const MASS_SPRING: MethodProperties = MethodProperties {
    name: "msm",
    title: "the mass-spring model",
    unknowns: Unknowns::Springs,
    elements: &[ElementChoice::Auto],
    usual_element: ElementChoice::Auto,
    cells: TETRAHEDRA,
    is_linear: false,
    is_small_strain: false,
    laws: Laws::AtRest,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: false,
    knows_loads: true,
    knows_inner_stress: false,
    knows_contact: false,
    gives_stress: false,
};

const VOLUME_SPLINE: MethodProperties = MethodProperties {
    name: "dvs",
    title: "the volume spline",
    unknowns: Unknowns::ControlPoints,
    elements: &[],
    usual_element: ElementChoice::Auto,
    cells: EVERY_SHAPE,
    is_linear: false,
    is_small_strain: true,
    laws: Laws::AtRest,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: false,
    knows_loads: true,
    knows_inner_stress: false,
    knows_contact: false,
    gives_stress: false,
};

const THICKNESS_WARP: MethodProperties = MethodProperties {
    name: "thickness_warp",
    title: "the thickness-preserving warp",
    unknowns: Unknowns::None,
    elements: &[],
    usual_element: ElementChoice::Auto,
    cells: EVERY_SHAPE,
    is_linear: false,
    is_small_strain: false,
    laws: Laws::AtRest,
    knows_fibres: false,
    expects_fibres: false,
    knows_membrane: false,
    knows_loads: false,
    knows_inner_stress: false,
    knows_contact: false,
    gives_stress: false,
};

impl MethodKind {
    /// Its row of the table.
    pub fn properties(self) -> &'static MethodProperties {
        match self {
            MethodKind::FemLinear => &FEM_LINEAR,
            MethodKind::FemNonlinear => &FEM_NONLINEAR,
            MethodKind::MassTensor => &MASS_TENSOR,
            MethodKind::MassTensorTransverse => &MASS_TENSOR_TRANSVERSE,
            MethodKind::MassTensorNonlinear => &MASS_TENSOR_NONLINEAR,
            MethodKind::MassSpring => &MASS_SPRING,
            MethodKind::VolumeSpline => &VOLUME_SPLINE,
            MethodKind::ThicknessWarp => &THICKNESS_WARP,
        }
    }

    /// As documents call it.
    pub fn name(self) -> &'static str {
        self.properties().name
    }
}

impl Method {
    pub fn kind(&self) -> MethodKind {
        match self {
            Method::FemLinear => MethodKind::FemLinear,
            Method::FemNonlinear => MethodKind::FemNonlinear,
            Method::MassSpring(_) => MethodKind::MassSpring,
            Method::MassTensor(_) => MethodKind::MassTensor,
            Method::MassTensorTransverse(_) => MethodKind::MassTensorTransverse,
            Method::MassTensorNonlinear => MethodKind::MassTensorNonlinear,
            Method::VolumeSpline(_) => MethodKind::VolumeSpline,
            Method::ThicknessWarp(_) => MethodKind::ThicknessWarp,
        }
    }

    /// Of its links between control points in mN/mm, where it has any.
    pub(super) fn link_stiffness(&self) -> Option<f64> {
        match self {
            Method::VolumeSpline(spline) => match spline.stiffness {
                Stiffness::Lattice(links) => Some(links),
                Stiffness::Galerkin => None,
            },
            Method::FemLinear
            | Method::FemNonlinear
            | Method::MassSpring(_)
            | Method::MassTensor(_)
            | Method::MassTensorTransverse(_)
            | Method::MassTensorNonlinear
            | Method::ThicknessWarp(_) => None,
        }
    }

    /// Its row of the table.
    pub fn properties(&self) -> &'static MethodProperties {
        self.kind().properties()
    }
}
