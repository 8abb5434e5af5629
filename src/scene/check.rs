//! Entries to a scene, and what must hold between keys.

use super::data::{
    Adapt, ArcLength, ArcLengthWord, EndRotation, Expectation, Geometry, LengthLimit, Load, Material, MeshSpec, Output,
    Scene, Solver, Stage, Symmetry,
};
use super::document::Document;
use super::error::SceneError;
use super::fault::{Checked, Fault, Place, Source};
use super::key_table as keys;
use super::problem::{Direction, Problem};
use super::read::{Found, Reader};
use super::structure::{check_temperature, structure};
use super::{geometries, load_steps, materials, names, stage_order};
use crate::units::significant;

/// Length of the layer in which a cylinder feels its held end, in units of sqrt(R t): pi decay lengths of
/// sqrt(R t)/(3(1 - nu^2))^(1/4), after which 4 % are left (Timoshenko & Woinowsky-Krieger, section 114), at nu = 0.3.
const BOUNDARY_LAYER: f64 = 2.4;

/// Reads a scene from TOML. `file_name` is only what errors call the text.
///
/// # Errors
/// One error for the first thing that is wrong: syntax, then names, then missing tables, then values in the order of
/// the help text.
pub fn parse(text: &str, file_name: &str) -> Result<Scene, SceneError> {
    parse_with_settings::<&str>(text, file_name, &[])
}

/// Reads a scene from TOML with settings of the form `section.key=value` applied to it before it is checked, as if
/// the file said so; the last setting of a key holds. A value is TOML, but a word needs no quotes.
///
/// # Errors
/// As [`parse`]; what is wrong with a setting is shown in the setting.
pub fn parse_with_settings<S: AsRef<str>>(text: &str, file_name: &str, settings: &[S]) -> Result<Scene, SceneError> {
    let folder = std::path::Path::new(file_name).parent().unwrap_or(std::path::Path::new(""));
    Document::read(text, settings).and_then(|document| scene(&Reader::new(&document), folder)).map_err(|fault| {
        let file = Source { name: file_name.into(), text: text.into() };
        let settings = settings.iter().map(|text| Source { name: "--set".into(), text: text.as_ref().into() });
        SceneError::new(fault, std::iter::once(file).chain(settings).collect())
    })
}

fn scene(reader: &Reader<'_, '_>, folder: &std::path::Path) -> Checked<Scene> {
    let document = reader.document;
    names::check(document)?;
    for section in keys::SECTIONS.iter().filter(|section| section.required) {
        if document.header(section.name).is_none() {
            return Err(missing_section(document, section.name));
        }
    }
    let geometry = geometry(reader, folder)?;
    let material = material(reader, &geometry)?;
    let (mesh, symmetry) = mesh(reader)?;
    let (load, increments) = load(reader, &geometry)?;
    check_length(reader, &geometry, &material, &load)?;
    let (supports, actions, probes) = structure(reader, &load, (&geometry, &material))?;
    check_temperature(reader, &material, &actions)?;
    let pipeline = stages(reader)?;
    let adapt = adapt(reader, &pipeline, &geometry)?;
    let solver = solver(reader, increments.as_ref().map(|increments| &increments.first))?;
    let continuation = continuation(reader, &load, increments.and_then(|increments| increments.longest))?;
    let output =
        Output { sync: reader.word(&keys::SYNC)?.value, mesh_history: reader.switch(&keys::MESH_HISTORY)?.value };
    let expect = Expectation {
        outcome: reader.word(&keys::OUTCOME)?.value,
        same_as: reader.maybe_text(&keys::SAME_AS)?,
        least_bits: reader.count(&keys::LEAST_BITS)?.value,
        peak: reader.maybe_number(&keys::PEAK)?,
        last: reader.maybe_number(&keys::LAST)?,
        inexact: reader.maybe_text(&keys::INEXACT)?,
    };
    let expect = reader.document.header(keys::OUTCOME.section).map(|_| expect);
    let pipeline = pipeline.value;
    Ok(Scene {
        expect,
        geometry,
        material,
        mesh,
        symmetry,
        load,
        supports,
        actions,
        probes,
        adapt,
        solver,
        continuation,
        pipeline,
        output,
    })
}

