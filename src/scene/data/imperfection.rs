//! Where the undeformed surfaces differ from the perfect ones that the scene describes.

use serde::{Deserialize, Serialize};

use super::place::is_first;

/// A geometric imperfection: the surfaces are free of stress with it. Several add up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Imperfection {
    /// What errors and remarks call it, and settings; no two imperfections have the same name.
    pub name: String,
    /// Its shape and size.
    #[serde(flatten)]
    pub kind: ImperfectionKind,
}

/// The shape of an imperfection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ImperfectionKind {
    /// Modes of linear buckling of the perfect structure under its loads at factor 1.
    Modes {
        /// Numbers of the modes, from 1.
        modes: Vec<usize>,
        /// Largest offset, in thicknesses of the thinnest shell; the sign turns a single mode round.
        amplitude: f64,
        /// Seed of the weights of several modes; `None` for a single one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        seed: Option<u64>,
    },
    /// A homogeneous Gaussian field of vectors in space, the same for all shells.
    RandomField {
        /// Seed of the field.
        seed: u64,
        /// Distance at which the correlation has fallen to 1/e, mm.
        correlation_mm: f64,
        /// Standard deviation of each component, in thicknesses of the thinnest shell.
        deviation: f64,
    },
    /// Offsets along the normal of one shell, measured on a grid.
    Grid {
        /// The shell, by its place in the list.
        #[serde(default, skip_serializing_if = "is_first")]
        shell: usize,
        /// Offsets at places of the surface.
        #[serde(flatten)]
        offsets: OffsetGrid,
        /// Factor of the offsets.
        scale: f64,
    },
}

/// Offsets at the places of a full grid of fractions of u and v.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OffsetGrid {
    /// Fractions of u, from 0 to 1, ascending.
    pub u: Vec<f64>,
    /// Fractions of v.
    pub v: Vec<f64>,
    /// Offsets along the normal, mm; v runs fastest.
    pub offsets_mm: Vec<f64>,
}
