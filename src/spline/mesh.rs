//! The surfaces of a structure: one patch for each shell, with all control points in one list.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::digest::{Feed, Hash};
use crate::spline::{Patch, Spans};

/// Knots of each direction of each patch, in the order of the patches.
pub type KnotLists = Vec<[Vec<f64>; 2]>;

/// Numbers of the knots of all patches in each direction.
pub fn knot_counts(lists: &KnotLists) -> [usize; 2] {
    [0, 1].map(|direction| lists.iter().map(|knots| knots[direction].len()).sum())
}

/// The mid-surfaces of the shells of a structure. Vectors on control points hold those of the first patch, then those of
/// the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Surface of each shell; at least one.
    pub patches: Vec<Patch>,
}

impl From<Patch> for Mesh {
    fn from(patch: Patch) -> Self {
        Self { patches: vec![patch] }
    }
}

impl Mesh {
    /// The only patch, where what is asked for is known of scenes of one shell alone.
    pub fn lone(&self) -> &Patch {
        &self.patches[0]
    }

    /// Number of control points of all patches.
    pub fn point_count(&self) -> usize {
        self.patches.iter().map(|patch| patch.control_points.len()).sum()
    }

    /// Numbers of the control points of each patch.
    pub fn ranges(&self) -> Vec<Range<usize>> {
        let mut first = 0;
        let range = |patch: &Patch| {
            let from = first;
            first += patch.control_points.len();
            from..first
        };
        self.patches.iter().map(range).collect()
    }

    /// Numbers of the control points of one patch.
    ///
    /// # Panics
    /// Where there is no such patch.
    pub fn range(&self, patch: usize) -> Range<usize> {
        let first = self.patches[..patch].iter().map(|patch| patch.control_points.len()).sum();
        first..first + self.patches[patch].control_points.len()
    }

    /// Position of a control point, mm.
    ///
    /// # Panics
    /// Where there is no such control point.
    pub fn point(&self, index: usize) -> [f64; 3] {
        let (patch, index) = self.place(index);
        self.patches[patch].point(index)
    }

    /// Patch of a control point, and its number there.
    ///
    /// # Panics
    /// Where there is no such control point.
    pub fn place(&self, mut index: usize) -> (usize, usize) {
        for (number, patch) in self.patches.iter().enumerate() {
            match index.checked_sub(patch.control_points.len()) {
                Some(beyond) => index = beyond,
                None => return (number, index),
            }
        }
        panic!("a control point {index} beyond the last one")
    }

    /// Place of a control point in the grid of its patch.
    ///
    /// # Panics
    /// Where there is no such control point.
    pub fn grid_place(&self, index: usize) -> [usize; 2] {
        let (patch, own) = self.place(index);
        self.patches[patch].grid().place(own)
    }

    /// Positions of all control points, mm.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        self.patches.iter().flat_map(Patch::points)
    }

    /// Numbers of elements in each direction of each patch.
    pub fn elements(&self) -> Elements {
        self.patches.iter().map(Patch::element_counts).collect()
    }

    /// Inserts a knot into the middle of every span.
    pub fn halved(&self) -> Self {
        let middles = |patch: &Patch| {
            [0, 1].map(|direction| Spans::of(&patch.knots[direction], patch.degree[direction]).middles())
        };
        self.with_knots(&self.patches.iter().map(middles).collect::<Vec<_>>())
    }

    /// No knots for any patch.
    pub fn no_knots(&self) -> KnotLists {
        vec![Default::default(); self.patches.len()]
    }

    /// Returns the same surfaces with the knots `new` of each patch (ascending) inserted.
    pub fn with_knots(&self, new: &[[Vec<f64>; 2]]) -> Self {
        Self { patches: self.patches.iter().zip(new).map(|(patch, new)| patch.with_knots(new)).collect() }
    }

    /// Content hash of the mesh; independent of how a log encodes it. The hash of one patch is that of a mesh that has
    /// no other.
    pub fn hash(&self) -> Hash {
        if let [patch] = &self.patches[..] {
            return patch.hash();
        }
        let mut feed = Feed::new("foldline mesh of several patches");
        feed.integer(self.patches.len() as u64);
        self.patches.iter().for_each(|patch| feed.bytes(patch.hash().as_bytes()));
        feed.finish()
    }
}

/// Numbers of elements in each direction, of the only patch or of each patch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Elements {
    /// Along u and v of the only patch.
    OfOne([usize; 2]),
    /// Along u and v of each of several patches.
    OfEach(Vec<[usize; 2]>),
}

impl Elements {
    /// Numbers of each patch.
    pub fn each(&self) -> &[[usize; 2]] {
        match self {
            Self::OfOne(counts) => std::slice::from_ref(counts),
            Self::OfEach(counts) => counts,
        }
    }

    /// Number of all elements.
    pub fn count(&self) -> usize {
        self.each().iter().map(|[along, across]| along * across).sum()
    }

    /// The numbers with a sign between those of one patch, and a plus between patches.
    pub fn with_sign(&self, times: &str) -> String {
        let of_patch = |[along, across]: &[usize; 2]| format!("{along}{times}{across}");
        self.each().iter().map(of_patch).collect::<Vec<_>>().join(" + ")
    }
}

/// Viewers want a type that is plain: a list, of numbers or of lists of numbers.
impl JsonSchema for Elements {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Elements".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": ["integer", "array"], "items": { "type": "integer" } } })
    }
}

/// Of the numbers of each patch.
impl FromIterator<[usize; 2]> for Elements {
    fn from_iter<I: IntoIterator<Item = [usize; 2]>>(counts: I) -> Self {
        let counts: Vec<[usize; 2]> = counts.into_iter().collect();
        match counts[..] {
            [only] => Self::OfOne(only),
            _ => Self::OfEach(counts),
        }
    }
}

impl From<[usize; 2]> for Elements {
    fn from(counts: [usize; 2]) -> Self {
        Self::OfOne(counts)
    }
}

impl PartialEq<[usize; 2]> for Elements {
    fn eq(&self, other: &[usize; 2]) -> bool {
        self.each() == [*other]
    }
}

/// As in 16 × 8, or 16 × 8 + 4 × 4.
impl Display for Elements {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with_sign(" × "))
    }
}
