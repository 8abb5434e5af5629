//! Where a shell is held and what acts on it, as marks for its picture, with the outline that it had before.

use super::export::WholeShell;
use crate::model::{Site, direction_at, parameters_of, supports_of};
use crate::scene::{
    Action, ActionKind, Edge, ForceVector, Hold, Motion, Region, Scene, Support, SurfaceDirection, Symmetry,
};
use crate::shell::{add, cross, dot, norm, scaled, sub};
use crate::spline::{Patch, mid_surface_point};
use crate::state::State;

/// Marks on a deformed shell, mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// Edges of the shell as it was before.
    pub(super) outline: Vec<Vec<[f64; 3]>>,
    /// What the outline is of.
    pub(super) outline_name: &'static str,
    pub(super) held: Vec<Held>,
    pub(super) arrows: Vec<Arrow>,
}

/// A place that is held: a point, or a line of points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Held {
    pub(super) kind: HeldKind,
    pub(super) points: Vec<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HeldKind {
    /// All displacements are given.
    Hinged,
    /// Some components of the displacement are given.
    Guided,
    /// An edge that neither moves nor turns.
    Clamped,
    /// An edge that moves as one.
    Section,
    /// In a plane of symmetry.
    Symmetric,
}

/// An arrow whose head is at its last point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Arrow {
    pub(super) kind: ArrowKind,
    pub(super) points: Vec<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArrowKind {
    Load,
    /// A motion that a support is given.
    Motion,
}

impl HeldKind {
    pub(super) const ALL: [HeldKind; 5] =
        [HeldKind::Hinged, HeldKind::Guided, HeldKind::Clamped, HeldKind::Section, HeldKind::Symmetric];

    pub(super) fn name(self) -> &'static str {
        match self {
            HeldKind::Hinged => "hinged",
            HeldKind::Guided => "held in some directions",
            HeldKind::Clamped => "clamped",
            HeldKind::Section => "rigid section",
            HeldKind::Symmetric => "plane of symmetry",
        }
    }
}

impl ArrowKind {
    pub(super) const ALL: [ArrowKind; 2] = [ArrowKind::Load, ArrowKind::Motion];

    pub(super) fn name(self) -> &'static str {
        match self {
            ArrowKind::Load => "load",
            ArrowKind::Motion => "given motion",
        }
    }
}

/// Points of a line.
const SAMPLES: usize = 48;
/// Lengths of arrows and radii of turns, relative to the size of the shell.
const AT_POINT: f64 = 0.12;
const ON_LINE: f64 = 0.07;
const ON_SURFACE: f64 = 0.05;
const TURN: f64 = 0.035;
/// Arrows along a line, and each way on a surface.
const ARROWS: usize = 4;

impl Marks {
    /// The supports and loads of a scene in a state, and the undeformed outline.
    pub fn of(scene: &Scene, state: &State) -> Self {
        let mut marks = Self { outline_name: "undeformed", ..Self::default() };
        let whole = scene;
        for index in 0..scene.shell_count() {
            let (scene, state) = (scene.of_shell(index), state.of_shell(index));
            let shell = WholeShell::new(&scene, &state);
            let place = Place::new(&scene, &shell, state.parameter);
            marks.outline.extend(outline(shell.undeformed()));
            place.mark_supports(&mut marks);
            // What acts on a section of several edges is drawn once.
            let is_elsewhere = |action: &&Action| match &action.kind {
                ActionKind::SectionForce { section, .. } | ActionKind::SectionMoment { section, .. } => {
                    whole.supports.iter().any(|support| support.name == *section && support.shell != index)
                }
                _ => false,
            };
            for action in scene.actions.iter().filter(|action| !is_elsewhere(action)) {
                let factor = action.history.at(state.parameter);
                if factor != 0.0 {
                    marks.arrows.extend(place.loads(&action.kind, factor));
                }
            }
        }
        marks
    }

    /// The supports of a scene on a mode, which is the shell of `state` moved, and the outline of the equilibrium.
    pub fn of_mode(scene: &Scene, state: &State, moved: &State) -> Self {
        let mut marks = Self { outline_name: "equilibrium", ..Self::default() };
        for index in 0..scene.shell_count() {
            let (scene, state, moved) = (scene.of_shell(index), state.of_shell(index), moved.of_shell(index));
            let equilibrium = WholeShell::new(&scene, &state);
            let shell = WholeShell::new(&scene, &moved);
            marks.outline.extend(outline(equilibrium.deformed()));
            Place::new(&scene, &shell, state.parameter).mark_supports(&mut marks);
        }
        marks.arrows.clear();
        marks
    }

    /// All points that must be in view.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let arrows = self.arrows.iter().flat_map(|arrow| &arrow.points);
        self.outline.iter().flatten().chain(arrows).copied()
    }
}

