//! Fronts: dense blocks of columns of the factor, and the tree in which they are eliminated.
//!
//! A front is the columns of one block of the dissection: its own unknowns (pivots), and below them the rows of all
//! later unknowns that they or fronts below meet. What its elimination leaves on these rows goes to the front above
//! (Duff & Reid, *ACM Trans. Math. Softw.* 9, 1983, p. 302; Liu, *SIAM Review* 34, 1992, p. 82).

use crate::equilibrium::sparse::dense::{scratch_len, shares};
use crate::equilibrium::sparse::dissection::{Block, dissect};
use crate::equilibrium::sparse::graph::Graph;
use crate::equilibrium::sparse::structure::Couplings;

/// Columns and blocks begin at multiples of so many numbers (a cache line), so that kernels meet the same alignment in
/// every run.
pub(super) const ALIGNED: usize = 8;
/// Number of operations from which on a subtree may have a thread of its own.
const SHARED_FLOPS: f64 = 2e7;
/// Number of subtrees, by their share of the operations, that may run at once; each takes memory of its own.
const SUBTREES: f64 = 32.0;

/// A run of consecutive rows of a front that are consecutive in the front above, too.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub from: u32,
    pub to: u32,
    pub length: u32,
}

/// A front. Places are numbers in the order of elimination.
#[derive(Debug)]
pub(super) struct Front {
    /// Place of the first pivot.
    pub begin: usize,
    /// Number of pivots.
    pub width: usize,
    /// Places of the rows below the pivots, ascending.
    pub rows: Vec<u32>,
    /// Where the rows lie in the front above.
    pub runs: Vec<Run>,
    /// Indices of the fronts below.
    pub below: Vec<usize>,
    /// Length of the columns of the factor, and of what is left on the rows, in numbers.
    pub stride: usize,
    pub rest_stride: usize,
    /// Numbers of the factor in the front and all fronts below it.
    pub factor_len: usize,
    /// Numbers that the elimination of the front and of those below it needs at once for what is left.
    pub rest_len: usize,
    /// Whether fronts below are eliminated at the same time.
    pub shared: bool,
    /// Operations of the front and of all fronts below it.
    pub flops: f64,
    /// Operations on the longest way from a front without any below, where large fronts are shared by threads.
    pub longest: f64,
}

impl Front {
    /// Number of rows, with those of the pivots.
    pub fn height(&self) -> usize {
        self.width + self.rows.len()
    }

    /// Numbers of the front's own columns.
    pub fn own_len(&self) -> usize {
        self.stride * self.width
    }

    /// Numbers that are left on the rows.
    pub fn left_len(&self) -> usize {
        self.rest_stride * self.rows.len()
    }
}

/// The order of elimination and the fronts, each after those below it.
#[derive(Debug, Default)]
pub(super) struct Fronts {
    /// Unknown at each place.
    pub order: Vec<u32>,
    /// Place of each unknown.
    pub places: Vec<u32>,
    pub fronts: Vec<Front>,
    /// Fronts with none above.
    pub tops: Vec<usize>,
}

impl Fronts {
    /// Analyses a structure.
    pub fn new(couplings: &Couplings) -> Self {
        let (graph, members) = Graph::compress(couplings);
        let mut fronts = Self::default();
        let mut building = Building { graph: &graph, members: &members, places: vec![0; graph.len()] };
        building.place(&dissect(&graph), &mut fronts);
        fronts.places = vec![0; couplings.unknowns];
        for (place, unknown) in fronts.order.iter().enumerate() {
            fronts.places[*unknown as usize] = place as u32;
        }
        fronts.find_runs();
        let whole = fronts.tops.iter().map(|top| fronts.fronts[*top].flops).sum::<f64>();
        fronts.find_room(SHARED_FLOPS.max(whole / SUBTREES));
        fronts
    }

    fn find_runs(&mut self) {
        for above in 0..self.fronts.len() {
            for below in self.fronts[above].below.clone() {
                let runs = runs(&self.fronts[below].rows, &self.fronts[above]);
                self.fronts[below].runs = runs;
            }
        }
    }

