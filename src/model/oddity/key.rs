//! A key with its value, in words.

use crate::units::significant;

/// The name of a key with its value, as a scene has them.
pub(super) fn key(name: &str, value: f64) -> String {
    format!("{name} = {}", significant(value, 6))
}
