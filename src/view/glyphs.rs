//! Supports, loads and the outline of a shell as signs in its picture.

use super::camera::{Camera, Projected};
use super::colour::Colour;
use super::drawing::{Anchor, Drawing, Stroke};
use super::marks::{Arrow, ArrowKind, Held, HeldKind, Marks, every};

/// Half the width of a sign, pixels.
const HALF: f64 = 5.5;
/// Signs along a line at most, and pixels for each.
const ALONG: usize = 5;
const APART: f64 = 60.0;
const LINE: f64 = 2.2;
const OUTLINE: Stroke = Stroke { colour: Colour::GREY, opacity: 1.0, width: 1.0, dash: Some([5.0, 4.0]) };
/// Width of the white rim that signs stand out by, on either side, pixels.
const RIM: f64 = 1.6;
const HEAD: [f64; 2] = [10.0, 4.0];
/// Length below which an arrow points at the eye, pixels.
const SHORTEST: f64 = 3.0;
/// Size of letters in the legend, and their width, pixels.
const LETTERS: u32 = 13;
const LETTER: f64 = 9.6;

/// Draws the outline of the shell as it was, where `is_seen` says that nothing hides it.
pub(super) fn draw_outline(drawing: &mut Drawing, marks: &Marks, camera: &Camera, is_seen: impl Fn(Projected) -> bool) {
    let mut seen = Vec::new();
    for line in &marks.outline {
        let points: Vec<Projected> = line.iter().map(|point| camera.project(*point)).collect();
        for stretch in points.chunk_by(|from, to| is_seen(from.middle(to))).filter(|stretch| stretch.len() > 1) {
            seen.push(stretch.iter().map(|point| [point.x, point.y]).collect());
        }
    }
    drawing.lines(seen, OUTLINE);
}

/// Draws supports and loads over the shell.
pub(super) fn draw_marks(drawing: &mut Drawing, marks: &Marks, camera: &Camera) {
    let place = |point: [f64; 3]| {
        let Projected { x, y, .. } = camera.project(point);
        [x, y]
    };
    for Held { kind, points } in &marks.held {
        let points: Vec<_> = points.iter().map(|point| place(*point)).collect();
        if points.len() > 1 {
            rimmed(drawing, points.clone(), edge_stroke(*kind));
        }
        if *kind != HeldKind::Symmetric {
            let signs = (length(&points) / APART).round() as usize;
            every(points, signs.clamp(1, ALONG)).for_each(|at| draw_sign(drawing, *kind, at));
        }
    }
    for Arrow { kind, points } in &marks.arrows {
        draw_arrow(drawing, *kind, points.iter().map(|point| place(*point)).collect());
    }
}

/// Names what marks there are, in a line of text that begins here.
pub(super) fn draw_legend(drawing: &mut Drawing, marks: &Marks, [mut x, y]: [f64; 2]) {
    const SAMPLE: f64 = 26.0;
    let middle = y - 4.5;
    let mut entry = |name: &str, sample: &dyn Fn(&mut Drawing, f64)| {
        sample(drawing, x);
        drawing.text([x + SAMPLE + 6.0, y], Anchor::Start, LETTERS, name);
        x += SAMPLE + 6.0 + LETTER * name.chars().count() as f64 + 22.0;
    };
    if !marks.outline.is_empty() {
        entry(marks.outline_name, &|drawing, x| drawing.lines(vec![vec![[x, middle], [x + SAMPLE, middle]]], OUTLINE));
    }
    for kind in HeldKind::ALL.into_iter().filter(|kind| marks.held.iter().any(|held| held.kind == *kind)) {
        entry(kind.name(), &|drawing, x| match kind {
            HeldKind::Symmetric => drawing.lines(vec![vec![[x, middle], [x + SAMPLE, middle]]], edge_stroke(kind)),
            _ => {
                draw_sign(drawing, kind, [x + SAMPLE - 8.0, middle - if kind == HeldKind::Hinged { HALF } else { 0.0 }])
            }
        });
    }
    for kind in ArrowKind::ALL.into_iter().filter(|kind| marks.arrows.iter().any(|arrow| arrow.kind == *kind)) {
        entry(kind.name(), &|drawing, x| draw_arrow(drawing, kind, vec![[x, middle], [x + SAMPLE, middle]]));
    }
}

