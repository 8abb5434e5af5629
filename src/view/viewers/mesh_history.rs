//! What a run adds to its log for viewers, stage by stage.

use super::log_lines::log_lines;
use super::scene_update::{Coloured, scene_update};
use super::{Topics, message};
use crate::journal::{ViewerMessage, ViewerTopics, format::log_time_ns};
use crate::record::{Outcome, Record};
use crate::scene::{Geometry, Scene};
use crate::spline::Mesh;
use crate::state::State;
use crate::view::deformed_surface;

/// Cells of a picture for each element along u and v: two, and one where there are so many elements that a viewer shows no more
/// by two.
pub(super) fn cells_per_element(scene: &Scene, mesh: &Mesh) -> [usize; 2] {
    const MANY: usize = 48;
    let (elements, cuts) = (mesh.elements(), scene.symmetry.cuts());
    let most = |direction: usize| elements.each().iter().map(|counts| counts[direction]).max().unwrap_or(0);
    [0, 1].map(|direction| if most(direction) << usize::from(cuts[direction]) < MANY { 2 } else { 1 })
}

/// Bending strain at the bright end of the colours, in units of 1/R: a fold has 1, and up to 1.14 beside its middle.
const BRIGHTEST: f64 = 1.2;

/// A source of viewer messages: the deformed mesh, coloured by bending strain, after each stage that ends in an equilibrium, and
/// a line about every stage.
#[derive(Debug)]
pub struct MeshHistory {
    scene: Scene,
    topics: Topics,
}

impl MeshHistory {
    /// Creates the source of messages for a run of this scene.
    pub fn new(scene: &Scene) -> Self {
        Self { scene: scene.clone(), topics: Topics::new() }
    }

    /// The deformed mesh.
    fn picture(&self, state: &State, time_ns: u64) -> Option<ViewerMessage> {
        // A state in a log is finite, so samples of it are too; a picture is no reason to stop a run.
        let samples = deformed_surface(
            &self.scene,
            &state.mesh,
            &state.displacement,
            cells_per_element(&self.scene, &state.mesh),
        )
        .ok()?;
        let mut coloured = Coloured::new(samples);
        coloured.range = match self.scene.geometry {
            // A tape spring keeps its colours from state to state; other shells have no curvature to measure by.
            Geometry::TapeSpring { radius_mm, .. } => [0.0, BRIGHTEST / radius_mm],
            _ => [0.0, coloured.range[1]],
        };
        message(&self.topics.scene, &scene_update(&coloured, time_ns))
    }
}

impl ViewerTopics for MeshHistory {
    fn messages(&mut self, state: &State, record: &Record) -> Vec<ViewerMessage> {
        let report = &record.report;
        let time_ns = log_time_ns(record.commit.ordinal);
        let lines = log_lines(record, self.scene.loads_follow(), time_ns);
        let lines = lines.iter().filter_map(|line| message(&self.topics.log, line));
        let moved = report.outcome == Outcome::Done && report.stage.finds_equilibrium();
        let picture = moved.then(|| self.picture(state, time_ns)).flatten();
        lines.chain(picture).collect()
    }
}
