//! Grids of rational Bézier cells as XML of VTK: what surface and knot lines have in common.

use std::fmt::Write as _;

use super::bezier::BezierPatches;
use super::instant::Instant;
use super::xml_array::{OPENING, XmlArray};

/// The point array that warps a grid.
pub(super) const DISPLACEMENT: &str = "displacement";

/// Cells of one type, each with points of its own.
pub(super) struct BezierGrid<'a> {
    pub(super) patches: &'a BezierPatches,
    /// VTK's type of the cells.
    pub(super) kind: u8,
    /// Degrees of each cell along its parameters; 0 for one that it has not.
    pub(super) degrees: Vec<[usize; 2]>,
    /// Control points of one cell after another, in VTK's order.
    pub(super) controls: Vec<usize>,
}

/// Grids of shells one after another, as one.
pub(super) struct BezierGrids<'a> {
    pub(super) grids: Vec<BezierGrid<'a>>,
    /// The names of the shells of a structure; empty for a shell that has none.
    pub(super) names: Vec<&'a str>,
}

impl BezierGrids<'_> {
    /// Formats the text of a `.vtu` file, with the numbers of the instant and further field arrays, and with weights,
    /// displacements and further point arrays. Cells of a structure have the place of their shell in its list, and the field
    /// data its names.
    pub(super) fn vtu(
        self,
        instant: &Instant,
        field_arrays: impl Iterator<Item = XmlArray>,
        point_arrays: impl Iterator<Item = XmlArray>,
    ) -> String {
        let mut xml = String::from(OPENING) + "<FieldData>\n";
        for (name, value) in instant.numbers() {
            XmlArray::of_numbers(name, [value].into_iter()).tuples(1).write(&mut xml);
        }
        XmlArray::of_text("state_hash", &instant.state_hash.to_string()).write(&mut xml);
        if !self.names.is_empty() {
            XmlArray::of_texts("shell_names", &self.names).write(&mut xml);
        }
        field_arrays.for_each(|array| array.write(&mut xml));
        xml.push_str("</FieldData>\n");
        let (points, cells) = (self.controls().count(), self.degrees().count());
        // Writing to a string does not fail.
        let _ = writeln!(xml, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>");
        self.vectors("points", |patches, k| patches.undeformed.point(k)).write(&mut xml);
        xml.push_str("</Points>\n");
        self.write_cells(&mut xml);
        xml.push_str("<PointData Vectors=\"displacement\" RationalWeights=\"RationalWeights\">\n");
        let weights = self.controls().map(|(patches, k)| patches.undeformed.control_points[k][3]);
        XmlArray::of_numbers("RationalWeights", weights).write(&mut xml);
        self.vectors(DISPLACEMENT, |patches, k| patches.displacement[k]).write(&mut xml);
        point_arrays.for_each(|array| array.write(&mut xml));
        xml.push_str("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        xml
    }

    /// The control points of all cells, each with its patches.
    fn controls(&self) -> impl Iterator<Item = (&BezierPatches, usize)> {
        self.grids.iter().flat_map(|grid| grid.controls.iter().map(|k| (grid.patches, *k)))
    }

    /// The degrees of all cells.
    fn degrees(&self) -> impl Iterator<Item = &[usize; 2]> {
        self.grids.iter().flat_map(|grid| &grid.degrees)
    }

    /// A vector in mm at each control point.
    fn vectors(&self, name: &str, at: impl Fn(&BezierPatches, usize) -> [f64; 3]) -> XmlArray {
        XmlArray::of_numbers(name, self.controls().flat_map(|(patches, k)| at(patches, k)))
            .of_components(&["x", "y", "z"])
            .in_unit("mm")
    }

    fn write_cells(&self, xml: &mut String) {
        let ends = self.degrees().scan(0, |end, [p, q]| {
            *end += (p + 1) * (q + 1);
            Some(*end)
        });
        xml.push_str("<Cells>\n");
        XmlArray::of_indices("connectivity", 0..self.controls().count()).write(xml);
        XmlArray::of_indices("offsets", ends).write(xml);
        let kinds = self.grids.iter().flat_map(|grid| grid.degrees.iter().map(|_| grid.kind));
        XmlArray::of_bytes("UInt8", "types", kinds).write(xml);
        xml.push_str("</Cells>\n<CellData HigherOrderDegrees=\"HigherOrderDegrees\">\n");
        let degrees = self.degrees().flat_map(|[p, q]| [*p as f64, *q as f64, 0.0]);
        XmlArray::of_numbers("HigherOrderDegrees", degrees).of_components(&["u", "v", "w"]).write(xml);
        if !self.names.is_empty() {
            let shells =
                self.grids.iter().enumerate().flat_map(|(shell, grid)| grid.degrees.iter().map(move |_| shell));
            XmlArray::of_indices("shell", shells).write(xml);
        }
        xml.push_str("</CellData>\n");
    }
}
