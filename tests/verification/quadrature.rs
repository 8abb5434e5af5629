//! Quadrature with fewer points leaves no field without energy but the six rigid motions: eigenvalues of the stiffness
//! without supports, on small, large and strongly graded meshes, of every degree, and after refinement.

use std::sync::Arc;

use foldline::energy::{Discretization, Want};
use foldline::equilibrium::Assembled;
use foldline::model::{starting_mesh, starting_patch};
use foldline::scene::{Quadrature, Scene, parse};
use foldline::spline::{Mesh, Patch};
use nalgebra::DMatrix;

/// A short panel, so thick that bending and stretching are not far apart: what has no energy stands out.
fn panel(degree: usize, elements: [usize; 2], quadrature: Quadrature) -> Scene {
    panel_of(1.0, degree, elements, quadrature)
}

fn panel_of(thickness: f64, degree: usize, elements: [usize; 2], quadrature: Quadrature) -> Scene {
    let text = format!(
        r#"
        [geometry]
        kind = "cylinder-panel"
        length_mm = 12.0
        radius_mm = 10.0
        arc_deg = 60.0
        [material]
        kind = "isotropic"
        youngs_modulus_mpa = 1.0
        poissons_ratio = 0.3
        thickness_mm = {thickness:?}
        [mesh]
        degree = [{degree}, {degree}]
        elements = [{}, {}]
        quadrature = "{}"
        [load]
        kind = "steps"
        factor = 1.0
        increment = 1.0
        [[support]]
        name = "root"
        on = "u-start"
        kind = "clamped"
        [[action]]
        on = [1.0, 0.5]
        kind = "force"
        force_n = [0.0, 0.0, 1.0]
        "#,
        elements[0],
        elements[1],
        quadrature.name()
    );
    parse(&text, "panel.toml").unwrap()
}

