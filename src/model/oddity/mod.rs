//! What looks odd about a scene: numbers that are allowed, and most likely meant in another unit or another place.
//!
//! | file | what |
//! |---|---|
//! | `lengths` | extents, thickness, radii, arcs |
//! | `material` | moduli, strengths, density, angles of plies |
//! | `loads` | loads over stiffness, acceleration, numbers of load steps |
//! | `key` | a key with its value, in words |
//! | `elements` | shape of elements, and how small refinement makes them |
//!
//! A scene whose numbers are in units of its own says so (`units = "own"` in `[output]`), and none of them is odd.

mod elements;
mod key;
mod lengths;
mod loads;
mod material;

use crate::model::size::Size;
use crate::scene::{NumbersIn, Scene};

/// Writes a sentence for each number of a scene that looks like a slip, with the number and what it may be; `size` is that of
/// its shell.
pub fn oddities(scene: &Scene, size: &Size) -> Vec<String> {
    if scene.output.units == NumbersIn::Own {
        return Vec::new();
    }
    let found = [
        lengths::odd(scene, size),
        material::odd(&scene.material),
        loads::odd(scene, size),
        elements::odd(scene, size),
    ];
    found.into_iter().flatten().collect()
}
