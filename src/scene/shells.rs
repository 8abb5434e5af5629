//! The array of tables `[[shell]]`: the shells of a structure.

use std::path::Path;

use super::data::{Edge, Geometry, Load, Material, Pose, Shell, ShellEdge};
use super::document::Document;
use super::fault::{Checked, CheckedWhole, Fault, Faults};
use super::keys::Section;
use super::nearest::nearest;
use super::problem::Problem;
use super::regions::EDGES;
use super::table::{Table, between};
use super::tables::Tables;
use super::{geometries, materials, meshes, profiles};
use crate::units::significant;

/// Length of the layer in which a cylinder feels its held end, in units of sqrt(R t): pi decay lengths of
/// sqrt(R t)/(3(1 - nu^2))^(1/4), after which 4 % are left (Timoshenko & Woinowsky-Krieger, section 114), at nu = 0.3.
const BOUNDARY_LAYER: f64 = 2.4;

/// Shells of a scene, and whether it calls them by names.
pub(super) struct Shells {
    pub all: Vec<Shell>,
    pub are_named: bool,
}

impl Shells {
    /// Reads the only shell of a scene, which has no name.
    pub fn of_one(tables: &Tables, folder: &Path, faults: &mut Faults) -> Option<Self> {
        let geometry = faults.keep(geometries::geometry(tables.one("geometry"), folder));
        let material = faults.keep(material(tables));
        let mesh = meshes::mesh_of_shell(tables);
        let (name, pose) = (String::new(), Pose::default());
        let only = Shell { name, geometry: geometry?, material: material?, mesh, pose };
        Some(Self { all: vec![only], are_named: false })
    }

    /// Reads the shells of a structure; `tables` are those of the structure.
    pub fn of_structure(document: &Document<'_>, tables: &Tables, folder: &Path) -> CheckedWhole<Self> {
        let (mut all, mut faults): (Vec<Shell>, Vec<Fault>) = (Vec::new(), Vec::new());
        for (index, table) in tables.all("shell").enumerate() {
            match of_table(document, index, table, folder) {
                Ok(shell) if all.iter().any(|other| other.name == shell.name) => {
                    let problem = format!("another shell is called \"{}\"", shell.name);
                    faults.push(*table.wrong_at("name", problem, "give each a name of its own"));
                }
                Ok(shell) => all.push(shell),
                // What is wrong with a table that all shells share is said once.
                Err(found) => found.into_iter().for_each(|fault| {
                    if !faults.iter().any(|known| known.place == fault.place && known.problem == fault.problem) {
                        faults.push(fault);
                    }
                }),
            }
        }
        if faults.is_empty() { Ok(Self { all, are_named: true }) } else { Err(faults) }
    }

    /// The shells as the data of a scene has them: none where there is only one.
    pub fn named(&self) -> Vec<Shell> {
        if self.are_named { self.all.clone() } else { Vec::new() }
    }

    /// Finds the shell that a table names, which it must where there are several; `None` where it names none and `may_lack` says
    /// that it acts on all of them.
    pub fn named_in(&self, table: &Table, may_lack: bool) -> Checked<Option<usize>> {
        let given: Option<String> = table.get("shell");
        match (given, self.are_named) {
            (Some(_), false) => Err(table.wrong_at(
                "shell",
                "this scene has one shell, which has no name",
                "leave `shell` out, or describe the shells by [[shell]] tables",
            )),
            (None, false) => Ok(Some(0)),
            (None, true) if may_lack => Ok(None),
            (None, true) => Err(table.wrong(
                None,
                "it does not say which shell is meant",
                format!("add `shell`, one of {}", self.list()),
            )),
            (Some(name), true) => self.find(&name, table, "shell").map(Some),
        }
    }

