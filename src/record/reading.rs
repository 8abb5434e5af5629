//! What reports give by name: probes, joints and bonds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The value of a probe of the scene at an equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reading {
    /// Name of the probe.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Where it is, as parameters (u, v) in [0, 1], for a largest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 2]>,
}

/// A joint or a bond at an equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConnectionReading {
    /// Its name in the scene.
    pub name: String,
    /// Its share of the energy that the structure stores.
    pub energy_share: f64,
    /// Of a joint that keeps an angle, the largest angle by which it has opened, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opened_deg: Option<f64>,
    /// Of a bond, the largest traction that opens it, MPa; below 0 where it is pressed together everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peel: Option<LargestTraction>,
    /// Of a bond, the largest shear traction, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear: Option<LargestTraction>,
}

/// The largest traction of a kind in a bond.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LargestTraction {
    /// Its size, MPa: per undeformed area.
    pub mpa: f64,
    /// Where it is, as parameters (u, v) in [0, 1] of the bond's first shell.
    pub at: [f64; 2],
}
