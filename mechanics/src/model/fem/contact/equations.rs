//! Rows of contact as equations of the free unknowns.

use std::collections::BTreeMap;

use crate::boundary::Constraint;
use crate::boundary::contact::ContactRow;
use crate::model::dofs::{DofMap, partly_constrained};
use crate::solver::PartlyHeld;
use crate::solver::preconditioned::Equation;

/// Free unknowns by node.
#[derive(Clone)]
pub(in crate::model::fem) struct FreeUnknowns<'a> {
    dof_map: &'a DofMap,
    partly_constrained: BTreeMap<usize, PartlyHeld>,
}

impl<'a> FreeUnknowns<'a> {
    pub fn new(constraints: &[Constraint], dof_map: &'a DofMap) -> Self {
        let partly = partly_constrained(constraints, dof_map);
        let partly_constrained = partly.into_iter().map(|partly| (partly.row, partly)).collect();
        FreeUnknowns { dof_map, partly_constrained }
    }

    /// Coefficients of a contact constraint on free unknowns, along the axes of their nodes; none where both sides are
    /// constrained.
    pub fn equation(&self, row: &ContactRow) -> Equation {
        let mut equation = Equation::new();
        for (node, along) in &row.terms {
            let place = self.dof_map.row(*node);
            if place >= self.dof_map.ordering.free {
                continue;
            }
            let partly = self.partly_constrained.get(&place);
            let own = partly.map_or(*along, |partly| partly.axes.transpose() * along);
            let is_free = |k: usize| partly.is_none_or(|partly| !partly.held[k]);
            let free = (0..3).filter(|&k| is_free(k) && own[k] != 0.0);
            equation.extend(free.map(|k| ((3 * place + k) as u32, own[k])));
        }
        equation
    }
}
