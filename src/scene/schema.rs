//! A JSON Schema of scene files, for editors, from the table of keys. It accepts every scene; what it cannot say, such as
//! that an increment is at most the target, the parser alone refuses.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::data::Stage;
use super::key_table::SECTIONS;
use super::keys::{Choice, Form, Key, Kind, Length, Limits, Presence, Section};
use super::places::EDGES;

/// The schema of a scene file (draft 7), pretty-printed.
pub fn json_schema() -> String {
    format!("{:#}\n", of_scene(SECTIONS))
}

/// The schema of a file of some tables.
pub(super) fn of_scene(sections: &[Section]) -> Value {
    let properties: Map<String, Value> =
        sections.iter().map(|section| (section.name.into(), of_section(section))).collect();
    let required: Vec<&str> = sections.iter().filter(|section| section.required).map(|section| section.name).collect();
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A scene of foldline",
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn of_section(section: &Section) -> Value {
    let mut table = match section.kind_key() {
        None => of_kind(section, None),
        Some(key) => {
            let Kind::Word(choices) = key.kind else { unreachable!("{} is not a word", key.path()) };
            let kinds: Vec<Value> = choices.iter().map(|choice| of_kind(section, Some(choice))).collect();
            json!({ "type": "object", "required": ["kind"], "oneOf": kinds })
        }
    };
    table["description"] = json!(section.meaning);
    if section.many { json!({ "type": "array", "description": section.meaning, "items": table }) } else { table }
}

/// A table of a kind, or of one that has none.
fn of_kind(section: &Section, kind: Option<&Choice>) -> Value {
    let keys = || section.keys_of(kind.map(|choice| choice.word)).filter(|key| kind.is_none() || key.name != "kind");
    let mut properties: Map<String, Value> = keys().map(|key| (key.name.to_owned(), of_key(key))).collect();
    let required = keys().filter(|key| key.presence == Presence::Required).map(|key| key.name);
    let mut table = json!({ "type": "object", "additionalProperties": false });
    table["required"] = kind.iter().map(|_| "kind").chain(required).collect();
    if let Some(choice) = kind {
        properties.insert("kind".into(), json!({ "const": choice.word, "description": choice.meaning }));
        table["title"] = json!(choice.word);
    }
    table["properties"] = Value::Object(properties);
    let rules: Vec<Value> = keys().flat_map(rules).collect();
    if !rules.is_empty() {
        table["allOf"] = json!(rules);
    }
    table
}

/// What a key asks of other keys of its table.
fn rules(key: &Key) -> Vec<Value> {
    let not_both = |other: &str| json!({ "not": { "required": [key.name, other] } });
    match key.presence {
        Presence::InsteadOf(other) => vec![not_both(other)],
        Presence::Unless(other) => {
            vec![not_both(other), json!({ "anyOf": [{ "required": [key.name] }, { "required": [other] }] })]
        }
        Presence::Required | Presence::Default(_) | Presence::Follows(_) => vec![],
    }
}

fn of_key(key: &Key) -> Value {
    let mut schema = of_values(&key.kind);
    schema["description"] = json!(format!("{} {}", key.meaning, key.presence.words()));
    schema["examples"] = json!([as_json(key.example)]);
    if let Presence::Default(text) = key.presence {
        schema["default"] = as_json(text);
    }
    schema
}

/// A value of TOML as one of JSON.
fn as_json(text: &str) -> Value {
    let entry: Result<BTreeMap<String, Value>, _> = toml::from_str(&format!("value = {text}"));
    entry.ok().and_then(|mut entry| entry.remove("value")).unwrap_or_default()
}

fn of_values(kind: &Kind) -> Value {
    match kind {
        Kind::Word(choices) => words(choices),
        Kind::Words(choices) => json!({ "type": "array", "items": words(choices), "minItems": 1 }),
        Kind::Number(limits) => within("number", limits),
        Kind::NumberOrPair(limits) => {
            either(within("number", limits), list(Length::Exactly(2), within("number", limits)))
        }
        Kind::NumberOr(word) => either(within("number", &Limits::ANY), json!({ "const": word })),
        Kind::Numbers(length, limits) => list(*length, within("number", limits)),
        Kind::Rows(length) => list(Length::Any, list(Length::Exactly(*length), within("number", &Limits::ANY))),
        Kind::Vector => {
            let number = within("number", &Limits::ANY);
            either(list(Length::Exactly(3), number.clone()), number)
        }
        Kind::Count(limits) => within("integer", limits),
        Kind::Pair(limits) => either(within("integer", limits), list(Length::Exactly(2), within("integer", limits))),
        Kind::Place(forms) => json!({ "anyOf": forms.iter().map(|form| place(*form)).collect::<Vec<_>>() }),
        Kind::Switch => json!({ "type": "boolean" }),
        Kind::Stages => {
            json!({ "type": "array", "items": { "enum": Stage::ALL.map(Stage::name) }, "minItems": 1, "uniqueItems": true })
        }
        Kind::Text => json!({ "type": "string" }),
    }
}

fn words(choices: &[Choice]) -> Value {
    json!({ "enum": choices.iter().map(|choice| choice.word).collect::<Vec<_>>() })
}

fn either(one: Value, other: Value) -> Value {
    json!({ "anyOf": [one, other] })
}

fn list(length: Length, items: Value) -> Value {
    match length {
        Length::Any => json!({ "type": "array", "items": items }),
        Length::Exactly(length) => json!({ "type": "array", "items": items, "minItems": length, "maxItems": length }),
    }
}

fn within(number: &str, limits: &Limits) -> Value {
    let mut schema = json!({ "type": number });
    let ends = [(limits.low, "minimum", "exclusiveMinimum"), (limits.high, "maximum", "exclusiveMaximum")];
    for (limit, included, excluded) in ends.into_iter().filter(|(limit, ..)| limit.value.is_finite()) {
        schema[if limit.included { included } else { excluded }] = json!(limit.value);
    }
    schema
}

fn place(form: Form) -> Value {
    let number = json!({ "type": "number", "minimum": 0, "maximum": 1 });
    match form {
        Form::Edge => json!({ "enum": EDGES.map(|(_, name)| name) }),
        Form::Point => list(Length::Exactly(2), number),
        Form::Line => json!({ "type": "string", "pattern": "^\\s*[uv]\\s*=\\s*\\+?[0-9.]+([eE][-+]?[0-9]+)?\\s*$" }),
    }
}
