//! Whether a whole shell is its own mirror image in the plane of a line inside.
//!
//! A symmetric line inside holds what a symmetric shell does by itself. On any other shell it would add a support that
//! does not exist: surface, supports and actions must be mapped onto themselves. The parameter across the line goes
//! over into 1 − ξ; tangents along it are mirrored and those across mirrored and turned round, so that the normal of
//! the image is the image of the normal: loads along directions of the surface keep their size. Forces and translations
//! are mirrored, moments and turns mirrored and turned round. Actions on the whole surface are checked on the line
//! ([`super::mirror_check`]).

use crate::model::ModelError;
use crate::model::edge::{on_edge, side};
use crate::model::limits::{ANGLE, POSITION, ROUNDING, SAME_PARAMETER};
use crate::model::mirror::Mirror;
use crate::model::parametrize::{parameters_of, sample_parameters};
use crate::model::scene_supports::supports_of;
use crate::model::symmetry_plane::unit;
use crate::scene::{
    Action, ActionKind, ForceVector, History, Hold, Motion, ParametricDirection, Region, Scene, Seam, Support,
};
use crate::shell::{dot, norm, scaled, sub};
use crate::spline::{Patch, mid_surface_point};
use crate::units::{place, significant};

/// A vector whose components are given or free.
type Given = [Option<f64>; 3];

/// A mirror plane with the shell on both sides.
struct Plane {
    normal: [f64; 3],
    /// Point of the plane, mm.
    origin: [f64; 3],
    /// Distance below which a difference is rounding of coordinates, mm.
    rounding_mm: f64,
}

/// A support or an action, reduced to what a mirror changes.
#[derive(Clone)]
struct SupportOrAction {
    /// Name, in words.
    name: String,
    /// Everything that no mirror changes, as text.
    kind: String,
    /// Points of its place: one, or start, middle and end of a line; none for the whole surface.
    points: Vec<[f64; 3]>,
    /// How far across the line its place is, as a parameter from the line: it tells the lips of a slit apart, which lie in one place.
    /// 0 where it reaches over both sides.
    side: f64,
    /// Vectors that are mirrored: forces, translations, arms.
    vectors: Vec<Given>,
    /// Vectors that are mirrored and turned round: moments and turns.
    turns: Vec<Given>,
    history: History,
}

/// Refuses a shell that is not its own mirror image in the plane of a line inside.
///
/// # Errors
/// Where the line is not in the middle of the shell, or a surface point, a support or an action has no image.
pub(super) fn check_own_image(scene: &Scene, mesh: &Patch, mirror: &Mirror) -> Result<(), ModelError> {
    let refused = |what: String| Err(ModelError::NotItsOwnImage { support: mirror.support.clone(), what });
    if (mirror.parameter - 0.5).abs() > SAME_PARAMETER {
        return refused("the line does not lie in its middle, at 0.5".into());
    }
    let origin = mirror.point(mesh, 0.0).position;
    let samples = samples(mesh, mirror.direction);
    let size = samples.iter().map(|[point, _]| norm(sub(*point, origin))).fold(0.0, f64::max);
    let plane = Plane { normal: mirror.normal, origin, rounding_mm: POSITION * size };
    let off = samples.iter().map(|[point, opposite]| (norm(sub(plane.point(*point), *opposite)), *point));
    let (off_mm, at) = off.fold((0.0, origin), |worst, one| if one.0 > worst.0 { one } else { worst });
    if off_mm > plane.rounding_mm {
        let [off, most] = [off_mm, plane.rounding_mm].map(|value| significant(value, 3));
        let at = place(at);
        return refused(format!(
            "the image of {at} is {off} mm off the surface (up to {most} mm is taken for rounding)"
        ));
    }
    let supports = supports_of(scene);
    let across = mirror.direction;
    let supports = supports.iter().map(|support| SupportOrAction::of_support(scene, mesh, support, across, origin));
    let actions = scene.actions.iter().filter_map(|action| SupportOrAction::of_action(scene, mesh, action, across));
    let parts: Vec<SupportOrAction> = supports.chain(actions).collect();
    let count = |part: &SupportOrAction| parts.iter().filter(|other| plane.is_same(part, other)).count();
    let unmatched = |part: &&SupportOrAction| plane.image(part).is_none_or(|image| count(&image) != count(part));
    match parts.iter().find(unmatched) {
        Some(part) => refused(format!("{} has no mirror image on the other side", part.name)),
        None => Ok(()),
    }
}

