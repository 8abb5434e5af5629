//! What joints and bonds show of a state.

use super::{Connection, Connections, Energy};
use crate::energy::{At, Term};

/// A joint or a bond in a state.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectionState {
    /// Its name in the scene.
    pub name: String,
    /// Energy that it stores in the model, N·mm.
    pub energy_n_mm: f64,
    /// Of a joint, the largest angle by which the surfaces have turned against each other, degrees.
    pub opened_deg: Option<f64>,
}

impl Connections {
    /// Looks at every connection that has an energy, joints first.
    pub fn states(&self, at: At) -> Vec<ConnectionState> {
        self.list.iter().map(|connection| connection.state(at)).collect()
    }
}

impl Connection {
    fn state(&self, at: At) -> ConnectionState {
        let (energy_n_mm, opened_deg) = match &self.energy {
            Energy::Bond(glue) => (glue.energy(at), None),
            Energy::Joint(joint) => {
                let kept = joint.points.iter().filter(|point| point.law.rotation != 0.0);
                let opened = kept.map(|point| point.law.opened(&point.deformed(at.displacement)).to_degrees());
                let largest = opened.fold(None, |most: Option<f64>, angle| {
                    Some(most.map_or(angle, |most| if angle.abs() > most.abs() { angle } else { most }))
                });
                (joint.energy(at), largest)
            }
        };
        ConnectionState { name: self.name.clone(), energy_n_mm, opened_deg }
    }
}
