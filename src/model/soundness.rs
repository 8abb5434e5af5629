//! Checks of a surface that a user gives: it does not fold over itself, has a normal everywhere, and edges that
//! coincide are declared as a seam.
//!
//! Normals are examined on a grid: points of every span and its ends. From one to the next they turn by less than a
//! quarter turn, or do once the step between them is halved often enough; where they never do the surface turns over.
//! Between points, the area of a parameter square is followed to its least value, which a fold or a collapse takes to
//! zero.

use crate::model::ModelError;
use crate::model::limits::POSITION;
use crate::scene::Seam;
use crate::shell::{cross, dot, norm, scaled, sub};
use crate::spline::{Patch, Spans, SurfacePoint, mid_surface_point};
use crate::units::{place, significant};

/// Area of a parameter square, relative to the largest, below which there is none.
const NO_AREA: f64 = 1e-9;
/// Number of halvings of a step after which a normal that still turns over is taken to do so.
const HALVINGS: usize = 12;
/// Ratio of an area to the neighbouring ones below which it may lie next to a fold.
const DIP: f64 = 0.9;
/// Number of steps towards the least area between two points; each leaves two thirds of the interval.
const LEAST_AREA_STEPS: usize = 40;

/// A point of the grid.
#[derive(Clone, Copy)]
struct Sample {
    at: [f64; 2],
    position: [f64; 3],
    /// A₁ × A₂.
    area: [f64; 3],
}

impl Sample {
    fn new(patch: &Patch, at: [f64; 2]) -> Self {
        let SurfacePoint { position, derivatives } = mid_surface_point(patch, &[], at);
        Self { at, position, area: cross(derivatives[0], derivatives[1]) }
    }

    fn between(patch: &Patch, one: &Sample, other: &Sample, share: f64) -> Self {
        Self::new(patch, [0, 1].map(|direction| one.at[direction] + share * (other.at[direction] - one.at[direction])))
    }
}

/// Refuses a surface that folds over itself or has no normal somewhere.
///
/// # Errors
/// Where the surface does.
pub fn check_normals(patch: &Patch) -> Result<(), ModelError> {
    let [along, across] = [0, 1].map(|direction| parameters(patch, direction));
    let grid: Vec<Vec<Sample>> =
        along.iter().map(|u| across.iter().map(|v| Sample::new(patch, [*u, *v])).collect()).collect();
    let largest = grid.iter().flatten().map(|sample| norm(sample.area)).fold(0.0, f64::max);
    let least = NO_AREA * largest;
    let columns = (0..across.len()).map(|j| grid.iter().map(|row| row[j]).collect::<Vec<Sample>>());
    let lines: Vec<Vec<Sample>> = grid.iter().cloned().chain(columns).collect();
    // Where there is no area there is no normal either, which is reported for the point itself.
    let has_area = |pair: &&[Sample]| pair.iter().all(|sample| norm(sample.area) > least);
    let mut pairs = lines.iter().flat_map(|line| line.windows(2)).filter(has_area);
    if let Some(pair) = pairs.find(|pair| turns_over(patch, &pair[0], &pair[1], HALVINGS)) {
        return Err(folds(&pair[0], &pair[1]));
    }
    if let Some(point) = grid.iter().flatten().find(|sample| norm(sample.area) <= least) {
        return Err(ModelError::Collapsed { at: place(point.position) });
    }
    let mut threes = lines.iter().flat_map(|line| line.windows(3));
    threes.try_for_each(|three| check_area(patch, [&three[0], &three[1], &three[2]], least))
}

/// Lists the parameters of the grid: both ends of every span, and more points in between than a polynomial area has
/// turning points.
fn parameters(patch: &Patch, direction: usize) -> Vec<f64> {
    let steps = 2 * patch.degree[direction] + 1;
    Spans::of(&patch.knots[direction], patch.degree[direction]).samples(steps)
}

/// Whether the normal turns over between two points, however near each other they are.
fn turns_over(patch: &Patch, one: &Sample, other: &Sample, halvings: usize) -> bool {
    if dot(one.area, other.area) > 0.0 {
        return false;
    }
    if halvings == 0 {
        return true;
    }
    let middle = Sample::between(patch, one, other, 0.5);
    turns_over(patch, one, &middle, halvings - 1) || turns_over(patch, &middle, other, halvings - 1)
}

