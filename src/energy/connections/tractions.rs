//! What bonds carry anywhere on the shells that they glue.
//!
//! A layer that is much stiffer than the elements are small carries tractions that are right at its points only: between them −k r holds
//! the difference of two splines, times a large k. So the tractions are those of the spline through the ones at the points, and none where
//! nothing is glued.

use std::borrow::Cow;

use super::glue::Traction;
use super::glued_area::{GluedArea, Panel};
use super::greville_rule::Piece;
use super::layer::{Layer, Side};
use crate::model::perfect_on;
use crate::scene::{Bond, Scene};
use crate::spline::{Mesh, ScalarSurface};

/// The layers of all bonds of a structure, in a state of it.
#[derive(Debug)]
pub struct GluedLayers<'a> {
    list: Vec<GluedLayer<'a>>,
}

/// A shell that bonds glue to others.
#[derive(Debug)]
pub struct GluedShell<'a> {
    layers: &'a GluedLayers<'a>,
    shell: usize,
}

impl GluedShell<'_> {
    /// What a bond carries at the parameters (u, v); `None` where nothing is glued. Of several bonds there, by the one that carries most.
    pub fn traction(&self, at: [f64; 2]) -> Option<Traction> {
        let here = self.layers.list.iter().filter_map(|glued| glued.traction(self.shell, at));
        here.max_by(|one, other| one.size().total_cmp(&other.size()))
    }
}

impl<'a> GluedLayers<'a> {
    /// Finds the layers of a scene on a mesh whose control points are displaced (mm); none where it has no bond.
    pub fn new(scene: &'a Scene, mesh: &'a Mesh, displacement: &[[f64; 3]]) -> Self {
        let ranges = mesh.ranges();
        // A mesh of a run has a perfect one, and lies together, or the run would not have begun.
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
            let layer = Layer::new(bond, sides);
            let GluedArea { base, panels } = GluedArea::new(&bond.name, &layer).ok()?;
            let panels = panels.iter().map(|panel| TractionPanel::new(panel, displacement)).collect();
            Some(GluedLayer { shells: bond.shells, layer, base, panels })
        };
        Self { list: scene.bonds.iter().filter_map(of_bond).collect() }
    }

    /// Returns what glues a shell; `None` where nothing does.
    pub fn of_shell(&self, shell: usize) -> Option<GluedShell<'_>> {
        let is_glued = self.list.iter().any(|glued| glued.shells.contains(&shell));
        is_glued.then_some(GluedShell { layers: self, shell })
    }
}

/// The layer of a bond between two shells.
#[derive(Debug)]
struct GluedLayer<'a> {
    shells: [usize; 2],
    layer: Layer<'a>,
    base: usize,
    panels: Vec<TractionPanel>,
}

impl GluedLayer<'_> {
    fn traction(&self, shell: usize, at: [f64; 2]) -> Option<Traction> {
        let side = self.shells.iter().position(|own| *own == shell)?;
        let faces = self.layer.faces_at(side, at, &mut None).filter(|faces| self.layer.is_glued(faces))?;
        let at = faces.at[self.base];
        self.panels.iter().find(|panel| panel.contains(at)).map(|panel| panel.at(at))
    }
}

/// The tractions of a panel: the peel, and both components of the shear.
#[derive(Debug)]
struct TractionPanel {
    ends: [[f64; 2]; 2],
    components: [ScalarSurface; 3],
}

impl TractionPanel {
    fn new(Panel { pieces, layer }: &Panel, displacement: &[[f64; 3]]) -> Self {
        let at_points: Vec<[f64; 3]> = layer
            .iter()
            .map(|point| {
                point.as_ref().map_or([0.0; 3], |point| {
                    let Traction { peel_mpa, shear_mpa: [one, two] } =
                        point.law.traction(&point.deformed(displacement));
                    [peel_mpa, one, two]
                })
            })
            .collect();
        let through = |component: usize| {
            let values: Vec<f64> = at_points.iter().map(|traction| traction[component]).collect();
            let places = pieces.each_ref().map(|piece| &piece.points[..]);
            ScalarSurface::of(
                pieces.each_ref().map(|piece| piece.knots.clone()),
                pieces.each_ref().map(|piece| piece.degree),
                places,
                &values,
            )
        };
        Self { ends: pieces.each_ref().map(Piece::ends), components: [0, 1, 2].map(through) }
    }

    fn contains(&self, at: [f64; 2]) -> bool {
        (0..2).all(|k| (self.ends[k][0]..=self.ends[k][1]).contains(&at[k]))
    }

    fn at(&self, at: [f64; 2]) -> Traction {
        let [peel_mpa, one, two] = self.components.each_ref().map(|component| component.at(at));
        Traction { peel_mpa, shear_mpa: [one, two] }
    }
}
