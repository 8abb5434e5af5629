//! The deformed mesh after every equilibrium as `foxglove.SceneUpdate` messages, for the 3D panel of a viewer: the
//! surface coloured by bending strain, knot lines on top, and the range of the colours in words. Written as JSON, which any
//! reader can read without generated code, with the official schema, `scene_update.schema.json` (npm package `@foxglove/schemas`
//! 2.1.0, MIT licence).

use std::sync::Arc;

use serde_json::{Value, json};

use super::colour::Colour;
use super::deformed_surface::deformed_surface;
use super::samples::SurfaceSamples;
use crate::journal::{ViewerMessage, ViewerTopic, ViewerTopics};
use crate::record::{Outcome, Record};
use crate::scene::Scene;
use crate::state::State;

/// Topic of the messages with deformed meshes.
pub const MESH_HISTORY_TOPIC: &str = "/foldline/scene";
const SCHEMA: &[u8] = include_bytes!("scene_update.schema.json");
/// Cells of a picture for each element, each way.
const CELLS_PER_ELEMENT: usize = 2;
/// Bending strain at the bright end of the colours, in units of 1/R: a fold has 1.
const BRIGHTEST: f64 = 1.1;

/// A source of viewer messages that show the deformed mesh after each stage that ends in an equilibrium.
#[derive(Debug)]
pub struct MeshHistory {
    scene: Scene,
    topic: Arc<ViewerTopic>,
}

impl MeshHistory {
    /// Creates the source of messages for a run of this scene.
    pub fn new(scene: &Scene) -> Self {
        let topic = ViewerTopic {
            topic: MESH_HISTORY_TOPIC.to_string(),
            message_encoding: "json".to_string(),
            schema_name: "foxglove.SceneUpdate".to_string(),
            schema_encoding: "jsonschema".to_string(),
            schema: SCHEMA.to_vec(),
        };
        Self { scene: scene.clone(), topic: Arc::new(topic) }
    }
}

impl ViewerTopics for MeshHistory {
    fn messages(&mut self, state: &State, record: &Record) -> Vec<ViewerMessage> {
        let report = &record.report;
        let moved = report.outcome == Outcome::Done && report.stage.finds_equilibrium();
        if !moved {
            return Vec::new();
        }
        // A state in a log is finite, so samples of it are too; a picture is no reason to stop a run.
        let samples = deformed_surface(&self.scene, &state.mesh, &state.displacement, CELLS_PER_ELEMENT);
        let update = samples.map(|samples| scene_update(&samples, &self.scene));
        let message =
            |update: Value| ViewerMessage { topic: self.topic.clone(), data: update.to_string().into_bytes() };
        update.into_iter().map(message).collect()
    }
}

/// One entity, which replaces that of the state before.
fn scene_update(samples: &SurfaceSamples, scene: &Scene) -> Value {
    let values = vertex_values(samples);
    // A tape spring keeps its colours from state to state; other shells have no curvature to measure by.
    let radius_mm = match scene.geometry {
        crate::scene::Geometry::TapeSpring { radius_mm, .. } => radius_mm,
        _ => BRIGHTEST / values.iter().copied().fold(f64::MIN_POSITIVE, f64::max),
    };
    let colours: Vec<Value> = values
        .iter()
        .map(|value| {
            let [r, g, b] = Colour::viridis(value * radius_mm / BRIGHTEST).0.map(short);
            json!({"r": r, "g": g, "b": b, "a": 1.0})
        })
        .collect();
    let indices: Vec<usize> = samples.cells().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let pose =
        json!({"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}});
    let black = json!({"r": 0.0, "g": 0.0, "b": 0.0, "a": 0.6});
    let none: [Value; 0] = [];
    // Type 0: a line through all points.
    let line = |line: &Vec<[f64; 3]>| {
        json!({
            "type": 0,
            "pose": pose,
            "thickness": 1.0,
            "scale_invariant": true,
            "points": line.iter().map(|p| point(*p)).collect::<Vec<_>>(),
            "color": black,
            "colors": none,
            "indices": none,
        })
    };
    let lines: Vec<Value> = samples.knot_lines.iter().map(line).collect();
    let corner = [0, 1, 2].map(|c| samples.points.iter().map(|p| p[c]).fold(f64::MIN, f64::max));
    let legend = json!({
        "pose": {"position": point(corner), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}},
        "billboard": true,
        "font_size": 14.0,
        "scale_invariant": true,
        "color": {"r": 0.5, "g": 0.5, "b": 0.5, "a": 1.0},
        "text": format!("{}: 0 to {:.3e}", samples.quantity, BRIGHTEST / radius_mm),
    });
    json!({
        "deletions": none,
        "entities": [{
            "timestamp": {"sec": 0, "nsec": 0},
            "frame_id": "shell",
            "id": "shell",
            "lifetime": {"sec": 0, "nsec": 0},
            "frame_locked": false,
            "metadata": [{"key": "colour", "value": samples.quantity}, {"key": "unit of length", "value": "mm"}],
            "arrows": none, "cubes": none, "spheres": none, "cylinders": none, "texts": [legend], "models": none,
            "triangles": [{
                "pose": pose,
                "points": samples.points.iter().map(|p| point(*p)).collect::<Vec<_>>(),
                "color": black,
                "colors": colours,
                "indices": indices,
            }],
            "lines": lines,
        }],
    })
}

/// Mean of the cells around each point.
fn vertex_values(samples: &SurfaceSamples) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); samples.points.len()];
    for (corners, value) in samples.cells().zip(&samples.cell_values).filter(|(_, value)| value.is_finite()) {
        for corner in corners {
            sums[corner].0 += value;
            sums[corner].1 += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect()
}

fn point([x, y, z]: [f64; 3]) -> Value {
    json!({"x": short(x), "y": short(y), "z": short(z)})
}

/// Three decimals: a micrometre, or a shade that nobody sees.
fn short(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
