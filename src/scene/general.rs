//! Tables of scenes other than the tape spring with turning ends: geometry, material and load of other kinds, and the
//! arrays of tables `[[ply]]`, `[[support]]` and `[[probe]]`.

use super::actions::has_centre;
use super::data::{
    Axis, Component, Edge, Geometry, History, Hold, Load, LoadSteps, Material, Motion, OrthotropicLaw,
    ParametricDirection, Place, Ply, Probe, ProbeKind, Reaction, Seam, Support,
};
use super::error::Checked;
use super::nurbs::nurbs;
use super::table::{ANY, LENGTH, Range, Table};

/// Kinds of geometry that are read here.
pub(super) const GEOMETRIES: [&str; 5] = ["plate", "cylinder-panel", "annulus", "sphere-zone", "nurbs"];
/// Kinds of material that are read here.
pub(super) const MATERIALS: [&str; 2] = ["orthotropic", "laminate"];
/// Kinds of load that are read here.
pub(super) const LOADS: [&str; 1] = ["steps"];
/// Keys that tables of these kinds have and those of the first kind, which the table of keys knows, have not.
const KEYS_OF_KINDS: [(&str, &str, &[&str]); 8] = [
    ("geometry", "plate", &["width_mm"]),
    ("geometry", "cylinder-panel", &["seam", "from_deg"]),
    ("geometry", "annulus", &["inner_radius_mm", "outer_radius_mm", "seam", "from_deg"]),
    ("geometry", "sphere-zone", &["latitude_deg", "seam", "from_deg"]),
    ("geometry", "nurbs", &["degrees", "knots_u", "knots_v", "control_points_mm", "weights", "file", "seam"]),
    (
        "material",
        "orthotropic",
        &[
            "youngs_modulus_1_mpa",
            "youngs_modulus_2_mpa",
            "poissons_ratio_12",
            "shear_modulus_12_mpa",
            "thermal_expansion_1_per_k",
            "thermal_expansion_2_per_k",
            "angle_deg",
        ],
    ),
    (
        "material",
        "laminate",
        &[
            "youngs_modulus_1_mpa",
            "youngs_modulus_2_mpa",
            "poissons_ratio_12",
            "shear_modulus_12_mpa",
            "thermal_expansion_1_per_k",
            "thermal_expansion_2_per_k",
        ],
    ),
    ("load", "steps", &["increment", "longest_increment", "factor", "least_increment", "snap_tolerance"]),
];

/// The kinds of a table that have a key which those of its first kind have not.
pub(super) fn kinds_with(section: &str, key: &str) -> Vec<&'static str> {
    let with = KEYS_OF_KINDS.iter().filter(|(of, _, keys)| *of == section && keys.contains(&key));
    with.map(|(_, kind, _)| *kind).collect()
}

/// Words of `seam`.
pub(super) const SEAMS: [(&str, Seam); 2] = [("smooth", Seam::Smooth), ("free", Seam::Free)];
/// Arrays of tables.
pub(super) const ARRAYS: [&str; 4] = ["ply", "support", "action", "probe"];

const ARC: Range = Range { above: 0.0, most: 360.0, reason: "an arc is more than 0 and at most 360 degrees" };
const FROM: Range = Range { above: -360.0, most: 360.0, reason: "an arc starts between -360 and 360 degrees" };
const DENSITY: Range = Range { above: 0.0, most: 1e12, reason: "densities are positive, in kg/m3 (steel: 7850)" };
/// A gap of a full turn that is smaller is rounding of coordinates: 1e-4 rad.
const NEAR_FULL_TURN_DEG: f64 = 0.006;
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
                from_deg: table.maybe_number("from_deg", FROM)?,
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
            let from_deg = table.maybe_number("from_deg", FROM)?;
            Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, from_deg, seam: seam(&table, arc_deg)? }
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
            let from_deg = table.maybe_number("from_deg", FROM)?;
            Geometry::SphereZone { radius_mm, latitude_deg, arc_deg, from_deg, seam: seam(&table, arc_deg)? }
        }
        _ => Geometry::Nurbs(nurbs(&table, folder)?),
    };
    table.finish()?;
    Ok(geometry)
}

