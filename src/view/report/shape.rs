//! The deformed shells over the load steps: points of each whole shell on one grid for all frames, the knot lines of each frame's
//! mesh, and fields. Numbers are packed as 16 bits over their range, which is finer than a screen.

use serde::Serialize;

use crate::scene::Scene;
use crate::shell::norm;
use crate::spline::Elements;
use crate::spline::{Patch, Spans, mid_surface_point};
use crate::state::State;
use crate::view::bonded::ShellsOfState;
use crate::view::colour::VIRIDIS;
use crate::view::export::{WholePoint, WholeShell, base64};
use crate::view::fields::{Field, fields_of};
use crate::view::samples::number_range;

/// Most points of all shells in a frame.
const MOST_POINTS: usize = 4000;
/// Most frames.
const MOST_FRAMES: usize = 40;
/// Fields that the page offers, by name and component; that without a component is the length of the vector.
const OFFERED: [(&str, Option<usize>); 14] = [
    ("bending_strain_max", Some(0)),
    ("displacement", None),
    ("failure_tsai_wu", Some(0)),
    ("failure_max_strain", Some(0)),
    ("membrane_force_principal", Some(0)),
    ("membrane_force_principal", Some(1)),
    ("membrane_force", Some(0)),
    ("membrane_force", Some(1)),
    ("bending_moment_principal", Some(0)),
    ("bending_moment", Some(0)),
    ("bending_moment", Some(1)),
    ("energy_density", Some(0)),
    ("bond_peel", Some(0)),
    ("bond_shear", None),
];
/// What a value is packed as that is no number, of a field that has such; its numbers have one value less.
const BLANK: u16 = u16::MAX;

/// The deformed shells over the load steps.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    /// Points along u and v of each shell; what frames have of one shell follows what they have of the other.
    counts: Vec<[usize; 2]>,
    /// Least and largest coordinate of all frames, mm.
    bounds: [[f64; 2]; 3],
    fields: Vec<ShownField>,
    frames: Vec<Frame>,
    colours: Vec<u32>,
}

/// A field that the page can colour by.
#[derive(Clone, Debug, Serialize)]
struct ShownField {
    title: String,
    means: String,
    /// Least and largest value of all frames.
    range: [f64; 2],
    /// Whether it has no value in places.
    has_blanks: bool,
}

/// The shells at the end of a load step.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    step: u64,
    label: String,
    elements: Elements,
    /// Coordinates of the points, the second direction fastest.
    points: String,
    /// Values at the points, field by field.
    values: Vec<String>,
    /// Coordinates of the knot lines of each shell: all lines of one u, then those of one v.
    lines: String,
    /// Number of knot lines of one u, and of one v, of each shell.
    line_counts: Vec<[usize; 2]>,
}

/// A state to be shown.
#[derive(Clone, Debug)]
pub struct FrameAt {
    /// The state.
    pub state: State,
    /// What it is called, such as "θ 12.4°".
    pub label: String,
    /// Its load step.
    pub step: u64,
}

/// Which of `steps` load steps are shown: all of them, or evenly chosen ones with the last, and those that `wanted` names.
pub fn chosen_frames(steps: &[u64], wanted: impl Fn(u64) -> bool) -> Vec<u64> {
    let stride = steps.len().div_ceil(MOST_FRAMES).max(1);
    let is_chosen = |(index, step): &(usize, &u64)| index % stride == 0 || index + 1 == steps.len() || wanted(**step);
    steps.iter().enumerate().filter(is_chosen).map(|(_, step)| *step).collect()
}

impl Shape {
    /// Samples the states of a scene; `None` where there is none.
    pub fn new(scene: &Scene, states: &[FrameAt]) -> Option<Self> {
        let finest = states.iter().max_by_key(|at| at.state.mesh.elements().count())?;
        let shells = ShellsOfState::new(scene, &finest.state);
        let most = MOST_POINTS / scene.shell_count();
        let grids: Vec<[Vec<f64>; 2]> = shells.whole().iter().map(|shell| places(shell.undeformed(), most)).collect();
        let offered = offered(scene);
        let sampled: Vec<Sampled> = states.iter().map(|at| Sampled::new(scene, &at.state, &grids, &offered)).collect();
        let coordinates =
            |c: usize| sampled.iter().flat_map(move |frame| frame.points.iter().map(move |point| point[c]));
        let bounds = [0, 1, 2].map(|c| number_range(coordinates(c)));
        let ranges: Vec<[f64; 2]> = (0..offered.len())
            .map(|index| number_range(sampled.iter().flat_map(|frame| frame.values[index].iter().copied())))
            .collect();
        let has_blanks: Vec<bool> = (0..offered.len())
            .map(|index| sampled.iter().any(|frame| frame.values[index].iter().any(|value| value.is_nan())))
            .collect();
        let pack_points =
            |points: &[[f64; 3]]| packed(points.iter().flat_map(|p| (0..3).map(move |c| (p[c], bounds[c]))), false);
        let pack_values = |index: usize, values: &[f64]| {
            packed(values.iter().map(|value| (*value, ranges[index])), has_blanks[index])
        };
        let frames = states.iter().zip(&sampled).map(|(at, frame)| Frame {
            step: at.step,
            label: at.label.clone(),
            elements: at.state.mesh.elements(),
            points: pack_points(&frame.points),
            values: frame.values.iter().enumerate().map(|(index, values)| pack_values(index, values)).collect(),
            lines: pack_points(&frame.lines),
            line_counts: frame.line_counts.clone(),
        });
        let fields = offered.iter().enumerate().map(|(index, (field, component))| ShownField {
            title: field.title_of(*component),
            means: field.means.to_owned(),
            range: ranges[index],
            has_blanks: has_blanks[index],
        });
        Some(Self {
            counts: grids.iter().map(|grid| grid.each_ref().map(Vec::len)).collect(),
            bounds,
            fields: fields.collect(),
            frames: frames.collect(),
            colours: VIRIDIS.to_vec(),
        })
    }
}

