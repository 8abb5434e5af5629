//! Runs next to each other: what each came to and cost, and where the curves of two part most.
//!
//! Between load steps curves are straight, as they are drawn. Where one run has jumped and the other has not they are on different
//! branches, and what differs is where they jump: curves are compared up to the first jump of either, and behind those of both.

use std::borrow::Cow;

use super::accuracy::{CurvePoint, SAME};
use super::path::{PathPoint, equilibrium_path};
use super::summary::Summary;
use crate::record::{Parameter, Record};
use crate::scene::Scene;

/// A number that a run came to or cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is; the same in every run that has it.
    pub name: Cow<'static, str>,
    /// Its unit; empty where it has none.
    pub unit: Cow<'static, str>,
    /// The number.
    pub value: f64,
}

impl Summary {
    /// What can be compared with other runs: results first, then the mesh at the end, then the work. What the run has not come to is
    /// left out.
    pub fn findings(&self) -> Vec<Finding> {
        let turns = self.driven_by == Parameter::Rotation;
        let at = if turns { "°" } else { "" };
        let finding = |name: &'static str, unit: &'static str, value: Option<f64>| {
            value.map(|value| Finding { name: name.into(), unit: unit.into(), value })
        };
        let snap = self.snaps.first();
        let limit = self.passed.iter().find(|passed| passed.critical.name().starts_with("limit point"));
        let bifurcation = self.passed.iter().find(|passed| passed.critical.is_bifurcation());
        let moment = |value: Option<f64>| value.filter(|_| turns);
        let of_curve = [
            finding("stiffness", "N·mm/rad", moment(self.initial_stiffness_n_mm)),
            finding("peak moment", "N·mm", moment(self.peak.map(|peak| peak.moment_n_mm))),
            finding("peak at", at, moment(self.peak.map(|peak| peak.parameter))),
            finding("limit point at", at, limit.map(|limit| limit.parameter)),
            finding("moment there", "N·mm", moment(limit.map(|limit| limit.moment_n_mm))),
            limit.filter(|_| !turns).and_then(|limit| limit.probe).zip(self.probes.first()).map(|(value, first)| {
                Finding { name: "probe there".into(), unit: first.unit.to_string().into(), value }
            }),
            finding("bifurcation at", at, bifurcation.map(|bifurcation| bifurcation.parameter)),
            finding("jumps", "", Some(self.snaps.len() as f64)),
            finding("jump from", at, snap.map(|snap| snap.before)),
            finding("jump to", at, snap.map(|snap| snap.after)),
            finding("moment behind it", "N·mm", moment(snap.map(|snap| snap.moment_after_n_mm))),
            finding("released energy", "N·mm", snap.and_then(|snap| snap.energy_released_n_mm)),
            finding("fold moment", "N·mm", moment(self.fold.map(|fold| fold.moment_n_mm))),
        ];
        let probes = self.probes.iter().map(|reading| Finding {
            name: reading.name.clone().into(),
            unit: reading.unit.to_string().into(),
            value: reading.value,
        });
        let mesh = self.meshes.last();
        let elements = mesh.map(|mesh| (self.symmetric_parts * mesh.elements.count()) as f64);
        let sum = |number: fn(&super::summary::StageWork) -> usize| self.work.iter().map(number).sum::<usize>() as f64;
        let of_end = [
            finding("reached", at, self.last.as_ref().map(|last| last.parameter)),
            finding("strain energy", "N·mm", self.last.as_ref().map(|last| last.strain_energy_n_mm)),
            finding("elements (whole)", "", elements),
            finding("unknowns", "", mesh.map(|mesh| mesh.unknowns as f64)),
            finding("load steps", "", Some(self.load_steps as f64)),
            finding("rejected solves", "", Some(self.rejections as f64)),
            finding("iterations", "", Some(sum(|work| work.iterations))),
            finding("factorizations", "", Some(sum(|work| work.factorizations))),
            finding("wall time", "s", Some(self.wall_s())),
        ];
        of_curve.into_iter().flatten().chain(probes).chain(of_end.into_iter().flatten()).collect()
    }
}

/// What a run is looked at by: the moment of its turning ends over their rotation, or the first probe, else the strain energy, over
/// the load factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What drives the run.
    pub driven_by: Parameter,
    /// Name of the quantity, with its unit.
    pub quantity: String,
    points: Vec<CurvePoint>,
}

/// Where two curves part most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Parameter there.
    pub parameter: f64,
    /// The difference, as a share of the largest value of the first curve on that side of the jump.
    pub share: f64,
}

/// Why curves are not compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// They show different quantities over different parameters.
    #[error("it shows {own}, and the first {other}")]
    OtherQuantity {
        /// What the second curve shows.
        own: String,
        /// What the first one shows.
        other: String,
    },
    /// One has two values at one parameter.
    #[error("by arc length a path passes one load more than once")]
    TurnsBack,
}

