//! Error against effort: the same path of equilibria on one mesh after another.
//!
//! A tape spring is followed by arc length from the unfolded shell past its limit point, down the unstable path and up the
//! fold. What is compared are the peak of the moment, the two limit points, and the moments at one rotation on the unstable
//! path and on the fold.

use crate::record::{Outcome, Record};
use crate::scene::{ArcLength, ArcLengthWord, Load, Scene, Stage};
use crate::study::archive::Done;

/// Points of the path through which its quantities are interpolated.
const INTERPOLATED: usize = 6;
/// Parts into which an interpolated stretch is divided to find its top.
const PARTS: usize = 2000;
/// Limit points are located to this, degrees: a hundredth of what is asked of them.
const LOCATED_DEG: f64 = 1e-4;

/// The results of a scene on one mesh.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct ConvergenceRow {
    /// Degree each way.
    pub degree: [usize; 2],
    /// Elements each way over the whole shell.
    pub elements: [usize; 2],
    /// Free unknowns of the model.
    pub unknowns: usize,
    /// Peak of the moment, N·mm, and the rotation there, degrees.
    pub peak: Option<[f64; 2]>,
    /// First limit point: rotation, degrees, and moment, N·mm.
    pub limit: Option<[f64; 2]>,
    /// Lowest limit point, where the unstable path ends in the fold: rotation and moment.
    pub fold_begins: Option<[f64; 2]>,
    /// Moment on the unstable path at the requested rotation, N·mm.
    pub unstable_n_mm: Option<f64>,
    /// Moment on the fold at the last rotation, N·mm.
    pub fold_n_mm: Option<f64>,
    /// Number of load steps.
    pub steps: u64,
    /// Newton iterations.
    pub iterations: usize,
    /// Wall time, seconds.
    pub wall_s: f64,
}

/// A scene that is not one of a tape spring whose ends turn.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error(
    "only a tape spring whose ends turn has a peak, a limit rotation and a fold: write load.kind = \"end-rotation\""
)]
pub struct NotASpring;

/// A point of the path.
#[derive(Clone, Copy, Debug)]
struct Point {
    length: f64,
    rotation: f64,
    moment: f64,
    passed_limit: bool,
}

/// The scene of the path along the uniform mesh that a scene starts with.
///
/// # Errors
/// Where the scene is not one of a tape spring.
pub fn path_scene(scene: &Scene) -> Result<Scene, NotASpring> {
    if let Load::Steps(_) = scene.load {
        return Err(NotASpring);
    }
    let mut scene = scene.clone();
    scene.adapt = None;
    scene.pipeline = vec![Stage::Solve];
    let limits =
        ArcLength { control: ArcLengthWord::ArcLength, longest_step: 2.0, shortest_step: 1e-5, most_steps: 5000 };
    scene.continuation.get_or_insert(limits);
    scene.solver.snap_tolerance_deg = Some(LOCATED_DEG);
    scene.solver.least_increment_deg = scene.solver.least_increment_deg.map(|least| least.min(LOCATED_DEG));
    Ok(scene)
}

/// Evaluates the critical points and moments of a path that was followed.
pub fn converged(scene: &Scene, done: &Done, unstable_at_deg: f64) -> ConvergenceRow {
    read_off(scene, &done.records, unstable_at_deg, done.wall_s)
}

