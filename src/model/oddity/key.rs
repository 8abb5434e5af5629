//! A key with its value, and what may have been meant by a place, in words.

use crate::scene::Region;
use crate::units::significant;

/// The name of a key with its value, as a scene has them.
pub(super) fn key(name: &str, value: f64) -> String {
    format!("{name} = {}", significant(value, 6))
}

/// Asks whether the place with u and v exchanged was meant; of a corner on the diagonal, only whether this one was.
pub(super) fn exchanged(on: Region) -> String {
    match on.exchanged() {
        other if other == on => "is another place meant?".to_owned(),
        other => format!("are u and v exchanged, and on = {other} meant?"),
    }
}
