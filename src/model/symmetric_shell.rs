//! In which lines through its middle a whole shell, with all that holds it and acts on it, is its own mirror image.

use crate::model::mirror_check::check_mirror_images;
use crate::model::start::starting_patch;
use crate::scene::{History, Hold, ParametricDirection, Region, Scene, Support, Symmetry};
use crate::spline::Patch;

/// Finds out whether the shell is its own mirror image in the line u = 0.5, and in v = 0.5: whether a plane of symmetry there would
/// be taken. Where a part is modelled already, what is cut is not symmetric again.
pub fn symmetric_lines(scene: &Scene, mesh: &Patch) -> [bool; 2] {
    if scene.end_rotation().is_some() {
        let cut = scene.symmetry.cuts();
        return [(0, Symmetry::HalfLength), (1, Symmetry::HalfArc)].map(|(direction, symmetry)| {
            !cut[direction] && starting_patch(&Scene { symmetry, ..scene.clone() }).is_ok()
        });
    }
    [ParametricDirection::U, ParametricDirection::V].map(|direction| {
        let plane = Support {
            name: "plane of symmetry".into(),
            on: Region::Line(direction, 0.5),
            shell: 0,
            also: Vec::new(),
            hold: Hold::Symmetric,
            history: History::default(),
        };
        let supports = scene.supports.iter().cloned().chain([plane]).collect();
        check_mirror_images(&Scene { supports, ..scene.clone() }, mesh).is_ok()
    })
}
