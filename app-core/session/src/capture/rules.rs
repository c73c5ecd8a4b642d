//! Rules of the schema for a record or its fields beyond their types.

use std::ops::RangeInclusive;

use schemars::Schema;
use schemars::transform::Transform;
use serde_json::{Map, Value, json};

/// The range of a field's number, or of each of its numbers, ends included.
pub(super) struct Within(pub(super) RangeInclusive<f64>);

impl Transform for Within {
    fn transform(&mut self, schema: &mut Schema) {
        let of_entries = schema.get_mut("items").and_then(Value::as_object_mut);
        let numbers = match of_entries {
            Some(entries) => entries,
            None => schema.ensure_object(),
        };
        for (key, end) in [("minimum", *self.0.start()), ("maximum", *self.0.end())] {
            numbers.insert(key.to_owned(), json!(end));
        }
    }
}

/// The keys that each kind of light requires, since its record has those of all kinds.
pub(super) fn needs_of_its_kind(schema: &mut Schema) {
    let shapes = [
        ("sphere", [("position", "array"), ("radius", "number")]),
        (
            "directional",
            [("direction_to_light", "array"), ("angular_radius_deg", "number")],
        ),
    ];
    let shapes = shapes.map(|(kind, needed)| {
        let types = needed.map(|(key, of_type)| (key.to_owned(), json!({ "type": of_type })));
        let mut properties = Map::from_iter(types);
        properties.insert("kind".to_owned(), json!({ "const": kind }));
        json!({ "properties": properties, "required": needed.map(|(key, _)| key) })
    });
    schema.insert("anyOf".to_owned(), json!(shapes));
}
