//! Bonds against closed forms: a lap joint with its shear lag and the peel at its ends, and strips that bend as one.

use foldline::equilibrium::{Configuration, Workspace, linear_buckling};
use foldline::pipeline::Stages;
use foldline::record::ConnectionReading;
use foldline::scene::{Scene, parse};
use foldline::state::State;
use foldline::view::{Field, ShellsOfState, fields_of};

use crate::support::run;

/// Moduli, thickness and length of the strips, stiffness of the layer k = c E/t, and the pull.
const E: f64 = 70e3;
const T: f64 = 1.0;
const LENGTH: f64 = 40.0;
const C: f64 = 0.01;
/// A membrane strain of 1e-6, for which the closed form is meant.
const PULL: f64 = 1e-6 * E * T;

/// Two strips glued over their whole length: the lower one is pulled at its right end, the upper one at its left end, and moments P t/2 at
/// the loaded ends balance the couple. `further` is added to the length of the lower strip, on the right.
fn lap_joint(upper: [usize; 2], turned: bool, further: f64) -> Scene {
    let (moment, lower) = (0.5 * PULL * T, LENGTH + further);
    let elements = (lower * 1.5).round();
    // On the other side: the shell of the list that is first lies above, and its normal looks at the bond or away from it.
    let axes = if turned { "x_axis = [1.0, 0.0, 0.0]\ny_axis = [0.0, -1.0, 0.0]\n" } else { "" };
    let y = if turned { 10.0 } else { 0.0 };
    let sign = if turned { -1.0 } else { 1.0 };
    let text = format!(
        "[[shell]]\nname = \"lower\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = {lower:?}\nwidth_mm = 10.0\n\
         [shell.mesh]\nelements = [{elements}, 1]\n\
         [[shell]]\nname = \"upper\"\nposition_mm = [0.0, {y:?}, 1.0]\n{axes}\
         [shell.geometry]\nkind = \"plate\"\nlength_mm = {LENGTH:?}\nwidth_mm = 10.0\n[shell.mesh]\nelements = {upper:?}\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = {E:?}\npoissons_ratio = 0.0\nthickness_mm = {T:?}\n\
         [[bond]]\nname = \"glue\"\nshells = [\"lower\", \"upper\"]\nstiffness = {C:?}\n\
         [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
         [[support]]\nname = \"free\"\nkind = \"rigid-motions\"\n\
         [[action]]\nkind = \"line-force\"\nshell = \"lower\"\non = \"u-end\"\nforce_n_per_mm = [{PULL:?}, 0.0, 0.0]\n\
         [[action]]\nkind = \"line-force\"\nshell = \"upper\"\non = \"u-start\"\nforce_n_per_mm = [-{PULL:?}, 0.0, 0.0]\n\
         [[action]]\nkind = \"edge-moment\"\nshell = \"lower\"\non = \"u-end\"\nmoment_n = {moment:?}\n\
         [[action]]\nkind = \"edge-moment\"\nshell = \"upper\"\non = \"u-start\"\nmoment_n = {:?}\n",
        sign * moment
    );
    parse(&text, "lap.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Shear traction on the lower strip and peel of a lap joint of equal adherends, at a distance from its middle.
///
/// With δ the slip of the glued faces, N₁' = −τ = −k δ and E I (w₁ + w₂)⁗ = t τ′ give τ‴ = λ² τ′ with λ² = 8 k/(E t): Volkersen's
/// shear lag, λ² = 2 k/(E t), with the bending that Goland & Reissner add. At the ends δ′ = ∓4 P/(E t), and ∫τ = −P, so that
/// τ = −½ P λ cosh λx / sinh λc. The faces part by Δ with E I Δ⁗ = −2 k Δ, E I Δ″ = P t/2 and Δ‴ = 0 at both ends, which are so far
/// apart that each has its own e^{−βs} (cos βs − sin βs), β⁴ = k/(2 E I), with k Δ = ½ P t β² at the end.
fn expected(x: f64) -> [f64; 2] {
    let (k, half) = (C * E / T, 0.5 * LENGTH);
    let lambda = (8.0 * k / (E * T)).sqrt();
    let beta = (k / (2.0 * E * T.powi(3) / 12.0)).powf(0.25);
    let decayed = |s: f64| (-beta * s).exp() * ((beta * s).cos() - (beta * s).sin());
    let shear = -0.5 * PULL * lambda * (lambda * x).cosh() / (lambda * half).sinh();
    [shear, 0.5 * PULL * T * beta * beta * (decayed(half - x) + decayed(half + x))]
}

/// Share of the largest traction within which the closed form is met. Strips of 60 cubic elements of h = 0.67 mm have displacements
/// to (β h)⁴/384 = 3e-5 and, which the offset to the faces brings in, slopes to (β h)³/100 = 4e-4; ends that are e^{−βL} = 3e-9 apart and
/// strains of 1e-6 add nothing.
const CLOSE: f64 = 1e-3;

fn field(scene: &Scene, name: &str) -> Field {
    fields_of(scene).into_iter().find(|field| field.name == name).unwrap_or_else(|| panic!("there is no {name}"))
}

fn solved(scene: &Scene) -> (State, Vec<ConnectionReading>) {
    let (state, record) = run(scene.clone()).pop().unwrap();
    (state, record.report.connections)
}

/// The fields of both strips against the closed form, whatever the elements of the upper one, and whichever way its normal looks.
#[test]
fn a_lap_joint_has_the_shear_lag_and_the_peel_of_theory() {
    for (upper, turned) in [([60, 1], false), ([60, 1], true), ([53, 2], false)] {
        let scene = lap_joint(upper, turned, 0.0);
        let (state, connections) = solved(&scene);
        let [peel, shear] = ["bond_peel", "bond_shear"].map(|name| field(&scene, name));
        let shells = ShellsOfState::new(&scene, &state);
        let [most_shear, most_peel] = expected(0.5 * LENGTH);
        for fields in shells.fields() {
            for step in 0..=40 {
                let u = f64::from(step) / 40.0;
                let point = fields.at([u, 0.3]);
                let [along, across] = expected((u - 0.5) * LENGTH);
                let ([found, sideways, _], [opening, ..]) = (point.value(&shear), point.value(&peel));
                assert!((found - along).abs() < CLOSE * most_shear.abs(), "{upper:?} {u}: {found} for {along}");
                assert!(sideways.abs() < CLOSE * most_shear.abs(), "{upper:?} {u}: {sideways}");
                assert!((opening - across).abs() < CLOSE * most_peel, "{upper:?} {u}: {opening} for {across}");
            }
        }
        // At the ends, where the outermost Greville points lie.
        let [glue] = &connections[..] else { panic!("{connections:?}") };
        for (largest, field, most) in [(glue.shear, 0, most_shear.abs()), (glue.peel, 1, most_peel)] {
            let largest = largest.unwrap();
            let off = (largest.at[0] - 0.5).abs();
            assert!((off - 0.5).abs() < 1e-9, "{largest:?}");
            let there = expected((largest.at[0] - 0.5) * LENGTH)[field].abs();
            assert!((largest.mpa - there).abs() < CLOSE * most, "{largest:?} for {there}");
        }
    }
}

/// Beyond the end of the upper strip nothing is glued.
#[test]
fn there_is_no_traction_where_nothing_is_glued() {
    let scene = lap_joint([60, 1], false, 20.0);
    let (state, _) = solved(&scene);
    let peel = field(&scene, "bond_peel");
    let shells = ShellsOfState::new(&scene, &state);
    let [lower, upper] = &shells.fields().collect::<Vec<_>>()[..] else { panic!("two shells") };
    let at = |x: f64| lower.at([x / (LENGTH + 20.0), 0.5]).value(&peel)[0];
    assert!(at(39.9).is_finite() && at(1.0).is_finite());
    assert!(at(40.1).is_nan() && at(59.0).is_nan());
    assert!(upper.at([1.0, 0.5]).value(&peel)[0].is_finite());
    let range = lower.range(&peel, (0..=20).map(|k| [f64::from(k) / 20.0, 0.5])).unwrap()[0];
    assert!(range.iter().all(|end| end.is_finite()), "{range:?}");
}

/// A column of two strips glued on each other, clamped below, with a rigid section pushed at the top: 100 × 5 mm, 0.25 mm each.
/// `strips` are the heights of their surfaces, and where those lie off the middle.
fn glued_column(degree: usize, elements: [usize; 2], stiffness: f64, strips: [[f64; 2]; 2]) -> Scene {
    let strip = |name: &str, [height, offset]: [f64; 2], elements: usize| {
        format!(
            "[[shell]]\nname = \"{name}\"\nposition_mm = [0.0, 0.0, {height:?}]\n[shell.geometry]\nkind = \"plate\"\n\
             length_mm = 100.0\nwidth_mm = 5.0\n[shell.mesh]\ndegree = {degree}\nelements = [{elements}, 1]\n\
             [shell.material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = {E:?}\npoissons_ratio = 0.0\nthickness_mm = 0.25\n\
             offset_mm = {offset:?}\n"
        )
    };
    let text = format!(
        "{}{}[[bond]]\nname = \"glue\"\nshells = [\"lower\", \"upper\"]\nstiffness = {stiffness:?}\n\
         [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
         [[support]]\nname = \"root\"\nkind = \"clamped\"\nedges = [\"lower.u-start\", \"upper.u-start\"]\n\
         [[support]]\nname = \"tip\"\nkind = \"rigid\"\nedges = [\"lower.u-end\", \"upper.u-end\"]\nx_mm = \"free\"\nz_mm = \"free\"\n\
         rotation_y_deg = \"free\"\n\
         [[action]]\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [-1.0, 0.0, 0.0]\n",
        strip("lower", strips[0], elements[0]),
        strip("upper", strips[1], elements[1]),
    );
    parse(&text, "column.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Euler's loads of one strip of both thicknesses, 1, 9 and 25 times π² EI/(4 L²), on few elements and whatever the stiffness of the
/// layer: 20 times the third one, with a stiff layer on 8 cubic elements, where it is summed up at all Gauss points.
///
/// The third mode is 1.25 waves: 8 elements are 6.4 a wave, which is to be enough for 1 % with cubic and 0.3 % with quartic ones. The
/// layer itself slips by (q t)²/(2c) = 4e-4 there with c = 0.5.
#[test]
fn glued_strips_buckle_as_one_on_few_elements() {
    for (degree, elements, close) in [(3, [8, 8], 1e-2), (4, [8, 8], 3e-3), (3, [16, 16], 1e-3), (4, [16, 11], 2e-3)] {
        for stiffness in [0.5, 50.0] {
            let column = glued_column(degree, elements, stiffness, [[0.0, 0.0], [0.25, 0.0]]);
            let start = Stages::new(column.clone()).start().unwrap();
            let mut work = Workspace::new(&column, &start.mesh).unwrap();
            let found = linear_buckling(&mut work, Configuration::of(&start), 3).unwrap();
            let euler = std::f64::consts::PI.powi(2) * E * 5.0 * 0.5_f64.powi(3) / 12.0 / (4.0 * 100.0 * 100.0);
            assert_eq!(found.counted, 3);
            for (mode, times) in found.modes.iter().zip([1.0, 9.0, 25.0]) {
                let ratio = mode.factor / (times * euler);
                assert!((ratio - 1.0).abs() < close, "{degree} {elements:?} {stiffness}: load {times}: {ratio}");
            }
        }
    }
}

/// Surfaces off the middle of the thickness: strips that are drawn on their common face, and on their outer ones, are the same pair to
/// 1e-4: the layer is summed up at the same points, of other surfaces. As the middle ones they would cross, or lie apart.
#[test]
fn faces_are_those_of_the_material_whatever_the_offset() {
    let load = |lower: [f64; 2], upper: [f64; 2]| {
        let column = glued_column(3, [8, 8], 5.0, [lower, upper]);
        let start = Stages::new(column.clone()).start().unwrap();
        let mut work = Workspace::new(&column, &start.mesh).unwrap();
        linear_buckling(&mut work, Configuration::of(&start), 1).unwrap().modes[0].factor
    };
    let middle = load([0.0, 0.0], [0.25, 0.0]);
    for (lower, upper) in [([0.125, 0.125], [0.125, -0.125]), ([-0.125, -0.125], [0.375, 0.125])] {
        let found = load(lower, upper);
        assert!((found / middle - 1.0).abs() < 1e-4, "{lower:?} {upper:?}: {found} {middle}");
    }
}