fn seam(table: &Table<'_, '_>, arc_deg: f64) -> Checked<Option<Seam>> {
    let given = table.maybe_word("seam", &SEAMS)?;
    let short_deg = 360.0 - arc_deg;
    if short_deg > 0.0 && short_deg < NEAR_FULL_TURN_DEG {
        return Err(table.wrong(
            table.place_of("arc_deg").as_ref(),
            format!("an arc of {arc_deg} degrees is {short_deg:.1e} degrees short of a full turn"),
            "write `arc_deg = 360.0` and a `seam`, or leave a gap that can be seen (0.006 degrees)",
        ));
    }
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

/// What one table says of a layer: moduli, Poisson's ratio and expansions.
#[derive(Clone, Copy, Default)]
struct GivenLaw {
    youngs_modulus_1_mpa: Option<f64>,
    youngs_modulus_2_mpa: Option<f64>,
    poissons_ratio_12: Option<f64>,
    shear_modulus_12_mpa: Option<f64>,
    thermal_expansion_1_per_k: Option<f64>,
    thermal_expansion_2_per_k: Option<f64>,
}

impl GivenLaw {
    fn read(table: &Table<'_, '_>) -> Checked<Self> {
        let ratio =
            Range { above: -10.0, most: 10.0, reason: "Poisson's ratio nu12 is below sqrt(E1/E2) in magnitude" };
        Ok(Self {
            youngs_modulus_1_mpa: table.maybe_number("youngs_modulus_1_mpa", MODULUS)?,
            youngs_modulus_2_mpa: table.maybe_number("youngs_modulus_2_mpa", MODULUS)?,
            poissons_ratio_12: table.maybe_number("poissons_ratio_12", ratio)?,
            shear_modulus_12_mpa: table.maybe_number("shear_modulus_12_mpa", MODULUS)?,
            thermal_expansion_1_per_k: table.maybe_number("thermal_expansion_1_per_k", EXPANSION)?,
            thermal_expansion_2_per_k: table.maybe_number("thermal_expansion_2_per_k", EXPANSION)?,
        })
    }

    /// Refuses what contradicts itself, as far as it is given.
    fn checked(self, table: &Table<'_, '_>) -> Checked<Self> {
        let expansions = [
            ("thermal_expansion_1_per_k", self.thermal_expansion_1_per_k),
            ("thermal_expansion_2_per_k", self.thermal_expansion_2_per_k),
        ];
        if let [(given, Some(_)), (other, None)] | [(other, None), (given, Some(_))] = expansions {
            return Err(table.wrong(
                table.place_of(given).as_ref(),
                format!("`{given}` is given and `{other}` is not"),
                format!("write both; `{other} = 0.0` does not expand that way"),
            ));
        }
        let ratio = self.youngs_modulus_1_mpa.zip(self.youngs_modulus_2_mpa).map(|(along, across)| along / across);
        if let Some((nu, ratio)) = self.poissons_ratio_12.zip(ratio).filter(|(nu, ratio)| nu * nu >= *ratio) {
            return Err(table.wrong(
                table.place_of("poissons_ratio_12").as_ref(),
                format!("nu12 = {nu} is too large for E1/E2 = {ratio}: the layer would have no stiffness"),
                "nu12 squared must be below E1/E2",
            ));
        }
        Ok(self)
    }

    /// What is missing comes from `default`.
    fn or(self, default: Self) -> Self {
        Self {
            youngs_modulus_1_mpa: self.youngs_modulus_1_mpa.or(default.youngs_modulus_1_mpa),
            youngs_modulus_2_mpa: self.youngs_modulus_2_mpa.or(default.youngs_modulus_2_mpa),
            poissons_ratio_12: self.poissons_ratio_12.or(default.poissons_ratio_12),
            shear_modulus_12_mpa: self.shear_modulus_12_mpa.or(default.shear_modulus_12_mpa),
            thermal_expansion_1_per_k: self.thermal_expansion_1_per_k.or(default.thermal_expansion_1_per_k),
            thermal_expansion_2_per_k: self.thermal_expansion_2_per_k.or(default.thermal_expansion_2_per_k),
        }
    }
}

/// Law of the layer of one table; what is missing comes from `default`.
fn law(table: &Table<'_, '_>, default: GivenLaw) -> Checked<OrthotropicLaw> {
    let given = GivenLaw::read(table)?.or(default).checked(table)?;
    let modulus = |name: &'static str, value: Option<f64>| {
        let remedy = "an orthotropic layer has youngs_modulus_1_mpa, youngs_modulus_2_mpa, poissons_ratio_12, shear_modulus_12_mpa";
        value.ok_or_else(|| table.missing(name, remedy))
    };
    Ok(OrthotropicLaw {
        youngs_modulus_1_mpa: modulus("youngs_modulus_1_mpa", given.youngs_modulus_1_mpa)?,
        youngs_modulus_2_mpa: modulus("youngs_modulus_2_mpa", given.youngs_modulus_2_mpa)?,
        poissons_ratio_12: given
            .poissons_ratio_12
            .ok_or_else(|| table.missing("poissons_ratio_12", "write for example `poissons_ratio_12 = 0.3`"))?,
        shear_modulus_12_mpa: modulus("shear_modulus_12_mpa", given.shear_modulus_12_mpa)?,
        thermal_expansion_1_per_k: given.thermal_expansion_1_per_k,
        thermal_expansion_2_per_k: given.thermal_expansion_2_per_k,
    })
}