    /// Finds a shell by its name.
    pub fn find(&self, name: &str, table: &Table, key: &str) -> Checked<usize> {
        self.all.iter().position(|shell| shell.name == name).ok_or_else(|| {
            let meant = nearest(name, self.all.iter().map(|shell| &*shell.name));
            let remedy = match meant {
                Some(meant) => format!("did you mean \"{meant}\"? The shells are {}", self.list()),
                None => format!("the shells are {}", self.list()),
            };
            table.wrong_at(key, format!("no shell is called \"{name}\""), remedy)
        })
    }

    /// Finds the edges that a key lists.
    pub fn edges(&self, table: &Table, key: &str) -> Checked<Vec<ShellEdge>> {
        let words: Vec<String> = table.get::<Option<Vec<String>>>(key).unwrap_or_default();
        words.iter().map(|word| self.edge(word, table, key)).collect()
    }

    fn edge(&self, word: &str, table: &Table, key: &str) -> Checked<ShellEdge> {
        if !self.are_named {
            return Err(table.wrong_at(
                key,
                "this scene has one shell, which has no name",
                "describe the shells by [[shell]] tables",
            ));
        }
        let known = |edge: &str| EDGES.iter().find(|(_, name)| *name == edge).map(|(edge, _)| *edge);
        let (shell, edge): (&str, Option<Edge>) =
            word.rsplit_once('.').map_or((word, None), |(shell, edge)| (shell, known(edge)));
        let Some(edge) = edge else {
            let example = self.all.first().map_or("web", |shell| &shell.name);
            if word.contains('=') {
                return Err(table.wrong_at(
                    key,
                    format!("\"{word}\" is a line inside a shell, and only edges are joined and held as one"),
                    format!(
                        "write two shells that meet along that line, and a smooth joint of their edges, such as \"{example}.u-end\""
                    ),
                ));
            }
            return Err(table.wrong_at(
                key,
                format!("\"{word}\" is no edge of a shell"),
                format!("write the name of a shell, a point and an edge, such as \"{example}.u-end\" (or u-start, v-start, v-end)"),
            ));
        };
        Ok(ShellEdge { shell: self.find(shell, table, key)?, edge })
    }

    fn list(&self) -> String {
        self.all.iter().map(|shell| format!("\"{}\"", shell.name)).collect::<Vec<_>>().join(", ")
    }
}

fn of_table(document: &Document<'_>, index: usize, table: &Table, folder: &Path) -> CheckedWhole<Shell> {
    let own = document.of_shell(index);
    if let Some(missing) = missing(&own, table) {
        return Err(vec![*missing]);
    }
    let tables = Tables::read(&own)?;
    let mut faults = Faults::default();
    let name: String = table.get("name");
    if name.is_empty() || name.contains('.') {
        faults.keep::<()>(Err(table.wrong_at(
            "name",
            "an edge is named by a shell, a point and a word",
            "write a name without a point",
        )));
    }
    let pose = faults.keep(pose(table));
    let geometry = faults.keep(geometries::geometry(tables.one("geometry"), folder));
    let material = faults.keep(material(&tables));
    let mesh = meshes::mesh_of_shell(&tables);
    if meshes::chooses_mesh(&tables) {
        faults.keep::<()>(Err(table.wrong(
            None,
            "it has no number of elements",
            "write `elements` in [shell.mesh] below it, or in [mesh] for all shells",
        )));
    }
    match (pose, geometry, material) {
        (Some(pose), Some(geometry), Some(material)) => faults.or(Shell { name, geometry, material, mesh, pose }),
        _ => Err(faults.0),
    }
}

/// The fault of a shell without a table that it needs.
fn missing(own: &Document<'_>, table: &Table) -> Option<Box<Fault>> {
    let is_there = |section: &&Section| own.tables.iter().any(|written| written.name == section.name);
    let section = own.sections.iter().filter(|section| section.required).find(|section| !is_there(section))?;
    let remedy = match section.name {
        "material" => "add [shell.material] below it, or [material] for all shells".to_owned(),
        name => format!("add [shell.{name}] below it"),
    };
    let problem = Problem::Table { table: table.title.clone(), problem: format!("it has no {}", section.name), remedy };
    Some(Fault::new(problem, &table.place))
}

