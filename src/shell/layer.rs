//! The layers of the shell: where they lie, what strains they lock in each other, and how near they are to failing.

use crate::scene::{Material, OrthotropicLaw, Ply, Strengths};
use crate::shell::free_strain::thermal_strain;
use crate::shell::local::{LocalPoint, at_height, turned_strains};
use crate::shell::material::{heights, plane_stress_stiffness};
use crate::shell::{dot, failure, sub};

/// A layer of the shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Heights of its bottom and its top above the surface of the geometry, mm.
    pub heights: [f64; 2],
    /// Angle of material axis 1 from e₁ towards e₂, degrees.
    pub angle_deg: f64,
    /// What decides whether it fails, where the scene gives that.
    strong: Option<Strong>,
}

/// What decides whether a layer fails.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strong {
    law: OrthotropicLaw,
    strengths: Strengths,
    /// Elastic strains of its faces per kelvin in a shell that is free of forces, in its own axes.
    locked_per_kelvin: [[f64; 3]; 2],
}

/// How near to failing a layer is: load over the load at failure, if all its stresses grow alike; 1 where it fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Tsai and Wu's.
    TsaiWu,
    /// Maximum strain.
    MaximumStrain,
}

/// The layers of a material from bottom to top: one unless it is a laminate.
pub fn layers(material: &Material) -> Vec<Layer> {
    let thermal = thermal_strain(material).map(|(per_kelvin, _)| per_kelvin);
    let layer = |heights: [f64; 2], angle_deg: f64, law: Option<&OrthotropicLaw>| {
        let locked = |law: &OrthotropicLaw, height: f64| {
            let (Some(shell), Some([along, across])) = (thermal, law.expansion_per_k()) else { return [0.0; 3] };
            sub(turned_strains(at_height(shell.membrane, shell.bending, height), angle_deg), [along, across, 0.0])
        };
        let strong = |law: &OrthotropicLaw| {
            let locked_per_kelvin = heights.map(|height| locked(law, height));
            law.strengths.map(|strengths| Strong { law: *law, strengths, locked_per_kelvin })
        };
        Layer { heights, angle_deg, strong: law.and_then(strong) }
    };
    let middle = -material.offset_mm();
    let whole = |thickness: f64| [middle - 0.5 * thickness, middle + 0.5 * thickness];
    match material {
        Material::Isotropic { thickness_mm, .. } => vec![layer(whole(*thickness_mm), 0.0, None)],
        Material::Orthotropic { thickness_mm, angle_deg, law, .. } => {
            vec![layer(whole(*thickness_mm), *angle_deg, Some(law))]
        }
        Material::Laminate { plies, offset_mm } => {
            let of_ply = |(heights, ply): ([f64; 2], &Ply)| layer(heights, ply.angle_deg, Some(&ply.law));
            heights(plies, *offset_mm).zip(plies).map(of_ply).collect()
        }
    }
}

impl Layer {
    /// Whether the scene gives its strengths.
    pub fn has_strengths(&self) -> bool {
        self.strong.is_some()
    }

    /// How near to failing it is at that of its faces where it is nearer, in a shell that is warmer by a change of temperature, K;
    /// 0 where its strengths are not given.
    pub fn failure(&self, criterion: Criterion, point: &LocalPoint, change_k: f64) -> f64 {
        let Some(Strong { law, strengths, locked_per_kelvin }) = &self.strong else { return 0.0 };
        let at_face = |face: usize| {
            let elastic = point.elastic_strains_at(self.heights[face], self.angle_deg);
            let strains = [0, 1, 2].map(|i| elastic[i] + change_k * locked_per_kelvin[face][i]);
            match criterion {
                Criterion::TsaiWu => {
                    let stresses = plane_stress_stiffness(law).map(|row| dot(row, strains));
                    failure::tsai_wu(strengths, stresses)
                }
                Criterion::MaximumStrain => failure::maximum_strain(law, strengths, strains),
            }
        };
        at_face(0).max(at_face(1))
    }
}
