//! A JSON Schema of scene files, for editors, from the table of keys. It accepts every scene; what it cannot say, such as
//! that an increment is at most the target, the parser alone refuses.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::data::Stage;
use super::key_table::{OF_A_SHELL, SECTIONS};
use super::keys::{Choice, Form, Key, Kind, Length, Limits, Presence, Section};
use super::regions::EDGES;

/// Generates the JSON schema (draft 7) of a scene file, pretty-printed.
pub fn json_schema() -> String {
    format!("{:#}\n", of_scene(SECTIONS))
}

/// The schema of a file of some tables.
pub(super) fn of_scene(sections: &[Section]) -> Value {
    let has_shells = sections.iter().any(|section| section.name == "shell");
    let of_file = |section: &Section| match section.name {
        "shell" => of_shells(section, sections),
        _ => of_section(section),
    };
    let properties: Map<String, Value> =
        sections.iter().map(|section| (section.name.into(), of_file(section))).collect();
    // What each shell of a structure has of its own is required where there is only one.
    let of_one = |section: &&Section| has_shells && OF_A_SHELL.contains(&section.name);
    let names = |of_shell: bool| -> Vec<&str> {
        let required = sections.iter().filter(|section| section.required && of_one(section) == of_shell);
        required.map(|section| section.name).collect()
    };
    let (required, alone) = (names(false), names(true));
    let shells = if has_shells { json!([{ "required": ["shell"] }, { "required": alone }]) } else { json!([{}]) };
    json!({
        "anyOf": shells,
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A scene of foldline",
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// The shells of a structure, with the tables below each of them.
fn of_shells(section: &Section, sections: &[Section]) -> Value {
    let mut table = of_table(section);
    for own in sections.iter().filter(|own| OF_A_SHELL.contains(&own.name)) {
        table["properties"][own.name] = of_section(own);
    }
    json!({ "type": "array", "description": section.meaning, "items": table })
}

fn of_section(section: &Section) -> Value {
    let table = of_table(section);
    if section.many { json!({ "type": "array", "description": section.meaning, "items": table }) } else { table }
}

/// All keys of a table, and the rules of its kind for them: editors complete the former, and show which of the latter is broken.
fn of_table(section: &Section) -> Value {
    let mut properties = Map::new();
    for key in section.keys {
        let same: Vec<Value> = section.keys.iter().filter(|other| other.name == key.name).map(of_key).collect();
        properties.insert(key.name.into(), if let [only] = &*same { only.clone() } else { json!({ "anyOf": same }) });
    }
    let mut table = match section.kind_key() {
        None => json!({ "required": required(section, None), "allOf": rules(section, None) }),
        Some(key) => {
            let kinds: Vec<Value> = key.words().map(|kind| of_kind(section, kind)).collect();
            json!({ "required": [key.name], "allOf": kinds })
        }
    };
    table["type"] = json!("object");
    table["description"] = json!(section.meaning);
    table["properties"] = Value::Object(properties);
    table["additionalProperties"] = json!(false);
    table
}

/// What holds in tables of a kind.
fn of_kind(section: &Section, kind: &str) -> Value {
    let names: Vec<&str> = section.keys_of(Some(kind)).map(|key| key.name).collect();
    // Those of one name that mean another thing in another kind.
    let several = |key: &&Key| section.keys.iter().filter(|other| other.name == key.name).count() > 1;
    let own = section.keys_of(Some(kind)).filter(several);
    let properties: Map<String, Value> = own.map(|key| (key.name.into(), of_values(&key.kind))).collect();
    json!({
        "if": { "properties": { "kind": { "const": kind } }, "required": ["kind"] },
        "then": {
            "required": required(section, Some(kind)),
            "propertyNames": { "enum": names },
            "properties": properties,
            "allOf": rules(section, Some(kind)),
        },
    })
}

fn required(section: &Section, kind: Option<&str>) -> Vec<&'static str> {
    section.keys_of(kind).filter(|key| key.presence == Presence::Required).map(|key| key.name).collect()
}

/// What the keys of a table ask of each other, and a rule that asks nothing: a schema has no empty list of rules.
fn rules(section: &Section, kind: Option<&str>) -> Vec<Value> {
    section.keys_of(kind).flat_map(rules_of).chain([json!({})]).collect()
}

/// What a key asks of other keys of its table.
fn rules_of(key: &Key) -> Vec<Value> {
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
    if let Some(section) = key.items {
        schema["items"] = of_table(section);
    }
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
        Kind::Tables => json!({ "type": "array", "minItems": 1 }),
        Kind::Vector => {
            let number = within("number", &Limits::ANY);
            either(list(Length::Exactly(3), number.clone()), number)
        }
        Kind::Count(limits) => within("integer", limits),
        Kind::Pair(limits) => either(within("integer", limits), list(Length::Exactly(2), within("integer", limits))),
        Kind::Region(forms) => json!({ "anyOf": forms.iter().map(|form| place(*form)).collect::<Vec<_>>() }),
        Kind::Switch => json!({ "type": "boolean" }),
        Kind::Stages => {
            json!({ "type": "array", "items": { "enum": Stage::ALL.map(Stage::name) }, "minItems": 1, "uniqueItems": true })
        }
        Kind::Text => json!({ "type": "string" }),
        Kind::Texts(length) => list(*length, json!({ "type": "string" })),
        Kind::Edges(length) => {
            let edges = EDGES.map(|(_, name)| name).join("|");
            list(*length, json!({ "type": "string", "pattern": format!("^.+\\.({edges})$") }))
        }
    }
}

/// One of some words; what each means is shown by editors that complete by Taplo.
fn words(choices: &[Choice]) -> Value {
    let words: Vec<&str> = choices.iter().map(|choice| choice.word).collect();
    let meanings: Vec<&str> = choices.iter().map(|choice| choice.meaning).collect();
    json!({ "enum": words, "x-taplo": { "docs": { "enumValues": meanings } } })
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
