//! What a mesh cannot show: the strain energy that halving every element would change.
//!
//! A shape in balance on a mesh is out of balance in the space with every knot span halved. With its residual r and stiffness
//! K there, the energy falls by ½ rᵀK⁻¹r to first order: that sees locking, which jumps of derivatives do not. Beside it
//! stands what the finer quadrature makes of the same shape: rules with few points miss what bends between them.

use std::sync::Arc;

use crate::adapt::project_displacements;
use crate::energy::TermSource;
use crate::equilibrium::{Configuration, LinearBuckling, Placed, Workspace};
use crate::model::MOST_CONTROL_POINTS;
use crate::scene::Scene;
use crate::shell::norm;
use crate::spline::Mesh;
use crate::state::State;

/// Control points of a halved mesh up to which it is looked at. A run may have more, and what is said at its end is not to take
/// several times the memory that it took.
const MOST_LOOKED_AT: usize = MOST_CONTROL_POINTS / 5;

/// Share of the energy that the free strain puts into a shell that is held, up to which the strain energy of one that is not
/// says nothing: where it takes its natural shape, all that is left is what elements and tolerance are off by.
const OF_HELD: f64 = 1e-3;

/// Motion to the equilibrium of the halved mesh, relative to the largest displacement, up to which the energy that it releases is
/// no sign of coarse elements: small waves of stretching in a shell that bends or turns freely, which hardly any energy hides.
/// Rolled plates, natural curvature and rigid turns have 1e-15 to 8e-4, with energies that would change by 59 % and more; shells
/// that elements of theirs cannot show 0.04 to 40.
const STILL: f64 = 5e-3;
/// The same relative to the size of the shell: displacements of a shell that was let go again are rounding.
const ROUNDING: f64 = 1e-9;

/// Energies of an equilibrium on its mesh and on the one with every element halved; of the model, N·mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halving {
    /// Strain energy on the equilibrium's own mesh.
    pub energy: f64,
    /// Strain energy of the same shape with the quadrature of the halved elements.
    pub integrated: f64,
    /// What finding equilibrium there would release, to first order, but for modes that are critical.
    pub released: f64,
    /// The largest motion of a control point on the way there, mm.
    pub motion_mm: f64,
    /// The largest displacement of a control point, and the longest side of the box of them all, mm.
    pub sizes_mm: [f64; 2],
    /// Strain energy that the free strain would put in, were the shell held as it was; 0 where nothing changes that.
    pub held: f64,
}

/// An equilibrium on the mesh with every element halved, as it was found and relaxed by one step of Newton's method.
#[derive(Debug)]
pub struct Halved {
    work: Workspace,
    halving: Halving,
    relaxed: Placed,
    parameter: f64,
    largest_force: f64,
}

impl Halved {
    /// Relaxes an equilibrium on the mesh with every element halved, where `own` are user-defined terms; `None` where the
    /// stiffness there has no factor, does not fit in memory, or there are more than a fifth of [`MOST_CONTROL_POINTS`]. What lies in the
    /// `critical` softest modes is left out of the energy: next to a critical point it says where that point lies.
    pub fn of(scene: &Scene, own: &[Arc<dyn TermSource>], state: &State, critical: usize) -> Option<Self> {
        let mesh = &state.mesh;
        let finer = Arc::new(mesh.halved());
        if finer.point_count() > MOST_LOOKED_AT {
            return None;
        }
        let projected = project_displacements(mesh, &finer, &state.displacement);
        let mut work = Workspace::with_terms(scene, &finer, own).ok()?;
        let (displacement, turns) =
            work.allowed(Configuration { displacement: &projected, ..Configuration::of(state) });
        let integrated = work.energy(&displacement, state.parameter);
        let at = Configuration { displacement: &displacement, turns: &turns, ..Configuration::of(state) };
        let held = work.energy(&vec![[0.0; 3]; displacement.len()], state.parameter);
        let release = work.linear_release(at).ok()?;
        let energy = state.strain_energy_n_mm / scene.symmetry.copies() as f64;
        let largest = displacement.iter().map(|moved| norm(*moved)).fold(0.0, f64::max);
        let sizes_mm = [largest, longest_side(&finer)];
        let soft = if critical > 0 { work.released_by_softest(&release, critical) } else { 0.0 };
        let (released, motion_mm) = (release.energy - soft, release.motion_mm());
        let halving = Halving { energy, integrated, released, motion_mm, sizes_mm, held };
        let relaxed = release.after(1.0, &work);
        Some(Self { work, halving, relaxed, parameter: state.parameter, largest_force: state.largest_force_n })
    }

    /// The energies on the two meshes, as computed when this was made.
    pub fn halving(&self) -> Halving {
        self.halving
    }

    /// The workspace of the halved mesh and the relaxed shape on it.
    pub fn relaxed(&mut self) -> (&mut Workspace, Configuration<'_>) {
        let (displacement, turns) = &self.relaxed;
        let Self { parameter, largest_force, .. } = *self;
        (&mut self.work, Configuration { displacement, turns, parameter, largest_force })
    }

    /// How the shell has buckled on the halved mesh, if it has.
    pub fn buckling(&mut self) -> Option<LinearBuckling> {
        let (work, at) = self.relaxed();
        LinearBuckling::of(work, at).ok().flatten()
    }
}

impl Halving {
    /// Whether the shell hardly moves on the way to equilibrium on the halved mesh.
    pub fn is_still(&self) -> bool {
        let [displacement, side] = self.sizes_mm;
        self.motion_mm <= STILL * displacement || self.motion_mm <= ROUNDING * side
    }

    /// What halving changes, relative to the strain energy (at least to a thousandth of what the free strain would put into a
    /// held shell): what the finer quadrature makes of the shape, or what equilibrium
    /// would release, whichever is more. Where few points miss what bends between them, the two nearly cancel. The baseline
    /// on 4 × 4 quadratic elements, at 20°, where it should have snapped: 59 and 66 % with `patch`, 0 and 31 % with `full`;
    /// on 4 × 4 cubic ones, before the snap: 0.1 and 0.6 %; refined as it ships, next to the limit point: 0.00 and 0.03 %.
    pub fn energy_share(&self) -> f64 {
        let quadrature = (self.integrated - self.energy).abs();
        quadrature.max(self.released.abs()) / compared_with(self.energy, self.held)
    }
}

/// The energy that a change of it is compared with, where a shell stores `energy` and the free strain would put `held` in, were it
/// held.
pub fn compared_with(energy: f64, held: f64) -> f64 {
    energy.max(OF_HELD * held)
}

/// The longest side of the box of a mesh's control points, mm.
fn longest_side(mesh: &Mesh) -> f64 {
    let side = |c: usize| {
        let along = || mesh.points().map(|point| point[c]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    side(0).max(side(1)).max(side(2))
}
