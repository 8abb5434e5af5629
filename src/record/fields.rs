//! The fields of a report by name, for conditions and for the index of a long log.

use serde_json::Value;

use crate::record::Report;

/// Lists the fields of a report by name; the numbers of a pair also follow one by one.
pub fn fields_of(report: &Report) -> Vec<(String, Value)> {
    let Ok(Value::Object(object)) = serde_json::to_value(report) else { return Vec::new() };
    let mut fields = Vec::new();
    for (name, value) in object {
        // Probes are listed by their own names, below.
        if name == "probes" {
            continue;
        }
        if let Value::Array(pair) = &value {
            for (index, part) in pair.iter().enumerate() {
                fields.push((format!("{name}_{}", index + 1), part.clone()));
            }
            let numbers: Vec<f64> = pair.iter().filter_map(as_number).collect();
            let whole = match name.as_str() {
                "elements" => numbers.iter().product(),
                "marked" => numbers.iter().sum(),
                _ => numbers.iter().copied().fold(f64::MIN, f64::max),
            };
            fields.push((name, Value::from(whole)));
        } else {
            fields.push((name, value));
        }
    }
    for probe in &report.probes {
        fields.push((probe.name.clone(), Value::from(probe.value)));
    }
    fields
}

/// Reads a field as a number: true is 1, and what is neither number nor truth is `None`.
pub fn as_number(value: &Value) -> Option<f64> {
    value.as_f64().or_else(|| value.as_bool().map(|truth| if truth { 1.0 } else { 0.0 }))
}
