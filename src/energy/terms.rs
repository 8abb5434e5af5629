//! The sum of all terms on a mesh other than the shell.

use std::sync::Arc;

use crate::energy::{At, Connections, Tangent, Term, TermSource};
use crate::model::{BlockPattern, Blocks, ModelError, Tables};
use crate::scene::Scene;
use crate::shell::add;
use crate::spline::Mesh;

/// All terms on a mesh other than the shell.
#[derive(Debug, Default)]
pub struct Terms {
    list: Vec<Named>,
    /// Sources of the terms of the caller's own.
    own: Vec<Arc<dyn TermSource>>,
}

#[derive(Debug)]
struct Named {
    name: String,
    term: Box<dyn Term>,
}

impl Terms {
    /// Whether terms other than shells, joints and bonds may store energy: springs, and terms of the caller's own.
    pub fn may_store(scene: &Scene, own: &[Arc<dyn TermSource>]) -> bool {
        !(scene.springs.is_empty() && own.is_empty())
    }

    /// Makes the terms of a scene's actions and those of the caller's own.
    ///
    /// # Errors
    /// Where one of them does not fit the mesh.
    pub fn new(scene: &Scene, mesh: &Mesh, tables: &[Tables], own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        Self::with_connections(scene, mesh, tables, own, &Connections::new(scene, mesh)?)
    }

    /// Makes the terms where the joints and bonds are known.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub(super) fn with_connections(
        scene: &Scene,
        mesh: &Mesh,
        tables: &[Tables],
        own: &[Arc<dyn TermSource>],
        connections: &Connections,
    ) -> Result<Self, ModelError> {
        let mut terms = Self { own: own.to_vec(), ..Self::of_actions(scene, mesh)? };
        connections.terms().for_each(|(name, term)| terms.push(&name, term));
        for source in own {
            terms.push(source.name(), source.on(scene, mesh, tables)?);
        }
        Ok(terms)
    }

    /// Makes the terms where no tables of the mesh are at hand; they are built if there are terms of the caller's own.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn on(scene: &Scene, mesh: &Mesh, own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        match own.is_empty() {
            true if scene.joints.is_empty() && scene.bonds.is_empty() => Self::of_actions(scene, mesh),
            _ => Self::new(scene, mesh, &Tables::of_structure(scene, mesh), own),
        }
    }

    /// Makes the part of the terms that acts where both parameters of the surface are below `limits`.
    ///
    /// # Errors
    /// Where a term does not fit the mesh or cannot be divided.
    pub fn below(&self, scene: &Scene, mesh: &Mesh, tables: &[Tables], limits: [f64; 2]) -> Result<Self, ModelError> {
        let mut part = Self::of_actions_below(scene, mesh, limits)?;
        for source in &self.own {
            part.push(source.name(), source.below(scene, mesh, tables, limits)?);
        }
        Ok(part)
    }

    pub(super) fn push(&mut self, name: &str, term: Box<dyn Term>) {
        self.list.push(Named { name: name.to_owned(), term });
    }

    /// Iterates over the terms.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Term> {
        self.list.iter().map(|named| &*named.term)
    }

    /// Forces on the control points, N, of the term of this name; `None` where there is none.
    pub(super) fn forces_of(&self, name: &str, at: At) -> Option<Vec<[f64; 3]>> {
        let Named { term, .. } = self.list.iter().find(|named| named.name == name)?;
        let mut forces = vec![[0.0; 3]; at.displacement.len()];
        term.add_forces(at, &mut forces);
        Some(forces)
    }

    /// Whether there are no terms.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether the tangent of any term has a skew part.
    pub fn have_skew(&self) -> bool {
        self.iter().any(Term::has_skew)
    }

    /// Pairs of control points that a term couples though they share no element.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        self.iter().flat_map(Term::pairs).collect()
    }

    /// Energy that each term stores in the model, N·mm.
    pub fn energies(&self, at: At) -> Vec<f64> {
        self.iter().map(|term| term.energy(at)).collect()
    }

    /// Energy that all terms store in the model, N·mm.
    pub fn energy(&self, at: At) -> f64 {
        self.iter().map(|term| term.energy(at)).sum::<f64>() + 0.0
    }

    /// Forces of all terms on the control points, N.
    pub fn forces(&self, at: At) -> Vec<[f64; 3]> {
        let [mut forces, internal] = self.forces_apart(at);
        forces.iter_mut().zip(internal).for_each(|(sum, force)| *sum = add(*sum, force));
        forces
    }

    /// Forces on the control points, N: first those of loads, then those of terms that store energy, which are empty
    /// where no term does.
    pub fn forces_apart(&self, at: At) -> [Vec<[f64; 3]>; 2] {
        let none = || vec![[0.0; 3]; at.displacement.len()];
        let (mut of_loads, mut internal) = (none(), Vec::new());
        for term in self.iter() {
            match term.factors(at.parameter).is_empty() {
                false => term.add_forces(at, &mut of_loads),
                true => {
                    internal.resize(at.displacement.len(), [0.0; 3]);
                    term.add_forces(at, &mut internal);
                }
            }
        }
        [of_loads, internal]
    }

    /// Derivatives of the forces with respect to the parameter where the shell does not move, N.
    pub fn rates(&self, at: At) -> Vec<[f64; 3]> {
        let mut rates = vec![[0.0; 3]; at.displacement.len()];
        self.iter().for_each(|term| term.add_rates(at, &mut rates));
        rates
    }

    /// Adds the symmetric part of the tangent to a stiffness, and returns the skew part, which is empty where there is
    /// none.
    ///
    /// # Panics
    /// Where a term couples control points without saying so, or has a skew part without saying so.
    pub fn add_tangent(&self, at: At, pattern: &BlockPattern, stiffness: &mut Blocks) -> Blocks {
        let mut skew = if self.have_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        for Named { name, term } in self.list.iter().filter(|named| named.term.has_tangent()) {
            Tangent::adding_to(pattern, stiffness, &mut skew, name).take(&**term, at);
        }
        skew
    }

    /// Adds the symmetric part of what stresses add to the tangent per unit of the parameter ([`Term::add_stress_stiffness`]).
    pub fn add_stress_stiffness(&self, at: At, rates: &[[f64; 3]], pattern: &BlockPattern, stiffness: &mut Blocks) {
        let mut skew = if self.have_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        for Named { name, term } in self.list.iter().filter(|named| named.term.has_tangent()) {
            let mut tangent = Tangent::adding_to(pattern, stiffness, &mut skew, name);
            term.add_stress_stiffness(at, rates, &mut tangent);
        }
    }

    /// Strokes of all actions over a straight motion, N·mm.
    pub fn strokes(&self, mesh: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        self.iter().flat_map(|term| term.strokes(mesh, from, to)).collect()
    }

    /// Work of the actions over strokes, with their factors at one value of the parameter, N·mm.
    pub fn work(&self, strokes: &[f64], parameter: f64) -> f64 {
        let factors = self.iter().flat_map(|term| term.factors(parameter));
        factors.zip(strokes).map(|(factor, stroke)| factor * stroke).sum()
    }

    /// Work of the actions over strokes, with the means of their factors at two values of the parameter, N·mm.
    pub fn mean_work(&self, strokes: &[f64], parameters: [f64; 2]) -> f64 {
        0.5 * parameters.map(|parameter| self.work(strokes, parameter)).iter().sum::<f64>()
    }
}
