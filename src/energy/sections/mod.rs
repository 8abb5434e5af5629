//! What hangs on rigid sections: springs, and the weight of point masses.
//!
//! | file | what |
//! |---|---|
//! | `frame` | position and rotation of a section as functions of its control points, with two derivatives |
//! | `hung` | an energy of these, as a term |
//! | `spring` | springs |
//! | `weight` | the weight of point masses |

mod frame;
mod hung;
mod spring;
mod weight;

use self::hung::Hung;
use self::spring::SpringLaw;
use self::weight::Weight;
use crate::energy::loads::is_below;
use crate::energy::{At, Terms};
use crate::model::{ModelError, members};
use crate::scene::{ActionKind, Scene};
use crate::spline::Mesh;

/// What the term of a spring is called: an action may have the spring's own name.
fn spring_term(spring: &str) -> String {
    format!("spring \"{spring}\"")
}

impl Terms {
    /// Forces of a spring on the control points, N.
    pub fn forces_of_spring(&self, spring: &str, at: At) -> Vec<[f64; 3]> {
        self.forces_of(&spring_term(spring), at).unwrap_or_default()
    }

    /// Adds the springs of a scene, and the weights of its point masses where there is gravity, on sections where both parameters
    /// are below `limits`.
    ///
    /// # Errors
    /// Where a section does not determine what moves them, or lies on both sides of a limit.
    pub(super) fn hang_on_sections(&mut self, scene: &Scene, mesh: &Mesh, limits: [f64; 2]) -> Result<(), ModelError> {
        if scene.springs.is_empty() && scene.masses.is_empty() {
            return Ok(());
        }
        let members = members(scene, mesh);
        for spring in &scene.springs {
            if !is_below(scene, &spring.section, limits)? {
                continue;
            }
            self.push(&spring_term(&spring.name), Box::new(Hung::<SpringLaw>::of(scene, mesh, &members, spring)?));
        }
        for mass in &scene.masses {
            if !is_below(scene, &mass.section, limits)? {
                continue;
            }
            for action in &scene.actions {
                if let ActionKind::Gravity { acceleration_m_s2 } = action.kind {
                    let weight = Hung::<Weight>::of(scene, mesh, &members, (mass, acceleration_m_s2, &action.history))?;
                    self.push(&format!("mass \"{}\"", mass.name), Box::new(weight));
                }
            }
        }
        Ok(())
    }
}
