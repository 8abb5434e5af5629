//! What looks odd about a scene: numbers that are allowed, and most likely meant in another unit or another place.
//!
//! | file | what |
//! |---|---|
//! | `lengths` | extents, thickness, radii, arcs |
//! | `material` | moduli, strengths, density, angles of plies |
//! | `loads` | loads over stiffness, acceleration, numbers of load steps |
//! | `motion` | how far loads move the shell; turns of supports |
//! | `places` | loads and probes where the shell is held |
//! | `key` | a key with its value, in words |
//! | `elements` | shape of elements, and how small refinement makes them |
//!
//! What cannot be told from a scene that is meant as it stands is not said: u and v exchanged in the place of a support that
//! still holds the shell, or of a load that still moves it (a plate may be clamped along its long side); loads that are a
//! thousandth of what was meant where they are one load step, which may be small on purpose, or where they still move the shell by
//! more than a twentieth of its thickness; units that differ by a factor of ten, such as bar and MPa; angles from 5 to 6.28.
//!
//! A scene whose numbers are in units of its own says so (`units = "own"` in `[output]`), and none of them is odd.

mod elements;
mod key;
mod lengths;
mod loads;
mod material;
mod motion;
mod places;

pub use motion::{is_driven_by_loads, odd_motion};

use crate::model::size::Size;
use crate::scene::{NumbersIn, Scene};

/// Writes a sentence for each number of a scene that looks like a slip, with the number and what it may be; `size` is that of
/// its shell.
pub fn oddities(scene: &Scene, size: &Size) -> Vec<String> {
    if scene.output.units == NumbersIn::Own {
        return Vec::new();
    }
    if !scene.shells.is_empty() {
        return (0..scene.shells.len()).flat_map(|shell| of_shell(scene, shell)).collect();
    }
    let found = [
        lengths::odd(scene, size),
        material::odd(&scene.material),
        loads::odd(scene, size),
        elements::odd(scene, size),
        motion::odd_rotations(scene).into_iter().collect(),
        places::odd(scene),
    ];
    found.into_iter().flatten().collect()
}

/// What looks odd about one shell of a structure; its loads and supports are those of the structure.
fn of_shell(scene: &Scene, shell: usize) -> Vec<String> {
    let alone = scene.of_shell(shell);
    let Ok(size) = Size::of(&alone) else { return Vec::new() };
    let found = [lengths::odd(&alone, &size), material::odd(&alone.material), elements::odd(&alone, &size)];
    let name = scene.shell_name(shell).unwrap_or_default();
    found.into_iter().flatten().map(|odd| format!("shell \"{name}\": {odd}")).collect()
}
