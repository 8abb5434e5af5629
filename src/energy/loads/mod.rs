//! The actions of a scene as terms of the balance of forces.
//!
//! | file | what |
//! |---|---|
//! | `dead` | loads that do not depend on the displacement |
//! | `following` | loads that turn with the shell |
//! | `points` | where loads are summed up |
//! | `sections` | loads on rigid sections |
//! | `strokes` | the work of loads that turn with the shell |

mod dead;
mod following;
mod points;
mod sections;
mod strokes;

use self::dead::{Dead, DeadLoads, dead_forces};
use self::following::{FollowerKind, Following, FollowingLoads};
use self::points::{LoadPoint, area_points, edge_points, line_points};
use self::sections::TurningCouple;
pub(super) use self::sections::{SectionPoints, is_below};
use crate::energy::Terms;
use crate::model::{Member, ModelError, direction_at, members, parameters_of};
use crate::scene::{Action, ActionKind, ForceVector, History, LoadedArea, Region, Scene, SectionTurns};
use crate::shell::{cross, scaled};
use crate::spline::Mesh;

/// Limits of the parameters that leave no part of the surface out.
const EVERYWHERE: [f64; 2] = [f64::INFINITY; 2];

impl Terms {
    /// Builds the terms of a scene's actions and of what hangs on its sections on a mesh.
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
        let members = members(scene, mesh);
        let mut loads = Loads { points: mesh.point_count(), ..Loads::default() };
        for action in &scene.actions {
            loads.add_to_section(scene, mesh, &members, (action, limits))?;
            for member in members.iter().filter(|member| action.shell.is_none_or(|shell| shell == member.index)) {
                loads.add(member, action, limits)?;
            }
        }
        let mut terms = Self::default();
        if !loads.dead.0.is_empty() {
            terms.push("dead loads", Box::new(loads.dead));
        }
        if !loads.following.0.is_empty() {
            terms.push("loads that follow", Box::new(loads.following));
        }
        for (name, couple) in loads.couples {
            terms.push(&name, Box::new(couple));
        }
        terms.hang_on_sections(scene, mesh, limits)?;
        Ok(terms)
    }
}

/// Dead and following loads while they are collected.
#[derive(Debug, Default)]
struct Loads {
    /// Number of control points of all shells.
    points: usize,
    dead: DeadLoads,
    following: FollowingLoads,
    couples: Vec<(String, TurningCouple)>,
}

impl Loads {
    fn add(&mut self, member: &Member, action: &Action, limits: [f64; 2]) -> Result<(), ModelError> {
        let (scene, patch) = (&*member.scene, member.patch);
        let history = action.history.clone();
        match &action.kind {
            ActionKind::Force { on, force_n } => {
                let at = parameters_of(&scene.geometry, *on);
                if at[0] < limits[0] && at[1] < limits[1] {
                    self.push_dead(member, history, vec![LoadPoint::new(patch, at, 1.0)], *force_n);
                }
            }
            ActionKind::LineForce { on, force_n_per_mm } => {
                let points = match on {
                    Region::Edge(edge) => edge_points(patch, *edge, limits),
                    Region::Line(direction, fraction) => {
                        let direction = direction.index();
                        line_points(patch, direction, parameters_of(&scene.geometry, [*fraction; 2])[direction], limits)
                    }
                    Region::Point(_) | Region::Whole => {
                        return Err(ModelError::NotALine { action: action.name.clone() });
                    }
                };
                self.push_dead(member, history, points, *force_n_per_mm);
            }
            ActionKind::AreaForce { force_n_per_mm2, per } => {
                let mut points = area_points(scene, patch, limits);
                points.iter_mut().for_each(|point| point.weight *= point.area(*per, *force_n_per_mm2));
                self.push_dead(member, history, points, *force_n_per_mm2);
            }
            ActionKind::Gravity { acceleration_m_s2 } => {
                // kg/mm² times m/s² is N/mm². A scene without density has no gravity.
                let weight = scaled(scene.material.mass_kg_per_mm2().unwrap_or(0.0), *acceleration_m_s2);
                let mut points = area_points(scene, patch, limits);
                let force = ForceVector::Components(weight);
                points.iter_mut().for_each(|point| point.weight *= point.area(LoadedArea::Undeformed, force));
                self.push_dead(member, history, points, force);
            }
            ActionKind::EdgeMoment { on, moment_n } => {
                let mut points = edge_points(patch, *on, limits);
                points.iter_mut().for_each(|point| point.weight *= moment_n);
                let running = 1 - on.side().0.index();
                let points = shifted(points, member);
                self.following.0.push(Following { history, kind: FollowerKind::Moment(running), points });
            }
            ActionKind::Pressure { pressure_mpa, follower } => {
                let mut points = area_points(scene, patch, limits);
                points.iter_mut().for_each(|point| point.weight *= pressure_mpa);
                let points = shifted(points, member);
                if *follower {
                    self.following.0.push(Following { history, kind: FollowerKind::Pressure, points });
                } else {
                    let along_normal = |point: &LoadPoint| cross(point.site.tangents[0], point.site.tangents[1]);
                    self.dead.0.push(Dead { history, forces: dead_forces(self.points, &points, along_normal) });
                }
            }
            // Loads on sections are those of the structure; the others change the shell's free strain and exert no forces of
            // their own.
            ActionKind::SectionForce { .. }
            | ActionKind::SectionMoment { .. }
            | ActionKind::Temperature { .. }
            | ActionKind::NaturalCurvature { .. } => {}
        }
        Ok(())
    }

    fn add_to_section(
        &mut self,
        scene: &Scene,
        mesh: &Mesh,
        members: &[Member],
        (action, limits): (&Action, [f64; 2]),
    ) -> Result<(), ModelError> {
        let history = action.history.clone();
        if let ActionKind::SectionForce { section, .. } | ActionKind::SectionMoment { section, .. } = &action.kind
            && !is_below(scene, section, limits)?
        {
            return Ok(());
        }
        match &action.kind {
            ActionKind::SectionForce { section, force_n } => {
                let forces = SectionPoints::of(scene, mesh, members, section)?.force(section, *force_n)?;
                self.dead.0.push(Dead { history, forces });
            }
            ActionKind::SectionMoment { section, moment_n_mm, about, forces_along, turns } => {
                let points = SectionPoints::of(scene, mesh, members, section)?;
                let axes = [*about, *forces_along];
                match turns {
                    SectionTurns::Dead => {
                        let forces = points.dead_moment(section, *moment_n_mm, axes)?;
                        self.dead.0.push(Dead { history, forces });
                    }
                    SectionTurns::Follows => {
                        let couple = points.turning_moment(section, *moment_n_mm, axes, history)?;
                        self.couples.push((action.name.clone(), couple));
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn push_dead(&mut self, member: &Member, history: History, points: Vec<LoadPoint>, force: ForceVector) {
        let points = shifted(points, member);
        let at = |point: &LoadPoint| match force {
            ForceVector::Components(components) => components,
            ForceVector::Along(size, direction) => scaled(size, direction_at(&member.scene, &point.site, direction)),
        };
        self.dead.0.push(Dead { history, forces: dead_forces(self.points, &points, at) });
    }
}

/// Points of a shell by the numbers that control points have in the structure.
fn shifted(points: Vec<LoadPoint>, member: &Member) -> Vec<LoadPoint> {
    points.into_iter().map(|point| point.shifted(member.points.start)).collect()
}
