//! The names of the segments of a label map, in `key:=value` lines as 3D Slicer writes them.

use std::collections::BTreeMap;

use crate::format::limits::ReadLimits;

const KEY: &str = "Segment";
const NAME: &str = "_Name";
const LABEL: &str = "_LabelValue";

/// What lines said of each segment, by its number.
#[derive(Default)]
pub(super) struct Segments {
    names: BTreeMap<u32, String>,
    labels: BTreeMap<u32, u16>,
}

impl Segments {
    /// Takes up a line that is about the name or the label of a segment.
    pub fn take(&mut self, key: &[u8], value: &[u8], limits: &ReadLimits) {
        let (Ok(key), Ok(value)) = (std::str::from_utf8(key), std::str::from_utf8(value)) else {
            return;
        };
        let (Some(key), value) = (key.strip_prefix(KEY), value.trim()) else { return };
        let number = |end: &str| key.strip_suffix(end).and_then(|number| number.parse().ok());
        let fits = !value.is_empty() && value.chars().count() as u64 <= limits.name_length;
        if let Some(number) = number(NAME).filter(|_| fits && self.has_room(limits)) {
            self.names.insert(number, value.to_owned());
        }
        if let Some((number, label)) = number(LABEL).zip(value.parse().ok())
            && self.has_room(limits)
        {
            self.labels.insert(number, label);
        }
    }

    fn has_room(&self, limits: &ReadLimits) -> bool {
        (self.names.len().max(self.labels.len()) as u64) < limits.label_values
    }

    /// Names by label, of segments that have both.
    pub fn names(&self) -> BTreeMap<u16, String> {
        let named =
            |(number, name): (&u32, &String)| Some((*self.labels.get(number)?, name.clone()));
        self.names.iter().filter_map(named).collect()
    }
}

/// The lines of these names.
pub(super) fn lines(names: &BTreeMap<u16, String>) -> String {
    let line = |(number, (label, name)): (usize, (&u16, &String))| {
        let name: String = name.chars().filter(|c| !c.is_control()).collect();
        format!("{KEY}{number}{LABEL}:={label}\n{KEY}{number}{NAME}:={name}\n")
    };
    names.iter().enumerate().map(line).collect()
}