/// The four edges of a surface.
fn outline(mesh: &Patch) -> Vec<Vec<[f64; 3]>> {
    let edges = [Edge::UStart, Edge::UEnd, Edge::VStart, Edge::VEnd];
    edges.map(|edge| places_on(edge).map(|at| mid_surface_point(mesh, &[], at).position).collect()).to_vec()
}

/// Parameters along an edge.
fn places_on(edge: Edge) -> impl Iterator<Item = [f64; 2]> {
    let (direction, at_end) = edge.side();
    let end = f64::from(u8::from(at_end));
    let on = move |along: f64| if direction.index() == 0 { [end, along] } else { [along, end] };
    (0..=SAMPLES).map(move |k| on(k as f64 / SAMPLES as f64))
}

/// A shell to be marked.
struct Place<'a> {
    scene: &'a Scene,
    undeformed: &'a Patch,
    deformed: &'a Patch,
    parameter: f64,
    /// Diagonal of the undeformed shell, mm.
    size: f64,
}

impl<'a> Place<'a> {
    fn new(scene: &'a Scene, shell: &'a WholeShell, parameter: f64) -> Self {
        let span = |c: usize| {
            let values = || shell.undeformed().points().map(move |point| point[c]);
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        };
        let size = norm([0, 1, 2].map(span));
        Self { scene, undeformed: shell.undeformed(), deformed: shell.deformed(), parameter, size }
    }

    fn position(&self, at: [f64; 2]) -> [f64; 3] {
        mid_surface_point(self.deformed, &[], at).position
    }

