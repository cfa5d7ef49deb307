//! Bodies with a damaged surface, meshed and held against the undamaged body.
//!
//! An ending is right where cells are positive, each edge of the boundary lies between two triangles, the volume is within 1 % of
//! the undamaged mesh's, tissue more than half a cell from the undamaged boundary is missing or too much by no more than 1 % of it,
//! flat ends of the scan are where they were, no angle is below 5 degrees, and what was mended is named; or it is a refusal, by its name. All else is wrong: told, where a
//! warning names the damage, or silent.

use std::collections::{BTreeMap, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};

use mechanics::anatomy::surfaces::{mended, outside};
use mechanics::domain::{Boundary, Domain, SurfaceDomain, SurfaceDomainError};
use mechanics::mesh::quality::quality;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::meshing::{MeshingError, MeshingSettings, SizeField, TissueMesh, mesh};
use mechanics::progress::Unobserved;

use super::chords::{Chords, Lines};
use super::damage::Damage;

/// How far the volume may be off.
const VOLUME: f64 = 0.01;
/// How much of the volume may lie elsewhere, and what is near enough to the undamaged boundary not to count, in cells.
const ELSEWHERE: f64 = 0.01;
const NEAR: f64 = 0.5;
/// How many of the nodes where the scan ended there are at least; a lattice that is moved a little has a tenth fewer.
const ENDS: f64 = 0.75;
/// In degrees.
const LEAST_ANGLE: f64 = 5.0;

/// A skin with bones, and the mesh between them undamaged.
pub struct Undamaged {
    pub name: &'static str,
    /// The skin, then the bones.
    pub surfaces: Vec<TriangleSurface>,
    /// The edge of the cubes of the lattice, in mm.
    pub edge: f64,
    pub volume: f64,
    /// Nodes where the scan ended.
    ends: usize,
    pub lines: Lines,
    pub chords: Chords,
    domain: SurfaceDomain,
    told: Vec<String>,
}

/// How a damaged surface ended.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    Right,
    /// By its name.
    Refused(String),
    /// What is wrong, and that a warning names the damage.
    Told(&'static str),
    /// What is wrong, and that nothing tells of it.
    Silent(&'static str),
}

/// A mesh with what is told of it.
pub struct Made {
    pub tissue: TissueMesh,
    pub domain: SurfaceDomain,
    pub told: Vec<String>,
}

/// What a run came to.
pub struct Outcome {
    pub ending: Ending,
    pub made: Option<Made>,
    /// The share by which the volume is off, the share that lies elsewhere, and the smallest angle in degrees.
    pub off: f64,
    pub elsewhere: f64,
    pub angle: f64,
}

impl Undamaged {
    pub fn new(name: &'static str, surfaces: Vec<TriangleSurface>, edge: f64) -> Undamaged {
        let Made { tissue, domain, told } =
            made(&surfaces, edge).unwrap_or_else(|why| panic!("{name}: {why}"));
        let [low, high] = tissue.volume.bounds();
        let lines = Lines::through(&low, &high);
        let chords = lines.chords(&boundary(&tissue));
        let volume = tissue.report.volume;
        let ends = tissue.nodes_on(Boundary::Cut).len();
        Undamaged { name, surfaces, edge, volume, ends, lines, chords, domain, told }
    }

    /// Damages one surface after the other as the seed goes up.
    pub fn damaged(&self, damage: Damage, seed: u64) -> Vec<TriangleSurface> {
        let which = seed as usize % self.surfaces.len();
        let each = self.surfaces.iter().enumerate();
        each.map(|(n, surface)| if n == which { damage.of(surface, seed) } else { surface.clone() })
            .collect()
    }

    pub fn outcome(&self, damage: Damage, seed: u64) -> Outcome {
        let surfaces = self.damaged(damage, seed);
        let none = |ending| Outcome { ending, made: None, off: -1.0, elsewhere: 1.0, angle: 0.0 };
        match catch_unwind(AssertUnwindSafe(|| made(&surfaces, self.edge))) {
            Err(_) => none(Ending::Silent("panic")),
            Ok(Err(refusal)) => none(Ending::Refused(refusal)),
            // So little damage may leave all as it was.
            Ok(Ok(made)) => self.judged(damage.is_told() && surfaces != self.surfaces, made),
        }
    }

    fn judged(&self, is_to_be_told: bool, made: Made) -> Outcome {
        let report = &made.tissue.report;
        let quality = quality(&made.tissue.volume);
        let surface = boundary(&made.tissue);
        let off = report.volume / self.volume - 1.0;
        let other = self.lines.chords(&surface);
        let elsewhere = self.lines.difference(&self.chords, &other, |at| self.is_far(at));
        let elsewhere = elsewhere / self.volume;
        let angle = report.angles.smallest;
        let ends = made.tissue.nodes_on(Boundary::Cut).len();
        let is_told = made.told != self.told;
        let wrong = if quality.smallest_volume <= 0.0 || quality.inverted > 0 {
            Some("cells that are not positive")
        } else if !is_manifold(&surface) {
            Some("no manifold")
        } else if off.abs() > VOLUME {
            Some("volume")
        } else if elsewhere > ELSEWHERE {
            Some("elsewhere")
        } else if (ends as f64) < ENDS * self.ends as f64 {
            Some("ends of the scan")
        } else if angle < LEAST_ANGLE {
            Some("angle")
        } else {
            (is_to_be_told && !is_told).then_some("not named")
        };
        let ending = match wrong {
            None => Ending::Right,
            Some(what) if is_told => Ending::Told(what),
            Some(what) => Ending::Silent(what),
        };
        Outcome { ending, made: Some(made), off, elsewhere, angle }
    }

    /// Whether a place is farther from the boundary than a lattice that is moved a little makes up.
    fn is_far(&self, at: &Vector) -> bool {
        let boundaries = [Boundary::Skin, Boundary::Bone, Boundary::Cut];
        let distance = |on| (self.domain.projection(at, on) - at).norm();
        boundaries.into_iter().all(|on| {
            let distance = distance(on);
            distance == 0.0 || distance > NEAR * self.edge
        })
    }

    /// Every damage with each of the seeds.
    pub fn endings(&self, seeds: std::ops::Range<u64>) -> Endings {
        let mut found = Endings::new();
        for seed in seeds {
            for damage in Damage::ALL {
                let ending = self.outcome(damage, seed).ending;
                found.entry((damage, ending)).or_default().push(seed);
            }
        }
        found
    }
}

/// The mesh between surfaces, the first of which is the skin, and what is told of it; or the name of the refusal.
fn made(surfaces: &[TriangleSurface], edge: f64) -> Result<Made, String> {
    let bones: Vec<&TriangleSurface> = surfaces[1..].iter().collect();
    let domain =
        SurfaceDomain::new(&surfaces[0], &bones, &[]).map_err(|error| name(&error).to_owned())?;
    let settings = MeshingSettings { size: SizeField::uniform(edge), ..MeshingSettings::default() };
    let tissue = mesh(&domain, &settings, &Unobserved).map_err(|error| match error {
        MeshingError::Broken { what, .. } => what.to_owned(),
        other => other.to_string(),
    })?;
    let warnings = mended(&domain).into_iter().chain(outside(&domain));
    let told = warnings.map(|warning| warning.detail).collect();
    Ok(Made { tissue, domain, told })
}

pub fn boundary(tissue: &TissueMesh) -> TriangleSurface {
    tissue.volume.surface_of(&tissue.volume.boundary_faces())
}

/// Each edge is passed once in each direction.
fn is_manifold(surface: &TriangleSurface) -> bool {
    let mut ways: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
    for [a, b, c] in &surface.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            ways.entry([*from.min(to), *from.max(to)]).or_default()[usize::from(from < to)] += 1;
        }
    }
    ways.values().all(|&both| both == [1, 1])
}

