//! Loads that turn with the shell: their forces, and the tangent of these forces.
//!
//! The virtual work of a load at a point of the surface is Σ_a δu_a · (N_a h₀ + N_a,₁ h₁ + N_a,₂ h₂), where h depends on
//! the deformed tangents a₁, a₂ alone:
//!
//! | action | h |
//! |---|---|
//! | follower pressure p | h₀ = p a₁ × a₂ |
//! | edge moment m about the tangent τ of the edge | −m α₁ w/J² on δa₁ and m α₂ w/J² on δa₂, w = a₁ × a₂, J = abs(w) |
//!
//! For the moment, δW = m τ·δω with δω × n = δn, so that δW = m (τ × n)·δn = m (τ × n)·δw/J; with ν = τ × n this is
//! m [δa₁·(a₂ × ν) + δa₂·(ν × a₁)]/J = m [−(a₂·τ) n·δa₁ + (a₁·τ) n·δa₂]/J, hence α₁ = a₂·τ and α₂ = a₁·τ. It acts on the
//! undeformed length of the edge and turns with the shell.
//!
//! Loads that follow the shell have a tangent whose symmetric part goes into the stiffness. Its skew part is zero on the
//! free unknowns where the load has a potential there (pressure on a shell whose edges are held, for instance) and is
//! otherwise solved for as it is ([`crate::equilibrium`]).

use crate::energy::loads::points::LoadPoint;
use crate::energy::{At, Tangent, Term};
use crate::scene::History;
use crate::shell::{add, cross, dot, norm, scaled};
use crate::spline::Mesh;

/// Loads that follow the shell.
#[derive(Debug, Default)]
pub(super) struct FollowingLoads(pub Vec<Following>);

/// Forces that turn with the shell.
#[derive(Debug)]
pub(super) struct Following {
    pub history: History,
    pub kind: FollowerKind,
    pub points: Vec<LoadPoint>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum FollowerKind {
    /// A pressure along a₁ × a₂.
    Pressure,
    /// A moment about a₁ or a₂ (0 or 1).
    Moment(usize),
}

impl FollowingLoads {
    fn add(&self, at: At, factor: impl Fn(&History) -> f64, forces: &mut [[f64; 3]]) {
        for following in &self.0 {
            let factor = factor(&following.history);
            for point in &following.points {
                let (h, _) = following.kind.work(point.deformed(at.displacement));
                for (a, control) in point.controls.iter().copied().enumerate() {
                    for k in 0..3 {
                        let share = factor * point.weight * point.functions[k][a];
                        forces[control] = add(forces[control], scaled(share, h[k]));
                    }
                }
            }
        }
    }
}

impl Term for FollowingLoads {
    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        self.add(at, |history| history.at(at.parameter), forces);
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn has_skew(&self) -> bool {
        true
    }

    fn add_tangent(&self, at: At, tangent: &mut Tangent) {
        self.add_slopes(at, |history| history.at(at.parameter), tangent);
    }

    /// The loads grow; what their motion changes is of second order.
    fn add_stress_stiffness(&self, at: At, _: &[[f64; 3]], tangent: &mut Tangent) {
        self.add_slopes(at, |history| history.rate(at.parameter), tangent);
    }

    fn add_rates(&self, at: At, rates: &mut [[f64; 3]]) {
        self.add(at, |history| history.rate(at.parameter), rates);
    }

    fn strokes(&self, _: &Mesh, from: &[[f64; 3]], to: &[[f64; 3]]) -> Vec<f64> {
        let stroke = |following: &Following| {
            let at_point = |point: &LoadPoint| point.weight * following.kind.stroke(point, from, to);
            following.points.iter().map(at_point).sum()
        };
        self.0.iter().map(stroke).collect()
    }

    fn factors(&self, parameter: f64) -> Vec<f64> {
        self.0.iter().map(|following| following.history.at(parameter)).collect()
    }
}

impl FollowingLoads {
    fn add_slopes(&self, at: At, factor: impl Fn(&History) -> f64, tangent: &mut Tangent) {
        for following in &self.0 {
            let factor = factor(&following.history);
            for points in following.points.chunk_by(|one, other| one.controls[0] == other.controls[0]) {
                let Some(first) = points.first() else { continue };
                let controls = &first.controls;
                let mut element = ElementTangent::new(controls.len());
                for point in points {
                    let (_, slopes) = following.kind.work(point.deformed(at.displacement));
                    element.add(factor, point, &slopes);
                }
                for (a, i) in controls.iter().enumerate() {
                    for (b, j) in controls.iter().enumerate() {
                        tangent.add([*i, *j], element.block(a, b));
                    }
                }
            }
        }
    }
}

/// Tangent ∂f_a/∂u_b of one element: `numbers[((b · 3 + c) · 3 + d) · functions + a]`, c of the force and d of the motion.
struct ElementTangent {
    functions: usize,
    numbers: Vec<f64>,
}

impl ElementTangent {
    fn new(functions: usize) -> Self {
        Self { functions, numbers: vec![0.0; 9 * functions * functions] }
    }