impl Curve {
    /// Reads the curve of a run of `scene` from its records.
    pub fn of(scene: &Scene, records: &[Record]) -> Self {
        let (driven_by, probe) = (Parameter::of(scene), scene.probes.first());
        let turns = driven_by == Parameter::Rotation;
        let quantity = match probe {
            _ if turns => "moment (N·mm)".to_owned(),
            Some(probe) => {
                let reading = records.iter().find_map(|record| record.report.probes.first());
                reading.map_or(probe.name.clone(), |reading| format!("{} ({})", probe.name, reading.unit))
            }
            None => "strain energy (N·mm)".to_owned(),
        };
        let value = |point: &PathPoint| match (turns, probe.is_some()) {
            (true, _) => Some(point.moment_n_mm),
            (false, true) => point.probe,
            (false, false) => Some(point.strain_energy_n_mm),
        };
        let mut behind = false;
        let points = equilibrium_path(records).into_iter().filter_map(|point| {
            behind |= point.jumped;
            Some(CurvePoint { parameter: point.parameter, value: value(&point)?, behind })
        });
        Self { driven_by, quantity, points: points.collect() }
    }

    /// Where another curve deviates most from this one: before the first jump of either, and behind those of both.
    ///
    /// # Errors
    /// Where they show something else, or one of them turns back.
    pub fn deviations(&self, other: &Curve) -> Result<[Option<Deviation>; 2], CurveError> {
        if (self.driven_by, &self.quantity) != (other.driven_by, &other.quantity) {
            let shown = |curve: &Curve| match curve.driven_by {
                Parameter::Rotation => format!("{} over the rotation", curve.quantity),
                Parameter::LoadFactor => format!("{} over the load factor", curve.quantity),
            };
            return Err(CurveError::OtherQuantity { own: shown(other), other: shown(self) });
        }
        let [[before, behind], [other_before, other_behind]] = [self, other].map(Curve::sides);
        let rises = |side: &Vec<[f64; 2]>| side.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if ![&before, &behind, &other_before, &other_behind].into_iter().all(rises) {
            return Err(CurveError::TurnsBack);
        }
        Ok([deviation(&before, &other_before), deviation(&behind, &other_behind)])
    }

    /// Parameters and values before the first jump and behind it.
    fn sides(&self) -> [Vec<[f64; 2]>; 2] {
        [false, true].map(|behind| {
            let on_side = self.points.iter().filter(|point| point.behind == behind);
            on_side.map(|point| [point.parameter, point.value]).collect()
        })
    }
}

/// Where two polylines over a rising parameter part most, at the points of either that both span; `None` where they span none.
fn deviation(first: &[[f64; 2]], second: &[[f64; 2]]) -> Option<Deviation> {
    let largest = first.iter().map(|[_, value]| value.abs()).fold(0.0, f64::max);
    let apart = first
        .iter()
        .chain(second)
        .filter_map(|[at, _]| Some((*at, (value_at(first, *at)? - value_at(second, *at)?).abs())));
    let (parameter, most) = apart.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (largest > 0.0).then_some(Deviation { parameter, share: most / largest })
}

/// Value of a polyline at a parameter; `None` beyond its ends.
fn value_at(points: &[[f64; 2]], at: f64) -> Option<f64> {
    let is_same = |[parameter, _]: &&[f64; 2]| (parameter - at).abs() <= SAME * at.abs();
    if let Some([_, value]) = points.iter().find(is_same) {
        return Some(*value);
    }
    let after = points.partition_point(|[parameter, _]| *parameter < at);
    let ([x0, y0], [x1, y1]) = (points.get(after.checked_sub(1)?)?, points.get(after)?);
    Some(y0 + (y1 - y0) * (at - x0) / (x1 - x0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64, bool)]) -> Curve {
        let of = |&(parameter, value, behind): &(f64, f64, bool)| CurvePoint { parameter, value, behind };
        let (driven_by, quantity) = (Parameter::LoadFactor, "tip".to_owned());
        Curve { driven_by, quantity, points: points.iter().map(of).collect() }
    }

    #[test]
    fn curves_are_compared_between_their_points_and_on_either_side_of_their_jumps() {
        let first = curve(&[(1.0, 10.0, false), (3.0, 30.0, false), (4.0, 5.0, true), (5.0, 8.0, true)]);
        // Jumps later; at 2 it is 2 above the line of the first.
        let second = curve(&[(1.0, 10.0, false), (2.0, 22.0, false), (4.0, 44.0, false), (5.0, 7.6, true)]);
        let [before, behind] = first.deviations(&second).unwrap().map(Option::unwrap);
        assert_eq!((before.parameter, behind.parameter), (3.0, 5.0));
        assert!((before.share - 3.0 / 30.0).abs() < 1e-12 && (behind.share - 0.4 / 8.0).abs() < 1e-12);
        assert_eq!(first.deviations(&first).unwrap().map(|side| side.map(|it| it.share)), [Some(0.0), Some(0.0)]);
    }

    #[test]
    fn what_does_not_compare_says_so() {
        let (first, beyond) = (curve(&[(1.0, 1.0, false)]), curve(&[(2.0, 1.0, false)]));
        assert_eq!(first.deviations(&beyond), Ok([None, None]));
        let back = curve(&[(1.0, 1.0, false), (2.0, 2.0, false), (1.5, 3.0, false)]);
        assert_eq!(first.deviations(&back), Err(CurveError::TurnsBack));
        let other = Curve { quantity: "pull".into(), ..first.clone() };
        assert!(matches!(first.deviations(&other), Err(CurveError::OtherQuantity { .. })));
    }
}