/// Refuses a spring that the boundary layers of its two ends fill: between rigid ends so near to each other no fold forms.
fn check_length(reader: &Reader<'_, '_>, geometry: &Geometry, material: &Material, load: &Load) -> Checked<()> {
    let (Geometry::TapeSpring { length_mm, radius_mm, .. }, Load::EndRotation(_)) = (geometry, load) else {
        return Ok(());
    };
    let layer_mm = BOUNDARY_LAYER * (radius_mm * material.thickness_mm()).sqrt();
    if *length_mm >= 2.0 * layer_mm {
        return Ok(());
    }
    let table = reader.document.table("geometry");
    let problem = format!(
        "a spring of {length_mm} mm is all boundary layer: each end takes {BOUNDARY_LAYER} sqrt(R t) = {} mm of it",
        significant(layer_mm, 3)
    );
    let remedy = format!(
        "make it longer than {} mm, by far; radius_mm is {radius_mm}: are the two exchanged?",
        significant(2.0 * layer_mm, 3)
    );
    Err(table.wrong(table.place_of("length_mm").as_ref(), problem, remedy))
}

fn missing_section(document: &Document<'_>, section: &'static str) -> Box<Fault> {
    let required = keys::KEYS.iter().filter(|key| key.section == section && key.presence == super::Presence::Required);
    let lines: String = required.map(|key| format!("\n{} = {}", key.name, key.example)).collect();
    let gap = if document.end.span.end == 0 { "" } else { "\n\n" };
    Fault::new(Problem::MissingSection { section }, &document.end)
        .edit(&document.end, format!("{gap}[{section}]{lines}"))
}

fn geometry(reader: &Reader<'_, '_>, folder: &std::path::Path) -> Checked<Geometry> {
    if reader.document.is_of_general_kind("geometry") {
        return geometries::geometry(reader.document.table("geometry"), folder);
    }
    reader.bare_word(&keys::GEOMETRY_KIND)?;
    Ok(Geometry::TapeSpring {
        length_mm: reader.number(&keys::LENGTH)?.value,
        radius_mm: reader.number(&keys::RADIUS)?.value,
        arc_deg: reader.number(&keys::ARC)?.value,
    })
}

fn material(reader: &Reader<'_, '_>, geometry: &Geometry) -> Checked<Material> {
    let plies = reader.document.tables("ply");
    let (material, thickness) = if reader.document.is_of_general_kind("material") {
        let table = reader.document.table("material");
        let place = table.place_of("thickness_mm").or(Some(table.place.clone()));
        (materials::material(table, plies)?, place)
    } else {
        reader.bare_word(&keys::MATERIAL_KIND)?;
        let youngs_modulus_mpa = reader.number(&keys::YOUNGS_MODULUS)?.value;
        let poissons_ratio = reader.number(&keys::POISSONS_RATIO)?.value;
        let thickness = reader.number(&keys::THICKNESS)?;
        materials::no_plies(plies)?;
        let material = Material::Isotropic {
            youngs_modulus_mpa,
            poissons_ratio,
            thickness_mm: thickness.value,
            offset_mm: reader.number(&keys::OFFSET)?.value,
            thermal_expansion_per_k: reader.maybe_number(&keys::THERMAL_EXPANSION)?,
            density_kg_m3: reader.maybe_number(&keys::DENSITY)?,
        };
        (material, thickness.place)
    };
    let thickness_mm = material.thickness_mm();
    if material.offset_mm().abs() > thickness_mm {
        let table = reader.document.table("material");
        let problem = format!(
            "offset_mm = {} puts the surface farther from the middle of the thickness than the whole thickness, \
             {thickness_mm} mm",
            material.offset_mm()
        );
        let remedy =
            "half the thickness puts it on top; where the shell lies farther off, draw the geometry nearer to it";
        return Err(table.wrong(table.place_of("offset_mm").as_ref(), problem, remedy));
    }
    if let Some(radius_mm) = radius(geometry).filter(|radius| thickness_mm >= *radius) {
        let place = reader.document.entry("geometry", "radius_mm").map(|entry| entry.value_place());
        return Err(between(Problem::NotThin { thickness_mm, radius_mm }, thickness, place, reader));
    }
    Ok(material)
}

