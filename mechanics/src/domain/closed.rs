//! Inside of a closed surface, such as that of a muscle.

use super::assessment::Assessment;
use super::shell::{Shell, Side};
use super::surface_error::{SurfaceDomainError, SurfaceName};
use crate::mesh::{TriangleSurface, Vector};

/// A body may be told from half of its triangles; of a muscle, whose share of cells is asked for, most have to be there.
const LEAST_LEVEL: f64 = 0.8;

/// A surface with an inside: where its generalised winding number is above half of what it is well inside.
#[derive(Clone, Debug)]
pub struct ClosedSurface {
    shell: Shell,
    pub assessment: Assessment,
}

impl ClosedSurface {
    /// Refuses a surface, in mm, that is open or turned to a large part; small holes are bridged by its winding number.
    pub fn new(surface: &TriangleSurface, name: SurfaceName) -> Result<Self, SurfaceDomainError> {
        let (shell, assessment) = Shell::new(surface, name)?;
        let Assessment { level, open_edges, .. } = assessment;
        if level < LEAST_LEVEL {
            return Err(SurfaceDomainError::Incomplete { surface: name, level, open_edges });
        }
        Ok(ClosedSurface { shell, assessment })
    }

    pub fn contains(&self, point: &Vector) -> bool {
        self.shell.value(point) > 0.0
    }

    /// Whether a ball is inside or, if false, outside; `None` where it is neither or that is not certain.
    pub fn contains_ball(&self, centre: &Vector, radius: f64) -> Option<bool> {
        self.shell.side(centre, radius).map(|side| side == Side::In)
    }

    /// Lowest and highest corner of its box, in mm.
    pub fn bounds(&self) -> (Vector, Vector) {
        self.shell.tree.bounds()
    }
}
