//! The deformed surface as triangles: binary STL, in mm.

use crate::shell::{cross, norm, sub};
use crate::spline::{Grid, Patch, Spans, mid_surface_point};

/// Length of the text in front.
const HEAD_LEN: usize = 80;

/// Formats surfaces as binary STL, with 2 · (`points` − 1)² triangles for each element; `title` is what its head says, as far
/// as it has room. Corners lie on the surface; neighbours share them exactly, and triangles without area are left out.
pub fn stl(surfaces: &[&Patch], points: usize, title: &str) -> Vec<u8> {
    let triangles: Vec<Vec<u8>> = surfaces.iter().flat_map(|surface| triangles(surface, points)).collect();
    let mut bytes: Vec<u8> = title.bytes().chain(std::iter::repeat(0)).take(HEAD_LEN).collect();
    bytes.extend((triangles.len() as u32).to_le_bytes());
    bytes.extend(triangles.into_iter().flatten());
    bytes
}

/// The triangles of a surface, 50 bytes each.
fn triangles(surface: &Patch, points: usize) -> Vec<Vec<u8>> {
    let [us, vs] = [0, 1].map(|direction| lines(surface, direction, points));
    let grid = Grid::new([us.len(), vs.len()]);
    let at = |k: usize| {
        let [i, j] = grid.place(k);
        mid_surface_point(surface, &[], [us[i], vs[j]]).position
    };
    let corners: Vec<[f64; 3]> = (0..grid.len()).map(at).collect();
    let of_cell = |k: usize| {
        let [i, j] = Grid::new([us.len() - 1, vs.len() - 1]).place(k);
        let corner = |di, dj| corners[grid.index([i + di, j + dj])];
        [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]]
    };
    let triangles = (0..(us.len() - 1) * (vs.len() - 1)).flat_map(of_cell);
    triangles.filter_map(triangle).collect()
}

/// Parameters of the lines of points in a direction.
fn lines(surface: &Patch, direction: usize, points: usize) -> Vec<f64> {
    let spans = Spans::of(&surface.knots[direction], surface.degree[direction]).bounds;
    let parts = points - 1;
    let of_span = |[from, to]: &[f64; 2]| {
        let (from, length) = (*from, to - from);
        (0..parts).map(move |part| from + length * part as f64 / parts as f64)
    };
    spans.iter().flat_map(of_span).chain(spans.last().map(|[_, to]| *to)).collect()
}

/// The 50 bytes of a triangle.
fn triangle(corners: [[f64; 3]; 3]) -> Option<Vec<u8>> {
    let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
    let length = norm(normal);
    let vectors = std::iter::once(normal.map(|component| component / length)).chain(corners);
    let bytes = vectors.flatten().flat_map(|number| (number as f32).to_le_bytes()).chain([0, 0]);
    (length > 0.0).then(|| bytes.collect())
}