    /// Adds Σ_k N_k(a) [Σ_l N_l(b) ∂h_k/∂a_l] of a point.
    fn add(&mut self, factor: f64, point: &LoadPoint, slopes: &WorkSlopes) {
        for b in 0..self.functions {
            for (k, slopes) in slopes.iter().enumerate() {
                for cd in 0..9 {
                    let [c, d] = [cd / 3, cd % 3];
                    let slope = point.functions[1][b] * slopes[0][c][d] + point.functions[2][b] * slopes[1][c][d];
                    if slope == 0.0 {
                        continue;
                    }
                    let share = factor * point.weight * slope;
                    let to = &mut self.numbers[(b * 9 + cd) * self.functions..][..self.functions];
                    for (to, function) in to.iter_mut().zip(&point.functions[k]) {
                        *to += share * function;
                    }
                }
            }
        }
    }

    fn block(&self, a: usize, b: usize) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|c| [0, 1, 2].map(|d| self.numbers[(b * 9 + 3 * c + d) * self.functions + a]))
    }
}

/// The vectors h₀, h₁, h₂ of a load.
type Work = [[f64; 3]; 3];
/// Derivatives ∂h_k/∂a_l: `[k][l][component of h][component of a]`.
type WorkSlopes = [[[[f64; 3]; 3]; 2]; 3];

