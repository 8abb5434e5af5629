//! The mesh that a run starts with, and how it is refined: as the scene says, or where it leaves that out.

use super::data::{Adapt, Indicator, LengthLimit, MeshSpec, Splitting, Stage, Symmetry};
use super::fault::{Checked, Fault};
use super::geometries::TAPE_SPRING;
use super::problem::{Direction, Problem};
use super::table::{Table, between, data};
use super::tables::Tables;

/// Elements each way that a run starts with where the scene names none. Two and six made no difference to the error that was kept
/// (`tests/verification/tolerance.rs`).
const START_ELEMENTS: [usize; 2] = [4, 4];
/// Degrees then of a tape spring: across its arc it bends alike but for its edges, and a few elements of degree 5 show that with the
/// fewest unknowns of all degrees tried.
const TAPE_SPRING_DEGREE: [usize; 2] = [3, 5];
/// Degrees of other shells.
const DEGREE: [usize; 2] = [3, 3];
/// Relative error that the mesh may cause where the scene says nothing about its mesh.
const TOLERANCE: f64 = 0.01;

/// Kinds of geometry without curvature.
const FLAT: [&str; 2] = ["plate", "annulus"];

/// Reads the mesh that a shell starts with.
pub(super) fn mesh_of_shell(tables: &Tables) -> MeshSpec {
    let table = tables.one("mesh");
    let is_spring = tables.one("geometry").kind() == TAPE_SPRING;
    let degree = if is_spring && chooses_mesh(tables) { TAPE_SPRING_DEGREE } else { DEGREE };
    let mut values = table.values.clone();
    values.entry("degree").or_insert_with(|| degree.as_slice().into());
    values.entry("elements").or_insert_with(|| START_ELEMENTS.as_slice().into());
    data(&table.title, values)
}

/// Reads the part of the only shell that is modelled.
pub(super) fn symmetry(tables: &Tables) -> Checked<Symmetry> {
    let (table, symmetry_table) = (tables.one("mesh"), tables.one("symmetry"));
    let (mesh, symmetry): (MeshSpec, Symmetry) = (mesh_of_shell(tables), symmetry_table.get("part"));
    for (index, direction) in Direction::BOTH.into_iter().enumerate() {
        let count = mesh.elements[index];
        if symmetry.cuts()[index] && count % 2 == 1 {
            let problem = Problem::OddElements { direction, elements: count, part: symmetry_table.word("part").into() };
            let place = table.place_of_item("elements", index);
            let fault = between(problem, place.clone(), symmetry_table.place_of("part"), table);
            return Err(match place {
                Some(place) => fault.edit(&place, (count + 1).to_string()),
                None => fault,
            });
        }
    }
    Ok(symmetry)
}

/// Whether the tables of a shell leave its mesh to the program: they name no number of elements.
pub(super) fn chooses_mesh(tables: &Tables) -> bool {
    !tables.one("mesh").values.contains_key("elements")
}

/// What refining depends on beside its own tables.
pub(super) struct Refinable<'a> {
    pub tables: &'a Tables,
    /// Whether the scene leaves its mesh to the program.
    pub chooses_mesh: bool,
    /// Kind of the geometry of each shell.
    pub kinds: Vec<&'static str>,
    /// Whether the scene has several shells.
    pub is_structure: bool,
}

impl Refinable<'_> {
    /// Whether the error that the mesh causes decides how it is refined, since the scene says nothing else.
    fn chooses_by_error(&self) -> bool {
        self.chooses_mesh && self.tables.one("adapt").place_of("threshold").is_none()
    }
}

/// The stages of a load step.
pub(super) fn stages(refinable: &Refinable) -> Checked<Vec<Stage>> {
    let Refinable { tables, chooses_mesh, .. } = *refinable;
    let pipeline = tables.one("pipeline");
    let given: Option<Vec<Stage>> = pipeline.get("stages");
    let stages = given.unwrap_or_else(|| match tables.one("adapt").is_given || chooses_mesh {
        true if refinable.chooses_by_error() => [&Stage::REFINING[..], &[Stage::CoarsenKnots]].concat(),
        true => Stage::REFINING.to_vec(),
        false => vec![Stage::Solve],
    });
    if chooses_mesh && !stages.contains(&Stage::RefineKnots) {
        let problem = "no number of elements is given, and no stage refines those that a run starts with";
        let (mesh, place) = (tables.one("mesh"), pipeline.place_of("stages"));
        return Err(mesh.wrong(place.as_ref(), problem, "write `elements` in [mesh], or leave [pipeline] out"));
    }
    Ok(stages)
}

