//! Fields: what pictures, files and viewers can show of a shell, each with its name, its unit and its components.
//!
//! Strains and resultants are in the axes of the shell: e₁ along u of the undeformed surface, e₂ = n × e₁. Their values are those
//! of the NURBS surface at the point asked for, not means of what elements integrate.

use std::cell::OnceCell;

use crate::energy::{GluedShell, Traction};
use crate::model::{FreeStrains, NaturalState};
use crate::scene::{Material, Scene};
use crate::shell::{Criterion, Layer, LocalPoint, gauss_legendre, layers, local_point, norm, principal, sub};
use crate::spline::{Grid, Patch, Spans, mid_surface_point, mid_surface_points};

/// A field of the shell.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name in files, viewers and arguments.
    pub name: String,
    /// The unit of its values; empty where they have none.
    pub unit: &'static str,
    /// The names of its components, at most three.
    pub components: &'static [&'static str],
    /// What it is.
    pub means: &'static str,
    quantity: Quantity,
}

/// What a field is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Displacement,
    MembraneStrain,
    PrincipalMembraneStrain,
    BendingStrain,
    PrincipalBendingStrain,
    LargestBendingStrain,
    MembraneForce,
    PrincipalMembraneForce,
    BendingMoment,
    PrincipalBendingMoment,
    EnergyDensity,
    Indicator,
    ElementSize,
    Thickness,
    /// What a bond carries along the normal.
    Peel,
    /// What a bond carries along the surface.
    BondShear,
    /// Strain of the layer with this number, from the bottom.
    Ply(usize),
    /// How near to failing a layer is, or that of all which is nearest.
    Failure(Criterion, Option<usize>),
}

const XYZ: &[&str] = &["x", "y", "z"];
const TENSOR: &[&str] = &["11", "22", "12"];
const PRINCIPAL: &[&str] = &["1", "2"];
const ALONG_AND_ACROSS: &[&str] = &["u", "v"];
const SCALAR: &[&str] = &[""];

/// A row of the list: name, unit, components, what it is.
type Row = (&'static str, &'static str, &'static [&'static str], &'static str, Quantity);

const FIELDS: [Row; 14] = [
    ("displacement", "mm", XYZ, "displacement from the undeformed shell", Quantity::Displacement),
    ("membrane_strain", "", TENSOR, "Green–Lagrange strains ε₁₁, ε₂₂, 2ε₁₂ of the surface", Quantity::MembraneStrain),
    ("membrane_strain_principal", "", PRINCIPAL, "principal membrane strains", Quantity::PrincipalMembraneStrain),
    ("bending_strain", "1/mm", TENSOR, "changes of curvature κ₁₁, κ₂₂, 2κ₁₂", Quantity::BendingStrain),
    ("bending_strain_principal", "1/mm", PRINCIPAL, "principal changes of curvature", Quantity::PrincipalBendingStrain),
    (
        "bending_strain_max",
        "1/mm",
        SCALAR,
        "the larger of |κ₁₁| along u and |κ₂₂| along v",
        Quantity::LargestBendingStrain,
    ),
    ("membrane_force", "N/mm", TENSOR, "membrane forces n₁₁, n₂₂, n₁₂", Quantity::MembraneForce),
    ("membrane_force_principal", "N/mm", PRINCIPAL, "principal membrane forces", Quantity::PrincipalMembraneForce),
    ("bending_moment", "N·mm/mm", TENSOR, "bending moments m₁₁, m₂₂, m₁₂", Quantity::BendingMoment),
    ("bending_moment_principal", "N·mm/mm", PRINCIPAL, "principal bending moments", Quantity::PrincipalBendingMoment),
    ("energy_density", "N·mm/mm²", SCALAR, "strain energy per undeformed area", Quantity::EnergyDensity),
    ("indicator", "", ALONG_AND_ACROSS, "refinement indicators |κ| h along u and v", Quantity::Indicator),
    (
        "element_size",
        "mm",
        ALONG_AND_ACROSS,
        "undeformed lengths of the element through its middle",
        Quantity::ElementSize,
    ),
    ("thickness", "mm", SCALAR, "thickness of the shell", Quantity::Thickness),
];

/// What only shells have that are glued.
const OF_BONDS: [Row; 2] = [
    (
        "bond_peel",
        "MPa",
        SCALAR,
        "traction of a bond across its layer, positive where it opens, per undeformed area; no number where nothing is glued",
        Quantity::Peel,
    ),
    (
        "bond_shear",
        "MPa",
        PRINCIPAL,
        "traction of a bond along its layer, on its first shell, in the deformed axes 1 and 2 of that",
        Quantity::BondShear,
    ),
];

