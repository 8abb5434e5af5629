//! The shell for ParaView: an unstructured grid of rational Bézier cells, which are the NURBS surface itself.
//!
//! Format: VTK File Formats, "UnstructuredGrid"; cells of type `VTK_BEZIER_QUADRILATERAL`, whose degrees and weights VTK finds in
//! the cell array `HigherOrderDegrees` and the point array `RationalWeights`. Points are those of the undeformed surface, and
//! `displacement` has the displacements of the control points: "Warp by Vector" with scale 1 makes exactly the deformed surface,
//! since both are sums of the same rational functions. Other fields are coefficients of patches that take the field's values at
//! (p + 1)(q + 1) uniform points of each cell. Coefficients may lie beyond all values of the surface, where a field has an extreme inside
//! a cell; so the range of the values stands beside them, as the field array `NAME_range` (a row for each component).

use std::fmt::Write as _;

use rayon::prelude::*;

use super::super::fields::Field;
use super::bezier::BezierPatches;
use super::instant::Instant;
use super::whole_shell::WholeShell;
use super::xml_array::XmlArray;

/// VTK's type of the cells.
const BEZIER_QUADRILATERAL: u8 = 77;

/// The array that warps the grid.
const DISPLACEMENT: &str = "displacement";

/// Formats the shell as the text of a `.vtu` file, with `displacement` and these fields as point arrays, and the numbers of the
/// instant as field arrays.
pub fn surface_vtu(shell: &WholeShell, fields: &[Field], instant: &Instant) -> String {
    let patches = BezierPatches::of(shell);
    let (order, cells) = (vtk_order(patches.undeformed.degree), patches.elements().len());
    let each = order.len();
    // Every cell has points of its own: fields may jump between elements.
    let controls: Vec<usize> = (0..cells)
        .flat_map(|element| {
            let of_element: Vec<usize> = patches.of_element(element).collect();
            order.iter().map(|k| of_element[*k]).collect::<Vec<_>>()
        })
        .collect();

    let shown = fields.iter().filter(|field| field.name != DISPLACEMENT);
    let shown: Vec<OnCells> = shown.map(|field| OnCells::of(shell, &patches, field)).collect();
    let ranges = shown.iter().map(|OnCells { field, range, .. }| {
        XmlArray::of_numbers(&format!("{}_range", field.name), range.iter().flatten().copied())
            .of_components(&["least", "largest"])
            .tuples(range.len())
    });
    let mut xml = head(instant, ranges);
    let _ = writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">", controls.len());
    xml.push_str("<Points>\n");
    let points = controls.iter().flat_map(|k| patches.undeformed.point(*k));
    XmlArray::of_numbers("points", points).of_components(&["x", "y", "z"]).in_unit("mm").write(&mut xml);
    xml.push_str("</Points>\n");
    write_cells(&mut xml, &vec![(BEZIER_QUADRILATERAL, each); cells]);
    xml.push_str("<CellData HigherOrderDegrees=\"HigherOrderDegrees\">\n");
    let [p, q] = patches.undeformed.degree.map(|degree| degree as f64);
    let degrees = std::iter::repeat_n([p, q, 0.0], cells).flatten();
    XmlArray::of_numbers("HigherOrderDegrees", degrees).of_components(&["u", "v", "w"]).write(&mut xml);
    xml.push_str("</CellData>\n<PointData Vectors=\"displacement\" RationalWeights=\"RationalWeights\">\n");
    write_weights_and_displacement(&mut xml, &patches, &controls);
    for OnCells { field, coefficients, .. } in shown {
        let components = field.components.len();
        let of_cell = |cell: &Vec<[f64; 3]>| order.iter().map(|k| cell[*k]).collect::<Vec<_>>();
        let numbers = coefficients.iter().flat_map(of_cell).flat_map(|value| value.into_iter().take(components));
        XmlArray::of_numbers(&field.name, numbers).of_components(field.components).in_unit(field.unit).write(&mut xml);
    }
    xml.push_str("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    xml
}

