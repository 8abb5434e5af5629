//! The shells of a structure one by one: each as a scene of its own on its own patch.

use std::borrow::Cow;
use std::ops::Range;

use crate::scene::{Scene, Support};
use crate::spline::{Mesh, Patch};

/// A shell of a structure.
#[derive(Debug)]
pub struct Member<'a> {
    /// Its place in the list of shells.
    pub index: usize,
    /// The shell alone, with what holds it and acts on it.
    pub scene: Cow<'a, Scene>,
    /// Its surface.
    pub patch: &'a Patch,
    /// Numbers of its control points among those of the structure.
    pub points: Range<usize>,
}

impl Member<'_> {
    /// Picks the supports of this shell from those of the structure.
    pub(super) fn supports(&self, all: &[Support]) -> Vec<Support> {
        all.iter().filter(|support| support.shell == self.index).cloned().collect()
    }
}

/// Lists the shells of a scene on a mesh.
pub fn members<'a>(scene: &'a Scene, mesh: &'a Mesh) -> Vec<Member<'a>> {
    let patches = mesh.patches.iter().zip(mesh.ranges()).enumerate();
    patches.map(|(index, (patch, points))| Member { index, scene: scene.of_shell(index), patch, points }).collect()
}