/// Points of the surface, two in every span in each direction, each with the opposite one.
fn samples(mesh: &Patch, direction: usize) -> Vec<[[f64; 3]; 2]> {
    let [us, vs] = [0, 1].map(|direction| sample_parameters(mesh, direction));
    let pair = |at: [f64; 2]| {
        let mut opposite = at;
        opposite[direction] = 1.0 - at[direction];
        [at, opposite].map(|at| mid_surface_point(mesh, &[], at).position)
    };
    us.iter().flat_map(|u| vs.iter().map(move |v| [*u, *v])).map(pair).collect()
}

/// Points that distinguish a place from others.
fn points_of(scene: &Scene, mesh: &Patch, on: Region) -> Vec<[f64; 3]> {
    let along = |direction: usize, fraction: f64| {
        [0.0, 0.5, 1.0].map(|along| if direction == 0 { [fraction, along] } else { [along, fraction] }).to_vec()
    };
    let fractions = match on {
        Region::Point(at) => vec![at],
        Region::Line(ParametricDirection::U, fraction) => along(0, fraction),
        Region::Line(ParametricDirection::V, fraction) => along(1, fraction),
        Region::Edge(edge) => {
            let (direction, at_end) = side(edge);
            along(direction, if at_end { 1.0 } else { 0.0 })
        }
        Region::Whole => vec![],
    };
    let position = |at: [f64; 2]| mid_surface_point(mesh, &[], parameters_of(&scene.geometry, at)).position;
    fractions.into_iter().map(position).collect()
}

/// How far a place is from the middle in the direction across the line. Both ends of a closed shell are one place.
fn side_of(scene: &Scene, on: Region, across: usize) -> f64 {
    let fraction = match on {
        Region::Edge(edge) if side(edge).0 == across => f64::from(u8::from(side(edge).1)),
        Region::Line(direction, fraction) if direction.index() == across => fraction,
        Region::Point(at) => at[across],
        Region::Edge(_) | Region::Line(..) | Region::Whole => return 0.0,
    };
    let is_end = fraction == 0.0 || fraction == 1.0;
    if is_end && scene.geometry.seam() == Some(Seam::Smooth) { 0.0 } else { fraction - 0.5 }
}

impl SupportOrAction {
    fn of_support(scene: &Scene, mesh: &Patch, support: &Support, across: usize, origin: [f64; 3]) -> Self {
        let (kind, vectors, turns) = match &support.hold {
            Hold::Symmetric => ("symmetric", vec![], vec![]),
            Hold::RigidMotions => ("rigid motions", vec![], vec![]),
            Hold::Displacement { displacement_mm } => ("displacement", vec![*displacement_mm], vec![]),
            Hold::Rigid { motions, reference_mm, normals_turn } => {
                let value = |motion: Motion| match motion {
                    Motion::Given(value) => Some(value),
                    Motion::Free(_) => None,
                };
                let [x, y, z, about_x, about_y, about_z] = motions.map(value);
                let arm = reference_mm.map(|point| sub(point, origin).map(Some));
                let kind = if *normals_turn { "clamped section" } else { "hinged section" };
                (kind, [Some([x, y, z]), arm].into_iter().flatten().collect(), vec![[about_x, about_y, about_z]])
            }
        };
        Self {
            name: format!("support \"{}\"", support.name),
            kind: kind.into(),
            points: points_of(scene, mesh, support.on),
            side: side_of(scene, support.on, across),
            vectors,
            turns,
            history: support.history.clone(),
        }
    }

