//! Fields against closed forms: pressurised tube, rolled strip, plate bending, a laminate under given strains, images in planes of
//! symmetry.

use foldline::model::starting_mesh;
use foldline::scene::{Scene, Symmetry, parse};
use foldline::state::State;
use foldline::view::{Field, ShellFields, fields_of};

use crate::benchmarks::read;
use crate::support::{run, scene};

/// What the closed forms are met to.
const CLOSE: f64 = 1e-3;

fn field(scene: &Scene, name: &str) -> Field {
    fields_of(scene).into_iter().find(|field| field.name == name).unwrap_or_else(|| panic!("there is no {name}"))
}

fn value(scene: &Scene, state: &State, name: &str, at: [f64; 2]) -> [f64; 3] {
    ShellFields::new(scene, state).at(at).value(&field(scene, name))
}

fn assert_close(found: f64, expected: f64, scale: f64, what: &str) {
    assert!((found - expected).abs() < CLOSE * scale.abs(), "{what}: {found} for {expected}");
}

/// Hoop force p R, hoop strain p R/(E t), axial strain −ν times that, energy ½ p² R²/(E t) per area.
#[test]
fn a_tube_under_pressure() {
    let (e, nu, t, r, p) = (70e3, 0.3, 0.1, 10.0, 0.01);
    let tube = parse(
        "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 24.0\nradius_mm = 10.0\narc_deg = 90.0\n\
         [[support]]\non = \"v-start\"\nkind = \"symmetric\"\n[[support]]\non = \"v-end\"\nkind = \"symmetric\"\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.1\n\
         [mesh]\ndegree = [3, 3]\nelements = [2, 8]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = 0.01\n",
        "tube",
    )
    .unwrap();
    let state = run(tube.clone()).pop().unwrap().0;
    let (force, strain) = (p * r, p * r / (e * t));
    for at in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.75]] {
        let [n11, n22, n12] = value(&tube, &state, "membrane_force", at);
        assert_close(n22, force, force, "hoop force");
        assert_close(n11, 0.0, force, "axial force");
        assert_close(n12, 0.0, force, "shear");
        let [e11, e22, _] = value(&tube, &state, "membrane_strain", at);
        assert_close(e22, strain, strain, "hoop strain");
        assert_close(e11, -nu * strain, strain, "axial strain");
        let [largest, least, _] = value(&tube, &state, "membrane_force_principal", at);
        assert_close(largest, force, force, "largest force");
        assert_close(least, 0.0, force, "least force");
        let [energy, ..] = value(&tube, &state, "energy_density", at);
        assert_close(energy, 0.5 * force * strain, force * strain, "energy");
        let [x, y, z] = value(&tube, &state, "displacement", at);
        let axial = -nu * strain * 24.0 * at[0];
        assert_close(x.hypot(y.hypot(z)), (strain * r).hypot(axial), strain * r, "displacement");
    }
    assert_eq!(value(&tube, &state, "thickness", [0.5, 0.5])[0], t);
    assert_close(value(&tube, &state, "element_size", [0.1, 0.9])[0], 12.0, 12.0, "element along");
    let size_at = |element: usize| value(&tube, &state, "element_size", [0.1, (element as f64 + 0.5) / 8.0])[1];
    let arc = 0.5 * std::f64::consts::PI * r;
    assert_close((0..8).map(size_at).sum(), arc, arc, "the elements across");
}

/// A strip of D = 100 N·mm rolled up by a moment of 52.36 N: κ = M/D everywhere, whatever it has turned.
#[test]
fn a_rolled_strip() {
    let mut strip = read("rolled-cantilever");
    strip.mesh.degree = [5, 3];
    let state = run(strip.clone()).pop().unwrap().0;
    let (moment, stiffness) = (52.35987755982988, 100.0);
    for at in [[0.03, 0.5], [0.5, 0.1], [0.97, 0.9]] {
        let [m11, m22, m12] = value(&strip, &state, "bending_moment", at);
        assert_close(m11.abs(), moment, moment, "moment");
        assert_close(m22.abs().max(m12.abs()), 0.0, moment, "other moments");
        let [k11, ..] = value(&strip, &state, "bending_strain", at);
        assert_close(k11.abs(), moment / stiffness, moment / stiffness, "curvature");
        assert_eq!(k11.signum(), m11.signum());
        let [energy, ..] = value(&strip, &state, "energy_density", at);
        assert_close(energy, 0.5 * moment * moment / stiffness, 0.5 * moment * moment / stiffness, "energy");
        let [indicator, _, _] = value(&strip, &state, "indicator", at);
        assert_close(indicator, k11.abs() * 12.0 / 16.0, indicator, "indicator");
        let [largest, ..] = value(&strip, &state, "bending_strain_max", at);
        assert_close(largest, k11.abs(), k11, "largest bending strain");
    }
}

