//! Elements that look odd.

use super::key::key;
use crate::model::size::Size;
use crate::scene::{LengthLimit, Scene};
use crate::units::significant;

/// Length over width of an element of the starting mesh.
const MOST_ASPECT: f64 = 100.0;

pub(super) fn odd(scene: &Scene, size: &Size) -> Vec<String> {
    aspect(scene, size).into_iter().chain(limit(scene, size)).collect()
}

/// Elements far longer one way than the other: the numbers of elements along u and v are exchanged.
fn aspect(scene: &Scene, size: &Size) -> Option<String> {
    let elements = scene.mesh.elements;
    let lengths = [0, 1].map(|direction| size.sides_mm[direction] / elements[direction] as f64);
    let aspect = (lengths[0] / lengths[1]).max(lengths[1] / lengths[0]);
    (aspect > MOST_ASPECT).then(|| {
        let [length, width] = lengths.map(|length| significant(length, 3));
        format!("mesh.elements = {elements:?} makes elements of {length} × {width} mm: are u and v exchanged?")
    })
}

/// Refinement to less than the thickness.
fn limit(scene: &Scene, size: &Size) -> Option<String> {
    let LengthLimit::Millimetres(limits) = scene.adapt.as_ref()?.length_limit else { return None };
    let limit = limits[0].min(limits[1]);
    (limit < size.thickness_mm).then(|| {
        format!(
            "{} is less than the thickness, {} mm, of which the theory of shells knows nothing: is it in mm?",
            key("adapt.length_limit_mm", limit),
            significant(size.thickness_mm, 3)
        )
    })
}