const FAILURES: [(&str, &str, Criterion); 2] = [
    (
        "failure_tsai_wu",
        "load over the load at failure by Tsai and Wu (1/R, the inverse reserve factor, if all stresses grow alike; fails from 1 \
         on), at that face of a ply where it is largest",
        Criterion::TsaiWu,
    ),
    (
        "failure_max_strain",
        "strain over the strain at failure (strength over modulus; fails from 1 on), at that face of a ply where it is largest",
        Criterion::MaximumStrain,
    ),
];

/// All fields of the shells of a scene: those of any shell, the strains of every ply of a laminate, where strengths are given
/// how near to failing the shell and every ply is, and what bonds carry. Not every shell of a structure has all of them.
pub fn fields_of(scene: &Scene) -> Vec<Field> {
    let mut fields = fields_of_shell(&scene.of_shell(0));
    for index in 1..scene.shell_count() {
        let further = fields_of_shell(&scene.of_shell(index));
        let new: Vec<Field> = further.into_iter().filter(|field| !fields.contains(field)).collect();
        fields.extend(new);
    }
    if !scene.bonds.is_empty() {
        fields.extend(OF_BONDS.map(of_row));
    }
    fields
}

fn of_row((name, unit, components, means, quantity): Row) -> Field {
    Field { name: name.to_owned(), unit, components, means, quantity }
}

/// The fields of a shell alone.
fn fields_of_shell(scene: &Scene) -> Vec<Field> {
    let layers = layers(&scene.material);
    let plies = match &scene.material {
        Material::Laminate { .. } => &layers[..],
        Material::Isotropic { .. } | Material::Orthotropic { .. } => &[],
    };
    let strain_of = |ply: usize| Field {
        name: format!("ply_{}_strain", ply + 1),
        unit: "",
        components: TENSOR,
        means: "strains along the ply's fibres, across them and in shear (2ε₁₂), at that face of the ply where they are larger; \
                plies are counted from the bottom",
        quantity: Quantity::Ply(ply),
    };
    let failures = |ply: Option<usize>| {
        let prefix = ply.map_or(String::new(), |ply| format!("ply_{}_", ply + 1));
        FAILURES.map(|(name, means, criterion)| Field {
            name: format!("{prefix}{name}"),
            unit: "",
            components: SCALAR,
            means,
            quantity: Quantity::Failure(criterion, ply),
        })
    };
    let of_all = layers.iter().all(Layer::has_strengths).then(|| failures(None));
    let of_each = (0..plies.len()).filter(|ply| plies[*ply].has_strengths()).flat_map(|ply| failures(Some(ply)));
    let of_any_shell = FIELDS.into_iter().map(of_row);
    of_any_shell.chain((0..plies.len()).map(strain_of)).chain(of_all.into_iter().flatten()).chain(of_each).collect()
}

impl Field {
    /// Whether its components are those of a vector, which has a length.
    pub fn is_vector(&self) -> bool {
        matches!(self.quantity, Quantity::Displacement | Quantity::BondShear)
    }

    /// The name of a component, or of the length of all of them, with the unit, as axes and colour bars have it.
    pub fn title_of(&self, component: Option<usize>) -> String {
        let name = self.name.replace('_', " ");
        let of_component = component.and_then(|index| self.components.get(index)).filter(|name| !name.is_empty());
        let name = of_component.map_or(name.clone(), |component| format!("{name} {component}"));
        if self.unit.is_empty() { name } else { format!("{name} ({})", self.unit) }
    }

    /// The value at the image of a point in a plane of symmetry: across the length (`direction` 0, normal to x) or through the apex
    /// (1, normal to y). The axes of the image continue those of the shell.
    pub fn mirrored(&self, mut value: [f64; 3], direction: usize) -> [f64; 3] {
        match self.quantity {
            Quantity::Displacement => value[direction] = -value[direction],
            Quantity::MembraneStrain
            | Quantity::BendingStrain
            | Quantity::MembraneForce
            | Quantity::BendingMoment
            | Quantity::Ply(_) => value[2] = -value[2],
            _ => {}
        }
        value
    }
}

/// The fields of a shell in a state.
#[derive(Debug)]
pub struct ShellFields<'a> {
    scene: &'a Scene,
    mesh: &'a Patch,
    displacement: &'a [[f64; 3]],
    natural: Option<NaturalState>,
    spans: [Spans; 2],
    /// Undeformed lengths of the elements through their middles, mm, the second direction fastest.
    lengths: Vec<[f64; 2]>,
    layers: Vec<Layer>,
    /// What glues it to other shells.
    glued: Option<GluedShell<'a>>,
}