fn read_off(scene: &Scene, records: &[Record], unstable_at_deg: f64, wall_s: f64) -> ConvergenceRow {
    let path: Vec<Point> = records
        .iter()
        .map(|record| &record.report)
        .filter(|report| report.outcome == Outcome::Done)
        .map(|report| Point {
            length: report.path_length_mm.unwrap_or(0.0),
            rotation: report.parameter,
            moment: report.moment_n_mm,
            passed_limit: report.critical_point.is_some_and(|critical| critical.limit_point),
        })
        .collect();
    let limits: Vec<usize> = (0..path.len()).filter(|index| path[*index].passed_limit).collect();
    let first = limits.first().copied();
    // On the way the rotation may turn back and forth: the fold begins at the lowest of its limit points.
    let second = limits.iter().skip(1).copied().min_by(|i, j| path[*i].rotation.total_cmp(&path[*j].rotation));
    let at_limit = |index: usize, sign: f64| {
        let (_, rotation) = top(&path, index, |point| sign * point.rotation)?;
        Some([sign * rotation, path[index].moment])
    };
    let peak = (0..first.unwrap_or(path.len())).max_by(|i, j| path[*i].moment.total_cmp(&path[*j].moment));
    let peak = peak.and_then(|index| {
        let (length, moment) = top(&path, index, |point| point.moment)?;
        Some([moment, interpolate(around(&path, index), length, |point| point.rotation)])
    });
    let back = first.map(|first| &path[first..second.unwrap_or(path.len())]);
    let unstable_n_mm = back.and_then(|back| {
        let beyond = back.iter().position(|point| point.rotation < unstable_at_deg).filter(|beyond| *beyond > 0)?;
        Some(interpolate_over(around(back, beyond), unstable_at_deg, |point| point.rotation, |point| point.moment))
    });
    ConvergenceRow {
        degree: scene.mesh.degree,
        elements: scene.mesh.elements,
        unknowns: records.last().map_or(0, |record| record.report.unknowns),
        peak,
        limit: first.and_then(|index| at_limit(index, 1.0)),
        fold_begins: second.and_then(|index| at_limit(index, -1.0)),
        unstable_n_mm,
        fold_n_mm: second.and_then(|_| path.last()).map(|point| point.moment),
        steps: records.last().map_or(0, |record| record.report.step),
        iterations: records.iter().map(|record| record.report.iterations).sum(),
        wall_s,
    }
}

/// The points nearest to one, as many as are interpolated through.
fn around(path: &[Point], index: usize) -> &[Point] {
    let from = index.saturating_sub(INTERPOLATED / 2).min(path.len().saturating_sub(INTERPOLATED));
    &path[from..path.len().min(from + INTERPOLATED)]
}

/// Largest value near a point of the path, and the length of the path where it is.
fn top(path: &[Point], index: usize, value: impl Fn(&Point) -> f64) -> Option<(f64, f64)> {
    let points = around(path, index);
    let (before, after) = (path.get(index.checked_sub(1)?)?, path.get(index + 1)?);
    let candidates = (0..=PARTS).map(|part| {
        let length = before.length + (after.length - before.length) * part as f64 / PARTS as f64;
        (length, interpolate(points, length, &value))
    });
    candidates.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn interpolate(points: &[Point], length: f64, value: impl Fn(&Point) -> f64) -> f64 {
    interpolate_over(points, length, |point| point.length, value)
}

/// Lagrange's polynomial through the points.
fn interpolate_over(points: &[Point], at: f64, abscissa: impl Fn(&Point) -> f64, value: impl Fn(&Point) -> f64) -> f64 {
    let term = |(i, point): (usize, &Point)| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(value(point), |product, (_, other)| {
            product * (at - abscissa(other)) / (abscissa(point) - abscissa(other))
        })
    };
    points.iter().enumerate().map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(count: usize) -> Vec<Point> {
        (0..count)
            .map(|i| {
                let length = 0.25 * i as f64;
                Point { length, rotation: length.cos(), moment: (length - 0.9).cos(), passed_limit: false }
            })
            .collect()
    }

    #[test]
    fn a_top_between_points_is_found() {
        let path = circle(12);
        let (length, moment) = top(&path, 4, |point| point.moment).unwrap();
        assert!((length - 0.9).abs() < 2e-3 && (moment - 1.0).abs() < 1e-5, "{length} {moment}");
        assert!((interpolate(around(&path, 4), length, |point| point.rotation) - length.cos()).abs() < 1e-4);
    }

    #[test]
    fn a_top_at_the_end_is_none() {
        assert_eq!(top(&circle(5), 0, |point| point.rotation), None);
        assert_eq!(top(&circle(5), 4, |point| point.moment), None);
    }
}
