//! Energies and loads, each a [`Term`], and the matrix that takes their tangents.

use std::collections::BTreeSet;
use std::fmt::Debug;

use crate::digest::Hash;
use crate::model::{BlockPattern, Blocks, ModelError, Tables};
use crate::scene::Scene;
use crate::shell::dot;
use crate::spline::Mesh;

/// The configuration of the shell that a term is evaluated at.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Mesh of the shell.
    pub mesh: &'a Mesh,
    /// Displacement of the control points, mm.
    pub displacement: &'a [[f64; 3]],
    /// The scene's parameter.
    pub parameter: f64,
}

/// Relative size up to which the skew part of a tangent that claims to have none is taken for rounding, or for the
/// error of finite differences.
const SYMMETRIC: f64 = 1e-6;

/// An energy, or forces without one, on a mesh.
///
/// A term that stores energy E exerts the forces −∂E/∂u. They are internal forces like the shell's own, and E is part
/// of what states and reports call strain energy. Where E depends on the parameter as well, what a change of the
/// parameter puts in is part of the work. A term that does work on the shell is a load: it stores nothing, and gives
/// its work by strokes and factors.
pub trait Term: Debug + Send + Sync {
    /// Returns the pairs of control points that the term couples though they share no element.
    fn pairs(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Computes the energy that the term stores in the model, N·mm.
    fn energy(&self, _at: At) -> f64 {
        0.0
    }

    /// Computes the change of the stored energy, N·mm, as the parameter changes to `to` while the shell does not move.
    fn put_in(&self, from: At, to: f64) -> f64 {
        self.energy(At { parameter: to, ..from }) - self.energy(from)
    }

    /// Adds the forces that the term exerts on the control points, N.
    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]);

    /// Whether the forces depend on the displacement.
    fn has_tangent(&self) -> bool {
        false
    }

    /// Whether the tangent of the forces has a skew part, which forces of an energy never have.
    fn has_skew(&self) -> bool {
        false
    }

    /// Adds the derivatives of the forces to `tangent`, for every ordered pair of control points, also where they are
    /// symmetric. The program ends where they are not symmetric and [`Self::has_skew`] is false, since half of them
    /// would be lost.
    fn add_tangent(&self, _at: At, _tangent: &mut Tangent) {}

    /// Adds to `tangent` what changes in the derivatives of the forces per unit of the parameter, where the shell moves at these rates
    /// by linear theory and keeps its geometry: the part that the stresses make which the rates cause, and that of loads. A term of
    /// the caller's own adds none, as by default.
    fn add_stress_stiffness(&self, _at: At, _rates: &[[f64; 3]], _tangent: &mut Tangent) {}

    /// Adds the derivatives of the forces with respect to the parameter where the shell does not move, N.
    fn add_rates(&self, _at: At, _rates: &mut [[f64; 3]]) {}

    /// Computes the strokes of the term's actions over a straight motion, N·mm: the work that each would do with its
    /// factor held at 1. Empty for a term that stores energy.
    fn strokes(&self, _mesh: &Mesh, _from: &[[f64; 3]], _to: &[[f64; 3]]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the factors of the term's actions at a value of the parameter, as many as there are strokes. A term
    /// without any stores energy.
    fn factors(&self, _parameter: f64) -> Vec<f64> {
        Vec::new()
    }
}

/// All ordered pairs of some control points, each once.
pub(super) fn pairs_among(points: impl IntoIterator<Item = usize>) -> Vec<[usize; 2]> {
    let points: BTreeSet<usize> = points.into_iter().collect();
    points.iter().flat_map(|i| points.iter().map(|j| [*i, *j])).collect()
}

/// Maker of a [`Term`] of the caller's own for every mesh of a run. Its name and hash are recorded in the log.
pub trait TermSource: Debug + Send + Sync {
    /// Name of the term in messages and manifests.
    fn name(&self) -> &str;

    /// Hash of everything that decides the numbers of the term.
    fn hash(&self) -> Hash;

    /// Makes the term on a mesh; the quadrature points of each of its shells are in `tables`, and their control points have
    /// the numbers that they have in the structure.
    ///
    /// # Errors
    /// Where it does not fit the mesh.
    fn on(&self, scene: &Scene, mesh: &Mesh, tables: &[Tables]) -> Result<Box<dyn Term>, ModelError>;

    /// Makes the part of the term that acts where both parameters of the surface are below `limits`: the moment of a
    /// section follows from everything that acts on one side of it.
    ///
    /// # Errors
    /// Where the term cannot be divided, as by default; then probes of such moments are refused.
    fn below(&self, _: &Scene, _: &Mesh, _: &[Tables], _limits: [f64; 2]) -> Result<Box<dyn Term>, ModelError> {
        Err(ModelError::NoPart { term: self.name().to_owned() })
    }
}

/// A matrix that takes the derivatives of the forces of a term: the symmetric part of −∂f/∂u, and its skew part where
/// there is one.
#[derive(Debug)]
pub struct Tangent<'a> {
    pattern: &'a BlockPattern,
    stiffness: &'a mut Blocks,
    /// Skew part; empty where all terms have symmetric tangents.
    skew: &'a mut Blocks,
    /// Name of the term whose tangent is taken.
    term: &'a str,
    /// Check of the symmetry, where the term claims to be symmetric.
    symmetry: Option<Symmetry>,
}

