//! The graph of a structure, compressed: unknowns that meet the same others, as those of a control point do, are one
//! vertex (Ashcraft, *SIAM J. Sci. Comput.* 16, 1995, p. 1404).

use std::collections::HashMap;

use crate::equilibrium::sparse::structure::Couplings;

/// Undirected graph: the neighbours of each vertex, without itself, ascending.
#[derive(Debug, Default)]
pub(super) struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// Number of unknowns of each vertex.
    pub weights: Vec<u32>,
}

impl Graph {
    /// Creates a graph from its edges, each in one direction only, with repetitions or without.
    fn new(weights: Vec<u32>, edges: &[[u32; 2]]) -> Self {
        let mut starts = vec![0; weights.len() + 1];
        for vertex in edges.as_flattened() {
            starts[*vertex as usize + 1] += 1;
        }
        for vertex in 0..weights.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; 2 * edges.len()];
        for [a, b] in edges {
            for (from, to) in [(*a as usize, *b), (*b as usize, *a)] {
                neighbours[next[from] as usize] = to;
                next[from] += 1;
            }
        }
        // Repetitions go.
        let (mut kept, mut begin) = (0, 0);
        for vertex in 0..weights.len() {
            let end = starts[vertex + 1] as usize;
            neighbours[begin..end].sort_unstable();
            let first = kept;
            for k in begin..end {
                if kept == first || neighbours[kept - 1] != neighbours[k] {
                    neighbours[kept] = neighbours[k];
                    kept += 1;
                }
            }
            begin = end;
            starts[vertex + 1] = kept as u32;
        }
        neighbours.truncate(kept);
        Self { starts, neighbours, weights }
    }

    /// Compresses a structure; returns the unknowns of each vertex, too.
    pub fn compress(couplings: &Couplings) -> (Self, Vec<Vec<u32>>) {
        let mut groups_of: Vec<Vec<u32>> = vec![Vec::new(); couplings.unknowns];
        for (group, unknowns) in couplings.groups.iter().enumerate() {
            for unknown in unknowns {
                if groups_of[*unknown].last() != Some(&(group as u32)) {
                    groups_of[*unknown].push(group as u32);
                }
            }
        }
        let mut members: Vec<Vec<u32>> = Vec::new();
        let mut vertices_of: Vec<Vec<u32>> = vec![Vec::new(); couplings.groups.len()];
        let mut known: HashMap<&[u32], usize> = HashMap::new();
        for (unknown, groups) in groups_of.iter().enumerate() {
            let new = members.len();
            // An unknown of no group meets none.
            let vertex = if groups.is_empty() { new } else { *known.entry(groups).or_insert(new) };
            if vertex == new {
                members.push(Vec::new());
                groups.iter().for_each(|group| vertices_of[*group as usize].push(new as u32));
            }
            members[vertex].push(unknown as u32);
        }
        let mut edges = Vec::with_capacity(couplings.pairs.len());
        for [i, j] in couplings.meetings() {
            for a in &vertices_of[i] {
                edges.extend(vertices_of[j].iter().filter(|b| a != *b).map(|b| [*a, *b]));
            }
        }
        (Self::new(members.iter().map(|members| members.len() as u32).collect(), &edges), members)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Neighbours of a vertex.
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Number of unknowns of all vertices.
    pub fn weight(&self) -> usize {
        self.weights.iter().map(|weight| *weight as usize).sum()
    }

    /// The graph of some vertices, ascending, which are numbered anew in their order. `renamed` is [`OUTSIDE`] for each
    /// vertex of this graph, before and after.
    pub fn part(&self, vertices: &[u32], renamed: &mut [u32]) -> Self {
        for (new, vertex) in vertices.iter().enumerate() {
            renamed[*vertex as usize] = new as u32;
        }
        let mut part = Self { starts: vec![0], ..Self::default() };
        for vertex in vertices {
            let inside = self.neighbours(*vertex as usize).iter().map(|other| renamed[*other as usize]);
            part.neighbours.extend(inside.filter(|other| *other != OUTSIDE));
            part.starts.push(part.neighbours.len() as u32);
            part.weights.push(self.weights[*vertex as usize]);
        }
        vertices.iter().for_each(|vertex| renamed[*vertex as usize] = OUTSIDE);
        part
    }

    /// Distance of each vertex from the nearest of some, in edges; [`FAR`] where there is no way.
    pub fn distances(&self, from: &[u32]) -> Vec<u32> {
        let mut distances = vec![FAR; self.len()];
        from.iter().for_each(|vertex| distances[*vertex as usize] = 0);
        let mut queue = from.to_vec();
        let mut next = 0;
        while let Some(vertex) = queue.get(next).map(|vertex| *vertex as usize) {
            next += 1;
            for other in self.neighbours(vertex) {
                if distances[*other as usize] == FAR {
                    distances[*other as usize] = distances[vertex] + 1;
                    queue.push(*other);
                }
            }
        }
        distances
    }

    /// The connected components, each ascending.
    pub fn components(&self) -> Vec<Vec<u32>> {
        let mut component = vec![FAR; self.len()];
        let mut components: Vec<Vec<u32>> = Vec::new();
        for vertex in 0..self.len() {
            if component[vertex] != FAR {
                continue;
            }
            let mut members = vec![vertex as u32];
            component[vertex] = components.len() as u32;
            let mut next = 0;
            while let Some(vertex) = members.get(next).map(|vertex| *vertex as usize) {
                next += 1;
                for other in self.neighbours(vertex) {
                    if component[*other as usize] == FAR {
                        component[*other as usize] = components.len() as u32;
                        members.push(*other);
                    }
                }
            }
            members.sort_unstable();
            components.push(members);
        }
        components
    }
}

/// Distance of vertices to which there is no way.
pub(super) const FAR: u32 = u32::MAX;
/// Number of a vertex that is not in a part of the graph.
pub(super) const OUTSIDE: u32 = u32::MAX;
