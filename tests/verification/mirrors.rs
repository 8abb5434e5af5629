//! Planes of symmetry: what is not its own mirror image is refused with its numbers, and what is, is taken.

use foldline::model::{ModelError, starting_patch, symmetric_lines};
use foldline::pipeline::Stages;
use foldline::scene::{OrthotropicLaw, Ply, Scene, Symmetry, parse};

use crate::support::{run, scene};

const LAW: OrthotropicLaw = OrthotropicLaw {
    youngs_modulus_1_mpa: 130_000.0,
    youngs_modulus_2_mpa: 9_000.0,
    poissons_ratio_12: 0.3,
    shear_modulus_12_mpa: 5_000.0,
    thermal_expansion_1_per_k: None,
    thermal_expansion_2_per_k: None,
    strengths: None,
};

fn laminate(angles: &[f64]) -> foldline::scene::Material {
    let ply = |angle_deg: &f64| Ply {
        thickness_mm: 0.16 / angles.len() as f64,
        angle_deg: *angle_deg,
        law: LAW,
        density_kg_m3: None,
    };
    foldline::scene::Material::Laminate { plies: angles.iter().map(ply).collect(), offset_mm: 0.0 }
}

fn spring(symmetry: Symmetry, angles: &[f64]) -> Result<(), ModelError> {
    let mut scene = parse(include_str!("scenes/laminate-quarter.toml"), "scene.toml").unwrap();
    (scene.symmetry, scene.material, scene.mesh.elements) = (symmetry, laminate(angles), [8, 4]);
    Stages::new(scene).start().map(|_| ())
}