impl<'a> Tangent<'a> {
    /// Starts from sums of the terms before; `skew` is empty where all terms have symmetric tangents.
    pub(super) fn adding_to(
        pattern: &'a BlockPattern,
        stiffness: &'a mut Blocks,
        skew: &'a mut Blocks,
        term: &'a str,
    ) -> Self {
        Self { pattern, stiffness, skew, term, symmetry: None }
    }
}

impl Tangent<'_> {
    /// Returns the symmetric part of −∂f/∂u, N/mm, for terms that fill it in themselves on blocks of this pattern.
    ///
    /// # Panics
    /// Where the matrix has another pattern.
    pub(super) fn stiffness_of(&mut self, pattern: &BlockPattern) -> &mut Blocks {
        assert!(std::ptr::eq(self.pattern, pattern), "a stiffness of another pattern");
        self.stiffness
    }

    /// Computes the tangent of one term on a matrix of this pattern: the symmetric part of −∂f/∂u and the skew part,
    /// which is empty where the term has none.
    ///
    /// # Panics
    /// Where the term couples control points without saying so, or has a skew part without saying so.
    pub fn of(term: &dyn Term, at: At, pattern: &BlockPattern) -> [Blocks; 2] {
        let mut stiffness = Blocks::zeros(pattern);
        let mut skew = if term.has_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        Tangent::adding_to(pattern, &mut stiffness, &mut skew, "one term").take(term, at);
        [stiffness, skew]
    }

    /// Takes the tangent of a term, and checks that it is as symmetric as the term claims.
    pub(super) fn take(mut self, term: &dyn Term, at: At) {
        self.symmetry = (!term.has_skew()).then(Symmetry::default);
        term.add_tangent(at, &mut self);
        self.check();
    }

    /// Ends the program where the term hides a skew part.
    fn check(self) {
        if let Some(Symmetry { difference, size }) = self.symmetry.filter(Symmetry::is_broken) {
            let (name, share) = (self.term, difference.abs() / size);
            panic!(
                "the tangent of the term \"{name}\" is not symmetric, by {share:.1e} of its size, but `has_skew` is false"
            );
        }
    }

    /// Adds ∂f_i/∂u_j, N/mm.
    ///
    /// # Panics
    /// Where the control points neither share an element nor are among the term's own [`Term::pairs`].
    pub fn add(&mut self, [i, j]: [usize; 2], slope: [[f64; 3]; 3]) {
        let block = self.block([i, j]);
        if let Some(symmetry) = &mut self.symmetry {
            symmetry.see([i, j], &slope);
        }
        let has_skew = !self.skew.is_empty();
        let stiffness = self.stiffness.block_mut(block);
        let skew = if has_skew { self.skew.block_mut(block) } else { &mut [] };
        for c in 0..3 {
            for d in 0..3 {
                let half = 0.5 * slope[c][d];
                if i <= j {
                    stiffness[3 * c + d] -= half;
                }
                if j <= i {
                    stiffness[3 * d + c] -= half;
                }
                if has_skew && i <= j {
                    skew[3 * c + d] -= half;
                }
                if has_skew && j <= i {
                    skew[3 * d + c] += half;
                }
            }
        }
    }
}

impl Tangent<'_> {
    fn block(&self, [i, j]: [usize; 2]) -> usize {
        let block = self.pattern.block(i.min(j), i.max(j));
        block.unwrap_or_else(|| {
            panic!("the term \"{}\" couples control points {i} and {j}, but does not list the pair", self.term)
        })
    }

    /// Adds ∂f_i/∂u_j, and for two control points its transpose ∂f_j/∂u_i as well, N/mm: for terms that are symmetric by the way in
    /// which they are summed up.
    ///
    /// # Panics
    /// Where the control points neither share an element nor are among the term's own [`Term::pairs`].
    pub(super) fn add_symmetric(&mut self, [i, j]: [usize; 2], slope: [[f64; 3]; 3]) {
        let block = self.block([i, j]);
        let stiffness = self.stiffness.block_mut(block);
        for c in 0..3 {
            for d in 0..3 {
                stiffness[if i <= j { 3 * c + d } else { 3 * d + c }] -= slope[c][d];
            }
        }
    }
}

/// The form x·(A y) − y·(A x) of a matrix A that is added block by block, for two fields x and y without any symmetry:
/// 0 where A is symmetric.
#[derive(Debug, Default)]
struct Symmetry {
    difference: f64,
    /// Sum of the magnitudes of all contributions.
    size: f64,
}

impl Symmetry {
    fn see(&mut self, [i, j]: [usize; 2], slope: &[[f64; 3]; 3]) {
        let at = |point: usize, ratio: f64| [1, 2, 3].map(|c| ((3 * point + c) as f64 * ratio).fract() - 0.5);
        let [x, y] = [0.618_033_988_75, 0.414_213_562_37].map(|ratio| [at(i, ratio), at(j, ratio)]);
        let form = |left: [f64; 3], right: [f64; 3]| dot(left, slope.map(|row| dot(row, right)));
        let (forward, backward) = (form(x[0], y[1]), form(y[0], x[1]));
        self.difference += forward - backward;
        self.size += forward.abs() + backward.abs();
    }

    fn is_broken(&self) -> bool {
        self.difference.abs() > SYMMETRIC * self.size
    }
}
