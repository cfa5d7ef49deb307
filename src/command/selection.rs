//! Selections of nodes as arguments: `NAME` is a set, `ARRAY=VALUE` the nodes where an array has a value.

use crate::schema::case::document::{BoneDocument, SegmentDocument};
use crate::schema::case::selection::SelectionDocument;

/// What `--fixed` and `--skin` take: `skull`, `tag=4`, or `tag=4,7` for the nodes of either value.
pub fn selection(text: &str) -> Result<SelectionDocument, String> {
    let Some((array, values)) = text.split_once('=') else {
        return Ok(SelectionDocument::node_set(text));
    };
    let label = |value: &str| {
        let value = value.trim().parse::<i64>().map_err(|_| {
            format!("`{value}` is not a whole number: an array selects nodes as ARRAY=VALUE")
        })?;
        let array = Some(array.trim().to_owned());
        Ok(SelectionDocument { array, value: Some(value), ..SelectionDocument::default() })
    };
    let mut parts = values.split(',').map(label).collect::<Result<Vec<_>, String>>()?;
    match parts.as_slice() {
        [_] => Ok(parts.remove(0)),
        _ => Ok(SelectionDocument { any: Some(parts), ..SelectionDocument::default() }),
    }
}

/// What `--segment` takes: `jaw=mandible_attached` or `jaw=tag=4`.
pub fn segment(text: &str) -> Result<SegmentDocument, String> {
    let (name, nodes) = text
        .split_once('=')
        .ok_or("a segment is NAME=SET or NAME=ARRAY=VALUE, for example jaw=tag=4")?;
    Ok(SegmentDocument { name: name.trim().to_owned(), nodes: selection(nodes)? })
}

/// What `--bone` takes: a file of all bone, or `mandible=mandible.stl` for one that is a segment.
#[derive(Clone, Debug, PartialEq)]
pub enum BoneArgument {
    All(String),
    Segment(BoneDocument),
}

pub fn bone(text: &str) -> BoneArgument {
    match text.split_once('=') {
        None => BoneArgument::All(text.to_owned()),
        Some((name, mesh)) => BoneArgument::Segment(BoneDocument {
            name: name.trim().to_owned(),
            mesh: mesh.to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_name_is_a_set_and_a_name_with_a_value_an_array() {
        let read =
            |text| selection(text).map(|found| serde_json::to_value(found).unwrap_or_default());
        assert_eq!(read("skull"), Ok(json!({"node_set": "skull"})));
        assert_eq!(read("tag=-4"), Ok(json!({"array": "tag", "value": -4})));
        let both = json!({"any": [{"array": "tag", "value": 1}, {"array": "tag", "value": 2}]});
        assert_eq!(read("tag=1,2"), Ok(both));
        assert!(read("tag=bone").is_err_and(|why| why.contains("not a whole number")));
        let jaw = segment("jaw=tag=4").map(|found| (found.name, found.nodes.value));
        assert_eq!(jaw, Ok(("jaw".to_owned(), Some(4))));
        assert!(segment("jaw").is_err());
        assert_eq!(bone("bone.stl"), BoneArgument::All("bone.stl".to_owned()));
        let jaw = BoneDocument { name: "jaw".to_owned(), mesh: "a=b.stl".to_owned() };
        assert_eq!(bone("jaw=a=b.stl"), BoneArgument::Segment(jaw));
    }
}
