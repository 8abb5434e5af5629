//! The whole shell of a state, whatever part of it is modelled: one NURBS surface, undeformed and deformed.
//!
//! A part is completed by its images in the planes of symmetry. The line in a plane becomes a knot of multiplicity p, so the
//! surface stays the one that was computed; it is smooth there as far as the support holds its tangents.

use crate::scene::Scene;
use crate::spline::{Grid, Patch};
use crate::state::State;
use crate::view::fields::{Field, FieldPoint, ShellFields};

/// Share of an element by which its border is evaluated inside it.
const INSIDE: f64 = 1e-10;

/// The whole shell of a state.
#[derive(Debug)]
pub struct WholeShell<'a> {
    /// Its name in a structure.
    name: Option<&'a str>,
    fields: ShellFields<'a>,
    /// Whether the model is cut across the length, and along the apex.
    cuts: [bool; 2],
    undeformed: Patch,
    deformed: Patch,
}

impl<'a> WholeShell<'a> {
    /// Completes the shell of a state of a scene.
    pub fn new(scene: &'a Scene, state: &'a State) -> Self {
        Self::of(ShellFields::new(scene, state.mesh.lone(), &state.displacement, state.parameter), None)
    }

    /// Completes a shell of which these are the fields.
    pub(in crate::view) fn of(fields: ShellFields<'a>, name: Option<&'a str>) -> Self {
        let (scene, model, displacement) = fields.parts();
        let (mut undeformed, mut deformed) = (model.clone(), moved(model, displacement));
        let cuts = scene.symmetry.cuts();
        if cuts[0] {
            let grid = model.grid();
            let row: Vec<f64> = grid.line(0, grid.counts[0] - 1).map(|control| model.point(control)[0]).collect();
            let plane = row.iter().sum::<f64>() / row.len() as f64;
            let image = |[x, y, z, w]: [f64; 4]| [2.0 * plane * w - x, y, z, w];
            [undeformed, deformed] = [undeformed, deformed].map(|mesh| with_image(&mesh, 0, Image::After, image));
        }
        if cuts[1] {
            let image = |[x, y, z, w]: [f64; 4]| [x, -y, z, w];
            [undeformed, deformed] = [undeformed, deformed].map(|mesh| with_image(&mesh, 1, Image::Before, image));
        }
        Self { name, fields, cuts, undeformed, deformed }
    }

    /// The shell as one that is alone.
    pub fn without_name(self) -> Self {
        Self { name: None, ..self }
    }

    /// Its name in a structure of several shells.
    pub fn name(&self) -> Option<&'a str> {
        self.name
    }

    /// Whether it has a field of the structure at all.
    pub fn has(&self, field: &Field) -> bool {
        self.fields.has(field)
    }

    /// The undeformed surface; its parameters are in [0, 1].
    pub fn undeformed(&self) -> &Patch {
        &self.undeformed
    }

    /// The deformed surface, with the knots of the undeformed one.
    pub fn deformed(&self) -> &Patch {
        &self.deformed
    }

    /// Displacements of the control points, mm.
    pub fn displacement(&self) -> impl Iterator<Item = [f64; 3]> {
        displacements(&self.undeformed, &self.deformed)
    }

    /// A point of an element that has these bounds in the parameters: what jumps at a knot has the value of this element on its
    /// border.
    pub fn at_in(&self, bounds: [[f64; 2]; 2], at: [f64; 2]) -> WholePoint<'_> {
        self.at([0, 1].map(|direction| {
            let [from, to] = bounds[direction];
            let gap = INSIDE * (to - from);
            at[direction].clamp(from + gap, to - gap)
        }))
    }

    /// A point of the parameters of the whole shell.
    pub fn at(&self, [u, v]: [f64; 2]) -> WholePoint<'_> {
        let (u, in_image_along) = match self.cuts[0] {
            true if u > 0.5 => (2.0 - 2.0 * u, true),
            true => (2.0 * u, false),
            false => (u, false),
        };
        let (v, in_image_across) = match self.cuts[1] {
            true if v < 0.5 => (1.0 - 2.0 * v, true),
            true => (2.0 * v - 1.0, false),
            false => (v, false),
        };
        WholePoint { point: self.fields.at([u, v]), is_image: [in_image_along, in_image_across] }
    }
}

/// A point of the whole shell, of which every field can be read.
#[derive(Debug)]
pub struct WholePoint<'a> {
    point: FieldPoint<'a>,
    /// Whether it lies beyond the plane across the length, and beyond that through the apex.
    is_image: [bool; 2],
}

impl WholePoint<'_> {
    /// The components of a field; those beyond its number are 0.
    pub fn value(&self, field: &Field) -> [f64; 3] {
        let planes = (0..2).filter(|direction| self.is_image[*direction]);
        planes.fold(self.point.value(field), |value, direction| field.mirrored(value, direction))
    }
}

/// Displacements that take the control points of one mesh to those of another, mm.
pub(super) fn displacements(from: &Patch, to: &Patch) -> impl Iterator<Item = [f64; 3]> {
    from.points().zip(to.points()).map(|(from, to)| [0, 1, 2].map(|c| to[c] - from[c]))
}

/// The mesh with its control points moved, mm.
fn moved(mesh: &Patch, displacement: &[[f64; 3]]) -> Patch {
    let at = |([x, y, z, w], [dx, dy, dz]): (&[f64; 4], &[f64; 3])| [x + w * dx, y + w * dy, z + w * dz, *w];
    Patch { control_points: mesh.control_points.iter().zip(displacement).map(at).collect(), ..mesh.clone() }
}

/// Where an image lies in the parameter.
#[derive(Clone, Copy, PartialEq)]
enum Image {
    Before,
    After,
}

/// A surface on [0, 1]² and its image, joined along the last line in `direction` (or the first one, for an image before it);
/// parameters of the whole are again in [0, 1].
fn with_image(mesh: &Patch, direction: usize, side: Image, image: impl Fn([f64; 4]) -> [f64; 4]) -> Patch {
    let degree = mesh.degree[direction];
    let half = |knot: &f64| if side == Image::After { 0.5 * knot } else { 0.5 + 0.5 * knot };
    let own: Vec<f64> = mesh.knots[direction].iter().map(half).collect();
    let mirrored: Vec<f64> = own.iter().rev().map(|knot| 1.0 - knot).collect();
    let [first, second] = if side == Image::After { [own, mirrored] } else { [mirrored, own] };
    let joint = std::iter::repeat_n(0.5, degree);
    let knots = first[..first.len() - degree - 1].iter().copied().chain(joint).chain(second[degree + 1..].to_vec());

    let from = mesh.grid();
    let count = from.counts[direction];
    let mut counts = from.counts;
    counts[direction] = 2 * count - 1;
    let to = Grid::new(counts);
    let control = |index: usize| {
        let mut place = to.place(index);
        let along = place[direction];
        let is_image = if side == Image::After { along >= count } else { along + 1 < count };
        place[direction] = match side {
            Image::After => along.min(2 * count - 2 - along),
            Image::Before => (along + 1).abs_diff(count),
        };
        let point = mesh.control_points[from.index(place)];
        if is_image { image(point) } else { point }
    };
    let mut whole = mesh.clone();
    whole.knots[direction] = knots.collect();
    whole.control_points = (0..to.len()).map(control).collect();
    whole
}
