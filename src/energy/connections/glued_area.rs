//! The area over which two shells are glued, and the points at which the energy of the layer is summed up there.
//!
//! They are points of one of the shells, the one that has more of them: the finer shell follows the other one. Its directions are divided
//! where either shell has a kink, and where the other one ends, so that a layer that begins or ends along a line does so at the end of a
//! panel.

use super::coupled::CoupledPoint;
use super::glue::Glue;
use super::greville_rule::{Piece, kinks, pieces};
use super::layer::{Faces, Layer};
use crate::model::{ModelError, gauss_points};
use crate::spline::{Grid, Spans, mid_surface_point};
use crate::units::place;

/// Gauss points in each direction of an element.
const GAUSS: usize = 2;
/// Points of a line at which it is seen where it runs on the other shell.
const LINE_SAMPLES: usize = 5;
/// Largest difference in a parameter along a line on which it counts as constant.
const STRAIGHT: f64 = 1e-6;

/// Where two shells are glued.
#[derive(Debug)]
pub(super) struct GluedArea {
    /// The shell whose points they are: the first (0) or the second one (1) of the bond.
    pub base: usize,
    pub panels: Vec<Panel>,
}

/// A rectangle in the parameters of the base.
#[derive(Debug)]
pub(super) struct Panel {
    pub pieces: [Piece; 2],
    /// The layer at their points, the second direction fastest; `None` where the faces do not lie together.
    pub layer: Vec<Option<CoupledPoint<Glue>>>,
}

impl GluedArea {
    /// Finds where the perfect surfaces of two shells lie together; the layer keeps the gap that the shells have.
    ///
    /// # Errors
    /// Where their faces do not lie together anywhere, or the shells cross each other.
    pub fn new(bond: &str, layer: &Layer) -> Result<Self, ModelError> {
        let [one, other] = [Looked::at(bond, layer, 0)?, Looked::at(bond, layer, 1)?];
        let (base, most) = if other.count() > one.count() { (1, &other) } else { (0, &one) };
        if most.count() == 0 {
            let (gap, at) = one.nearest;
            let (gap, at) = (gap.is_finite().then_some(gap), place(at));
            return Err(ModelError::NothingGlued { bond: bond.to_string(), gap, at, most: layer.tolerance });
        }
        let panels = most.panels.iter().filter(|panel| panel.count() > 0).map(|panel| panel.glued(layer, base));
        Ok(Self { base, panels: panels.collect() })
    }

    /// The part of the layer between the points, at two Gauss points in each direction of each element.
    pub fn gauss_points(&self, layer: &Layer) -> Vec<CoupledPoint<Glue>> {
        let (mut points, mut guess) = (Vec::new(), None);
        for panel in &self.panels {
            for [u, v] in element_points(&panel.pieces) {
                let at = [u[0], v[0]];
                let faces = layer.faces_at(self.base, at, &mut guess).filter(|faces| layer.is_glued(faces));
                points.extend(faces.map(|faces| {
                    let area = u[1] * v[1] * layer.area_at(self.base, at);
                    layer.glued(&faces, area, layer.between(faces.at))
                }));
            }
        }
        points
    }

    /// The layer at all points.
    pub fn into_points(self) -> Vec<CoupledPoint<Glue>> {
        self.panels.into_iter().flat_map(|panel| panel.layer).flatten().collect()
    }
}

/// What is seen from the points of one shell.
struct Looked {
    panels: Vec<LookedPanel>,
    /// Smallest distance of faces, mm, and where it is.
    nearest: (f64, [f64; 3]),
}

/// What is seen from the points of a panel, the second direction fastest: faces that lie together.
struct LookedPanel {
    pieces: [Piece; 2],
    faces: Vec<Option<Faces>>,
}

impl Looked {
    fn at(bond: &str, layer: &Layer, base: usize) -> Result<Self, ModelError> {
        let patch = layer.perfect(base);
        let breaks = breaks(layer, base);
        let [us, vs] = [0, 1].map(|k| pieces(&patch.knots[k], patch.degree[k], breaks[k].iter().copied()));
        let (mut panels, mut nearest, mut guess) = (Vec::new(), (f64::INFINITY, [0.0; 3]), None);
        for pieces in us.iter().flat_map(|u| vs.iter().map(move |v| [u.clone(), v.clone()])) {
            let mut faces = Vec::new();
            for at in grid(&pieces) {
                let found = layer.faces_at(base, at, &mut guess);
                if let Some(found) = &found {
                    let here = mid_surface_point(patch, &[], at).position;
                    if found.gap < nearest.0 {
                        nearest = (found.gap, here);
                    }
                    if found.gap < -layer.tolerance {
                        let (bond, at) = (bond.to_string(), place(here));
                        return Err(ModelError::ShellsCross { bond, by: -found.gap, at });
                    }
                }
                faces.push(found.filter(|found| layer.is_glued(found)));
            }
            let panel = LookedPanel { pieces, faces };
            panels.push(panel.without_touching_ends());
        }
        Ok(Self { panels, nearest })
    }

