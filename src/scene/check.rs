//! Entries to a scene, and what must hold between keys.

use super::data::{
    Adapt, EndRotation, Geometry, LengthLimit, Load, Material, MeshSpec, Output, Scene, Solver, Stage, Symmetry,
};
use super::document::Document;
use super::error::{Checked, Direction, Fault, Place, Problem, SceneError, Source};
use super::key_table as keys;
use super::read::{Found, Reader};
use super::{names, stage_order};

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
    Document::read(text, settings).and_then(|document| scene(&Reader::new(&document))).map_err(|fault| {
        let file = Source { name: file_name.into(), text: text.into() };
        let settings = settings.iter().map(|text| Source { name: "--set".into(), text: text.as_ref().into() });
        SceneError::new(fault, std::iter::once(file).chain(settings).collect())
    })
}

fn scene(reader: &Reader<'_, '_>) -> Checked<Scene> {
    let document = reader.document;
    names::check(document)?;
    for section in keys::SECTIONS.iter().filter(|section| section.required) {
        if document.header(section.name).is_none() {
            return Err(missing_section(document, section.name));
        }
    }
    let geometry = geometry(reader)?;
    let material = material(reader, &geometry)?;
    let (mesh, symmetry) = mesh(reader)?;
    let (load, increment) = load(reader)?;
    let pipeline = stages(reader)?;
    let adapt = adapt(reader, &pipeline)?;
    let solver = solver(reader, &increment)?;
    let output =
        Output { sync: reader.word(&keys::SYNC)?.value, mesh_history: reader.switch(&keys::MESH_HISTORY)?.value };
    Ok(Scene {
        geometry,
        material,
        mesh,
        symmetry,
        load,
        supports: vec![],
        actions: vec![],
        probes: vec![],
        adapt,
        solver,
        pipeline: pipeline.value,
        output,
    })
}

fn missing_section(document: &Document<'_>, section: &'static str) -> Box<Fault> {
    let required = keys::KEYS.iter().filter(|key| key.section == section && key.presence == super::Presence::Required);
    let lines: String = required.map(|key| format!("\n{} = {}", key.name, key.example)).collect();
    let gap = if document.end.span.end == 0 { "" } else { "\n\n" };
    Fault::new(Problem::MissingSection { section }, &document.end)
        .edit(&document.end, format!("{gap}[{section}]{lines}"))
}

fn geometry(reader: &Reader<'_, '_>) -> Checked<Geometry> {
    reader.bare_word(&keys::GEOMETRY_KIND)?;
    Ok(Geometry::TapeSpring {
        length_mm: reader.number(&keys::LENGTH)?.value,
        radius_mm: reader.number(&keys::RADIUS)?.value,
        arc_deg: reader.number(&keys::ARC)?.value,
    })
}

fn material(reader: &Reader<'_, '_>, geometry: &Geometry) -> Checked<Material> {
    reader.bare_word(&keys::MATERIAL_KIND)?;
    let youngs_modulus_mpa = reader.number(&keys::YOUNGS_MODULUS)?.value;
    let poissons_ratio = reader.number(&keys::POISSONS_RATIO)?.value;
    let thickness = reader.number(&keys::THICKNESS)?;
    let thickness_mm = thickness.value;
    let Geometry::TapeSpring { radius_mm, .. } = *geometry else { todo!() };
    if thickness_mm >= radius_mm {
        let radius = reader.number(&keys::RADIUS)?.place;
        return Err(between(Problem::NotThin { thickness_mm, radius_mm }, thickness.place, radius, reader));
    }
    Ok(Material::Isotropic { youngs_modulus_mpa, poissons_ratio, thickness_mm })
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

fn load(reader: &Reader<'_, '_>) -> Checked<(Load, Found<f64>)> {
    reader.bare_word(&keys::LOAD_KIND)?;
    let sense = reader.word(&keys::SENSE)?.value;
    let rotation = reader.number(&keys::ROTATION)?;
    let increment = reader.number(&keys::INCREMENT)?;
    let (rotation_deg, increment_deg) = (rotation.value, increment.value);
    if increment_deg > rotation_deg {
        let problem = Problem::IncrementPastTarget { increment_deg, rotation_deg };
        return Err(between(problem, increment.place, rotation.place, reader));
    }
    Ok((Load::EndRotation(EndRotation { sense, rotation_deg, increment_deg }), increment))
}

fn stages(reader: &Reader<'_, '_>) -> Checked<Found<Vec<Stage>>> {
    if let Some(entry) = reader.entry(&keys::STAGES) {
        return Ok(Found { value: stage_order::read(&keys::STAGES, entry)?, place: Some(entry.value_place()) });
    }
    let adapts = reader.document.header(keys::THRESHOLD.section).is_some();
    let value = if adapts { Stage::ALL.to_vec() } else { vec![Stage::Solve] };
    Ok(Found { value, place: None })
}

fn adapt(reader: &Reader<'_, '_>, pipeline: &Found<Vec<Stage>>) -> Checked<Option<Adapt>> {
    let threshold = reader.number(&keys::THRESHOLD)?.value;
    let rule = reader.entry(&keys::LENGTH_LIMIT);
    let length = reader.entry(&keys::LENGTH_LIMIT_MM);
    if let (Some(rule), Some(length)) = (rule, length) {
        let problem = Problem::BothGiven { key: &keys::LENGTH_LIMIT_MM, other: &keys::LENGTH_LIMIT };
        return Err(Fault::new(problem, &length.place).also(Some(&rule.place)));
    }
    let length_limit = match length {
        Some(_) => LengthLimit::Millimetres([reader.number(&keys::LENGTH_LIMIT_MM)?.value; 2]),
        None => reader.word(&keys::LENGTH_LIMIT)?.value,
    };
    if pipeline.value.contains(&Stage::EvaluateIndicators) {
        return Ok(Some(Adapt { threshold: [threshold; 2], length_limit }));
    }
    match reader.document.header(keys::THRESHOLD.section) {
        None => Ok(None),
        Some(header) => Err(Fault::new(Problem::AdaptUnused, &header.place).also(pipeline.place.as_ref())),
    }
}

fn solver(reader: &Reader<'_, '_>, increment: &Found<f64>) -> Checked<Solver> {
    let tolerance = reader.number(&keys::TOLERANCE)?.value;
    let max_iterations = reader.count(&keys::MAX_ITERATIONS)?.value;
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
        scene(&reader).unwrap();
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
                parse_with_settings(EVERYTHING, "table.toml", &[setting]).unwrap();
            }
        }
    }
}
