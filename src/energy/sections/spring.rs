//! Springs between rigid sections and the ground: E = ½ Σ k_i u_i² + ½ Σ c_i φ_i² of the displacement u of the section's reference point
//! and the rotation vector φ of the section.

use super::frame::{Carried, POSE, SectionFrame};
use super::hung::{Derivatives, Hung, PoseLaw};
use crate::energy::At;
use crate::energy::loads::SectionPoints;
use crate::model::{Member, ModelError};
use crate::scene::{Scene, Spring};
use crate::shell::{FrameVector, TANGENTS, add, scaled};
use crate::spline::Mesh;

/// The stiffness of a spring.
#[derive(Debug)]
pub(super) struct SpringLaw {
    reference: Carried,
    /// Along x, y, z, N/mm.
    translation: [f64; 3],
    /// About x, y, z, N·mm per radian.
    rotation: [f64; 3],
}

impl Hung<SpringLaw> {
    /// Makes the term of a spring.
    ///
    /// # Errors
    /// Where its section does not determine its motion.
    pub fn of(scene: &Scene, mesh: &Mesh, members: &[Member], spring: &Spring) -> Result<Self, ModelError> {
        let section = SectionPoints::of(scene, mesh, members, &spring.section)?;
        let frame = SectionFrame::new(&section, mesh);
        let rotation = spring.rotation_n_mm_per_deg.map(|per_degree| per_degree.to_degrees());
        let translation = spring.translation_n_per_mm;
        let stands_on_line = "its edge is a line that the shell turns about, and a spring that turns with it";
        if rotation != [0.0; 3] && !frame.turns() {
            return Err(ModelError::SectionWithoutExtent { section: spring.section.clone(), what: stands_on_line });
        }
        let at = if translation == [0.0; 3] { section.mean } else { section.reference };
        let off_line = "its reference point lies off its edge, which the shell turns about, and a spring";
        let reference = frame.carried(&spring.section, at, off_line)?;
        Ok(Self { frame, law: SpringLaw { reference, translation, rotation } })
    }
}

impl SpringLaw {
    /// Displacement and rotation at a displacement of the control points.
    fn strained(&self, frame: &SectionFrame, displacement: &[[f64; 3]]) -> [FrameVector; 2] {
        let pose = frame.at(displacement);
        [pose.displacement(&self.reference, frame), frame.rotation(&pose)]
    }

    fn forces(&self, strained: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let [moved, turned] = strained;
        [[0, 1, 2].map(|c| self.translation[c] * moved[c]), [0, 1, 2].map(|c| self.rotation[c] * turned[c])]
    }
}

impl PoseLaw for SpringLaw {
    fn energy(&self, frame: &SectionFrame, at: At) -> f64 {
        let strained = self.strained(frame, at.displacement).map(|vector| vector.value);
        let pairs = self.forces(strained).into_iter().flatten().zip(strained.into_iter().flatten());
        0.5 * pairs.map(|(force, way)| force * way).sum::<f64>()
    }

    fn derivatives(&self, frame: &SectionFrame, at: At) -> Derivatives {
        let [moved, turned] = self.strained(frame, at.displacement);
        let [force, moment] = self.forces([moved.value, turned.value]);
        let mut sums = Derivatives::ZERO;
        sums.add(&moved, true, force, self.translation);
        sums.add(&turned, false, moment, self.rotation);
        sums
    }

    fn stressed(&self, frame: &SectionFrame, at: At, rates: &[[f64; 3]]) -> Derivatives {
        let [mean, p, q] = frame.rates(rates);
        let rates: Vec<f64> = p.into_iter().chain(q).collect();
        let rate_of =
            |vector: &FrameVector| (0..TANGENTS).fold([0.0; 3], |sum, k| add(sum, scaled(rates[k], vector.first[k])));
        let [moved, turned] = self.strained(frame, at.displacement);
        let [force, moment] = self.forces([add(mean, rate_of(&moved)), rate_of(&turned)]);
        let mut sums = Derivatives::ZERO;
        sums.add(&moved, true, force, [0.0; 3]);
        sums.add(&turned, false, moment, [0.0; 3]);
        sums
    }

    fn gradient_rates(&self, _: &SectionFrame, _: At) -> [f64; POSE] {
        [0.0; POSE]
    }

    fn stroke(&self, _: &SectionFrame, _: &[[f64; 3]], _: &[[f64; 3]]) -> Option<f64> {
        None
    }

    fn factor(&self, _: f64) -> Option<f64> {
        None
    }
}
