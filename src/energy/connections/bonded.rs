//! The energy of a bond: what of its layer is summed up where.
//!
//! At the Greville points alone ([`super::greville_rule`]) waves of two elements are missed: the slope of the one shell vanishes where
//! the displacement of the other would follow it, and the two bend as if they were not glued, a web of 30 × 9 quartic elements at 0.7 of
//! its load. At Gauss points alone the layer locks. So a part of it is summed up at Gauss points: against slip (π/h)² A, with
//! 1/A = 1/A₁ + 1/A₂ of the stiffnesses against stretching and h the length of an element, with which waves of two elements are as
//! stiff as those of shells that are truly one: ½ k t² w′² is then the energy ½ A t² w″² at the wave number π/h. Against opening
//! (π/h)⁴ D: with as much as against slip, shells whose meshes do not match would lock. Waves that are resolved fulfil the conditions
//! at these points nearly, and pay nothing for it. What of a layer is no stiffer than that is summed up at Gauss points as a whole. The
//! element's longer side counts: waves of two elements across the shorter one stay softer than they are, and still buckle later than any
//! wave that the mesh can show.
//!
//! The third load of a column of two bonded strips 2000 times as long as thick, relative to Euler's (25 times the first), stiffness
//! 0.5 and 50 E/t, with p Gauss points an element as they were, and so:
//!
//! | elements | degree | at Gauss points | so |
//! |---|---|---|---|
//! | 8 | 3 | 1.59, 20.3 | 0.994, 0.994 |
//! | 16 | 3 | 1.018, 1.64 | 0.9996, 0.9997 |
//! | 8 | 4 | 1.036, 1.43 | 0.998, 0.998 |

use super::coupled::{CoupledPoint, Coupling};
use super::glue::Glue;
use super::glued_area::GluedArea;
use super::layer::Layer;
use crate::energy::Term;

/// The energy of a bond.
#[derive(Debug)]
pub(super) struct Bonded {
    /// At the Greville points, the layer but for what is between.
    held: Coupling<Glue>,
    /// At Gauss points.
    between: Coupling<Glue>,
}

impl Bonded {
    /// Takes up the layer over an area.
    pub fn new(layer: &Layer, area: GluedArea) -> Self {
        let between = area.gauss_points(layer);
        Self { held: Coupling::new(area.into_points()), between: Coupling::new(between) }
    }

    /// Where the tractions are looked at.
    pub fn seen(&self) -> &[CoupledPoint<Glue>] {
        &self.held.points
    }

    /// The terms of which it is the sum.
    pub fn parts(&self) -> impl Iterator<Item = &dyn Term> {
        [&self.held, &self.between].into_iter().map(|part| part as &dyn Term)
    }
}