    /// Finds how much memory subtrees take.
    fn find_room(&mut self, shared_flops: f64) {
        for index in 0..self.fronts.len() {
            let front = &self.fronts[index];
            let below = || front.below.iter().map(|below| &self.fronts[*below]);
            let shared = below().filter(|below| below.flops > shared_flops).count() > 1;
            let (mut kept, mut most) = (0, 0);
            for below in below() {
                most = most.max(kept + below.rest_len);
                kept += if shared { below.rest_len } else { below.left_len() };
            }
            let rest_len = front.left_len() + most.max(kept).max(scratch_len(front.width, front.height()));
            let front = &mut self.fronts[index];
            (front.shared, front.rest_len) = (shared, rest_len);
        }
    }
}

struct Building<'a> {
    graph: &'a Graph,
    members: &'a [Vec<u32>],
    /// Place of the first unknown of each vertex.
    places: Vec<u32>,
}

impl Building<'_> {
    /// Gives places to the vertices of all blocks, and then their fronts.
    fn place(&mut self, blocks: &[Block], fronts: &mut Fronts) {
        fn number(building: &mut Building, block: &Block, order: &mut Vec<u32>) {
            block.below.iter().for_each(|below| number(building, below, order));
            for vertex in &block.vertices {
                building.places[*vertex as usize] = order.len() as u32;
                order.extend_from_slice(&building.members[*vertex as usize]);
            }
        }
        blocks.iter().for_each(|block| number(self, block, &mut fronts.order));
        let mut seen = vec![false; self.graph.len()];
        for block in blocks {
            let (top, _) = self.front(block, fronts, &mut seen);
            fronts.tops.push(top);
        }
    }

    /// Appends the front of a block and those below it; returns its index and the vertices of its rows.
    fn front(&self, block: &Block, fronts: &mut Fronts, seen: &mut [bool]) -> (usize, Vec<u32>) {
        let below: Vec<(usize, Vec<u32>)> = block.below.iter().map(|block| self.front(block, fronts, seen)).collect();
        block.vertices.iter().for_each(|vertex| seen[*vertex as usize] = true);
        let begin = block.vertices.first().map_or(0, |first| self.places[*first as usize]);
        let mut rows = Vec::new();
        let met = block.vertices.iter().flat_map(|vertex| self.graph.neighbours(*vertex as usize));
        for vertex in met.chain(below.iter().flat_map(|(_, rows)| rows)) {
            if self.places[*vertex as usize] >= begin && !seen[*vertex as usize] {
                seen[*vertex as usize] = true;
                rows.push(*vertex);
            }
        }
        block.vertices.iter().chain(&rows).for_each(|vertex| seen[*vertex as usize] = false);
        rows.sort_unstable_by_key(|vertex| self.places[*vertex as usize]);
        let weight = |vertex: &u32| self.members[*vertex as usize].len();
        let width = block.vertices.iter().map(weight).sum::<usize>();
        let places = rows.iter().flat_map(|vertex| {
            let first = self.places[*vertex as usize];
            first..first + weight(vertex) as u32
        });
        let places: Vec<u32> = places.collect();
        let height = width + places.len();
        let own_flops = (places.len()..height).map(|length| ((length + 1) as f64).powi(2)).sum::<f64>();
        let of_below = || below.iter().map(|(index, _)| &fronts.fronts[*index]);
        let stride = height.next_multiple_of(ALIGNED);
        let front = Front {
            begin: begin as usize,
            width,
            rest_stride: places.len().next_multiple_of(ALIGNED),
            rows: places,
            runs: Vec::new(),
            stride,
            factor_len: stride * width + of_below().map(|front| front.factor_len).sum::<usize>(),
            rest_len: 0,
            shared: false,
            flops: own_flops + of_below().map(|front| front.flops).sum::<f64>(),
            longest: own_flops / shares(height) + of_below().map(|front| front.longest).fold(0.0, f64::max),
            below: below.iter().map(|(index, _)| *index).collect(),
        };
        fronts.fronts.push(front);
        (fronts.fronts.len() - 1, rows)
    }
}

/// Where rows of a front lie in the one above.
fn runs(rows: &[u32], above: &Front) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut passed = 0;
    for (from, row) in rows.iter().enumerate() {
        let own = (*row as usize).wrapping_sub(above.begin);
        let to = if own < above.width {
            own
        } else {
            passed += above.rows[passed..].iter().take_while(|other| *other < row).count();
            above.width + passed
        };
        match runs.last_mut() {
            Some(run) if (run.to + run.length) as usize == to => run.length += 1,
            _ => runs.push(Run { from: from as u32, to: to as u32, length: 1 }),
        }
    }
    runs
}
