//! `foldline plot`: pictures from a log.

use std::path::PathBuf;

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::log_file::{Gathered, first_and_last, read_through};
use super::output::{file_name, path_in_line, print, write_files};
use crate::history::{States, redefined_probes, remove_redefined};
use crate::record::{Parameter, Record, Report};
use crate::scene::Scene;
use crate::spline::Mesh;
use crate::state::State;
use crate::study::{TapeSpring, equilibria};
use crate::units::rounded;
use crate::view::{
    Field, Picture, ViewDirection, coloured_surface, deformed_surface, fields_of, load_probe_plot, mesh_picture,
    moment_rotation_plot, vtu,
};

/// Cells along a picture that look smooth.
const SMOOTH: usize = 120;

/// Draw the moment–rotation curve, or the load factor over the first probe, and the deformed mesh of a log
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// Folder for moment-rotation.svg (other shells: load-probe.svg, the load factor over the first probe), mesh.svg and
    /// mesh.vtu [default: the log's name without .mcap]
    #[arg(short, long, value_name = "DIR", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Show the mesh at the end of this load step [default: the last one]
    #[arg(long, value_name = "K")]
    step: Option<u64>,
    /// Look at the mesh from this side: degrees about z from x towards y, degrees above the xy-plane
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = direction, allow_hyphen_values = true)]
    view: Option<ViewDirection>,
    /// Colour the mesh by this field, such as bending_moment.11, energy_density or displacement (its length); a wrong name lists
    /// all of them [default: the larger bending strain]
    #[arg(long, value_name = "FIELD[.COMPONENT]")]
    field: Option<String>,
}

impl Arguments {
    /// Reads the log, draws, and names the files.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, output, step, view, field } = self;
        let (mut gathered, mut shown) = (Gathered::default(), None);
        let read = read_through(&log, |portion| {
            let is_wanted = |report: &Report| step.is_none_or(|step| report.step == step);
            if let Some(last) = portion.entries().iter().rfind(|entry| is_wanted(&entry.record.report)) {
                let ordinal = last.record.commit.ordinal as usize;
                shown = Some((ordinal, last.record.report.clone(), portion.log().state(ordinal)));
            }
            gathered.take(portion);
        })?;
        let mut records = std::mem::take(&mut gathered.records);
        remove_redefined(&redefined_probes(&read.log), &mut records);
        let folder = output.unwrap_or_else(|| log.with_extension(""));
        let name = log.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let Some((ordinal, report, state)) = shown else {
            return Err(match step {
                Some(step) => Failure::NoSuchStep { log, step, known: first_and_last(records.iter()) },
                None => crate::view::PlotError::NoEquilibrium.into(),
            });
        };
        let unprobed = equilibria(&records).any(|record| lacks_first_probe(&read.scene, &record.report));
        // Readings and states that the log has not are made from the states that it has.
        let read = if unprobed || state.is_err() { read.whole(&log)? } else { read };
        if unprobed {
            records = read.records_of_scene(&log)?;
        }
        let unusable = |source| Failure::WrongLog { log: log.clone(), source: Box::new(source) };
        let state = state.or_else(|_| States::of(&read.log).at(ordinal)).map_err(unusable)?;
        let picture = Picture {
            direction: view.unwrap_or_default(),
            title: format!("{name}, load step {}", report.step),
            subtitle: subtitle(&report),
            ..Picture::default()
        };
        // Everything is drawn before anything is written.
        let files = curve(&read.scene, &records, &name)?.into_iter().chain(surface(
            &read.scene,
            &state,
            &picture,
            field.as_deref(),
        )?);
        let files: Vec<_> = files.map(|(file, text)| (folder.join(file), text.into_bytes())).collect();
        write_files(&files)?;
        print(&files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect::<String>())
    }
}