fn name(error: &SurfaceDomainError) -> &'static str {
    match error {
        SurfaceDomainError::Coordinate { .. } => "no place",
        SurfaceDomainError::Corner { .. } => "no corner",
        SurfaceDomainError::Empty { .. } => "empty",
        SurfaceDomainError::NoInside { .. } => "no inside",
        SurfaceDomainError::Incomplete { .. } => "incomplete",
        SurfaceDomainError::Uncertain { .. } => "uncertain",
        SurfaceDomainError::Open { .. } => "open",
        SurfaceDomainError::TwoWalls { .. } => "walls",
        SurfaceDomainError::Doubled { .. } => "doubled",
        SurfaceDomainError::Tangled { .. } => "tangled",
        SurfaceDomainError::BoneOutside { .. } => "bone outside",
        SurfaceDomainError::NoTissue { .. } => "no tissue",
        SurfaceDomainError::Limit(_) => "limit",
    }
}

/// For each damage and ending the seeds that led there.
pub type Endings = BTreeMap<(Damage, Ending), Vec<u64>>;

/// As many as `DAMAGE_SEEDS` says.
pub fn seeds(usual: u64) -> std::ops::Range<u64> {
    let asked = std::env::var("DAMAGE_SEEDS").ok().and_then(|count| count.parse().ok());
    0..asked.unwrap_or(usual)
}

/// Rows of a table.
pub fn print_counts(endings: &Endings) {
    for ((damage, ending), seeds) in endings {
        println!("| {damage:?} | {ending:?} | {} |", seeds.len());
    }
}

/// A head cut flat at its neck, around a bone that is three quarters of it.
pub fn made_head() -> Vec<TriangleSurface> {
    let skin =
        super::surfaces::map(&super::surfaces::head(5), |x| Vector::new(x.x, x.y, x.z.max(-90.0)));
    let bone = super::surfaces::map(&super::surfaces::head(4), |x| {
        Vector::new(x.x, x.y, x.z * 0.9) * 0.75
    });
    vec![skin, bone]
}