/// A field on the cells.
struct OnCells<'f> {
    field: &'f Field,
    /// Coefficients of each cell, the second direction fastest.
    coefficients: Vec<Vec<[f64; 3]>>,
    /// Least and largest value of each component at the nodes.
    range: Vec<[f64; 2]>,
}

impl<'f> OnCells<'f> {
    fn of(shell: &WholeShell, patches: &BezierPatches, field: &'f Field) -> Self {
        let at_nodes = |element: usize| {
            let bounds = patches.bounds(element);
            patches.nodes(element).map(|at| shell.value_in(field, bounds, at)).collect::<Vec<_>>()
        };
        let values: Vec<Vec<[f64; 3]>> = (0..patches.elements().len()).into_par_iter().map(at_nodes).collect();
        let range = |component: usize| {
            let values = values.iter().flatten().map(|value| value[component]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
        };
        let coefficients =
            values.iter().enumerate().map(|(element, values)| patches.interpolating(element, values)).collect();
        Self { field, coefficients, range: (0..field.components.len()).map(range).collect() }
    }
}

/// The beginning of a file, up to its piece, with further field arrays.
pub(super) fn head<'a>(instant: &Instant, further: impl IntoIterator<Item = XmlArray<'a>>) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n",
    );
    for (name, value) in instant.numbers() {
        XmlArray::of_numbers(name, [value].into_iter()).tuples(1).write(&mut xml);
    }
    XmlArray::of_text("state_hash", &instant.state_hash.to_string()).write(&mut xml);
    further.into_iter().for_each(|array| array.write(&mut xml));
    xml.push_str("</FieldData>\n");
    xml
}

/// Cells of a type and a number of points each, with points of their own.
pub(super) fn write_cells(xml: &mut String, cells: &[(u8, usize)]) {
    let ends = cells.iter().scan(0, |end, (_, points)| {
        *end += points;
        Some(*end)
    });
    xml.push_str("<Cells>\n");
    XmlArray::of_indices("connectivity", 0..cells.iter().map(|(_, points)| points).sum()).write(xml);
    XmlArray::of_indices("offsets", ends).write(xml);
    XmlArray::of_bytes("UInt8", "types", cells.iter().map(|(kind, _)| *kind)).write(xml);
    xml.push_str("</Cells>\n");
}

/// What VTK has to know of rational cells, and what warps them.
pub(super) fn write_weights_and_displacement(xml: &mut String, patches: &BezierPatches, controls: &[usize]) {
    let weights = controls.iter().map(|k| patches.undeformed.control_points[*k][3]);
    XmlArray::of_numbers("RationalWeights", weights).write(xml);
    let displacement = controls.iter().flat_map(|k| patches.displacement[*k]);
    XmlArray::of_numbers(DISPLACEMENT, displacement).of_components(&["x", "y", "z"]).in_unit("mm").write(xml);
}

/// Control points of a patch (second direction fastest) in the order of `vtkHigherOrderQuadrilateral`: corners around the cell,
/// then the inner points of its edges v = 0, u = 1, v = 1, u = 0, each with its parameter, then the inside with u fastest.
fn vtk_order([p, q]: [usize; 2]) -> Vec<usize> {
    let corners = [[0, 0], [p, 0], [p, q], [0, q]].into_iter();
    let edges = (1..p)
        .map(|i| [i, 0])
        .chain((1..q).map(|j| [p, j]))
        .chain((1..p).map(|i| [i, q]))
        .chain((1..q).map(|j| [0, j]));
    let inside = (1..q).flat_map(|j| (1..p).map(move |i| [i, j]));
    corners.chain(edges).chain(inside).map(|[i, j]| i * (q + 1) + j).collect()
}

#[cfg(test)]
mod tests {
    use super::vtk_order;

    #[test]
    fn points_of_a_cell_in_the_order_of_vtk() {
        // 2 by 3: i (q + 1) + j.
        assert_eq!(vtk_order([2, 3]), [0, 8, 11, 3, 4, 9, 10, 7, 1, 2, 5, 6]);
        let mut all = vtk_order([5, 2]);
        all.sort_unstable();
        assert!(all.into_iter().eq(0..18));
    }
}
