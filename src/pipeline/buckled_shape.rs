//! The shape of an imperfection that is made of modes of linear buckling of the perfect structure.
//!
//! A mode has no sign of its own, and modes that share a load factor are any basis of their span: which one is found hangs on rounding.
//! Here each span has the basis of the projections of fixed fields w₁, w₂, … onto it, made orthonormal in that order, with the product
//! ∫ f·g dA over the perfect surfaces. It depends on the span alone, and converges with the mesh; of a single mode it fixes the sign:
//! ∫ φ·w₁ dA > 0.

use std::sync::Arc;

use crate::energy::{TermSource, check_held};
use crate::equilibrium::{BucklingMode, BucklingModes, Configuration, Workspace, WorkspaceError, linear_buckling};
use crate::model::{Gaussians, ImperfectionError, ModelError, SurfaceSample, largest_offset};
use crate::scene::Scene;
use crate::shell::{add, dot, scaled, sub};
use crate::spline::Mesh;

/// Relative difference of neighbouring load factors that are taken for one: the modes of a pair that symmetry makes differ by as much on
/// coarse meshes.
const ONE_FACTOR: f64 = 1e-4;
/// Modes that are found beyond those that are asked for, at first, to see whether more share the last load factor.
const MORE: usize = 3;
/// Times as many modes as are asked for after which no more are found.
const MOST_TIMES: usize = 4;
/// Share of a fixed field in a span below which the next one is taken.
const LEAST_SHARE: f64 = 1e-6;
/// Fixed fields that are tried for each mode.
const TRIES: usize = 8;

/// Changes where seeds are to mean other weights.
const PURPOSE: &str = "foldline weights of modes 1";

/// Finds the moves of the control points by modes of linear buckling (numbered from 1) under the loads of a scene without its
/// imperfections: a single mode, or a combination with normal weights. The largest move of the surfaces is `amplitude_mm`.
///
/// # Errors
/// Where the perfect structure does not buckle so, or too many modes share a load factor.
pub(super) fn buckled_shape(
    scene: &Scene,
    perfect: &Arc<Mesh>,
    own: &[Arc<dyn TermSource>],
    name: &str,
    modes: &[usize],
    amplitude_mm: f64,
    seed: Option<u64>,
) -> Result<Vec<[f64; 3]>, ModelError> {
    let whole = scene.perfect();
    let found = Found::new(&whole, perfect, own, name, modes)?;
    let mut weights = seed.map(|seed| Gaussians::new(PURPOSE, seed));
    let mut sum = vec![[0.0; 3]; perfect.point_count()];
    for mode in modes {
        let shape = found.basis_vector(perfect, mode - 1);
        let weight = weights.as_mut().map_or(1.0, Gaussians::draw) / largest_offset(&whole, perfect, &shape).mm;
        sum.iter_mut().zip(shape).for_each(|(sum, shift)| *sum = add(*sum, scaled(weight, shift)));
    }
    let factor = amplitude_mm / largest_offset(&whole, perfect, &sum).mm;
    Ok(sum.into_iter().map(|shift| scaled(factor, shift)).collect())
}

/// Modes, enough to hold whole every span that one of those asked for belongs to.
struct Found {
    modes: Vec<BucklingMode>,
}