fn radius(geometry: &Geometry) -> Option<f64> {
    match geometry {
        Geometry::TapeSpring { radius_mm, .. }
        | Geometry::CylinderPanel { radius_mm, .. }
        | Geometry::SphereZone { radius_mm, .. } => Some(*radius_mm),
        Geometry::Plate { .. } | Geometry::Annulus { .. } | Geometry::Nurbs(_) => None,
    }
}

fn mesh(reader: &Reader<'_, '_>) -> Checked<(MeshSpec, Symmetry)> {
    let degree = reader.pair(&keys::DEGREE)?.value;
    let elements = reader.pair(&keys::ELEMENTS)?;
    let quadrature = reader.word(&keys::QUADRATURE)?.value;
    let part = reader.bare_word(&keys::PART)?;
    let symmetry: Symmetry = reader.word(&keys::PART)?.value;
    for (index, direction) in Direction::BOTH.into_iter().enumerate() {
        let count = elements.value[index];
        if symmetry.cuts()[index] && count % 2 == 1 {
            let problem = Problem::OddElements { direction, elements: count, part: part.value };
            let place = element_place(reader, index).or(elements.place);
            let fault = between(problem, place.clone(), part.place, reader);
            return Err(match place {
                Some(place) => fault.edit(&place, (count + 1).to_string()),
                None => fault,
            });
        }
    }
    Ok((MeshSpec { degree, elements: elements.value, quadrature }, symmetry))
}

/// Where the count of elements in one direction stands.
fn element_place(reader: &Reader<'_, '_>, index: usize) -> Option<Place> {
    let entry = reader.entry(&keys::ELEMENTS)?;
    let item = entry.value.get_ref().as_array()?.get(index)?;
    Some(entry.place_of(item.span()))
}

fn load(reader: &Reader<'_, '_>, geometry: &Geometry) -> Checked<(Load, Option<Increments>)> {
    if reader.document.is_of_general_kind("load") {
        return Ok((load_steps::steps(reader.document.table("load"))?, None));
    }
    reader.bare_word(&keys::LOAD_KIND)?;
    if !matches!(geometry, Geometry::TapeSpring { .. }) {
        let table = reader.document.table("load");
        let place = table.place_of("kind");
        return Err(table.wrong(
            place.as_ref(),
            "only a tape spring has ends that turn",
            "write `kind = \"steps\"`, and add [[support]] and [[action]] tables",
        ));
    }
    let sense = reader.word(&keys::SENSE)?.value;
    let rotation = reader.number(&keys::ROTATION)?;
    let increment = reader.number(&keys::INCREMENT)?;
    let (rotation_deg, increment_deg) = (rotation.value, increment.value);
    if increment_deg > rotation_deg {
        let problem = Problem::IncrementPastTarget { increment_deg, rotation_deg };
        return Err(between(problem, increment.place, rotation.place, reader));
    }
    let longest = match reader.entry(&keys::LONGEST_INCREMENT) {
        Some(_) => Some(reader.number(&keys::LONGEST_INCREMENT)?),
        None => None,
    };
    if let Some(longest) = longest.as_ref().filter(|longest| longest.value < increment_deg) {
        let problem = Problem::LongestIncrementTooSmall { longest_increment_deg: longest.value, increment_deg };
        return Err(between(problem, longest.place.clone(), increment.place, reader));
    }
    let longest_increment_deg =
        longest.as_ref().map(|longest| longest.value).filter(|longest| *longest > increment_deg);
    let load = Load::EndRotation(EndRotation { sense, rotation_deg, increment_deg, longest_increment_deg });
    Ok((load, Some(Increments { first: increment, longest: longest.and_then(|longest| longest.place) })))
}

fn stages(reader: &Reader<'_, '_>) -> Checked<Found<Vec<Stage>>> {
    if let Some(entry) = reader.entry(&keys::STAGES) {
        return Ok(Found { value: stage_order::read(&keys::STAGES, entry)?, place: Some(entry.value_place()) });
    }
    let adapts = reader.document.header(keys::THRESHOLD.section).is_some();
    let value = if adapts { Stage::REFINING.to_vec() } else { vec![Stage::Solve] };
    Ok(Found { value, place: None })
}

