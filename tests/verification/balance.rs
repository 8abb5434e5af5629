//! The default quadrature leaves constant membrane forces on curved surfaces in balance: tubes under pressure, whole and cut,
//! uniform and graded, of every degree and thin to R/t = 3000, against p R²/(E t).

use std::sync::Arc;

use foldline::equilibrium::{Equilibrium, Standing, Workspace};
use foldline::model::starting_mesh;
use foldline::scene::{Scene, parse};
use foldline::spline::{Mesh, Spans, mid_surface_point};

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
         [mesh]\ndegree = [{degree}, {degree}]\nelements = [1, 1]\nquadrature = \"{quadrature}\"\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = {pressure:?}\n",
        part.tables()
    );
    parse(&text, "tube.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Knots that cut each span of a direction into pieces of these relative sizes.
fn cut(mesh: &Mesh, direction: usize, sizes: &[f64]) -> Vec<f64> {
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

/// The displacement of a scene on a mesh, and the points that its stretching and bending have.
fn solved(scene: &Scene, mesh: &Arc<Mesh>) -> (Vec<[f64; 3]>, [usize; 2]) {
    let mut work = Workspace::new(scene, mesh).unwrap();
    let tables = &work.discretization().tables;
    let bending = tables.points.references.len();
    let stretching = tables.stretching.as_ref().map_or(bending, |table| table.references.len());
    let still = vec![[0.0; 3]; mesh.control_points.len()];
    let start = Standing { displacement: &still, turns: &[], parameter: 0.0 };
    let found = Equilibrium::new(scene, &mut work).advance(start, scene.load.target(), &mut |_| false).unwrap();
    (found.displacement, [stretching, bending])
}

/// Largest error of the radial displacement along the arc, relative to p R²/(E t).
fn tube_error(
    part: Part,
    radius_over_thickness: f64,
    degree: usize,
    per_quarter: usize,
    graded: bool,
    quadrature: &str,
) -> (f64, [usize; 2]) {
    let scene = tube(part, radius_over_thickness, degree, quadrature);
    let coarse = starting_mesh(&scene).unwrap();
    let spans = coarse.element_counts()[1];
    let sizes = sizes(per_quarter * part.quarters() / spans, graded);
    let mesh = Arc::new(coarse.with_knots(&[vec![0.25, 0.5, 0.75], cut(&coarse, 1, &sizes)]));
    let (displacement, points) = solved(&scene, &mesh);
    let exact = STRAIN * RADIUS;
    let mut worst = 0.0_f64;
    for sample in 0..=40 {
        for u in [0.0] {
            let at = [u, sample as f64 / 40.0];
            let before = mid_surface_point(&mesh, &[], at).position;
            let after = mid_surface_point(&mesh, &displacement, at).position;
            let radial = (1..3).map(|c| (after[c] - before[c]) * before[c] / RADIUS).sum::<f64>();
            worst = worst.max((radial / exact - 1.0).abs());
        }
    }
    let elements = mesh.element_counts();
    let _ = elements;
    (worst, points)
}

#[test]
#[ignore = "a table"]
fn table_of_tubes() {
    let rule = std::env::var("RULE").unwrap_or("balanced".into());
    for part in [Part::Quarter, Part::Half, Part::Whole] {
        for degree in 2..=5 {
            for graded in [false, true] {
                for ratio in [30.0, 100.0, 300.0, 1000.0, 3000.0] {
                    let mut row = String::new();
                    for count in [4, 8, 16, 32, 64] {
                        let (error, [stretching, bending]) = tube_error(part, ratio, degree, count, graded, &rule);
                        let share = stretching as f64 / bending as f64;
                        row += &format!("  {:9.4} {share:.2}", 100.0 * error);
                    }
                    println!("{part:?} p {degree} {} R/t {ratio:5}: {row}", if graded { "graded " } else { "uniform" });
                }
            }
        }
    }
}
