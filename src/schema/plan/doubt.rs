//! Plausibility of movements as they are stated, before pivots and matrices make one movement of them.

use super::document::{PlanDocument, PlanSegmentDocument};
use super::movement::MovementDocument;
use crate::schema::Triple;
use mechanics::mesh::{Vector, Warning};
use mechanics::plan::doubt::{ROUNDING_DEG, suspect_shift};

impl PlanDocument {
    /// Translations stated beside a rotation that metres explain better. The shift of a segment without one is judged with
    /// all others of the plan, and matrices are computed: they hold the rounding of what computed them.
    pub fn doubts(&self) -> Vec<Warning> {
        let turned = self.segments.iter().filter(|segment| segment.turns());
        turned.flat_map(PlanSegmentDocument::suspect_shifts).collect()
    }
}

impl PlanSegmentDocument {
    /// Its movements that are stated by a translation and a rotation.
    fn stated(&self) -> Vec<MovementDocument> {
        let single = MovementDocument {
            translation_mm: self.translation_mm,
            rotation_deg: self.rotation_deg,
            ..MovementDocument::default()
        };
        self.sequence.iter().flatten().cloned().chain([single]).collect()
    }

    fn turns(&self) -> bool {
        let rotations = self.stated().into_iter().filter_map(|movement| movement.rotation_deg);
        rotations.map(Vector::from).any(|angles| angles.amax() > ROUNDING_DEG)
    }

    fn suspect_shifts(&self) -> Vec<Warning> {
        let shifts = self.stated().into_iter().filter_map(|movement| movement.translation_mm);
        let suspect = |shift: Triple| suspect_shift(self.name.trim(), Vector::from(shift).norm());
        shifts.filter_map(suspect).collect()
    }
}
