//! A key is described in one place: reading, errors, hints, help and schema follow from there.

use super::document::Document;
use super::error::SceneError;
use super::fault::Source;
use super::keys::{Key, Kind, Limit, Limits, Presence, Reach, Section};
use super::tables::Tables;
use super::{help, identity, schema};

static WITH_DAMPER: [Section; 1] = [Section {
    name: "damper",
    many: false,
    required: true,
    meaning: "What takes energy out.",
    keys: &[Key::new(
        "damper",
        "rest_force_n",
        Kind::Number(Limits { low: Limit::excluded(0.0, "a damper pushes back"), high: Limit::NONE }),
        "4.0",
    )
    .means("Force at rest.")
    .or(Presence::Default("2.0"))
    .reaches(Reach::Steps)
    .also_called(&["f0"])],
}];

fn read(text: &str) -> Result<f64, String> {
    let tables = Document::read::<&str>(text, &[], &WITH_DAMPER).map_err(|fault| vec![*fault]);
    let value = tables.and_then(|document| Ok(Tables::read(&document)?.one("damper").get("rest_force_n")));
    let source = Source { name: "damper.toml".into(), text: text.into() };
    value.map_err(|faults| SceneError::new(faults, vec![source]).plain())
}

#[test]
fn range_default_unit_and_hints_follow() {
    assert_eq!(read("[damper]"), Ok(2.0));
    assert_eq!(read("[damper]\nrest_force_n = 3"), Ok(3.0));
    let says = |text: &str, what: &str| {
        let error = read(text).unwrap_err();
        assert!(error.contains(what), "{error}");
    };
    says("[damper]\nrest_force_n = -3.0", "must be a number greater than 0 N");
    says("[damper]\nrest_force_n = -3.0", "a damper pushes back");
    says("[damper]\nrest_force_kn = 0.003", "did you mean `rest_force_n`? 0.003 kN are 3 N");
    says("[damper]\nrest_force_n = \"3 N\"", "+ rest_force_n = 3.0");
    says("[damper]\nrset_force_n = 3.0", "did you mean `rest_force_n`?");
    says("[damper]\nf0 = 3.0", "did you mean `rest_force_n`? (the value is in N)");
    says("[dampre]", "did you mean [damper]?");
}

#[test]
fn help_schema_and_reach_follow() {
    let text = help::of_section(&WITH_DAMPER[0]);
    assert!(
        text.contains("  rest_force_n = 4.0\n      Force at rest. A number greater than 0 N. Default: 2.0.\n"),
        "{text}"
    );
    let schema = schema::of_scene(&WITH_DAMPER);
    let key = serde_json::json!({
        "type": "number",
        "exclusiveMinimum": 0.0,
        "default": 2.0,
        "examples": [4.0],
        "description": "Force at rest. Default: 2.0.",
    });
    assert_eq!(schema["properties"]["damper"]["properties"]["rest_force_n"], key);
    assert_eq!(schema["required"], serde_json::json!(["damper"]));
    assert_eq!(identity::reach(&WITH_DAMPER, "damper.rest_force_n"), Reach::Steps);
}
