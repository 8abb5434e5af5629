//! The default quadrature leaves constant membrane forces on curved surfaces in balance: tubes under pressure, whole and cut,
//! uniform and graded, of every degree and thin to R/t = 3000, against p R²/(E t). On other shells it is at most 1.35 times as
//! far off as p + 2 points, and 2.5 times under membrane stress that varies along the arc (found: 1.28 and 1.03 at worst).

use std::sync::Arc;

use foldline::energy::{Discretization, Want};
use foldline::equilibrium::{Assembled, Configuration, Equilibrium, Workspace};
use foldline::model::starting_patch;
use foldline::scene::{Scene, parse};
use foldline::spline::{Patch, Spans, mid_surface_point};
use nalgebra::{DMatrix, DVector};

/// Radius, mm; modulus, MPa; hoop strain: so small that the shell is linear, so large that rounding is not seen.
const RADIUS: f64 = 10.0;
const MODULUS: f64 = 70e3;
const STRAIN: f64 = 1e-7;

/// How much of a tube is modelled.
#[derive(Clone, Copy, Debug)]
enum Part {
    Whole,
    Half,
    Quarter,
}

impl Part {
    fn quarters(self) -> usize {
        match self {
            Part::Whole => 4,
            Part::Half => 2,
            Part::Quarter => 1,
        }
    }

    /// Arcs of one segment that it is built from.
    fn segments(self) -> usize {
        match self {
            Part::Whole => 3,
            Part::Half => 2,
            Part::Quarter => 1,
        }
    }

    /// Geometry, and supports beside that of the end.
    fn tables(self) -> &'static str {
        match self {
            Part::Whole => {
                "arc_deg = 360.0\nseam = \"smooth\"\n\
                 [[support]]\non = [0.0, 0.5]\nkind = \"fixed\"\nhold = [\"y\"]\n\
                 [[support]]\non = [0.0, 0.0]\nkind = \"fixed\"\nhold = [\"y\"]\n\
                 [[support]]\non = [0.0, 0.25]\nkind = \"fixed\"\nhold = [\"z\"]\n"
            }
            Part::Half => {
                "arc_deg = 180.0\n\
                 [[support]]\non = \"v-start\"\nkind = \"symmetric\"\n\
                 [[support]]\non = \"v-end\"\nkind = \"symmetric\"\n\
                 [[support]]\non = [0.0, 0.5]\nkind = \"fixed\"\nhold = [\"y\"]\n"
            }
            Part::Quarter => {
                "arc_deg = 90.0\n\
                 [[support]]\non = \"v-start\"\nkind = \"symmetric\"\n\
                 [[support]]\non = \"v-end\"\nkind = \"symmetric\"\n"
            }
        }
    }
}

