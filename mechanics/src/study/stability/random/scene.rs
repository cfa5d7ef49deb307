//! Small random scenes: tissue thinner than the movement of its bone, every law, method and element.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::draws::Draws;
use crate::material::hyperelastic::{
    Fibres, Fung, Law, MooneyRivlin, NeoHookean, NeoHookeanIsochoric, Ogden, OgdenTerm,
    PolyconvexBarrier, RubinBodner, SaintVenantKirchhoff, VerondaWestmann, Volumetric,
};
use crate::material::{LinearElastic, MaterialError};
use crate::mesh::sample::block;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::plan::RigidMovement;
use crate::prediction::{
    Case, CaseSegment, ElementChoice, FibreDirection, Laws, Load, MethodKind, Settings, Sliding,
    SlidingNormal,
};
use crate::study::methods;
use crate::study::stability::Probe;
use crate::study::stability::scenes::{jaw, set};
use crate::study::variant::Variant;

/// Surgical movements end here, in mm and degrees.
const FARTHEST: f64 = 25.0;
const MOST_TURNED: f64 = 45.0;

/// Makes a seed of its own for the choice of quadratic tetrahedra.
const OF_EDGES: u64 = 1 << 32;

/// Relative residual: far below what any picture shows, and met soon.
const RESIDUAL: f64 = 1e-6;

/// A scene with the words for the method and the law it is for.
pub(super) struct RandomScene {
    pub method: String,
    pub law: &'static str,
    pub probe: Probe,
}

/// The scene at a place of a seed.
pub(super) fn scene(seed: u64, place: u64) -> Result<RandomScene, MaterialError> {
    let mut numbers = Draws::of(seed, place);
    let (variant, element, shape) = method(&mut numbers);
    let element = match may_be_quadratic(&variant, shape) && of_edges(seed, place) {
        true => ElementChoice::Quadratic,
        false => element,
    };
    let (law, tissue) = tissue(&mut numbers)?;
    let mesh = tissue_block(&mut numbers, shape);
    let case = case(&mut numbers, mesh, tissue);
    let mut plan = jaw(movement(&mut numbers));
    if variant.settings.method.properties().knows_loads && numbers.once_in(8) {
        let pressure = numbers.between(-3.0, 3.0);
        plan.loads = vec![Load::Pressure { faces: set("z_max"), pressure }];
    }
    let method = match element == ElementChoice::Auto {
        true => variant.label,
        false => format!("{} {}", variant.method, element.name()),
    };
    let settings = Settings { element, relative_residual: RESIDUAL, ..variant.settings };
    Ok(RandomScene { method, law, probe: Probe { case, plan, settings } })
}

/// Quadratic tetrahedra at finite strain are no variant of studies, because their time is out of proportion there.
fn may_be_quadratic(variant: &Variant, shape: CellShape) -> bool {
    variant.settings.method.kind() == MethodKind::FemNonlinear && shape == CellShape::Tet4
}

/// One scene in 24, by draws of its own: the others of a seed stay what they are.
fn of_edges(seed: u64, place: u64) -> bool {
    Draws::of(seed ^ OF_EDGES, place).once_in(24)
}

/// Methods of finite strain half of the time. Iterations that papers give up are left out.
fn method(numbers: &mut Draws) -> (Variant, ElementChoice, CellShape) {
    let finite = |kind: &&MethodKind| kind.properties().laws != Laws::AtRest;
    let wants_finite = !numbers.once_in(2);
    let kinds: Vec<MethodKind> =
        MethodKind::ALL.iter().filter(|kind| finite(kind) == wants_finite).copied().collect();
    let kind = numbers.of_list(&kinds).copied().unwrap_or(MethodKind::FemNonlinear);
    let mut variants = methods::of_method(kind);
    // Where one way of a method is sound, those that are there to fail say nothing new.
    if variants.iter().any(|variant| !variant.may_fail) {
        variants.retain(|variant| !variant.may_fail);
    }
    let variant = variants.swap_remove(numbers.whole(0, variants.len() - 1));
    let properties = kind.properties();
    // A variant that is made for an element has it; the others take any.
    let (own, any) = (variant.settings.element, numbers.of_list(properties.elements));
    let element = if own == ElementChoice::Auto { any.copied().unwrap_or(own) } else { own };
    let shapes: Vec<CellShape> =
        properties.cells.iter().filter(|shape| element.shapes().contains(shape)).copied().collect();
    let shape = numbers.of_list(&shapes).copied().unwrap_or(CellShape::Tet4);
    (variant, element, shape)
}

