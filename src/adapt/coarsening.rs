//! Knots taken out of a mesh: which, and what becomes of the displacements.

use std::sync::Arc;

use crate::adapt::estimate::JudgedMesh;
use crate::spline::{Coarsening, Grid, Mesh, Spans};

/// A knot that may leave, and what that costs.
struct Leaving {
    direction: usize,
    /// The span that ends at it.
    span: usize,
    knot: f64,
    /// Error that its leaving adds, relative.
    added: f64,
    /// The same for each unknown that leaves with it.
    per_unknown: f64,
}

/// Knots of a mesh that are not in the one that the run starts with and whose leaving keeps the estimated error below `target`:
/// those that cost least for each unknown, no two of them at one span.
///
/// A span that grows from h to H has (H/h)^(2(p−1)) times the error.
pub(super) fn superfluous(judged: &JudgedMesh, start: &Mesh, target: f64) -> [Vec<f64>; 2] {
    let mut candidates: Vec<Leaving> = [0, 1].into_iter().flat_map(|k| candidates(judged, start, k)).collect();
    candidates.sort_by(|a, b| a.per_unknown.total_cmp(&b.per_unknown));
    let mut room = target - judged.relative.iter().sum::<f64>();
    let mut leaving: [Vec<f64>; 2] = Default::default();
    let mut touched = judged.lengths.each_ref().map(|lengths| vec![false; lengths.len()]);
    for Leaving { direction, span, knot, added, .. } in candidates {
        let spans = &mut touched[direction][span..span + 2];
        if added <= room && spans.iter().all(|touched| !touched) {
            room -= added;
            spans.fill(true);
            leaving[direction].push(knot);
        }
    }
    leaving.iter_mut().for_each(|knots| knots.sort_by(f64::total_cmp));
    leaving
}

fn candidates(judged: &JudgedMesh, start: &Mesh, direction: usize) -> Vec<Leaving> {
    let JudgedMesh { mesh, errors, relative, lengths, .. } = judged;
    let degree = mesh.degree[direction];
    let bounds = Spans::of(&mesh.knots[direction], degree).bounds;
    let (shares, lengths) = (&errors[direction].shares, &lengths[direction]);
    let sum: f64 = shares.iter().map(|share| share.abs()).sum();
    let order = 2 * (degree as i32 - 1);
    let inserted = bounds.iter().enumerate().take(bounds.len() - 1).filter(|(_, [_, knot])| {
        let times = mesh.knots[direction].iter().filter(|other| *other == knot).count();
        times == 1 && !start.knots[direction].contains(knot)
    });
    let leaving = |(span, [_, knot]): (usize, &[f64; 2])| {
        let whole = lengths[span] + lengths[span + 1];
        let grown = |span: usize| shares[span].abs() * ((whole / lengths[span]).powi(order) - 1.0);
        let added = relative[direction] * (grown(span) + grown(span + 1)) / sum.max(f64::MIN_POSITIVE);
        let unknowns = mesh.control_counts()[1 - direction] as f64;
        Leaving { direction, span, knot: *knot, added, per_unknown: added / unknowns }
    };
    inserted.map(leaving).collect()
}

/// A mesh without some of its inserted knots, and the map of vectors at its control points to those that are left.
#[derive(Debug)]
pub struct Coarsened {
    /// The coarser mesh; geometry as on the mesh that the run starts with, to rounding.
    pub mesh: Arc<Mesh>,
    finer: Arc<Mesh>,
    maps: [Coarsening; 2],
}

impl Coarsened {
    /// Takes knots out of a mesh; `start` is one that has none of them and the same geometry.
    pub fn new(finer: &Arc<Mesh>, superfluous: &[Vec<f64>; 2], start: &Mesh) -> Self {
        let kept = [0, 1].map(|k| without(&finer.knots[k], &superfluous[k]));
        let inserted = [0, 1].map(|k| without(&kept[k], &start.knots[k]));
        // Geometry is inserted again rather than approximated.
        let mesh = Arc::new(start.with_knots(&inserted));
        let maps = [0, 1].map(|k| Coarsening::new(&finer.knots[k], &mesh.knots[k], finer.degree[k]));
        Self { mesh, finer: finer.clone(), maps }
    }

    /// The best approximation of vectors at the control points, in the coarser space.
    pub fn approximated(&self, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let weighted = |(vector, point): (&[f64; 3], &[f64; 4])| vector.map(|value| value * point[3]);
        let mut net: Vec<[f64; 3]> = vectors.iter().zip(&self.finer.control_points).map(weighted).collect();
        let mut grid = self.finer.grid();
        for (direction, map) in self.maps.iter().enumerate() {
            (grid, net) = along(grid, direction, &net, |line| map.coarsened(line));
        }
        net.iter().zip(&self.mesh.control_points).map(|(vector, point)| vector.map(|value| value / point[3])).collect()
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

/// Knots without some of them; both ascending.
fn without(knots: &[f64], taken: &[f64]) -> Vec<f64> {
    let mut taken = taken.iter().peekable();
    knots.iter().copied().filter(|knot| taken.next_if(|other| *other == knot).is_none()).collect()
}