/// A material of one of [`MATERIALS`].
pub(super) fn material(table: Table<'_, '_>, plies: Vec<Table<'_, '_>>) -> Checked<Material> {
    let kind = table.word("kind", &MATERIALS.map(|kind| (kind, kind)))?;
    if kind == "orthotropic" {
        let material = Material::Orthotropic {
            law: law(&table, GivenLaw::default())?,
            angle_deg: table.number_or("angle_deg", ANY, 0.0)?,
            thickness_mm: table.number("thickness_mm", LENGTH, "0.1")?,
            density_kg_m3: table.maybe_number("density_kg_m3", DENSITY)?,
            offset_mm: table.number_or("offset_mm", ANY, 0.0)?,
        };
        table.finish()?;
        return no_plies(plies).map(|()| material);
    }
    let offset_mm = table.number_or("offset_mm", ANY, 0.0)?;
    let default = GivenLaw::read(&table)?.checked(&table)?;
    let density_kg_m3 = table.maybe_number("density_kg_m3", DENSITY)?;
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
            density_kg_m3: ply.maybe_number("density_kg_m3", DENSITY)?.or(density_kg_m3),
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
pub(super) fn place(table: &Table<'_, '_>) -> Checked<Place> {
    let remedy = "write an edge (\"u-start\", \"u-end\", \"v-start\", \"v-end\"), a point (`on = [1.0, 0.5]`, fractions of u and v), or a line (`on = \"u=0.5\"`)";
    let Some(entry) = table.entry("on") else { return Err(table.missing("on", remedy)) };
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

pub(super) fn point(table: &Table<'_, '_>) -> Checked<[f64; 2]> {
    let at: [f64; 2] = table.tuple("on", "[1.0, 0.5]")?;
    if at.iter().any(|fraction| !(0.0..=1.0).contains(fraction)) {
        let problem = format!("there is no point ({}, {})", at[0], at[1]);
        return Err(table.wrong(table.place_of("on").as_ref(), problem, "fractions of u and v run from 0 to 1"));
    }
    Ok(at)
}

pub(super) fn edge(table: &Table<'_, '_>, what: &str) -> Checked<Edge> {
    match place(table)? {
        Place::Edge(edge) => Ok(edge),
        _ => Err(table.wrong(
            table.place_of("on").as_ref(),
            format!("{what} needs a whole edge"),
            "write `on = \"u-start\"`, \"u-end\", \"v-start\" or \"v-end\"",
        )),
    }
}

pub(super) fn history(table: &Table<'_, '_>) -> Checked<History> {
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
    let kinds = ["hinged", "fixed", "displacement", "symmetric", "clamped", "rigid", "rigid-motions"];
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
        "symmetric" => (edge_or_line(&table)?, Hold::Symmetric),
        "rigid-motions" => (Place::Whole, Hold::RigidMotions),
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

/// Where a plane of symmetry may lie.
fn edge_or_line(table: &Table<'_, '_>) -> Checked<Place> {
    match place(table)? {
        on @ (Place::Edge(_) | Place::Line(..)) => Ok(on),
        _ => Err(table.wrong(
            table.place_of("on").as_ref(),
            "a plane of symmetry needs a whole edge or line",
            "write an edge, such as `on = \"u-start\"`, or a line inside, such as `on = \"u=0.5\"`",
        )),
    }
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

const AXES: [(&str, Axis); 3] = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
const COMPONENTS: [(&str, Component); 6] = [
    ("x", Component::X),
    ("y", Component::Y),
    ("z", Component::Z),
    ("magnitude", Component::Magnitude),
    ("normal", Component::Normal),
    ("radial", Component::Radial),
];
const REACTIONS: [(&str, Reaction); 6] = [
    ("force-x", Reaction::ForceX),
    ("force-y", Reaction::ForceY),
    ("force-z", Reaction::ForceZ),
    ("moment-x", Reaction::MomentX),
    ("moment-y", Reaction::MomentY),
    ("moment-z", Reaction::MomentZ),
];

/// One `[[probe]]`.
pub(super) fn probe(table: Table<'_, '_>, supports: &[Support], geometry: &Geometry) -> Checked<Probe> {
    let Some(name) = table.maybe_text("name")? else {
        return Err(table.missing("name", "write what reports should call it, such as `name = \"tip\"`"));
    };
    let kinds = ["displacement", "reaction", "section-moment", "energy", "bending-strain"];
    let kind = match table.word("kind", &kinds.map(|kind| (kind, kind)))? {
        "displacement" => {
            let component = table.word("component", &COMPONENTS)?;
            if component == Component::Radial {
                has_centre(&table, "component", geometry)?;
            }
            ProbeKind::Displacement { on: point(&table)?, component }
        }
        "reaction" => {
            let known: Vec<String> = supports.iter().map(|support| format!("\"{}\"", support.name)).collect();
            let remedy = match known.is_empty() {
                true => "the scene has no [[support]]".to_owned(),
                false => format!("the supports are {}", known.join(", ")),
            };
            let Some(support) = table.maybe_text("support")? else {
                return Err(table.missing("support", remedy));
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
