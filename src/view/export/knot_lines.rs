//! The knot lines for ParaView, in a grid of their own: lines among the cells of a surface have no values of its fields.

use super::bezier::BezierPatches;
use super::bezier_grid::{BezierGrid, BezierGrids};
use super::instant::Instant;
use super::whole_shell::WholeShell;

/// VTK's type of the cells.
const BEZIER_CURVE: u8 = 75;

/// Formats the knot lines of shells as the text of a `.vtu` file: rational Bézier curves, one for each side of an element, on the
/// undeformed surface, with `displacement` as a point array.
pub fn knot_lines_vtu(shells: &[WholeShell], instant: &Instant) -> String {
    let patches: Vec<BezierPatches> = shells.iter().map(BezierPatches::of).collect();
    let grids = patches.iter().map(lines_of).collect();
    let names = shells.iter().filter_map(WholeShell::name).collect();
    BezierGrids { grids, names }.vtu(instant, std::iter::empty(), std::iter::empty())
}

fn lines_of(patches: &BezierPatches) -> BezierGrid<'_> {
    let (net, degree, elements) = (patches.undeformed.grid(), patches.undeformed.degree, patches.elements());
    let (mut controls, mut degrees) = (Vec::new(), Vec::new());
    for constant in 0..2 {
        let running = 1 - constant;
        let p = degree[running];
        for line in (0..=elements.counts[constant]).map(|knot| knot * degree[constant]) {
            for from in (0..elements.counts[running]).map(|element| element * p) {
                // Ends first, then what is between.
                let along = [from, from + p].into_iter().chain(from + 1..from + p);
                controls.extend(along.map(|along| net.index_along(constant, line, along)));
                degrees.push([p, 0]);
            }
        }
    }
    BezierGrid { patches, kind: BEZIER_CURVE, degrees, controls }
}
