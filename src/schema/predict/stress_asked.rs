//! Further requirements of a spec that requests stress.

use super::document::{OutputName, PredictDocument};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::prediction::MethodKind;

impl PredictDocument {
    /// Requests stress, and its file.
    pub fn request_stress(&mut self) {
        self.stress = true;
        let mut outputs = self.files();
        outputs.push(OutputName::VolumeVtu);
        self.outputs = Some(outputs);
    }

    /// Refuses stress of a method without it, without its file, and of cells that the case does not have.
    pub(super) fn check_stress(&self, at: &Pointer, faults: &mut Faults) {
        if !self.stress {
            return;
        }
        let method = self.method.chosen().properties();
        if !method.gives_stress {
            let detail = format!(
                "{} gives no stress of cells, only {} do",
                method.title,
                listed(MethodKind::ALL.iter().copied())
            );
            faults.add(at, ErrorCode::MethodMismatch, detail);
        }
        if !self.files().contains(&OutputName::VolumeVtu) {
            let detail = "stress is in `volume.vtu`: name it in `outputs`";
            faults.add(at, ErrorCode::OneOf, detail);
        }
        if self.refine.is_some() {
            let detail =
                "a refined mesh has other cells than that of the case: omit `stress` or `refine`";
            faults.add(at, ErrorCode::OneOf, detail);
        }
    }
}

fn listed(methods: impl Iterator<Item = MethodKind>) -> String {
    let giving = methods.filter(|method| method.properties().gives_stress);
    giving.map(|method| format!("`{}`", method.name())).collect::<Vec<_>>().join(", ")
}
