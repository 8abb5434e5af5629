//! A NURBS surface as the user gives it: in the scene, or in a file of its own.

use super::data::NurbsPatch;
use super::fault::Checked;
use super::keys::number;
use super::table::{Table, data};
use crate::spline::{Grid, KnotFlaw, check_knots, control_count};

/// Size of the largest scene file, and of the largest file of a surface, bytes: a log holds the one with the other, and
/// reads no larger ones.
pub const SCENE_BYTES_LIMIT: u64 = 8 << 20;

/// Knots that differ by less than this share of their range are meant to be one: text of six digits does not say more, and
/// elements so short leave nothing of the digits of a displacement.
const NEAR: f64 = 1e-5;

/// The keys of a surface in a file of its own.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct NurbsFile {
    degrees: [usize; 2],
    knots_u: Vec<f64>,
    knots_v: Vec<f64>,
    control_points_mm: Vec<[f64; 3]>,
    #[serde(default)]
    weights: Vec<f64>,
}

/// A geometry of kind `nurbs`.
pub(super) fn nurbs(table: &Table, folder: &std::path::Path) -> Checked<NurbsPatch> {
    let file = match table.get::<Option<String>>("file") {
        None => {
            let keys = ["degrees", "knots_u", "knots_v", "control_points_mm", "weights"];
            let given = table.values.iter().filter(|(name, _)| keys.contains(&name.as_str()));
            data(&table.title, given.map(|(name, value)| (name.clone(), value.clone())).collect())
        }
        Some(_) if table.place_of("weights").is_some() => {
            let remedy = "take `weights` out, or write them into the file";
            return Err(table.wrong_at("weights", "the surface is in a file, and so are its weights", remedy));
        }
        Some(name) => read(&folder.join(name)).map_err(|problem| {
            table.wrong_at("file", problem, "the path is relative to the scene file; the file is a JSON object with the keys degrees, knots_u, knots_v, control_points_mm, weights")
        })?,
    };
    let mut patch = NurbsPatch {
        degrees: file.degrees,
        knots_u: file.knots_u,
        knots_v: file.knots_v,
        control_points_mm: file.control_points_mm,
        weights: file.weights,
        seam: table.get("seam"),
    };
    if patch.weights.is_empty() {
        patch.weights = vec![1.0; patch.control_points_mm.len()];
    }
    sound(&patch).map_err(|Unsound { key, problem, remedy }| {
        table.wrong(table.place_of("file").or(table.place_of(key)).as_ref(), problem, remedy)
    })?;
    Ok(patch)
}

/// Reads a surface from a file of its own; why it cannot be read otherwise.
fn read(path: &std::path::Path) -> Result<NurbsFile, String> {
    let text = read_text(path)?;
    serde_json::from_str(&text).map_err(|error| format!("{} cannot be read: {error}", path.display()))
}

/// Reads a file that a scene names; why it cannot be read otherwise.
pub(super) fn read_text(path: &std::path::Path) -> Result<String, String> {
    let wrong = |error: String| format!("{} cannot be read: {error}", path.display());
    match std::fs::metadata(path) {
        // A device or a pipe may never end.
        Ok(found) if !found.is_file() => return Err(wrong("it is no regular file".into())),
        Ok(found) if found.len() > SCENE_BYTES_LIMIT => {
            let bytes = found.len();
            return Err(wrong(format!("it has {bytes} bytes, and no more than {SCENE_BYTES_LIMIT} are taken")));
        }
        _ => {}
    }
    let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    // Some programs put a byte-order mark in front.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Why a patch is no tensor-product surface.
struct Unsound {
    /// The key that is most likely wrong.
    key: &'static str,
    problem: String,
    remedy: String,
}

impl Unsound {
    fn new(key: &'static str, problem: String, remedy: impl Into<String>) -> Self {
        Self { key, problem, remedy: remedy.into() }
    }
}

const CLAMPED: &str = "knots are ascending and clamped: the first and the last occur degree + 1 times";

fn sound(patch: &NurbsPatch) -> Result<(), Unsound> {
    sound_knots("u", "knots_u", &patch.knots_u, patch.degrees[0])?;
    sound_knots("v", "knots_v", &patch.knots_v, patch.degrees[1])?;
    let counts = [(&patch.knots_u, patch.degrees[0]), (&patch.knots_v, patch.degrees[1])]
        .map(|(knots, degree)| control_count(knots, degree));
    let expected = Grid::new(counts).len();
    if patch.control_points_mm.len() != expected {
        return Err(Unsound::new(
            "control_points_mm",
            format!("the knots ask for {expected} control points, and there are {}", patch.control_points_mm.len()),
            format!(
                "each direction has as many as it has knots, less degree and 1: {} in u times {} in v",
                counts[0], counts[1]
            ),
        ));
    }
    if patch.weights.len() != expected {
        let problem = format!("there are {expected} control points and {} weights", patch.weights.len());
        return Err(Unsound::new("weights", problem, "each control point has one weight, in the same order"));
    }
    if let Some(index) = patch.weights.iter().position(|weight| !(weight.is_finite() && *weight > 0.0)) {
        return Err(Unsound::new(
            "weights",
            format!("weight {} is {}, and weights are positive", index + 1, number(patch.weights[index])),
            "a weight of 1 is that of an ordinary control point; take `weights` out where the surface is not rational",
        ));
    }
    if let Some(index) = patch.control_points_mm.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        let problem = format!("control point {} is not finite", index + 1);
        return Err(Unsound::new("control_points_mm", problem, "coordinates are numbers in mm"));
    }
    Ok(())
}

fn sound_knots(name: &str, key: &'static str, knots: &[f64], degree: usize) -> Result<(), Unsound> {
    let wrong = |problem: String| Err(Unsound::new(key, problem, CLAMPED));
    if !(1..=5).contains(&degree) {
        let problem = format!("degree {degree} in {name} is not offered: 1 to 5 are");
        return Err(Unsound::new("degrees", problem, "write a surface of a higher degree as one of degree 5 or less"));
    }
    let Err(flaw) = check_knots(knots, degree, NEAR) else { return Ok(()) };
    match flaw {
        KnotFlaw::Few { least } => {
            wrong(format!("{} knots in {name} are too few for degree {degree}: at least {least}", knots.len()))
        }
        KnotFlaw::NotFinite { index } => wrong(format!("knot {} in {name} is not a finite number", index + 1)),
        KnotFlaw::Descending { index } => wrong(format!(
            "the knots in {name} do not ascend: {} comes after {}",
            number(knots[index]),
            number(knots[index - 1])
        )),
        KnotFlaw::TooNear { pair: [one, other], share } => {
            let problem = format!(
                "the knots {one} and {other} in {name} are neither equal nor apart: they differ by {share:.1e} of the range"
            );
            let remedy = format!("write the same number for both, or put them apart by {NEAR:e} of the range or more");
            Err(Unsound::new(key, problem, remedy))
        }
        KnotFlaw::NotClamped { knot, times } => wrong(format!(
            "the knots in {name} are not clamped: {} occurs {times} times at an end, not {}",
            number(knot),
            degree + 1
        )),
        KnotFlaw::Tears { knot, times } => Err(Unsound::new(
            key,
            format!("knot {} in {name} occurs {times} times: the surface would tear", number(knot)),
            format!("inside, a knot occurs at most as often as the degree: {degree} times"),
        )),
    }
}
