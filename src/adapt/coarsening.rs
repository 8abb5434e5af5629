//! Knots taken out of a mesh: which, and what becomes of the displacements.
//!
//! What a knot is worth is the energy ½ dᵀKd of what its leaving takes from the displacement: its difference d from the best
//! approximation without it. Equilibrium on the coarser mesh costs less. The shares that spans have of the estimated error
//! say too little: a span whose displacement is nearly resolved has next to none, whatever happens when it grows. By them half of
//! the baseline's fold left at 44°, and had to come back.

use crate::adapt::refinement::{unweighted, weighted};
use crate::equilibrium::{Configuration, SolveError, Workspace};
use crate::scene::Scene;
use crate::shell::sub;
use crate::spline::{Coarsening, Grid, Patch, without_knots};
use crate::state::State;

/// Relative error of the measured quantity that is taken for a relative change of the energy: where spans are too long for the fold
/// of a tape spring, the moment has 5 to 17 times the relative error of the energy.
const OF_QUANTITY: f64 = 20.0;

/// A knot that may be removed.
struct Leaving {
    direction: usize,
    /// Its number among the inner knots of the direction.
    index: usize,
    knot: f64,
    /// Relative error that its removal adds.
    added: f64,
    /// The same for each control point that is removed with it.
    per_point: f64,
}

/// Finds inserted knots of the mesh of an equilibrium whose removal adds no more than `room` to the relative error: those that are
/// worth least, no two next to each other. What is in `start`, the mesh that the run starts with, stays.
///
/// # Errors
/// Where the stiffness cannot be formed.
pub fn superfluous(
    scene: &Scene,
    work: &mut Workspace,
    state: &State,
    start: &Patch,
    room: f64,
) -> Result<[Vec<f64>; 2], SolveError> {
    let mut candidates = Vec::new();
    for direction in 0..2 {
        candidates.extend(candidates_of(scene, work, state, start, direction)?);
    }
    candidates.sort_by(|a: &Leaving, b: &Leaving| a.per_point.total_cmp(&b.per_point));
    let mut room = room;
    let mut leaving: [Vec<(usize, f64)>; 2] = Default::default();
    for Leaving { direction, index, knot, added, .. } in candidates {
        let is_alone = leaving[direction].iter().all(|(other, _)| other.abs_diff(index) > 1);
        if added <= room && is_alone {
            room -= added;
            leaving[direction].push((index, knot));
        }
    }
    Ok(leaving.map(|mut knots| {
        knots.sort_by(|a, b| a.1.total_cmp(&b.1));
        knots.into_iter().map(|(_, knot)| knot).collect()
    }))
}

fn candidates_of(
    scene: &Scene,
    work: &mut Workspace,
    state: &State,
    start: &Patch,
    direction: usize,
) -> Result<Vec<Leaving>, SolveError> {
    let State { mesh, displacement, .. } = state;
    let patch = mesh.lone();
    let (knots, degree) = (&patch.knots[direction], patch.degree[direction]);
    let points = patch.control_counts()[1 - direction] as f64;
    let energy_of_model = state.strain_energy_n_mm.abs() / scene.symmetry.copies() as f64;
    let inner = &knots[degree + 1..knots.len() - degree - 1];
    let mut found = Vec::new();
    for (index, knot) in inner.iter().enumerate() {
        let times = inner.iter().filter(|other| *other == knot).count();
        if times > 1 || start.knots[direction].contains(knot) {
            continue;
        }
        let mut taken: [Vec<f64>; 2] = Default::default();
        taken[direction].push(*knot);
        let Some(coarsened) = Coarsened::new(patch, &taken, start) else { continue };
        let shown = coarsened.shown(displacement);
        let hidden: Vec<[f64; 3]> = displacement.iter().zip(shown).map(|(u, v)| sub(*u, v)).collect();
        let energy = work.energy_of_motion(Configuration::of(state), &hidden)?;
        let added = OF_QUANTITY * energy.abs() / energy_of_model;
        found.push(Leaving { direction, index, knot: *knot, added, per_point: added / points });
    }
    Ok(found)
}

/// A patch without some of its inserted knots, and the map of vectors at its control points to those that are left.
#[derive(Debug)]
pub struct Coarsened {
    /// The coarser patch; geometry as on the mesh that the run starts with, to rounding.
    pub patch: Patch,
    finer: Patch,
    maps: [Coarsening; 2],
}

impl Coarsened {
    /// Takes knots out of a patch; `start` is one that has none of them and the same geometry. `None` where it has.
    pub fn new(finer: &Patch, superfluous: &[Vec<f64>; 2], start: &Patch) -> Option<Self> {
        let kept = [0, 1].map(|k| without_knots(&finer.knots[k], &superfluous[k]));
        let count = |knots: &[f64], knot: &f64| knots.iter().filter(|other| *other == knot).count();
        let has_start =
            |k: usize| start.knots[k].iter().all(|knot| count(&kept[k], knot) >= count(&start.knots[k], knot));
        if finer.degree != start.degree || !(has_start(0) && has_start(1)) {
            return None;
        }
        let inserted = [0, 1].map(|k| without_knots(&kept[k], &start.knots[k]));
        // Geometry is inserted again rather than approximated.
        let patch = start.with_knots(&inserted);
        let maps = [0, 1].map(|k| Coarsening::new(&finer.knots[k], &patch.knots[k], finer.degree[k]));
        Some(Self { patch, finer: finer.clone(), maps })
    }

    /// The best approximation of vectors at the control points, in the coarser space.
    pub fn approximated(&self, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (_, net) = self.coarse_net(vectors);
        unweighted(&self.patch, &net)
    }

    /// The same at the control points of the finer mesh: what of the vectors the coarser space can show.
    fn shown(&self, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (mut grid, mut net) = self.coarse_net(vectors);
        for (direction, map) in self.maps.iter().enumerate() {
            (grid, net) = along(grid, direction, &net, |line| map.refined(line));
        }
        unweighted(&self.finer, &net)
    }

    /// The best approximation in homogeneous coordinates.
    fn coarse_net(&self, vectors: &[[f64; 3]]) -> (Grid, Vec<[f64; 3]>) {
        let mut net = weighted(&self.finer, vectors);
        let mut grid = self.finer.grid();
        for (direction, map) in self.maps.iter().enumerate() {
            (grid, net) = along(grid, direction, &net, |line| map.coarsened(line));
        }
        (grid, net)
    }
}

/// Applies a map to every line of a net along a direction.
fn along(
    grid: Grid,
    direction: usize,
    net: &[[f64; 3]],
    map: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>,
) -> (Grid, Vec<[f64; 3]>) {
    let lines = (0..grid.counts[1 - direction]).map(|beside| {
        let line: Vec<[f64; 3]> = grid.line(1 - direction, beside).map(|point| net[point]).collect();
        map(&line)
    });
    let lines: Vec<Vec<[f64; 3]>> = lines.collect();
    let mut counts = grid.counts;
    counts[direction] = lines.first().map_or(0, Vec::len);
    let after = Grid::new(counts);
    let point = |index: usize| {
        let place = after.place(index);
        lines[place[1 - direction]][place[direction]]
    };
    (after, (0..after.len()).map(point).collect())
}
