//! Loads that do not depend on the displacement.

use crate::energy::loads::points::LoadPoint;
use crate::energy::{At, Term};
use crate::scene::History;
use crate::shell::{add, dot, scaled, sub};
use crate::spline::Mesh;

/// Dead loads: forces, line forces, area forces, weight and pressures that keep their direction.
#[derive(Debug, Default)]
pub(super) struct DeadLoads(pub Vec<Dead>);

/// Forces that do not depend on the displacement.
#[derive(Debug)]
pub(super) struct Dead {
    pub history: History,
    /// Control points, with their forces at factor 1, N.
    pub forces: Vec<(usize, [f64; 3])>,
}

impl DeadLoads {
    fn add(&self, factor: impl Fn(&History) -> f64, forces: &mut [[f64; 3]]) {
        for dead in &self.0 {
            let factor = factor(&dead.history);
            for (point, force) in &dead.forces {
                forces[*point] = add(forces[*point], scaled(factor, *force));
            }
        }
    }
}

impl Term for DeadLoads {
    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.add(|history| history.at(at.parameter), forces);
    }

    fn add_rates(&self, at: At, rates: &mut [[f64; 3]]) {
        self.add(|history| history.rate(at.parameter), rates);
    }

    /// Computes force times motion for each load.
    fn strokes(&self, _: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        let stroke = |dead: &Dead| {
            let motion = |(point, force): &(usize, [f64; 3])| dot(*force, sub(to[*point], from[*point]));
            dead.forces.iter().map(motion).sum()
        };
        self.0.iter().map(stroke).collect()
    }

    fn factors(&self, parameter: f64) -> Vec<f64> {
        self.0.iter().map(|dead| dead.history.at(parameter)).collect()
    }
}

/// Computes the forces on `count` control points of a load whose force per weight at a point is `force`.
pub(super) fn dead_forces(
    count: usize,
    points: &[LoadPoint],
    force: impl Fn(&LoadPoint) -> [f64; 3],
) -> Vec<(usize, [f64; 3])> {
    let mut sums = vec![[0.0; 3]; count];
    for point in points {
        let whole = scaled(point.weight, force(point));
        for (a, control) in point.controls.iter().copied().enumerate() {
            sums[control] = add(sums[control], scaled(point.functions[0][a], whole));
        }
    }
    sums.into_iter().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
}
