//! A small set of vertices that splits a connected graph in two.
//!
//! Distances along the graph stand for coordinates, of which nothing is known. From four vertices far from each other
//! (on a patch: its corners), d_a − d_b, (d_a + d_c) − (d_b + d_d) and the like grow from one side to the other, with
//! straight contours between them; so do distances from a whole side. Each contour cuts the graph, and the best of all
//! is straightened by moves of single vertices (Fiduccia & Mattheyses 1982, for separators of vertices: Ashcraft & Liu,
//! *SIAM J. Matrix Anal. Appl.* 19, 1998, p. 325).

use std::collections::BinaryHeap;

use crate::equilibrium::sparse::graph::{FAR, Graph};

/// Number of moves without a gain after which refinement stops.
const PATIENCE: usize = 120;
/// Number of rounds of refinement at most.
const ROUNDS: usize = 6;
/// Number of cuts that are refined.
const REFINED: usize = 2;
/// Share of the unknowns that each side keeps at least.
const LEAST_SHARE: f64 = 0.1;

/// Finds a separator: 0 or 1 for each vertex of either side, 2 for those between; `None` where there is none that
/// leaves enough on both sides.
pub(super) fn separate(graph: &Graph) -> Option<Vec<u8>> {
    let mut cuts: Vec<Cut> = fields(graph).iter().filter_map(|field| best_contour(graph, field)).collect();
    cuts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    cuts.truncate(REFINED);
    let refined = cuts.into_iter().map(|cut| {
        let mut refinement = Refinement::new(graph, cut.sides);
        for _ in 0..ROUNDS {
            if !refinement.round() {
                break;
            }
        }
        Cut { cost: refinement.cost(), sides: refinement.sides }
    });
    let best = refined.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    best.cost.is_finite().then_some(best.sides)
}

/// A split of the graph with its cost.
struct Cut {
    cost: f64,
    sides: Vec<u8>,
}

/// Cost of a separator for the unknowns of both sides and of itself: its share, more so where the sides differ.
fn cost([one, other, separator]: [u64; 3]) -> f64 {
    let (one, other, separator) = (one as f64, other as f64, separator as f64);
    let whole = one + other + separator;
    if one.min(other) < LEAST_SHARE * (whole - separator) || one.min(other) == 0.0 {
        return f64::INFINITY;
    }
    separator * whole / one.min(other).powf(0.5) / one.max(other).powf(0.5)
}

/// Functions on the vertices whose contours may cut well.
fn fields(graph: &Graph) -> Vec<Vec<i32>> {
    // The vertex farthest from those before it, with the fewest neighbours of several: a corner.
    let corner = |distances: &[u32]| -> u32 {
        let key = |vertex: &u32| {
            (std::cmp::Reverse(distances[*vertex as usize]), graph.neighbours(*vertex as usize).len(), *vertex)
        };
        (0..graph.len() as u32).min_by_key(key).unwrap_or_default()
    };
    let farthest = |distances: &[u32]| -> Vec<u32> {
        let most = distances.iter().copied().max().unwrap_or(FAR);
        (0..graph.len() as u32).filter(|vertex| distances[*vertex as usize] == most).collect()
    };
    let a = graph.distances(&[corner(&graph.distances(&[0]))]);
    let mut nearest = a.clone();
    let mut next = || {
        let distances = graph.distances(&[corner(&nearest)]);
        nearest.iter_mut().zip(&distances).for_each(|(least, distance)| *least = (*least).min(*distance));
        distances
    };
    let [b, c, d] = [next(), next(), next()];
    let side = graph.distances(&farthest(&a));
    let other_side = graph.distances(&farthest(&side));
    let sum = |plus: [&[u32]; 2], minus: [&[u32]; 2]| -> Vec<i32> {
        let value = |v: usize| (plus[0][v] + plus[1][v]) as i32 - (minus[0][v] + minus[1][v]) as i32;
        (0..graph.len()).map(value).collect()
    };
    vec![
        sum([&a, &a], [&b, &b]),
        sum([&a, &c], [&b, &d]),
        sum([&a, &d], [&b, &c]),
        sum([&a, &b], [&c, &d]),
        sum([&side, &side], [&other_side, &other_side]),
    ]
}

