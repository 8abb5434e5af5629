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
}