impl Found {
    fn new(
        scene: &Scene,
        perfect: &Arc<Mesh>,
        own: &[Arc<dyn TermSource>],
        name: &str,
        modes: &[usize],
    ) -> Result<Self, ModelError> {
        let last = modes.iter().copied().max().unwrap_or(1);
        let mut count = last + MORE;
        loop {
            let BucklingModes { modes, counted, settled, .. } = lowest_modes(scene, perfect, own, name, count)?;
            if !settled && !modes.is_empty() {
                let reason = "their load factors did not settle; name fewer or lower modes".to_owned();
                return Err(ImperfectionError::NoModes { imperfection: name.to_owned(), reason }.into());
            }
            let missed = counted > modes.len();
            let found = Self { modes };
            if found.modes.len() < last {
                let (imperfection, found) = (name.to_owned(), found.modes.len());
                return Err(ImperfectionError::NoSuchMode { imperfection, mode: last, found }.into());
            }
            let (from, to) = found.span_of(last - 1);
            // There are no more of them, or the next one has another load factor.
            if !missed && (found.modes.len() < count || to < count) {
                return Ok(found);
            }
            if 2 * count > MOST_TIMES * (last + MORE) {
                return Err(ImperfectionError::Cluster {
                    imperfection: name.to_owned(),
                    mode: last,
                    count: to - from,
                    factor: found.modes[last - 1].factor,
                    within: ONE_FACTOR,
                }
                .into());
            }
            count *= 2;
        }
    }

    /// First mode, and the one behind the last, that share a load factor with a mode.
    fn span_of(&self, mode: usize) -> (usize, usize) {
        let is_one = |a: usize| (self.modes[a + 1].factor / self.modes[a].factor - 1.0).abs() <= ONE_FACTOR;
        let (mut from, mut to) = (mode, mode + 1);
        while from > 0 && is_one(from - 1) {
            from -= 1;
        }
        while to < self.modes.len() && is_one(to - 1) {
            to += 1;
        }
        (from, to)
    }

    /// The mode of this index in the basis of its span that does not hang on rounding.
    fn basis_vector(&self, perfect: &Mesh, mode: usize) -> Vec<[f64; 3]> {
        let (from, to) = self.span_of(mode);
        let shapes: Vec<&[[f64; 3]]> = self.modes[from..to].iter().map(|mode| &*mode.shape).collect();
        let shares = Span::of(perfect, &shapes).basis_vector(mode - from);
        let mut sum = vec![[0.0; 3]; perfect.point_count()];
        for (share, shape) in shares.iter().zip(shapes) {
            sum.iter_mut().zip(shape).for_each(|(sum, shift)| *sum = add(*sum, scaled(*share, *shift)));
        }
        sum
    }
}

/// The span of some shapes, in an orthonormal basis of sums of them.
struct Span {
    samples: Vec<SurfaceSample>,
    /// Values of each basis vector at the samples.
    values: Vec<Vec<[f64; 3]>>,
    /// Shares of the shapes in each basis vector.
    shares: Vec<Vec<f64>>,
}

impl Span {
    /// Makes shapes orthonormal in their order (Gram and Schmidt).
    fn of(perfect: &Mesh, shapes: &[&[[f64; 3]]]) -> Self {
        let samples = SurfaceSample::all(perfect);
        let mut span = Self { samples, values: Vec::new(), shares: Vec::new() };
        for (number, shape) in shapes.iter().enumerate() {
            let mut values: Vec<[f64; 3]> = span.samples.iter().map(|sample| sample.moved(perfect, shape)).collect();
            let mut shares: Vec<f64> = (0..shapes.len()).map(|k| f64::from(u8::from(k == number))).collect();
            for (other, of_other) in span.values.iter().zip(&span.shares) {
                let share = span.product(&values, other);
                values.iter_mut().zip(other).for_each(|(value, other)| *value = sub(*value, scaled(share, *other)));
                shares.iter_mut().zip(of_other).for_each(|(value, other)| *value -= share * other);
            }
            let scale = 1.0 / span.product(&values, &values).sqrt();
            span.values.push(values.into_iter().map(|value| scaled(scale, value)).collect());
            span.shares.push(shares.into_iter().map(|share| scale * share).collect());
        }
        span
    }

    /// ∫ a·b dA.
    fn product(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        self.samples.iter().zip(a.iter().zip(b)).map(|(sample, (a, b))| sample.area * dot(*a, *b)).sum()
    }