impl<'a> ShellFields<'a> {
    /// The fields of a shell alone, on its patch, displaced by `displacement` (mm, one vector for each control point) at a value of
    /// the scene's parameter.
    pub fn new(scene: &'a Scene, mesh: &'a Patch, displacement: &'a [[f64; 3]], parameter: f64) -> Self {
        let spans = [0, 1].map(|direction| Spans::of(&mesh.knots[direction], mesh.degree[direction]));
        Self {
            scene,
            mesh,
            displacement,
            natural: FreeStrains::new(scene, mesh).at(parameter),
            lengths: element_lengths(mesh, &spans),
            spans,
            layers: layers(&scene.material),
            glued: None,
        }
    }

    /// The same fields, with those of the bonds of a structure.
    pub(super) fn with_bonds(self, glued: Option<GluedShell<'a>>) -> Self {
        Self { glued, ..self }
    }

    /// The scene of the shell, its patch, and the displacement of its control points, mm.
    pub(super) fn parts(&self) -> (&'a Scene, &'a Patch, &'a [[f64; 3]]) {
        (self.scene, self.mesh, self.displacement)
    }

    /// Whether the shell has a field of the structure at all.
    pub fn has(&self, field: &Field) -> bool {
        self.has_quantity(field.quantity)
    }

    fn has_quantity(&self, quantity: Quantity) -> bool {
        let is_laminate = matches!(self.scene.material, Material::Laminate { .. });
        match quantity {
            Quantity::Ply(ply) => is_laminate && ply < self.layers.len(),
            Quantity::Failure(_, None) => self.layers.iter().all(Layer::has_strengths),
            Quantity::Failure(_, Some(ply)) => is_laminate && self.layers.get(ply).is_some_and(Layer::has_strengths),
            Quantity::Peel | Quantity::BondShear => self.glued.is_some(),
            _ => true,
        }
    }

    /// A point of the parameters (u, v), of which every field can be read.
    pub fn at(&self, at: [f64; 2]) -> FieldPoint<'_> {
        let [undeformed, deformed] = mid_surface_points(self.mesh, [&[], self.displacement], at);
        let moved = [0, 1, 2, 3, 4].map(|k| sub(deformed.derivatives[k], undeformed.derivatives[k]));
        let free = self.natural.as_ref().map(|natural| &natural.strain);
        let local = local_point(&self.scene.material, undeformed.derivatives, &moved, free);
        let [a1, a2, ..] = undeformed.derivatives;
        FieldPoint {
            shell: self,
            displacement: sub(deformed.position, undeformed.position),
            bending_along_parameters: along_parameters(local.bending, a1, a2),
            local,
            element: self.element_at(at),
            at,
            traction: OnceCell::new(),
        }
    }

    /// Least and largest value of each component over some points, or `None` without a point; what is no number counts for nothing.
    pub fn range(&self, field: &Field, points: impl Iterator<Item = [f64; 2]>) -> Option<[[f64; 2]; 3]> {
        let widened = |range: [[f64; 2]; 3], value: [f64; 3]| {
            [0, 1, 2].map(|c| [range[c][0].min(value[c]), range[c][1].max(value[c])])
        };
        let ranges = points.map(|at| self.at(at).value(field).map(|value| [value; 2]));
        ranges.reduce(|all, one| widened(widened(all, one.map(|range| range[0])), one.map(|range| range[1])))
    }

    fn element_at(&self, at: [f64; 2]) -> usize {
        let counts = [0, 1].map(|direction| self.spans[direction].count());
        let place = [0, 1].map(|direction| {
            let beyond = self.spans[direction].bounds.partition_point(|[_, to]| *to <= at[direction]);
            beyond.min(counts[direction] - 1)
        });
        Grid::new(counts).index(place)
    }
}

/// A point of a shell in a state: what its fields are read from.
#[derive(Debug)]
pub struct FieldPoint<'a> {
    shell: &'a ShellFields<'a>,
    /// Displacement, mm.
    displacement: [f64; 3],
    /// Strains and resultants.
    local: LocalPoint,
    /// |κ| per length along the parameter lines u and v.
    bending_along_parameters: [f64; 2],
    /// Index of its element, the second direction fastest.
    element: usize,
    /// Its parameters.
    at: [f64; 2],
    /// What a bond carries there, once it is asked for.
    traction: OnceCell<Option<Traction>>,
}

