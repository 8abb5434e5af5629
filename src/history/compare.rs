//! Two states side by side, in bits: which fields differ, by how much, and where on the surface.
//!
//! Structs are taken apart by name, so that a field that is forgotten here does not compile.

use crate::spline::{Mesh, Patch};
use crate::state::{
    Course, CriticalAhead, DriveMemory, PathMemory, Previous, Refinement, Rejection, State, StepControl,
};

/// A field in which two states differ, and its values where they differ most.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the field.
    pub field: &'static str,
    /// Where in it: control point (i₁, i₂) and its undeformed place, mm.
    pub place: Option<([usize; 2], [f64; 3])>,
    /// The two values there; for vectors the component that differs most.
    pub values: [f64; 2],
    /// Bits that agree, relative to what the field is compared with, mostly its own largest magnitude: −log₂(|a − b| / scale).
    /// Infinite for zeros of different sign.
    pub agreeing_bits: f64,
}

/// The result of comparing all fields of two states.
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
    let mut found = Found { mesh: &a.mesh, kinds: Vec::new(), numbers: Vec::new() };
    found.states(a, b);
    let Found { kinds, mut numbers, .. } = found;
    if !kinds.is_empty() {
        return Comparison::Structure(kinds.join("; "));
    }
    if numbers.is_empty() {
        return Comparison::Identical;
    }
    numbers.sort_by(|x, y| x.agreeing_bits.total_cmp(&y.agreeing_bits));
    Comparison::Numbers(numbers)
}

struct Found<'m> {
    /// The mesh that gives the place of a control point.
    mesh: &'m Mesh,
    /// What makes numbers of the two states no counterparts, in words.
    kinds: Vec<String>,
    numbers: Vec<Difference>,
}

