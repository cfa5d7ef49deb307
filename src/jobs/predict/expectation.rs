//! Expected choice of `auto`, before anything is solved.

use super::cost::{
    CONTACT, CONTACT_AT_FINITE_STRAIN, at_finite_strain, memory_at_finite_strain_mb, memory_mb,
    time_without_contact_s, with_contact,
};
use super::input::{PredictInput, Prepared};
use crate::schema::predict::expectation::{
    BandDocument, ExpectationDocument, ExpectedRungDocument, RESTS_ON,
};
use crate::schema::predict::time_band::TimeBandDocument;
use mechanics::boundary::NodeClass;
use mechanics::mesh::Vector;
use mechanics::prediction::{Accepted, Rung, SECOND_ORDER_TAKES, Scene};
use mechanics::response::by_rule_of_thumb;

/// The rule of thumb is conservative; it was too large by at most this factor (`docs/estimates.md`).
const TOO_LARGE: f64 = 6.0;

/// The third order of a plan is about so many times the square of the second over the largest movement, which is about twice the mean
/// of the skin's that `adequate::climb` divides by.
const THIRD: f64 = 3.0;

impl Prepared {
    /// Whether movements of segments alone deform the tissue, so that they tell the choice of `auto`: they say nothing of
    /// loads, prescribed displacements, tissue that grows, muscles that pull and fibres that only pull.
    pub(super) fn is_foreseen(&self) -> bool {
        let Scene { distributed, forces, conditions, .. } = &self.scene;
        let is_prescribed = |class: &NodeClass| *class == NodeClass::Prescribed;
        distributed.inner.is_empty()
            && forces.iter().all(|force| *force == Vector::zeros())
            && !conditions.classes.iter().any(is_prescribed)
            && !self.scene.has_pulling_fibres()
    }

    /// The models of `auto` with the expected cost of each; none for other methods, where more than movements deforms the
    /// tissue, and of a mesh that is refined.
    pub fn expectation(&self, input: &PredictInput) -> Option<ExpectationDocument> {
        let accepted = input.spec.accepted()?;
        if input.spec.refine.is_some() || !self.is_foreseen() {
            return None;
        }
        let rule = by_rule_of_thumb(&self.scene);
        let linearity_mm = BandDocument { low: rule.estimate / TOO_LARGE, high: rule.estimate };
        let movement_mm = rule.largest_relative_movement;
        let model = |error: f64| needed(error, movement_mm, &accepted).name().to_owned();
        Some(ExpectationDocument {
            accepted_mm: accepted.skin_mm,
            movement_mm,
            rotation_deg: rule.largest_rotation.to_degrees(),
            linearity_mm,
            at_least: model(linearity_mm.low),
            at_most: model(linearity_mm.high),
            rests_on: RESTS_ON.to_owned(),
            rungs: self.expected_rungs(input),
        })
    }

    fn expected_rungs(&self, input: &PredictInput) -> Vec<ExpectedRungDocument> {
        let scene = &self.scene;
        let alone = time_without_contact_s(scene, input.spec.method);
        let linear = alone.map(|band| with_contact(scene, band, CONTACT));
        let memory = memory_mb(scene, 0);
        let second_order = linear.map(|TimeBandDocument { low, high }| TimeBandDocument {
            low: SECOND_ORDER_TAKES * low,
            high: SECOND_ORDER_TAKES * high,
        });
        let newton = alone.map(at_finite_strain);
        let newton = newton.map(|band| with_contact(scene, band, CONTACT_AT_FINITE_STRAIN));
        let rung = |(rung, time_s, memory_mb): (Rung, _, f64)| ExpectedRungDocument {
            name: rung.name().to_owned(),
            time_s,
            memory_mb,
        };
        let rungs = [
            (Rung::Linear, linear, memory),
            (Rung::SecondOrder, second_order, memory),
            (Rung::FiniteStrain, newton, memory_at_finite_strain_mb(scene)),
        ];
        rungs.map(rung).into()
    }
}

/// The cheapest model of a plan, by its linearisation error.
fn needed(linearity_mm: f64, movement_mm: f64, accepted: &Accepted) -> Rung {
    let third_order_mm = THIRD * linearity_mm * linearity_mm / movement_mm;
    if linearity_mm <= accepted.skin_mm {
        Rung::Linear
    } else if third_order_mm <= accepted.skin_mm {
        Rung::SecondOrder
    } else {
        Rung::FiniteStrain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_movements_are_expected_to_need_dearer_models() {
        let accepted = Accepted { skin_mm: 0.1, ..Accepted::default() };
        // What was measured on the slab of docs/estimates.md.
        assert_eq!(needed(0.029, 1.8, &accepted), Rung::Linear);
        assert_eq!(needed(0.186, 4.5, &accepted), Rung::SecondOrder);
        assert_eq!(needed(0.725, 9.0, &accepted), Rung::FiniteStrain);
    }
}
