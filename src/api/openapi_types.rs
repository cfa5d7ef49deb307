//! Corrections of the OpenAPI description for generators of clients: names, types and required members that follow from
//! the code and that the derived schemas lack or blur.

use serde_json::{Map, Value, json};

/// The schema of ids: text, because documents refer to ids as text.
const ID_PATTERN: &str = "^[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}$";

/// The same description, in a form suited to generated types.
pub fn typed(mut document: Value) -> Value {
    let schemas = document["components"]["schemas"].clone();
    simplify(&mut document, &schemas);
    document
}

fn simplify(value: &mut Value, schemas: &Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| simplify(item, schemas)),
        Value::Object(object) => {
            object.values_mut().for_each(|member| simplify(member, schemas));
            one_type(object);
            never_null(object);
            id_as_text(object);
            bytes(object);
            flat(object, schemas);
        }
        _ => {}
    }
}

/// A list of one type is that type.
fn one_type(object: &mut Map<String, Value>) {
    let only = match object.get("type").and_then(Value::as_array).map(Vec::as_slice) {
        Some([only]) => only.clone(),
        _ => return,
    };
    object.insert("type".into(), only);
}

/// Parameters and headers are present or absent, never null.
fn never_null(object: &mut Map<String, Value>) {
    let Some(schema) = object.get_mut("schema") else { return };
    let kind = match schema["type"].as_array().map(Vec::as_slice) {
        Some([kind, null]) if null == "null" => kind.clone(),
        _ => return,
    };
    schema["type"] = kind;
}

/// A parameter that is an id has the type of ids in documents.
fn id_as_text(object: &mut Map<String, Value>) {
    if object.get("format").is_some_and(|format| format == "uuid") {
        object.remove("format");
        object.insert("pattern".into(), ID_PATTERN.into());
    }
}

/// A body of bytes is no list of numbers, and an event stream is no text.
fn bytes(object: &mut Map<String, Value>) {
    let Some(content) = object.get_mut("content").and_then(Value::as_object_mut) else { return };
    for (media_type, content) in content {
        if media_type == "text/event-stream" {
            *content = json!({});
            continue;
        }
        let schema = &mut content["schema"];
        if schema["items"]["format"] == "int32" && schema["items"]["minimum"] == 0.0 {
            *schema = json!({"type": "string", "format": "binary"});
        }
    }
}

/// Members of one JSON object that are in several parts in the code are one object.
fn flat(object: &mut Map<String, Value>, schemas: &Value) {
    let Some(parts) = object.get("allOf").and_then(Value::as_array) else { return };
    let mut properties = Map::new();
    let mut required = Vec::new();
    let mut open = false;
    for part in parts {
        // A part that may be missing: its members are there or not.
        let optional = part["oneOf"][1]["type"] == "null";
        let part = resolved(if optional { &part["oneOf"][0] } else { part }, schemas);
        match part["properties"].as_object() {
            Some(members) => properties.extend(members.clone()),
            // A map of further members.
            None => open = true,
        }
        if let Some(names) = part["required"].as_array().filter(|_| !optional) {
            required.extend(names.clone());
        }
    }
    object.remove("allOf");
    object.insert("type".into(), "object".into());
    object.insert("properties".into(), properties.into());
    object.insert("required".into(), required.into());
    if open {
        object.insert("additionalProperties".into(), json!({}));
    }
}

fn resolved<'a>(schema: &'a Value, schemas: &'a Value) -> &'a Value {
    let name = schema["$ref"].as_str().and_then(|text| text.rsplit('/').next());
    name.map_or(schema, |name| &schemas[name])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_flat_in_json_is_flat_in_the_description() {
        let document = json!({"components": {"schemas": {
            "Numbers": {"type": "object", "required": ["mean"], "properties": {"mean": {"type": ["number"]}}},
            "Row": {"allOf": [
                {"oneOf": [{"$ref": "#/components/schemas/Numbers"}, {"type": "null"}]},
                {"type": "object"},
                {"type": "object", "required": ["name"], "properties": {"name": {"type": "string"}}}]}}}});
        let row = &typed(document)["components"]["schemas"]["Row"];
        assert_eq!(row["required"], json!(["name"]));
        assert_eq!(row["properties"]["name"], json!({"type": "string"}));
        assert_eq!(row["additionalProperties"], json!({}));
        assert!(row["properties"]["mean"].is_object());
    }

    #[test]
    fn bytes_and_ids_have_types_that_clients_have() {
        let array = json!({"type": "array", "items": {"type": "integer", "format": "int32", "minimum": 0.0}});
        let document = json!({"components": {"schemas": {}}, 
            "content": {"model/stl": {"schema": array}, "text/event-stream": {"schema": {}}}, "id": {"type": "string", "format": "uuid"}});
        let typed = typed(document);
        assert_eq!(typed["content"]["text/event-stream"], json!({}));
        assert_eq!(typed["content"]["model/stl"]["schema"]["format"], "binary");
        assert_eq!(typed["id"], json!({"type": "string", "pattern": ID_PATTERN}));
    }
}