    /// Creates the description of an action; `None` for one on the whole surface.
    fn of_action(scene: &Scene, mesh: &Patch, action: &Action, across: usize) -> Option<Self> {
        let forced = |kind: &str, force: ForceVector| match force {
            ForceVector::Components(force) => (kind.to_owned(), vec![force.map(Some)], vec![]),
            ForceVector::Along(size, direction) => (format!("{kind} of {size:?} {direction:?}"), vec![], vec![]),
        };
        let place_of = |section: &str| Some(scene.supports.iter().find(|support| support.name == section)?.on);
        let (on, (kind, vectors, turns)) = match &action.kind {
            ActionKind::Force { on, force_n } => (Region::Point(*on), forced("force", *force_n)),
            ActionKind::LineForce { on, force_n_per_mm } => (*on, forced("line force", *force_n_per_mm)),
            ActionKind::SectionForce { section, force_n } => {
                (place_of(section)?, forced("section force", ForceVector::Components(*force_n)))
            }
            ActionKind::SectionMoment { section, moment_n_mm, about, .. } => {
                let mut turn = [0.0; 3];
                turn[*about as usize] = *moment_n_mm;
                (place_of(section)?, ("section moment".into(), vec![], vec![turn.map(Some)]))
            }
            &ActionKind::EdgeMoment { on, moment_n } => {
                let (direction, _) = side(on);
                let along = unit(on_edge(mesh, on, 0.5).derivatives[1 - direction]);
                (Region::Edge(on), ("edge moment".into(), vec![], vec![scaled(moment_n, along).map(Some)]))
            }
            ActionKind::AreaForce { .. }
            | ActionKind::Gravity { .. }
            | ActionKind::Pressure { .. }
            | ActionKind::Temperature { .. }
            | ActionKind::NaturalCurvature { .. } => return None,
        };
        Some(Self {
            name: format!("action \"{}\"", action.name),
            kind,
            points: points_of(scene, mesh, on),
            side: side_of(scene, on, across),
            vectors,
            turns,
            history: action.history.clone(),
        })
    }
}

impl Plane {
    fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        sub(vector, scaled(2.0 * dot(vector, self.normal), self.normal))
    }

    fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let arm = sub(point, self.origin);
        sub(point, scaled(2.0 * dot(arm, self.normal), self.normal))
    }

    /// Mirrors a vector; `None` where the image of a given component has a share along one that is free.
    fn given(&self, vector: &Given) -> Option<Given> {
        let mixes = |i: usize, j: usize| i != j && (self.normal[i] * self.normal[j]).abs() > ROUNDING;
        let parted = |i: usize| (0..3).any(|j| mixes(i, j) && vector[i].is_some() != vector[j].is_some());
        let image = self.vector(vector.map(Option::unwrap_or_default));
        (!(0..3).any(parted)).then(|| [0, 1, 2].map(|c| vector[c].map(|_| image[c])))
    }

    fn image(&self, part: &SupportOrAction) -> Option<SupportOrAction> {
        let turned = |turn: &Given| Some(self.given(turn)?.map(|component| component.map(|value| -value)));
        Some(SupportOrAction {
            points: part.points.iter().map(|point| self.point(*point)).collect(),
            side: -part.side,
            vectors: part.vectors.iter().map(|vector| self.given(vector)).collect::<Option<_>>()?,
            turns: part.turns.iter().map(turned).collect::<Option<_>>()?,
            ..part.clone()
        })
    }

    /// Whether two of them do the same in the same place. A mirror reverses lines that cross it.
    fn is_same(&self, one: &SupportOrAction, other: &SupportOrAction) -> bool {
        let near = |(a, b): (&[f64; 3], &[f64; 3])| norm(sub(*a, *b)) <= 2.0 * self.rounding_mm;
        let alike = |(a, b): (&Given, &Given)| {
            let [x, y] = [a, b].map(|vector| vector.map(Option::unwrap_or_default));
            let free = |vector: &Given| vector.map(|component| component.is_none());
            free(a) == free(b) && norm(sub(x, y)) <= 2.0 * ANGLE * norm(x)
        };
        let all_alike = |a: &[Given], b: &[Given]| a.len() == b.len() && a.iter().zip(b).all(alike);
        one.kind == other.kind
            && one.history == other.history
            && (one.side - other.side).abs() <= SAME_PARAMETER
            && one.points.len() == other.points.len()
            && (one.points.iter().zip(&other.points).all(near)
                || one.points.iter().zip(other.points.iter().rev()).all(near))
            && all_alike(&one.vectors, &other.vectors)
            && all_alike(&one.turns, &other.turns)
    }
}