/// Checks the area where the middle of three points has the least: follows it to the least one between the outer two,
/// projected on the normal of the middle.
fn check_area(patch: &Patch, [before, middle, after]: [&Sample; 3], least: f64) -> Result<(), ModelError> {
    let size = norm(middle.area);
    let beside = [before, after].map(|sample| norm(sample.area));
    if size > beside[0].min(beside[1]) || size > DIP * beside[0].max(beside[1]) {
        return Ok(());
    }
    let normal = scaled(1.0 / size, middle.area);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..LEAST_AREA_STEPS {
        let [one, other] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        let [first, second] = [one, other].map(|share| Sample::between(patch, before, after, share));
        if let Some(found) = [&first, &second].into_iter().find(|sample| dot(sample.area, normal) <= least) {
            return Err(match dot(found.area, normal) < -least {
                true => folds(middle, found),
                false => ModelError::Collapsed { at: place(found.position) },
            });
        }
        match dot(first.area, normal) < dot(second.area, normal) {
            true => high = other,
            false => low = one,
        }
    }
    Ok(())
}

fn folds(one: &Sample, other: &Sample) -> ModelError {
    let angle_deg = norm(cross(one.area, other.area)).atan2(dot(one.area, other.area)).to_degrees();
    ModelError::FoldsOver { from: place(one.position), to: place(other.position), angle_deg }
}

/// Largest distances of the two edges across each direction, mm: as they are, and with one of them reversed.
struct Gaps {
    same: [f64; 2],
    reversed: [f64; 2],
    tolerance: f64,
}

impl Gaps {
    fn new(patch: &Patch) -> Self {
        let corner = patch.point(0);
        let arms = patch.points().map(|point| sub(point, corner));
        let tolerance = POSITION * arms.map(norm).fold(0.0, f64::max);
        let gap = |direction: usize, reversed: bool| {
            let on = |end: f64, at: f64| {
                mid_surface_point(patch, &[], if direction == 0 { [end, at] } else { [at, end] }).position
            };
            let distance = |at: f64| norm(sub(on(0.0, at), on(1.0, if reversed { 1.0 - at } else { at })));
            parameters(patch, 1 - direction).into_iter().map(distance).fold(0.0, f64::max)
        };
        Self { same: [gap(0, false), gap(1, false)], reversed: [gap(0, true), gap(1, true)], tolerance }
    }
}

/// Finds the directions in which the surface closes: the edge at the end is that at the start.
pub fn closed_directions(patch: &Patch) -> [bool; 2] {
    let gaps = Gaps::new(patch);
    gaps.same.map(|gap| gap <= gaps.tolerance)
}

/// Checks that the scene's seam agrees with the edges that coincide.
///
/// # Errors
/// Where opposite edges coincide and no seam is given, or the other way round.
pub fn check_seam(patch: &Patch, seam: Option<Seam>) -> Result<(), ModelError> {
    const EDGES: [&str; 2] = ["u-start and u-end", "v-start and v-end"];
    let gaps = Gaps::new(patch);
    let shown = |gap: f64| significant(gap, 3);
    let meeting = (0..2).find(|direction| gaps.same[*direction] <= gaps.tolerance);
    let reversed = (0..2).find(|direction| gaps.reversed[*direction] <= gaps.tolerance);
    match (seam, meeting, reversed) {
        (None, Some(direction), _) => Err(ModelError::EdgesMeet {
            edges: EDGES[direction],
            gap_mm: shown(gaps.same[direction]),
            tolerance_mm: shown(gaps.tolerance),
        }),
        (None | Some(Seam::Smooth), _, Some(direction)) => {
            Err(ModelError::EdgesMeetReversed { edges: EDGES[direction] })
        }
        (Some(_), None, None) => {
            Err(ModelError::NoSeam { gaps_mm: gaps.same.map(shown), tolerance_mm: shown(gaps.tolerance) })
        }
        _ => Ok(()),
    }
}
