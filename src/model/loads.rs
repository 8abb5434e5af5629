//! Forces on the control points from a scene's actions, and how they change with the displacement.
//!
//! The virtual work of a load at a point of the surface is Σ_a δu_a · (N_a h₀ + N_a,₁ h₁ + N_a,₂ h₂), where h depends on
//! the deformed tangents a₁, a₂ alone:
//!
//! | action | h |
//! |---|---|
//! | force, line force, area force, weight, dead pressure | h₀ constant |
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

use crate::model::ModelError;
use crate::model::direction::{Site, direction_at};
use crate::model::place::parameters_of;
use crate::model::quadrature::PointCounts;
use crate::scene::{Action, ActionKind, Edge, ForceVector, History, LoadedArea, Place, Scene};
use crate::shell::{add, cross, dot, gauss_legendre, norm, scaled};
use crate::spline::{Mesh, Spans, evaluate_surface, mid_surface_point};

/// No limit to the part of the surface.
const EVERYWHERE: [f64; 2] = [f64::INFINITY; 2];

/// The actions of a scene on a mesh.
#[derive(Debug, Default)]
pub struct Loads {
    pub(super) dead: Vec<Dead>,
    pub(super) following: Vec<Following>,
}

/// Forces that do not depend on the displacement.
#[derive(Debug)]
pub(super) struct Dead {
    pub history: History,
    /// (control point, force at factor 1).
    pub forces: Vec<(usize, [f64; 3])>,
}

/// Forces that turn with the shell.
#[derive(Debug)]
pub(super) struct Following {
    pub history: History,
    pub kind: Kind,
    pub points: Vec<LoadPoint>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// Along a₁ × a₂.
    Pressure,
    /// About a₁ or a₂ (0 or 1).
    Moment(usize),
}

/// A quadrature point of a load.
#[derive(Debug)]
pub(super) struct LoadPoint {
    /// First control indices each way.
    first: [usize; 2],
    /// Values, derivatives ,1 and ,2 of the functions.
    pub functions: [Vec<f64>; 3],
    /// Where it is.
    site: Site,
    /// Load times quadrature weight at factor 1.
    pub weight: f64,
}

/// A block of a tangent: between functions a and b of an element.
pub struct LoadBlock {
    /// Control points of the two functions.
    pub points: [usize; 2],
    /// ∂f_a/∂u_b.
    pub block: [[f64; 3]; 3],
}

