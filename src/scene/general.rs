//! Tables of scenes other than the tape spring with turning ends: geometry, material and load of other kinds, and the
//! arrays of tables `[[ply]]`, `[[support]]`, `[[action]]` and `[[probe]]`.

use super::data::{
    Action, ActionKind, Axis, Component, Edge, Geometry, History, Hold, Load, LoadSteps, Material, Motion, NurbsPatch,
    OrthotropicLaw, ParametricDirection, Place, Ply, Probe, ProbeKind, Reaction, Seam, Support,
};
use super::error::Checked;
use super::table::{ANY, LENGTH, Range, Table};

/// Kinds of geometry that are read here.
pub(super) const GEOMETRIES: [&str; 5] = ["plate", "cylinder-panel", "annulus", "sphere-zone", "nurbs"];
/// Kinds of material that are read here.
pub(super) const MATERIALS: [&str; 2] = ["orthotropic", "laminate"];
/// Kinds of load that are read here.
pub(super) const LOADS: [&str; 1] = ["steps"];
/// Arrays of tables.
pub(super) const ARRAYS: [&str; 4] = ["ply", "support", "action", "probe"];

const ARC: Range = Range { above: 0.0, most: 360.0, reason: "an arc is more than 0 and at most 360 degrees" };
const EXPANSION: Range = Range {
    above: -1e-3,
    most: 1e-3,
    reason: "a strain per kelvin, such as 22.5e-6 across the fibres of carbon in epoxy",
};
const MODULUS: Range = Range { above: 0.0, most: 1e13, reason: "moduli are positive, in MPa" };

/// A geometry of one of [`GEOMETRIES`].
pub(super) fn geometry(table: Table<'_, '_>, folder: &std::path::Path) -> Checked<Geometry> {
    let kinds = GEOMETRIES.map(|kind| (kind, kind));
    let kind = table.word("kind", &kinds)?;
    let geometry = match kind {
        "plate" => Geometry::Plate {
            length_mm: table.number("length_mm", LENGTH, "100.0")?,
            width_mm: table.number("width_mm", LENGTH, "50.0")?,
        },
        "cylinder-panel" => {
            let arc_deg = table.number("arc_deg", ARC, "90.0")?;
            Geometry::CylinderPanel {
                length_mm: table.number("length_mm", LENGTH, "100.0")?,
                radius_mm: table.number("radius_mm", LENGTH, "50.0")?,
                arc_deg,
                seam: seam(&table, arc_deg)?,
            }
        }
        "annulus" => {
            let arc_deg = table.number("arc_deg", ARC, "360.0")?;
            let inner_radius_mm = table.number("inner_radius_mm", LENGTH, "6.0")?;
            let outer_radius_mm = table.number("outer_radius_mm", LENGTH, "10.0")?;
            if inner_radius_mm >= outer_radius_mm {
                let problem =
                    format!("the inner radius, {inner_radius_mm} mm, is not below the outer, {outer_radius_mm} mm");
                return Err(table.wrong(table.place_of("inner_radius_mm").as_ref(), problem, "exchange them"));
            }
            Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, seam: seam(&table, arc_deg)? }
        }
        "sphere-zone" => {
            let arc_deg = table.number("arc_deg", ARC, "90.0")?;
            let latitude_deg: [f64; 2] = table.tuple("latitude_deg", "[0.0, 72.0]")?;
            let [from, to] = latitude_deg;
            if !(-90.0 < from && from < to && to < 90.0) {
                let problem = format!("latitudes from {from} to {to} degrees are no zone");
                let remedy = "they must grow, and lie between the poles: at a pole (90 degrees) an edge would collapse to a point; leave a small hole";
                return Err(table.wrong(table.place_of("latitude_deg").as_ref(), problem, remedy));
            }
            let radius_mm = table.number("radius_mm", LENGTH, "10.0")?;
            Geometry::SphereZone { radius_mm, latitude_deg, arc_deg, seam: seam(&table, arc_deg)? }
        }
        _ => Geometry::Nurbs(nurbs(&table, folder)?),
    };
    table.finish()?;
    Ok(geometry)
}

