//! The scene's probes at an equilibrium.

use std::cell::OnceCell;

use crate::adapt::largest_bending_strain;
use crate::energy::{At, ConnectionState, Discretization, GreatestTraction};
use crate::equilibrium::{Configuration, Coordinates, Workspace};
use crate::model::{
    Exerted, Member, ModelError, Placement, Site, control_expressions, direction_at, line_place, members, parameters_of,
};
use crate::record::{ConnectionReading, LargestTraction, Reading};
use crate::scene::{Axis, Component, Probe, ProbeKind, Reaction, Region, Scene, SurfaceDirection};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::mid_surface_point;

/// Reads every probe of a scene at an equilibrium; `energy` is what the whole shell stores, N·mm.
///
/// # Errors
/// Where a probe asks for what the scene does not have, or for a section moment that a term of the caller's own has no part of.
pub fn read_probes(
    scene: &Scene,
    work: &mut Workspace,
    at: Configuration,
    energy: f64,
) -> Result<Vec<Reading>, ModelError> {
    read(scene, work, at, energy, &scene.probes)
}

/// Reads the first probe of a scene; `None` where it has none.
///
/// # Errors
/// As for [`read_probes`].
pub(super) fn read_first_probe(
    scene: &Scene,
    work: &mut Workspace,
    at: Configuration,
    energy: f64,
) -> Result<Option<Reading>, ModelError> {
    let first = &scene.probes[..scene.probes.len().min(1)];
    Ok(read(scene, work, at, energy, first)?.pop())
}

fn read(
    scene: &Scene,
    work: &mut Workspace,
    at: Configuration,
    energy: f64,
    probes: &[Probe],
) -> Result<Vec<Reading>, ModelError> {
    if probes.is_empty() {
        return Ok(Vec::new());
    }
    let forces = work.forces(at);
    let discretization = work.discretization();
    let Coordinates { placement, .. } = Coordinates::of(&discretization.unknowns, at);
    let members = members(scene, &discretization.mesh);
    let reader =
        Reader { scene, members, discretization, at, placement, forces: &forces, exerted: OnceCell::new(), energy };
    probes.iter().map(|probe| reader.read(probe)).collect()
}

/// Reads the joints and bonds of a structure at an equilibrium.
pub(super) fn read_connections(work: &Workspace, at: Configuration) -> Vec<ConnectionReading> {
    let Discretization { mesh, connections, .. } = work.discretization();
    let stored = work.energy(at.displacement, at.parameter);
    let states = connections.states(At { mesh, displacement: at.displacement, parameter: at.parameter });
    let reading = |ConnectionState { name, energy_n_mm, opened_deg, tractions }| {
        let energy_share = if stored > 0.0 { energy_n_mm / stored } else { 0.0 };
        let largest = tractions.map(|all| all.map(|GreatestTraction { mpa, at }| LargestTraction { mpa, at }));
        let [peel, shear] = largest.map_or([None; 2], |all| all.map(Some));
        ConnectionReading { name, energy_share, opened_deg, peel, shear }
    };
    states.into_iter().map(reading).collect()
}

struct Reader<'a> {
    scene: &'a Scene,
    members: Vec<Member<'a>>,
    discretization: &'a Discretization,
    at: Configuration<'a>,
    placement: Placement<'a>,
    /// Forces that supports and joints exert on the control points, N.
    forces: &'a [[f64; 3]],
    /// Forces of each support apart, computed once a probe asks for them.
    exerted: OnceCell<Exerted>,
    energy: f64,
}