impl FollowerKind {
    /// Computes the vectors that multiply N, N,₁ and N,₂ at factor and weight 1, and their derivatives.
    fn work(self, [a1, a2]: [[f64; 3]; 2]) -> (Work, WorkSlopes) {
        let mut h = [[0.0; 3]; 3];
        let mut slopes = [[[[0.0; 3]; 3]; 2]; 3];
        let w = cross(a1, a2);
        let unit = |c: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == c)));
        match self {
            FollowerKind::Pressure => {
                h[0] = w;
                for e in 0..3 {
                    let columns = [cross(unit(e), a2), cross(a1, unit(e))];
                    for l in 0..2 {
                        (0..3).for_each(|c| slopes[0][l][c][e] = columns[l][c]);
                    }
                }
            }
            FollowerKind::Moment(running) => {
                let along = [a1, a2][running];
                let length = norm(along);
                let tangent = scaled(1.0 / length, along);
                let square = dot(w, w);
                let quotient = scaled(1.0 / square, w);
                let alpha = [-dot(a2, tangent), dot(a1, tangent)];
                h[1] = scaled(alpha[0], quotient);
                h[2] = scaled(alpha[1], quotient);
                for l in 0..2 {
                    for e in 0..3 {
                        let dw = if l == 0 { cross(unit(e), a2) } else { cross(a1, unit(e)) };
                        let dq = add(scaled(1.0 / square, dw), scaled(-2.0 * dot(w, dw) / square, quotient));
                        let flat = add(unit(e), scaled(-tangent[e], tangent));
                        let dt = if l == running { scaled(1.0 / length, flat) } else { [0.0; 3] };
                        let own = |which: usize| if which == l { tangent[e] } else { 0.0 };
                        let dalpha = [-(own(1) + dot(a2, dt)), own(0) + dot(a1, dt)];
                        for k in 0..2 {
                            let column = add(scaled(dalpha[k], quotient), scaled(alpha[k], dq));
                            (0..3).for_each(|c| slopes[1 + k][l][c][e] = column[c]);
                        }
                    }
                }
            }
        }
        (h, slopes)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::energy::Discretization;
    use crate::model::{Blocks, starting_mesh};
    use crate::scene::{Action, ActionKind, Edge, Region, parse};

    /// A panel with a follower pressure and an edge moment, displaced at random.
    fn loaded(clamped: bool) -> (Discretization, Vec<[f64; 3]>) {
        let mut scene =
            parse(include_str!("../../../pipelines/verification/rolled-cantilever.toml"), "x.toml").unwrap();
        scene.geometry = crate::scene::Geometry::CylinderPanel {
            length_mm: 9.0,
            radius_mm: 5.0,
            arc_deg: 80.0,
            from_deg: None,
            seam: None,
        };
        scene.mesh.elements = [3, 2];
        let kind = ActionKind::Pressure { pressure_mpa: 0.7, follower: true };
        let pressure = Action { name: "p".into(), kind, shell: None, history: History::default() };
        if clamped {
            scene.geometry = crate::scene::Geometry::Plate { length_mm: 9.0, width_mm: 7.0 };
            scene.actions.clear();
            let hinged = |edge: Edge| crate::scene::Support {
                name: format!("{edge:?}"),
                on: Region::Edge(edge),
                shell: 0,
                also: Vec::new(),
                hold: crate::scene::Hold::Displacement { displacement_mm: [Some(0.0); 3] },
                history: History::default(),
            };
            scene.supports = [Edge::UStart, Edge::UEnd, Edge::VStart, Edge::VEnd].map(hinged).to_vec();
        }
        scene.actions.push(pressure);
        let mesh = Arc::new(starting_mesh(&scene).unwrap());
        let discretization = Discretization::new(&scene, &mesh).unwrap();
        let free: Vec<f64> =
            (0..discretization.unknowns.count()).map(|i| 0.3 * ((i * 37 % 19) as f64 / 19.0 - 0.5)).collect();
        let displacement = discretization.unknowns.configure(&free, 1.0).displacement();
        (discretization, displacement)
    }

    /// ∂f/∂u times a field.
    fn slope(discretization: &Discretization, displacement: &[[f64; 3]], field: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let Discretization { mesh, blocks, terms, .. } = discretization;
        let mut stiffness = Blocks::zeros(blocks);
        let skew = terms.add_tangent(At { mesh, displacement, parameter: 0.8 }, blocks, &mut stiffness);
        let (one, other) = (stiffness.multiply(blocks, 1.0, field), skew.multiply(blocks, -1.0, field));
        one.iter().zip(other).map(|(a, b)| scaled(-1.0, add(*a, b))).collect()
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_forces() {
        let (discretization, displacement) = loaded(false);
        let mesh = &discretization.mesh;
        let direction: Vec<[f64; 3]> =
            (0..displacement.len()).map(|i| [0, 1, 2].map(|c| ((i * 31 + c * 17) % 23) as f64 / 23.0 - 0.5)).collect();
        let exact = slope(&discretization, &displacement, &direction);
        let step = 1e-6;
        let moved = |sign: f64| -> Vec<[f64; 3]> {
            let at: Vec<[f64; 3]> =
                displacement.iter().zip(&direction).map(|(u, d)| add(*u, scaled(sign * step, *d))).collect();
            discretization.terms.forces(At { mesh, displacement: &at, parameter: 0.8 })
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let scale = exact.iter().map(|force| norm(*force)).fold(0.0, f64::max);
        for (k, slope) in exact.iter().enumerate() {
            let found = [0, 1, 2].map(|c| (plus[k][c] - minus[k][c]) / (2.0 * step));
            assert!(norm([0, 1, 2].map(|c| found[c] - slope[c])) < 1e-6 * scale, "{k}: {found:?} {slope:?}");
        }
    }

    /// With all edges held, the pressure has a potential: its tangent on the free unknowns is symmetric. With free edges
    /// it is not.
    #[test]
    fn the_skew_part_is_that_of_free_edges() {
        let skew = |clamped: bool| {
            let (discretization, displacement) = loaded(clamped);
            let count = discretization.unknowns.count();
            let free = discretization.unknowns.of_displacement(&displacement, &[], 1.0);
            let placement = discretization.unknowns.configure(&free, 1.0);
            let field = |seed: usize| {
                let q: Vec<f64> = (0..count).map(|i| ((i * 7919 + seed) % 1013) as f64 / 1013.0 - 0.5).collect();
                placement.velocity(&q, &[])
            };
            let (a, b) = (field(3), field(11));
            let product =
                |one: &[[f64; 3]], other: Vec<[f64; 3]>| one.iter().zip(other).map(|(x, y)| dot(*x, y)).sum::<f64>();
            let ab = product(&a, slope(&discretization, &displacement, &b));
            let ba = product(&b, slope(&discretization, &displacement, &a));
            (ab - ba).abs() / (ab.abs() + ba.abs())
        };
        assert!(skew(true) < 1e-10, "{}", skew(true));
        assert!(skew(false) > 1e-3, "{}", skew(false));
    }
}