fn seam(table: &Table<'_, '_>, arc_deg: f64) -> Checked<Option<Seam>> {
    let given = table.maybe_word("seam", &[("smooth", Seam::Smooth), ("free", Seam::Free)])?;
    match (given, arc_deg == 360.0) {
        (None, true) => Err(table.wrong(
            None,
            "`seam` is missing, and a full turn meets itself",
            "write `seam = \"smooth\"` for a closed shell, or `seam = \"free\"` for one that is slit",
        )),
        (Some(_), false) => Err(table.wrong(
            table.place_of("seam").as_ref(),
            format!("an arc of {arc_deg} degrees does not meet itself: it has no seam"),
            "leave `seam` out, or write `arc_deg = 360.0`",
        )),
        (given, _) => Ok(given),
    }
}

/// The keys of a NURBS surface in a file of its own.
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

fn nurbs(table: &Table<'_, '_>, folder: &std::path::Path) -> Checked<NurbsPatch> {
    let file = match table.maybe_text("file")? {
        Some(name) => {
            let path = folder.join(&name);
            let wrong = |error: String| {
                let problem = format!("{} cannot be read: {error}", path.display());
                table.wrong(table.place_of("file").as_ref(), problem, "the path is relative to the scene file; the file is a JSON object with the keys degrees, knots_u, knots_v, control_points_mm, weights")
            };
            let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
            serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?
        }
        None => {
            let degrees: [f64; 2] = table.tuple("degrees", "[1, 2]")?;
            let missing = |name: &str| {
                table.wrong(
                    None,
                    format!("`{name}` is missing"),
                    "a nurbs surface has degrees, knots_u, knots_v, control_points_mm and, if it is rational, weights",
                )
            };
            NurbsFile {
                degrees: degrees.map(|degree| degree.max(0.0) as usize),
                knots_u: table.maybe_numbers("knots_u")?.ok_or_else(|| missing("knots_u"))?,
                knots_v: table.maybe_numbers("knots_v")?.ok_or_else(|| missing("knots_v"))?,
                control_points_mm: table
                    .maybe_rows("control_points_mm", "[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]")?
                    .ok_or_else(|| missing("control_points_mm"))?,
                weights: table.maybe_numbers("weights")?.unwrap_or_default(),
            }
        }
    };
    let mut patch = NurbsPatch {
        degrees: file.degrees,
        knots_u: file.knots_u,
        knots_v: file.knots_v,
        control_points_mm: file.control_points_mm,
        weights: file.weights,
    };
    if patch.weights.is_empty() {
        patch.weights = vec![1.0; patch.control_points_mm.len()];
    }
    sound(&patch).map_err(|problem| {
        table.wrong(None, problem, "knots are ascending and clamped: the first and the last stand degree + 1 times")
    })?;
    Ok(patch)
}

