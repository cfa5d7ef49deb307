//! Rest sought first near a displacement that is known, as of the same tissue under slightly other forces.

use super::inner::is_too_much;
use super::newton_state::{Question, Rest, Start};
use super::problem::FiniteStrain;
use super::tissue::Tissue;
use crate::mesh::Vector;
use crate::model::problem::ModelError;

impl<'a> FiniteStrain<'a> {
    /// Brings the tissue to rest from displacements near it, where there are such and no contact; none where that leads nowhere.
    pub(super) fn rest_near(
        &self,
        question: Question<'a>,
        start: &Start<'a>,
    ) -> Result<Option<(Tissue<'a>, Rest<'a>)>, ModelError> {
        let near = self.near.filter(|near| near.len() == self.nodes.len());
        let (Some(near), None) = (near, &start.touching) else { return Ok(None) };
        let moved: Vec<Vector> = self.nodes.iter().zip(near).map(|(x, u)| x + u).collect();
        let start = Start::at(question.constrained.dof_map.by_row(&moved), 1.0, None);
        match self.rest_from(question, start) {
            Err(error) if is_too_much(&error) => Ok(None),
            ended => ended.map(Some),
        }
    }
}
