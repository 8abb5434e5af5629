//! The work of a scene's actions as the shell moves, action by action.
//!
//! The stroke of an action is the work that it would do with its factor held at 1: along a straight motion of the control
//! points from one displacement to another,
//!
//! | action | stroke |
//! |---|---|
//! | force, line force, dead pressure | force times motion |
//! | follower pressure p | p times the volume that the surface sweeps: ∫ (a₁ × a₂)·Δx, quadratic on the way, so Simpson's rule is exact |
//! | edge moment m | m times the angle by which the normal turns about the tangent of the edge |
//!
//! Strokes add up along a path of many straight pieces, so that a pressure's is the volume between the ends and an
//! angle is unwrapped: where an edge stays straight or plane, a moment's is m Δφ however far it turns. Where it does
//! not, or where the edges of the pressed surface are free, the load has no potential, and the strokes are integrals
//! along the very path that they were summed on.

use crate::energy::loads::following::FollowerKind;
use crate::energy::loads::points::LoadPoint;
use crate::shell::{add, cross, dot, norm, scaled, sub};

/// Length of a sum of two unit tangents below which its direction is rounding.
const TURNED_ROUND: f64 = 1e-9;

impl FollowerKind {
    /// Computes the stroke of the load at a point of weight 1, N·mm.
    pub fn stroke(self, point: &LoadPoint, from: &[[f64; 3]], to: &[[f64; 3]]) -> f64 {
        let ends = [from, to].map(|displacement| point.deformed(displacement));
        let normals = ends.map(|[a1, a2]| cross(a1, a2));
        match self {
            FollowerKind::Pressure => {
                let middle = [0, 1].map(|k| scaled(0.5, add(ends[0][k], ends[1][k])));
                let mean = add(add(normals[0], normals[1]), scaled(4.0, cross(middle[0], middle[1])));
                dot(scaled(1.0 / 6.0, mean), point.motion(from, to))
            }
            FollowerKind::Moment(running) => {
                let unit = |vector: [f64; 3]| scaled(1.0 / norm(vector), vector);
                let [tangent, after] = ends.map(|tangents| unit(tangents[running]));
                let sum = add(tangent, after);
                // Where the tangent reverses there is no mean: the half turn of the normal about the tangent before
                // counts.
                let axis = if norm(sum) > TURNED_ROUND { unit(sum) } else { tangent };
                let [before, after] = normals.map(|normal| sub(normal, scaled(dot(normal, axis), axis)));
                dot(cross(before, after), axis).atan2(dot(before, after))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::sync::Arc;

    use super::*;
    use crate::energy::{At, Discretization};
    use crate::model::starting_mesh;
    use crate::scene::{Action, ActionKind, History, parse};

    /// A plate of 12 × 1 mm with a moment of 52.36 N·mm per mm on the end of its length, and one more action.
    fn plate(kind: ActionKind) -> Discretization {
        let mut scene =
            parse(include_str!("../../../pipelines/verification/rolled-cantilever.toml"), "x.toml").unwrap();
        scene.actions.push(Action { name: "more".into(), kind, shell: None, history: History::default() });
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        Discretization::new(&scene, &mesh).unwrap()
    }

    /// The plate turned about y by an angle, as a displacement of its control points.
    fn turned(plate: &Discretization, angle: f64) -> Vec<[f64; 3]> {
        let (sin, cos) = angle.sin_cos();
        plate.mesh.points().map(|[x, _, z]| [(cos - 1.0) * x + sin * z, 0.0, (cos - 1.0) * z - sin * x]).collect()
    }

    fn field(plate: &Discretization, size: f64, seed: usize) -> Vec<[f64; 3]> {
        let value = |i: usize, c: usize| size * (((i * 7919 + c * 104_729 + seed * 31) % 1013) as f64 / 1013.0 - 0.5);
        (0..plate.mesh.point_count()).map(|i| [0, 1, 2].map(|c| value(i, c))).collect()
    }

    #[test]
    fn a_small_stroke_is_force_times_motion() {
        for kind in [
            ActionKind::Pressure { pressure_mpa: 0.7, follower: true },
            ActionKind::Pressure { pressure_mpa: 0.7, follower: false },
            ActionKind::Force { on: [0.3, 0.6], force_n: [1.0, -2.0, 0.5].into() },
        ] {
            let plate = plate(kind);
            let Discretization { mesh, terms: loads, .. } = &plate;
            let (from, motion) = (field(&plate, 0.02, 1), field(&plate, 1e-6, 2));
            let to: Vec<[f64; 3]> = from.iter().zip(&motion).map(|(u, v)| add(*u, *v)).collect();
            let middle: Vec<[f64; 3]> = from.iter().zip(&motion).map(|(u, v)| add(*u, scaled(0.5, *v))).collect();
            let forces = loads.forces(At { mesh, displacement: &middle, parameter: 0.8 });
            let expected: f64 = forces.iter().zip(&motion).map(|(f, v)| dot(*f, *v)).sum();
            let found = loads.work(&loads.strokes(mesh, &from, &to), 0.8);
            assert!((found - expected).abs() < 1e-7 * expected.abs(), "{found} {expected}");
        }
    }

    /// Three turns in steps of 100°, there and back: m Δφ either way, and nothing in all.
    #[test]
    fn a_moment_does_work_by_its_angle_however_far_it_turns() {
        let plate = plate(ActionKind::Force { on: [0.0, 0.0], force_n: [0.0; 3].into() });
        let Discretization { mesh, terms: loads, .. } = &plate;
        let step = 5.0 * PI / 9.0;
        let sweep = |angles: &[f64]| -> f64 {
            let pieces = angles.windows(2);
            let work = |ends: &[f64]| {
                loads.work(&loads.strokes(mesh, &turned(&plate, ends[0]), &turned(&plate, ends[1])), 1.0)
            };
            pieces.map(work).sum()
        };
        let angles: Vec<f64> = (0..=11).map(|k| k as f64 * step).collect();
        let there = sweep(&angles);
        let expected = 50.0 * PI / 3.0 * 11.0 * step;
        assert!((there.abs() - expected).abs() < 1e-9 * expected, "{there} {expected}");
        let back: Vec<f64> = angles.iter().rev().copied().collect();
        assert!((sweep(&back) + there).abs() < 1e-9 * expected);
    }

    /// A half turn about the normal takes the edge's tangent round: its stroke is a number, and nothing for a normal that stays.
    #[test]
    fn a_moment_whose_edge_turns_round_does_finite_work() {
        let plate = plate(ActionKind::Force { on: [0.0, 0.0], force_n: [0.0; 3].into() });
        let Discretization { mesh, terms: loads, .. } = &plate;
        let still = vec![[0.0; 3]; mesh.point_count()];
        let about_z: Vec<[f64; 3]> = mesh.points().map(|[x, y, _]| [-2.0 * x, -2.0 * y, 0.0]).collect();
        let about_x: Vec<[f64; 3]> = mesh.points().map(|[_, y, z]| [0.0, -2.0 * y, -2.0 * z]).collect();
        let work = |to: &[[f64; 3]]| loads.work(&loads.strokes(mesh, &still, to), 1.0);
        assert!(work(&about_z).abs() < 1e-9, "{}", work(&about_z));
        assert!(work(&about_x).is_finite());
    }

    /// Between two shapes with the same edges a pressure sweeps one volume, on any path.
    #[test]
    fn a_pressure_does_work_by_the_volume_between() {
        let plate = plate(ActionKind::Pressure { pressure_mpa: 0.7, follower: true });
        let Discretization { mesh, terms: loads, .. } = &plate;
        let grid = mesh.lone().grid();
        let held = |size: f64, seed: usize| -> Vec<[f64; 3]> {
            let mut field = field(&plate, size, seed);
            let edge =
                |i: usize| (0..2).any(|direction| [0, grid.counts[direction] - 1].contains(&grid.place(i)[direction]));
            field.iter_mut().enumerate().filter(|(i, _)| edge(*i)).for_each(|(_, u)| *u = [0.0; 3]);
            field
        };
        let pressure = |from: &[[f64; 3]], to: &[[f64; 3]]| *loads.strokes(mesh, from, to).last().unwrap();
        let (a, b, c) = (held(0.0, 0), held(0.4, 1), held(0.4, 2));
        let (direct, round) = (pressure(&a, &c), pressure(&a, &b) + pressure(&b, &c));
        assert!((direct - round).abs() < 1e-12 * (direct.abs() + round.abs()) + 1e-14, "{direct} {round}");
        assert!(direct.abs() > 1e-3);
    }
}
