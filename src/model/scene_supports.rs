//! The supports of a scene: those that it names, or those that turning ends are equivalent to.

use crate::scene::{Edge, Geometry, History, Hold, Load, Motion, Region, Scene, Sense, Support};

/// Lists the supports of a scene: those that it names, or those that turning ends are equivalent to.
pub fn supports_of(scene: &Scene) -> Vec<Support> {
    let (Load::EndRotation(load), Geometry::TapeSpring { length_mm, radius_mm, arc_deg }) =
        (&scene.load, &scene.geometry)
    else {
        return scene.supports.clone();
    };
    let half = arc_deg.to_radians() / 2.0;
    let height = radius_mm * half.sin() / half;
    // Opposite sense: the free edges (below the centroid) are stretched, so the end at x = length turns by −θ. The
    // parameter is θ in degrees.
    let sign = match load.sense {
        Sense::Opposite => 1.0,
        Sense::Equal => -1.0,
    };
    let zero = Motion::Given(0.0);
    let end = |name: &str, edge: Edge, x: f64, slide: Motion, sign: f64| Support {
        name: name.into(),
        on: Region::Edge(edge),
        shell: 0,
        also: Vec::new(),
        hold: Hold::Rigid {
            motions: [slide, zero, zero, zero, Motion::Given(sign), zero],
            reference_mm: Some([x, 0.0, height]),
            normals_turn: true,
        },
        history: History::default(),
    };
    let mirror = |name: &str, edge: Edge| Support {
        name: name.into(),
        on: Region::Edge(edge),
        shell: 0,
        also: Vec::new(),
        hold: Hold::Symmetric,
        history: History::default(),
    };
    // The first end slides, so that there is no axial force; the other, or the plane of symmetry in its place, holds
    // the shell along x.
    let [half_length, half_arc] = scene.symmetry.cuts();
    let mut supports = vec![end("first end", Edge::UStart, 0.0, Motion::FREE, sign)];
    supports.push(match half_length {
        true => mirror("middle of the length", Edge::UEnd),
        false => end("second end", Edge::UEnd, *length_mm, zero, -sign),
    });
    if half_arc {
        supports.push(mirror("apex", Edge::VStart));
    }
    supports
}
