//! States of Newton's method: where it begins, what ends it, and tissue at rest.

use super::direction::{Directions, Tally};
use super::elements::CellBulkModulus;
use super::touching::Touching;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;
use crate::model::problem::LoadCase;
use crate::progress::Progress;
use crate::solver::{RestOnTheWay, SolveReport, Tolerance};

/// What ends Newton's method beside rest.
#[derive(Clone, Copy)]
pub(super) struct NewtonExits {
    /// Tissue with pressures that goes on in short steps only.
    pub jammed: bool,
    /// Tissue near rest.
    pub near: bool,
}

/// Where Newton's method begins.
#[derive(Clone)]
pub(super) struct Start<'a> {
    /// Positions by row.
    pub x: Vec<Vector>,
    /// For each pressure the mean of ln J that it answers to.
    pub log_volumes: Vec<f64>,
    /// The mean volume change that each hexahedron and wedge has of its own.
    pub means: Vec<f64>,
    /// The share of movement and load that is made.
    pub made: f64,
    /// Relative residuals so far.
    pub history: Vec<f64>,
    pub path: Vec<f64>,
    pub tally: Tally,
    /// Where contact is to be kept.
    pub touching: Option<Touching<'a>>,
}

impl<'a> Start<'a> {
    /// At positions by row, with a share of movement and load made.
    pub fn at(x: Vec<Vector>, made: f64, touching: Option<Touching<'a>>) -> Self {
        Start {
            x,
            log_volumes: Vec::new(),
            means: Vec::new(),
            made,
            history: Vec::new(),
            path: Vec::new(),
            tally: Tally::default(),
            touching,
        }
    }
}

/// What tissue and bones were asked.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub constrained: &'a Constrained<'a>,
    pub case: &'a LoadCase,
    /// The share of movement and load at which rest is wanted; 1 of all of it.
    pub share: f64,
    /// What of the bulk modulus stays in cells on the way: more after each jam.
    pub kept: &'static [CellBulkModulus],
    /// The relative residual above which tissue whose tangent was not positive definite is brought nearer to rest before bones
    /// go on.
    pub out_of_balance: f64,
    /// Whether hexahedra and wedges have the mean volume changes of their positions alone, so that their energy can be asked to fall.
    pub by_energy: bool,
    /// Steps, with those before, after which no rest is expected any more.
    pub most_steps: usize,
    pub tolerance: Tolerance,
    pub progress: &'a dyn Progress,
}

/// How Newton's method ended.
pub(super) enum Ending<'a> {
    Rest(Box<Rest<'a>>),
    /// More of the bulk modulus has to stay in the cells.
    Jam(Start<'a>),
    /// All of it may be shared, but in the cells of the mesh that are pressed.
    Near(Start<'a>, Vec<bool>),
}

/// Tissue at rest.
pub(super) struct Rest<'a> {
    /// By row.
    pub positions: Vec<Vector>,
    pub pressures: Vec<f64>,
    /// As those of a start.
    pub means: Vec<f64>,
    /// The share of movement and load that is made.
    pub made: f64,
    /// Internal forces in mN, by row.
    pub forces: Vec<Vector>,
    pub report: SolveReport,
    /// What solved the steps.
    pub directions: Directions,
    pub touching: Option<Touching<'a>>,
}

impl<'a> Rest<'a> {
    /// What is told of it, where so many residuals were measured before the part of the movement that ends there.
    pub fn on_the_way(&self, begun: usize) -> Option<RestOnTheWay> {
        self.report.newton.as_ref().map(|newton| RestOnTheWay {
            share: self.made,
            energy: newton.energy,
            least_det_f: newton.least_det_f,
            steps: self.report.history.len() - 1 - begun,
        })
    }

    /// Where another path begins.
    pub fn into_start(self) -> Start<'a> {
        let pressures = self.directions.pressures.as_ref();
        let log_volumes = pressures.map_or_else(Vec::new, |own| own.log_volumes(&self.pressures));
        // The state is measured again where it is gone on from.
        let (mut history, mut path) = (self.report.history, Vec::new());
        path.extend(self.report.newton.into_iter().flat_map(|newton| newton.path));
        history.pop();
        path.pop();
        Start {
            x: self.positions,
            log_volumes,
            means: self.means,
            made: self.made,
            history,
            path,
            tally: self.directions.tally,
            touching: self.touching,
        }
    }
}

/// The share of the movement after one more part of it, on the way to one.
pub(super) fn advanced(made: f64, more: f64, wanted: f64) -> f64 {
    let made = made + more;
    if wanted - made < 1e-12 { wanted } else { made }
}