impl FieldPoint<'_> {
    /// The components of a field of the shell's scene; those beyond its number are 0. Where the shell does not have the field, or nothing
    /// is glued, they are no numbers.
    pub fn value(&self, field: &Field) -> [f64; 3] {
        let Self { shell, displacement, local, bending_along_parameters: [along, across], element, .. } = self;
        if !shell.has(field) {
            return [f64::NAN; 3];
        }
        let scalar = |value: f64| [value, 0.0, 0.0];
        let tensor_of_strains = |[xx, yy, shear]: [f64; 3]| [xx, yy, 0.5 * shear];
        let pair = |[one, two]: [f64; 2]| [one, two, 0.0];
        let lengths = shell.lengths[*element];
        match field.quantity {
            Quantity::Displacement => *displacement,
            Quantity::MembraneStrain => local.membrane,
            Quantity::PrincipalMembraneStrain => pair(principal(tensor_of_strains(local.membrane))),
            Quantity::BendingStrain => local.bending,
            Quantity::PrincipalBendingStrain => pair(principal(tensor_of_strains(local.bending))),
            Quantity::LargestBendingStrain => scalar(along.max(*across)),
            Quantity::MembraneForce => local.forces,
            Quantity::PrincipalMembraneForce => pair(principal(local.forces)),
            Quantity::BendingMoment => local.moments,
            Quantity::PrincipalBendingMoment => pair(principal(local.moments)),
            Quantity::EnergyDensity => scalar(local.energy),
            Quantity::Indicator => pair([along * lengths[0], across * lengths[1]]),
            Quantity::ElementSize => pair(lengths),
            Quantity::Thickness => scalar(shell.scene.material.thickness_mm()),
            Quantity::Peel => self.traction().map_or([f64::NAN; 3], |traction| scalar(traction.peel_mpa)),
            Quantity::BondShear => self.traction().map_or([f64::NAN; 3], |traction| pair(traction.shear_mpa)),
            Quantity::Ply(ply) => {
                let Some(Layer { heights, angle_deg, .. }) = shell.layers.get(ply) else { return [0.0; 3] };
                let [bottom, top] = heights.map(|height| local.strains_at(height, *angle_deg));
                [0, 1, 2].map(|i| if bottom[i].abs() > top[i].abs() { bottom[i] } else { top[i] })
            }
            Quantity::Failure(criterion, ply) => {
                let change_k = shell.natural.map_or(0.0, |natural| natural.change_k);
                let asked = ply.map_or(&shell.layers[..], |ply| shell.layers.get(ply..=ply).unwrap_or_default());
                scalar(asked.iter().map(|layer| layer.failure(criterion, local, change_k)).fold(0.0, f64::max))
            }
        }
    }
}

impl FieldPoint<'_> {
    /// What a bond carries here.
    fn traction(&self) -> Option<Traction> {
        *self.traction.get_or_init(|| self.shell.glued.as_ref()?.traction(self.at))
    }
}

/// |κ| per length along the parameter lines u and v, whose tangents are A₁ and A₂, from the bending strains in the shell's axes.
fn along_parameters([k11, k22, twice_k12]: [f64; 3], a1: [f64; 3], a2: [f64; 3]) -> [f64; 2] {
    // The line of v leaves e₁ by the angle between A₁ and A₂.
    let (s, c) = angle_between(a1, a2).sin_cos();
    [k11.abs(), (c * c * k11 + s * s * k22 + c * s * twice_k12).abs()]
}

/// The angle between two vectors, radians.
fn angle_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cosine = (0..3).map(|c| a[c] * b[c]).sum::<f64>() / (norm(a) * norm(b));
    cosine.clamp(-1.0, 1.0).acos()
}

/// Undeformed lengths of the elements through their middles, mm.
fn element_lengths(mesh: &Patch, spans: &[Spans; 2]) -> Vec<[f64; 2]> {
    let rule = gauss_legendre(mesh.degree[0].max(mesh.degree[1]) + 1);
    let elements = Grid::new([0, 1].map(|direction| spans[direction].count()));
    (0..elements.len())
        .map(|element| {
            let place = elements.place(element);
            let bounds = [0, 1].map(|direction| spans[direction].bounds[place[direction]]);
            let middle = bounds.map(|[from, to]| 0.5 * (from + to));
            [0, 1].map(|direction| {
                let [from, to] = bounds[direction];
                let speed = |[x, weight]: &[f64; 2]| {
                    let mut at = middle;
                    at[direction] = 0.5 * ((from + to) + x * (to - from));
                    0.5 * (to - from) * weight * norm(mid_surface_point(mesh, &[], at).derivatives[direction])
                };
                rule.iter().map(speed).sum()
            })
        })
        .collect()
}
