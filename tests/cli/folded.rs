//! A folded tape spring made up for tests of pictures: a fold of uniform curvature with a flat section between two arms
//! that keep their section, on a mesh that is finer in the fold.

use foldline::view::SurfaceSamples;

const LENGTH: f64 = 300.0;
const RADIUS: f64 = 10.0;
const ARC: f64 = 1.919_862_177_193_763;
/// Arc length of the fold and of the ploy region at each of its sides, mm.
const FOLD: f64 = 10.0;
const PLOY: f64 = 34.0;

/// 1 in the fold, 0 in the arms, smooth between.
fn openness(s: f64) -> f64 {
    let outside = ((s - LENGTH / 2.0).abs() - FOLD / 2.0) / PLOY;
    if outside >= 1.0 { 0.0 } else { (1.0 + (std::f64::consts::PI * outside.max(0.0)).cos()) / 2.0 }
}

/// Samples of a spring whose ends have each turned by `rotation_deg`.
pub fn samples(parameter: f64) -> SurfaceSamples {
    // The tight curvature is in the fold; the ploy regions open the section but hardly bend along the length.
    let bend = |s: f64| openness(s).powi(6);
    let steps = 3000;
    let ds = LENGTH / f64::from(steps);
    let total: f64 = (0..steps).map(|i| bend((f64::from(i) + 0.5) * ds) * ds).sum();
    let curvature = 2.0 * parameter.to_radians() / total;
    let mut axis = vec![(0.0, 0.0, -parameter.to_radians())];
    for i in 0..steps {
        let (x, z, angle) = axis[i as usize];
        let middle: f64 = angle + 0.5 * ds * curvature * bend((f64::from(i) + 0.5) * ds);
        let next = angle + ds * curvature * bend((f64::from(i) + 0.5) * ds);
        axis.push((x + ds * middle.cos(), z + ds * middle.sin(), next));
    }
    let point = |s: f64, y: f64| -> [f64; 3] {
        let (x, z, angle) = axis[((s / ds).round() as usize).min(steps as usize)];
        let section = (1.0 - openness(s)) / RADIUS;
        // Height above the centroid of the section, and place across it.
        let (across, height) = if section < 1e-6 {
            (y, 0.0)
        } else {
            let half = section * RADIUS * ARC / 2.0;
            ((section * y).sin() / section, ((section * y).cos() - half.sin() / half) / section)
        };
        [x - height * angle.sin() - LENGTH / 2.0, across, z + height * angle.cos()]
    };
    let value = |s: f64| (openness(s) / RADIUS).max(curvature * bend(s));

    let knots1 = [
        0.0, 37.5, 75.0, 93.75, 112.5, 121.875, 131.25, 135.9375, 140.625, 145.3125, 150.0, 154.6875, 159.375,
        164.0625, 168.75, 178.125, 187.5, 206.25, 225.0, 262.5, 300.0,
    ];
    let width = RADIUS * ARC;
    let knots2: Vec<f64> = (0..=8).map(|i| width * (f64::from(i) / 8.0 - 0.5)).collect();
    let refined = |knots: &[f64], parts: usize| -> Vec<f64> {
        let spans = knots.windows(2);
        let inner = spans.flat_map(|k| (0..parts).map(|i| k[0] + (k[1] - k[0]) * i as f64 / parts as f64));
        inner.chain(knots.last().copied()).collect()
    };
    let (grid1, grid2) = (refined(&knots1, 6), refined(&knots2, 4));
    let points = grid1.iter().flat_map(|s| grid2.iter().map(|y| point(*s, *y))).collect();
    let middle = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
    let values = grid1.windows(2).flat_map(|s| vec![value(middle(s)); grid2.len() - 1]).collect();
    let along = knots2.iter().map(|y| grid1.iter().map(|s| point(*s, *y)).collect());
    let across = knots1.iter().map(|s| grid2.iter().map(|y| point(*s, *y)).collect());
    let lines = along.chain(across).collect();
    SurfaceSamples::new([grid1.len(), grid2.len()], points, values, lines, "bending strain max|κ| (1/mm)").unwrap()
}