impl Loads {
    /// The actions of a scene on a mesh.
    ///
    /// # Errors
    /// Where an action does not fit the surface.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self, ModelError> {
        Self::below(scene, mesh, EVERYWHERE)
    }

    /// Those on the part of the surface where both parameters are below `limits`.
    ///
    /// # Errors
    /// Where an action does not fit the surface.
    pub fn below(scene: &Scene, mesh: &Mesh, limits: [f64; 2]) -> Result<Self, ModelError> {
        let mut loads = Self::default();
        for action in &scene.actions {
            loads.add(scene, mesh, action, limits)?;
        }
        Ok(loads)
    }

    /// Whether nothing acts.
    pub fn is_empty(&self) -> bool {
        self.dead.is_empty() && self.following.is_empty()
    }

    /// Whether a load turns with the shell.
    pub fn follow(&self) -> bool {
        !self.following.is_empty()
    }

    fn add(&mut self, scene: &Scene, mesh: &Mesh, action: &Action, limits: [f64; 2]) -> Result<(), ModelError> {
        let history = action.history.clone();
        match &action.kind {
            ActionKind::Force { on, force_n } => {
                let at = parameters_of(&scene.geometry, *on);
                if at[0] < limits[0] && at[1] < limits[1] {
                    self.push_dead(scene, mesh, history, &[LoadPoint::new(mesh, at, 1.0)], *force_n);
                }
            }
            ActionKind::LineForce { on, force_n_per_mm } => {
                let points = match on {
                    Place::Edge(edge) => edge_points(mesh, *edge, limits),
                    Place::Line(direction, fraction) => {
                        let way = direction.index();
                        line_points(mesh, way, parameters_of(&scene.geometry, [*fraction; 2])[way], limits)
                    }
                    Place::Point(_) | Place::Whole => {
                        return Err(ModelError::NotALine { action: action.name.clone() });
                    }
                };
                self.push_dead(scene, mesh, history, &points, *force_n_per_mm);
            }
            ActionKind::AreaForce { force_n_per_mm2, per } => {
                let mut points = area_points(scene, mesh, limits);
                points.iter_mut().for_each(|point| point.weight *= point.area(*per, *force_n_per_mm2));
                self.push_dead(scene, mesh, history, &points, *force_n_per_mm2);
            }
            ActionKind::Gravity { acceleration_m_s2 } => {
                // kg/mm² times m/s² is N/mm². A scene without density has no gravity.
                let weight = scaled(scene.material.mass_kg_per_mm2().unwrap_or(0.0), *acceleration_m_s2);
                let mut points = area_points(scene, mesh, limits);
                let force = ForceVector::Components(weight);
                points.iter_mut().for_each(|point| point.weight *= point.area(LoadedArea::Undeformed, force));
                self.push_dead(scene, mesh, history, &points, force);
            }
            ActionKind::EdgeMoment { on, moment_n } => {
                let mut points = edge_points(mesh, *on, limits);
                points.iter_mut().for_each(|point| point.weight *= moment_n);
                let running = 1 - on.side().0.index();
                self.following.push(Following { history, kind: Kind::Moment(running), points });
            }
            ActionKind::Pressure { pressure_mpa, follower } => {
                let mut points = area_points(scene, mesh, limits);
                points.iter_mut().for_each(|point| point.weight *= pressure_mpa);
                if *follower {
                    self.following.push(Following { history, kind: Kind::Pressure, points });
                } else {
                    let along_normal = |point: &LoadPoint| cross(point.site.tangents[0], point.site.tangents[1]);
                    self.dead.push(Dead { history, forces: dead_forces(mesh, &points, along_normal) });
                }
            }
            // These change the shell's free strain.
            ActionKind::Temperature { .. } | ActionKind::NaturalCurvature { .. } => {}
        }
        Ok(())
    }

    fn push_dead(&mut self, scene: &Scene, mesh: &Mesh, history: History, points: &[LoadPoint], force: ForceVector) {
        let at = |point: &LoadPoint| match force {
            ForceVector::Components(components) => components,
            ForceVector::Along(size, direction) => scaled(size, direction_at(&scene.geometry, &point.site, direction)),
        };
        self.dead.push(Dead { history, forces: dead_forces(mesh, points, at) });
    }

    /// Forces on the control points, N.
    pub fn forces(&self, mesh: &Mesh, displacement: &[[f64; 3]], parameter: f64) -> Vec<[f64; 3]> {
        self.sum(mesh, displacement, |history| history.at(parameter))
    }

    /// Derivatives of the forces with respect to the parameter where the shell does not move, N.
    pub fn rates(&self, mesh: &Mesh, displacement: &[[f64; 3]], parameter: f64) -> Vec<[f64; 3]> {
        self.sum(mesh, displacement, |history| history.rate(parameter))
    }

    /// Forces on the control points with a factor for each action, N.
    fn sum(&self, mesh: &Mesh, displacement: &[[f64; 3]], factor: impl Fn(&History) -> f64) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; mesh.control_points.len()];
        for dead in &self.dead {
            let factor = factor(&dead.history);
            for (point, force) in &dead.forces {
                forces[*point] = add(forces[*point], scaled(factor, *force));
            }
        }
        for following in &self.following {
            let factor = factor(&following.history);
            for point in &following.points {
                let (h, _) = following.kind.work(point.deformed(mesh, displacement));
                for (a, control) in point.controls(mesh).enumerate() {
                    for k in 0..3 {
                        let share = factor * point.weight * point.functions[k][a];
                        forces[control] = add(forces[control], scaled(share, h[k]));
                    }
                }
            }
        }
        forces
    }

    /// Hands every block of ∂f/∂u to `take`: of each element, once its points are summed up.
    pub fn tangent(&self, mesh: &Mesh, displacement: &[[f64; 3]], parameter: f64, mut take: impl FnMut(LoadBlock)) {
        for following in &self.following {
            let factor = following.history.at(parameter);
            for points in following.points.chunk_by(|one, other| one.first == other.first) {
                let Some(first) = points.first() else { continue };
                let controls: Vec<usize> = first.controls(mesh).collect();
                let mut element = ElementTangent::new(controls.len());
                for point in points {
                    let (_, slopes) = following.kind.work(point.deformed(mesh, displacement));
                    element.add(factor, point, &slopes);
                }
                for (a, i) in controls.iter().enumerate() {
                    for (b, j) in controls.iter().enumerate() {
                        take(LoadBlock { points: [*i, *j], block: element.block(a, b) });
                    }
                }
            }
        }
    }
}

/// ∂f_a/∂u_b of one element: `numbers[((b · 3 + c) · 3 + d) · functions + a]`, c of the force and d of the motion.
struct ElementTangent {
    functions: usize,
    numbers: Vec<f64>,
}

impl ElementTangent {
    fn new(functions: usize) -> Self {
        Self { functions, numbers: vec![0.0; 9 * functions * functions] }
    }