/// The best cut along a contour of a field: vertices below it, and those that meet them as the separator.
fn best_contour(graph: &Graph, field: &[i32]) -> Option<Cut> {
    let least = *field.iter().min()?;
    let count = (*field.iter().max()? - least) as usize + 2;
    let level = |vertex: usize| (field[vertex] - least) as usize;
    // Unknowns below each level, and in the separator: those whose lowest neighbour is below it, and they are not.
    let (mut below, mut separator) = (vec![0_i64; count + 1], vec![0_i64; count + 1]);
    let lowest: Vec<usize> = (0..graph.len())
        .map(|v| graph.neighbours(v).iter().map(|other| level(*other as usize)).min().unwrap_or(usize::MAX))
        .collect();
    for vertex in 0..graph.len() {
        let weight = i64::from(graph.weights[vertex]);
        below[level(vertex) + 1] += weight;
        if lowest[vertex] < level(vertex) {
            separator[lowest[vertex] + 1] += weight;
            separator[level(vertex) + 1] -= weight;
        }
    }
    let whole = graph.weight() as i64;
    let (mut under, mut between) = (0, 0);
    let mut best = (f64::INFINITY, 0);
    for cut in 0..count {
        under += below[cut];
        between += separator[cut];
        let cost = cost([under, whole - under - between, between].map(|weight| weight as u64));
        if cost < best.0 {
            best = (cost, cut);
        }
    }
    let side = |vertex: usize| match (level(vertex) < best.1, lowest[vertex] < best.1) {
        (true, _) => 0,
        (false, false) => 1,
        (false, true) => 2,
    };
    best.0.is_finite().then(|| Cut { cost: best.0, sides: (0..graph.len()).map(side).collect() })
}

/// Moves of single vertices out of the separator, each of which draws its neighbours of the other side in.
struct Refinement<'a> {
    graph: &'a Graph,
    sides: Vec<u8>,
    /// Unknowns of the sides and of the separator.
    weights: [u64; 3],
    /// Round in which a vertex left the separator: it does not leave it again in that round.
    moved: Vec<u32>,
    round: u32,
}

impl<'a> Refinement<'a> {
    fn new(graph: &'a Graph, sides: Vec<u8>) -> Self {
        let mut weights = [0; 3];
        for (side, weight) in sides.iter().zip(&graph.weights) {
            weights[usize::from(*side)] += u64::from(*weight);
        }
        Self { graph, moved: vec![0; sides.len()], sides, weights, round: 0 }
    }

    fn cost(&self) -> f64 {
        cost(self.weights)
    }

    /// Unknowns by which the separator shrinks where a vertex of it goes to a side.
    fn gain(&self, vertex: usize, to: u8) -> i64 {
        let drawn = self.graph.neighbours(vertex).iter().filter(|other| self.sides[**other as usize] == 1 - to);
        let drawn = drawn.map(|other| i64::from(self.graph.weights[*other as usize])).sum::<i64>();
        i64::from(self.graph.weights[vertex]) - drawn
    }

    fn set(&mut self, vertex: usize, side: u8) {
        let weight = u64::from(self.graph.weights[vertex]);
        self.weights[usize::from(self.sides[vertex])] -= weight;
        self.weights[usize::from(side)] += weight;
        self.sides[vertex] = side;
    }

    /// Moves vertices, the best first, also at a loss, and goes back to the best state on the way; says whether it is
    /// better than the first.
    fn round(&mut self) -> bool {
        self.round += 1;
        let mut queue = BinaryHeap::new();
        // Of equal gains the vertex that entered the queue last: neighbours of the last move, which go on with it.
        let mut entered = 0_u64;
        let offer = |this: &Self, queue: &mut BinaryHeap<(i64, u64, usize, u8)>, entered: &mut u64, vertex: usize| {
            for to in [0, 1] {
                *entered += 1;
                queue.push((this.gain(vertex, to), *entered, vertex, to));
            }
        };
        for vertex in (0..self.sides.len()).filter(|vertex| self.sides[*vertex] == 2) {
            offer(self, &mut queue, &mut entered, vertex);
        }
        let start = self.cost();
        let (mut best, mut best_length) = (start, 0);
        let mut log: Vec<(usize, u8)> = Vec::new();
        let mut moves = 0;
        while let Some((gain, _, vertex, to)) = queue.pop() {
            let stale = self.sides[vertex] != 2 || self.moved[vertex] == self.round || self.gain(vertex, to) != gain;
            if stale || self.weights[usize::from(1 - to)] as i64 <= gain.abs() {
                continue;
            }
            log.push((vertex, 2));
            self.moved[vertex] = self.round;
            self.set(vertex, to);
            let mut touched = Vec::new();
            for other in self.graph.neighbours(vertex) {
                let other = *other as usize;
                if self.sides[other] == 1 - to {
                    log.push((other, 1 - to));
                    self.set(other, 2);
                    touched.push(other);
                    let near = self.graph.neighbours(other).iter().map(|near| *near as usize);
                    touched.extend(near.filter(|near| self.sides[*near] == 2));
                }
            }
            let near = self.graph.neighbours(vertex).iter().map(|near| *near as usize);
            touched.extend(near.filter(|near| self.sides[*near] == 2));
            touched.sort_unstable();
            touched.dedup();
            for other in touched.into_iter().filter(|other| self.moved[*other] != self.round) {
                offer(self, &mut queue, &mut entered, other);
            }
            moves += 1;
            if self.cost() < best {
                (best, best_length, moves) = (self.cost(), log.len(), 0);
            }
            if moves > PATIENCE {
                break;
            }
        }
        for (vertex, side) in log.drain(best_length..).rev() {
            self.set(vertex, side);
        }
        best < start
    }
}
