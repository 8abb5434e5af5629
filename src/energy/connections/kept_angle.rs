//! The energy that keeps the angle between two surfaces along an edge (Herrema, Johnson, Proserpio, Wu, Kiendl & Hsu 2019, *Penalty
//! coupling of non-matching isogeometric Kirchhoff–Love shell patches*).
//!
//! E = ½ α ∫ [(Δ a₃·a₃′)² + (Δ a_n·a₃′)²] ds on the undeformed edge, with the normals a₃, a₃′ of the two surfaces, the normal a_n of
//! the edge within the first one, and Δ for the change since the undeformed state. a₃·a₃′ and a_n·a₃′ are cosine and sine of the
//! angle between the surfaces; the second one makes the angle unique. α = c D/h.

use super::coupled::{Derivatives, FIRST_TANGENT, LOCAL, Local, PointLaw, moved};
use crate::shell::{FrameVector, TANGENTS, dot};

/// The energy at a point of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptAngle {
    /// Direction (0 or 1) of the first surface that runs along the edge.
    pub running: usize,
    /// α times the weight of the point, N·mm.
    pub rotation: f64,
    /// Cosine and sine of the angle between the undeformed surfaces.
    pub angle: [f64; 2],
}

impl KeptAngle {
    /// Cosine and sine of the angle between two surfaces along an edge.
    pub fn angle_of([one, other]: &[Local; 2], running: usize) -> [f64; 2] {
        let normal = FrameVector::normal([other[1], other[2]]).value;
        let tangents = [one[1], one[2]];
        [FrameVector::normal(tangents).value, FrameVector::edge_normal(tangents, running).value]
            .map(|vector| dot(vector, normal))
    }

    /// Angle by which the surfaces have turned against each other, radians.
    pub fn opened(&self, sides: &[Local; 2]) -> f64 {
        let [[cos, sin], [c, s]] = [Self::angle_of(sides, self.running), self.angle];
        (sin * c - cos * s).atan2(cos * c + sin * s)
    }
}

impl PointLaw for KeptAngle {
    fn energy(&self, sides: &[Local; 2]) -> f64 {
        let angle = Self::angle_of(sides, self.running);
        let turned: f64 = (0..2).map(|k| (angle[k] - self.angle[k]).powi(2)).sum();
        0.5 * self.rotation * turned
    }

    fn stressed(&self, sides: &[Local; 2], rates: &[Local; 2]) -> Self {
        let (after, before, step) = moved(sides, rates);
        let [after, before] = [after, before].map(|sides| Self::angle_of(&sides, self.running));
        Self { angle: [0, 1].map(|k| self.angle[k] - (after[k] - before[k]) / step), ..*self }
    }

    fn add_derivatives(&self, sides: &[Local; 2], sums: &mut Derivatives) {
        let tangents = [sides[0][1], sides[0][2]];
        let other = FrameVector::normal([sides[1][1], sides[1][2]]);
        let vectors = [FrameVector::normal(tangents), FrameVector::edge_normal(tangents, self.running)];
        for (vector, reference) in vectors.iter().zip(self.angle) {
            add_product(sums, self.rotation, vector, &other, reference);
        }
    }
}

/// Adds the derivatives of ½ α (v·v′ − c)², where v depends on the tangents of the first surface and v′ on those of the other.
fn add_product(sums: &mut Derivatives, alpha: f64, one: &FrameVector, other: &FrameVector, reference: f64) {
    let change = dot(one.value, other.value) - reference;
    let mut slope = [0.0; 2 * TANGENTS];
    for p in 0..TANGENTS {
        slope[p] = dot(one.first[p], other.value);
        slope[TANGENTS + p] = dot(one.value, other.first[p]);
    }
    let place = |p: usize| if p < TANGENTS { FIRST_TANGENT + p } else { LOCAL + FIRST_TANGENT + p - TANGENTS };
    for p in 0..2 * TANGENTS {
        sums.gradient[place(p)] += alpha * change * slope[p];
        for q in 0..2 * TANGENTS {
            let bend = match (p.checked_sub(TANGENTS), q.checked_sub(TANGENTS)) {
                (None, None) => dot(one.second[p][q], other.value),
                (Some(p), Some(q)) => dot(one.value, other.second[p][q]),
                (None, Some(q)) => dot(one.first[p], other.first[q]),
                (Some(p), None) => dot(one.first[q], other.first[p]),
            };
            sums.hessian[place(p)][place(q)] += alpha * (slope[p] * slope[q] + change * bend);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::connections::coupled::tests::check;

    /// Two surfaces at 70 degrees along an edge, moved and turned against each other.
    fn sides() -> [Local; 2] {
        let (sin, cos) = 70_f64.to_radians().sin_cos();
        [
            [[0.02, -0.01, 0.03], [1.1, 0.1, 0.05], [0.1, 0.9, -0.1]],
            [[0.01, 0.02, -0.02], [1.05, 0.15, 0.0], [0.05, 0.9 * cos + 0.1, 0.9 * sin]],
        ]
    }

    #[test]
    fn the_energy_of_a_joint_has_these_derivatives() {
        for running in [0, 1] {
            let angle = [0.3, -0.9];
            check(&KeptAngle { running, rotation: 3.0, angle }, &sides(), 10.0);
        }
    }

    #[test]
    fn an_angle_that_opens_is_told() {
        let turned = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0; 3], [1.0, 0.0, 0.0], [0.0, cos, sin]]]
        };
        let law = KeptAngle { running: 0, rotation: 1.0, angle: KeptAngle::angle_of(&turned(2.5), 0) };
        assert_eq!(law.energy(&turned(2.5)), 0.0);
        assert!((law.opened(&turned(2.6)).abs() - 0.1).abs() < 1e-14);
        assert!((law.energy(&turned(2.6)) - (1.0 - 0.1_f64.cos())).abs() < 1e-14, "4 sin²(φ/2)/2");
    }
}