/// Eigenvalues of the stiffness on the control points, ascending, at a displacement.
fn eigenvalues(scene: &Scene, mesh: &Arc<Mesh>, displacement: &[[f64; 3]]) -> Vec<f64> {
    let discretization = Discretization::new(scene, mesh).unwrap();
    let mut assembled = Assembled::new(&discretization);
    assembled.assemble(&discretization, displacement, 0.0, Want::Stiffness);
    let count = mesh.point_count();
    let mut matrix = DMatrix::zeros(3 * count, 3 * count);
    for column in 0..3 * count {
        let mut field = vec![[0.0; 3]; count];
        field[column / 3][column % 3] = 1.0;
        for (point, force) in assembled.multiply(&discretization, &field).iter().enumerate() {
            (0..3).for_each(|c| matrix[(3 * point + c, column)] = force[c]);
        }
    }
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Six eigenvalues vanish, and the seventh is that of full quadrature but for its error.
fn check(degree: usize, quadrature: Quadrature, mesh: &Arc<Mesh>, what: &str) {
    check_against(Quadrature::Full, 1.0, degree, quadrature, mesh, what);
}

fn check_against(
    reference: Quadrature,
    thickness: f64,
    degree: usize,
    quadrature: Quadrature,
    mesh: &Arc<Mesh>,
    what: &str,
) {
    let still = vec![[0.0; 3]; mesh.point_count()];
    let values = |quadrature| eigenvalues(&panel_of(thickness, degree, [1, 1], quadrature), mesh, &still);
    let (found, full) = (values(quadrature), values(reference));
    let rounding = 1e-12 * full[full.len() - 1];
    let what = format!("degree {degree}, {}, thickness {thickness}, {what}", quadrature.name());
    assert!(found[0] > -rounding && found[5] < rounding, "{what}: six rigid motions, {:?}", &found[..7]);
    assert!(found[6] > 0.5 * full[6], "{what}: {:e} where full quadrature has {:e}", found[6], full[6]);
}

fn graded(mesh: &Patch) -> Patch {
    // Each knot ten times closer to the edge than the one before, and a pair that is very close together inside.
    mesh.with_knots(&[vec![1e-3, 1e-2, 0.1, 0.5, 0.5001], vec![0.3, 0.9, 0.99, 0.999]])
}

#[test]
fn no_field_but_rigid_motions_is_without_energy() {
    for quadrature in [Quadrature::Reduced, Quadrature::Patch] {
        for degree in 2..=5 {
            for elements in [[1, 1], [2, 1], [3, 3], [5, 4]] {
                let mesh = Arc::new(starting_mesh(&panel(degree, elements, quadrature)).unwrap());
                check(degree, quadrature, &mesh, &format!("{elements:?} elements"));
            }
            let mesh = starting_patch(&panel(degree, [1, 1], quadrature)).unwrap();
            check(degree, quadrature, &Arc::new(graded(&mesh).into()), "graded");
            let refined =
                mesh.with_knots(&[vec![0.5], vec![0.25, 0.5, 0.75]]).with_knots(&[vec![0.75, 0.875], vec![0.125]]);
            check(degree, quadrature, &Arc::new(refined.into()), "refined twice");
        }
    }
}

/// The default against degree + 3 points: on patches of all small sizes and on strips, thick, where its points are few, and
/// thin, where they are many.
#[test]
fn the_default_is_nowhere_half_as_stiff() {
    let quadrature = Quadrature::Balanced;
    for degree in 2..=5 {
        for thickness in [1.0, 0.1] {
            let check = |mesh: Patch, what: &str| {
                check_against(Quadrature::FullPlusTwo, thickness, degree, quadrature, &Arc::new(mesh.into()), what);
            };
            for elements in [[1, 1], [1, 2], [2, 2], [3, 2], [8, 1], [1, 8], [4, 4]] {
                let mesh = starting_patch(&panel(degree, elements, quadrature)).unwrap();
                check(mesh, &format!("{elements:?} elements"));
            }
            let single = starting_patch(&panel(degree, [1, 1], quadrature)).unwrap();
            check(single.with_knots(&[vec![], vec![0.4, 0.6, 0.7]]), "graded strip");
            check(single.with_knots(&[vec![0.5, 0.75, 0.9], vec![0.4, 0.6, 0.7]]), "graded");
            check(single.with_knots(&[vec![0.5], vec![0.5; degree - 1]]), "repeated knot");
        }
    }
}

#[test]
#[ignore = "minutes"]
fn the_default_is_nowhere_half_as_stiff_on_any_small_patch() {
    for degree in 2..=5 {
        for thickness in [1.0, 0.1] {
            for elements in (1..=8).flat_map(|u| (1..=8).map(move |v| [u, v])) {
                let mesh = Arc::new(starting_mesh(&panel(degree, elements, Quadrature::Balanced)).unwrap());
                let what = format!("{elements:?} elements");
                check_against(Quadrature::FullPlusTwo, thickness, degree, Quadrature::Balanced, &mesh, &what);
            }
        }
    }
}

/// The check sees what holds nothing.
#[test]
fn too_few_points_would_show() {
    let scene = panel(3, [6, 6], Quadrature::Patch);
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    let still = vec![[0.0; 3]; mesh.point_count()];
    let mut poor = Discretization::new(&scene, &mesh).unwrap();
    // All points of the elements next to one edge lose their stiffness, as if none were there.
    let elements = poor.shells[0].tables.elements.counts[1];
    let lost: usize = (0..elements).map(|element| poor.shells[0].tables.points.element_points(element).len()).sum();
    let tables = &mut poor.shells[0].tables;
    tables.points.functions[..lost * 5 * tables.padded].fill(0.0);
    let mut assembled = Assembled::new(&poor);
    assembled.assemble(&poor, &still, 0.0, Want::Stiffness);
    let mut corner = still.clone();
    corner[0] = [1.0, 0.0, 0.0];
    let force = assembled.multiply(&poor, &corner);
    assert!(force.iter().flatten().all(|value| *value == 0.0), "a corner that nothing holds");
}
