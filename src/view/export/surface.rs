//! The shell for ParaView: an unstructured grid of rational Bézier cells, which are the NURBS surface itself.
//!
//! Format: VTK File Formats, "UnstructuredGrid"; cells of type `VTK_BEZIER_QUADRILATERAL`, whose degrees and weights VTK finds in
//! the cell array `HigherOrderDegrees` and the point array `RationalWeights`. Points are those of the undeformed surface, and
//! `displacement` has the displacements of the control points: "Warp by Vector" with scale 1 makes exactly the deformed surface,
//! since both are sums of the same rational functions. Other fields are coefficients of patches that take the field's values at
//! (p + 1)(q + 1) uniform points of each cell, and no numbers in a cell in which a field has no value at one of them. Coefficients may lie beyond all values of the surface, where a field has an extreme inside
//! a cell; so the range of the values stands beside them, as the field array `NAME_range` (a row for each component). They are of
//! single precision, which is finer than any mesh; positions and displacements are exact.

use rayon::prelude::*;

use super::bezier::BezierPatches;
use super::bezier_grid::{BezierGrid, BezierGrids, DISPLACEMENT};
use super::instant::Instant;
use super::whole_shell::{WholePoint, WholeShell};
use super::xml_array::XmlArray;
use crate::view::fields::Field;

/// VTK's type of the cells.
const BEZIER_QUADRILATERAL: u8 = 77;

/// Formats shells as the text of a `.vtu` file, with `displacement` and these fields as point arrays, and the numbers of the
/// instant as field arrays. Cells of a structure have the number of their shell in the cell array `shell`, from 0, and
/// `shell_names` in the field data has the names.
pub fn surface_vtu(shells: &[WholeShell], fields: &[Field], instant: &Instant) -> String {
    let shown: Vec<&Field> = fields.iter().filter(|field| field.name != DISPLACEMENT).collect();
    let patches: Vec<BezierPatches> = shells.iter().map(BezierPatches::of).collect();
    let mut on_cells: Vec<OnCells> = shown.iter().map(|field| OnCells { field, cells: Vec::new() }).collect();
    for (shell, patches) in shells.iter().zip(&patches) {
        add_fields_on_cells(shell, patches, &mut on_cells);
    }
    BezierGrids {
        grids: patches.iter().map(cells_of).collect(),
        names: shells.iter().filter_map(WholeShell::name).collect(),
    }
    .vtu(instant, on_cells.iter().map(OnCells::range_array), on_cells.iter().map(OnCells::array))
}

/// The cells of a shell.
fn cells_of(patches: &BezierPatches) -> BezierGrid<'_> {
    let degree = patches.undeformed.degree;
    let (order, cells) = (vtk_order(degree), patches.elements().len());
    let in_order = |element| {
        let controls: Vec<usize> = patches.of_element(element).collect();
        order.iter().map(|k| controls[*k]).collect::<Vec<_>>()
    };
    // Every cell has points of its own: fields may jump between elements.
    let controls = (0..cells).flat_map(in_order).collect();
    BezierGrid { patches, kind: BEZIER_QUADRILATERAL, degrees: vec![degree; cells], controls }
}

/// A field on the cells.
struct OnCells<'f> {
    field: &'f Field,
    /// In the order of the cells.
    cells: Vec<OnCell>,
}

/// A field on a cell.
struct OnCell {
    /// In VTK's order.
    coefficients: Vec<[f64; 3]>,
    /// Least and largest value of each component at the nodes.
    range: [[f64; 2]; 3],
}

/// Adds the cells of a shell: a point is evaluated once for all fields.
fn add_fields_on_cells(shell: &WholeShell, patches: &BezierPatches, fields: &mut [OnCells]) {
    let order = vtk_order(patches.undeformed.degree);
    let asked: Vec<&Field> = fields.iter().map(|on_cells| on_cells.field).collect();
    let on_cell = |element: usize| {
        let bounds = patches.bounds(element);
        let points: Vec<WholePoint> = patches.nodes(element).map(|at| shell.at_in(bounds, at)).collect();
        let of_field = |field: &&Field| {
            let values: Vec<[f64; 3]> = points.iter().map(|point| point.value(field)).collect();
            let range = [0, 1, 2].map(|c| range(values.iter().map(|value| [value[c]; 2])));
            let coefficients = patches.interpolating(element, &values);
            OnCell { coefficients: order.iter().map(|k| coefficients[*k]).collect(), range }
        };
        asked.iter().map(of_field).collect()
    };
    let by_cell: Vec<Vec<OnCell>> = (0..patches.elements().len()).into_par_iter().map(on_cell).collect();
    for of_cell in by_cell {
        fields.iter_mut().zip(of_cell).for_each(|(field, on_cell)| field.cells.push(on_cell));
    }
}

/// The range that holds all of these; those that are no numbers do not count, and alone make a range of none.
fn range(ranges: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    ranges.fold([f64::NAN; 2], |[low, high], [least, most]| [low.min(least), high.max(most)])
}

impl OnCells<'_> {
    /// The range, a row for each component.
    fn range_array(&self) -> XmlArray {
        let count = self.field.components.len();
        let rows = (0..count).flat_map(|c| range(self.cells.iter().map(|cell| cell.range[c])));
        XmlArray::of_numbers(&format!("{}_range", self.field.name), rows)
            .of_components(&["least", "largest"])
            .tuples(count)
    }

    /// The coefficients.
    fn array(&self) -> XmlArray {
        let Field { name, components, unit, .. } = self.field;
        let all = self.cells.iter().flat_map(|cell| cell.coefficients.iter().copied());
        let numbers: Vec<f64> = all.flat_map(|value| value.into_iter().take(components.len())).collect();
        XmlArray::of_shown_numbers(name, &numbers).of_components(components).in_unit(unit)
    }
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
