//! Limit points and bifurcations, as reports name them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::state::State;

/// A limit point or a bifurcation that a step has passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CriticalPoint {
    /// Whether the parameter turns back: a limit point.
    pub limit_point: bool,
    /// By how many the negative pivots of the stiffness changed.
    pub pivots_changed: i64,
}

impl CriticalPoint {
    /// Returns the critical point between two points of the path, if there is one; each is given by the rate of the
    /// parameter along the path and the number of negative pivots.
    pub fn between(before: (f64, u64), after: (f64, u64)) -> Option<Self> {
        let limit_point = before.0.signum() != after.0.signum();
        let pivots_changed = after.1 as i64 - before.1 as i64;
        (limit_point || pivots_changed != 0).then_some(Self { limit_point, pivots_changed })
    }

    /// Between two equilibria at growing loads: where the shell lost stability and did not jump, it stayed on a path that others
    /// cross.
    pub(crate) fn passed_by_load(before: &State, after: &State) -> Option<Self> {
        let passed = Self::between((1.0, before.negative_pivots), (1.0, after.negative_pivots));
        passed.filter(|critical| critical.pivots_changed > 0)
    }

    /// Name of the critical point: "limit point" or "bifurcation".
    pub fn name(&self) -> &'static str {
        match (self.limit_point, self.is_bifurcation()) {
            // The parameter turns back, and stability stays as it is.
            (true, _) if self.turns_back_alone() => "turning point",
            (true, false) => "limit point",
            (true, true) => "limit point and bifurcation",
            (false, _) => "bifurcation",
        }
    }

    /// Describes the critical point in a table: its kind, and how the pivots changed.
    pub fn in_words(&self) -> String {
        let plural = if self.pivots_changed.abs() == 1 { "" } else { "s" };
        format!("{} ({:+} negative pivot{plural})", self.name(), self.pivots_changed)
    }

    /// Whether the parameter turns back while the pivots stay: no limit point, unless a bifurcation falls on it.
    pub(crate) fn turns_back_alone(&self) -> bool {
        self.limit_point && self.pivots_changed == 0
    }

    /// Whether another path crosses here.
    pub fn is_bifurcation(&self) -> bool {
        self.pivots_changed.unsigned_abs() != u64::from(self.limit_point)
    }
}