/// Whether a patch is a tensor-product surface.
fn sound(patch: &NurbsPatch) -> Result<(), String> {
    let mut expected = 1;
    for (name, knots, degree) in [("u", &patch.knots_u, patch.degrees[0]), ("v", &patch.knots_v, patch.degrees[1])] {
        if !(1..=5).contains(&degree) {
            return Err(format!("degree {degree} in {name} is not offered: 1 to 5 are"));
        }
        if knots.len() < 2 * (degree + 1) {
            return Err(format!(
                "{} knots in {name} are too few for degree {degree}: at least {}",
                knots.len(),
                2 * (degree + 1)
            ));
        }
        if knots.iter().any(|knot| !knot.is_finite()) || knots.windows(2).any(|pair| pair[1] < pair[0]) {
            return Err(format!("the knots in {name} are not ascending numbers"));
        }
        let ends = [knots[0], knots[knots.len() - 1]];
        for group in knots.chunk_by(|a, b| a == b) {
            let at_end = ends.contains(&group[0]);
            if at_end && group.len() != degree + 1 {
                return Err(format!(
                    "the knots in {name} are not clamped: {} stands {} times at an end, not {}",
                    group[0],
                    group.len(),
                    degree + 1
                ));
            }
            if !at_end && group.len() > degree {
                return Err(format!(
                    "knot {} in {name} stands {} times: the surface would tear",
                    group[0],
                    group.len()
                ));
            }
        }
        expected *= knots.len() - degree - 1;
    }
    if patch.control_points_mm.len() != expected {
        return Err(format!(
            "the knots ask for {expected} control points, and there are {}",
            patch.control_points_mm.len()
        ));
    }
    if patch.weights.len() != expected {
        return Err(format!("there are {expected} control points and {} weights", patch.weights.len()));
    }
    if patch.weights.iter().any(|weight| !(weight.is_finite() && *weight > 0.0)) {
        return Err("a weight is not a positive number".into());
    }
    if patch.control_points_mm.iter().flatten().any(|x| !x.is_finite()) {
        return Err("a control point is not finite".into());
    }
    Ok(())
}

/// Moduli of one table; what is missing comes from `default`.
fn law(table: &Table<'_, '_>, default: Option<OrthotropicLaw>) -> Checked<OrthotropicLaw> {
    let modulus = |name: &'static str, default: Option<f64>| {
        match (table.maybe_number(name, MODULUS)?, default) {
        (Some(value), _) | (None, Some(value)) => Ok(value),
        (None, None) => Err(table.wrong(None, format!("`{name}` is missing"), "an orthotropic layer has youngs_modulus_1_mpa, youngs_modulus_2_mpa, poissons_ratio_12, shear_modulus_12_mpa")),
    }
    };
    let ratio = Range { above: -10.0, most: 10.0, reason: "Poisson's ratio nu12 is below sqrt(E1/E2) in magnitude" };
    let law = OrthotropicLaw {
        youngs_modulus_1_mpa: modulus("youngs_modulus_1_mpa", default.map(|law| law.youngs_modulus_1_mpa))?,
        youngs_modulus_2_mpa: modulus("youngs_modulus_2_mpa", default.map(|law| law.youngs_modulus_2_mpa))?,
        poissons_ratio_12: match (table.maybe_number("poissons_ratio_12", ratio)?, default) {
            (Some(value), _) => value,
            (None, Some(law)) => law.poissons_ratio_12,
            (None, None) => {
                return Err(table.wrong(
                    None,
                    "`poissons_ratio_12` is missing",
                    "write for example `poissons_ratio_12 = 0.3`",
                ));
            }
        },
        shear_modulus_12_mpa: modulus("shear_modulus_12_mpa", default.map(|law| law.shear_modulus_12_mpa))?,
        thermal_expansion_1_per_k: table
            .maybe_number("thermal_expansion_1_per_k", EXPANSION)?
            .or(default.and_then(|law| law.thermal_expansion_1_per_k)),
        thermal_expansion_2_per_k: table
            .maybe_number("thermal_expansion_2_per_k", EXPANSION)?
            .or(default.and_then(|law| law.thermal_expansion_2_per_k)),
    };
    if law.thermal_expansion_1_per_k.is_some() != law.thermal_expansion_2_per_k.is_some() {
        let (given, other) = match law.thermal_expansion_1_per_k {
            Some(_) => ("thermal_expansion_1_per_k", "thermal_expansion_2_per_k"),
            None => ("thermal_expansion_2_per_k", "thermal_expansion_1_per_k"),
        };
        return Err(table.wrong(
            table.place_of(given).as_ref(),
            format!("`{given}` is given and `{other}` is not"),
            format!("write both; `{other} = 0.0` does not expand that way"),
        ));
    }
    if law.poissons_ratio_12.powi(2) >= law.youngs_modulus_1_mpa / law.youngs_modulus_2_mpa {
        let problem = format!(
            "nu12 = {} is too large for E1/E2 = {}: the layer would have no stiffness",
            law.poissons_ratio_12,
            law.youngs_modulus_1_mpa / law.youngs_modulus_2_mpa
        );
        return Err(table.wrong(
            table.place_of("poissons_ratio_12").as_ref(),
            problem,
            "nu12 squared must be below E1/E2",
        ));
    }
    Ok(law)
}

