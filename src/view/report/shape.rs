//! The deformed shell over the load steps: points of the whole shell on one grid for all frames, the knot lines of each frame's
//! mesh, and fields. Numbers are packed as 16 bits over their range, which is finer than a screen.

use serde::Serialize;

use crate::scene::Scene;
use crate::shell::norm;
use crate::spline::{Mesh, Spans, mid_surface_point};
use crate::state::State;
use crate::view::colour::VIRIDIS;
use crate::view::export::base64;
use crate::view::fields::{Field, ShellFields, fields_of};

/// Most points of the whole shell in a frame.
const MOST_POINTS: usize = 4000;
/// Most frames.
const MOST_FRAMES: usize = 40;
/// Fields that the page offers, by name and component; that without a component is the length of the vector.
const OFFERED: [(&str, Option<usize>); 6] = [
    ("bending_strain_max", Some(0)),
    ("displacement", None),
    ("membrane_force_principal", Some(0)),
    ("membrane_force_principal", Some(1)),
    ("bending_moment_principal", Some(0)),
    ("energy_density", Some(0)),
];

/// The deformed shell over the load steps.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    /// Points along u and v.
    counts: [usize; 2],
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
}

/// The shell at the end of a load step.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    step: u64,
    label: String,
    elements: [usize; 2],
    /// Coordinates of the points, the second direction fastest.
    points: String,
    /// Values at the points, field by field.
    values: Vec<String>,
    /// Coordinates of the knot lines: all lines of one u, then those of one v.
    lines: String,
    /// Number of knot lines of one u, and of one v.
    line_counts: [usize; 2],
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

/// A line of points in one direction: parameters, and whether they are images in the plane of symmetry.
type Places = Vec<(f64, bool)>;

