//! Energies and loads beside the shell's own, each a [`Term`]; all others see their sum.

use std::fmt::Debug;

use crate::digest::Hash;
use crate::model::{BlockPattern, Blocks, ModelError, Tables};
use crate::scene::Scene;
use crate::spline::Mesh;

/// A configuration of the shell.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Displacement of its control points, mm.
    pub displacement: &'a [[f64; 3]],
    /// The scene's parameter.
    pub parameter: f64,
}

/// An energy, or forces without one, on one mesh. What stores energy exerts the forces −∂E/∂u; what does work on the shell
/// stores none, and says what it does by strokes. A stored energy may not depend on the parameter: nothing counts what that would
/// put in. What a term stores is part of what states and reports call strain energy.
pub trait Term: Debug + Send + Sync {
    /// Pairs of control points that it couples though they share no element.
    fn pairs(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Energy that it stores in the model, N·mm.
    fn energy(&self, _at: At) -> f64 {
        0.0
    }

    /// Adds the forces that it exerts on the control points, N.
    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]);

    /// Whether the forces depend on the displacement.
    fn has_tangent(&self) -> bool {
        false
    }

    /// Whether the tangent of the forces is not symmetric.
    fn has_skew(&self) -> bool {
        false
    }

    /// Hands over the derivatives of the forces: all pairs of control points both ways, also where they are symmetric.
    fn add_tangent(&self, _at: At, _tangent: &mut Tangent) {}

    /// Adds the derivatives of the forces with respect to the parameter where the shell does not move, N.
    fn add_rates(&self, _at: At, _rates: &mut [[f64; 3]]) {}

    /// Strokes of its actions on a straight way, N·mm: the work that each would do with its factor held at 1. Nothing where
    /// it stores energy.
    fn strokes(&self, _mesh: &Mesh, _from: &[[f64; 3]], _to: &[[f64; 3]]) -> Vec<f64> {
        Vec::new()
    }

    /// Factors of its actions at a value of the parameter: as many as strokes.
    fn factors(&self, _parameter: f64) -> Vec<f64> {
        Vec::new()
    }
}

/// What makes a [`Term`] of one's own for every mesh of a run. Its name and hash are part of what a log is made with.
pub trait TermSource: Debug + Send + Sync {
    /// What it is called in messages and manifests.
    fn name(&self) -> &str;

    /// Hash of all that decides its numbers.
    fn hash(&self) -> Hash;

    /// On a mesh, whose quadrature points are in the tables.
    ///
    /// # Errors
    /// Where it does not fit the mesh.
    fn on(&self, scene: &Scene, mesh: &Mesh, tables: &Tables) -> Result<Box<dyn Term>, ModelError>;
}

/// Takes derivatives of forces into a matrix: the symmetric part of −∂f/∂u, and its skew part where there is one.
#[derive(Debug)]
pub struct Tangent<'a> {
    pattern: &'a BlockPattern,
    stiffness: &'a mut Blocks,
    /// Empty where all terms have symmetric tangents.
    skew: &'a mut Blocks,
}

impl Tangent<'_> {
    /// Takes ∂f_i/∂u_j, N/mm.
    ///
    /// # Panics
    /// Where the control points neither share an element nor are among the term's own [`Term::pairs`].
    pub fn add(&mut self, [i, j]: [usize; 2], slope: [[f64; 3]; 3]) {
        let Some(block) = self.pattern.block(i.min(j), i.max(j)) else {
            panic!("a term couples control points {i} and {j}, and does not name the pair")
        };
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

/// All terms beside the shell on a mesh.
#[derive(Debug, Default)]
pub struct Terms {
    pub(super) list: Vec<Box<dyn Term>>,
}

impl Terms {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether a tangent is not symmetric.
    pub fn have_skew(&self) -> bool {
        self.list.iter().any(|term| term.has_skew())
    }

    /// Pairs of control points that share no element and are coupled.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        self.list.iter().flat_map(|term| term.pairs()).collect()
    }

    /// Energy that each stores in the model, N·mm.
    pub fn energies(&self, at: At) -> Vec<f64> {
        self.list.iter().map(|term| term.energy(at)).collect()
    }

    /// Energy that they store in the model, N·mm.
    pub fn energy(&self, at: At) -> f64 {
        self.list.iter().map(|term| term.energy(at)).sum::<f64>() + 0.0
    }

    /// Forces on the control points, N.
    pub fn forces(&self, at: At) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; at.displacement.len()];
        self.list.iter().for_each(|term| term.add_forces(at, &mut forces));
        forces
    }

    /// Derivatives of the forces with respect to the parameter where the shell does not move, N.
    pub fn rates(&self, at: At) -> Vec<[f64; 3]> {
        let mut rates = vec![[0.0; 3]; at.displacement.len()];
        self.list.iter().for_each(|term| term.add_rates(at, &mut rates));
        rates
    }

    /// Adds the symmetric part of the tangent to a stiffness; returns the skew part, empty where there is none.
    pub fn add_tangent(&self, at: At, pattern: &BlockPattern, stiffness: &mut Blocks) -> Blocks {
        let mut skew = if self.have_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        let mut tangent = Tangent { pattern, stiffness, skew: &mut skew };
        self.list.iter().filter(|term| term.has_tangent()).for_each(|term| term.add_tangent(at, &mut tangent));
        skew
    }

    /// Strokes of all actions on a straight way, N·mm.
    pub fn strokes(&self, mesh: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        self.list.iter().flat_map(|term| term.strokes(mesh, from, to)).collect()
    }

    /// Work of the actions over strokes with their factors at a parameter, N·mm.
    pub fn work(&self, strokes: &[f64], parameter: f64) -> f64 {
        let factors = self.list.iter().flat_map(|term| term.factors(parameter));
        factors.zip(strokes).map(|(factor, stroke)| factor * stroke).sum()
    }

    /// The same with the means of their factors at two parameters, N·mm.
    pub fn mean_work(&self, strokes: &[f64], parameters: [f64; 2]) -> f64 {
        0.5 * parameters.map(|parameter| self.work(strokes, parameter)).iter().sum::<f64>()
    }
}