/// A material of one of [`MATERIALS`].
pub(super) fn material(table: Table<'_, '_>, plies: Vec<Table<'_, '_>>) -> Checked<Material> {
    let kind = table.word("kind", &MATERIALS.map(|kind| (kind, kind)))?;
    if kind == "orthotropic" {
        let material = Material::Orthotropic {
            law: law(&table, None)?,
            angle_deg: table.number_or("angle_deg", ANY, 0.0)?,
            thickness_mm: table.number("thickness_mm", LENGTH, "0.1")?,
            offset_mm: table.number_or("offset_mm", ANY, 0.0)?,
        };
        table.finish()?;
        return no_plies(plies).map(|()| material);
    }
    let offset_mm = table.number_or("offset_mm", ANY, 0.0)?;
    let any = ["youngs_modulus_1_mpa", "youngs_modulus_2_mpa", "poissons_ratio_12", "shear_modulus_12_mpa"];
    let default = if any.iter().any(|name| table.entry(name).is_some()) { Some(law(&table, None)?) } else { None };
    if plies.is_empty() {
        return Err(table.wrong(
            None,
            "a laminate has no plies",
            "add `[[ply]]` tables from bottom to top, each with thickness_mm and angle_deg",
        ));
    }
    table.finish()?;
    let mut laminate = Vec::new();
    for ply in plies {
        laminate.push(Ply {
            thickness_mm: ply.number("thickness_mm", LENGTH, "0.05")?,
            angle_deg: ply.number_or("angle_deg", ANY, 0.0)?,
            law: law(&ply, default)?,
        });
        ply.finish()?;
    }
    Ok(Material::Laminate { plies: laminate, offset_mm })
}

/// Refuses plies that belong to no laminate.
pub(super) fn no_plies(plies: Vec<Table<'_, '_>>) -> Checked<()> {
    match plies.first() {
        Some(ply) => Err(ply.wrong(
            None,
            "plies belong to a laminate",
            "write `kind = \"laminate\"` in [material], or take the [[ply]] tables away",
        )),
        None => Ok(()),
    }
}

/// Steps of the load factor.
pub(super) fn steps(table: Table<'_, '_>) -> Checked<Load> {
    table.word("kind", &[("steps", ())])?;
    let positive = Range { above: 0.0, most: 1e6, reason: "load factors grow from 0" };
    let factor = table.number_or("factor", positive, 1.0)?;
    let increment = table.number("increment", positive, "0.05")?;
    let longest = table.number_or("longest_increment", positive, increment)?;
    let load = LoadSteps {
        factor,
        increment,
        longest_increment: (longest > increment).then_some(longest),
        least_increment: table.number_or("least_increment", positive, 1e-6)?,
        snap_tolerance: table.number_or("snap_tolerance", positive, 1e-3)?,
    };
    if load.increment > load.factor {
        let problem =
            format!("the increment, {}, goes past the load factor at the end, {}", load.increment, load.factor);
        return Err(table.wrong(table.place_of("increment").as_ref(), problem, "make it smaller"));
    }
    if longest < increment {
        let problem = format!("the longest increment, {longest}, is smaller than the increment, {increment}");
        return Err(table.wrong(
            table.place_of("longest_increment").as_ref(),
            problem,
            "make it larger, or take it out",
        ));
    }
    if load.least_increment > load.increment || load.snap_tolerance < load.least_increment {
        let problem = format!(
            "least_increment = {} must be at most the increment ({}) and at most snap_tolerance ({})",
            load.least_increment, load.increment, load.snap_tolerance
        );
        return Err(table.wrong(table.place_of("least_increment").as_ref(), problem, "make it smaller"));
    }
    table.finish()?;
    Ok(Load::Steps(load))
}