    fn count(&self) -> usize {
        self.panels.iter().map(LookedPanel::count).sum()
    }
}

impl LookedPanel {
    fn count(&self) -> usize {
        self.faces.iter().flatten().count()
    }

    /// Leaves out ends at which faces touch in no more than a line.
    fn without_touching_ends(self) -> Self {
        let Self { pieces, faces } = self;
        let grid = Grid::new(pieces.each_ref().map(|piece| piece.points.len()));
        let inner = |k: usize| {
            let [i, j] = grid.place(k);
            grid.index([pieces[0].inwards(i), pieces[1].inwards(j)])
        };
        let touches: Vec<bool> = (0..faces.len()).map(|k| faces[inner(k)].is_none()).collect();
        let faces = faces.into_iter().zip(touches).map(|(found, touches)| found.filter(|_| !touches)).collect();
        Self { pieces, faces }
    }

    fn glued(&self, layer: &Layer, base: usize) -> Panel {
        let [us, vs] = &self.pieces;
        let weights = us.weights.iter().flat_map(|u| vs.weights.iter().map(move |v| u * v));
        let of_point = |(faces, weight): (&Option<Faces>, f64)| {
            let faces = faces.as_ref()?;
            let between = layer.between(faces.at);
            Some(layer.glued(
                faces,
                weight * layer.area_at(base, faces.at[base]),
                between.map(|part| layer.stiffness - part),
            ))
        };
        Panel { pieces: self.pieces.clone(), layer: self.faces.iter().zip(weights).map(of_point).collect() }
    }
}

/// Gauss points with their weights in each direction, element by element: points of one element follow each other.
fn element_points(pieces: &[Piece; 2]) -> Vec<[[f64; 2]; 2]> {
    let of_spans = |piece: &Piece| -> Vec<Vec<[f64; 2]>> {
        let spans = Spans::of(&piece.knots, piece.degree).bounds;
        spans.into_iter().map(|span| gauss_points(span, GAUSS).collect()).collect()
    };
    let [us, vs] = pieces.each_ref().map(of_spans);
    let mut points = Vec::new();
    for (us, vs) in us.iter().flat_map(|us| vs.iter().map(move |vs| (us, vs))) {
        points.extend(us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])));
    }
    points
}

/// The points of a panel, the second direction fastest.
fn grid([us, vs]: &[Piece; 2]) -> impl Iterator<Item = [f64; 2]> {
    us.points.iter().flat_map(|u| vs.points.iter().map(move |v| [*u, *v]))
}

/// Parameters of the base, for each of its directions, at which lines of the other shell run across it: its edges and kinks.
fn breaks(layer: &Layer, base: usize) -> [Vec<f64>; 2] {
    let other = layer.perfect(1 - base);
    let mut breaks = [Vec::new(), Vec::new()];
    for direction in 0..2 {
        for kink in kinks(&other.knots[direction], other.degree[direction]) {
            let mut guess = None;
            let along = (0..LINE_SAMPLES).map(|k| k as f64 / (LINE_SAMPLES - 1) as f64);
            let seen = along.filter_map(|along| {
                let at = if direction == 0 { [kink, along] } else { [along, kink] };
                let faces = layer.faces_at(1 - base, at, &mut guess)?;
                layer.is_glued(&faces).then_some(faces.at[base])
            });
            let seen: Vec<[f64; 2]> = seen.collect();
            for (k, breaks) in breaks.iter_mut().enumerate() {
                breaks.extend(constant(seen.iter().map(|at| at[k])));
            }
        }
    }
    breaks
}

/// The value that two or more numbers share.
fn constant(numbers: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let (least, most) = numbers.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    (numbers.count() >= 2 && most - least <= STRAIGHT).then_some(0.5 * (least + most))
}