    /// Parameters of the points of a region; of the whole surface none.
    fn places(&self, on: Region) -> Vec<[f64; 2]> {
        match on {
            Region::Edge(edge) => places_on(edge).collect(),
            Region::Point(fractions) => vec![parameters_of(&self.scene.geometry, fractions)],
            Region::Line(direction, fraction) => {
                let at = parameters_of(&self.scene.geometry, [fraction; 2])[direction.index()];
                let along = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64);
                along.map(|along| if direction.index() == 0 { [at, along] } else { [along, at] }).collect()
            }
            Region::Whole => Vec::new(),
        }
    }

    /// Supports of the whole shell, whatever part of it is modelled.
    fn mark_supports(&self, marks: &mut Marks) {
        let whole = Scene { symmetry: Symmetry::None, ..self.scene.clone() };
        for support in supports_of(&whole) {
            let points: Vec<_> = self.places(support.on).into_iter().map(|at| self.position(at)).collect();
            if let Some(kind) = kind_of(&support.hold).filter(|_| !points.is_empty()) {
                marks.arrows.extend(self.motions(&support, &points));
                marks.held.push(Held { kind, points });
            }
        }
    }

    /// Motions that a support is given.
    fn motions(&self, support: &Support, points: &[[f64; 3]]) -> Vec<Arrow> {
        let factor = support.history.at(self.parameter);
        let centre = scaled(1.0 / points.len() as f64, points.iter().fold([0.0; 3], |sum, point| add(sum, *point)));
        let [translation, turn] = match &support.hold {
            Hold::Displacement { displacement_mm } => [displacement_mm.map(Option::unwrap_or_default), [0.0; 3]],
            Hold::Rigid { motions, .. } => {
                let given = |k: usize| if let Motion::Given(value) = motions[k] { value } else { 0.0 };
                [[0, 1, 2].map(given), [3, 4, 5].map(given)]
            }
            Hold::Symmetric | Hold::RigidMotions => [[0.0; 3]; 2],
        };
        let moved = straight(ArrowKind::Motion, centre, scaled(factor, translation), AT_POINT * self.size, Head::Away);
        let turned = turning(ArrowKind::Motion, centre, scaled(factor, turn), 2.0 * TURN * self.size);
        moved.into_iter().chain(turned).collect()
    }

    /// What acts, at a factor.
    fn loads(&self, kind: &ActionKind, factor: f64) -> Vec<Arrow> {
        let onto = |at: [f64; 2], along: [f64; 3], length: f64| {
            straight(ArrowKind::Load, self.position(at), along, length * self.size, Head::At)
        };
        let surface = || {
            let middle = |k: usize| (k as f64 + 0.5) / ARROWS as f64;
            (0..ARROWS).flat_map(move |i| (0..ARROWS).map(move |j| [middle(i), middle(j)]))
        };
        match kind {
            ActionKind::SectionForce { section, force_n } => {
                let along = scaled(factor, *force_n);
                self.section(section)
                    .and_then(|at| straight(ArrowKind::Load, at, along, AT_POINT * self.size, Head::At))
                    .into_iter()
                    .collect()
            }
            ActionKind::SectionMoment { section, moment_n_mm, about, .. } => {
                let mut axis = [0.0; 3];
                axis[*about as usize] = factor * moment_n_mm;
                self.section(section)
                    .and_then(|at| turning(ArrowKind::Load, at, axis, TURN * self.size))
                    .into_iter()
                    .collect()
            }
            ActionKind::Force { on, force_n } => {
                let at = parameters_of(&self.scene.geometry, *on);
                onto(at, self.vector(force_n, at, None, factor), AT_POINT).into_iter().collect()
            }
            ActionKind::LineForce { on, force_n_per_mm } => {
                let edge = if let Region::Edge(edge) = on { Some(*edge) } else { None };
                let pulls = matches!(force_n_per_mm, ForceVector::Along(size, SurfaceDirection::Outward) if size * factor > 0.0);
                let head = || if pulls { Head::Away } else { Head::At };
                let along = |at| self.vector(force_n_per_mm, at, edge, factor);
                let arrow = |at| straight(ArrowKind::Load, self.position(at), along(at), ON_LINE * self.size, head());
                every(self.places(*on), ARROWS + 1).filter_map(arrow).collect()
            }
            ActionKind::AreaForce { force_n_per_mm2, .. } => surface()
                .filter_map(|at| onto(at, self.vector(force_n_per_mm2, at, None, factor), ON_SURFACE))
                .collect(),
            ActionKind::Gravity { acceleration_m_s2 } => {
                surface().filter_map(|at| onto(at, scaled(factor, *acceleration_m_s2), ON_SURFACE)).collect()
            }
            ActionKind::Pressure { pressure_mpa, follower } => {
                let mesh = if *follower { self.deformed } else { self.undeformed };
                let normal = |at| {
                    let [a1, a2, ..] = mid_surface_point(mesh, &[], at).derivatives;
                    scaled(factor * pressure_mpa, cross(a1, a2))
                };
                surface().filter_map(|at| onto(at, normal(at), ON_SURFACE)).collect()
            }
            ActionKind::EdgeMoment { on, moment_n } => {
                let running = 1 - on.side().0.index();
                let about = |at| {
                    let tangent = mid_surface_point(self.deformed, &[], at).derivatives[running];
                    turning(ArrowKind::Load, self.position(at), scaled(factor * moment_n, tangent), TURN * self.size)
                };
                every(places_on(*on).collect(), 3).filter_map(about).collect()
            }
            // Everywhere the same, and without a direction in space.
            ActionKind::Temperature { .. } | ActionKind::NaturalCurvature { .. } => Vec::new(),
        }
    }

    /// Where the middle of a rigid section stands.
    fn section(&self, name: &str) -> Option<[f64; 3]> {
        let support = self.scene.supports.iter().find(|support| support.name == name)?;
        let middle = support.on.fractions().map(|fraction| fraction.unwrap_or(0.5));
        matches!(support.on, Region::Edge(_)).then(|| self.position(middle))
    }

    /// The direction of a force, of any length.
    fn vector(&self, force: &ForceVector, at: [f64; 2], edge: Option<Edge>, factor: f64) -> [f64; 3] {
        match force {
            ForceVector::Components(components) => scaled(factor, *components),
            ForceVector::Along(size, direction) => {
                let point = mid_surface_point(self.undeformed, &[], at);
                let [a1, a2, ..] = point.derivatives;
                let site = Site { position: point.position, tangents: [a1, a2], edge };
                scaled(factor * size, direction_at(self.scene, &site, *direction))
            }
        }
    }
}

/// How a support is drawn; that of rigid motions alone holds no place.
fn kind_of(hold: &Hold) -> Option<HeldKind> {
    match hold {
        Hold::Displacement { displacement_mm } => match displacement_mm.iter().flatten().count() {
            0 => None,
            3 => Some(HeldKind::Hinged),
            _ => Some(HeldKind::Guided),
        },
        Hold::Symmetric => Some(HeldKind::Symmetric),
        Hold::RigidMotions => None,
        Hold::Rigid { motions, normals_turn, .. } => {
            let is_still = motions.iter().all(|motion| *motion == Motion::Given(0.0));
            match (is_still, normals_turn) {
                (true, true) => Some(HeldKind::Clamped),
                (true, false) => Some(HeldKind::Hinged),
                (false, _) => Some(HeldKind::Section),
            }
        }
    }
}

/// Some of a line's points, evenly chosen, its ends among them; one is the middle.
pub(super) fn every<P: Copy>(points: Vec<P>, count: usize) -> impl Iterator<Item = P> {
    let count = count.min(points.len());
    let last = points.len().saturating_sub(1);
    (0..count).map(move |k| points[if count == 1 { last / 2 } else { last * k / (count - 1) }])
}