/// Where something is: an edge, a point or a line.
fn place(table: &Table<'_, '_>) -> Checked<Place> {
    let remedy = "write an edge (\"u-start\", \"u-end\", \"v-start\", \"v-end\"), a point (`on = [1.0, 0.5]`, fractions of u and v), or a line (`on = \"u=0.5\"`)";
    let Some(entry) = table.entry("on") else { return Err(table.wrong(None, "`on` is missing", remedy)) };
    let at = entry.value_place();
    let Some(text) = entry.value.get_ref().as_str() else {
        let [u, v] = point(table)?;
        return Ok(Place::Point([u, v]));
    };
    let edges = [("u-start", Edge::UStart), ("u-end", Edge::UEnd), ("v-start", Edge::VStart), ("v-end", Edge::VEnd)];
    if let Some((_, edge)) = edges.iter().find(|(name, _)| *name == text) {
        return Ok(Place::Edge(*edge));
    }
    if let Some((direction, value)) = text.split_once('=') {
        let direction = match direction.trim() {
            "u" => Some(ParametricDirection::U),
            "v" => Some(ParametricDirection::V),
            _ => None,
        };
        if let (Some(direction), Ok(value)) = (direction, value.trim().parse::<f64>()) {
            if 0.0 < value && value < 1.0 {
                return Ok(Place::Line(direction, value));
            }
            let remedy = "a line lies strictly between 0 and 1; at 0 and 1 are the edges, such as \"u-start\"";
            return Err(table.wrong(Some(&at), format!("there is no line {text}"), remedy));
        }
    }
    Err(table.wrong(Some(&at), format!("`on` cannot be \"{text}\""), remedy))
}

fn point(table: &Table<'_, '_>) -> Checked<[f64; 2]> {
    let at: [f64; 2] = table.tuple("on", "[1.0, 0.5]")?;
    if at.iter().any(|fraction| !(0.0..=1.0).contains(fraction)) {
        let problem = format!("there is no point ({}, {})", at[0], at[1]);
        return Err(table.wrong(table.place_of("on").as_ref(), problem, "fractions of u and v run from 0 to 1"));
    }
    Ok(at)
}

fn edge(table: &Table<'_, '_>, what: &str) -> Checked<Edge> {
    match place(table)? {
        Place::Edge(edge) => Ok(edge),
        _ => Err(table.wrong(
            table.place_of("on").as_ref(),
            format!("{what} needs a whole edge"),
            "write `on = \"u-start\"`, \"u-end\", \"v-start\" or \"v-end\"",
        )),
    }
}

fn history(table: &Table<'_, '_>) -> Checked<History> {
    let rows: Vec<[f64; 2]> = table.maybe_rows("history", "[[0.0, 0.0], [1.0, 1.0]]")?.unwrap_or_default();
    if rows.windows(2).any(|pair| pair[1][0] <= pair[0][0]) || rows.first().is_some_and(|row| row[0] < 0.0) {
        let remedy = "each row is [load factor, factor]; load factors start at 0 or later and grow from row to row";
        return Err(table.wrong(
            table.place_of("history").as_ref(),
            "the load factors of `history` do not grow",
            remedy,
        ));
    }
    if rows.first().is_some_and(|row| row[0] == 0.0 && row[1] != 0.0) {
        let remedy = "the run starts from the undeformed shell: the factor at load factor 0 must be 0";
        return Err(table.wrong(table.place_of("history").as_ref(), "`history` does not start from rest", remedy));
    }
    Ok(History(rows))
}