/// Position and axes of a shell.
fn pose(table: &Table) -> Checked<Pose> {
    let axis = |name: &str| -> Checked<[f64; 3]> {
        let axis: [f64; 3] = table.get(name);
        match axis.iter().any(|component| *component != 0.0) {
            true => Ok(axis),
            false => {
                Err(table.wrong_at(name, "an axis without length has no direction", "write such as [1.0, 0.0, 0.0]"))
            }
        }
    };
    Pose::new(table.get("position_mm"), axis("x_axis")?, axis("y_axis")?).map_err(|degrees| {
        table.wrong_at(
            "y_axis",
            format!("y_axis makes {degrees:.4} degrees with x_axis"),
            "the axes of a shell are at right angles",
        )
    })
}

/// Refuses what only a scene of one shell has.
pub(super) fn check_structure(shells: &Shells, tables: &Tables, load: &Load) -> Checked<()> {
    if let (false, Some(table)) = (shells.are_named, tables.all("joint").chain(tables.all("bond")).next()) {
        return Err(table.wrong(None, "this scene has one shell", "describe the shells by [[shell]] tables"));
    }
    if let (true, Load::EndRotation(_)) = (shells.are_named, load) {
        let table = tables.one("load");
        return Err(table.wrong_at(
            "kind",
            "only a single tape spring has ends that turn",
            "write `kind = \"steps\"`, and add [[support]] and [[action]] tables",
        ));
    }
    shells
        .all
        .iter()
        .filter(|_| !shells.are_named)
        .try_for_each(|shell| check_length(tables.one("geometry"), &shell.geometry, &shell.material, load))
}

/// Refuses a spring that the boundary layers of its two ends fill: between rigid ends so near to each other no fold forms.
fn check_length(table: &Table, geometry: &Geometry, material: &Material, load: &Load) -> Checked<()> {
    let (Geometry::TapeSpring { length_mm, radius_mm, .. }, Load::EndRotation(_)) = (geometry, load) else {
        return Ok(());
    };
    let layer_mm = BOUNDARY_LAYER * (radius_mm * material.thickness_mm()).sqrt();
    if *length_mm >= 2.0 * layer_mm {
        return Ok(());
    }
    let problem = format!(
        "a spring of {length_mm} mm is all boundary layer: each end takes {BOUNDARY_LAYER} sqrt(R t) = {} mm of it",
        significant(layer_mm, 3)
    );
    let remedy = format!(
        "make it longer than {} mm, by far; radius_mm is {radius_mm}: are the two exchanged?",
        significant(2.0 * layer_mm, 3)
    );
    Err(table.wrong_at("length_mm", problem, remedy))
}

/// The material of a shell, which is thin.
fn material(tables: &Tables) -> Checked<Material> {
    let table = tables.one("material");
    let material = materials::material(table, tables.all("ply").collect())?;
    let thickness_mm = material.thickness_mm();
    if material.offset_mm().abs() > thickness_mm {
        let problem = format!(
            "offset_mm = {} puts the surface farther from the middle of the thickness than the whole thickness, \
             {thickness_mm} mm",
            material.offset_mm()
        );
        let remedy =
            "half the thickness puts it on top; where the shell lies farther off, draw the geometry nearer to it";
        return Err(table.wrong_at("offset_mm", problem, remedy));
    }
    let geometry = tables.one("geometry");
    profiles::check_thin(geometry, thickness_mm)?;
    let radius_mm: Option<f64> = geometry.get("radius_mm");
    if let Some(radius_mm) = radius_mm.filter(|radius_mm| thickness_mm >= *radius_mm) {
        let thickness = table.place_of("thickness_mm").or(Some(table.place.clone()));
        let problem = Problem::NotThin { thickness_mm, radius_mm };
        return Err(between(problem, thickness, geometry.place_of("radius_mm"), table));
    }
    Ok(material)
}
