//! A state of a log as a picture of its mesh.

use std::path::Path;

use super::failure::Failure;
use super::plotted::name_of;
use crate::record::{Parameter, Report};
use crate::scene::Scene;
use crate::spline::Mesh;
use crate::state::State;
use crate::units::rounded;
use crate::view::{
    Field, Marks, Picture, SurfaceSamples, ViewDirection, coloured_surface, deformed_surface, fields_of, viewpoint,
};

/// Cells along a picture that look smooth.
const SMOOTH: usize = 120;

/// How a mesh is shown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look<'f> {
    /// Where it is seen from; `None` for where its shells are seen well.
    pub(super) direction: Option<ViewDirection>,
    /// Name of the field that it is coloured by; `None` for the larger bending strain.
    pub(super) field: Option<&'f str>,
}

/// The deformed surface of a state, and the picture of it.
pub(super) fn pictured(
    log: &Path,
    scene: &Scene,
    state: &State,
    report: &Report,
    Look { direction, field }: &Look,
) -> Result<(SurfaceSamples, Picture), Failure> {
    let State { mesh, displacement, .. } = state;
    let samples = match field {
        None => deformed_surface(scene, mesh, displacement, cells_per_element(mesh))?,
        Some(name) => {
            let (field, component) = named(scene, name)?;
            coloured_surface(scene, state, &field, component, cells_per_element(mesh))?
        }
    };
    let picture = Picture {
        direction: direction.unwrap_or_else(|| viewpoint(&samples)),
        title: format!("{}, load step {}", name_of(log), report.step),
        subtitle: subtitle(report),
        marks: Marks::of(scene, state),
        ..Picture::default()
    };
    Ok((samples, picture))
}

/// The field of this name, with the component that is named behind a point.
pub(super) fn named(scene: &Scene, name: &str) -> Result<(Field, Option<usize>), Failure> {
    let (of_field, of_component) = name.split_once('.').map_or((name, None), |(field, part)| (field, Some(part)));
    let fields = fields_of(scene);
    let found = fields.iter().find(|field| field.name == of_field).and_then(|field| match of_component {
        Some(component) => Some((field.clone(), Some(field.components.iter().position(|known| *known == component)?))),
        // One component is the value itself, and of a vector the length is shown; a tensor has none.
        None => match field.components {
            [_] => Some((field.clone(), Some(0))),
            _ if field.is_vector() => Some((field.clone(), None)),
            _ => None,
        },
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

/// Cells that make a coarse mesh look smooth and a fine one no larger than need be.
pub(super) fn cells_per_element(mesh: &Mesh) -> [usize; 2] {
    let most = mesh.elements().each().iter().flatten().copied().max().unwrap_or(1);
    [SMOOTH.div_ceil(most).clamp(2, 12); 2]
}

/// The numbers of the state that a picture shows.
fn subtitle(report: &Report) -> String {
    let Report { parameter, moment_n_mm, elements, .. } = report;
    let reached = match report.driven_by {
        Parameter::Rotation => format!("θ {}°, M {moment_n_mm:.2} N·mm", rounded(*parameter)),
        Parameter::LoadFactor => format!("load factor {}", rounded(*parameter)),
    };
    format!("{reached}, {elements} elements in the model")
}
