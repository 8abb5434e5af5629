//! What changes of temperature and of natural curvature make of the shell's free strain, over the scene's parameter.

use crate::model::gauss::span_points;
use crate::scene::{Action, ActionKind, History, Scene};
use crate::shell::{FreeStrain, cross, norm, thermal_strain};
use crate::spline::{Mesh, mid_surface_point};

/// Free strain of the shell over the parameter.
#[derive(Debug, Default)]
pub struct FreeStrains {
    /// By one kelvin.
    per_kelvin: NaturalState,
    sources: Vec<Source>,
}

/// The state without forces at a value of the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NaturalState {
    /// The same everywhere on the shell.
    pub strain: FreeStrain,
    /// Energy that layers keep in each other there, over the whole model, N·mm.
    pub locked_n_mm: f64,
}

/// An action, at factor 1.
#[derive(Debug)]
struct Source {
    history: History,
    /// K.
    change_k: f64,
    /// κ₁₁, κ₂₂, 2κ₁₂, 1/mm.
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
    pub fn new(scene: &Scene, mesh: &Mesh) -> Self {
        let sources: Vec<Source> = scene.actions.iter().filter_map(Source::of).collect();
        // A scene is checked for expansions where the temperature changes.
        let thermal = thermal_strain(&scene.material).filter(|_| !sources.is_empty());
        let per_kelvin = thermal.map_or_else(NaturalState::default, |(strain, locked_n_per_mm)| NaturalState {
            strain,
            locked_n_mm: locked_n_per_mm * reference_area(mesh),
        });
        Self { per_kelvin, sources }
    }

    /// At a value of the parameter; `None` where the scene has no such actions.
    pub fn at(&self, parameter: f64) -> Option<NaturalState> {
        self.sum(|history| history.at(parameter))
    }

    /// At a value of the parameter, and by its rate beyond: what differs from [`Self::at`] by the rate of the strain.
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
        let NaturalState { strain: FreeStrain { membrane, bending }, locked_n_mm } = self.per_kelvin;
        let strain = FreeStrain {
            membrane: membrane.map(|strain| change_k * strain),
            bending: [0, 1, 2].map(|i| change_k * bending[i] + curvature[i]),
        };
        // A natural curvature fits together by itself: its strain z κ is that of a shell that bends.
        Some(NaturalState { strain, locked_n_mm: change_k * change_k * locked_n_mm })
    }
}

/// Area of the undeformed surface, mm².
fn reference_area(mesh: &Mesh) -> f64 {
    let [along, across] = [0, 1].map(|direction| span_points(mesh, direction, mesh.degree[direction] + 1));
    let points = along.iter().flat_map(|one| across.iter().map(move |two| (one, two)));
    points
        .map(|([u, along], [v, across])| {
            let [a1, a2, ..] = mid_surface_point(mesh, &[], [*u, *v]).derivatives;
            along * across * norm(cross(a1, a2))
        })
        .sum()
}
