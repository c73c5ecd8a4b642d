//! Validation of a value against a schema, as far as the schema of sessions needs it; an unknown
//! keyword is a panic.

use serde_json::Value;

/// Keywords that only describe.
const REMARKS: &[&str] = &["$schema", "title", "description", "format", "default"];

pub(crate) fn follows(value: &Value, schema: &Value) -> bool {
    let rules = schema.as_object().unwrap();
    rules
        .iter()
        .filter(|(keyword, _)| !REMARKS.contains(&keyword.as_str()))
        .all(|(keyword, rule)| {
            of_object(value, keyword, rule)
                .or_else(|| of_list(value, keyword, rule))
                .or_else(|| of_one(value, keyword, rule))
                .unwrap_or_else(|| panic!("the keyword {keyword} is not looked at"))
        })
}

/// `None` if the rule is not one for objects; a rule for objects does not apply to other values.
/// The functions below do the same.
fn of_object(value: &Value, keyword: &str, rule: &Value) -> Option<bool> {
    let entries = value.as_object();
    let holds = |is_right: &dyn Fn(&serde_json::Map<String, Value>) -> bool| entries.is_none_or(is_right);
    match keyword {
        "properties" => Some(holds(&|entries| {
            let known = rule.as_object().unwrap();
            let both = known
                .iter()
                .filter_map(|(key, schema)| Some((entries.get(key)?, schema)));
            both.into_iter().all(|(value, schema)| follows(value, schema))
        })),
        "required" => Some(holds(&|entries| {
            let mut keys = rule.as_array().unwrap().iter();
            keys.all(|key| entries.contains_key(key.as_str().unwrap()))
        })),
        _ => None,
    }
}

fn of_list(value: &Value, keyword: &str, rule: &Value) -> Option<bool> {
    let holds = |is_right: &dyn Fn(&Vec<Value>) -> bool| value.as_array().is_none_or(is_right);
    match keyword {
        "items" => Some(holds(&|entries| entries.iter().all(|entry| follows(entry, rule)))),
        "minItems" => Some(holds(&|entries| entries.len() as u64 >= rule.as_u64().unwrap())),
        "maxItems" => Some(holds(&|entries| entries.len() as u64 <= rule.as_u64().unwrap())),
        _ => None,
    }
}

fn of_one(value: &Value, keyword: &str, rule: &Value) -> Option<bool> {
    let shapes = || {
        let shapes = rule.as_array().unwrap().iter();
        shapes.filter(|shape| follows(value, shape)).count()
    };
    match keyword {
        "type" => Some(match rule.as_array() {
            Some(types) => types.iter().any(|of_type| is_a(value, of_type)),
            None => is_a(value, rule),
        }),
        "const" => Some(value == rule),
        "enum" => Some(rule.as_array().unwrap().contains(value)),
        "anyOf" => Some(shapes() > 0),
        "oneOf" => Some(shapes() == 1),
        "minimum" => Some(value.as_f64().is_none_or(|value| value >= rule.as_f64().unwrap())),
        "maximum" => Some(value.as_f64().is_none_or(|value| value <= rule.as_f64().unwrap())),
        "minLength" => Some(
            value
                .as_str()
                .is_none_or(|text| text.chars().count() as u64 >= rule.as_u64().unwrap()),
        ),
        _ => None,
    }
}

fn is_a(value: &Value, of_type: &Value) -> bool {
    match of_type.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "null" => value.is_null(),
        other => panic!("the type {other} is not looked at"),
    }
}
