//! The actions of a scene as terms of the balance of forces.
//!
//! | file | what |
//! |---|---|
//! | `dead` | loads that do not depend on the displacement |
//! | `following` | loads that turn with the shell |
//! | `points` | where loads are summed up |
//! | `strokes` | the work of loads that turn with the shell |

mod dead;
mod following;
mod points;
mod strokes;

use self::dead::{Dead, DeadLoads, dead_forces};
use self::following::{FollowerKind, Following, FollowingLoads};
use self::points::{LoadPoint, area_points, edge_points, line_points};
use crate::energy::Terms;
use crate::model::{ModelError, direction_at, parameters_of};
use crate::scene::{Action, ActionKind, ForceVector, History, LoadedArea, Region, Scene};
use crate::shell::{cross, scaled};
use crate::spline::Mesh;

/// Limits of the parameters that leave no part of the surface out.
const EVERYWHERE: [f64; 2] = [f64::INFINITY; 2];

impl Terms {
    /// Builds the terms of a scene's actions on a mesh.
    ///
    /// # Errors
    /// Where an action does not fit the surface.
    pub fn of_actions(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        Self::of_actions_below(scene, mesh, EVERYWHERE)
    }

    /// Builds the terms of a scene's actions on the part of the surface where both parameters are below `limits`.
    ///
    /// # Errors
    /// Where an action does not fit the surface.
    pub fn of_actions_below(scene: &Scene, mesh: &Mesh, limits: [f64; 2]) -> Result<Self, ModelError> {
        let mut loads = Loads::default();
        for action in &scene.actions {
            loads.add(scene, mesh, action, limits)?;
        }
        let mut terms = Self::default();
        if !loads.dead.0.is_empty() {
            terms.push("dead loads", Box::new(loads.dead));
        }
        if !loads.following.0.is_empty() {
            terms.push("loads that follow", Box::new(loads.following));
        }
        Ok(terms)
    }
}

/// Dead and following loads while they are collected.
#[derive(Debug, Default)]
struct Loads {
    dead: DeadLoads,
    following: FollowingLoads,
}

impl Loads {
    fn add(&mut self, scene: &Scene, mesh: &Mesh, action: &Action, limits: [f64; 2]) -> Result<(), ModelError> {
        let history = action.history.clone();
        match &action.kind {
            ActionKind::Force { on, force_n } => {
                let at = parameters_of(&scene.geometry, *on);
                if at[0] < limits[0] && at[1] < limits[1] {
                    self.push_dead(scene, mesh, history, &[LoadPoint::new(mesh, at, 1.0)], *force_n);
                }
            }
            ActionKind::LineForce { on, force_n_per_mm } => {
                let points = match on {
                    Region::Edge(edge) => edge_points(mesh, *edge, limits),
                    Region::Line(direction, fraction) => {
                        let direction = direction.index();
                        line_points(mesh, direction, parameters_of(&scene.geometry, [*fraction; 2])[direction], limits)
                    }
                    Region::Point(_) | Region::Whole => {
                        return Err(ModelError::NotALine { action: action.name.clone() });
                    }
                };
                self.push_dead(scene, mesh, history, &points, *force_n_per_mm);
            }
            ActionKind::AreaForce { force_n_per_mm2, per } => {
                let mut points = area_points(scene, mesh, limits);
                points.iter_mut().for_each(|point| point.weight *= point.area(*per, *force_n_per_mm2));
                self.push_dead(scene, mesh, history, &points, *force_n_per_mm2);
            }
            ActionKind::Gravity { acceleration_m_s2 } => {
                // kg/mm² times m/s² is N/mm². A scene without density has no gravity.
                let weight = scaled(scene.material.mass_kg_per_mm2().unwrap_or(0.0), *acceleration_m_s2);
                let mut points = area_points(scene, mesh, limits);
                let force = ForceVector::Components(weight);
                points.iter_mut().for_each(|point| point.weight *= point.area(LoadedArea::Undeformed, force));
                self.push_dead(scene, mesh, history, &points, force);
            }
            ActionKind::EdgeMoment { on, moment_n } => {
                let mut points = edge_points(mesh, *on, limits);
                points.iter_mut().for_each(|point| point.weight *= moment_n);
                let running = 1 - on.side().0.index();
                self.following.0.push(Following { history, kind: FollowerKind::Moment(running), points });
            }
            ActionKind::Pressure { pressure_mpa, follower } => {
                let mut points = area_points(scene, mesh, limits);
                points.iter_mut().for_each(|point| point.weight *= pressure_mpa);
                if *follower {
                    self.following.0.push(Following { history, kind: FollowerKind::Pressure, points });
                } else {
                    let along_normal = |point: &LoadPoint| cross(point.site.tangents[0], point.site.tangents[1]);
                    self.dead.0.push(Dead { history, forces: dead_forces(mesh, &points, along_normal) });
                }
            }
            // Such actions change the shell's free strain and exert no forces of their own.
            ActionKind::Temperature { .. } | ActionKind::NaturalCurvature { .. } => {}
        }
        Ok(())
    }

    fn push_dead(&mut self, scene: &Scene, mesh: &Mesh, history: History, points: &[LoadPoint], force: ForceVector) {
        let at = |point: &LoadPoint| match force {
            ForceVector::Components(components) => components,
            ForceVector::Along(size, direction) => scaled(size, direction_at(&scene.geometry, &point.site, direction)),
        };
        self.dead.0.push(Dead { history, forces: dead_forces(mesh, points, at) });
    }
}
