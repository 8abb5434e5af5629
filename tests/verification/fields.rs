//! Fields against closed forms: pressurised tube, rolled strip, plate bending, a laminate under given strains and under forces and
//! moments that break it, images in planes of symmetry.

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

fn fields_in<'a>(scene: &'a Scene, state: &'a State) -> ShellFields<'a> {
    ShellFields::new(scene, state.mesh.lone(), &state.displacement, state.parameter)
}

fn value(scene: &Scene, state: &State, name: &str, at: [f64; 2]) -> [f64; 3] {
    fields_in(scene, state).at(at).value(&field(scene, name))
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

/// A plate of 10 × 6 mm with u = (e x + g y, f y) and w = ½ k x² + ½ l y² + c x y, which one biquadratic element shows exactly; at
/// the corner the slopes of w are zero.
fn strained(plate: &Scene, [e, f, g]: [f64; 3], [k, l, c]: [f64; 3]) -> State {
    let mut state = State::undeformed(starting_mesh(plate).unwrap());
    let corner = state.mesh.point(0);
    let places: Vec<[f64; 2]> = state.mesh.points().map(|[x, y, _]| [x - corner[0], y - corner[1]]).collect();
    // The Bézier coefficients of x² on [0, a] are 0, 0, a².
    let squared = |place: f64, side: f64| if place > 0.9 * side { side * side } else { 0.0 };
    let moved = |[x, y]: &[f64; 2]| {
        let w = 0.5 * k * squared(*x, 10.0) + 0.5 * l * squared(*y, 6.0) + c * x * y;
        [e * x + g * y, f * y, w]
    };
    state.displacement = places.iter().map(moved).collect();
    state
}

/// The same with these Green–Lagrange strains ε₁₁, ε₂₂, 2ε₁₂ and changes of curvature κ₁₁, κ₂₂, 2κ₁₂ at the corner.
fn under(plate: &Scene, [e11, e22, shear]: [f64; 3], [k11, k22, twice_k12]: [f64; 3]) -> State {
    let e = (1.0 + 2.0 * e11).sqrt() - 1.0;
    let g = shear / (1.0 + e);
    let f = (1.0 + 2.0 * e22 - g * g).sqrt() - 1.0;
    // κ = B − b, and b is that of a surface whose normal is +z.
    strained(plate, [e, f, g], [-k11, -k22, -0.5 * twice_k12])
}

#[test]
fn a_laminate_under_given_strains() {
    let laminate = parse(LAMINATE, "laminate").unwrap();
    let [e, f, g, k, l, c] = [1e-5, -2e-5, 3e-5, 2e-4, -1e-4, 5e-5];
    let state = strained(&laminate, [e, f, g], [k, l, c]);
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

const STRENGTHS: &str = "tensile_strength_1_mpa = 1500.0\ncompressive_strength_1_mpa = 1200.0\n\
    tensile_strength_2_mpa = 50.0\ncompressive_strength_2_mpa = 200.0\nshear_strength_12_mpa = 80.0\n";
const XT: f64 = 1500.0;
const XC: f64 = 1200.0;
const YT: f64 = 50.0;
const YC: f64 = 200.0;
const S: f64 = 80.0;

/// R of Tsai and Wu's criterion: how much larger stresses lie on the surface F = 1, by halving.
fn reserve([s1, s2, s12]: [f64; 3]) -> f64 {
    let (f11, f22) = (1.0 / (XT * XC), 1.0 / (YT * YC));
    let exceeds = |r: f64| {
        let linear = (1.0 / XT - 1.0 / XC) * s1 + (1.0 / YT - 1.0 / YC) * s2;
        let quadratic = f11 * s1 * s1 + f22 * s2 * s2 - (f11 * f22).sqrt() * s1 * s2 + s12 * s12 / (S * S);
        r * linear + r * r * quadratic > 1.0
    };
    let halve = |[low, high]: [f64; 2], _| {
        let middle = 0.5 * (low + high);
        if exceeds(middle) { [low, middle] } else { [middle, high] }
    };
    (0..100).fold([0.0, 1e6], halve)[0]
}

/// One layer under each of its strengths alone: both criteria say 1.
#[test]
fn a_layer_fails_at_its_strengths() {
    let (e1, e2, nu, g) = (128e3, 6.5e3, 0.35, 7.5e3);
    for angle in [0.0, 90.0] {
        let moduli = LAMINATE.split("[material]").nth(1).unwrap().split("[[ply]]").next().unwrap();
        let layer = LAMINATE.split("[material]").next().unwrap().to_owned()
            + "[material]"
            + &moduli.replace("laminate", "orthotropic")
            + STRENGTHS
            + &format!("thickness_mm = 0.1\nangle_deg = {angle:?}\n[mesh]")
            + LAMINATE.split("[mesh]").nth(1).unwrap();
        let layer = parse(&layer, "layer").unwrap();
        for stress in [[XT, 0.0, 0.0], [-XC, 0.0, 0.0], [0.0, YT, 0.0], [0.0, -YC, 0.0], [0.0, 0.0, S]] {
            let own = [stress[0] / e1 - nu * stress[1] / e1, stress[1] / e2 - nu * stress[0] / e1, stress[2] / g];
            let strain = if angle == 0.0 { own } else { [own[1], own[0], -own[2]] };
            let state = under(&layer, strain, [0.0; 3]);
            assert_close(value(&layer, &state, "failure_tsai_wu", [0.0; 2])[0], 1.0, 1.0, "Tsai and Wu");
            assert_close(value(&layer, &state, "failure_max_strain", [0.0; 2])[0], 1.0, 1.0, "maximum strain");
        }
    }
}

/// [0/90]s under n and m: stresses of every ply by lamination theory, as by hand.
#[test]
fn plies_fail_under_forces_and_moments() {
    let laminate = parse(&LAMINATE.replacen("[[ply]]", &format!("{STRENGTHS}[[ply]]"), 1), "laminate").unwrap();
    let (e1, e2, nu, g, t) = (128e3, 6.5e3, 0.35, 7.5e3, 0.01775);
    let scale = 1.0 / (1.0 - nu * nu * e2 / e1);
    let (q11, q22, q12) = (scale * e1, scale * e2, scale * nu * e2);
    // Of the plies at 0° (outside) and 90° (inside), by their shares of 4 t and of 16 t³/3 = (4 t)³/12.
    let (a11, a12, a66) = (2.0 * t * (q11 + q22), 4.0 * t * q12, 4.0 * t * g);
    let inertia = 16.0 * t * t * t / 3.0;
    let (d11, d22) = (inertia * (7.0 * q11 + q22) / 8.0, inertia * (q11 + 7.0 * q22) / 8.0);
    let (d12, d66) = (inertia * q12, inertia * g);
    let ([n1, n2, n12], [m1, m2, m12]) = ([12.0, -3.0, 1.5], [0.2, 0.05, 0.03]);
    let solved =
        |a: f64, b: f64, c: f64, x: f64, y: f64| [(c * x - b * y) / (a * c - b * b), (a * y - b * x) / (a * c - b * b)];
    let ([x1, x2], [k1, k2]) = (solved(a11, a12, a11, n1, n2), solved(d11, d12, d22, m1, m2));
    let (strain, bending) = ([x1, x2, n12 / a66], [k1, k2, m12 / d66]);
    let state = under(&laminate, strain, bending);
    let at = [0.0; 2];
    for (c, expected) in [n1, n2, n12].into_iter().enumerate() {
        assert_close(value(&laminate, &state, "membrane_force", at)[c], expected, n1, "membrane force");
    }
    for (c, expected) in [m1, m2, m12].into_iter().enumerate() {
        assert_close(value(&laminate, &state, "bending_moment", at)[c], expected, m1, "bending moment");
    }
    let (mut nearest, mut most_strained) = (0.0_f64, 0.0_f64);
    for ply in 0..4 {
        let (mut tsai_wu, mut max_strain) = (0.0_f64, 0.0_f64);
        for height in [t * (ply as f64 - 2.0), t * (ply as f64 - 1.0)] {
            let [xx, yy, shear] = [0, 1, 2].map(|i| strain[i] + height * bending[i]);
            let [e_1, e_2, e_12] = if ply == 0 || ply == 3 { [xx, yy, shear] } else { [yy, xx, -shear] };
            let stress = [q11 * e_1 + q12 * e_2, q12 * e_1 + q22 * e_2, g * e_12];
            tsai_wu = tsai_wu.max(1.0 / reserve(stress));
            let along = e_1 * e1 / if e_1 > 0.0 { XT } else { -XC };
            let across = e_2 * e2 / if e_2 > 0.0 { YT } else { -YC };
            max_strain = max_strain.max(along).max(across).max((e_12 * g / S).abs());
        }
        let own = |name: &str| value(&laminate, &state, &format!("ply_{}_failure_{name}", ply + 1), at)[0];
        assert_close(own("tsai_wu"), tsai_wu, tsai_wu, "Tsai and Wu");
        assert_close(own("max_strain"), max_strain, max_strain, "maximum strain");
        (nearest, most_strained) = (nearest.max(tsai_wu), most_strained.max(max_strain));
    }
    assert_close(value(&laminate, &state, "failure_tsai_wu", at)[0], nearest, nearest, "Tsai and Wu of all plies");
    let found = value(&laminate, &state, "failure_max_strain", at)[0];
    assert_close(found, most_strained, most_strained, "maximum strain of all plies");
}

/// Where nothing can expand, a ply has the stresses of its own expansion, whatever the others do.
#[test]
fn plies_fail_by_heat_alone() {
    let (e1, e2, nu, alpha, change) = (128e3, 6.5e3, 0.35, [0.02e-6, 22.5e-6], -120.0);
    let expansion = "thermal_expansion_1_per_k = 0.02e-6\nthermal_expansion_2_per_k = 22.5e-6\n";
    let heated = LAMINATE
        .replacen("[[ply]]", &format!("{STRENGTHS}{expansion}[[ply]]"), 1)
        .replace("kind = \"pressure\"\npressure_mpa = 1e-6", "kind = \"temperature\"\nchange_k = -120.0");
    let heated = parse(&heated, "heated").unwrap();
    let mut state = State::undeformed(starting_mesh(&heated).unwrap());
    let scale = 1.0 / (1.0 - nu * nu * e2 / e1);
    let along = -scale * (e1 * alpha[0] + nu * e2 * alpha[1]) * change;
    let across = -scale * (nu * e2 * alpha[0] + e2 * alpha[1]) * change;
    for factor in [1.0, 0.5] {
        state.parameter = factor;
        for name in ["ply_1_failure_tsai_wu", "ply_3_failure_tsai_wu", "failure_tsai_wu"] {
            let expected = factor / reserve([along, across, 0.0]);
            assert_close(value(&heated, &state, name, [0.3, 0.6])[0], expected, expected, name);
        }
        let strained = -alpha[1] * change * e2 / YT * factor;
        assert_close(value(&heated, &state, "failure_max_strain", [0.3, 0.6])[0], strained, strained, "maximum strain");
    }
}

/// Fields of failure are there where strengths are: of a laminate as a whole where every ply has them.
#[test]
fn failure_needs_strengths() {
    let names = |text: &str| {
        let fields = fields_of(&parse(text, "laminate").unwrap()).into_iter().map(|field| field.name);
        fields.filter(|name| name.contains("failure")).collect::<Vec<_>>()
    };
    assert!(names(LAMINATE).is_empty());
    let one_ply =
        LAMINATE.replace("thickness_mm = 0.01775\n[mesh]", &format!("thickness_mm = 0.01775\n{STRENGTHS}[mesh]"));
    assert_eq!(names(&one_ply), ["ply_4_failure_tsai_wu", "ply_4_failure_max_strain"]);
    let all = LAMINATE.replacen("[[ply]]", &format!("{STRENGTHS}[[ply]]"), 1);
    assert_eq!(names(&all).len(), 10);
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
    let (all, part) = (fields_in(&whole, &of_whole), fields_in(&quarter, &of_quarter));
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