/// A number for both directions, or one for each.
fn one_or_pair(reader: &Reader<'_, '_>, key: &'static super::Key) -> Checked<[f64; 2]> {
    if reader.entry(key).is_some_and(|entry| entry.value.get_ref().as_array().is_some()) {
        let table = reader.document.table(key.section);
        let pair: [f64; 2] = table.tuple(key.name, "[1.0, 2.0]")?;
        if pair.iter().any(|value| *value <= 0.0) {
            return Err(table.wrong(table.place_of(key.name).as_ref(), format!("`{}` must be positive", key.name), ""));
        }
        return Ok(pair);
    }
    Ok([reader.number(key)?.value; 2])
}

fn adapt(reader: &Reader<'_, '_>, pipeline: &Found<Vec<Stage>>, geometry: &Geometry) -> Checked<Option<Adapt>> {
    let threshold = one_or_pair(reader, &keys::THRESHOLD)?;
    let rule = reader.entry(&keys::LENGTH_LIMIT);
    let length = reader.entry(&keys::LENGTH_LIMIT_MM);
    if let (Some(rule), Some(length)) = (rule, length) {
        let problem = Problem::BothGiven { key: &keys::LENGTH_LIMIT_MM, other: &keys::LENGTH_LIMIT };
        return Err(Fault::new(problem, &length.place).also(Some(&rule.place)));
    }
    let length_limit = match length {
        Some(_) => LengthLimit::Millimetres(one_or_pair(reader, &keys::LENGTH_LIMIT_MM)?),
        None if rule.is_some() => reader.word(&keys::LENGTH_LIMIT)?.value,
        None if matches!(geometry, Geometry::TapeSpring { .. }) => LengthLimit::SqrtRadiusThickness,
        None => LengthLimit::HalfDecayLength,
    };
    if pipeline.value.contains(&Stage::EvaluateIndicators) {
        let flat = matches!(geometry, Geometry::Plate { .. } | Geometry::Annulus { .. });
        if flat && length_limit == LengthLimit::SqrtRadiusThickness {
            let table = reader.document.table("adapt");
            return Err(table.wrong(
                None,
                "a flat shell has no radius to limit the elements by",
                "write \"half-decay-length\", or `length_limit_mm`, a number or one for each direction",
            ));
        }
        return Ok(Some(Adapt { threshold, length_limit }));
    }
    match reader.document.header(keys::THRESHOLD.section) {
        None => Ok(None),
        Some(header) => Err(Fault::new(Problem::AdaptUnused, &header.place).also(pipeline.place.as_ref())),
    }
}

fn solver(reader: &Reader<'_, '_>, increment: Option<&Found<f64>>) -> Checked<Solver> {
    let tolerance = reader.number(&keys::TOLERANCE)?.value;
    let max_iterations = reader.count(&keys::MAX_ITERATIONS)?.value;
    let Some(increment) = increment else {
        for (key, instead) in [(&keys::LEAST_INCREMENT, "least_increment"), (&keys::SNAP_TOLERANCE, "snap_tolerance")] {
            if let Some(entry) = reader.entry(key) {
                let table = reader.document.table("solver");
                let problem = format!("`{}` is in degrees, and the steps of this scene are load factors", key.name);
                return Err(table.wrong(Some(&entry.place), problem, format!("write `{instead}` in [load]")));
            }
        }
        return Ok(Solver { tolerance, max_iterations, least_increment_deg: None, snap_tolerance_deg: None });
    };
    let least = reader.number(&keys::LEAST_INCREMENT)?;
    let snap = reader.number(&keys::SNAP_TOLERANCE)?;
    let (least_increment_deg, increment_deg, snap_tolerance_deg) = (least.value, increment.value, snap.value);
    if least_increment_deg > increment_deg {
        let problem = Problem::LeastIncrementTooLarge { least_increment_deg, increment_deg };
        return Err(between(problem, least.place, increment.place.clone(), reader));
    }
    if snap_tolerance_deg < least_increment_deg {
        let problem = Problem::SnapToleranceTooSmall { snap_tolerance_deg, least_increment_deg };
        return Err(between(problem, snap.place, least.place, reader));
    }
    Ok(Solver {
        tolerance,
        max_iterations,
        least_increment_deg: Some(least_increment_deg),
        snap_tolerance_deg: Some(snap_tolerance_deg),
    })
}

