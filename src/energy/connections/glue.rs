//! The energy of a layer of glue between the faces of two shells.

use super::coupled::{Derivatives, FIRST_TANGENT, LOCAL, Local, PointLaw, moved};
use crate::shell::{FrameVector, TANGENTS, add, basis_vector, cross, dot, norm, scaled, sub};

/// The point of an area at which two shells are glued.
///
/// ½ kₛ |r − s a₃|² + ½ kₙ s², s = r·a₃, r = x + c a₃ − (x′ + c′ a₃′) − g, with c and c′ the distances from the surfaces to the faces
/// that are glued, and g the gap between the faces of the undeformed shells, carried along as components on a₁, a₂, a₃: fixed in
/// space, a misfit would resist a rotation of the whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Glue {
    /// The stiffnesses that are summed up at the point times its area, N/mm: kₛ against slip, and kₙ against opening.
    pub stiffness: [f64; 2],
    /// k of the whole layer, N/mm³.
    pub per_area: f64,
    /// c and c′, mm.
    pub to_faces: [f64; 2],
    /// The side on which the other shell lies, as seen along the normal of the first: 1 or −1.
    pub outward: f64,
    /// Components of g on a₁, a₂ and a₃.
    pub gap: [f64; 3],
    /// The part of r that is not displacement, of the undeformed shells, mm.
    pub at_rest: [f64; 3],
}

impl Glue {
    /// The stretch r of the layer, mm.
    pub fn stretch(&self, sides: &[Local; 2]) -> [f64; 3] {
        let moved = sub(sides[0][0], sides[1][0]);
        add(moved, sub(self.across(sides), self.at_rest))
    }

    /// The part of r that is not displacement, mm.
    pub fn across(&self, [one, other]: &[Local; 2]) -> [f64; 3] {
        let normals = [one, other].map(|side| FrameVector::normal([side[1], side[2]]).value);
        let own = scaled(self.to_faces[0] - self.gap[2], normals[0]);
        let gap = add(scaled(self.gap[0], one[1]), scaled(self.gap[1], one[2]));
        sub(sub(own, gap), scaled(self.to_faces[1], normals[1]))
    }
}

/// What a layer of glue carries at a point, MPa: per undeformed area of the first shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traction {
    /// Along the normal of the first shell; positive where it pulls the faces together, as they open.
    pub peel_mpa: f64,
    /// On the first shell by the second, along the first one's deformed e₁ (along a₁) and e₂ = a₃ × e₁.
    pub shear_mpa: [f64; 2],
}

impl Traction {
    /// Its length, MPa.
    pub fn size(&self) -> f64 {
        let [one, two] = self.shear_mpa;
        norm([self.peel_mpa, one, two])
    }
}

impl Glue {
    /// The traction −k r on the first shell, split along its deformed surface and normal.
    pub fn traction(&self, sides: &[Local; 2]) -> Traction {
        let on_first = scaled(-self.per_area, self.stretch(sides));
        let [_, a1, a2] = sides[0];
        let normal = FrameVector::normal([a1, a2]).value;
        let along = scaled(1.0 / norm(a1), a1);
        Traction {
            peel_mpa: self.outward * dot(on_first, normal),
            shear_mpa: [dot(on_first, along), dot(on_first, cross(normal, along))],
        }
    }
}

impl PointLaw for Glue {
    fn energy(&self, sides: &[Local; 2]) -> f64 {
        let stretch = self.stretch(sides);
        let [slip, opening] = self.stiffness;
        let opened = dot(stretch, FrameVector::normal([sides[0][1], sides[0][2]]).value);
        0.5 * (slip * dot(stretch, stretch) + (opening - slip) * opened * opened)
    }

    fn stressed(&self, sides: &[Local; 2], rates: &[Local; 2]) -> Self {
        let (after, before, step) = moved(sides, rates);
        let rate = scaled(1.0 / step, sub(self.stretch(&after), self.stretch(&before)));
        Self { at_rest: sub(self.at_rest, rate), ..*self }
    }