fn offered(scene: &Scene) -> Vec<(Field, Option<usize>)> {
    let fields = fields_of(scene);
    let found = |(name, component): (&str, Option<usize>)| {
        fields.iter().find(|field| field.name == name).map(|field| (field.clone(), component))
    };
    OFFERED.into_iter().filter_map(found).collect()
}

/// Points, values and knot lines of a state, those of one shell after those of another.
struct Sampled {
    points: Vec<[f64; 3]>,
    values: Vec<Vec<f64>>,
    lines: Vec<[f64; 3]>,
    line_counts: Vec<[usize; 2]>,
}

impl Sampled {
    fn new(scene: &Scene, state: &State, grids: &[[Vec<f64>; 2]], offered: &[(Field, Option<usize>)]) -> Self {
        let values = vec![Vec::new(); offered.len()];
        let mut sampled = Self { points: Vec::new(), values, lines: Vec::new(), line_counts: Vec::new() };
        for (shell, grid) in ShellsOfState::new(scene, state).whole().iter().zip(grids) {
            sampled.add(shell, grid, offered);
        }
        sampled
    }

    fn add(&mut self, shell: &WholeShell, [along, across]: &[Vec<f64>; 2], offered: &[(Field, Option<usize>)]) {
        let position = |at: [f64; 2]| mid_surface_point(shell.deformed(), &[], at).position;
        let each = || along.iter().flat_map(|u| across.iter().map(|v| [*u, *v]));
        let field_points: Vec<WholePoint> = each().map(|at| shell.at(at)).collect();
        for ((field, component), values) in offered.iter().zip(&mut self.values) {
            let of = |value: [f64; 3]| component.map_or_else(|| norm(value), |index| value[index]);
            values.extend(field_points.iter().map(|point| of(point.value(field))));
        }
        let knots = [0, 1].map(|direction| divided(shell.undeformed(), direction, 1));
        let along_v = knots[0].iter().flat_map(|u| across.iter().map(|v| [*u, *v]));
        let along_u = knots[1].iter().flat_map(|v| along.iter().map(|u| [*u, *v]));
        self.points.extend(each().map(position));
        self.lines.extend(along_v.chain(along_u).map(position));
        self.line_counts.push(knots.each_ref().map(Vec::len));
    }
}

/// Parameters of the points of a whole shell: every element of the mesh, divided so that there are at most so many, as far as lines
/// of elements allow.
fn places(mesh: &Patch, most: usize) -> [Vec<f64>; 2] {
    let counts = mesh.element_counts();
    let parts = (1..=8).rev().find(|parts| counts.iter().map(|count| count * parts + 1).product::<usize>() <= most);
    [0, 1].map(|direction| {
        let all = divided(mesh, direction, parts.unwrap_or(1));
        let stride = all.len().div_ceil(MOST_POINTS / 20).max(1);
        let last = all.len() - 1;
        all.into_iter()
            .enumerate()
            .filter(|(index, _)| index % stride == 0 || *index == last)
            .map(|(_, at)| at)
            .collect()
    })
}

/// The ends of the elements in a direction and points that divide each into so many parts.
fn divided(mesh: &Patch, direction: usize, parts: usize) -> Vec<f64> {
    let bounds = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
    let inner =
        bounds.iter().flat_map(|[from, to]| (1..=parts).map(move |k| from + (to - from) * k as f64 / parts as f64));
    bounds.first().map(|[from, _]| *from).into_iter().chain(inner).collect()
}

/// Numbers as 16 bits over their ranges, little-endian, in base64; with blanks, what is no number is [`BLANK`].
fn packed(values: impl Iterator<Item = (f64, [f64; 2])>, has_blanks: bool) -> String {
    let most = if has_blanks { BLANK - 1 } else { u16::MAX };
    let bits = |(value, [low, high]): (f64, [f64; 2])| {
        let share = if high > low { (value - low) / (high - low) } else { 0.0 };
        if value.is_nan() { BLANK } else { (share * f64::from(most)).round() as u16 }
    };
    let bytes: Vec<u8> = values.flat_map(|value| bits(value).to_le_bytes()).collect();
    base64(&bytes)
}