/// [0/90]s of 71 µm (E₁ 128, E₂ 6.5, G₁₂ 7.5 GPa, ν₁₂ 0.35): A₁₁ = A₂₂ 4804.6, A₁₂ 162.5, A₆₆ 532.5 N/mm, D₁₁ 3.3858, D₁₂ 0.06828, D₂₂
/// 0.6509, D₆₆ 0.2237 N·mm.
const LAMINATE: &str = "[geometry]\nkind = \"plate\"\nlength_mm = 10.0\nwidth_mm = 6.0\n\
    [material]\nkind = \"laminate\"\nyoungs_modulus_1_mpa = 128000.0\nyoungs_modulus_2_mpa = 6500.0\n\
    poissons_ratio_12 = 0.35\nshear_modulus_12_mpa = 7500.0\n\
    [[ply]]\nthickness_mm = 0.01775\n[[ply]]\nthickness_mm = 0.01775\nangle_deg = 90.0\n\
    [[ply]]\nthickness_mm = 0.01775\nangle_deg = 90.0\n[[ply]]\nthickness_mm = 0.01775\n\
    [mesh]\ndegree = [2, 2]\nelements = [1, 1]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
    [[support]]\non = \"u-start\"\nkind = \"clamped\"\n[[action]]\nkind = \"pressure\"\npressure_mpa = 1e-6\n";

/// Given u = (e x + g y, f y) and w = ½ k x² + ½ l y² + c x y, which one biquadratic element shows exactly, at the corner where the
/// slopes of w are zero.
#[test]
fn a_laminate_under_given_strains() {
    let laminate = parse(LAMINATE, "laminate").unwrap();
    let mut state = State::undeformed(starting_mesh(&laminate).unwrap());
    let [e, f, g, k, l, c] = [1e-5, -2e-5, 3e-5, 2e-4, -1e-4, 5e-5];
    let corner = state.mesh.point(0);
    let places: Vec<[f64; 2]> = state.mesh.points().map(|[x, y, _]| [x - corner[0], y - corner[1]]).collect();
    // The Bézier coefficients of x² on [0, a] are 0, 0, a².
    let squared = |place: f64, side: f64| if place > 0.9 * side { side * side } else { 0.0 };
    state.displacement = places
        .iter()
        .map(|[x, y]| {
            let w = 0.5 * k * squared(*x, 10.0) + 0.5 * l * squared(*y, 6.0) + c * x * y;
            [e * x + g * y, f * y, w]
        })
        .collect();
    let at = [0.0, 0.0];
    let [e11, e22, shear] = [e, f, g];
    let [n11, n22, n12] = value(&laminate, &state, "membrane_force", at);
    assert_close(n11, 4804.6 * e11 + 162.5 * e22, 0.05, "n11");
    assert_close(n22, 4804.6 * e22 + 162.5 * e11, 0.1, "n22");
    assert_close(n12, 532.5 * shear, 532.5 * shear, "n12");
    // The normal is +z, and κ = B − b.
    let [k11, k22, twice_k12] = [-k, -l, -2.0 * c];
    let [m11, m22, m12] = value(&laminate, &state, "bending_moment", at);
    assert_close(m11, 3.3858 * k11 + 0.06828 * k22, 3.3858 * k11, "m11");
    assert_close(m22, 0.06828 * k11 + 0.6509 * k22, 0.6509 * k22, "m22");
    assert_close(m12, 0.2237 * twice_k12, 0.2237 * twice_k12, "m12");
    // The top ply has its fibres along u, that below it across; bending takes from these strains, more so at the upper face.
    let [fibre, across, in_shear] = value(&laminate, &state, "ply_4_strain", at);
    assert_close(fibre, e11 + 0.01775 * k11, 1e-5, "along the fibres of ply 4");
    assert_close(across, e22 + 0.01775 * k22, 2e-5, "across those of ply 4");
    assert_close(in_shear, shear + 0.01775 * twice_k12, 3e-5, "shear of ply 4");
    let [fibre, ..] = value(&laminate, &state, "ply_3_strain", at);
    assert_close(fibre, e22, 2e-5, "along the fibres of ply 3");
}

