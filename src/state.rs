//! What a checkpoint holds: plain data, all that decides the future of a run.

use std::sync::Arc;

use crate::scene::Stage;

/// A content hash (BLAKE3, 256 bits).
pub type Hash = blake3::Hash;

/// Tensor-product NURBS mid-surface. Control points are ordered with the second direction (arc) fastest:
/// index = i₁ · n₂ + i₂.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Polynomial degree each way.
    pub degree: [usize; 2],
    /// Open knot vectors each way; nᵢ = knots.len() − degree − 1 control points.
    pub knots: [Vec<f64>; 2],
    /// Homogeneous control points (w x, w y, w z, w), mm; length n₁ · n₂.
    pub control_points: Vec<[f64; 4]>,
}

impl Mesh {
    /// Control points each way.
    pub fn control_counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].len() - self.degree[k] - 1)
    }

    /// Non-empty knot spans (elements) each way.
    pub fn element_counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.knots[k].windows(2).filter(|pair| pair[0] < pair[1]).count())
    }

    /// Content hash; independent of how a log encodes the mesh.
    pub fn hash(&self) -> Hash {
        let mut feed = Feed::new("foldline mesh");
        for k in 0..2 {
            feed.integer(self.degree[k] as u64);
            feed.numbers(&self.knots[k]);
        }
        feed.integer(self.control_points.len() as u64);
        for point in &self.control_points {
            point.iter().for_each(|value| feed.number(*value));
        }
        feed.finish()
    }
}

/// A run between two stages.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Geometry and spline space. Shared: it changes only in refine-knots.
    pub mesh: Arc<Mesh>,
    /// Displacement of every control point, mm, in the order of the mesh. Between refine-knots and
    /// project-displacements it still belongs to the mesh without the knots in `inserted`.
    pub displacement: Vec<[f64; 3]>,
    /// New knots each way that evaluate-indicators asks for; emptied by refine-knots.
    pub marked: [Vec<f64>; 2],
    /// Knots each way that `mesh` has and `displacement` has not; emptied by project-displacements.
    pub inserted: [Vec<f64>; 2],
    /// Load step: 0 before the first solve.
    pub step: u64,
    /// The stage that made this state; `None` for the state that the scene starts from.
    pub stage: Option<Stage>,
    /// Rotation of each end, degrees.
    pub rotation_deg: f64,
    /// End moment dΠ/dθ / 2 (of each end, whole section), N·mm.
    pub moment_n_mm: f64,
    /// Strain energy of the whole shell, N·mm.
    pub strain_energy_n_mm: f64,
    /// Negative pivots of the tangent stiffness at the last equilibrium; 0 where it is stable.
    pub negative_pivots: u64,
    /// What the next solve will try.
    pub control: StepControl,
}

/// Memory of the step control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepControl {
    /// The scene's increment is divided by 2 to this power.
    pub halvings: u32,
    /// A rotation beyond the present one that is known to lie past a jump, degrees.
    pub jump_seen_at_deg: Option<f64>,
    /// Why the last solve left the state where it was; `None` where it went on.
    pub rejection: Option<Rejection>,
}

/// Why an attempted load step was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// The solver found no equilibrium.
    NoEquilibrium,
    /// The shell jumped, and the jump is not located well enough yet.
    Jump,
}

impl State {
    /// Content hash over everything that decides the future; independent of how a log encodes the state.
    pub fn hash(&self) -> Hash {
        let mut feed = Feed::new("foldline state");
        feed.bytes(self.mesh.hash().as_bytes());
        feed.integer(self.displacement.len() as u64);
        for vector in &self.displacement {
            vector.iter().for_each(|value| feed.number(*value));
        }
        for knots in self.marked.iter().chain(&self.inserted) {
            feed.numbers(knots);
        }
        feed.integer(self.step);
        feed.integer(self.stage.map_or(0, |stage| 1 + stage as u64));
        feed.number(self.rotation_deg);
        feed.number(self.moment_n_mm);
        feed.number(self.strain_energy_n_mm);
        feed.integer(self.negative_pivots);
        feed.integer(u64::from(self.control.halvings));
        feed.integer(u64::from(self.control.jump_seen_at_deg.is_some()));
        feed.number(self.control.jump_seen_at_deg.unwrap_or(0.0));
        feed.integer(match self.control.rejection {
            None => 0,
            Some(Rejection::NoEquilibrium) => 1,
            Some(Rejection::Jump) => 2,
        });
        feed.finish()
    }
}

/// Feeds numbers into a hash by their bits, each sequence with its length in front.
struct Feed(blake3::Hasher);

impl Feed {
    fn new(domain: &str) -> Self {
        let mut feed = Self(blake3::Hasher::new());
        feed.integer(domain.len() as u64);
        feed.bytes(domain.as_bytes());
        feed
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    fn integer(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    fn number(&mut self, value: f64) {
        self.bytes(&value.to_bits().to_le_bytes());
    }

    fn numbers(&mut self, values: &[f64]) {
        self.integer(values.len() as u64);
        values.iter().for_each(|value| self.number(*value));
    }

    fn finish(self) -> Hash {
        self.0.finalize()
    }
}