/// One `[[support]]`.
pub(super) fn support(table: Table<'_, '_>, ordinal: usize) -> Checked<Support> {
    let name = table.maybe_text("name")?.unwrap_or_else(|| format!("support {ordinal}"));
    let kinds = ["hinged", "fixed", "displacement", "symmetric", "clamped", "rigid"];
    let kind = table.word("kind", &kinds.map(|kind| (kind, kind)))?;
    let zero = Some(0.0);
    let (on, hold) = match kind {
        "hinged" => (place(&table)?, Hold::Displacement { displacement_mm: [zero; 3] }),
        "fixed" => (place(&table)?, Hold::Displacement { displacement_mm: held(&table)? }),
        "displacement" => {
            let displacement_mm =
                [table.maybe_number("x_mm", ANY)?, table.maybe_number("y_mm", ANY)?, table.maybe_number("z_mm", ANY)?];
            if displacement_mm == [None; 3] {
                return Err(table.wrong(
                    None,
                    "no component is given",
                    "write `x_mm`, `y_mm` or `z_mm`; those left out are free",
                ));
            }
            (place(&table)?, Hold::Displacement { displacement_mm })
        }
        "symmetric" => (Place::Edge(edge(&table, "a plane of symmetry")?), Hold::Symmetric),
        "clamped" => {
            let motions = [Motion::Given(0.0); 6];
            let hold = Hold::Rigid { motions, reference_mm: None, normals_turn: true };
            (Place::Edge(edge(&table, "a clamp")?), hold)
        }
        _ => (Place::Edge(edge(&table, "a rigid section")?), rigid(&table)?),
    };
    let history = if ["displacement", "rigid"].contains(&kind) { history(&table)? } else { History::default() };
    table.finish()?;
    Ok(Support { name, on, hold, history })
}

fn held(table: &Table<'_, '_>) -> Checked<[Option<f64>; 3]> {
    let Some(words) = table.maybe_words("hold")? else { return Ok([Some(0.0); 3]) };
    let mut held = [None; 3];
    for word in &words {
        match ["x", "y", "z"].iter().position(|axis| axis == word) {
            Some(axis) => held[axis] = Some(0.0),
            None => {
                return Err(table.wrong(
                    table.place_of("hold").as_ref(),
                    format!("`hold` cannot name \"{word}\""),
                    "components are \"x\", \"y\" and \"z\"",
                ));
            }
        }
    }
    if held == [None; 3] {
        return Err(table.wrong(
            table.place_of("hold").as_ref(),
            "`hold` holds nothing",
            "name at least one of \"x\", \"y\", \"z\"",
        ));
    }
    Ok(held)
}

fn rigid(table: &Table<'_, '_>) -> Checked<Hold> {
    let names = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];
    let mut motions = [Motion::Given(0.0); 6];
    for (motion, name) in motions.iter_mut().zip(names) {
        let Some(entry) = table.entry(name) else { continue };
        *motion = match entry.value.get_ref().as_str() {
            Some("free") => Motion::FREE,
            Some(_) => {
                return Err(table.wrong(
                    Some(&entry.value_place()),
                    format!("`{name}` must be a number or \"free\""),
                    "0.0 holds the motion",
                ));
            }
            None => Motion::Given(table.number_or(name, ANY, 0.0)?),
        };
    }
    let reference_mm = table.maybe_tuple("reference_mm", "[0.0, 0.0, 0.0]")?;
    let normals_turn = table.maybe_word("normals", &[("turn", true), ("free", false)])?.unwrap_or(true);
    Ok(Hold::Rigid { motions, reference_mm, normals_turn })
}

