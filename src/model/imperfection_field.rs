//! Imperfections that are given as a function of the place: a random field, or measured offsets along the normal of one shell. The
//! spline takes their values at its Greville points.

use rayon::prelude::*;

use crate::model::imperfection::thinnest_mm;
use crate::model::largest_offset::SurfaceSample;
use crate::model::parametrize::fractions_of;
use crate::model::random_field::RandomField;
use crate::scene::{Geometry, Imperfection, ImperfectionKind, Scene};
use crate::shell::{cross, dot, norm, scaled, sub};
use crate::spline::{Interpolation, Mesh, ScalarSurface, mid_surface_point};

/// Share of a field that a mesh does not show from which on that is said.
const NOT_SHOWN: f64 = 0.1;

/// An imperfection as a function of the place on the perfect surfaces.
#[derive(Debug)]
pub enum ImperfectionField<'s> {
    /// A field in space.
    Random(RandomField),
    /// Offsets along the normal of one shell.
    Measured {
        /// The shell.
        shell: usize,
        /// Its geometry.
        geometry: &'s Geometry,
        /// Offsets at fractions of u and v.
        offsets: ScalarSurface,
        /// Factor of them.
        scale: f64,
    },
}

impl<'s> ImperfectionField<'s> {
    /// The field of an imperfection; `None` where it is none.
    pub fn of(scene: &'s Scene, imperfection: &'s Imperfection) -> Option<Self> {
        match &imperfection.kind {
            ImperfectionKind::Modes { .. } => None,
            ImperfectionKind::RandomField { seed, correlation_mm, deviation } => {
                Some(Self::Random(RandomField::new(*seed, *correlation_mm, deviation * thinnest_mm(scene))))
            }
            ImperfectionKind::Grid { shell, offsets, scale } => Some(Self::Measured {
                shell: *shell,
                geometry: scene.shells.get(*shell).map_or(&scene.geometry, |own| &own.geometry),
                offsets: ScalarSurface::through([&offsets.u, &offsets.v], &offsets.offsets_mm),
                scale: *scale,
            }),
        }
    }

    /// Whether it is smooth in space, so that what is joined stays so but for what the spline is off.
    pub fn is_smooth_in_space(&self) -> bool {
        matches!(self, Self::Random(_))
    }

    /// The offset at a place of a patch, mm.
    fn at(&self, mesh: &Mesh, patch: usize, parameters: [f64; 2]) -> [f64; 3] {
        let point = || mid_surface_point(&mesh.patches[patch], &[], parameters);
        match self {
            Self::Random(field) => field.at(point().position),
            Self::Measured { shell, .. } if *shell != patch => [0.0; 3],
            Self::Measured { geometry, offsets, scale, .. } => {
                let [a1, a2, ..] = point().derivatives;
                let normal = cross(a1, a2);
                scaled(scale * offsets.at(fractions_of(geometry, parameters)) / norm(normal), normal)
            }
        }
    }

    /// The moves of the control points of the perfect surfaces.
    pub fn moves(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        let of_patch = |patch: usize| {
            let interpolation = Interpolation::new(&mesh.patches[patch]);
            let values: Vec<[f64; 3]> =
                interpolation.grid().into_par_iter().map(|parameters| self.at(mesh, patch, parameters)).collect();
            interpolation.control_values(&values)
        };
        (0..mesh.patches.len()).flat_map(of_patch).collect()
    }

    /// Root mean square of what the surfaces of a mesh do not show of it, relative to that of all of it, where that is much.
    pub fn not_shown(&self, mesh: &Mesh) -> Option<f64> {
        let moves = self.moves(mesh);
        let [mut lost, mut all] = [0.0; 2];
        for sample in SurfaceSample::all(mesh) {
            let wanted = self.at(mesh, sample.patch, sample.parameters);
            let difference = sub(wanted, sample.moved(mesh, &moves));
            lost += sample.area * dot(difference, difference);
            all += sample.area * dot(wanted, wanted);
        }
        let share = (lost / all).sqrt();
        (share > NOT_SHOWN).then_some(share)
    }
}
