//! A sampled surface for ParaView: the XML unstructured grid of VTK.
//!
//! Format: VTK File Formats, "UnstructuredGrid". The surface itself, with all fields, is in `export`.

use std::fmt::Write as _;

use super::drawing::escaped;
use super::export::{OPENING, XmlArray};
use super::samples::SurfaceSamples;

/// VTK cell types.
const VTK_POLY_LINE: u8 = 4;
const VTK_QUAD: u8 = 9;

/// Formats `samples` as the text of a `.vtu` file: a quadrilateral for each cell, a polyline for each knot line. Cell
/// arrays: the values under the name of their quantity (NaN on knot lines), and `knot_line` (0 on the surface, 1 on
/// knot lines; a threshold separates them).
pub fn vtu(samples: &SurfaceSamples) -> String {
    let lines: Vec<&Vec<[f64; 3]>> = samples.knot_lines.iter().filter(|line| line.len() > 1).collect();
    let points: Vec<f64> = samples.points.iter().chain(lines.iter().copied().flatten()).flatten().copied().collect();
    let faces = samples.cell_values.len();
    let cells = faces + lines.len();

    let connectivity = samples.cells().flatten().chain(samples.points.len()..points.len() / 3);
    let ends = lines.iter().scan(4 * faces, |end, line| {
        *end += line.len();
        Some(*end)
    });
    let offsets = (1..=faces).map(|face| 4 * face).chain(ends);
    let kinds: Vec<u8> = (0..cells).map(|cell| if cell < faces { VTK_QUAD } else { VTK_POLY_LINE }).collect();
    let values: Vec<f64> = (0..cells).map(|cell| samples.cell_values.get(cell).copied().unwrap_or(f64::NAN)).collect();
    let is_line: Vec<u8> = (0..cells).map(|cell| u8::from(cell >= faces)).collect();

    let quantity = escaped(&samples.quantity);
    let mut xml = String::from(OPENING);
    // Writing to a string does not fail.
    let _ = writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">", points.len() / 3);
    xml.push_str("<Points>\n");
    XmlArray::of_numbers("Points", points.iter().copied()).of_components(&["x", "y", "z"]).write(&mut xml);
    xml.push_str("</Points>\n<Cells>\n");
    XmlArray::of_indices("connectivity", connectivity).write(&mut xml);
    XmlArray::of_indices("offsets", offsets).write(&mut xml);
    XmlArray::of_bytes("UInt8", "types", kinds.into_iter()).write(&mut xml);
    let _ = writeln!(xml, "</Cells>\n<CellData Scalars=\"{quantity}\">");
    XmlArray::of_numbers(&quantity, values.into_iter()).write(&mut xml);
    XmlArray::of_bytes("UInt8", "knot_line", is_line.into_iter()).write(&mut xml);
    xml.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    xml
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_and_a_line() {
        let points = vec![[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let line = vec![points[0], points[1]];
        let samples = SurfaceSamples::new([2, 2], points, vec![0.5], vec![line, vec![]], "a < b").unwrap();
        let xml = vtu(&samples);
        assert!(xml.contains(r#"NumberOfPoints="6" NumberOfCells="2""#));
        assert!(xml.contains(r#"Scalars="a &lt; b""#));
        let mut offsets = String::new();
        XmlArray::of_indices("offsets", [4, 6].into_iter()).write(&mut offsets);
        assert!(xml.contains(&offsets));
    }
}
