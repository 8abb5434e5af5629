//! The shells of a state one by one, each with what bonds carry on it.

use super::export::WholeShell;
use super::fields::ShellFields;
use crate::energy::GluedLayers;
use crate::model::{Member, members};
use crate::scene::Scene;
use crate::state::State;

/// The shells of a scene in a state.
#[derive(Debug)]
pub struct ShellsOfState<'a> {
    scene: &'a Scene,
    state: &'a State,
    members: Vec<Member<'a>>,
    layers: GluedLayers<'a>,
}

impl<'a> ShellsOfState<'a> {
    /// Takes the shells apart.
    pub fn new(scene: &'a Scene, state: &'a State) -> Self {
        let members = members(scene, &state.mesh);
        Self { scene, state, members, layers: GluedLayers::new(scene, &state.mesh, &state.displacement) }
    }

    /// The fields of each shell, in the order of the scene.
    pub fn fields(&self) -> impl ExactSizeIterator<Item = ShellFields<'_>> {
        self.members.iter().map(|Member { index, scene, patch, points }| {
            let Self { state: State { displacement, parameter, .. }, layers, .. } = self;
            let glued = layers.of_shell(*index);
            ShellFields::new(scene, patch, &displacement[points.clone()], *parameter).with_bonds(glued)
        })
    }

    /// Each shell whole, with its name.
    pub fn whole(&self) -> Vec<WholeShell<'_>> {
        let named = |(index, fields)| WholeShell::of(fields, self.scene.shell_name(index));
        self.fields().enumerate().map(named).collect()
    }
}
