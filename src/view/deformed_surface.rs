//! The deformed shell as samples for pictures: the whole of it, whatever part is modelled.

use rayon::prelude::*;

use super::bonded::ShellsOfState;
use super::fields::{Field, ShellFields};
use super::samples::{SamplesError, SurfaceSamples, cells_of};
use crate::model::{Member, members};
use crate::scene::Scene;
use crate::shell::{add, cross, dot, norm, sub};
use crate::spline::{Grid, LineBasis, Mesh, Patch, SurfaceBasis, SurfacePoint, position_on_lines};
use crate::state::State;

/// Points and values on a grid that follows the elements.
struct SampleGrid {
    counts: [usize; 2],
    points: Vec<[f64; 3]>,
    values: Vec<f64>,
}

/// What the cells of a sampled surface show.
struct Shown<'v> {
    /// Value where two lines of the parameters meet.
    value: &'v (dyn Fn([&LineBasis; 2]) -> f64 + Sync),
    /// Sign of the value at images in the planes of symmetry across the length and through the apex.
    image: [f64; 2],
    /// Its name, with its unit.
    quantity: String,
}

/// Samples the shells of `scene` on `mesh`, displaced by `displacement` (mm, one vector for each control point), with
/// `cells_per_element` cells along u and along v in every element. The value of a cell is the larger of the physical bending
/// strains |κᵢᵢ|/|Aᵢ|² along the length and along the arc at its middle, 1/mm. Symmetric parts are reflected.
///
/// # Errors
/// Where a displacement is not finite.
///
/// # Panics
/// Where `displacement` does not have the length of the mesh's control points.
pub fn deformed_surface(
    scene: &Scene,
    mesh: &Mesh,
    displacement: &[[f64; 3]],
    cells_per_element: [usize; 2],
) -> Result<SurfaceSamples, SamplesError> {
    of_shells(members(scene, mesh), |Member { scene, patch, points, .. }| {
        let moved = &displacement[points];
        let value =
            |[along, across]: [&LineBasis; 2]| bending_strain(patch, moved, &SurfaceBasis::of(patch, along, across));
        let shown = Shown { value: &value, image: [1.0; 2], quantity: "bending strain max|κ| (1/mm)".to_owned() };
        sampled(&scene, patch, moved, cells_per_element, shown)
    })
}

/// The same with the values of a component of a field, or with the length of all of them; shells without that field show nothing
/// of it.
///
/// # Errors
/// Where a displacement is not finite.
pub fn coloured_surface(
    scene: &Scene,
    state: &State,
    field: &Field,
    component: Option<usize>,
    cells_per_element: [usize; 2],
) -> Result<SurfaceSamples, SamplesError> {
    of_shells(ShellsOfState::new(scene, state).fields(), |fields: ShellFields| {
        let (scene, patch, moved) = fields.parts();
        let of = |value: [f64; 3]| component.map_or_else(|| norm(value), |index| value[index]);
        let value = |lines: [&LineBasis; 2]| of(fields.at(lines.map(|line| line.parameter)).value(field));
        let image = [0, 1].map(|direction| of(field.mirrored([1.0; 3], direction)).signum());
        let shown = Shown { value: &value, image, quantity: field.title_of(component) };
        sampled(scene, patch, moved, cells_per_element, shown)
    })
}

/// The shells of a state moved by `mode` (mm, one vector for each control point), with the motion relative to the largest as the
/// value of a cell.
///
/// # Errors
/// Where a displacement is not finite.
pub fn mode_surface(
    scene: &Scene,
    state: &State,
    mode: &[[f64; 3]],
    cells_per_element: [usize; 2],
) -> Result<SurfaceSamples, SamplesError> {
    let mut samples = of_shells(members(scene, &state.mesh), |Member { scene, patch, points, .. }| {
        let (mode, displacement) = (&mode[points.clone()], &state.displacement[points]);
        let motion = |lines: [&LineBasis; 2]| {
            let [to, from] = [mode, &[]].map(|moved| position_on_lines(patch, moved, lines));
            norm(sub(to, from))
        };
        let moved: Vec<[f64; 3]> = displacement.iter().zip(mode).map(|(u, motion)| add(*u, *motion)).collect();
        let shown = Shown { value: &motion, image: [1.0; 2], quantity: "motion in the mode, relative".to_owned() };
        sampled(&scene, patch, &moved, cells_per_element, shown)
    })?;
    let largest = samples.value_range().map_or(1.0, |[_, largest]| largest.max(f64::MIN_POSITIVE));
    samples.cell_values.iter_mut().for_each(|value| *value /= largest);
    Ok(samples)
}

