//! A sampled surface for ParaView: the XML unstructured grid of VTK.
//!
//! Format: VTK File Formats, "UnstructuredGrid". Arrays are inline base64 (`format="binary"`) with a 64-bit length in
//! front, little-endian, uncompressed: exact, and not-a-number survives, which ASCII arrays do not read back.

use std::fmt::Write as _;

use super::mesh_picture::escaped;
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

    let mut connectivity: Vec<i64> = samples.cells().flatten().map(|index| index as i64).collect();
    connectivity.extend(samples.points.len() as i64..(points.len() / 3) as i64);
    let ends = lines.iter().scan(4 * faces as i64, |end, line| {
        *end += line.len() as i64;
        Some(*end)
    });
    let offsets: Vec<i64> = (1..=faces as i64).map(|face| 4 * face).chain(ends).collect();
    let kinds: Vec<u8> = (0..cells).map(|cell| if cell < faces { VTK_QUAD } else { VTK_POLY_LINE }).collect();
    let values: Vec<f64> = (0..cells).map(|cell| samples.cell_values.get(cell).copied().unwrap_or(f64::NAN)).collect();
    let is_line: Vec<u8> = (0..cells).map(|cell| u8::from(cell >= faces)).collect();

    let quantity = escaped(&samples.quantity);
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n",
    );
    // Writing to a string does not fail.
    let _ = writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">", points.len() / 3);
    xml.push_str("<Points>\n");
    array(&mut xml, "Float64", "NumberOfComponents=\"3\" Name=\"Points\"", points.iter().flat_map(|v| v.to_le_bytes()));
    xml.push_str("</Points>\n<Cells>\n");
    array(&mut xml, "Int64", "Name=\"connectivity\"", connectivity.iter().flat_map(|v| v.to_le_bytes()));
    array(&mut xml, "Int64", "Name=\"offsets\"", offsets.iter().flat_map(|v| v.to_le_bytes()));
    array(&mut xml, "UInt8", "Name=\"types\"", kinds.into_iter());
    let _ = writeln!(xml, "</Cells>\n<CellData Scalars=\"{quantity}\">");
    array(&mut xml, "Float64", &format!("Name=\"{quantity}\""), values.iter().flat_map(|v| v.to_le_bytes()));
    array(&mut xml, "UInt8", "Name=\"knot_line\"", is_line.into_iter());
    xml.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    xml
}

/// One array: its length in bytes and its bytes, encoded as one.
fn array(xml: &mut String, kind: &str, attributes: &str, bytes: impl Iterator<Item = u8>) {
    let body: Vec<u8> = bytes.collect();
    let framed: Vec<u8> = (body.len() as u64).to_le_bytes().into_iter().chain(body).collect();
    let _ = writeln!(xml, "<DataArray type=\"{kind}\" {attributes} format=\"binary\">{}</DataArray>", base64(&framed));
}

/// RFC 4648, with padding.
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().chain([&0, &0]).take(3).fold(0u32, |word, byte| word << 8 | u32::from(*byte));
        for place in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_rfc_4648() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_cell_and_a_line() {
        let points = vec![[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let line = vec![points[0], points[1]];
        let samples = SurfaceSamples::new([2, 2], points, vec![0.5], vec![line, vec![]], "a < b").unwrap();
        let xml = vtu(&samples);
        assert!(xml.contains(r#"NumberOfPoints="6" NumberOfCells="2""#));
        assert!(xml.contains(r#"Scalars="a &lt; b""#));
        let offsets: Vec<u8> = [16u64, 4, 6].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert!(xml.contains(&base64(&offsets)));
    }
}
