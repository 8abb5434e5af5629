//! The direction from which a structure is best seen: where one shell hides the other, another one.

use super::camera::{Camera, DepthBuffer, ViewDirection};
use super::samples::{SurfaceSamples, cells_of};
use crate::shell::{cross, norm, sub};

/// Pixels of the canvas on which directions are compared, each way.
const PIXELS: usize = 240;
/// Directions, besides the usual one: azimuth about z and elevation, degrees.
const AZIMUTHS: [f64; 8] = [-62.0, -28.0, -118.0, -152.0, 28.0, 62.0, 118.0, 152.0];
const ELEVATIONS: [f64; 2] = [24.0, 50.0];
/// By how much another direction must show more for the usual one to be left: a frame in a plane and two panels at an angle are seen
/// well by that, the flanges of a boom are not.
const WORTH: f64 = 1.1;

/// Finds the direction that shows every shell; the usual one for one shell, and where no other is much better.
pub fn viewpoint(samples: &SurfaceSamples) -> ViewDirection {
    let usual = ViewDirection::default();
    if samples.grids.len() < 2 {
        return usual;
    }
    let all = ELEVATIONS
        .into_iter()
        .flat_map(|elevation_deg| AZIMUTHS.map(|azimuth_deg| ViewDirection { azimuth_deg, elevation_deg }));
    let judged = all.map(|direction| (direction, shown(samples, direction)));
    let better = |best: (ViewDirection, f64), one: (ViewDirection, f64)| if one.1 > best.1 { one } else { best };
    judged.fold((usual, WORTH * shown(samples, usual)), better).0
}

/// How well a direction shows all shells: the share of its area that is seen, at right angles to the view, of the shell that is seen
/// least, and the mean of all.
fn shown(samples: &SurfaceSamples, direction: ViewDirection) -> f64 {
    let side = PIXELS as f64;
    let (camera, _) = Camera::fitted(direction, samples.points.iter().copied(), [0.0, 0.0, side, side]);
    let mut buffer = DepthBuffer::new(PIXELS, PIXELS);
    let (mut areas, mut shell_of) = (Vec::new(), Vec::new());
    for (shell, counts) in samples.grids.iter().enumerate() {
        areas.push(0.0);
        shell_of.extend(std::iter::repeat_n(shell, cells_of(*counts).len()));
    }
    for (face, cell) in samples.cells().enumerate() {
        let points = cell.map(|index| samples.points[index]);
        areas[shell_of[face]] += area(points);
        let [a, b, c, d] = points.map(|point| camera.project(point));
        buffer.triangle(face as u32, [a, b, c]);
        buffer.triangle(face as u32, [a, c, d]);
    }
    let mut seen = vec![0.0; areas.len()];
    buffer.faces().for_each(|face| seen[shell_of[face]] += camera.scale.powi(-2));
    let shares = || seen.iter().zip(&areas).map(|(seen, area)| if *area > 0.0 { seen / area } else { 1.0 });
    shares().fold(f64::INFINITY, f64::min) + shares().sum::<f64>() / areas.len() as f64
}

/// Area of a cell, from its diagonals, mm².
fn area([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    0.5 * norm(cross(sub(c, a), sub(d, b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel that is spanned by ten times two vectors from a corner.
    fn panel(corner: [f64; 3], across: [[f64; 3]; 2]) -> SurfaceSamples {
        let at = |i: f64, j: f64| [0, 1, 2].map(|c| corner[c] + i * across[0][c] + j * across[1][c]);
        let points = vec![at(0.0, 0.0), at(0.0, 10.0), at(10.0, 0.0), at(10.0, 10.0)];
        SurfaceSamples::new([2, 2], points, vec![1.0], vec![], "").unwrap()
    }

    const UPRIGHT: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn one_shell_and_panels_side_by_side_are_seen_as_usual() {
        let one = panel([0.0; 3], UPRIGHT);
        assert_eq!(viewpoint(&one), ViewDirection::default());
        let two = SurfaceSamples::joined([one, panel([10.0, 0.0, 0.0], UPRIGHT)]).unwrap();
        assert_eq!(viewpoint(&two), ViewDirection::default());
    }

    /// A large upright panel hides a small one behind it: both are seen from the other side.
    #[test]
    fn a_panel_behind_another_is_seen_from_elsewhere() {
        let large = panel([-15.0, 0.0, -15.0], UPRIGHT.map(|side| side.map(|c| 4.0 * c)));
        let two = SurfaceSamples::joined([large, panel([0.0, 2.0, 0.0], UPRIGHT)]).unwrap();
        let found = viewpoint(&two);
        assert!(found.azimuth_deg > 0.0, "{found:?}: towards y");
        assert!(shown(&two, found) > WORTH * shown(&two, ViewDirection::default()));
    }
}
