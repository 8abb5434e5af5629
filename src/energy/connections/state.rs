//! What joints and bonds show of a state.

use super::bonded::Bonded;
use super::coupled::CoupledPoint;
use super::glue::{Glue, Traction};
use super::{Connection, Connections, Energy, Shared};
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
    /// Of a bond, the largest traction that opens it, and the largest shear traction.
    pub tractions: Option<[GreatestTraction; 2]>,
}

/// The largest traction of a kind in a bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GreatestTraction {
    /// Its size, MPa: per undeformed area.
    pub mpa: f64,
    /// Where it is, as parameters (u, v) of the bond's first shell.
    pub at: [f64; 2],
}

impl Connections {
    /// Looks at every connection that has an energy, joints first.
    pub fn states(&self, at: At) -> Vec<ConnectionState> {
        self.list.iter().map(|connection| connection.state(at)).collect()
    }
}

impl Connection {
    fn state(&self, at: At) -> ConnectionState {
        let energy_n_mm = Shared(self.energy.clone()).energy(at);
        let (opened_deg, tractions) = match &*self.energy {
            Energy::Bond(bond) => (None, greatest(bond, at)),
            Energy::Joint(joint) => {
                let opened = joint.seen().map(|point| point.law.opened(&point.deformed(at.displacement)).to_degrees());
                let largest = opened.fold(None, |most: Option<f64>, angle| {
                    Some(most.map_or(angle, |most| if angle.abs() > most.abs() { angle } else { most }))
                });
                (largest, None)
            }
        };
        ConnectionState { name: self.name.clone(), energy_n_mm, opened_deg, tractions }
    }
}

/// The largest opening and shear tractions at the Greville points of a bond.
fn greatest(bond: &Bonded, at: At) -> Option<[GreatestTraction; 2]> {
    let of_point = |point: &CoupledPoint<Glue>| {
        let Traction { peel_mpa, shear_mpa: [one, two] } = point.law.traction(&point.deformed(at.displacement));
        [peel_mpa, one.hypot(two)].map(|mpa| GreatestTraction { mpa, at: point.sides[0].at })
    };
    let larger = |one: GreatestTraction, other: GreatestTraction| if other.mpa > one.mpa { other } else { one };
    bond.seen().iter().map(of_point).reduce(|all, one| [larger(all[0], one[0]), larger(all[1], one[1])])
}
