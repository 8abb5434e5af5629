//! Energies and loads, each a [`Term`]; those beside the shell, of which all others see the sum.

use std::fmt::Debug;
use std::sync::Arc;

use crate::digest::Hash;
use crate::model::{BlockPattern, Blocks, ModelError, Tables};
use crate::scene::Scene;
use crate::shell::{add, dot};
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

/// Share of its size up to which the skew part of a tangent that is said to have none is taken for rounding, or for what
/// differences leave in it.
const SYMMETRIC: f64 = 1e-6;

/// An energy, or forces without one, on one mesh.
///
/// What stores energy exerts the forces −∂E/∂u, which are internal forces as the shell's own are, and what it stores is part of what
/// states and reports call strain energy. Where the energy depends on the parameter as well, what a change of that puts in is
/// part of the work. What does work on the shell is a load: it stores nothing, and says what it does by strokes and factors.
pub trait Term: Debug + Send + Sync {
    /// Pairs of control points that it couples though they share no element.
    fn pairs(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Energy that it stores in the model, N·mm.
    fn energy(&self, _at: At) -> f64 {
        0.0
    }

    /// What it stores more, in N·mm, where the parameter changes to `to` and the shell stays where it is.
    fn put_in(&self, from: At, to: f64) -> f64 {
        self.energy(At { parameter: to, ..from }) - self.energy(from)
    }

    /// Adds the forces that it exerts on the control points, N.
    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]);

    /// Whether the forces depend on the displacement.
    fn has_tangent(&self) -> bool {
        false
    }

    /// Whether the tangent of the forces is not symmetric: never where they are those of an energy.
    fn has_skew(&self) -> bool {
        false
    }

    /// Hands over the derivatives of the forces: all pairs of control points both ways, also where they are symmetric. One that
    /// is not symmetric, and of which [`Self::has_skew`] does not say so, ends the program: half of it would be lost.
    fn add_tangent(&self, _at: At, _tangent: &mut Tangent) {}

    /// Adds the derivatives of the forces with respect to the parameter where the shell does not move, N.
    fn add_rates(&self, _at: At, _rates: &mut [[f64; 3]]) {}

    /// Strokes of its actions on a straight way, N·mm: the work that each would do with its factor held at 1. Nothing where
    /// it stores energy.
    fn strokes(&self, _mesh: &Mesh, _from: &[[f64; 3]], _to: &[[f64; 3]]) -> Vec<f64> {
        Vec::new()
    }

    /// Factors of its actions at a value of the parameter: as many as strokes. A term without any stores energy.
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

    /// What of it acts where both parameters of the surface are below `limits`: the moment of a section is found from all that
    /// acts on one side of it.
    ///
    /// # Errors
    /// Where it does not know, as it is said here; then probes of such moments are refused.
    fn below(&self, _: &Scene, _: &Mesh, _: &Tables, _limits: [f64; 2]) -> Result<Box<dyn Term>, ModelError> {
        Err(ModelError::NoPart { term: self.name().to_owned() })
    }
}

/// Takes derivatives of the forces of a term into a matrix: the symmetric part of −∂f/∂u, and its skew part where there is one.
#[derive(Debug)]
pub struct Tangent<'a> {
    pattern: &'a BlockPattern,
    stiffness: &'a mut Blocks,
    /// Empty where all terms have symmetric tangents.
    skew: &'a mut Blocks,
    /// The term that hands over.
    term: &'a str,
    /// Where it says that it is symmetric.
    symmetry: Option<Symmetry>,
}

