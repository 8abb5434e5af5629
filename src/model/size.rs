//! The size of a shell in a few numbers, by which a slip of unit shows at once.

use std::fmt::{self, Display, Formatter};

use crate::model::ModelError;
use crate::model::start::starting_patch;
use crate::model::thinness::{Extent, side_mm};
use crate::scene::{Material, OrthotropicLaw, Scene, Symmetry};
use crate::spline::{Patch, Spans, mid_surface_point};
use crate::units::significant;

/// Samples of each span for the box.
const SAMPLES: usize = 8;

/// Lengths, thinness and stiffness of the whole shell, whatever part of it is modelled; of a structure, of all shells.
#[derive(Clone, Debug)]
pub struct Size {
    /// Least and largest coordinates in x, y and z, mm.
    bounds_mm: [[f64; 2]; 3],
    /// Lengths of the lines through the middle along u and v, mm.
    pub sides_mm: [f64; 2],
    /// Smallest radius of curvature except at tips, mm; `None` for a plane.
    pub radius_mm: Option<f64>,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Least and largest Young's modulus of the layers, MPa.
    pub moduli_mpa: [f64; 2],
}

impl Size {
    /// Measures the shell of a scene.
    ///
    /// # Errors
    /// Where the scene has no starting mesh.
    pub fn of(scene: &Scene) -> Result<Self, ModelError> {
        let sizes = (1..scene.shell_count()).map(|shell| Self::of_shell(scene, shell));
        let first = Self::of_shell(scene, 0)?;
        sizes.into_iter().try_fold(first, |all, one| Ok(all.and(one?)))
    }

    fn of_shell(scene: &Scene, shell: usize) -> Result<Self, ModelError> {
        let scene = scene.of_shell(shell).into_owned();
        let mesh = starting_patch(&Scene { symmetry: Symmetry::None, ..scene.clone() })?;
        let Extent { radius_mm, .. } = Extent::of(&mesh, &scene.material);
        let sides_mm = [0, 1].map(|direction| side_mm(&mesh, direction));
        let longest = sides_mm[0].max(sides_mm[1]);
        Ok(Self {
            bounds_mm: bounds_mm(&mesh),
            sides_mm,
            // Rounding curves a plane.
            radius_mm: (radius_mm < FLAT * longest).then_some(radius_mm),
            thickness_mm: scene.material.thickness_mm(),
            moduli_mpa: moduli_mpa(&scene.material),
        })
    }

    /// Sizes of two shells of one structure as one: the box of both, the sides of the longer one, the smallest radius and thickness.
    fn and(self, other: Self) -> Self {
        let longest = |size: &Self| size.sides_mm[0].max(size.sides_mm[1]);
        let radii = [self.radius_mm, other.radius_mm].into_iter().flatten();
        Self {
            bounds_mm: [0, 1, 2].map(|c| {
                let ([low, high], [other_low, other_high]) = (self.bounds_mm[c], other.bounds_mm[c]);
                [low.min(other_low), high.max(other_high)]
            }),
            sides_mm: if longest(&self) >= longest(&other) { self.sides_mm } else { other.sides_mm },
            radius_mm: radii.reduce(f64::min),
            thickness_mm: self.thickness_mm.min(other.thickness_mm),
            moduli_mpa: [self.moduli_mpa[0].min(other.moduli_mpa[0]), self.moduli_mpa[1].max(other.moduli_mpa[1])],
        }
    }

    /// Extents in x, y and z, mm.
    pub fn box_mm(&self) -> [f64; 3] {
        self.bounds_mm.map(|[low, high]| high - low)
    }

    /// Largest extent, mm.
    pub fn largest_mm(&self) -> f64 {
        self.box_mm().into_iter().fold(0.0, f64::max)
    }

    /// Smallest radius over thickness.
    pub fn radius_over_thickness(&self) -> Option<f64> {
        Some(self.radius_mm? / self.thickness_mm)
    }
}

/// Radius from which on a surface is a plane, as a multiple of its length.
const FLAT: f64 = 1e6;

impl Display for Size {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let shown = |value: f64| significant(value, 3);
        // A plane has a thickness of rounding.
        let least = 1e-9 * self.largest_mm();
        let [x, y, z] = self.box_mm().map(|length| shown(if length < least { 0.0 } else { length }));
        write!(f, "box {x} × {y} × {z} mm, ")?;
        let longest = self.sides_mm[0].max(self.sides_mm[1]);
        match self.radius_mm {
            Some(radius) => {
                let [over_thickness, length_over] = [radius / self.thickness_mm, longest / radius].map(shown);
                write!(f, "smallest radius {} mm, R/t {over_thickness}, L/R {length_over}, ", shown(radius))?;
            }
            None => write!(f, "flat, L/t {}, ", shown(longest / self.thickness_mm))?,
        }
        let [least, most] = self.moduli_mpa;
        match least == most {
            true => write!(f, "E {} MPa", shown(least)),
            false => write!(f, "E {} to {} MPa", shown(least), shown(most)),
        }
    }
}

/// The smallest and the largest Young's modulus of a material, MPa.
pub fn moduli_mpa(material: &Material) -> [f64; 2] {
    let moduli = laws(material).into_iter().flat_map(|(_, moduli)| moduli);
    moduli.fold([f64::INFINITY, 0.0], |[least, most], value| [least.min(value), most.max(value)])
}

/// The layers of a material, each in words that end where the name of a key follows, with its Young's moduli, MPa.
pub(super) fn laws(material: &Material) -> Vec<(String, Vec<f64>)> {
    let moduli = |law: &OrthotropicLaw| vec![law.youngs_modulus_1_mpa, law.youngs_modulus_2_mpa];
    match material {
        Material::Isotropic { youngs_modulus_mpa, .. } => vec![("material.".into(), vec![*youngs_modulus_mpa])],
        Material::Orthotropic { law, .. } => vec![("material.".into(), moduli(law))],
        Material::Laminate { plies, .. } => {
            let of_ply = |(index, ply): (usize, &crate::scene::Ply)| (format!("ply {}: ", index + 1), moduli(&ply.law));
            plies.iter().enumerate().map(of_ply).collect()
        }
    }
}

/// Least and largest coordinates of a surface along the axes, mm, from samples of each span and its ends.
fn bounds_mm(mesh: &Patch) -> [[f64; 2]; 3] {
    let [us, vs] = [0, 1].map(|direction| {
        let spans = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
        let within = |[from, to]: [f64; 2]| (0..=SAMPLES).map(move |k| from + (to - from) * k as f64 / SAMPLES as f64);
        spans.into_iter().flat_map(within).collect::<Vec<f64>>()
    });
    let points = us.iter().flat_map(|u| vs.iter().map(move |v| mid_surface_point(mesh, &[], [*u, *v]).position));
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for point in points {
        for (bound, x) in bounds.iter_mut().zip(point) {
            *bound = [bound[0].min(x), bound[1].max(x)];
        }
    }
    bounds
}