    fn add_derivatives(&self, sides: &[Local; 2], sums: &mut Derivatives) {
        let stretch = self.stretch(sides);
        let normals = [0, 1].map(|k| FrameVector::normal([sides[k][1], sides[k][2]]));
        let shares = [self.to_faces[0] - self.gap[2], -self.to_faces[1]];
        let unit = |c: usize, size: f64| scaled(size, basis_vector(c));
        // ∂r by each component.
        let mut slopes = [[0.0; 3]; 2 * LOCAL];
        for (k, sign) in [(0, 1.0), (1, -1.0)] {
            for c in 0..3 {
                slopes[k * LOCAL + c] = unit(c, sign);
            }
            for p in 0..TANGENTS {
                let straight = if k == 0 { unit(p % 3, -self.gap[p / 3]) } else { [0.0; 3] };
                slopes[k * LOCAL + FIRST_TANGENT + p] = add(straight, scaled(shares[k], normals[k].first[p]));
            }
        }
        let [slip, opening] = self.stiffness;
        for p in 0..2 * LOCAL {
            sums.gradient[p] += slip * dot(stretch, slopes[p]);
            for q in 0..2 * LOCAL {
                sums.hessian[p][q] += slip * dot(slopes[p], slopes[q]);
            }
        }
        // ∂²r, of the normals of one side each, times a vector.
        let mut add_bends = |stiffness: f64, vector: [f64; 3]| {
            for k in 0..2 {
                let from = k * LOCAL + FIRST_TANGENT;
                for p in 0..TANGENTS {
                    for q in 0..TANGENTS {
                        sums.hessian[from + p][from + q] +=
                            stiffness * shares[k] * dot(vector, normals[k].second[p][q]);
                    }
                }
            }
        };
        add_bends(slip, stretch);
        if opening != slip {
            let opened = dot(stretch, normals[0].value);
            add_bends((opening - slip) * opened, normals[0].value);
            add_opening(sums, opening - slip, stretch, &slopes, &normals[0]);
        }
    }
}

/// Adds the derivatives of ½ k s², s = r·a₃, from those of r, but for the part k s a₃·∂²r.
fn add_opening(
    sums: &mut Derivatives,
    stiffness: f64,
    stretch: [f64; 3],
    slopes: &[[f64; 3]; 2 * LOCAL],
    normal: &FrameVector,
) {
    let opened = dot(stretch, normal.value);
    let turn = |p: usize| match p {
        FIRST_TANGENT..LOCAL => normal.first[p - FIRST_TANGENT],
        _ => [0.0; 3],
    };
    let rates: Vec<f64> = (0..2 * LOCAL).map(|p| dot(slopes[p], normal.value) + dot(stretch, turn(p))).collect();
    for p in 0..2 * LOCAL {
        sums.gradient[p] += stiffness * opened * rates[p];
        for q in 0..2 * LOCAL {
            let mixed = dot(slopes[p], turn(q)) + dot(slopes[q], turn(p));
            sums.hessian[p][q] += stiffness * (rates[p] * rates[q] + opened * mixed);
        }
    }
    for p in 0..TANGENTS {
        for q in 0..TANGENTS {
            sums.hessian[FIRST_TANGENT + p][FIRST_TANGENT + q] +=
                stiffness * opened * dot(stretch, normal.second[p][q]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::connections::coupled::tests::check;

    const SIDES: [Local; 2] = [
        [[0.02, -0.01, 0.03], [1.1, 0.1, 0.05], [0.1, 0.9, -0.1]],
        [[0.01, 0.02, -0.02], [1.05, 0.15, 0.0], [0.05, -1.0, 0.1]],
    ];

    fn law(stiffness: [f64; 2]) -> Glue {
        let flat = Glue {
            stiffness,
            per_area: 4.0,
            to_faces: [0.3, 0.2],
            outward: 1.0,
            gap: [0.02, -0.03, 0.05],
            at_rest: [0.0; 3],
        };
        let at_rest = [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0; 3], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]];
        Glue { at_rest: flat.across(&at_rest), ..flat }
    }

    #[test]
    fn the_energy_of_a_layer_has_these_derivatives() {
        for stiffness in [[4.0, 4.0], [4.0, 1.0], [0.0, 3.0]] {
            check(&law(stiffness), &SIDES, 10.0);
        }
    }

    /// Turned as one body about the origin, with a point 7 mm away, the layer is not stretched, whatever gap it had.
    #[test]
    fn a_rigid_motion_does_not_stretch_a_layer() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let turn = |[x, y, z]: [f64; 3]| [cos * x + sin * z, y, cos * z - sin * x];
        let rest = [
            [[7.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            [[7.02, 0.97, 0.55], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
        ];
        let flat = Glue {
            stiffness: [1.0, 0.3],
            per_area: 1.0,
            to_faces: [0.3, 0.2],
            outward: 1.0,
            gap: [0.0; 3],
            at_rest: [0.0; 3],
        };
        let undeformed = rest.map(|[_, a1, a2]: Local| [[0.0; 3], a1, a2]);
        let [x, y] = [rest[0][0], rest[1][0]];
        let gap = add(sub(x, y), flat.across(&undeformed));
        let normal = cross(rest[0][1], rest[0][2]);
        let law = Glue { gap: [gap[0], gap[1], dot(gap, normal)], ..flat };
        let law = Glue { at_rest: law.across(&undeformed), ..law };
        let moved = rest.map(|[x, a1, a2]| [sub(turn(x), x), turn(a1), turn(a2)]);
        assert!(law.energy(&moved) < 1e-30, "{:e}", law.energy(&moved));
        assert!(law.energy(&undeformed) < 1e-30);
    }
}