/// A number for both directions, or one for each.
fn one_or_pair(table: &Table, name: &str) -> Option<[f64; 2]> {
    let value = table.values.get(name)?;
    Some(value.as_f64().map_or_else(|| table.get(name), |both| [both; 2]))
}

/// When and how far the mesh is refined; `None` where no stage looks at it.
pub(super) fn adapt(refinable: &Refinable, pipeline: &[Stage]) -> Checked<Option<Adapt>> {
    let Refinable { tables, ref kinds, is_structure, .. } = *refinable;
    let table = tables.one("adapt");
    if !pipeline.contains(&Stage::EvaluateIndicators) {
        let stages = tables.one("pipeline").place_of("stages");
        let unused = Fault::new(Problem::AdaptUnused, &table.place).also(stages.as_ref());
        return if table.is_given { Err(unused) } else { Ok(None) };
    }
    let is_spring = matches!(kinds[..], [TAPE_SPRING]);
    let Some(threshold) = one_or_pair(table, "threshold") else { unreachable!("adapt.threshold has a default") };
    let chosen = refinable.chooses_by_error().then_some(TOLERANCE);
    let tolerance = table.get::<Option<f64>>("tolerance").or(chosen);
    let indicator = tolerance.map_or(Indicator::BendingStrain(threshold), Indicator::Error);
    if let (true, Indicator::Error(_)) = (is_structure, indicator) {
        return Err(table.wrong_at(
            "tolerance",
            "the error that the mesh causes is estimated for single shells alone",
            "write `threshold` in its place",
        ));
    }
    let default = match indicator {
        Indicator::Error(_) => LengthLimit::Thickness,
        Indicator::BendingStrain(_) if is_spring => LengthLimit::SqrtRadiusThickness,
        Indicator::BendingStrain(_) => LengthLimit::HalfDecayLength,
    };
    let length_limit = match one_or_pair(table, "length_limit_mm") {
        Some(lengths_mm) => LengthLimit::Millimetres(lengths_mm),
        None => table.get::<Option<_>>("length_limit").unwrap_or(default),
    };
    if kinds.iter().any(|kind| FLAT.contains(kind)) && length_limit == LengthLimit::SqrtRadiusThickness {
        return Err(table.wrong(
            None,
            "a flat shell has no radius to limit the elements by",
            "write \"half-decay-length\", or `length_limit_mm`, a number or one for each direction",
        ));
    }
    let splitting: Splitting = table.get("splitting");
    if table.place_of("splitting").is_some() && matches!(indicator, Indicator::Error(_)) {
        return Err(table.wrong_at(
            "splitting",
            "with a tolerance, spans are split in as many parts as the error asks for",
            "leave it out",
        ));
    }
    let continuation = tables.one("continuation");
    if continuation.is_given && matches!(indicator, Indicator::Error(_)) {
        let problem =
            "by arc length, a mesh that is refined by its error behind a limit point may lead back along the path";
        let tolerance = table.place_of("tolerance");
        let remedy = match tolerance {
            Some(_) => "write `threshold` in place of `tolerance`, or leave [continuation] out",
            None => "write [mesh] with `elements`, or [adapt] with a `threshold`",
        };
        return Err(table.wrong(tolerance.as_ref().or(Some(&continuation.place)), problem, remedy));
    }
    if pipeline.contains(&Stage::CoarsenKnots) && !matches!(indicator, Indicator::Error(_)) {
        return Err(table.wrong(
            tables.one("pipeline").place_of("stages").as_ref(),
            "coarsen-knots goes by the error that the mesh causes, and a threshold says nothing about it",
            "write `tolerance` in [adapt] in place of `threshold`, or leave coarsen-knots out",
        ));
    }
    Ok(Some(Adapt { indicator, length_limit, splitting }))
}