    /// Shares of the shapes in a vector of the basis of the projections of fixed fields.
    fn basis_vector(&self, index: usize) -> Vec<f64> {
        let size = self.values.len();
        let field = FixedFields::around(&self.samples);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for number in 0..TRIES * size {
            let fixed: Vec<[f64; 3]> = self.samples.iter().map(|sample| field.at(number, sample.position)).collect();
            let length = self.product(&fixed, &fixed).sqrt();
            let mut found: Vec<f64> = self.values.iter().map(|value| self.product(value, &fixed) / length).collect();
            for other in &basis {
                let share: f64 = found.iter().zip(other).map(|(a, b)| a * b).sum();
                found.iter_mut().zip(other).for_each(|(a, b)| *a -= share * b);
            }
            let left = found.iter().map(|share| share * share).sum::<f64>().sqrt();
            if left > LEAST_SHARE {
                basis.push(found.into_iter().map(|share| share / left).collect());
            }
            if basis.len() > index {
                break;
            }
        }
        // None of the fixed fields has a share: only a span that is orthogonal to all of them is without a basis.
        let unit = || (0..size).map(|k| f64::from(u8::from(k == index))).collect();
        let chosen = basis.into_iter().nth(index).unwrap_or_else(unit);
        let of_shape =
            |shape: usize| chosen.iter().zip(&self.shares).map(|(share, shares)| share * shares[shape]).sum();
        (0..size).map(of_shape).collect()
    }
}

/// Fields in space without any symmetry, with kinks, so that modes of any wavelength have a share in them.
struct FixedFields {
    low: [f64; 3],
    size: f64,
}

impl FixedFields {
    fn around(samples: &[SurfaceSample]) -> Self {
        let bound = |start: f64, of: fn(f64, f64) -> f64| {
            samples.iter().fold([start; 3], |bound, sample| [0, 1, 2].map(|c| of(bound[c], sample.position[c])))
        };
        let (low, high) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
        Self { low, size: (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max) }
    }

    fn at(&self, number: usize, place: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let waves = |j: usize| 0.6 + (0.618_033_988_75 * (1 + j + 3 * c + 9 * number) as f64).fract();
            let along: f64 = (0..3).map(|j| waves(j) * (place[j] - self.low[j]) / self.size).sum();
            let phase = (0.414_213_562_37 * (1 + c + 3 * number) as f64).fract();
            4.0 * ((along + phase).fract() - 0.5).abs() - 1.0
        })
    }
}

/// The lowest modes about the undeformed perfect structure.
fn lowest_modes(
    scene: &Scene,
    perfect: &Arc<Mesh>,
    own: &[Arc<dyn TermSource>],
    name: &str,
    count: usize,
) -> Result<BucklingModes, ModelError> {
    let none = |reason: String| ModelError::from(ImperfectionError::NoModes { imperfection: name.to_owned(), reason });
    // The modes are those of the loads at factor 1, in the ratio that they have there, however they get there.
    let mut straight = scene.clone();
    let histories = straight.actions.iter_mut().map(|action| &mut action.history);
    histories.chain(straight.supports.iter_mut().map(|support| &mut support.history)).for_each(|history| {
        *history = history.straight();
    });
    let scene = &straight;
    let work = Workspace::with_terms(scene, perfect, own);
    let mut work = work.map_err(|error| match error {
        WorkspaceError::Model(cause) => cause,
        WorkspaceError::Factor(cause) => none(cause.to_string()),
    })?;
    let unknowns = &work.discretization().unknowns;
    check_held(scene, perfect, unknowns, own)?;
    let turns = if unknowns.turns_are_unknown() { vec![[0.0; 3]; unknowns.sections().len()] } else { Vec::new() };
    let displacement = vec![[0.0; 3]; perfect.point_count()];
    let at = Configuration { displacement: &displacement, turns: &turns, parameter: 0.0, largest_force: 0.0 };
    linear_buckling(&mut work, at, count).map_err(|error| none(error.to_string()))
}