impl Found<'_> {
    fn states(&mut self, a: &State, b: &State) {
        let State {
            mesh,
            displacement,
            marked,
            superfluous,
            refined,
            step,
            stage,
            parameter,
            turns,
            moment_n_mm,
            strain_energy_n_mm,
            negative_pivots,
            drive: DriveMemory { control, course },
            largest_force_n,
            refinement,
            estimate,
        } = a;
        if *stage == b.stage && control.rejection != b.drive.control.rejection {
            return self.kinds.push(format!("{} against {}", outcome(a), outcome(b)));
        }
        if (*step, *stage) != (b.step, b.stage) {
            let name = |state: &State| state.stage.map_or("start", |stage| stage.name());
            return self.kinds.push(format!("step {step} {} against step {} {}", name(a), b.step, name(b)));
        }
        self.meshes(["knots", "control points"], mesh, &b.mesh);
        if !self.kinds.is_empty() {
            return;
        }
        self.knots("knot spans marked", marked, &b.marked);
        self.knots("knots superfluous", superfluous, &b.superfluous);
        if *negative_pivots != b.negative_pivots {
            self.kinds.push(format!("{negative_pivots} negative pivots against {}", b.negative_pivots));
        }
        if let Some((x, y)) = self.both("a finer mesh waiting", refined, &b.refined) {
            self.meshes(["knots of the finer mesh", "control points of the finer mesh"], x, y);
        }
        self.number("rotation or load factor", *parameter, b.parameter);
        self.number("moment_n_mm", *moment_n_mm, b.moment_n_mm);
        self.number("strain_energy_n_mm", *strain_energy_n_mm, b.strain_energy_n_mm);
        self.number("largest_force_n", *largest_force_n, b.largest_force_n);
        self.vectors("displacement", displacement, &b.displacement);
        self.list("turns", turns.as_flattened(), b.turns.as_flattened());
        self.courses(course, &b.drive.course, *parameter);
        if let Some((x, y)) = self.both("memory of a refinement", refinement, &b.refinement) {
            self.refinements(x, y, *strain_energy_n_mm);
        }
        if let Some((x, y)) = self.both("estimate of the error", estimate, &b.estimate) {
            self.number("step of the estimated error", x.step as f64, y.step as f64);
            self.number("estimated error", x.relative_error, y.relative_error);
            self.list("largest indicator", &x.largest_indicator, &y.largest_indicator);
        }
        self.controls(control, &b.drive.control);
    }

    /// Knots to insert, or to take out.
    fn knots(&mut self, what: &'static str, a: &[[Vec<f64>; 2]], b: &[[Vec<f64>; 2]]) {
        let [of_a, of_b] = [a, b].map(|lists| lists.iter().flatten().map(Vec::len).collect::<Vec<usize>>());
        if of_a == of_b {
            a.iter().flatten().zip(b.iter().flatten()).for_each(|(x, y)| self.list(what, x, y));
        } else {
            self.kinds.push(format!("{of_a:?} {what} against {of_b:?}"));
        }
    }

    fn meshes(&mut self, [knots_name, points_name]: [&'static str; 2], a: &Mesh, b: &Mesh) {
        let Mesh { patches } = a;
        if patches.len() != b.patches.len() {
            return self.kinds.push(format!("{} shells against {}", patches.len(), b.patches.len()));
        }
        for (one, other) in patches.iter().zip(&b.patches) {
            let Patch { degree, knots, control_points } = one;
            if *degree != other.degree || one.control_counts() != other.control_counts() {
                let degrees =
                    if *degree == other.degree { String::new() } else { format!(" of degree {:?}", other.degree) };
                return self.kinds.push(format!(
                    "a mesh of {} elements against {}{degrees}",
                    a.elements(),
                    b.elements()
                ));
            }
            knots.iter().zip(&other.knots).for_each(|(x, y)| self.list(knots_name, x, y));
            self.vectors(points_name, control_points, &other.control_points);
        }
    }

    fn courses(&mut self, a: &Course, b: &Course, parameter: f64) {
        match (a, b) {
            (Course::Unknown, Course::Unknown) => {}
            (Course::Load(Previous { displacement, parameter }), Course::Load(y)) => {
                self.vectors("displacement before", displacement, &y.displacement);
                self.number("rotation or load factor before", *parameter, y.parameter);
            }
            (Course::Path(x), Course::Path(y)) => self.paths(x, y, parameter),
            (Course::Unknown | Course::Load(_) | Course::Path(_), _) => {
                self.only("memory of the equilibrium before", [a, b].map(|course| matches!(course, Course::Load(_))));
                self.only("a step by arc length", [a, b].map(|course| matches!(course, Course::Path(_))));
            }
        }
    }

    fn paths(&mut self, a: &PathMemory, b: &PathMemory, parameter: f64) {
        let PathMemory { heading, parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } = a;
        self.vectors("direction of the path", heading, &b.heading);
        // A rate goes through 0 at a limit point: it is compared with the mean rate as well.
        let mean_rate = if *travelled_mm > 0.0 { parameter / travelled_mm } else { 0.0 };
        self.beside("rate of the parameter", *parameter_rate, b.parameter_rate, mean_rate);
        self.number("length of the first step", *first_mm, b.first_mm);
        self.number("length of the next step", *next_mm, b.next_mm);
        self.number("length of the path", *travelled_mm, b.travelled_mm);
        if let Some((CriticalAhead { within_mm, rate_beyond }, y)) =
            self.both("a critical point ahead", critical_ahead, &b.critical_ahead)
        {
            self.beside("length to the critical point", *within_mm, y.within_mm, *first_mm);
            self.beside("rate beyond the critical point", *rate_beyond, y.rate_beyond, mean_rate);
        }
        if *at_bifurcation != b.at_bifurcation {
            self.kinds.push("only one of them has just passed a bifurcation".to_string());
        }
    }

    /// What refining changed is a difference of energies, and rounds as these do.
    fn refinements(&mut self, a: &Refinement, b: &Refinement, energy: f64) {
        let Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm } = a;
        self.number("growth on refining", *growth, b.growth);
        self.beside("energy that refining changed", *changed_n_mm, b.changed_n_mm, energy);
        self.beside("energy of the last ripple", *ripple_n_mm, b.ripple_n_mm, energy);
        if let Some((x, y)) = self.both("memory of the refinement before", expected_n_mm, &b.expected_n_mm) {
            // Of the whole mesh, and so larger by what the part was smaller.
            let scale = if *growth > 0.0 { energy / growth.min(1.0) } else { energy };
            self.beside("energy that refining was to change", *x, *y, scale);
        }
    }

    fn controls(&mut self, a: &StepControl, b: &StepControl) {
        let StepControl { halvings, jump_beyond, rejection: _ } = a;
        let size = |halvings: i32| match halvings {
            0 => "the scene's increment".to_string(),
            halvings @ 1.. => format!("an increment halved {halvings} times"),
            grown => format!("an increment doubled {} times", grown.unsigned_abs()),
        };
        if *halvings != b.halvings {
            self.kinds.push(format!("{} for the next step against {}", size(*halvings), size(b.halvings)));
        }
        if let Some((x, y)) = self.both("a jump seen ahead", jump_beyond, &b.jump_beyond) {
            self.number("jump seen at", *x, *y);
        }
    }

    /// Both where both are there; where only one is, that is a difference of kind.
    fn both<'s, T>(&mut self, what: &str, a: &'s Option<T>, b: &'s Option<T>) -> Option<(&'s T, &'s T)> {
        self.only(what, [a.is_some(), b.is_some()]);
        a.as_ref().zip(b.as_ref())
    }

    /// What only one of them has is a difference of kind.
    fn only(&mut self, what: &str, [first, second]: [bool; 2]) {
        if first != second {
            let which = if first { "first" } else { "second" };
            self.kinds.push(format!("{what} in the {which} only"));
        }
    }

    /// A number that is compared with its own magnitude.
    fn number(&mut self, field: &'static str, a: f64, b: f64) {
        self.beside(field, a, b, 0.0);
    }

    /// A number that is compared with its own magnitude or another, whichever is larger.
    fn beside(&mut self, field: &'static str, a: f64, b: f64, scale: f64) {
        if a.to_bits() != b.to_bits() {
            let agreeing_bits = agreeing_bits(a, b, a.abs().max(b.abs()).max(scale.abs()));
            self.numbers.push(Difference { field, place: None, values: [a, b], agreeing_bits });
        }
    }

    /// Numbers that are compared with the largest of them.
    fn list(&mut self, field: &'static str, a: &[f64], b: &[f64]) {
        if a.len() != b.len() {
            return self.kinds.push(format!("{} {field} against {}", a.len(), b.len()));
        }
        let [a, b] = [a, b].map(|list| list.iter().map(|value| [*value]).collect::<Vec<_>>());
        if let Some((_, values, agreeing_bits)) = worst(&a, &b) {
            self.numbers.push(Difference { field, place: None, values, agreeing_bits });
        }
    }

    /// Vectors on the control points of the mesh.
    fn vectors<const N: usize>(&mut self, field: &'static str, a: &[[f64; N]], b: &[[f64; N]]) {
        if a.len() != b.len() {
            return self.kinds.push(format!("{} control points in {field} against {}", a.len(), b.len()));
        }
        let Some((index, values, agreeing_bits)) = worst(a, b) else { return };
        // A finer mesh has more of them.
        let is_on_mesh = a.len() == self.mesh.point_count();
        let place = is_on_mesh.then(|| (self.mesh.grid_place(index), self.mesh.point(index)));
        self.numbers.push(Difference { field, place, values, agreeing_bits });
    }
}

