//! The mesh that a run starts with.

use serde::{Deserialize, Serialize};

/// The spline space and quadrature that the run starts with. Pairs are (along the length, along the arc).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshSpec {
    /// Polynomial degree each way, 2 to 5.
    pub degree: [usize; 2],
    /// Elements each way **over the whole shell**, whatever the symmetry: a quarter model of an 8 × 4
    /// mesh has 4 × 2 elements.
    pub elements: [usize; 2],
    /// Integration rule.
    pub quadrature: Quadrature,
}

/// The integration rule on an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Quadrature {
    /// Gauss–Legendre with degree + 1 points each way.
    Full,
    /// Gauss–Legendre with degree + 2 points each way.
    FullPlusOne,
    /// Gauss–Legendre with degree + 3 points each way.
    FullPlusTwo,
    /// Gauss–Legendre with degree points each way; degree + 1 in a direction that has one element.
    Reduced,
    /// Gauss–Legendre with degree − 1 points (at least 2) where the spline is smooth, degree next to edges and repeated
    /// knots; degree + 1 in a direction that has one element.
    Patch,
    /// As `Patch`, with as many points more for stretching as leave constant membrane forces in balance on the mesh in hand.
    Balanced,
}

impl Quadrature {
    /// The word for the rule in scenes and logs.
    pub fn name(self) -> &'static str {
        match self {
            Quadrature::Full => "full",
            Quadrature::FullPlusOne => "full-plus-one",
            Quadrature::FullPlusTwo => "full-plus-two",
            Quadrature::Reduced => "reduced",
            Quadrature::Patch => "patch",
            Quadrature::Balanced => "balanced",
        }
    }
}
