//! The names of labels in an extension of a NIfTI file: a `LabelTable` as segmentation programs write it.

use std::collections::BTreeMap;

use quick_xml::Reader;
use quick_xml::events::Event;

use crate::format::limits::ReadLimits;

/// Longest extension that is searched for names, in bytes.
const LONGEST: usize = 1 << 20;
const TABLE: &[u8] = b"<LabelTable>";
const TABLE_END: &[u8] = b"</LabelTable>";

/// Names by label, as far as there are any. What cannot be read names nothing: the image is whole without.
pub(super) fn names(extensions: &[u8], limits: &ReadLimits) -> BTreeMap<u16, String> {
    let extensions = &extensions[..extensions.len().min(LONGEST)];
    let find = crate::format::cursor::find;
    let table = find(extensions, TABLE).map(|at| &extensions[at..]);
    let table = table.and_then(|table| find(table, TABLE_END).map(|end| &table[..end]));
    let Some(text) = table.and_then(|table| std::str::from_utf8(table).ok()) else {
        return BTreeMap::new();
    };
    let mut reader = Reader::from_str(&text[TABLE.len()..]);
    let mut names = BTreeMap::new();
    let mut label = None;
    while let Ok(event) = reader.read_event() {
        let name = match event {
            Event::Start(start) if start.name().as_ref() == "Label" => {
                let key = start.try_get_attribute("Key").ok().flatten();
                label = key.and_then(|key| key.value.trim().parse().ok());
                continue;
            }
            Event::CData(name) => name.trim().to_owned(),
            Event::Text(name) => name.trim().to_owned(),
            Event::Eof => break,
            _ => continue,
        };
        let fits = !name.is_empty() && name.chars().count() as u64 <= limits.name_length;
        if let Some(label) = label.filter(|_| fits && (names.len() as u64) < limits.label_values) {
            names.insert(label, name);
        }
    }
    names
}