/// Moments of Navier's plate under an even pressure: at the middle of a simply supported square D (κ₁₁ + ν κ₂₂) = 0.0479 p a²
/// (Timoshenko & Woinowsky-Krieger, *Theory of Plates and Shells*, table 8).
#[test]
fn a_plate_under_pressure() {
    let plate = parse(
        "[geometry]\nkind = \"plate\"\nlength_mm = 50.0\nwidth_mm = 50.0\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 1.0\n\
         [mesh]\ndegree = [4, 4]\nelements = [8, 8]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[support]]\non = \"u-start\"\nkind = \"symmetric\"\n[[support]]\non = \"v-start\"\nkind = \"symmetric\"\n\
         [[support]]\non = \"u-end\"\nkind = \"fixed\"\nhold = [\"z\"]\n[[support]]\non = \"v-end\"\nkind = \"fixed\"\nhold = [\"z\"]\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = 1e-5\nfollower = false\n",
        "plate",
    )
    .unwrap();
    let state = run(plate.clone()).pop().unwrap().0;
    let expected = 0.0479 * 1e-5 * 100.0 * 100.0;
    let [m11, m22, _] = value(&plate, &state, "bending_moment", [0.0, 0.0]);
    assert_close(m11.abs(), expected, expected, "m11");
    assert_close(m22, m11, expected, "m22");
}

/// A quarter of the spring has, with its images, the fields of the whole; its arc has other parameters, but for apex and edge, and so
/// another error of the mesh.
#[test]
fn images_continue_the_fields() {
    let bent = |symmetry: Symmetry, elements: [usize; 2]| {
        let mut bent = scene("baseline-quarter.toml");
        (bent.symmetry, bent.mesh.elements, bent.mesh.degree) = (symmetry, elements, [4, 5]);
        bent.load.set_target(2.0);
        (bent.adapt, bent.pipeline) = (None, vec![foldline::scene::Stage::Solve]);
        let state = run(bent.clone()).pop().unwrap().0;
        (bent, state)
    };
    let (whole, of_whole) = bent(Symmetry::None, [16, 8]);
    let (quarter, of_quarter) = bent(Symmetry::Quarter, [16, 8]);
    let (all, part) = (ShellFields::new(&whole, &of_whole), ShellFields::new(&quarter, &of_quarter));
    // The whole one is held at another place along x.
    let names = ["displacement", "membrane_force", "bending_moment", "membrane_strain", "bending_moment_principal"];
    for (name, field) in names.map(|name| (name, field(&quarter, name))) {
        let grid = (0..121).map(|k| [(k / 11) as f64 / 10.0, (k % 11) as f64 / 10.0]);
        let ranges = part.range(&field, grid).unwrap();
        let scale = ranges.as_flattened().iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for at in [[0.4, 0.0], [0.6, 1.0], [0.6, 0.0]] {
            let own = part.at(at).value(&field);
            let [u, v] = [0.5 * at[0], 0.5 + 0.5 * at[1]];
            let images = [
                ([u, v], own),
                ([1.0 - u, v], field.mirrored(own, 0)),
                ([u, 1.0 - v], field.mirrored(own, 1)),
                ([1.0 - u, 1.0 - v], field.mirrored(field.mirrored(own, 0), 1)),
            ];
            for (place, expected) in images {
                let found = all.at(place).value(&field);
                for c in usize::from(name == "displacement")..field.components.len() {
                    assert!(
                        (found[c] - expected[c]).abs() < 0.01 * scale,
                        "{name} at {place:?}: {found:?} for {expected:?}"
                    );
                }
            }
        }
    }
}