/// One `[[action]]`.
pub(super) fn action(table: Table<'_, '_>, ordinal: usize) -> Checked<Action> {
    let name = table.maybe_text("name")?.unwrap_or_else(|| format!("action {ordinal}"));
    let kinds = ["force", "line-force", "edge-moment", "pressure", "temperature", "natural-curvature"];
    let kind = match table.word("kind", &kinds.map(|kind| (kind, kind)))? {
        "force" => ActionKind::Force { on: point(&table)?, force_n: table.tuple("force_n", "[0.0, 0.0, 1.0]")? },
        "line-force" => {
            let on = place(&table)?;
            if matches!(on, Place::Point(_)) {
                return Err(table.wrong(
                    table.place_of("on").as_ref(),
                    "a force per length needs a length",
                    "write an edge or a line in `on`, or use `kind = \"force\"` and `force_n`",
                ));
            }
            ActionKind::LineForce { on, force_n_per_mm: table.tuple("force_n_per_mm", "[0.0, 0.0, 1.0]")? }
        }
        "edge-moment" => ActionKind::EdgeMoment {
            on: edge(&table, "an edge moment")?,
            moment_n: table.number("moment_n", ANY, "1.0")?,
        },
        "temperature" => ActionKind::Temperature { change_k: table.number("change_k", ANY, "-100.0")? },
        "natural-curvature" => {
            ActionKind::NaturalCurvature { change_per_mm: table.tuple("change_per_mm", "[0.01, 0.0, 0.0]")? }
        }
        _ => ActionKind::Pressure {
            pressure_mpa: table.number("pressure_mpa", ANY, "0.001")?,
            follower: table.switch_or("follower", true)?,
        },
    };
    let history = history(&table)?;
    table.finish()?;
    Ok(Action { name, kind, history })
}

const AXES: [(&str, Axis); 3] = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
const COMPONENTS: [(&str, Component); 4] =
    [("x", Component::X), ("y", Component::Y), ("z", Component::Z), ("magnitude", Component::Magnitude)];
const REACTIONS: [(&str, Reaction); 6] = [
    ("force-x", Reaction::ForceX),
    ("force-y", Reaction::ForceY),
    ("force-z", Reaction::ForceZ),
    ("moment-x", Reaction::MomentX),
    ("moment-y", Reaction::MomentY),
    ("moment-z", Reaction::MomentZ),
];

/// One `[[probe]]`.
pub(super) fn probe(table: Table<'_, '_>, supports: &[Support]) -> Checked<Probe> {
    let Some(name) = table.maybe_text("name")? else {
        return Err(table.wrong(
            None,
            "`name` is missing",
            "write what reports should call it, such as `name = \"tip\"`",
        ));
    };
    let kinds = ["displacement", "reaction", "section-moment", "energy", "bending-strain"];
    let kind = match table.word("kind", &kinds.map(|kind| (kind, kind)))? {
        "displacement" => {
            ProbeKind::Displacement { on: point(&table)?, component: table.word("component", &COMPONENTS)? }
        }
        "reaction" => {
            let known: Vec<String> = supports.iter().map(|support| format!("\"{}\"", support.name)).collect();
            let remedy = match known.is_empty() {
                true => "the scene has no [[support]]".to_owned(),
                false => format!("the supports are {}", known.join(", ")),
            };
            let Some(support) = table.maybe_text("support")? else {
                return Err(table.wrong(None, "`support` is missing", remedy));
            };
            if supports.iter().all(|known| known.name != support) {
                return Err(table.wrong(
                    table.place_of("support").as_ref(),
                    format!("no support is called \"{support}\""),
                    remedy,
                ));
            }
            ProbeKind::Reaction { support, component: table.word("component", &REACTIONS)? }
        }
        "section-moment" => match place(&table)? {
            on @ Place::Line(..) => ProbeKind::SectionMoment { on, component: table.word("component", &AXES)? },
            _ => {
                return Err(table.wrong(
                    table.place_of("on").as_ref(),
                    "a section is a line",
                    "write for example `on = \"u=0.5\"`",
                ));
            }
        },
        "energy" => ProbeKind::Energy,
        _ => ProbeKind::BendingStrain,
    };
    table.finish()?;
    Ok(Probe { name, kind })
}