/// Tissue of moduli that agree with a Poisson ratio from .3 to .4999, and the word for its law.
fn tissue(numbers: &mut Draws) -> Result<(&'static str, LinearElastic), MaterialError> {
    let young_modulus = numbers.by_factors(1.0, 300.0);
    let poisson_ratio = 0.5 - numbers.by_factors(1e-4, 0.2);
    let linear = LinearElastic::new(young_modulus, poisson_ratio, 1.0)?;
    let (word, law) = law(numbers, &linear);
    let tissue = match law {
        Some(law) => LinearElastic::of_law(law, 1.0)?,
        None => linear,
    };
    let fibres = Fibres { k1: numbers.by_factors(0.1, 100.0), k2: numbers.by_factors(0.1, 30.0) };
    Ok((word, if numbers.once_in(4) { tissue.with_pulling_fibres(fibres) } else { tissue }))
}

fn law(numbers: &mut Draws, linear: &LinearElastic) -> (&'static str, Option<Law>) {
    let (mu, lambda, bulk) = (linear.shear_modulus(), linear.lambda(), linear.bulk_modulus());
    let volumetric = match numbers.once_in(4) {
        true => Volumetric::Logarithmic(bulk),
        false => Volumetric::Barrier(bulk),
    };
    match numbers.whole(0, 9) {
        0 => ("none stated", None),
        1 => ("neo-Hookean", Some(Law::NeoHookean(NeoHookean { lambda, mu }))),
        2 => {
            let law = NeoHookeanIsochoric { mu, volumetric };
            ("neo-Hookean, isochoric", Some(Law::NeoHookeanIsochoric(law)))
        }
        3 => {
            let law = SaintVenantKirchhoff { lambda, mu };
            ("Saint Venant-Kirchhoff", Some(Law::SaintVenantKirchhoff(law)))
        }
        4 => {
            let (part, c20) = (numbers.between(0.0, 0.5), mu * numbers.between(0.0, 0.5));
            let (c10, c01) = (0.5 * mu * (1.0 - part), 0.5 * mu * part);
            let law = MooneyRivlin { c10, c01, c20, c11: 0.0, c02: 0.0, volumetric };
            ("Mooney-Rivlin", Some(Law::MooneyRivlin(law)))
        }
        5 => {
            let g = numbers.by_factors(0.5, 20.0);
            let law = VerondaWestmann { c1: mu / g, g, volumetric };
            ("Veronda-Westmann", Some(Law::VerondaWestmann(law)))
        }
        6 => {
            let law = Fung { mu, b: numbers.by_factors(0.1, 50.0), volumetric };
            ("Fung", Some(Law::Fung(law)))
        }
        7 => {
            let (part, up) = (numbers.between(0.2, 1.0), numbers.between(1.0, 8.0));
            let down = numbers.between(-6.0, -1.0);
            let terms = [
                OgdenTerm { mu: 2.0 * mu * part / up, alpha: up },
                OgdenTerm { mu: 2.0 * mu * (1.0 - part) / down, alpha: down },
            ];
            ("Ogden", Some(Law::Ogden(Ogden::new(&terms, volumetric))))
        }
        8 => {
            let law = PolyconvexBarrier { lambda, mu };
            ("polyconvex barrier", Some(Law::PolyconvexBarrier(law)))
        }
        _ => {
            let (p, eta1) = (numbers.by_factors(1.0, 40.0), numbers.by_factors(1.0, 1000.0));
            let (eps0, theta) = (bulk / eta1, numbers.between(0.8, 1.2));
            let law = RubinBodner { eps0, p, eta1, eta2: mu / (eps0 * theta), theta };
            ("Rubin-Bodner", Some(Law::RubinBodner(law)))
        }
    }
}

