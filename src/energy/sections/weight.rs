//! The weight of a point mass on a rigid section: a dead force at a point that moves with it, which may lie off the shell.

use super::frame::{Carried, POSE, SectionFrame};
use super::hung::{Derivatives, Hung, PoseLaw};
use crate::energy::At;
use crate::energy::loads::SectionPoints;
use crate::model::{Member, ModelError};
use crate::scene::{History, PointMass, Scene};
use crate::shell::{dot, scaled, sub};
use crate::spline::Mesh;

/// The weight of a point mass.
#[derive(Debug)]
pub(super) struct Weight {
    carried: Carried,
    /// At factor 1, N.
    force: [f64; 3],
    history: History,
}

impl Hung<Weight> {
    /// Makes the term of a mass under an acceleration, m/s².
    ///
    /// # Errors
    /// Where its section does not determine its motion.
    pub fn of(
        scene: &Scene,
        mesh: &Mesh,
        members: &[Member],
        (mass, acceleration, history): (&PointMass, [f64; 3], &History),
    ) -> Result<Self, ModelError> {
        let section = SectionPoints::of(scene, mesh, members, &mass.section)?;
        let frame = SectionFrame::new(&section, mesh);
        let off_line = "a mass lies off its edge, which the shell turns about, and its weight";
        let carried = frame.carried(&mass.section, mass.at_mm.unwrap_or(section.reference), off_line)?;
        // kg times m/s² is N.
        let force = scaled(mass.mass_kg, acceleration);
        Ok(Self { frame, law: Weight { carried, force, history: history.clone() } })
    }
}

impl Weight {
    fn scaled_derivatives(&self, frame: &SectionFrame, at: At, factor: f64) -> Derivatives {
        let moved = frame.at(at.displacement).displacement(&self.carried, frame);
        let mut sums = Derivatives::ZERO;
        sums.add(&moved, true, scaled(-factor, self.force), [0.0; 3]);
        sums
    }
}

impl PoseLaw for Weight {
    fn energy(&self, _: &SectionFrame, _: At) -> f64 {
        0.0
    }

    fn derivatives(&self, frame: &SectionFrame, at: At) -> Derivatives {
        self.scaled_derivatives(frame, at, self.history.at(at.parameter))
    }

    /// The load grows; what its motion changes is of second order.
    fn stressed(&self, frame: &SectionFrame, at: At, _: &[[f64; 3]]) -> Derivatives {
        self.scaled_derivatives(frame, at, self.history.rate(at.parameter))
    }

    fn gradient_rates(&self, frame: &SectionFrame, at: At) -> [f64; POSE] {
        self.scaled_derivatives(frame, at, self.history.rate(at.parameter)).gradient
    }

    fn stroke(&self, frame: &SectionFrame, from: &[[f64; 3]], to: &[[f64; 3]]) -> Option<f64> {
        let place = |displacement: &[[f64; 3]]| frame.at(displacement).displacement(&self.carried, frame).value;
        Some(dot(self.force, sub(place(to), place(from))))
    }

    fn factor(&self, parameter: f64) -> Option<f64> {
        Some(self.history.at(parameter))
    }
}
