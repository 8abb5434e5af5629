//! The energy that keeps edges together whose control points are not shared.
//!
//! A penalty on the gap u − u′ at every point leaves the edges no more than the functions that both have: of splines with other knots
//! these are polynomials of the whole edge, and a ring plate whose sectors have 7, 4, 6 and 5 elements across is 0.7 % too stiff, more
//! with a higher penalty. What is kept is therefore the projection of the gap on the functions Nᵢ of the edge that has fewer, by means
//! (in the manner of Coradello, Loli & Buffa 2021, *A projected super-penalty method for the C¹-coupling of multi-patch isogeometric
//! Kirchhoff plates*):
//!
//! E = ½ Σ αᵢ |cᵢ|²,   cᵢ = ∫ Nᵢ (u − u′) ds / ∫ Nᵢ ds,   αᵢ = ∫ α Nᵢ ds.
//!
//! The force that it exerts along the edge is Σ α cᵢ Nᵢ, so that a constant one is exact.

use std::collections::BTreeMap;

use super::coupled::SurfaceSide;
use crate::energy::term::pairs_among;
use crate::energy::{At, Tangent, Term};
use crate::shell::{add, dot, scaled};

/// Share of a control point in a gap, relative to the largest, below which it has none.
const NONE: f64 = 1e-13;

/// A point of a joint at which gaps are summed up.
pub(super) struct GapPoint {
    pub sides: [SurfaceSide; 2],
    /// Length of the edge that it stands for, mm.
    pub length: f64,
    /// α, N/mm².
    pub stiffness: f64,
}

/// The mean of the gap by one function of an edge.
#[derive(Debug)]
struct MeanGap {
    /// Control points with their shares in it.
    shares: Vec<(usize, f64)>,
    /// αᵢ, N/mm.
    stiffness: f64,
}

/// The means of the gap between two edges.
#[derive(Debug)]
pub(super) struct MeanGaps(Vec<MeanGap>);

impl MeanGaps {
    /// Sums the gaps up over points; `fewer` (0 or 1) is the edge that has fewer functions there.
    pub fn new(points: &[GapPoint], fewer: usize) -> Self {
        let mut sums: BTreeMap<usize, (f64, f64, BTreeMap<usize, f64>)> = BTreeMap::new();
        for GapPoint { sides, length, stiffness } in points {
            for (function, value) in sides[fewer].values() {
                let weight = length * value;
                let (whole, alpha, shares) = sums.entry(function).or_default();
                *whole += weight;
                *alpha += stiffness * weight;
                for (side, sign) in sides.iter().zip([1.0, -1.0]) {
                    side.values().for_each(|(control, n)| *shares.entry(control).or_default() += sign * weight * n);
                }
            }
        }
        let gap = |(whole, stiffness, shares): (f64, f64, BTreeMap<usize, f64>)| {
            let shares: Vec<(usize, f64)> =
                shares.into_iter().map(|(control, share)| (control, share / whole)).collect();
            MeanGap { shares, stiffness }
        };
        Self(sums.into_values().filter(|(whole, ..)| *whole > 0.0).map(gap).collect())
    }
}

impl MeanGap {
    fn at(&self, displacement: &[[f64; 3]]) -> [f64; 3] {
        self.shares.iter().fold([0.0; 3], |sum, (control, share)| add(sum, scaled(*share, displacement[*control])))
    }
}

impl Term for MeanGaps {
    fn pairs(&self) -> Vec<[usize; 2]> {
        let of_gap = |gap: &MeanGap| pairs_among(gap.shares.iter().map(|(point, _)| *point));
        let mut pairs: Vec<[usize; 2]> = self.0.iter().flat_map(of_gap).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn energy(&self, at: At) -> f64 {
        let of_gap = |gap: &MeanGap| {
            let mean = gap.at(at.displacement);
            0.5 * gap.stiffness * dot(mean, mean)
        };
        self.0.iter().map(of_gap).sum::<f64>() + 0.0
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        for gap in &self.0 {
            let force = scaled(-gap.stiffness, gap.at(at.displacement));
            for (control, share) in &gap.shares {
                forces[*control] = add(forces[*control], scaled(*share, force));
            }
        }
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, _: At, tangent: &mut Tangent) {
        for MeanGap { shares, stiffness } in &self.0 {
            for (a, (i, of_i)) in shares.iter().enumerate() {
                for (j, of_j) in &shares[a..] {
                    let value = -stiffness * of_i * of_j;
                    let slope = [0, 1, 2].map(|c| [0, 1, 2].map(|d| if c == d { value } else { 0.0 }));
                    tangent.add_symmetric([*i, *j], slope);
                }
            }
        }
    }
}

impl SurfaceSide {
    /// Control points whose functions are not zero at the point, with their values.
    fn values(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        let values = &self.functions[0];
        self.controls.iter().copied().zip(values.iter().copied()).filter(|(_, value)| value.abs() > NONE)
    }
}