/// A block of a few cells, 1 to 15 mm thick, with a patch of its bottom for the bone that moves.
fn tissue_block(numbers: &mut Draws, shape: CellShape) -> VolumeMesh {
    let across = numbers.whole(3, 6);
    let width = numbers.between(12.0, 45.0);
    let size = Vector::new(width, width, numbers.by_factors(1.0, 15.0));
    let mut mesh = block(size, [across, across, numbers.whole(1, 3)], shape);
    // Inner nodes stand askew.
    let step = Vector::new(width / across as f64, width / across as f64, size.z) * 0.15;
    let inside = |x: f64, end: f64| x > 1e-6 && x < end - 1e-6;
    for node in &mut mesh.nodes {
        for axis in 0..2 {
            if inside(node[axis], size[axis]) {
                node[axis] += step[axis] * numbers.between(-1.0, 1.0);
            }
        }
    }
    let half = width * numbers.between(0.15, 0.35);
    let ring = width * numbers.between(0.0, 0.35);
    let beyond = |node: &&u32, reach: f64| {
        let x = mesh.nodes[**node as usize] - size * 0.5;
        x.x.abs().max(x.y.abs()) > reach
    };
    let base = mesh.node_sets["z_min"].clone();
    let mut patch: Vec<u32> = base.iter().filter(|node| !beyond(node, half)).copied().collect();
    if patch.is_empty() {
        patch.push(base[base.len() / 2]);
    }
    let mut far: Vec<u32> = base.iter().filter(|node| beyond(node, half + ring)).copied().collect();
    far.retain(|node| !patch.contains(node));
    if far.is_empty() {
        far.extend(base.iter().filter(|node| !patch.contains(node)).take(1));
    }
    mesh.node_sets.insert("patch".to_owned(), patch);
    mesh.node_sets.insert("far".to_owned(), far);
    mesh
}

/// The patch is the jaw's, what is far from it fixed, and one side slides once in a while.
fn case(numbers: &mut Draws, mesh: VolumeMesh, tissue: LinearElastic) -> Case {
    let mut course = direction(numbers);
    if course == Vector::zeros() {
        course = Vector::x();
    }
    let sliding = match numbers.once_in(5) {
        true => {
            vec![Sliding { nodes: set("x_min"), normal: SlidingNormal::Surface, segment: None }]
        }
        false => Vec::new(),
    };
    Case {
        volume: Arc::new(mesh),
        materials: BTreeMap::from([("*".to_owned(), tissue)]),
        fibres: BTreeMap::from([("*".to_owned(), FibreDirection::Uniform(course))]),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("patch") }],
        fixed: vec![set("far")],
        sliding,
        skin: Some(set("z_max")),
        ..Case::default()
    }
}

/// Up to 25 mm and 45 degrees, small ones as often as large ones.
fn movement(numbers: &mut Draws) -> RigidMovement {
    let by = direction(numbers) * numbers.by_factors(0.1, FARTHEST);
    let turned = match numbers.once_in(2) {
        true => direction(numbers) * numbers.by_factors(1.0, MOST_TURNED).to_radians(),
        false => Vector::zeros(),
    };
    RigidMovement::about_pivot(turned, Vector::new(20.0, 20.0, -10.0), by)
}

/// Of length 1.
fn direction(numbers: &mut Draws) -> Vector {
    let height = numbers.between(-1.0, 1.0);
    let around = numbers.between(0.0, std::f64::consts::TAU);
    let flat = (1.0 - height * height).sqrt();
    Vector::new(flat * around.cos(), flat * around.sin(), height)
}