/// A quarter of a plate; `tables` are its actions and further supports.
fn quarter(geometry: &str, material: &str, tables: &str) -> Scene {
    let text = format!(
        "[geometry]\n{geometry}\n[material]\n{material}\nthickness_mm = 0.5\n[mesh]\nelements = [4, 4]\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n\
         [[support]]\nname = \"middle\"\non = \"u-start\"\nkind = \"symmetric\"\n\
         [[support]]\nname = \"side\"\non = \"v-start\"\nkind = \"symmetric\"\n\
         [[probe]]\nname = \"centre\"\nkind = \"displacement\"\non = [0.0, 0.0]\ncomponent = \"z\"\n{tables}"
    );
    parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const PLATE: &str = "kind = \"plate\"\nlength_mm = 60.0\nwidth_mm = 40.0";
const ISOTROPIC: &str = "kind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3";
const HELD: &str = "[[support]]\nname = \"far\"\non = \"u-end\"\nkind = \"fixed\"\nhold = [\"z\"]\n";
const PRESSURE: &str = "[[action]]\nkind = \"pressure\"\npressure_mpa = 1e-4\n";

fn start(tables: &str) -> Result<(), ModelError> {
    Stages::new(quarter(PLATE, ISOTROPIC, tables)).start().map(|_| ())
}

#[test]
fn laminates_that_a_mirror_changes_are_refused() {
    let mirrored: [&[f64]; 6] = [&[0.0], &[90.0], &[0.0, 90.0], &[0.0, 90.0, 0.0], &[0.0, 0.0, 90.0], &[-90.0, 180.0]];
    let changed: [&[f64]; 7] = [
        &[45.0],
        &[45.0, -45.0],
        &[45.0, -45.0, -45.0, 45.0],
        &[0.0, 45.0, 90.0, -45.0],
        &[30.0, 0.0],
        &[0.0, 90.0, 1.0],
        &[2.0],
    ];
    for symmetry in [Symmetry::Quarter, Symmetry::HalfArc, Symmetry::HalfLength] {
        for angles in mirrored {
            assert_eq!(spring(symmetry, angles), Ok(()), "{angles:?} {symmetry:?}");
        }
        for angles in changed {
            let refused = spring(symmetry, angles);
            assert!(matches!(refused, Err(ModelError::MaterialNotMirrored { .. })), "{angles:?}: {refused:?}");
        }
    }
    // Antisymmetric: two layers cancel A16 and D16, four more of B16 remain.
    assert_eq!(spring(Symmetry::None, &[45.0, -45.0]), Ok(()));
    insta::assert_snapshot!(spring(Symmetry::Quarter, &[45.0, -45.0]).unwrap_err().to_string());
}

/// Fibres follow the lines of the net: bent inside, they cross the planes of symmetry at right angles where the net does.
#[test]
fn axes_of_the_material_follow_the_surface() {
    let material = "kind = \"orthotropic\"\nyoungs_modulus_1_mpa = 130000.0\nyoungs_modulus_2_mpa = 9000.0\n\
                    poissons_ratio_12 = 0.3\nshear_modulus_12_mpa = 5000.0";
    let net = |bend: f64| {
        // u runs straight off the edge at x = 0, as its plane asks, and at v = 0; inside it is bent.
        let row = |x: f64, bend: f64| {
            let y = [0.0, 13.0, 26.0, 40.0].map(|y: f64| y + bend * y / 40.0);
            y.map(|y| format!("[{x:?}, {y:?}, 0.0]")).join(", ")
        };
        let rows = [row(0.0, 0.0), row(20.0, 0.0), row(40.0, bend), row(60.0, 3.0 * bend)].join(", ");
        format!(
            "kind = \"nurbs\"\ndegrees = [3, 3]\nknots_u = [0, 0, 0, 0, 1, 1, 1, 1]\nknots_v = [0, 0, 0, 0, 1, 1, 1, 1]\n\
             control_points_mm = [{rows}]"
        )
    };
    let refused = |angle: f64| {
        let material = format!("{material}\nangle_deg = {angle:?}");
        Stages::new(quarter(&net(5.0), &material, &format!("{HELD}{PRESSURE}"))).start().err()
    };
    assert_eq!(refused(0.0), None);
    assert_eq!(refused(90.0), None);
    assert!(matches!(refused(45.0), Some(ModelError::MaterialNotMirrored { .. })));
}

#[test]
fn loads_and_motions_that_a_mirror_turns_round_are_refused() {
    let force = |on: &str, force: &str| format!("{HELD}[[action]]\nkind = \"force\"\non = {on}\nforce_n = {force}\n");
    let line = |on: &str, force: &str| {
        format!("{HELD}[[action]]\nkind = \"line-force\"\non = {on}\nforce_n_per_mm = {force}\n")
    };
    let moment = |on: &str| format!("{HELD}[[action]]\nkind = \"edge-moment\"\non = {on}\nmoment_n = 1.0\n");
    let rigid =
        |motion: &str| format!("[[support]]\nname = \"far\"\non = \"u-end\"\nkind = \"rigid\"\n{motion}\n{PRESSURE}");
    let given = |on: &str, motion: &str| {
        format!("{HELD}[[support]]\nname = \"pulled\"\non = {on}\nkind = \"displacement\"\n{motion}\n")
    };
    let taken = [
        force("[0.0, 0.5]", "[0.0, 2.0, 3.0]"),
        force("[0.5, 0.5]", "[1.0, 2.0, 3.0]"),
        force("[1.0, 0.0]", "[1.0, 0.0, 0.0]"),
        line("\"u-start\"", "[0.0, 0.0, 1.0]"),
        line("\"u-end\"", "[1.0, 0.0, 0.0]"),
        line("\"u-end\"", "[1.0, 0.0, 0.5]"),
        line("\"u=0.5\"", "[1.0, 0.0, 0.5]"),
        line("\"v=0.5\"", "[0.0, 0.5, 0.0]"),
        line("\"v-end\"", "[0.0, 0.5, 0.1]"),
        line("\"u-end\"", "1.0\nalong = \"outward\""),
        line("\"v=0.5\"", "1.0\nalong = \"normal\""),
        moment("\"u-end\""),
        rigid("z_mm = 1.0"),
        rigid("x_mm = \"free\"\nrotation_y_deg = 10.0"),
        given("\"u-end\"", "x_mm = 0.1"),
        given("[0.0, 1.0]", "y_mm = 0.1"),
    ];
    for tables in &taken {
        assert_eq!(start(tables), Ok(()), "{tables}");
    }
    let refused = [
        force("[0.0, 0.5]", "[1.0, 2.0, 3.0]"),
        force("[1.0, 0.0]", "[1.0, 0.2, 0.0]"),
        force("[0.0, 0.0]", "[0.0, 1.0, 0.0]"),
        line("\"v-start\"", "[1.0, -0.5, 0.0]"),
        line("\"u-end\"", "[1.0, 0.01, 0.0]"),
        line("\"u=0.5\"", "[0.0, 0.01, 0.0]"),
        line("\"v-end\"", "[0.1, 0.0, 0.0]"),
        line("\"v=0.5\"", "[0.1, 0.5, 0.0]"),
        moment("\"u-start\""),
        rigid("y_mm = 0.1"),
        rigid("y_mm = \"free\"\nrotation_x_deg = 10.0"),
        given("[0.0, 1.0]", "x_mm = 0.1"),
        given("\"u-end\"", "y_mm = 0.1"),
    ];
    let told = refused.map(|tables| start(&tables).expect_err(&tables).to_string());
    insta::assert_snapshot!(told.join("\n\n"));
}

/// A line that ends on a plane of symmetry bears no force across it there: a ring and a tube, held at one end and pulled at the
/// other.
#[test]
fn lines_that_end_on_a_plane_of_symmetry_bear_no_force_across_it() {
    let pulled = |geometry: &str, force: &str| {
        let text = format!(
            "[geometry]\n{geometry}\n[material]\n{ISOTROPIC}\nthickness_mm = 1.0\n[mesh]\nelements = [4, 4]\n\
             [load]\nkind = \"steps\"\nincrement = 1.0\n[[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
             [[support]]\nname = \"one\"\non = \"v-start\"\nkind = \"symmetric\"\n\
             [[support]]\nname = \"other\"\non = \"v-end\"\nkind = \"symmetric\"\n\
             [[action]]\non = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = {force}\n"
        );
        Stages::new(parse(&text, "scene.toml").unwrap()).start().map(|_| ())
    };
    let ring =
        |arc: f64| format!("kind = \"annulus\"\ninner_radius_mm = 20.0\nouter_radius_mm = 50.0\narc_deg = {arc:?}");
    let tube = "kind = \"cylinder-panel\"\nlength_mm = 100.0\nradius_mm = 50.0\narc_deg = 180.0\nfrom_deg = 0.0";
    for (geometry, force) in [
        (ring(90.0), "[0.0, 0.0, 0.1]"),
        (ring(90.0), "0.1\nalong = \"outward\""),
        (ring(70.0), "0.1\nalong = \"radial\""),
        (tube.into(), "[0.1, 0.0, 0.0]"),
        (tube.into(), "[0.0, 0.0, 0.1]"),
    ] {
        assert_eq!(pulled(&geometry, force), Ok(()), "{geometry} {force}");
    }
    for (geometry, force, support) in [
        (ring(90.0), "[0.1, 0.0, 0.0]", "other"),
        (ring(90.0), "[0.0, 0.1, 0.0]", "one"),
        (ring(70.0), "[0.01, 0.0, 0.0]", "other"),
        (tube.into(), "[0.0, 0.1, 0.0]", "one"),
    ] {
        let refused = pulled(&geometry, force);
        let on = |error: &ModelError| matches!(error, ModelError::LoadNotMirrored { support: found, .. } if found == support);
        assert!(refused.as_ref().is_err_and(on), "{geometry} {force}: {refused:?}");
    }
}

/// A pull beside a plane of symmetry is taken, and what its image does is said.
#[test]
fn what_the_image_of_a_pull_does_is_said() {
    let said = |force: &str| {
        let action =
            format!("[[action]]\nname = \"pull\"\non = \"v=0.5\"\nkind = \"line-force\"\nforce_n_per_mm = {force}\n");
        let mut stages = Stages::new(quarter(PLATE, ISOTROPIC, &format!("{HELD}{action}")));
        let start = stages.start().unwrap();
        stages.remarks(&start).unwrap().join("; ")
    };
    assert_eq!(
        said("[0.0, -0.5, 0.1]"),
        "action \"pull\" has 0.5 N/mm across the plane of symmetry of support \"side\": its image behind that pulls in the opposite direction"
    );
    assert_eq!(said("[0.0, 0.0, 0.1]"), "");
}

/// Corners of a quarter plate, mm, in the order of its net.
fn corners(off: [[f64; 3]; 4]) -> String {
    let exact = [[0.0, 0.0, 0.0], [0.0, 40.0, 0.0], [60.0, 0.0, 0.0], [60.0, 40.0, 0.0]];
    let points = [0, 1, 2, 3].map(|k| {
        let [x, y, z] = [0, 1, 2].map(|c| exact[k][c] + off[k][c]);
        format!("[{x:?}, {y:?}, {z:?}]")
    });
    format!(
        "kind = \"nurbs\"\ndegrees = [1, 1]\nknots_u = [0.0, 0.0, 1.0, 1.0]\nknots_v = [0.0, 0.0, 1.0, 1.0]\n\
         control_points_mm = [{}]",
        points.join(", ")
    )
}

/// Corners off by what five digits round away: the deflection of the centre is off by no more than the area is.
#[test]
fn rounding_of_coordinates_is_taken_and_does_no_harm() {
    let tables = format!("{HELD}{PRESSURE}");
    let centre = |off: [[f64; 3]; 4]| {
        let (_, record) = run(quarter(&corners(off), ISOTROPIC, &tables)).pop().unwrap();
        record.report.probes[0].value
    };
    let exact = centre([[0.0; 3]; 4]);
    for off in [
        [[0.0; 3], [0.0; 3], [0.0; 3], [0.0, 1e-7, 0.0]],
        [[0.002, 0.0, 0.0], [-0.002, 0.001, 0.0], [0.0, 0.002, 0.002], [0.002, -0.002, 0.0]],
        [[0.0, 0.003, 0.0], [0.003, 0.0, 0.0], [0.0, -0.003, 0.0], [0.003, 0.0, 0.0]],
    ] {
        let found = centre(off);
        assert!((found / exact - 1.0).abs() < 3e-4, "{off:?}: {found} for {exact}");
    }
    let given = run(parse(include_str!("scenes/symmetry-tolerance.toml"), "scene.toml").unwrap());
    assert!(given.last().unwrap().1.report.strain_energy_n_mm > 0.0);
}

#[test]
fn edges_that_are_no_mirrors_are_told_with_angle_and_distance() {
    let tables = format!("{HELD}{PRESSURE}");
    let start = |geometry: &str| Stages::new(quarter(geometry, ISOTROPIC, &tables)).start().unwrap_err().to_string();
    let leaves = "kind = \"nurbs\"\ndegrees = [1, 3]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 0, 0, 1, 1, 1, 1]\n\
                  control_points_mm = [[0, 0, 0], [0.1, 13, 0], [0, 26, 0.2], [0, 40, 0], \
                  [60, 0, 0], [60.1, 13, 0], [60, 26, 0.2], [60, 40, 0]]";
    let told = [
        start(&corners([[0.0; 3], [0.5, 0.0, 0.0], [0.0; 3], [0.5, 0.0, 0.0]])),
        start(&corners([[0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])),
        start(&corners([[0.0; 3], [0.0; 3], [0.0; 3], [0.0, 2.0, 0.0]])),
        start(leaves),
    ];
    insta::assert_snapshot!(told.join("\n\n"));
}

/// The lips of a slit lie in one place, and are two: what holds the one and pulls the other is no mirror image.
#[test]
fn lips_of_a_slit_are_told_apart() {
    let text = include_str!("../../pipelines/verification/slit-annular-plate.toml");
    let plane = "[[support]]\nname = \"plane\"\non = \"v=0.5\"\nkind = \"symmetric\"\n\n[[action]]";
    let scene = parse(&text.replace("[[action]]", plane), "slit.toml").unwrap();
    let refused = Stages::new(scene).start().unwrap_err().to_string();
    assert!(refused.contains("support \"clamped lip\" has no mirror image on the other side"), "{refused}");
}

/// In which lines a shell is symmetric is found without asking for a plane of symmetry, and is what asking for one would find.
#[test]
fn symmetric_lines_are_found() {
    let lines = |name: &str| {
        let scene = scene(name);
        symmetric_lines(&scene, &starting_patch(&scene).unwrap())
    };
    assert_eq!(lines("baseline.toml"), [true, true]);
    assert_eq!(lines("baseline-quarter.toml"), [false, false], "what is cut is not symmetric again");
    assert_eq!(lines("verification/hinged-roof-12.7.toml"), [true, true]);
    assert_eq!(lines("verification/rolled-cantilever.toml"), [false, true]);
    assert_eq!(lines("verification/slit-annular-plate.toml"), [false, false]);
    assert_eq!(lines("verification/laminated-plate.toml"), [false, false]);
}

/// The shipped quarter models are mirror images.
#[test]
fn shipped_quarters_are_taken() {
    for name in ["baseline-quarter.toml", "extreme/laminate-1000-crossed.toml", "extreme/arc-350.toml"] {
        Stages::new(scene(name)).start().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}
