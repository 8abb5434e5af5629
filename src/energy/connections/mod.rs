//! What connects the shells of a structure, as terms: joints along edges, and bonds over areas.
//!
//! | file | what |
//! |---|---|
//! | `coupled` | energies at points at which two surfaces meet, and their sums |
//! | `kept_angle`, `mean_gap` | the energies of a joint: of the angle, and of gaps between edges |
//! | `glue` | the energy of a bond |
//! | `layer` | where the faces that a bond glues lie together |
//! | `bonded` | the energy of a bond, and what of it is summed up where |
//! | `joint` | a joint, and where its energies are summed up |
//! | `greville_rule` | points of one direction of a patch at which a layer is summed up |
//! | `glued_area` | where two shells are glued |
//! | `tractions` | what bonds carry anywhere on their shells |
//! | `state` | what joints and bonds show of a state |

mod bonded;
mod coupled;
mod glue;
mod glued_area;
mod greville_rule;
mod joint;
mod kept_angle;
mod layer;
mod mean_gap;
mod state;
mod tractions;

use std::borrow::Cow;
use std::sync::Arc;

use self::bonded::Bonded;
use self::glued_area::GluedArea;
use self::joint::Joint;
use self::layer::{Layer, Side};
use crate::energy::{At, Tangent, Term};
use crate::model::{Member, ModelError, edge_pairs, members, perfect_on};
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
    energy: Arc<Energy>,
}

#[derive(Debug)]
enum Energy {
    Joint(Joint),
    Bond(Bonded),
}

impl Energy {
    /// The terms of which it is the sum.
    fn parts(&self) -> Box<dyn Iterator<Item = &dyn Term> + '_> {
        match self {
            Self::Joint(joint) => Box::new(joint.parts()),
            Self::Bond(bond) => Box::new(bond.parts()),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Joint(_) => "joint",
            Self::Bond(_) => "bond",
        }
    }
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
                let energy = Arc::new(Energy::Joint(joint));
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
            let sides = bond.shells.map(|shell| {
                let Member { scene, patch, points, .. } = &members[shell];
                let perfect = Cow::Borrowed(perfect_members[shell].patch);
                Side { patch, perfect, first: points.start, material: &scene.material }
            });
            let layer = Layer::new(bond, sides);
            let area = GluedArea::new(&bond.name, &layer)?;
            let energy = Arc::new(Energy::Bond(Bonded::new(&layer, area)));
            list.push(Connection { name: bond.name.clone(), energy });
        }
        Ok(Self { list })
    }

    /// Returns the term of each joint and bond, and what messages call it.
    pub(super) fn terms(&self) -> impl Iterator<Item = (String, Box<dyn Term>)> {
        self.list.iter().map(|Connection { name, energy }| {
            (format!("{} \"{name}\"", energy.kind()), Box::new(Shared(energy.clone())) as Box<dyn Term>)
        })
    }
}

/// An energy that others look at as well.
#[derive(Debug)]
struct Shared(Arc<Energy>);

impl Term for Shared {
    fn pairs(&self) -> Vec<[usize; 2]> {
        self.0.parts().flat_map(Term::pairs).collect()
    }

    fn energy(&self, at: At) -> f64 {
        self.0.parts().map(|part| part.energy(at)).sum::<f64>() + 0.0
    }

    /// The energy of a connection does not depend on the parameter.
    fn put_in(&self, _: At, _: f64) -> f64 {
        0.0
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.0.parts().for_each(|part| part.add_forces(at, forces));
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        self.0.parts().for_each(|part| part.add_tangent(at, tangent));
    }

    fn add_stress_stiffness(&self, at: At, rates: &[[f64; 3]], tangent: &mut Tangent) {
        self.0.parts().for_each(|part| part.add_stress_stiffness(at, rates, tangent));
    }
}