fn edge_stroke(kind: HeldKind) -> Stroke {
    let dash = (kind == HeldKind::Symmetric).then_some([9.0, 3.0]);
    Stroke { dash, ..Stroke::new(Colour::INK, LINE) }
}

/// A line with a white rim.
fn rimmed(drawing: &mut Drawing, line: Vec<[f64; 2]>, stroke: Stroke) {
    let rim = Stroke { colour: Colour::WHITE, width: stroke.width + 2.0 * RIM, dash: None, opacity: 0.8 };
    drawing.lines(vec![line.clone()], rim);
    drawing.lines(vec![line], stroke);
}

/// The sign of a support: a triangle below the point for a hinge, a square for a clamp, a rhombus for a rigid section, a ring
/// where some directions are free.
fn draw_sign(drawing: &mut Drawing, kind: HeldKind, [x, y]: [f64; 2]) {
    let polygon = |corners: &[[f64; 2]]| corners.iter().map(|[right, down]| [x + right, y + down]).collect::<Vec<_>>();
    let (outer, is_filled) = match kind {
        HeldKind::Hinged => (polygon(&[[0.0, 0.0], [HALF, 1.8 * HALF], [-HALF, 1.8 * HALF]]), false),
        HeldKind::Clamped => (polygon(&[[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]]), true),
        HeldKind::Section => (polygon(&[[0.0, -HALF], [HALF, 0.0], [0.0, HALF], [-HALF, 0.0]]), true),
        HeldKind::Guided | HeldKind::Symmetric => {
            let corner = |k: u32| (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
            let ring: Vec<_> = (0..16).map(corner).map(|(sin, cos)| [0.8 * HALF * cos, 0.8 * HALF * sin]).collect();
            (polygon(&ring), false)
        }
    };
    let closed = outer.iter().chain(outer.first()).copied().collect();
    drawing.face(outer, if is_filled { Colour::INK } else { Colour::WHITE });
    drawing.lines(vec![closed], Stroke::new(if is_filled { Colour::WHITE } else { Colour::INK }, 1.4));
}

fn draw_arrow(drawing: &mut Drawing, kind: ArrowKind, points: Vec<[f64; 2]>) {
    let colour = match kind {
        ArrowKind::Load => Colour::LOAD,
        ArrowKind::Motion => Colour::MOTION,
    };
    let Some(tip) = points.last().copied() else { return };
    if length(&points) < SHORTEST {
        let square = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]].map(|[dx, dy]| [tip[0] + dx, tip[1] + dy]);
        return drawing.face(square, colour);
    }
    // The head takes the end of the line, along its mean direction there.
    let behind = points.iter().rev().copied().find(|point| distance(*point, tip) >= HEAD[0]).unwrap_or(points[0]);
    let far = distance(behind, tip);
    let way = [0, 1].map(|c| (tip[c] - behind[c]) / far.max(f64::MIN_POSITIVE));
    let at = |back: f64, aside: f64| [tip[0] - back * way[0] - aside * way[1], tip[1] - back * way[1] + aside * way[0]];
    let mut shaft: Vec<_> = points.iter().copied().filter(|point| distance(*point, tip) > 0.8 * HEAD[0]).collect();
    shaft.push(at(0.8 * HEAD[0], 0.0));
    rimmed(drawing, shaft, Stroke::new(colour, LINE));
    drawing.face([tip, at(HEAD[0], HEAD[1]), at(HEAD[0], -HEAD[1])], colour);
}

fn length(line: &[[f64; 2]]) -> f64 {
    line.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
