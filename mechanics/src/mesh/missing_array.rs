//! Reasons why a mesh has no array and no node set of a name.

use std::collections::BTreeSet;

use super::VolumeMesh;
use super::ignored::{ArrayUse, ValuesOf, listed};

impl VolumeMesh {
    /// What is said of an array that is asked for and not there: why it was ignored, or what there is instead.
    pub fn missing_array(&self, wanted: ArrayUse, name: &str) -> String {
        let (what, of, known) = match wanted {
            ArrayUse::PointLabels => {
                ("integer point array", ValuesOf::Points, listed(self.node_labels.keys()))
            }
            ArrayUse::CellLabels => {
                ("integer cell array", ValuesOf::Cells, listed(self.cell_labels.keys()))
            }
            ArrayUse::PointVectors => {
                ("point array of 3 components", ValuesOf::Points, listed(self.node_vectors.keys()))
            }
            ArrayUse::CellVectors => {
                ("cell array of 3 components", ValuesOf::Cells, listed(self.cell_vectors.keys()))
            }
        };
        if let Some(array) = self.ignored.find(of, name) {
            return array.to_string();
        }
        if let Some(set) = name.strip_prefix("set_").filter(|set| self.node_sets.contains_key(*set))
        {
            return format!(
                "array {name:?} was read as the node set {set:?}: select it by `node_set`"
            );
        }
        let other = self.held_by(wanted, name).map(|held| format!(": {name:?} {held}"));
        format!("the mesh has no {what} {name:?}{}; it has {known}", other.unwrap_or_default())
    }

    /// What an array of this name holds in the place of what is wanted.
    fn held_by(&self, wanted: ArrayUse, name: &str) -> Option<&'static str> {
        let arrays = [
            (
                ArrayUse::PointLabels,
                self.node_labels.contains_key(name),
                "holds integers at points",
            ),
            (ArrayUse::CellLabels, self.cell_labels.contains_key(name), "holds integers of cells"),
            (
                ArrayUse::PointVectors,
                self.node_vectors.contains_key(name),
                "holds vectors at points",
            ),
            (ArrayUse::CellVectors, self.cell_vectors.contains_key(name), "holds vectors of cells"),
        ];
        let mut others = arrays.into_iter().filter(|(held, there, _)| *there && *held != wanted);
        others.next().map(|(_, _, holds)| holds)
    }

    /// What is said of a node set that is asked for and not there: which sets there are, and what else selects nodes.
    pub fn missing_set(&self, name: &str) -> String {
        let bare = name.strip_prefix("set_").unwrap_or(name);
        let arrays = [bare.to_owned(), format!("set_{bare}")];
        let ignored = arrays.iter().find_map(|array| self.ignored.find(ValuesOf::Points, array));
        let why = ignored.map(|array| format!("; {array}")).unwrap_or_default();
        let known = listed(self.node_sets.keys());
        format!(
            "the mesh has no node set {name:?}; it has {known}{why}{}",
            self.selection_hints(name)
        )
    }

    /// How nodes are selected that are in no set of this name.
    fn selection_hints(&self, name: &str) -> String {
        if let Some(labels) = self.node_labels.get(name) {
            let values: BTreeSet<i64> = labels.iter().copied().collect();
            let values = listed(values.iter().map(i64::to_string).collect::<Vec<_>>().iter());
            return format!(
                "; {name:?} is an integer point array: its nodes are selected by `array` with `value`, one of {values}"
            );
        }
        match self.node_labels.is_empty() {
            true if self.node_sets.is_empty() => {
                "; an integer point array `set_NAME` makes one of the points where it is not 0"
                    .to_owned()
            }
            true => String::new(),
            false => format!(
                "; its integer point arrays select nodes by `array` with `value`: {}",
                listed(self.node_labels.keys())
            ),
        }
    }
}
