//! The knot lines for ParaView, in a grid of their own: lines among the cells of a surface have no values of its fields.

use std::fmt::Write as _;

use super::bezier::BezierPatches;
use super::instant::Instant;
use super::vtu::{head, write_cells, write_weights_and_displacement};
use super::whole_shell::WholeShell;
use super::xml_array::XmlArray;

/// VTK's type of the cells.
const BEZIER_CURVE: u8 = 75;

/// Formats the knot lines as the text of a `.vtu` file: rational Bézier curves, one for each side of an element, on the undeformed
/// surface, with `displacement` as a point array.
pub fn knot_lines_vtu(shell: &WholeShell, instant: &Instant) -> String {
    let patches = BezierPatches::of(shell);
    let (net, degree, elements) = (patches.undeformed.grid(), patches.undeformed.degree, patches.elements());
    let (mut controls, mut cells, mut degrees) = (Vec::new(), Vec::new(), Vec::new());
    for constant in 0..2 {
        let running = 1 - constant;
        let p = degree[running];
        for line in (0..=elements.counts[constant]).map(|knot| knot * degree[constant]) {
            for from in (0..elements.counts[running]).map(|element| element * p) {
                // Ends first, then what is between.
                let along = [from, from + p].into_iter().chain(from + 1..from + p);
                controls.extend(along.map(|along| net.index_along(constant, line, along)));
                cells.push((BEZIER_CURVE, p + 1));
                degrees.push(p as f64);
            }
        }
    }
    let mut xml = head(instant, []);
    let _ = writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", controls.len(), cells.len());
    xml.push_str("<Points>\n");
    let points = controls.iter().flat_map(|k| patches.undeformed.point(*k));
    XmlArray::of_numbers("points", points).of_components(&["x", "y", "z"]).in_unit("mm").write(&mut xml);
    xml.push_str("</Points>\n");
    write_cells(&mut xml, &cells);
    xml.push_str("<CellData HigherOrderDegrees=\"HigherOrderDegrees\">\n");
    let degrees = degrees.into_iter().flat_map(|p| [p, 0.0, 0.0]);
    XmlArray::of_numbers("HigherOrderDegrees", degrees).of_components(&["u", "v", "w"]).write(&mut xml);
    xml.push_str("</CellData>\n<PointData Vectors=\"displacement\" RationalWeights=\"RationalWeights\">\n");
    write_weights_and_displacement(&mut xml, &patches, &controls);
    xml.push_str("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    xml
}
