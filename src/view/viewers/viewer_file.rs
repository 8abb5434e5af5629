//! A log as viewers of MCAP play it, made afterwards: pictures of chosen states with the reports and lines of all stages, at times
//! that play well. A file of its own, without states: no run continues from it.

use super::log_lines::log_lines;
use super::mesh_history::cells_per_element;
use super::scene_update::{Coloured, scene_update};
use super::{Topics, message};
use crate::journal::{TimedMessages, TimedMessagesError};
use crate::record::Record;
use crate::scene::Scene;
use crate::state::State;
use crate::view::{Field, SamplesError, coloured_surface, deformed_surface};

/// When a viewer shows what a stage did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepTimes {
    /// A tenth of a second for each load step.
    Steps,
    /// When it was there: the wall times of all stages so far, without the time between a stop and going on.
    Wall,
}

/// Time of a load step, nanoseconds.
const STEP_NS: u64 = 100_000_000;

/// A file that is being made.
pub struct ViewerFile {
    topics: Topics,
    times: StepTimes,
    wall_s: f64,
    /// What colours pictures: a component of a field or the length of all of them; the larger bending strain where it is not said.
    shown: Option<(Field, Option<usize>)>,
    /// The values at the ends of the colours.
    range: [f64; 2],
    file: TimedMessages,
}

impl ViewerFile {
    /// Creates a file with pictures that are coloured by a component of a field, or the length of all of them, or by the larger
    /// bending strain.
    ///
    /// # Errors
    /// None that a log can cause.
    pub fn new(times: StepTimes, shown: Option<(Field, Option<usize>)>) -> Result<Self, TimedMessagesError> {
        let (topics, file) = (Topics::new(), TimedMessages::new()?);
        Ok(Self { topics, times, wall_s: 0.0, shown, range: [f64::INFINITY, f64::NEG_INFINITY], file })
    }

    /// Makes the colours reach over the values of a state. The colours of all pictures mean the same.
    ///
    /// # Errors
    /// Where the state cannot be drawn.
    pub fn reach_over(&mut self, scene: &Scene, state: &State) -> Result<(), SamplesError> {
        let [low, high] = self.coloured(scene, state)?.range;
        self.range = [self.range[0].min(low), self.range[1].max(high)];
        Ok(())
    }

    /// Adds a stage, and gives back its time, nanoseconds.
    ///
    /// # Errors
    /// Where MCAP refuses a message.
    pub fn add_stage(&mut self, scene: &Scene, record: &Record) -> Result<u64, TimedMessagesError> {
        self.wall_s += record.wall_s + record.kept_s;
        let time_ns = match self.times {
            StepTimes::Steps => record.report.step.saturating_mul(STEP_NS),
            StepTimes::Wall => (self.wall_s.max(0.0) * 1e9) as u64,
        };
        self.file.add_report(time_ns, record)?;
        let lines = log_lines(record, scene.loads_follow(), time_ns);
        lines
            .iter()
            .filter_map(|line| message(&self.topics.log, line))
            .try_for_each(|line| self.file.add(time_ns, &line))?;
        Ok(time_ns)
    }

    /// Adds a picture of a state at a time, nanoseconds.
    ///
    /// # Errors
    /// Where the state cannot be drawn, or MCAP refuses the message.
    pub fn add_picture(&mut self, scene: &Scene, state: &State, time_ns: u64) -> Result<(), PictureError> {
        let mut coloured = self.coloured(scene, state)?;
        coloured.range = self.range;
        let picture = message(&self.topics.scene, &scene_update(&coloured, time_ns));
        Ok(picture.map_or(Ok(()), |picture| self.file.add(time_ns, &picture))?)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// Where MCAP refuses to end it.
    pub fn finish(self) -> Result<Vec<u8>, TimedMessagesError> {
        self.file.finish()
    }

    fn coloured(&self, scene: &Scene, state: &State) -> Result<Coloured, SamplesError> {
        let cells = cells_per_element(scene, &state.mesh);
        let samples = match &self.shown {
            None => deformed_surface(scene, &state.mesh, &state.displacement, cells),
            Some((field, component)) => coloured_surface(scene, state, field, *component, cells),
        };
        samples.map(Coloured::new)
    }
}

/// Why a picture is not in the file.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The state cannot be drawn.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// MCAP refuses it.
    #[error(transparent)]
    File(#[from] TimedMessagesError),
}
