//! The free strain of the shell over the scene's parameter, from changes of temperature and of natural curvature.

use crate::model::gauss::span_points;
use crate::scene::{Action, ActionKind, History, Scene};
use crate::shell::{FreeStrain, cross, norm, thermal_strain};
use crate::spline::{Patch, mid_surface_point};

/// Free strain of the shell as a function of the scene's parameter.
#[derive(Debug, Default)]
pub struct FreeStrains {
    /// Natural state of the shell heated by one kelvin.
    per_kelvin: NaturalState,
    sources: Vec<Source>,
}

/// State without forces at a value of the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NaturalState {
    /// Free strain, the same everywhere on the shell.
    pub strain: FreeStrain,
    /// Energy that layers lock in each other in that state, over the whole model, N·mm.
    pub locked_n_mm: f64,
    /// Change of temperature, K.
    pub change_k: f64,
}

/// An action on the free strain, at factor 1.
#[derive(Debug)]
struct Source {
    history: History,
    /// Change of temperature, K.
    change_k: f64,
    /// Natural curvatures κ₁₁, κ₂₂, 2κ₁₂, 1/mm.
    bending: [f64; 3],
}

impl Source {
    fn of(action: &Action) -> Option<Self> {
        let (change_k, bending) = match action.kind {
            ActionKind::Temperature { change_k } => (change_k, [0.0; 3]),
            ActionKind::NaturalCurvature { change_per_mm: [k11, k22, k12] } => (0.0, [k11, k22, 2.0 * k12]),
            _ => return None,
        };
        Some(Self { history: action.history.clone(), change_k, bending })
    }
}

impl FreeStrains {
    /// Computes the free strains of a scene's actions on a mesh.
    pub fn new(scene: &Scene, mesh: &Patch) -> Self {
        let sources: Vec<Source> = scene.actions.iter().filter_map(Source::of).collect();
        // Reading the scene has checked that the material has expansions where the temperature changes.
        let thermal = thermal_strain(&scene.material).filter(|_| !sources.is_empty());
        let per_kelvin = thermal.map_or_else(NaturalState::default, |(strain, locked_n_per_mm)| NaturalState {
            strain,
            locked_n_mm: locked_n_per_mm * reference_area(mesh),
            change_k: 1.0,
        });
        Self { per_kelvin, sources }
    }

    /// Natural state at a value of the parameter; `None` where the scene has no such actions.
    pub fn at(&self, parameter: f64) -> Option<NaturalState> {
        self.sum(|history| history.at(parameter))
    }

    /// Natural state at a value of the parameter plus its rate, which differs from [`Self::at`] by the rate of the
    /// strain.
    pub fn beyond(&self, parameter: f64) -> Option<NaturalState> {
        self.sum(|history| history.at(parameter) + history.rate(parameter))
    }

    fn sum(&self, factor: impl Fn(&History) -> f64) -> Option<NaturalState> {
        if self.sources.is_empty() {
            return None;
        }
        let (mut change_k, mut curvature) = (0.0, [0.0; 3]);
        for source in &self.sources {
            let factor = factor(&source.history);
            change_k += factor * source.change_k;
            (0..3).for_each(|i| curvature[i] += factor * source.bending[i]);
        }
        let NaturalState { strain: FreeStrain { membrane, bending }, locked_n_mm, .. } = self.per_kelvin;
        let strain = FreeStrain {
            membrane: membrane.map(|strain| change_k * strain),
            bending: [0, 1, 2].map(|i| change_k * bending[i] + curvature[i]),
        };
        // A natural curvature locks no energy: its strain z κ is that of a shell that bends.
        Some(NaturalState { strain, locked_n_mm: change_k * change_k * locked_n_mm, change_k })
    }
}

/// Area of the undeformed surface, mm².
fn reference_area(mesh: &Patch) -> f64 {
    let [along, across] = [0, 1].map(|direction| span_points(mesh, direction, mesh.degree[direction] + 1));
    let points = along.iter().flat_map(|one| across.iter().map(move |two| (one, two)));
    points
        .map(|([u, along], [v, across])| {
            let [a1, a2, ..] = mid_surface_point(mesh, &[], [*u, *v]).derivatives;
            along * across * norm(cross(a1, a2))
        })
        .sum()
}
