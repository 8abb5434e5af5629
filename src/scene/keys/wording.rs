//! Numbers and lists in sentences, and numbers in TOML.

/// A number as an engineer would write it: `300`, `0.019`, `1e-7`.
pub(in crate::scene) fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) { format!("{value:e}") } else { format!("{value}") }
}

/// A number as TOML writes floats: `300.0`, `0.019`, `1e-7`.
pub(in crate::scene) fn toml_float(value: f64) -> String {
    format!("{value:?}")
}

/// Items in a sentence: `a, b or c`.
pub(in crate::scene) fn join_or(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} or {last}", rest.join(", ")),
    }
}