/// Samples every shell, and puts the surfaces together.
fn of_shells<S>(
    shells: impl IntoIterator<Item = S>,
    of: impl Fn(S) -> Result<SurfaceSamples, SamplesError>,
) -> Result<SurfaceSamples, SamplesError> {
    let parts = shells.into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
    SurfaceSamples::joined(parts).ok_or(SamplesError::TooFewPoints { counts: [0, 0] })
}

fn sampled(
    scene: &Scene,
    mesh: &Patch,
    displacement: &[[f64; 3]],
    cells_per_element: [usize; 2],
    shown: Shown,
) -> Result<SurfaceSamples, SamplesError> {
    assert_eq!(displacement.len(), mesh.control_points.len());
    let parts = cells_per_element.map(|cells| cells.max(1));
    let [along, across] = [0, 1].map(|direction| divided(&mesh.knots[direction], parts[direction]));
    let points = on_grid(mesh, [&along, &across], &|lines| position_on_lines(mesh, displacement, lines));
    let middles = |lines: &[f64]| lines.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<f64>>();
    let values = on_grid(mesh, [&middles(&along), &middles(&across)], shown.value);
    let mut grid = SampleGrid { counts: [along.len(), across.len()], points, values };
    let [cut_at_middle, cut_at_apex] = scene.symmetry.cuts();
    if cut_at_middle {
        grid = grid.with_reflection_along(shown.image[0]);
    }
    if cut_at_apex {
        grid = grid.with_reflection_across(shown.image[1]);
    }
    let lines = grid.knot_lines(parts);
    let SampleGrid { counts, points, values } = grid;
    SurfaceSamples::new(counts, points, values, lines, &shown.quantity)
}

