//! What connects the shells of a structure, as terms: joints along edges, and bonds over areas.
//!
//! | file | what |
//! |---|---|
//! | `coupled` | energies at points at which two surfaces meet, and their sums |
//! | `kept_angle`, `mean_gap` | the energies of a joint: of the angle, and of gaps between edges |
//! | `glue` | the energy of a bond |
//! | `layer` | where the faces that a bond glues lie together |
//! | `joint` | a joint, and where its energies are summed up |
//! | `glued_points` | where the energy of a bond is summed up |
//! | `tractions` | what bonds carry anywhere on their shells |
//! | `state` | what joints and bonds show of a state |

mod coupled;
mod glue;
mod glued_points;
mod joint;
mod kept_angle;
mod layer;
mod mean_gap;
mod state;
mod tractions;

use std::sync::Arc;

use self::coupled::Coupling;
use self::glue::Glue;
use self::joint::Joint;
use crate::energy::{At, Tangent, Term};
use crate::model::{ModelError, edge_pairs, members, perfect_on};
use crate::scene::Scene;
use crate::spline::Mesh;

pub use glue::Traction;
pub use state::{ConnectionState, GreatestTraction};
pub use tractions::{GluedLayers, GluedShell};

/// The connections of a structure that have an energy.
#[derive(Clone, Debug, Default)]
pub struct Connections {
    list: Vec<Connection>,
}

/// A joint or a bond, with its energy.
#[derive(Clone, Debug)]
struct Connection {
    name: String,
    energy: Energy,
}

#[derive(Clone, Debug)]
enum Energy {
    Joint(Arc<Joint>),
    Bond(Arc<Coupling<Glue>>),
}

impl Connections {
    /// Finds the joints and bonds of a scene on a mesh.
    ///
    /// # Errors
    /// Where edges do not meet, or faces do not lie together.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        let mut list = Vec::new();
        if scene.joints.is_empty() && scene.bonds.is_empty() {
            return Ok(Self { list });
        }
        let members = members(scene, mesh);
        for pair in edge_pairs(scene, &members)? {
            if let Some(joint) = Joint::of(&pair, &members) {
                let energy = Energy::Joint(Arc::new(joint));
                list.push(Connection { name: pair.joint.name.clone(), energy });
            }
        }
        if scene.bonds.is_empty() {
            return Ok(Self { list });
        }
        // What is glued is seen on the perfect shells: an imperfection parts no faces, and brings none together.
        let perfect = perfect_on(scene, mesh)?;
        let perfect_members = crate::model::members(scene, &perfect);
        for bond in &scene.bonds {
            let points = glued_points::glued_points(bond, &members, &perfect_members)?;
            let energy = Energy::Bond(Arc::new(Coupling::new(points)));
            list.push(Connection { name: bond.name.clone(), energy });
        }
        Ok(Self { list })
    }

    /// Returns the term of each joint and bond, and what messages call it.
    pub(super) fn terms(&self) -> impl Iterator<Item = (String, Box<dyn Term>)> {
        self.list.iter().map(|Connection { name, energy }| match energy {
            Energy::Joint(coupling) => {
                (format!("joint \"{name}\""), Box::new(Shared(coupling.clone())) as Box<dyn Term>)
            }
            Energy::Bond(coupling) => (format!("bond \"{name}\""), Box::new(Shared(coupling.clone())) as Box<dyn Term>),
        })
    }
}

/// A term that others look at as well.
#[derive(Debug)]
struct Shared<T>(Arc<T>);

impl<T: Term> Term for Shared<T> {
    fn pairs(&self) -> Vec<[usize; 2]> {
        self.0.pairs()
    }

    fn energy(&self, at: At) -> f64 {
        self.0.energy(at)
    }

    /// The energy of a connection does not depend on the parameter.
    fn put_in(&self, _: At, _: f64) -> f64 {
        0.0
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.0.add_forces(at, forces);
    }

    fn has_tangent(&self) -> bool {
        self.0.has_tangent()
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        self.0.add_tangent(at, tangent);
    }

    fn add_stress_stiffness(&self, at: At, rates: &[[f64; 3]], tangent: &mut Tangent) {
        self.0.add_stress_stiffness(at, rates, tangent);
    }
}
