//! A surface as a `foxglove.SceneUpdate` message, for the 3D panel of a viewer: faces coloured by a quantity, knot lines on top, and the
//! range of the colours in words.

use serde::Serialize;

use super::Timestamp;
use crate::view::SurfaceSamples;
use crate::view::colour::Colour;
use crate::view::samples::number_range;

/// A surface with values on its points, and the values at the dark and the bright end of the colours.
pub(super) struct Coloured {
    samples: SurfaceSamples,
    values: Vec<f64>,
    pub(super) range: [f64; 2],
}

impl Coloured {
    /// Colours a surface over the range of its own values.
    pub(super) fn new(samples: SurfaceSamples) -> Self {
        let values = vertex_values(&samples);
        let range = number_range(values.iter().copied());
        Self { samples, values, range }
    }
}

/// Mean of the cells around each point; no number where none of them has a value.
fn vertex_values(samples: &SurfaceSamples) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); samples.points.len()];
    for (corners, value) in samples.cells().zip(&samples.cell_values).filter(|(_, value)| value.is_finite()) {
        for corner in corners {
            sums[corner].0 += value;
            sums[corner].1 += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { f64::NAN }).collect()
}

/// One entity, which replaces that of the state before.
pub(super) fn scene_update(coloured: &Coloured, time_ns: u64) -> SceneUpdate {
    let Coloured { samples, values, range: [low, high] } = coloured;
    let width = (high - low).max(f64::MIN_POSITIVE);
    let colour = |value: &f64| {
        let [r, g, b] = Colour::viridis((value - low) / width).0.map(short);
        Rgba { r, g, b, a: 1.0 }
    };
    let line = |line: &Vec<[f64; 3]>| Line {
        kind: LINE_STRIP,
        pose: Pose::default(),
        thickness: 1.0,
        scale_invariant: true,
        points: line.iter().copied().map(Point::from).collect(),
        color: BLACK,
        colors: [],
        indices: [],
    };
    let corner = [0, 1, 2].map(|c| samples.points.iter().map(|p| p[c]).fold(f64::MIN, f64::max));
    let legend = Text {
        pose: Pose { position: corner.into(), ..Pose::default() },
        billboard: true,
        font_size: 14.0,
        scale_invariant: true,
        color: Rgba { r: 0.5, g: 0.5, b: 0.5, a: 1.0 },
        text: format!("{}: {} to {}", samples.quantity, scientific(*low), scientific(*high)),
    };
    let entity = Entity {
        timestamp: Timestamp::of_ns(time_ns),
        frame_id: "shell",
        id: "shell",
        lifetime: Timestamp::of_ns(0),
        frame_locked: false,
        metadata: [
            KeyValue { key: "colour", value: samples.quantity.clone() },
            KeyValue { key: "unit of length", value: "mm".to_owned() },
        ],
        arrows: [],
        cubes: [],
        spheres: [],
        cylinders: [],
        texts: [legend],
        models: [],
        triangles: [Triangles {
            pose: Pose::default(),
            points: samples.points.iter().copied().map(Point::from).collect(),
            color: BLACK,
            colors: values.iter().map(colour).collect(),
            indices: samples.cells().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect(),
        }],
        lines: samples.knot_lines.iter().map(line).collect(),
    };
    SceneUpdate { deletions: [], entities: [entity] }
}

/// A value in few digits, 0 as such.
fn scientific(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.3e}") }
}

/// Three decimals: a micrometre, or a shade that nobody sees.
fn short(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// A line through all points.
const LINE_STRIP: u8 = 0;
const BLACK: Rgba = Rgba { r: 0.0, g: 0.0, b: 0.0, a: 0.6 };

/// What a message has none of.
type Nothing = [u8; 0];

#[derive(Serialize)]
pub(super) struct SceneUpdate {
    deletions: Nothing,
    entities: [Entity; 1],
}

#[derive(Serialize)]
struct Entity {
    timestamp: Timestamp,
    frame_id: &'static str,
    id: &'static str,
    lifetime: Timestamp,
    frame_locked: bool,
    metadata: [KeyValue; 2],
    arrows: Nothing,
    cubes: Nothing,
    spheres: Nothing,
    cylinders: Nothing,
    lines: Vec<Line>,
    triangles: [Triangles; 1],
    texts: [Text; 1],
    models: Nothing,
}

#[derive(Serialize)]
struct KeyValue {
    key: &'static str,
    value: String,
}

#[derive(Serialize)]
struct Line {
    #[serde(rename = "type")]
    kind: u8,
    pose: Pose,
    thickness: f64,
    scale_invariant: bool,
    points: Vec<Point>,
    color: Rgba,
    colors: Nothing,
    indices: Nothing,
}

#[derive(Serialize)]
struct Triangles {
    pose: Pose,
    points: Vec<Point>,
    color: Rgba,
    colors: Vec<Rgba>,
    indices: Vec<usize>,
}

#[derive(Serialize)]
struct Text {
    pose: Pose,
    billboard: bool,
    font_size: f64,
    scale_invariant: bool,
    color: Rgba,
    text: String,
}

#[derive(Default, Serialize)]
struct Pose {
    position: Point,
    orientation: Quaternion,
}

#[derive(Default, Serialize)]
struct Point {
    x: f64,
    y: f64,
    z: f64,
}

impl From<[f64; 3]> for Point {
    fn from(point: [f64; 3]) -> Self {
        let [x, y, z] = point.map(short);
        Self { x, y, z }
    }
}

#[derive(Serialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

#[derive(Clone, Copy, Serialize)]
struct Rgba {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}
