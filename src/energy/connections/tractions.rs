//! What bonds carry anywhere on the shells that they glue.
//!
//! A point of the first shell has the layer between it and the nearest point of the second, as the term has at its quadrature points.
//! A point of the second one has that of the nearest point of the first.

use std::borrow::Cow;

use super::glue::Traction;
use super::layer::{Layer, Searched, Side};
use crate::model::perfect_on;
use crate::scene::{Bond, Scene};
use crate::spline::Mesh;

/// The layers of all bonds of a structure.
#[derive(Debug)]
pub struct GluedLayers<'a> {
    list: Vec<GluedLayer<'a>>,
}

/// A shell that bonds glue to others, in a state of the structure.
#[derive(Debug)]
pub struct GluedShell<'a> {
    layers: &'a GluedLayers<'a>,
    shell: usize,
    displacement: &'a [[f64; 3]],
}

impl GluedShell<'_> {
    /// What a bond carries at the parameters (u, v); `None` where nothing is glued.
    pub fn traction(&self, at: [f64; 2]) -> Option<Traction> {
        self.layers.traction(self.shell, at, self.displacement)
    }
}

/// The layer of a bond between two shells.
#[derive(Debug)]
struct GluedLayer<'a> {
    shells: [usize; 2],
    layer: Layer<'a>,
    /// The first shell.
    one: Searched<'a>,
}

impl<'a> GluedLayers<'a> {
    /// Finds the layers of a scene on a mesh; none where it has no bond.
    pub fn new(scene: &'a Scene, mesh: &'a Mesh) -> Self {
        let ranges = mesh.ranges();
        // A mesh of a run has a perfect one, or the run would not have begun.
        let perfect = perfect_on(scene, mesh).unwrap_or(Cow::Borrowed(mesh));
        let of_bond = |bond: &'a Bond| {
            let sides = bond.shells.map(|shell| Side {
                patch: &mesh.patches[shell],
                perfect: match &perfect {
                    Cow::Borrowed(_) => Cow::Borrowed(&mesh.patches[shell]),
                    Cow::Owned(perfect) => Cow::Owned(perfect.patches[shell].clone()),
                },
                first: ranges[shell].start,
                material: &scene.shells[shell].material,
            });
            let one = Searched::new(sides[0].perfect.clone());
            GluedLayer { shells: bond.shells, layer: Layer::new(bond, sides), one }
        };
        Self { list: scene.bonds.iter().map(of_bond).collect() }
    }

    /// Returns what glues a shell where the control points of the structure are displaced (mm); `None` where nothing does.
    pub fn of_shell<'s>(&'s self, shell: usize, displacement: &'s [[f64; 3]]) -> Option<GluedShell<'s>> {
        let is_glued = self.list.iter().any(|glued| glued.shells.contains(&shell));
        is_glued.then_some(GluedShell { layers: self, shell, displacement })
    }

    /// Finds what is carried at the parameters (u, v) of a shell; of several bonds there, by the one that carries more.
    fn traction(&self, shell: usize, at: [f64; 2], displacement: &[[f64; 3]]) -> Option<Traction> {
        let here = self.list.iter().filter_map(|glued| glued.traction(shell, at, displacement));
        here.max_by(|one, other| one.size().total_cmp(&other.size()))
    }
}

impl GluedLayer<'_> {
    fn traction(&self, shell: usize, at: [f64; 2], displacement: &[[f64; 3]]) -> Option<Traction> {
        let place = self.shells.iter().position(|own| *own == shell)?;
        let Layer { other, tolerance, .. } = &self.layer;
        let nearest = match place {
            0 => other.nearest(self.layer.position(0, at), None),
            _ => self.one.nearest(self.layer.position(1, at), None),
        };
        let faces = self.layer.faces(if place == 0 { [at, nearest] } else { [nearest, at] })?;
        let point = (faces.gap <= *tolerance).then(|| self.layer.glued(&faces, 1.0))?;
        Some(point.law.traction(&point.deformed(displacement)))
    }
}