impl Tangent<'_> {
    /// The symmetric part, N/mm, for terms that fill it in themselves: −∂f/∂u, whose pattern is this.
    ///
    /// # Panics
    /// Where it has another pattern.
    pub(super) fn stiffness_of(&mut self, pattern: &BlockPattern) -> &mut Blocks {
        assert!(std::ptr::eq(self.pattern, pattern), "a stiffness of another pattern");
        self.stiffness
    }

    /// The tangent of one term, on a matrix of this pattern: the symmetric part of −∂f/∂u, and the skew part, empty where the term
    /// has none.
    ///
    /// # Panics
    /// Where the term couples control points without saying so, or has a skew part without saying so.
    pub fn of(term: &dyn Term, at: At, pattern: &BlockPattern) -> [Blocks; 2] {
        let mut stiffness = Blocks::zeros(pattern);
        let mut skew = if term.has_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        Tangent { pattern, stiffness: &mut stiffness, skew: &mut skew, term: "one term", symmetry: None }
            .take(term, at);
        [stiffness, skew]
    }

    /// Takes the tangent of a term, and looks whether that is as symmetric as the term says.
    fn take(mut self, term: &dyn Term, at: At) {
        self.symmetry = (!term.has_skew()).then(Symmetry::default);
        term.add_tangent(at, &mut self);
        self.check();
    }

    /// Ends the program where the term hides a skew part.
    fn check(self) {
        if let Some(Symmetry { difference, size }) = self.symmetry.filter(Symmetry::is_broken) {
            let (name, share) = (self.term, difference.abs() / size);
            panic!(
                "the tangent of the term \"{name}\" is not symmetric, by {share:.1e} of its size, and it does not say so"
            );
        }
    }

    /// Adds ∂f_i/∂u_j, N/mm.
    ///
    /// # Panics
    /// Where the control points neither share an element nor are among the term's own [`Term::pairs`].
    pub fn add(&mut self, [i, j]: [usize; 2], slope: [[f64; 3]; 3]) {
        let Some(block) = self.pattern.block(i.min(j), i.max(j)) else {
            panic!("the term \"{}\" couples control points {i} and {j}, and does not name the pair", self.term)
        };
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

/// x·(A y) − y·(A x) of a matrix A that is handed over block by block, for two fields x and y without any symmetry: 0 where A is
/// symmetric.
#[derive(Debug, Default)]
struct Symmetry {
    difference: f64,
    /// Sum of all magnitudes in it.
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

/// All terms beside the shell on a mesh.
#[derive(Debug, Default)]
pub struct Terms {
    list: Vec<Named>,
    /// Where those of the caller's own come from.
    own: Vec<Arc<dyn TermSource>>,
}

#[derive(Debug)]
struct Named {
    name: String,
    term: Box<dyn Term>,
}

impl Terms {
    /// The actions of a scene, and terms of the caller's own.
    ///
    /// # Errors
    /// Where one of them does not fit the mesh.
    pub fn new(scene: &Scene, mesh: &Mesh, tables: &Tables, own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        let mut terms = Self { own: own.to_vec(), ..Self::of_actions(scene, mesh)? };
        for source in own {
            terms.push(source.name(), source.on(scene, mesh, tables)?);
        }
        Ok(terms)
    }

    /// The same where the tables of the mesh are not at hand: they are made for terms of the caller's own.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn on(scene: &Scene, mesh: &Mesh, own: &[Arc<dyn TermSource>]) -> Result<Self, ModelError> {
        match own.is_empty() {
            true => Self::of_actions(scene, mesh),
            false => Self::new(scene, mesh, &Tables::new(scene, mesh), own),
        }
    }

    /// What of them acts where both parameters of the surface are below `limits`.
    ///
    /// # Errors
    /// Where one of them does not fit the mesh, or does not know.
    pub fn below(&self, scene: &Scene, mesh: &Mesh, tables: &Tables, limits: [f64; 2]) -> Result<Self, ModelError> {
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

    /// Whether there are no terms.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether the tangent of any term is not symmetric.
    pub fn have_skew(&self) -> bool {
        self.iter().any(Term::has_skew)
    }

    /// Pairs of control points that share no element and are coupled.
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

    /// Forces on the control points, N.
    pub fn forces(&self, at: At) -> Vec<[f64; 3]> {
        let [mut forces, internal] = self.forces_apart(at);
        forces.iter_mut().zip(internal).for_each(|(sum, force)| *sum = add(*sum, force));
        forces
    }

    /// Forces on the control points, N: of loads, and of what stores energy. The latter is empty where nothing does.
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

    /// Adds the symmetric part of the tangent to a stiffness; returns the skew part, empty where there is none.
    ///
    /// # Panics
    /// Where a term couples control points without saying so, or has a skew part without saying so.
    pub fn add_tangent(&self, at: At, pattern: &BlockPattern, stiffness: &mut Blocks) -> Blocks {
        let mut skew = if self.have_skew() { Blocks::zeros(pattern) } else { Blocks::default() };
        for Named { name, term } in self.list.iter().filter(|named| named.term.has_tangent()) {
            Tangent { pattern, stiffness, skew: &mut skew, term: name, symmetry: None }.take(&**term, at);
        }
        skew
    }

    /// Strokes of all actions on a straight way, N·mm.
    pub fn strokes(&self, mesh: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        self.iter().flat_map(|term| term.strokes(mesh, from, to)).collect()
    }

    /// Work of the actions over strokes with their factors at a parameter, N·mm.
    pub fn work(&self, strokes: &[f64], parameter: f64) -> f64 {
        let factors = self.iter().flat_map(|term| term.factors(parameter));
        factors.zip(strokes).map(|(factor, stroke)| factor * stroke).sum()
    }

    /// The same with the means of their factors at two parameters, N·mm.
    pub fn mean_work(&self, strokes: &[f64], parameters: [f64; 2]) -> f64 {
        0.5 * parameters.map(|parameter| self.work(strokes, parameter)).iter().sum::<f64>()
    }
}
