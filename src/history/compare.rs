//! Two states side by side: which field differs most, by how much, and where on the surface.

use crate::spline::Mesh;
use crate::state::{Rejection, State};

/// Two values of a field that are not the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the field.
    pub field: &'static str,
    /// Where in it: control point (i₁, i₂) and its undeformed place, mm.
    pub place: Option<([usize; 2], [f64; 3])>,
    /// The two values there; for vectors the component that differs most.
    pub values: [f64; 2],
    /// Bits that agree, relative to the largest magnitude in the field: −log₂(|a − b| / max).
    pub agreeing_bits: f64,
}

/// All fields of two states.
#[derive(Clone, Debug, PartialEq)]
pub enum Comparison {
    /// Every bit agrees.
    Identical,
    /// Numbers differ; a difference for each field that does, worst first.
    Numbers(Vec<Difference>),
    /// The states are not of one kind (another mesh, another stage, other marks), in words.
    Structure(String),
}

/// Compares two states field by field.
pub fn compare(a: &State, b: &State) -> Comparison {
    if a.hash() == b.hash() {
        return Comparison::Identical;
    }
    if let Some(what) = structure(a, b) {
        return Comparison::Structure(what);
    }
    let mut differences: Vec<Difference> = [
        ("rotation_deg", a.parameter, b.parameter),
        ("moment_n_mm", a.moment_n_mm, b.moment_n_mm),
        ("strain_energy_n_mm", a.strain_energy_n_mm, b.strain_energy_n_mm),
        ("largest_force_n", a.largest_force_n, b.largest_force_n),
    ]
    .into_iter()
    .filter_map(|(field, x, y)| number(field, x, y))
    .collect();
    differences.extend(displacement(a, b));
    differences.extend(control_points(&a.mesh, &b.mesh));
    if let (Some(p), Some(q)) = (&a.previous, &b.previous) {
        differences.extend(worst("displacement before", &a.mesh, &p.displacement, &q.displacement));
        differences.extend(number("rotation before", p.parameter, q.parameter));
    }
    if let (Some(p), Some(q)) = (&a.refinement, &b.refinement) {
        differences.extend(number("energy that refining changed", p.changed_n_mm, q.changed_n_mm));
        differences.extend(number("energy of the last ripple", p.ripple_n_mm, q.ripple_n_mm));
    }
    if let (Some(p), Some(q)) = (&a.path, &b.path) {
        differences.extend(worst("direction of the path", &a.mesh, &p.heading, &q.heading));
        differences.extend(number("length of the path", p.travelled_mm, q.travelled_mm));
        differences.extend(number("length of the next step", p.next_mm, q.next_mm));
    }
    differences.sort_by(|x, y| x.agreeing_bits.total_cmp(&y.agreeing_bits));
    if differences.is_empty() {
        return Comparison::Structure("knots or step control differ".to_string());
    }
    Comparison::Numbers(differences)
}

/// Why two states cannot be compared number by number.
fn structure(a: &State, b: &State) -> Option<String> {
    let elements = |state: &State| state.mesh.element_counts();
    if a.stage == b.stage && a.control.rejection != b.control.rejection {
        let what = |state: &State| match state.control.rejection {
            None => format!("a solve that reached {}°", state.parameter),
            Some(Rejection::NoEquilibrium) => "a solve that found no equilibrium".to_string(),
            Some(Rejection::Jump) => "a solve that was turned down as unstable on the way".to_string(),
            Some(Rejection::CriticalPoint) => "a solve that was turned down for a critical point".to_string(),
            Some(Rejection::SharpTurn) => "a solve that was turned down for a sharp turn".to_string(),
        };
        return Some(format!("{} against {}", what(a), what(b)));
    }
    if a.stage != b.stage || a.step != b.step {
        let name = |state: &State| state.stage.map_or("start", |stage| stage.name());
        return Some(format!("step {} {} against step {} {}", a.step, name(a), b.step, name(b)));
    }
    if a.mesh.degree != b.mesh.degree || a.mesh.control_counts() != b.mesh.control_counts() {
        let ([a1, a2], [b1, b2]) = (elements(a), elements(b));
        return Some(format!("a mesh of {a1} × {a2} elements against {b1} × {b2}"));
    }
    if a.marked != b.marked {
        let counts = |state: &State| [state.marked[0].len(), state.marked[1].len()];
        return Some(format!("{:?} knot spans marked against {:?}", counts(a), counts(b)));
    }
    if a.negative_pivots != b.negative_pivots {
        return Some(format!("{} negative pivots against {}", a.negative_pivots, b.negative_pivots));
    }
    if a.path.is_some() != b.path.is_some() {
        let what = |state: &State| if state.path.is_some() { "by arc length" } else { "by load" };
        return Some(format!("a step {} against one {}", what(a), what(b)));
    }
    if a.previous.is_some() != b.previous.is_some() {
        return Some("only one of them remembers the equilibrium before".to_string());
    }
    let growth = |state: &State| state.refinement.map(|last| (last.growth, last.expected_n_mm.is_some()));
    if growth(a) != growth(b) {
        return Some("they were refined otherwise before".to_string());
    }
    if a.control != b.control {
        let what = |state: &State| {
            let size = match state.control.halvings {
                0 => "the scene's increment".to_string(),
                halvings @ 1.. => format!("an increment halved {halvings} times"),
                grown => format!("an increment doubled {} times", grown.unsigned_abs()),
            };
            let jump = state.control.jump_seen_at_deg.map(|at| format!(", a jump seen at {at}"));
            size + &jump.unwrap_or_default()
        };
        return Some(format!("{} for the next step against {}", what(a), what(b)));
    }
    None
}

fn number(field: &'static str, a: f64, b: f64) -> Option<Difference> {
    (a.to_bits() != b.to_bits()).then(|| Difference {
        field,
        place: None,
        values: [a, b],
        agreeing_bits: agreeing_bits(a, b, a.abs().max(b.abs())),
    })
}

fn agreeing_bits(a: f64, b: f64, scale: f64) -> f64 {
    let share = (a - b).abs() / scale;
    if share.is_nan() { 0.0 } else { -share.log2() }
}

/// The component of a vector field on control points that differs most.
fn worst<const N: usize>(field: &'static str, mesh: &Mesh, a: &[[f64; N]], b: &[[f64; N]]) -> Option<Difference> {
    let scale = a.iter().chain(b).flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let mut found: Option<(usize, [f64; 2])> = None;
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        for c in 0..N {
            let larger = found.is_none_or(|(_, [p, q])| (x[c] - y[c]).abs() > (p - q).abs());
            if x[c].to_bits() != y[c].to_bits() && larger {
                found = Some((i, [x[c], y[c]]));
            }
        }
    }
    let (index, values) = found?;
    let n2 = mesh.control_counts()[1];
    let [x, y, z, w] = mesh.control_points[index];
    Some(Difference {
        field,
        place: Some(([index / n2, index % n2], [x / w, y / w, z / w])),
        values,
        agreeing_bits: agreeing_bits(values[0], values[1], scale),
    })
}

fn displacement(a: &State, b: &State) -> Option<Difference> {
    worst("displacement", &a.mesh, &a.displacement, &b.displacement)
}

fn control_points(a: &Mesh, b: &Mesh) -> Option<Difference> {
    worst("control points", a, &a.control_points, &b.control_points)
}
