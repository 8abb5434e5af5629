//! Nested dissection: a separator splits the graph into two parts that do not meet and comes after both in the order of
//! elimination, and so on in either part (George, *SIAM J. Numer. Anal.* 10, 1973, p. 345; Lipton, Rose & Tarjan, ibid. 16,
//! 1979, p. 346). On a surface of n vertices the factor has O(n log n) numbers and takes O(n^1.5) operations.

use crate::equilibrium::sparse::graph::{Graph, OUTSIDE};
use crate::equilibrium::sparse::separator::separate;

/// Number of unknowns up to which a part is eliminated as one dense block. On 128 × 64 cubic elements, of 60, 100, 150 and
/// 220 unknowns, the operations are 7.96, 8.08, 8.40 and 8.99e9, in 471, 375, 255 and 203 blocks.
const LEAF: usize = 100;
/// Vertices with more neighbours than so many times √n come last: they would join all parts (as in approximate minimum
/// degree: Amestoy, Davis & Duff, *ACM Trans. Math. Softw.* 30, 2004, p. 381).
const HUB: f64 = 10.0;
/// Number of vertices from which on the two parts are dissected on threads of their own.
const SHARED: usize = 2000;

/// A block of vertices that are eliminated together, after all blocks below it.
#[derive(Debug, PartialEq)]
pub(super) struct Block {
    /// Vertices, ascending.
    pub vertices: Vec<u32>,
    /// Blocks that do not meet each other.
    pub below: Vec<Block>,
}

/// Dissects a graph; returns one tree of blocks for each of its components.
pub(super) fn dissect(graph: &Graph) -> Vec<Block> {
    let all: Vec<u32> = (0..graph.len() as u32).collect();
    components(graph, &all)
}

/// Dissects the components of a graph, whose vertices have other names outside.
fn components(graph: &Graph, names: &[u32]) -> Vec<Block> {
    let components = graph.components();
    if components.len() == 1 {
        return vec![connected(graph, names)];
    }
    let mut renamed = vec![OUTSIDE; graph.len()];
    let one = |vertices: &Vec<u32>| connected(&graph.part(vertices, &mut renamed), &named(vertices, names));
    components.iter().map(one).collect()
}

/// Dissects a connected graph.
fn connected(graph: &Graph, names: &[u32]) -> Block {
    let whole = || Block { vertices: names.to_vec(), below: Vec::new() };
    if graph.weight() <= LEAF {
        return whole();
    }
    let most = (HUB * (graph.len() as f64).sqrt()) as usize;
    let is_hub = |vertex: usize| graph.neighbours(vertex).len() > most;
    let sides = match (0..graph.len()).any(is_hub) {
        true => Some((0..graph.len()).map(|vertex| if is_hub(vertex) { 2 } else { 0 }).collect()),
        false => separate(graph),
    };
    let Some(sides) = sides else { return whole() };
    let of_side = |side: u8| -> Vec<u32> {
        let members = sides.iter().enumerate().filter(|(_, s)| **s == side);
        members.map(|(vertex, _)| vertex as u32).collect()
    };
    let [one, other, separator] = [of_side(0), of_side(1), of_side(2)];
    let below = |vertices: Vec<u32>| {
        let part = graph.part(&vertices, &mut vec![OUTSIDE; graph.len()]);
        components(&part, &named(&vertices, names))
    };
    let (mut one, other) = match graph.len() > SHARED {
        true => rayon::join(|| below(one), || below(other)),
        false => (below(one), below(other)),
    };
    one.extend(other);
    Block { vertices: named(&separator, names), below: one }
}

fn named(vertices: &[u32], names: &[u32]) -> Vec<u32> {
    vertices.iter().map(|vertex| names[*vertex as usize]).collect()
}