    /// Σ_k N_k(a) [Σ_l N_l(b) ∂h_k/∂a_l] at a point.
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

/// h₀, h₁, h₂.
type Work = [[f64; 3]; 3];
/// ∂h_k/∂a_l: `[k][l][component of h][component of a]`.
type WorkSlopes = [[[[f64; 3]; 3]; 2]; 3];

impl Kind {
    /// What multiplies N, N,₁ and N,₂ at factor and weight 1, and its derivatives.
    fn work(self, [a1, a2]: [[f64; 3]; 2]) -> (Work, WorkSlopes) {
        let mut h = [[0.0; 3]; 3];
        let mut slopes = [[[[0.0; 3]; 3]; 2]; 3];
        let w = cross(a1, a2);
        let unit = |c: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == c)));
        match self {
            Kind::Pressure => {
                h[0] = w;
                for e in 0..3 {
                    let columns = [cross(unit(e), a2), cross(a1, unit(e))];
                    for l in 0..2 {
                        (0..3).for_each(|c| slopes[0][l][c][e] = columns[l][c]);
                    }
                }
            }
            Kind::Moment(running) => {
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

impl LoadPoint {
    fn new(mesh: &Mesh, at: [f64; 2], weight: f64) -> Self {
        let (first, [value, one, two, ..]) = evaluate_surface(mesh, at);
        let surface = mid_surface_point(mesh, &[], at);
        let tangents = [surface.derivatives[0], surface.derivatives[1]];
        let site = Site { position: surface.position, tangents, edge: None };
        Self { first, functions: [value, one, two], site, weight }
    }

    /// Area per parameter area, that of the surface or of its projection along a force.
    fn area(&self, per: LoadedArea, force: ForceVector) -> f64 {
        let normal = cross(self.site.tangents[0], self.site.tangents[1]);
        match (per, force) {
            (LoadedArea::Projected, ForceVector::Components(force)) if norm(force) > 0.0 => {
                (dot(normal, force) / norm(force)).abs()
            }
            _ => norm(normal),
        }
    }

    pub fn controls(&self, mesh: &Mesh) -> impl Iterator<Item = usize> + use<> {
        mesh.window(self.first)
    }

    /// a₁, a₂.
    pub fn deformed(&self, mesh: &Mesh, displacement: &[[f64; 3]]) -> [[f64; 3]; 2] {
        let mut tangents = self.site.tangents;
        for (a, control) in self.controls(mesh).enumerate() {
            for k in 0..2 {
                tangents[k] = add(tangents[k], scaled(self.functions[1 + k][a], displacement[control]));
            }
        }
        tangents
    }
}

/// Forces of a load whose force per weight at a point is `force`.
fn dead_forces(mesh: &Mesh, points: &[LoadPoint], force: impl Fn(&LoadPoint) -> [f64; 3]) -> Vec<(usize, [f64; 3])> {
    let mut sums = vec![[0.0; 3]; mesh.control_points.len()];
    for point in points {
        let whole = scaled(point.weight, force(point));
        for (a, control) in point.controls(mesh).enumerate() {
            sums[control] = add(sums[control], scaled(point.functions[0][a], whole));
        }
    }
    sums.into_iter().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
}

fn edge_points(mesh: &Mesh, edge: Edge, limits: [f64; 2]) -> Vec<LoadPoint> {
    let (direction, at_end) = edge.side();
    let mut points = line_points(mesh, direction.index(), if at_end { 1.0 } else { 0.0 }, limits);
    points.iter_mut().for_each(|point| point.site.edge = Some(edge));
    points
}

/// Gauss points of a line on which parameter `way` is `at`; weights are undeformed lengths, mm.
fn line_points(mesh: &Mesh, way: usize, at: f64, limits: [f64; 2]) -> Vec<LoadPoint> {
    let running = 1 - way;
    let mut points = Vec::new();
    if at >= limits[way] {
        return points;
    }
    let spans = mesh.element_counts()[running];
    for (parameter, weight) in gauss_points(mesh, running, &vec![0; spans], limits[running]) {
        let place = if way == 0 { [at, parameter] } else { [parameter, at] };
        let mut point = LoadPoint::new(mesh, place, weight);
        point.weight *= norm(point.site.tangents[running]);
        points.push(point);
    }
    points
}

/// Gauss points of the surface, element by element; weights are parameter areas. Each way they are at least as many as
/// stretching has: membrane forces carry a pressure, and where its forces are summed up less exactly than theirs, bending
/// takes the difference (at R/t = 3000, on eight cubic elements a quarter turn and p + 2 points for stretching, a pressure on
/// p − 1 points inside is 32 % off).
fn area_points(scene: &Scene, mesh: &Mesh, limits: [f64; 2]) -> Vec<LoadPoint> {
    let least = PointCounts::of(scene, mesh);
    let [along, across] = [0, 1].map(|way| gauss_points(mesh, way, &least.most()[way], limits[way]));
    let pairs = along.iter().flat_map(|one| across.iter().map(move |two| (one, two)));
    let mut points: Vec<_> = pairs.map(|((u, wu), (v, wv))| LoadPoint::new(mesh, [*u, *v], wu * wv)).collect();
    points.sort_by_key(|point| point.first);
    points
}

/// Parameters and weights of Gauss points in every span or the part of it below `limit`, at least `least` in each. A pressure integrates N x,₁ × x,₂, of degree
/// 3p − 1 each way: so many points are exact where the weights are equal, and only then is its tangent symmetric to rounding.
fn gauss_points(mesh: &Mesh, way: usize, least: &[usize], limit: f64) -> Vec<(f64, f64)> {
    let count = (3 * mesh.degree[way]).div_ceil(2);
    let spans = Spans::of(&mesh.knots[way], mesh.degree[way]);
    let in_span = |([from, to], least): (&[f64; 2], &usize)| {
        let to = to.min(limit);
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let rule = gauss_legendre(count.max(*least));
        rule.into_iter().map(move |[node, weight]| (middle + half * node, half * weight)).collect::<Vec<_>>()
    };
    spans.bounds.iter().zip(least).filter(|([from, _], _)| *from < limit).flat_map(in_span).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::{Discretization, starting_mesh};
    use crate::scene::{Place, parse};

    /// A panel with a follower pressure and an edge moment, displaced at random.
    fn loaded(clamped: bool) -> (Discretization, Vec<[f64; 3]>) {
        let mut scene = parse(include_str!("../../pipelines/verification/rolled-cantilever.toml"), "x.toml").unwrap();
        scene.geometry = crate::scene::Geometry::CylinderPanel {
            length_mm: 9.0,
            radius_mm: 5.0,
            arc_deg: 80.0,
            from_deg: None,
            seam: None,
        };
        scene.mesh.elements = [3, 2];
        let kind = ActionKind::Pressure { pressure_mpa: 0.7, follower: true };
        let pressure = Action { name: "p".into(), kind, history: History::default() };
        if clamped {
            scene.geometry = crate::scene::Geometry::Plate { length_mm: 9.0, width_mm: 7.0 };
            scene.actions.clear();
            let hinged = |edge: Edge| crate::scene::Support {
                name: format!("{edge:?}"),
                on: Place::Edge(edge),
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
        let displacement = discretization.unknowns.place(&free, 1.0).displacement();
        (discretization, displacement)
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_forces() {
        let (discretization, displacement) = loaded(false);
        let mesh = &discretization.mesh;
        let direction: Vec<[f64; 3]> =
            (0..displacement.len()).map(|i| [0, 1, 2].map(|c| ((i * 31 + c * 17) % 23) as f64 / 23.0 - 0.5)).collect();
        let mut exact = vec![[0.0; 3]; displacement.len()];
        discretization.loads.tangent(mesh, &displacement, 0.8, |part| {
            for c in 0..3 {
                exact[part.points[0]][c] += dot(part.block[c], direction[part.points[1]]);
            }
        });
        let step = 1e-6;
        let moved = |sign: f64| -> Vec<[f64; 3]> {
            let at: Vec<[f64; 3]> =
                displacement.iter().zip(&direction).map(|(u, d)| add(*u, scaled(sign * step, *d))).collect();
            discretization.loads.forces(mesh, &at, 0.8)
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
            let mesh = &discretization.mesh;
            let count = discretization.unknowns.count();
            let free = discretization.unknowns.of_displacement(&displacement, &[], 1.0);
            let placement = discretization.unknowns.place(&free, 1.0);
            let field = |seed: usize| {
                let q: Vec<f64> = (0..count).map(|i| ((i * 7919 + seed) % 1013) as f64 / 1013.0 - 0.5).collect();
                placement.velocity(&q, &[])
            };
            let (a, b) = (field(3), field(11));
            let (mut ab, mut ba) = (0.0, 0.0);
            discretization.loads.tangent(mesh, &displacement, 1.0, |part| {
                let [i, j] = part.points;
                ab += (0..3).map(|c| a[i][c] * dot(part.block[c], b[j])).sum::<f64>();
                ba += (0..3).map(|c| b[i][c] * dot(part.block[c], a[j])).sum::<f64>();
            });
            (ab - ba).abs() / (ab.abs() + ba.abs())
        };
        assert!(skew(true) < 1e-10, "{}", skew(true));
        assert!(skew(false) > 1e-3, "{}", skew(false));
    }
}