impl Shape {
    /// Samples the states of a scene; `None` where there is none.
    pub fn new(scene: &Scene, states: &[FrameAt]) -> Option<Self> {
        let finest = states.iter().max_by_key(|at| at.state.mesh.element_counts().iter().product::<usize>())?;
        let grid = places(scene, &finest.state.mesh);
        let offered = offered(scene);
        let sampled: Vec<Sampled> = states.iter().map(|at| Sampled::new(scene, &at.state, &grid, &offered)).collect();
        let coordinates =
            |c: usize| sampled.iter().flat_map(move |frame| frame.points.iter().map(move |point| point[c]));
        let bounds = [0, 1, 2].map(|c| range(coordinates(c)));
        let ranges: Vec<[f64; 2]> = (0..offered.len())
            .map(|index| range(sampled.iter().flat_map(|frame| frame.values[index].iter().copied())))
            .collect();
        let pack_points =
            |points: &[[f64; 3]]| packed(points.iter().flat_map(|p| (0..3).map(move |c| (p[c], bounds[c]))));
        let frames = states.iter().zip(&sampled).map(|(at, frame)| Frame {
            step: at.step,
            label: at.label.clone(),
            elements: at.state.mesh.element_counts(),
            points: pack_points(&frame.points),
            values: frame.values.iter().zip(&ranges).map(|(v, range)| packed(v.iter().map(|v| (*v, *range)))).collect(),
            lines: pack_points(&frame.lines),
            line_counts: frame.line_counts,
        });
        let fields = offered.iter().zip(&ranges).map(|((field, component), range)| ShownField {
            title: field.title_of(*component),
            means: field.means.to_owned(),
            range: *range,
        });
        Some(Self {
            counts: grid.each_ref().map(Vec::len),
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

/// Points, values and knot lines of a state.
struct Sampled {
    points: Vec<[f64; 3]>,
    values: Vec<Vec<f64>>,
    lines: Vec<[f64; 3]>,
    line_counts: [usize; 2],
}

impl Sampled {
    fn new(scene: &Scene, state: &State, grid: &[Places; 2], offered: &[(Field, Option<usize>)]) -> Self {
        let fields = ShellFields::new(scene, state);
        let plane = symmetry_plane(state);
        let position = |u: &(f64, bool), v: &(f64, bool)| {
            let [mut x, mut y, z] = mid_surface_point(&state.mesh, &state.displacement, [u.0, v.0]).position;
            if u.1 {
                x = 2.0 * plane - x;
            }
            if v.1 {
                y = -y;
            }
            [x, y, z]
        };
        let [along, across] = grid;
        let each = || along.iter().flat_map(|u| across.iter().map(move |v| (u, v)));
        let value = |field: &Field, component: Option<usize>, u: &(f64, bool), v: &(f64, bool)| {
            let value = fields.value(field, [u.0, v.0]);
            // Components that the page offers are the same in images.
            component.map_or_else(|| norm(value), |index| value[index])
        };
        let knots = [0, 1].map(|direction| knot_places(scene, &state.mesh, direction));
        let along_v = knots[0].iter().flat_map(|u| across.iter().map(move |v| (u, v)));
        let along_u = knots[1].iter().flat_map(|v| along.iter().map(move |u| (u, v)));
        Self {
            points: each().map(|(u, v)| position(u, v)).collect(),
            values: offered
                .iter()
                .map(|(field, component)| each().map(|(u, v)| value(field, *component, u, v)).collect())
                .collect(),
            lines: along_v.chain(along_u).map(|(u, v)| position(u, v)).collect(),
            line_counts: knots.each_ref().map(Vec::len),
        }
    }
}

/// x of the plane that the model ends at, mm: where its last row of points stands.
fn symmetry_plane(state: &State) -> f64 {
    const SAMPLES: usize = 5;
    let at = |k: usize| {
        mid_surface_point(&state.mesh, &state.displacement, [1.0, k as f64 / (SAMPLES - 1) as f64]).position[0]
    };
    (0..SAMPLES).map(at).sum::<f64>() / SAMPLES as f64
}

/// Parameters of the points of the whole shell: every element of the mesh, divided so that there are not too many.
fn places(scene: &Scene, mesh: &Mesh) -> [Places; 2] {
    let cuts = scene.symmetry.cuts();
    let counts = mesh.element_counts();
    let whole = [0, 1].map(|direction| counts[direction] * (1 + usize::from(cuts[direction])));
    let parts =
        (1..=8).rev().find(|parts| whole.iter().map(|count| count * parts + 1).product::<usize>() <= MOST_POINTS);
    let parts = parts.unwrap_or(1);
    [0, 1].map(|direction| {
        let bounds = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
        let inner =
            bounds.iter().flat_map(|[from, to]| (1..=parts).map(move |k| from + (to - from) * k as f64 / parts as f64));
        let own: Vec<f64> = bounds.first().map(|[from, _]| *from).into_iter().chain(inner).collect();
        let stride = own.len().div_ceil(MOST_POINTS / 20).max(1);
        let last = own.len() - 1;
        let kept = own.iter().enumerate().filter(|(index, _)| index % stride == 0 || *index == last).map(|(_, p)| *p);
        completed(kept.collect(), direction, cuts[direction])
    })
}

fn knot_places(scene: &Scene, mesh: &Mesh, direction: usize) -> Places {
    let bounds = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
    let knots = bounds.first().map(|[from, _]| *from).into_iter().chain(bounds.iter().map(|[_, to]| *to)).collect();
    completed(knots, direction, scene.symmetry.cuts()[direction])
}

/// Parameters with their images: along the length the images follow, across they come before.
fn completed(own: Vec<f64>, direction: usize, cut: bool) -> Places {
    let own: Places = own.into_iter().map(|parameter| (parameter, false)).collect();
    let image = |(parameter, _): &(f64, bool)| (*parameter, true);
    match (cut, direction) {
        (false, _) => own,
        (true, 0) => own.iter().copied().chain(own.iter().rev().skip(1).map(image)).collect(),
        (true, _) => own.iter().skip(1).rev().map(image).chain(own.iter().copied()).collect(),
    }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// Numbers as 16 bits over their ranges, little-endian, in base64.
fn packed(values: impl Iterator<Item = (f64, [f64; 2])>) -> String {
    let bits = |(value, [low, high]): (f64, [f64; 2])| {
        let share = if high > low { (value - low) / (high - low) } else { 0.0 };
        (share * f64::from(u16::MAX)).round() as u16
    };
    let bytes: Vec<u8> = values.flat_map(|value| bits(value).to_le_bytes()).collect();
    base64(&bytes)
}