/// What a scene says of the increments of a rotation.
struct Increments {
    first: Found<f64>,
    /// Where the longest one stands.
    longest: Option<Place>,
}

fn continuation(reader: &Reader<'_, '_>, load: &Load, growing: Option<Place>) -> Checked<Option<ArcLength>> {
    let control = reader.bare_word(&keys::CONTROL)?;
    let (longest, shortest) = (reader.number(&keys::LONGEST_STEP)?, reader.number(&keys::SHORTEST_STEP)?);
    let most_steps = reader.count(&keys::MOST_STEPS)?;
    if control.value == "arc-length" {
        if load.longest_increment() > load.increment() {
            let place = growing.or_else(|| reader.document.table("load").place_of("longest_increment"));
            return Err(reader.document.table("load").wrong(
                place.as_ref(),
                "increments do not grow by arc length: only the first step is an increment",
                "take it out, and write `longest_step` in [continuation]",
            ));
        }
        return Ok(Some(ArcLength {
            control: ArcLengthWord::ArcLength,
            longest_step: longest.value,
            shortest_step: shortest.value,
            most_steps: most_steps.value,
        }));
    }
    match longest.place.or(shortest.place).or(most_steps.place) {
        None => Ok(None),
        Some(place) => Err(reader.document.table("continuation").wrong(
            Some(&place),
            "this is about lengths along the path, and the steps of this scene are increments of its load",
            "write `control = \"arc-length\"` beside it, or take it out",
        )),
    }
}

/// The error for two values that do not go together; either may be a default, which stands nowhere.
fn between(problem: Problem, first: Option<Place>, second: Option<Place>, reader: &Reader<'_, '_>) -> Box<Fault> {
    match (first, second) {
        (Some(first), second) => Fault::new(problem, &first).also(second.as_ref()),
        (None, Some(second)) => Fault::new(problem, &second),
        (None, None) => Fault::new(problem, &reader.document.end),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scene::kinds;
    use crate::scene::{KEYS, Kind, SECTIONS};

    const EVERYTHING: &str = r#"
        [geometry]
        kind = "tape-spring"
        length_mm = 300.0
        radius_mm = 10.0
        arc_deg = 110.0
        [material]
        kind = "isotropic"
        youngs_modulus_mpa = 131000.0
        poissons_ratio = 0.3
        thickness_mm = 0.1
        [mesh]
        elements = [4, 4]
        [load]
        kind = "end-rotation"
        sense = "opposite"
        rotation_deg = 60.0
        increment_deg = 0.4
        [adapt]
        length_limit_mm = 1.0
    "#;

    #[test]
    fn the_keys_that_are_read_are_the_keys_of_the_table() {
        let document = Document::read::<&str>(EVERYTHING, &[]).unwrap();
        let reader = Reader::new(&document);
        scene(&reader, std::path::Path::new("")).unwrap();
        let asked: BTreeSet<_> = reader.asked().into_iter().collect();
        let table: BTreeSet<_> = KEYS.iter().map(|key| key.path()).collect();
        assert_eq!(table.len(), KEYS.len(), "a key stands twice in the table");
        assert_eq!(asked, table);
    }

    #[test]
    fn every_key_stands_in_a_section_of_the_table_and_ends_in_its_unit() {
        for key in KEYS {
            assert!(SECTIONS.iter().any(|section| section.name == key.section), "{}", key.path());
            assert!(key.name.ends_with(key.unit.suffix()), "{}", key.path());
        }
    }

    #[test]
    fn every_word_of_the_table_is_understood() {
        for key in KEYS {
            let Kind::Word(choices) = &key.kind else { continue };
            for choice in *choices {
                let setting = format!("{}={}", key.path(), choice.word);
                let parsed = parse_with_settings(EVERYTHING, "table.toml", &[setting]);
                let general = [&kinds::GEOMETRIES[..], &kinds::MATERIALS, &kinds::LOADS].concat();
                match general.contains(&choice.word) {
                    // It has keys of its own, which this scene lacks.
                    true => assert!(matches!(parsed.unwrap_err().problem(), Problem::Table { .. }), "{}", choice.word),
                    false => assert!(parsed.is_ok(), "{}", choice.word),
                }
            }
        }
    }
}