/// The end of an arrow that lies on the shell.
enum Head {
    At,
    Away,
}

/// A straight arrow along a vector; `None` where that is 0.
fn straight(kind: ArrowKind, at: [f64; 3], along: [f64; 3], length: f64, head: Head) -> Option<Arrow> {
    let size = norm(along);
    let way = scaled(length / size, along);
    let points = match head {
        Head::At => vec![sub(at, way), at],
        Head::Away => vec![at, add(at, way)],
    };
    (size > 0.0).then_some(Arrow { kind, points })
}

/// Three quarters of a turn about a vector by the right-hand rule; `None` where that is 0.
fn turning(kind: ArrowKind, centre: [f64; 3], about: [f64; 3], radius: f64) -> Option<Arrow> {
    const PARTS: usize = 24;
    let size = norm(about);
    if size == 0.0 {
        return None;
    }
    let axis = scaled(1.0 / size, about);
    let mut other = [0.0; 3];
    let least = (0..3).min_by(|a, b| axis[*a].abs().total_cmp(&axis[*b].abs())).unwrap_or(0);
    other[least] = 1.0;
    let square = sub(other, scaled(dot(other, axis), axis));
    let first = scaled(1.0 / norm(square), square);
    let second = cross(axis, first);
    let at = |k: usize| {
        let (sin, cos) = (1.5 * std::f64::consts::PI * k as f64 / PARTS as f64).sin_cos();
        add(centre, add(scaled(radius * cos, first), scaled(radius * sin, second)))
    };
    Some(Arrow { kind, points: (0..=PARTS).map(at).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    /// The state that a scene starts from, with its whole load.
    fn marks_of(text: &str) -> Marks {
        let scene = parse(text, "test").unwrap();
        let mut state = crate::pipeline::Stages::new(scene.clone()).start().unwrap();
        state.parameter = 1.0;
        Marks::of(&scene, &state)
    }

    fn kinds(marks: &Marks) -> Vec<HeldKind> {
        marks.held.iter().map(|held| held.kind).collect()
    }

    #[test]
    fn both_ends_of_a_quarter_of_a_tape_spring_turn() {
        let marks = marks_of(include_str!("../../pipelines/baseline-quarter.toml"));
        assert_eq!(kinds(&marks), [HeldKind::Section, HeldKind::Section]);
        assert_eq!(marks.arrows.len(), 2);
        let x = |held: &Held| held.points[0][0];
        assert!((x(&marks.held[1]) - x(&marks.held[0]) - 300.0).abs() < 1e-9);
        // In opposite sense.
        let turn = |arrow: &Arrow| {
            let [a, b] = [0, 6].map(|k| sub(arrow.points[k], scaled(0.5, add(arrow.points[0], arrow.points[12]))));
            cross(a, b)[1]
        };
        assert!(turn(&marks.arrows[0]) * turn(&marks.arrows[1]) < 0.0);
    }

    #[test]
    fn a_roof_is_hinged_and_pushed_down_at_its_middle() {
        let marks = marks_of(include_str!("../../pipelines/verification/hinged-roof-12.7.toml"));
        assert!(kinds(&marks).contains(&HeldKind::Hinged), "{:?}", kinds(&marks));
        let [Arrow { kind: ArrowKind::Load, points }] = &marks.arrows[..] else { panic!("{:?}", marks.arrows) };
        let way = sub(points[1], points[0]);
        assert!(way[2] < 0.0 && way[0] == 0.0 && way[1] == 0.0, "{way:?}");
    }

    /// A sphere under pressure, with what its missing caps would pull at its edges.
    #[test]
    fn a_pressure_acts_along_the_normal_and_edges_are_pulled_outward() {
        let marks = marks_of(include_str!("../../pipelines/verification/sphere-zone-pressure.toml"));
        let (pressure, edges) = marks.arrows.split_at(ARROWS * ARROWS);
        assert_eq!(edges.len(), 2 * (ARROWS + 1));
        for Arrow { points, .. } in pressure {
            // From the centre of the sphere outward, onto it.
            let way = sub(points[1], points[0]);
            assert!((norm(points[1]) - 100.0).abs() < 1e-9);
            assert!((dot(way, points[1]) - norm(way) * 100.0).abs() < 1e-9 * norm(way));
        }
        for Arrow { points, .. } in edges {
            assert!((norm(points[0]) - 100.0).abs() < 1e-9, "it begins at the edge");
            assert!(dot(sub(points[1], points[0]), points[0]).abs() < 1e-9, "it is tangent to the sphere");
        }
        assert!(marks.held.is_empty(), "rigid motions alone are held");
    }
}