fn tube(part: Part, radius_over_thickness: f64, degree: usize, quadrature: &str) -> Scene {
    let thickness = RADIUS / radius_over_thickness;
    let pressure = STRAIN * MODULUS / radius_over_thickness;
    let text = format!(
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 24.0\nradius_mm = {RADIUS:?}\n{}\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = {MODULUS:?}\npoissons_ratio = 0.3\n\
         thickness_mm = {thickness:?}\n\
         [mesh]\ndegree = [{degree}, {degree}]\nelements = [1, {}]\nquadrature = \"{quadrature}\"\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = {pressure:?}\n",
        part.tables(),
        part.segments()
    );
    parse(&text, "tube.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Knots that cut each span of a direction into pieces of these relative sizes.
fn cut(mesh: &Patch, direction: usize, sizes: &[f64]) -> Vec<f64> {
    let total: f64 = sizes.iter().sum();
    let spans = Spans::of(&mesh.knots[direction], mesh.degree[direction]).bounds;
    let in_span = |[from, to]: &[f64; 2]| {
        let mut sum = 0.0;
        let cuts = sizes[..sizes.len() - 1].iter().map(|size| {
            sum += size;
            from + (to - from) * sum / total
        });
        cuts.collect::<Vec<f64>>()
    };
    spans.iter().flat_map(in_span).collect()
}

/// Sizes of `count` elements: equal, or neighbours as 1 to 2.
fn sizes(count: usize, graded: bool) -> Vec<f64> {
    let pattern = if graded { [1.0, 0.5, 0.25, 0.5] } else { [1.0; 4] };
    (0..count).map(|k| pattern[k % 4]).collect()
}

/// The displacement of a scene on a mesh.
fn solved(scene: &Scene, mesh: &Patch) -> Vec<[f64; 3]> {
    let mut work = Workspace::new(scene, &Arc::new(mesh.clone().into())).unwrap();
    let still = vec![[0.0; 3]; mesh.control_points.len()];
    let start = Configuration { displacement: &still, turns: &[], parameter: 0.0, largest_force: 0.0 };
    Equilibrium::new(scene, &mut work).advance(start, scene.load.target(), &mut |_| false).unwrap().displacement
}

/// Largest error of the radial displacement along the arc, relative to p R²/(E t). Beside the end that may move freely along
/// the axis, where Poisson's ratio bends the free edge.
fn tube_error(
    part: Part,
    radius_over_thickness: f64,
    degree: usize,
    per_quarter: usize,
    graded: bool,
    quadrature: &str,
) -> f64 {
    let scene = tube(part, radius_over_thickness, degree, quadrature);
    let coarse = starting_patch(&scene).unwrap();
    let spans = coarse.element_counts()[1];
    let sizes = sizes(per_quarter * part.quarters() / spans, graded);
    let mesh = Arc::new(coarse.with_knots(&[vec![0.25, 0.5, 0.75], cut(&coarse, 1, &sizes)]));
    let displacement = solved(&scene, &mesh);
    let exact = STRAIN * RADIUS;
    let off = (0..=40).map(|sample| {
        let at = [0.0, sample as f64 / 40.0];
        let before = mid_surface_point(&mesh, &[], at).position;
        let after = mid_surface_point(&mesh, &displacement, at).position;
        let radial = (1..3).map(|c| (after[c] - before[c]) * before[c] / RADIUS).sum::<f64>();
        (radial / exact - 1.0).abs()
    });
    off.fold(0.0, f64::max)
}

fn check_tubes(parts: &[Part], degrees: &[usize], ratios: &[f64], counts: &[usize]) {
    for part in parts {
        for degree in degrees {
            for graded in [false, true] {
                for ratio in ratios {
                    // Degree 2 is asked for 0.1 % from 16 elements, and gives it from 4.
                    let off = counts.iter().map(|n| (tube_error(*part, *ratio, *degree, *n, graded, "balanced"), *n));
                    for (off, count) in off {
                        let what = format!("{part:?}, degree {degree}, {count} elements, graded {graded}, R/t {ratio}");
                        assert!(off < 1e-3, "{what}: {:.4} %", 100.0 * off);
                    }
                }
            }
        }
    }
}

#[test]
fn tubes_under_pressure() {
    check_tubes(&[Part::Quarter, Part::Whole], &[2, 3], &[30.0, 3000.0], &[4, 8]);
    check_tubes(&[Part::Quarter], &[3, 4, 5], &[100.0, 1000.0], &[4, 16]);
}

#[test]
#[ignore = "minutes"]
fn every_tube_under_pressure() {
    check_tubes(
        &[Part::Quarter, Part::Half, Part::Whole],
        &[2, 3, 4, 5],
        &[30.0, 100.0, 300.0, 1000.0, 3000.0],
        &[4, 8, 16, 32, 64],
    );
}

/// The tube of the fault that is to be seen no more: 82 % off at eight elements.
#[test]
fn the_rule_for_bending_alone_would_show() {
    let off = tube_error(Part::Quarter, 1000.0, 3, 8, false, "patch");
    assert!((0.75..0.9).contains(&off), "{off}");
}

/// Forces of a displacement on a finer mesh, on the control points of a coarser one: what a load made from a known
/// displacement is in the coarser space.
fn restricted(coarse: &Patch, new: &[Vec<f64>; 2], forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let of_function = |a: usize| {
        let mut marked = coarse.clone();
        for (b, point) in marked.control_points.iter_mut().enumerate() {
            point[0] = if a == b { point[3] } else { 0.0 };
        }
        let shares = marked.with_knots(new).control_points;
        let terms = shares.iter().zip(forces).filter(|(share, _)| share[0] != 0.0);
        terms.fold([0.0; 3], |sum, (share, force)| [0, 1, 2].map(|c| sum[c] + share[0] / share[3] * force[c]))
    };
    (0..coarse.control_points.len()).map(of_function).collect()
}

/// Displacement under forces on the control points, of the undeformed shell (linear).
fn linear(scene: &Scene, mesh: &Patch, forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let discretization = Discretization::new(scene, &Arc::new(mesh.clone().into())).unwrap();
    let mut assembled = Assembled::new(&discretization);
    let still = vec![[0.0; 3]; mesh.control_points.len()];
    assembled.assemble(&discretization, &still, 0.0, Want::Stiffness);
    let count = discretization.unknowns.count();
    let placement = discretization.unknowns.configure(&vec![0.0; count], 0.0);
    let mut matrix = DMatrix::zeros(count, count);
    for column in 0..count {
        let mut unit = vec![0.0; count];
        unit[column] = 1.0;
        let image = assembled.multiply(&discretization, &placement.velocity(&unit, &[]));
        matrix.set_column(column, &DVector::from_vec(placement.restrict(&image)));
    }
    let right = DVector::from_vec(placement.restrict(forces));
    let solution = matrix.cholesky().expect("held").solve(&right);
    placement.velocity(solution.as_slice(), &[])
}

/// Largest error of a quarter tube whose hoop stress varies along the arc: loads from a displacement in a space eight times as
/// fine.
fn varying_error(ratio: f64, degree: usize, count: usize, graded: bool, quadrature: &str) -> f64 {
    let scene = tube(Part::Quarter, ratio, degree, quadrature);
    let exact_scene = tube(Part::Quarter, ratio, degree, "full-plus-two");
    let single = starting_patch(&scene).unwrap();
    let coarse = Arc::new(single.with_knots(&[vec![], cut(&single, 1, &sizes(count, graded))]));
    let new = [vec![], cut(&coarse, 1, &[1.0; 8])];
    let fine = Arc::new(coarse.with_knots(&new));
    let given: Vec<[f64; 3]> = fine
        .control_points
        .iter()
        .map(|[_, y, z, w]| {
            let (y, z) = (y / w, z / w);
            let angle = y.atan2(z);
            // Neither its radial nor its tangential part crosses the planes at ±45°.
            let radial = 1.0 + 0.4 * (4.0 * angle).cos() + 0.2 * (8.0 * angle).cos();
            [0.0, radial * angle.sin(), radial * angle.cos()]
        })
        .collect();
    let discretization = Discretization::new(&exact_scene, &Arc::new((*fine).clone().into())).unwrap();
    let mut assembled = Assembled::new(&discretization);
    let still = vec![[0.0; 3]; fine.control_points.len()];
    assembled.assemble(&discretization, &still, 0.0, Want::Stiffness);
    let forces = assembled.multiply(&discretization, &given);
    let found = linear(&scene, &coarse, &restricted(&coarse, &new, &forces));
    let off = (0..=200).map(|sample| {
        let at = [0.5, sample as f64 / 200.0];
        let exact = sub(mid_surface_point(&fine, &given, at).position, mid_surface_point(&fine, &[], at).position);
        let found = sub(mid_surface_point(&coarse, &found, at).position, mid_surface_point(&coarse, &[], at).position);
        length(sub(exact, found))
    });
    off.fold(0.0, f64::max)
}

fn check_varying(degrees: &[usize], ratios: &[f64], counts: &[usize]) {
    for degree in degrees {
        for ratio in ratios {
            for count in counts {
                for graded in [false, true] {
                    let [found, exact] =
                        ["balanced", "full-plus-one"].map(|rule| varying_error(*ratio, *degree, *count, graded, rule));
                    println!(
                        "degree {degree}, R/t {ratio}, {count} elements, graded {graded}: {:.3} %, p + 2 points {:.3} %",
                        100.0 * found,
                        100.0 * exact
                    );
                    assert!(found < 2.5 * exact, "degree {degree}, R/t {ratio}, {count} elements, graded {graded}");
                }
            }
        }
    }
}

#[test]
fn membrane_stress_that_varies() {
    check_varying(&[3], &[30.0, 1000.0], &[8]);
}

#[test]
#[ignore = "minutes"]
fn membrane_stress_that_varies_on_every_tube() {
    check_varying(&[2, 3, 4, 5], &[30.0, 100.0, 300.0, 1000.0, 3000.0], &[8, 16, 32]);
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| a[c] - b[c])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Shells that are no tubes; `{}` is where the rest of a scene goes. Thickness follows from R/t.
const SHELLS: [(&str, f64, &str); 5] = [
    (
        "dome under pressure",
        10.0,
        "[geometry]\nkind = \"sphere-zone\"\nradius_mm = 10.0\nlatitude_deg = [30.0, 80.0]\narc_deg = 90.0\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n[[support]]\non = \"u-end\"\nkind = \"symmetric\"\n\
         [[support]]\non = \"v-start\"\nkind = \"clamped\"\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = LOAD\n",
    ),
    (
        "hypar with free edges",
        10.0,
        "[geometry]\nkind = \"nurbs\"\ndegrees = [2, 2]\nknots_u = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]\n\
         knots_v = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]\n\
         control_points_mm = [[-5.0, -5.0, 0.0], [-5.0, 0.0, 5.0], [-5.0, 5.0, 0.0], [0.0, -5.0, -5.0], [0.0, 0.0, 0.0], \
         [0.0, 5.0, -5.0], [5.0, -5.0, 0.0], [5.0, 0.0, 5.0], [5.0, 5.0, 0.0]]\n\
         [[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = LOAD\nfollower = false\n",
    ),
    (
        "pinched cylinder",
        10.0,
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 10.0\nradius_mm = 10.0\narc_deg = 90.0\n\
         [[support]]\non = \"u-start\"\nkind = \"fixed\"\nhold = [\"y\", \"z\"]\n\
         [[support]]\non = \"u-end\"\nkind = \"symmetric\"\n\
         [[support]]\non = \"v-start\"\nkind = \"symmetric\"\n[[support]]\non = \"v-end\"\nkind = \"symmetric\"\n\
         [[action]]\nkind = \"force\"\non = [1.0, 1.0]\nforce_n = [0.0, LOAD, LOAD]\n",
    ),
    (
        "hemisphere, pulled and pushed",
        10.0,
        "[geometry]\nkind = \"sphere-zone\"\nradius_mm = 10.0\nlatitude_deg = [0.0, 72.0]\narc_deg = 90.0\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n[[support]]\non = \"u-end\"\nkind = \"symmetric\"\n\
         [[support]]\non = [0.0, 1.0]\nkind = \"fixed\"\nhold = [\"z\"]\n\
         [[action]]\nkind = \"force\"\non = [0.0, 0.0]\nforce_n = [LOAD, 0.0, 0.0]\n\
         [[action]]\nkind = \"force\"\non = [1.0, 0.0]\nforce_n = [0.0, -LOAD, 0.0]\n",
    ),
    (
        "tape spring, one end turned",
        10.0,
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 40.0\nradius_mm = 10.0\narc_deg = 110.0\n\
         [[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
         [[support]]\non = \"u-end\"\nkind = \"rigid\"\nrotation_y_deg = 1e-6\nx_mm = \"free\"\nz_mm = \"free\"\n",
    ),
];

fn shell(text: &str, size: f64, ratio: f64, degree: usize, quadrature: &str) -> Scene {
    let thickness = size / ratio;
    // Small enough to be linear: a strain of some 1e-8 under pressure, forces by the stiffness against bending.
    let load = if text.contains("pressure") {
        format!("{:?}", 1e-10 * MODULUS / ratio)
    } else {
        format!("{:?}", 1e-6 * MODULUS * thickness.powi(3))
    };
    let text = format!(
        "{}[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = {MODULUS:?}\npoissons_ratio = 0.3\n\
         thickness_mm = {thickness:?}\n\
         [mesh]\ndegree = [{degree}, {degree}]\nelements = [1, 1]\nquadrature = \"{quadrature}\"\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n",
        text.replace("LOAD", &load)
    );
    parse(&text, "shell.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Displacements at samples of the surface.
fn sampled(scene: &Scene, sizes: &[f64]) -> Vec<[f64; 3]> {
    let single = starting_patch(scene).unwrap();
    let mesh = Arc::new(single.with_knots(&[cut(&single, 0, sizes), cut(&single, 1, sizes)]));
    let displacement = solved(scene, &mesh);
    let at = |sample: usize| [(sample % 11) as f64 / 10.0, (sample / 11) as f64 / 10.0];
    (0..121)
        .map(|sample| {
            let [before, after] = [&[][..], &displacement].map(|u| mid_surface_point(&mesh, u, at(sample)).position);
            sub(after, before)
        })
        .collect()
}

/// Largest difference over the largest displacement.
fn difference(found: &[[f64; 3]], exact: &[[f64; 3]]) -> f64 {
    let largest = exact.iter().map(|u| length(*u)).fold(0.0, f64::max);
    found.iter().zip(exact).map(|(a, b)| length(sub(*a, *b))).fold(0.0, f64::max) / largest
}

/// Error over that of p + 2 points.
const MOST_OVER: f64 = 1.25;
/// The same on tape springs with quadratic elements, which a dome's rule would make half as slow again.
const MOST_OVER_QUADRATIC: f64 = 1.35;

fn check_shells(degrees: &[usize], ratios: &[f64], counts: &[usize], reference: usize, print: bool) {
    let mut worse = Vec::new();
    for (name, size, text) in SHELLS {
        for ratio in ratios {
            let exact = sampled(&shell(text, size, *ratio, 5, "full-plus-one"), &sizes(reference, false));
            for degree in degrees {
                for (count, graded) in counts.iter().flat_map(|count| [(*count, false), (*count, true)]) {
                    let error = |rule: &str| {
                        let begin = std::time::Instant::now();
                        let found = sampled(&shell(text, size, *ratio, *degree, rule), &sizes(count, graded));
                        (difference(&found, &exact), begin.elapsed().as_secs_f64())
                    };
                    let what = format!("{name}, R/t {ratio}, degree {degree}, {count} elements, graded {graded}");
                    let (found, exact) = (error("balanced"), error("full-plus-one"));
                    if print {
                        let others = ["patch", "reduced", "full"].map(error);
                        let row = others
                            .iter()
                            .chain([&found, &exact])
                            .map(|(off, seconds)| format!("  {:8.3} % {:6.1} ms", 100.0 * off, 1e3 * seconds));
                        println!("{what}: {}", row.collect::<String>());
                    }
                    // Where p + 2 points are better than the reference can tell, nothing is asked.
                    let is_quadratic_tape = *degree == 2 && name.starts_with("tape spring");
                    let over = if is_quadratic_tape { MOST_OVER_QUADRATIC } else { MOST_OVER };
                    let most = (over * exact.0).max(1e-4);
                    if found.0 >= most {
                        worse.push(format!("{what}: {:e}, p + 2 points {:e}", found.0, exact.0));
                    }
                }
            }
        }
    }
    assert!(worse.is_empty(), "{worse:#?}");
}

#[test]
fn shells_that_are_no_tubes() {
    check_shells(&[3], &[100.0], &[4, 8], 16, false);
}

/// Errors and times of all rules.
#[test]
#[ignore = "minutes; a table"]
fn table_of_rules() {
    println!("columns: patch, reduced, full, balanced, full-plus-one (degree + 2 points)");
    check_shells(&[2, 3, 4], &[30.0, 300.0, 3000.0], &[4, 8, 16], 32, true);
}
