//! The constraints of a scene's supports on the control points of a mesh: rigid sections, linear constraints, given
//! displacements.
//!
//! All constraints are between components of control points in their frames (see [`super::Unknowns`]). Holding an edge
//! needs only its own row of control points; its slope (a clamp, a plane of symmetry) also needs the row next to it.

use crate::model::ModelError;
use crate::model::body::HeldMotions;
use crate::model::elimination::Expression;
use crate::model::mirror::Mirror;
use crate::scene::History;

/// Component of a plane's normal below which a motion along that axis lies in the plane.
const KEPT: f64 = 1e-9;
/// Motions of a rigid section, as keys of a scene.
const MOTIONS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];

/// A prescribed motion as a function of the scene's parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct PrescribedMotion {
    /// Motion at factor 1, mm.
    pub(super) at_one: f64,
    pub(super) history: History,
}

impl PrescribedMotion {
    /// Motion at a value of the parameter, mm.
    pub fn at(&self, parameter: f64) -> f64 {
        self.at_one * self.history.at(parameter)
    }

    /// Derivative of the motion with respect to the parameter, mm.
    pub fn rate(&self, parameter: f64) -> f64 {
        self.at_one * self.history.rate(parameter)
    }
}

/// A rigid section that moves.
#[derive(Clone, Debug)]
pub struct Section {
    /// Point whose motion is the translation of the section, undeformed, mm.
    pub centre: [f64; 3],
    /// Largest distance of the section's control points from the centre, mm.
    pub size: f64,
    /// Prescribed translations and rotation vector (times the size), mm; `None` where free.
    pub motions: [Option<PrescribedMotion>; 6],
    /// Control points of the edge.
    pub rigid_row: Vec<usize>,
}

/// The control points that a support holds, for its reactions.
#[derive(Clone, Debug)]
pub struct Footprint {
    /// Name of the support.
    pub name: String,
    /// Control points that it holds.
    pub points: Vec<usize>,
    /// Control points of the edge in a plane of symmetry; empty for other supports.
    pub mirrored: Vec<usize>,
    /// Whether it is a plane of symmetry through a line inside the shell.
    pub is_inner_mirror: bool,
    /// Point about which moments are taken, undeformed, mm.
    pub pole: [f64; 3],
    /// Section that the pole moves with, if any.
    pub section: Option<usize>,
}

/// The constraints that the supports of a scene impose on a mesh.
#[derive(Clone, Debug)]
pub struct Supports {
    /// Rigid sections that move.
    pub sections: Vec<Section>,
    /// Section that each control point belongs to, if any.
    pub section_of: Vec<Option<usize>>,
    /// Expressions in components (3 · control point + c, or 3 · control points + k for given displacement k) that are
    /// zero.
    pub constraints: Vec<Expression>,
    /// The prescribed displacements.
    pub displacements: Vec<PrescribedMotion>,
    /// Footprints of the supports, in the order of the scene.
    pub footprints: Vec<Footprint>,
    /// Support that each constraint comes from; `None` for a joint.
    pub(super) owner: Vec<Option<usize>>,
    /// Rigid motions that a support of rigid motions alone holds, if there is one.
    pub(crate) held_motions: Option<HeldMotions>,
}

impl Supports {
    /// Makes the error for a constraint that contradicts those before it.
    pub fn contradiction(&self, constraint: usize) -> ModelError {
        let support =
            self.owner[constraint].map_or("the joints", |index| self.footprints[index].name.as_str()).to_owned();
        let points: Vec<usize> = self.constraints[constraint].iter().map(|(component, _)| component / 3).collect();
        // Neighbouring supports share a few control points with it; the contradicting one shares most.
        let shared = |footprint: &Footprint| points.iter().filter(|point| footprint.points.contains(point)).count();
        let others = self.footprints.iter().filter(|footprint| footprint.name != support && shared(footprint) > 0);
        let other = others.rev().max_by_key(|footprint| shared(footprint));
        ModelError::Contradiction { support, other: other.map(|footprint| footprint.name.clone()) }
    }

    /// Finds the support of this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.footprints.iter().position(|footprint| footprint.name == name)
    }

    pub(super) fn push(&mut self, owner: Option<usize>, expression: Expression) {
        self.constraints.push(expression);
        self.owner.push(owner);
    }

    /// Refuses a plane of symmetry that a section could leave.
    pub(super) fn check_sections_keep(&self, points: &[usize], mirror: &Mirror) -> Result<(), ModelError> {
        for section in points.iter().filter_map(|point| self.section_of[*point]) {
            let motions = self.sections[section].motions_out_of_plane(mirror.normal);
            if !motions.is_empty() {
                let held = self.footprints.iter().find(|footprint| footprint.section == Some(section));
                return Err(ModelError::SectionLeavesPlane {
                    section: held.map_or_else(String::new, |footprint| footprint.name.clone()),
                    support: mirror.support.clone(),
                    motions,
                });
            }
        }
        Ok(())
    }

    /// Constraints are between components of one frame: on a mesh of too few elements a tie may join a control point of a
    /// section that moves with one that does not move with it.
    pub(super) fn check_frames(&self) -> Result<(), ModelError> {
        for (expression, owner) in self.constraints.iter().zip(&self.owner) {
            let mut frames = expression.iter().filter_map(|(component, _)| self.section_of.get(component / 3));
            let Some(first) = frames.next() else { continue };
            let Some(other) = frames.find(|frame| *frame != first) else { continue };
            let section = self
                .footprints
                .iter()
                .find(|footprint| footprint.section.is_some() && footprint.section == first.or(*other));
            return Err(ModelError::TiedToSection {
                tie: owner
                    .map_or("a joint of the surface".into(), |index| format!("\"{}\"", self.footprints[index].name)),
                section: section.map_or_else(String::new, |footprint| footprint.name.clone()),
            });
        }
        Ok(())
    }
}

impl Section {
    /// Lists the motions that would move a plane with this normal, as keys of a scene.
    fn motions_out_of_plane(&self, normal: [f64; 3]) -> Vec<&'static str> {
        let still = |k: usize| self.motions[k].as_ref().is_some_and(|law| law.at_one == 0.0);
        let keeps = |k: usize| match k {
            0..3 => normal[k].abs() < KEPT,
            _ => normal[k - 3].abs() > 1.0 - KEPT,
        };
        (0..6).filter(|k| !still(*k) && !keeps(*k)).map(|k| MOTIONS[k]).collect()
    }
}