/// What is found where lines of the parameters meet, the second direction fastest.
fn on_grid<T: Send>(mesh: &Patch, lines: [&[f64]; 2], find: &(dyn Fn([&LineBasis; 2]) -> T + Sync)) -> Vec<T> {
    let [along, across] = [0, 1].map(|direction| {
        let at = |parameter: &f64| LineBasis::at(mesh, direction, *parameter);
        lines[direction].iter().map(at).collect::<Vec<_>>()
    });
    let row = |along: &LineBasis| across.iter().map(|across| find([along, across])).collect::<Vec<T>>();
    along.par_iter().map(row).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// Every element's parameters, divided into equal parts.
fn divided(knots: &[f64], parts: usize) -> Vec<f64> {
    let spans = knots.windows(2).filter(|span| span[0] < span[1]);
    let inner = spans.flat_map(|span| (1..=parts).map(|i| span[0] + (span[1] - span[0]) * i as f64 / parts as f64));
    knots.first().copied().into_iter().chain(inner).collect()
}

/// The larger of |B₁₁ − b₁₁|/A₁₁ and |B₂₂ − b₂₂|/A₂₂ at a point.
fn bending_strain(mesh: &Patch, displacement: &[[f64; 3]], basis: &SurfaceBasis) -> f64 {
    let curvatures = |surface: &SurfacePoint| {
        let [a1, a2, a11, a22, _] = surface.derivatives;
        let normal = cross(a1, a2);
        [a11, a22].map(|second| dot(second, normal) / norm(normal))
    };
    let [undeformed, deformed] = [&[][..], displacement].map(|moved| basis.point(mesh, moved));
    let [before, after] = [&undeformed, &deformed].map(curvatures);
    let physical = |i: usize| {
        let tangent = undeformed.derivatives[i];
        (before[i] - after[i]).abs() / dot(tangent, tangent)
    };
    physical(0).max(physical(1))
}

impl SampleGrid {
    /// A line of points along which the parameter in `direction` is constant.
    fn line(&self, direction: usize, along: usize) -> impl DoubleEndedIterator<Item = [f64; 3]> + ExactSizeIterator {
        Grid::new(self.counts).line(direction, along).map(|point| self.points[point])
    }

    /// A row of values between two lines of points along the arc.
    fn value_row(&self, along: usize) -> impl DoubleEndedIterator<Item = f64> {
        cells_of(self.counts).line(0, along).map(|cell| self.values[cell])
    }

    /// Points each way with an image that shares one line in a direction.
    fn counts_doubled(&self, direction: usize) -> [usize; 2] {
        let mut counts = self.counts;
        counts[direction] = 2 * counts[direction] - 1;
        counts
    }

    /// With its image beyond the last row, in the plane x = const. through that row.
    fn with_reflection_along(self, sign: f64) -> Self {
        let n1 = self.counts[0];
        let last_row = self.line(0, n1 - 1);
        let count = last_row.len() as f64;
        let plane = last_row.map(|point| point[0]).sum::<f64>() / count;
        let image = |[x, y, z]: [f64; 3]| [2.0 * plane - x, y, z];
        let rows = (0..n1 - 1).rev().flat_map(|i| self.line(0, i)).map(image);
        let points = self.points.iter().copied().chain(rows).collect();
        let own = (0..n1 - 1).flat_map(|i| self.value_row(i));
        let images = (0..n1 - 1).rev().flat_map(|i| self.value_row(i)).map(|value| sign * value);
        let values = own.chain(images).collect();
        Self { counts: self.counts_doubled(0), points, values }
    }

    /// With its image before the first column, in the plane y = 0 through it.
    fn with_reflection_across(self, sign: f64) -> Self {
        let n1 = self.counts[0];
        let image = |[x, y, z]: [f64; 3]| [x, -y, z];
        let widened = |i: usize| self.line(0, i).skip(1).rev().map(image).chain(self.line(0, i));
        let points = (0..n1).flat_map(widened).collect();
        let values = (0..n1 - 1)
            .flat_map(|i| self.value_row(i).rev().map(|value| sign * value).chain(self.value_row(i)))
            .collect();
        Self { counts: self.counts_doubled(1), points, values }
    }

    /// Every `parts`-th line of the grid in each direction.
    fn knot_lines(&self, parts: [usize; 2]) -> Vec<Vec<[f64; 3]>> {
        let lines = |direction: usize| {
            (0..self.counts[direction])
                .step_by(parts[direction])
                .map(move |along| self.line(direction, along).collect())
        };
        lines(0).chain(lines(1)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::starting_mesh;
    use crate::scene::{self, Symmetry};

    const SCENE: &str = r#"
        [geometry]
        kind = "tape-spring"
        length_mm = 60.0
        radius_mm = 10.0
        arc_deg = 80.0
        [material]
        kind = "isotropic"
        youngs_modulus_mpa = 131000.0
        poissons_ratio = 0.3
        thickness_mm = 0.1
        [mesh]
        degree = [3, 3]
        elements = [4, 4]
        [load]
        kind = "end-rotation"
        sense = "opposite"
        rotation_deg = 10.0
        increment_deg = 1.0
        [pipeline]
        stages = ["solve"]
    "#;

    fn undeformed(symmetry: Symmetry, cells_per_element: usize) -> SurfaceSamples {
        let scene = Scene { symmetry, ..scene::parse(SCENE, "test").unwrap() };
        let mesh = starting_mesh(&scene).unwrap();
        let displacement = vec![[0.0; 3]; mesh.point_count()];
        deformed_surface(&scene, &mesh, &displacement, [cells_per_element; 2]).unwrap()
    }

    #[test]
    fn parts_make_the_whole() {
        let whole = undeformed(Symmetry::None, 2);
        assert_eq!(whole.grids, [[9, 9]]);
        assert_eq!(whole.knot_lines.len(), 10);
        for symmetry in [Symmetry::HalfLength, Symmetry::HalfArc, Symmetry::Quarter] {
            let completed = undeformed(symmetry, 2);
            assert_eq!(completed.grids, whole.grids);
            assert_eq!(completed.knot_lines.len(), whole.knot_lines.len());
            for (point, expected) in completed.points.iter().zip(&whole.points) {
                // The arc is parametrized again in each part: the same cylinder, points along it a little apart.
                let off: f64 = (0..3).map(|k| (point[k] - expected[k]).powi(2)).sum::<f64>().sqrt();
                assert!(off < 0.2, "{symmetry:?}: {point:?} for {expected:?}");
            }
        }
    }

    #[test]
    fn flattening_the_section_bends_it_by_its_curvature() {
        let scene = scene::parse(SCENE, "test").unwrap();
        let mesh = starting_mesh(&scene).unwrap();
        // Onto the tangent plane at the apex, along the z axis.
        let apex = mesh.points().map(|[_, _, z]| z).fold(f64::MIN, f64::max);
        let displacement: Vec<_> = mesh.points().map(|[_, _, z]| [0.0, 0.0, apex - z]).collect();
        let samples = deformed_surface(&scene, &mesh, &displacement, [3; 2]).unwrap();
        assert!(samples.points.iter().all(|point| (point[2] - apex).abs() < 1e-12));
        assert!(samples.cell_values.iter().all(|value| (value - 0.1).abs() < 1e-12), "{:?}", samples.cell_values);
    }

    #[test]
    fn at_rest_nothing_is_bent() {
        assert!(undeformed(Symmetry::Quarter, 1).cell_values.iter().all(|value| *value == 0.0));
    }
}