/// The curve of a run, if it has one.
fn curve(scene: &Scene, records: &[Record], name: &str) -> Result<Option<(&'static str, String)>, Failure> {
    Ok(match TapeSpring::of_scene(scene) {
        Some(_) => Some(("moment-rotation.svg", moment_rotation_plot(scene, records, name)?)),
        None => load_probe_plot(scene, records, name)?.map(|text| ("load-probe.svg", text)),
    })
}

/// The deformed surface as a picture and for ParaView.
fn surface(
    scene: &Scene,
    state: &State,
    picture: &Picture,
    field: Option<&str>,
) -> Result<[(&'static str, String); 2], Failure> {
    let State { mesh, displacement, .. } = state;
    let samples = match field {
        None => deformed_surface(scene, mesh, displacement, cells_per_element(mesh))?,
        Some(name) => {
            let (field, component) = named(scene, name)?;
            coloured_surface(scene, state, &field, component, cells_per_element(mesh))?
        }
    };
    Ok([("mesh.svg", mesh_picture(&samples, picture)), ("mesh.vtu", vtu(&samples))])
}

/// The field of this name, with the component that is named behind a point.
pub(super) fn named(scene: &Scene, name: &str) -> Result<(Field, Option<usize>), Failure> {
    let (of_field, of_component) = name.split_once('.').map_or((name, None), |(field, part)| (field, Some(part)));
    let fields = fields_of(scene);
    let found = fields.iter().find(|field| field.name == of_field).and_then(|field| match of_component {
        Some(component) => Some((field.clone(), Some(field.components.iter().position(|known| *known == component)?))),
        // One component is the value itself; of more the length is shown.
        None => Some((field.clone(), (field.components.len() == 1).then_some(0))),
    });
    found.ok_or_else(|| Failure::NoSuchField { field: name.to_owned(), known: fields.iter().map(listed).collect() })
}

/// A field with its components: `bending_moment.11/22/12`.
fn listed(field: &Field) -> String {
    match field.components {
        [_] => field.name.clone(),
        components => format!("{}.{}", field.name, components.join("/")),
    }
}

/// Whether a report has no reading of the probe that is drawn, as where the run began without it.
fn lacks_first_probe(scene: &Scene, report: &Report) -> bool {
    let first = scene.probes.first().filter(|_| TapeSpring::of_scene(scene).is_none());
    first.is_some_and(|first| report.probes.iter().all(|reading| reading.name != first.name))
}

/// Cells that make a coarse mesh look smooth and a fine one no larger than need be.
pub(super) fn cells_per_element(mesh: &Mesh) -> [usize; 2] {
    let [n1, n2] = mesh.element_counts();
    [SMOOTH.div_ceil(n1.max(n2)).clamp(2, 12); 2]
}

/// The numbers of the state that a picture shows.
fn subtitle(report: &Report) -> String {
    let Report { parameter, moment_n_mm, elements: [n1, n2], .. } = report;
    let reached = match report.driven_by {
        Parameter::Rotation => format!("θ {}°, M {moment_n_mm:.2} N·mm", rounded(*parameter)),
        Parameter::LoadFactor => format!("load factor {}", rounded(*parameter)),
    };
    format!("{reached}, {n1} × {n2} elements in the model")
}

/// "AZIMUTH,ELEVATION".
fn direction(text: &str) -> Result<ViewDirection, String> {
    let numbers = text.split_once(',').map(|(azimuth, elevation)| (azimuth.trim().parse(), elevation.trim().parse()));
    match numbers {
        Some((Ok(azimuth_deg), Ok(elevation_deg))) if f64::is_finite(azimuth_deg + elevation_deg) => {
            Ok(ViewDirection { azimuth_deg, elevation_deg })
        }
        _ => Err("two numbers of degrees are wanted, such as -62,24".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions() {
        assert_eq!(direction("-62, 24"), Ok(ViewDirection { azimuth_deg: -62.0, elevation_deg: 24.0 }));
        for wrong in ["", "1", "1,", "a,b", "inf,0", "1,2,3"] {
            assert!(direction(wrong).is_err(), "{wrong}");
        }
    }
}