impl Reader<'_> {
    fn read(&self, Probe { name, shell, kind }: &Probe) -> Result<Reading, ModelError> {
        let member = &self.members[*shell];
        let (value, unit, at) = match kind {
            ProbeKind::Displacement { on, component } => (self.displacement(member, *on, *component), "mm", None),
            ProbeKind::Reaction { support, component } => self.reaction(support, *component)?,
            ProbeKind::SectionMoment { on, component } => (self.section_moment(name, *on, *component)?, "N·mm", None),
            ProbeKind::Energy => (self.energy, "N·mm", None),
            ProbeKind::BendingStrain => {
                let on = (member.patch, &self.discretization.shells[*shell]);
                let (value, at) = largest_bending_strain(on, self.at.displacement);
                (value, "1/mm", Some(at))
            }
        };
        Ok(Reading { name: name.clone(), value, unit: unit.into(), at })
    }

    fn exerted(&self) -> &Exerted {
        self.exerted.get_or_init(|| self.placement.exerted(self.forces))
    }

    fn displacement(&self, member: &Member, on: [f64; 2], component: Component) -> f64 {
        let place = parameters_of(&member.scene.geometry, on);
        let moved = &self.at.displacement[member.points.clone()];
        let [after, before] = [moved, &[]].map(|u| mid_surface_point(member.patch, u, place));
        let moved = sub(after.position, before.position);
        let along = |direction: SurfaceDirection| {
            let tangents = [before.derivatives[0], before.derivatives[1]];
            let site = Site { position: before.position, tangents, edge: None };
            dot(moved, direction_at(&member.scene, &site, direction))
        };
        match component {
            Component::X => moved[0],
            Component::Y => moved[1],
            Component::Z => moved[2],
            Component::Magnitude => norm(moved),
            Component::Normal => along(SurfaceDirection::Normal),
            Component::Radial => along(SurfaceDirection::Radial),
        }
    }

    /// Computes the force and moment that a support or a spring exerts.
    fn reaction(
        &self,
        support: &str,
        component: Reaction,
    ) -> Result<(f64, &'static str, Option<[f64; 2]>), ModelError> {
        let spring = self.scene.springs.iter().find(|spring| spring.name == support);
        let supports = self.discretization.unknowns.supports();
        let holder = spring.map_or(support, |spring| &spring.section);
        let Some(index) = supports.find(holder) else {
            return Err(ModelError::NoSuchSupport { support: holder.to_owned() });
        };
        let trace = &supports.footprints[index];
        let pole = trace.section.map_or(trace.pole, |section| add(trace.pole, self.placement.translation(section)));
        let [force, moment] = match spring {
            None => {
                self.resultant(self.exerted().by_supports[index].iter().map(|(point, force)| (*point, *force)), pole)
            }
            Some(spring) => {
                let Configuration { displacement, parameter, .. } = self.at;
                let at = At { mesh: &self.discretization.mesh, displacement, parameter };
                let forces = self.discretization.terms.forces_of_spring(&spring.name, at);
                self.resultant(forces.into_iter().enumerate(), pole)
            }
        };
        Ok(match component {
            Reaction::ForceX => (force[0], "N", None),
            Reaction::ForceY => (force[1], "N", None),
            Reaction::ForceZ => (force[2], "N", None),
            Reaction::MomentX => (moment[0], "N·mm", None),
            Reaction::MomentY => (moment[1], "N·mm", None),
            Reaction::MomentZ => (moment[2], "N·mm", None),
        })
    }

    fn position(&self, point: usize) -> [f64; 3] {
        add(self.discretization.mesh.point(point), self.at.displacement[point])
    }

    /// Sums forces on control points, and their moments about `pole`.
    fn resultant(&self, forces: impl Iterator<Item = (usize, [f64; 3])>, pole: [f64; 3]) -> [[f64; 3]; 2] {
        forces.fold([[0.0; 3]; 2], |[sum, moment], (point, force)| {
            let arm = sub(self.position(point), pole);
            [add(sum, force), add(moment, cross(arm, force))]
        })
    }

    /// Computes the moment of a section by equilibrium of the side of smaller u or v: the forces of supports, loads and
    /// other terms there are carried across the line. Terms are summed over just that side. Where supports hold within
    /// one element of the line, their forces are shared out between the sides as the functions of the control points
    /// are.
    fn section_moment(&self, probe: &str, on: Region, component: Axis) -> Result<f64, ModelError> {
        let Discretization { mesh, shells, terms, .. } = self.discretization;
        let [shell] = &shells[..] else {
            return Err(ModelError::NotASection { probe: probe.to_owned() });
        };
        let patch = mesh.lone();
        let Some(line) = line_place(self.scene, patch, on) else {
            return Err(ModelError::NotASection { probe: probe.to_owned() });
        };
        let mut limits = [f64::INFINITY; 2];
        limits[line.direction] = line.parameter;
        let terms = terms.below(self.scene, mesh, std::slice::from_ref(&shell.tables), limits)?;
        let at = At { mesh, displacement: self.at.displacement, parameter: self.at.parameter };
        let acting = terms.forces(at);
        let places = control_expressions(self.scene, patch, on)?;
        let count = places.len() as f64;
        let middle = places
            .iter()
            .flatten()
            .fold([0.0; 3], |sum, (point, factor)| add(sum, scaled(factor / count, self.position(*point))));
        let grid = patch.grid();
        let side = (0..grid.len()).filter(|point| grid.place(*point)[line.direction] < line.first_beyond);
        let Exerted { by_joints, .. } = self.exerted();
        // A joint across the line acts on control points of both sides: its forces on this side are not external.
        let held = side.map(|point| {
            let joint = by_joints.get(&point).copied().unwrap_or_default();
            (point, sub(self.forces[point], joint))
        });
        let [_, moment] = self.resultant(held.chain(acting.into_iter().enumerate()), middle);
        Ok(-match component {
            Axis::X => moment[0],
            Axis::Y => moment[1],
            Axis::Z => moment[2],
        })
    }
}