/// What a stage came to, in words.
fn outcome(state: &State) -> String {
    match state.drive.control.rejection {
        None => format!("a solve that reached {}", state.parameter),
        Some(Rejection::NoEquilibrium) => "a solve that found no equilibrium".to_string(),
        Some(Rejection::Jump) => "a solve that was rejected as unstable on the way".to_string(),
        Some(Rejection::CriticalPoint) => "a solve that was rejected for a critical point".to_string(),
        Some(Rejection::SharpTurn) => "a solve that was rejected for a sharp turn".to_string(),
    }
}

fn agreeing_bits(a: f64, b: f64, scale: f64) -> f64 {
    if a == b {
        return f64::INFINITY;
    }
    let share = (a - b).abs() / scale;
    if share.is_nan() { 0.0 } else { -share.log2() }
}

/// Index and values of the component that differs most, and its agreeing bits.
fn worst<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> Option<(usize, [f64; 2], f64)> {
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
    found.map(|(index, values)| (index, values, agreeing_bits(values[0], values[1], scale)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::Stage;
    use crate::state::Estimate;

    fn state() -> State {
        let knots = vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0];
        let control_points = (0..16).map(|i| [f64::from(i) + 1.0, 2.0, 3.0, 1.0]).collect();
        let mesh = Arc::new(Mesh::from(Patch { degree: [2, 2], knots: [knots.clone(), knots], control_points }));
        State {
            displacement: vec![[1.0, 2.0, 3.0]; 16],
            marked: vec![[vec![0.25], vec![]]],
            refined: Some(mesh.clone()),
            step: 3,
            stage: Some(Stage::Solve),
            parameter: 8.0,
            turns: vec![[0.1, 0.2, 0.3]],
            moment_n_mm: 100.0,
            strain_energy_n_mm: 50.0,
            negative_pivots: 0,
            drive: DriveMemory {
                control: StepControl { halvings: 1, jump_beyond: Some(9.0), rejection: None },
                course: Course::Path(PathMemory {
                    heading: vec![[0.5, 0.25, 0.125]; 16],
                    parameter_rate: 0.5,
                    first_mm: 1.0,
                    next_mm: 2.0,
                    travelled_mm: 16.0,
                    critical_ahead: Some(CriticalAhead { within_mm: 0.5, rate_beyond: -0.25 }),
                    at_bifurcation: false,
                }),
            },
            largest_force_n: 5.0,
            refinement: Some(Refinement {
                changed_n_mm: 0.5,
                growth: 0.5,
                expected_n_mm: Some(0.25),
                ripple_n_mm: 0.125,
            }),
            superfluous: vec![[vec![], vec![0.5]]],
            estimate: Some(Estimate { step: 2, relative_error: 0.25, largest_indicator: [0.5, 0.125] }),
            mesh,
        }
    }

    /// The same where a load step led.
    fn after_load_step() -> State {
        let mut state = state();
        state.drive.course = Course::Load(Previous { displacement: vec![[0.5, 1.0, 1.5]; 16], parameter: 7.0 });
        state
    }

    fn path(state: &mut State) -> &mut PathMemory {
        let Course::Path(path) = &mut state.drive.course else { panic!("no path") };
        path
    }

    fn previous(state: &mut State) -> &mut Previous {
        let Course::Load(previous) = &mut state.drive.course else { panic!("no load step") };
        previous
    }

    /// The last bit of every number of a state, each alone, is a difference of that field, and one of rounding.
    #[test]
    fn the_last_bit_of_every_number_is_told() {
        type Change = fn(&mut State, fn(&mut f64));
        let changes: [(&str, Change); 25] = [
            ("knots", |s, f| f(&mut Arc::make_mut(&mut s.mesh).patches[0].knots[1][3])),
            ("control points", |s, f| f(&mut Arc::make_mut(&mut s.mesh).patches[0].control_points[7][2])),
            ("knots of the finer mesh", |s, f| {
                f(&mut Arc::make_mut(s.refined.as_mut().unwrap()).patches[0].knots[0][3])
            }),
            ("control points of the finer mesh", |s, f| {
                f(&mut Arc::make_mut(s.refined.as_mut().unwrap()).patches[0].control_points[3][1])
            }),
            ("displacement", |s, f| f(&mut s.displacement[5][2])),
            ("knot spans marked", |s, f| f(&mut s.marked[0][0][0])),
            ("knots superfluous", |s, f| f(&mut s.superfluous[0][1][0])),
            ("estimated error", |s, f| f(&mut s.estimate.as_mut().unwrap().relative_error)),
            ("largest indicator", |s, f| f(&mut s.estimate.as_mut().unwrap().largest_indicator[1])),
            ("rotation or load factor", |s, f| f(&mut s.parameter)),
            ("turns", |s, f| f(&mut s.turns[0][2])),
            ("moment_n_mm", |s, f| f(&mut s.moment_n_mm)),
            ("strain_energy_n_mm", |s, f| f(&mut s.strain_energy_n_mm)),
            ("largest_force_n", |s, f| f(&mut s.largest_force_n)),
            ("jump seen at", |s, f| f(s.drive.control.jump_beyond.as_mut().unwrap())),
            ("direction of the path", |s, f| f(&mut path(s).heading[2][0])),
            ("rate of the parameter", |s, f| f(&mut path(s).parameter_rate)),
            ("length of the first step", |s, f| f(&mut path(s).first_mm)),
            ("length of the next step", |s, f| f(&mut path(s).next_mm)),
            ("length of the path", |s, f| f(&mut path(s).travelled_mm)),
            ("length to the critical point", |s, f| f(&mut path(s).critical_ahead.as_mut().unwrap().within_mm)),
            ("rate beyond the critical point", |s, f| f(&mut path(s).critical_ahead.as_mut().unwrap().rate_beyond)),
            ("displacement before", |s, f| f(&mut previous(s).displacement[9][1])),
            ("rotation or load factor before", |s, f| f(&mut previous(s).parameter)),
            ("energy that refining was to change", |s, f| {
                f(s.refinement.as_mut().unwrap().expected_n_mm.as_mut().unwrap())
            }),
        ];
        for (field, change) in changes {
            let a = if field.ends_with("before") { after_load_step() } else { state() };
            assert_eq!(compare(&a, &a), Comparison::Identical);
            let mut b = a.clone();
            change(&mut b, |value| *value = value.next_up());
            assert_ne!(a.hash(), b.hash(), "{field}");
            let Comparison::Numbers(found) = compare(&a, &b) else { panic!("{field}: {:?}", compare(&a, &b)) };
            assert_eq!(found.iter().map(|it| it.field).collect::<Vec<_>>(), [field]);
            assert!((45.0..f64::INFINITY).contains(&found[0].agreeing_bits), "{field}: {found:?}");
            change(&mut b, |value| *value *= 1.5);
            let Comparison::Numbers(found) = compare(&a, &b) else { panic!("{field}: {:?}", compare(&a, &b)) };
            assert!(found[0].agreeing_bits < 12.0, "{field}: {found:?}");
        }
    }

    #[test]
    fn what_is_of_another_kind_is_told_in_words() {
        type Change = fn(&mut State);
        let changes: [(&str, Change); 14] = [
            ("[1, 0] knot spans marked against [1, 1]", |s| s.marked[0][1].push(0.75)),
            ("[0, 1] knots superfluous against [0, 0]", |s| s.superfluous[0][1].clear()),
            ("estimate of the error in the first only", |s| s.estimate = None),
            ("a finer mesh waiting in the first only", |s| s.refined = None),
            ("step 3 solve against step 4 solve", |s| s.step = 4),
            ("0 negative pivots against 1", |s| s.negative_pivots = 1),
            ("an increment halved 1 times for the next step against the scene's increment", |s| {
                s.drive.control.halvings = 0
            }),
            ("a jump seen ahead in the first only", |s| s.drive.control.jump_beyond = None),
            ("a solve that reached 8 against a solve that found no equilibrium", |s| {
                s.drive.control.rejection = Some(Rejection::NoEquilibrium)
            }),
            ("a step by arc length in the first only", |s| s.drive.course = Course::Unknown),
            ("memory of the equilibrium before in the second only; a step by arc length in the first only", |s| {
                *s = after_load_step()
            }),
            ("a critical point ahead in the first only", |s| path(s).critical_ahead = None),
            ("only one of them has just passed a bifurcation", |s| path(s).at_bifurcation = true),
            ("memory of a refinement in the first only", |s| s.refinement = None),
        ];
        let a = state();
        for (words, change) in changes {
            let mut b = a.clone();
            change(&mut b);
            let Comparison::Structure(what) = compare(&a, &b) else { panic!("{words}: {:?}", compare(&a, &b)) };
            assert!(what.contains(words), "{words}: {what}");
            assert_ne!(a.hash(), b.hash(), "{words}");
        }
    }
}
