//! What a user sees of a wrong scene. Every case is one slip in a scene that is right; its error is pinned.

use foldline::scene::{SceneError, help_text, parse, parse_with_settings};

const RIGHT: &str = r#"# A tape spring.
[geometry]
kind = "tape-spring"
length_mm = 300.0
radius_mm = 10.0
arc_deg = 110.0

[material]
kind = "isotropic"
youngs_modulus_mpa = 131000.0
poissons_ratio = 0.3
thickness_mm = 0.1

[mesh]
degree = [3, 3]
elements = [4, 4]
quadrature = "full"

[symmetry]
part = "quarter"

[load]
kind = "end-rotation"
sense = "opposite"
rotation_deg = 60.0
increment_deg = 0.4

[adapt]
threshold = 0.019
length_limit = "sqrt-radius-thickness"

[solver]
tolerance = 1e-7
max_iterations = 100
least_increment_deg = 1e-6
snap_tolerance_deg = 0.01

[pipeline]
stages = ["solve", "evaluate-indicators", "refine-knots", "project-displacements", "re-equilibrate"]

[output]
sync = "each-second"
mesh_history = false
"#;

/// The errors that some slips lead to: each replaces a text that occurs once.
fn errors(slips: &[(&str, &str)]) -> String {
    let show = |(right, wrong): &(&str, &str)| {
        assert_eq!(RIGHT.matches(right).count(), 1, "`{right}` does not name one place");
        let text = RIGHT.replace(right, wrong);
        match parse(&text, "scene.toml") {
            Ok(_) => panic!("`{wrong}` is taken"),
            Err(error) => report(&error),
        }
    };
    slips.iter().map(show).collect::<Vec<_>>().join("\n")
}

/// The errors that some settings on the right scene lead to.
fn setting_errors(settings: &[&str]) -> String {
    let show = |setting: &&str| match parse_with_settings(RIGHT, "scene.toml", &[setting]) {
        Ok(_) => panic!("`{setting}` is taken"),
        Err(error) => report(&error),
    };
    settings.iter().map(show).collect::<Vec<_>>().join("\n")
}

fn report(error: &SceneError) -> String {
    let plain = error.plain();
    assert!(plain.contains(&format!("{}:{}:", error.source_name(), error.line())), "{plain}");
    let without_colour = strip_colour(&error.coloured());
    assert!(without_colour.contains(&error.summary()) && plain.contains(&error.summary()));
    plain + "\n"
}

fn strip_colour(text: &str) -> String {
    let mut parts = text.split('\x1b');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |plain, part| plain + part.split_once('m').map_or("", |(_, rest)| rest))
}

/// Compares a text with the accepted one.
fn pin(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.set_prepend_module_to_snapshot(false);
    settings.set_snapshot_path("scene_errors");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

#[test]
fn the_scene_is_right() {
    parse(RIGHT, "scene.toml").unwrap();
}

#[test]
fn names() {
    pin(
        "names",
        &errors(&[
            ("length_mm = 300.0", "lenght_mm = 300.0"),
            ("length_mm = 300.0", "width_mm = 300.0\nlength_mm = 300.0"),
            ("arc_deg = 110.0", "arc_deg = 110.0\nthickness_mm = 0.1"),
            ("arc_deg = 110.0", "alpha = 110.0"),
            ("youngs_modulus_mpa", "E"),
            ("poissons_ratio", "nu"),
            ("threshold = 0.019", "r0 = 0.019"),
            ("mesh_history", "mesh-history"),
            ("tolerance = 1e-7", "tolerance = 1e-7\nmax_iter = 50\nbanana = 1"),
            ("[output]", "[output]\ncolour = true"),
            ("part = \"quarter\"", "half = true"),
            ("[material]", "[materail]"),
            ("[solver]", "[newton]"),
            ("[solver]", "[solver.newton]\nx = 1\n[solver]"),
            ("# A tape spring.", "length_mm = 300.0"),
            ("# A tape spring.", "banana = 1"),
            ("[symmetry]\npart = \"quarter\"\n", "[mesh.symmetry]\n"),
            ("length_mm = 300.0", "length_m = 0.3\nlength_mm = 300.0"),
        ]),
    );
}

#[test]
fn units() {
    pin(
        "units",
        &errors(&[
            ("length_mm = 300.0", "length_m = 0.3"),
            ("length_mm = 300.0", "length_cm = 30"),
            ("length_mm = 300.0", "length = 300.0"),
            ("length_mm = 300.0", "length_millimetres = 300.0"),
            ("radius_mm = 10.0", "radius_inch = 0.4"),
            ("thickness_mm = 0.1", "thikness_um = 100"),
            ("arc_deg = 110.0", "arc_rad = 1.92"),
            ("youngs_modulus_mpa = 131000.0", "youngs_modulus_gpa = 131"),
            ("youngs_modulus_mpa = 131000.0", "E_GPa = 131"),
            ("length_mm = 300.0", "length_mm = \"0.3 m\""),
            ("length_mm = 300.0", "length_m = \"long\""),
            ("youngs_modulus_mpa = 131000.0", "youngs_modulus_mpa = 131e15"),
        ]),
    );
}

#[test]
fn missing() {
    pin(
        "missing",
        &errors(&[
            ("radius_mm = 10.0\n", ""),
            ("increment_deg = 0.4\n\n", "\n"),
            ("kind = \"isotropic\"\n", ""),
            ("[load]\nkind = \"end-rotation\"\nsense = \"opposite\"\nrotation_deg = 60.0\nincrement_deg = 0.4\n\n", ""),
            (
                "[geometry]\nkind = \"tape-spring\"\nlength_mm = 300.0\nradius_mm = 10.0\narc_deg = 110.0\n",
                "geometry = { kind = \"tape-spring\", length_mm = 300.0 }\n",
            ),
        ]),
    );
    let outside = RIGHT.replace("[symmetry]\npart = \"quarter\"\n", "");
    let stray = parse(&format!("symmetry = \"quarter\"\n{outside}"), "scene.toml").unwrap_err();
    pin("value_for_table", &report(&stray));
    let empty = parse("", "empty.toml").unwrap_err();
    pin("missing_everything", &report(&empty));
}

#[test]
fn types() {
    pin(
        "types",
        &errors(&[
            ("length_mm = 300.0", "length_mm = \"300\""),
            ("length_mm = 300.0", "length_mm = [300.0]"),
            ("length_mm = 300.0", "length_mm = true"),
            ("length_mm = 300.0", "length_mm = 1979-05-27"),
            ("elements = [4, 4]", "elements = [4.0, 4.0]"),
            ("elements = [4, 4]", "elements = [4, 4.5]"),
            ("elements = [4, 4]", "elements = [4, 4, 4]"),
            ("elements = [4, 4]", "elements = [4, \"4\"]"),
            ("elements = [4, 4]", "elements = { length = 4, arc = 4 }"),
            ("max_iterations = 100", "max_iterations = 1e2"),
            ("mesh_history = false", "mesh_history = \"no\""),
            ("mesh_history = false", "mesh_history = 1"),
            ("sense = \"opposite\"", "sense = -1"),
            ("length_limit = \"sqrt-radius-thickness\"", "length_limit = 1.0"),
            ("[output]\nsync = \"each-second\"\nmesh_history = false", "[[output]]\nsync = \"each-second\""),
        ]),
    );
}

#[test]
fn words() {
    pin(
        "words",
        &errors(&[
            ("sense = \"opposite\"", "sense = \"oposite\""),
            ("sense = \"opposite\"", "sense = \"Equal\""),
            ("sense = \"opposite\"", "sense = \"up\""),
            ("kind = \"tape-spring\"", "kind = \"boom\""),
            ("part = \"quarter\"", "part = \"half\""),
            ("quadrature = \"full\"", "quadrature = \"gauss\""),
            ("sync = \"each-second\"", "sync = \"each_stage\""),
        ]),
    );
}

#[test]
fn numbers() {
    pin(
        "numbers",
        &errors(&[
            ("length_mm = 300.0", "length_mm = -300.0"),
            ("length_mm = 300.0", "length_mm = nan"),
            ("length_mm = 300.0", "length_mm = 1e400"),
            ("length_mm = 300.0", "length_mm = 3e6"),
            ("radius_mm = 10.0", "radius_mm = -inf"),
            ("thickness_mm = 0.1", "thickness_mm = 0"),
            ("thickness_mm = 0.1", "thickness_mm = 10.0"),
            ("poissons_ratio = 0.3", "poissons_ratio = 0.5"),
            ("poissons_ratio = 0.3", "poissons_ratio = -1"),
            ("arc_deg = 110.0", "arc_deg = 360"),
            ("arc_deg = 110.0", "arc_deg = 0.0"),
            ("degree = [3, 3]", "degree = 1"),
            ("degree = [3, 3]", "degree = [3, 6]"),
            ("elements = [4, 4]", "elements = [4, 0]"),
            ("elements = [4, 4]", "elements = 99999999999999999999999999999999999999999999"),
            ("elements = [4, 4]", "elements = [4, 5]"),
            ("elements = [4, 4]", "elements = 7"),
            ("rotation_deg = 60.0", "rotation_deg = -60.0"),
            ("rotation_deg = 60.0", "rotation_deg = 180"),
            ("increment_deg = 0.4\n", "increment_deg = 0\n"),
            ("increment_deg = 0.4\n", "increment_deg = -0.4\n"),
            ("increment_deg = 0.4\n", "increment_deg = 61\n"),
            ("threshold = 0.019", "threshold = 0.0"),
            ("tolerance = 1e-7", "tolerance = 0"),
            ("tolerance = 1e-7", "tolerance = 0.1"),
            ("max_iterations = 100", "max_iterations = 0"),
            ("increment_deg = 0.4\n", "increment_deg = 0.4\nlongest_increment_deg = 0.2\n"),
            ("least_increment_deg = 1e-6", "least_increment_deg = 0.5"),
            ("least_increment_deg = 1e-6", "least_increment_deg = 0.05"),
            ("least_increment_deg = 1e-6\nsnap_tolerance_deg = 0.01", "least_increment_deg = 0.05"),
        ]),
    );
}

const STAGES: &str =
    "stages = [\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]";

#[test]
fn stages() {
    pin(
        "stages",
        &errors(&[
            (STAGES, "stages = []"),
            (STAGES, "stages = \"solve\""),
            (STAGES, "stages = true"),
            (STAGES, "stages = [\"solve\", 2]"),
            (STAGES, "stages = [\"solve\", \"evaluate\"]"),
            (STAGES, "stages = [\"solve\", \"remesh\"]"),
            (STAGES, "stages = [\"solve\", \"solve\"]"),
            (STAGES, "stages = [\"evaluate-indicators\", \"solve\"]"),
            (STAGES, "stages = [\"evaluate-indicators\"]"),
            (STAGES, "stages = [\"solve\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]"),
            (STAGES, "stages = [\"solve\", \"evaluate-indicators\", \"refine-knots\"]"),
            (STAGES, "stages = [\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\"]"),
            (
                STAGES,
                "stages = [\n  \"solve\",\n  \"evaluate-indicators\",\n  \"project-displacements\",\n  \"re-equilibrate\",\n]",
            ),
            (
                STAGES,
                "stages = [\n  \"solve\",\n  \"evaluate-indicators\",\n  \"project-displacements\",\n  \"refine-knots\",\n  \"re-equilibrate\",\n]",
            ),
            (STAGES, "stages = [\"solve\"]"),
        ]),
    );
}

#[test]
fn stages_with_switch_branch() {
    pin(
        "stages_with_switch_branch",
        &errors(&[
            (STAGES, "stages = [\"switch-branch\"]"),
            (STAGES, "stages = [\"switch-branch\", \"solve\"]"),
            (STAGES, "stages = [\"solve\", \"switch-branch\", \"switch-branch\"]"),
            (STAGES, "stages = [\"solve\", \"evaluate-indicators\", \"switch-branch\"]"),
            (STAGES, "stages = [\"solve\", \"switch_branch\"]"),
            (
                STAGES,
                "stages = [\"solve\", \"switch-branch\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]",
            ),
        ]),
    );
}

#[test]
fn continuation() {
    let with = |lines: &str| format!("[continuation]\n{lines}\n[output]");
    let slips = [
        "control = \"arclength\"",
        "control = \"displacement\"",
        "control = true",
        "longest_step = 2.0",
        "control = \"load\"\nlongest_step = 2.0",
        "control = \"load\"\nmost_steps = 20",
        "shortest_step = 1e-5",
        "control = \"arc-length\"\nlongest_step = -2.0",
        "control = \"arc-length\"\nlongest_step = 0.5",
        "control = \"arc-length\"\nlongest_step = nan",
        "control = \"arc-length\"\nlongest_step = \"4\"",
        "control = \"arc-length\"\nshortest_step = -1e-4",
        "control = \"arc-length\"\nshortest_step = 0",
        "control = \"arc-length\"\nshortest_step = 2.0",
        "control = \"arc-length\"\nmost_steps = 0",
        "control = \"arc-length\"\nmost_steps = -5",
        "control = \"arc-length\"\nmost_steps = 10.5",
        "control = \"arc-length\"\nlongest_stpe = 2.0",
        "control = \"arc-length\"\nlongest_step_mm = 2.0",
    ];
    let slips: Vec<(&str, String)> = slips.iter().map(|lines| ("[output]", with(lines))).collect();
    let slips: Vec<(&str, &str)> = slips.iter().map(|(right, wrong)| (*right, wrong.as_str())).collect();
    pin("continuation", &errors(&slips));
}

#[test]
fn continuation_that_is_right() {
    for lines in ["", "control = \"load\"", "control = \"arc-length\"\nlongest_step = 1\nshortest_step = 1"] {
        let text = RIGHT.replace("[output]", &format!("[continuation]\n{lines}\n[output]"));
        let scene = parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{}", error.plain()));
        assert_eq!(scene.continuation.is_some(), lines.contains("arc-length"), "{lines}");
    }
}

#[test]
fn exclusive_keys() {
    pin("exclusive_keys", &errors(&[("threshold = 0.019", "threshold = 0.019\nlength_limit_mm = 1.0")]));
}

#[test]
fn syntax() {
    pin(
        "syntax",
        &errors(&[
            ("length_mm = 300.0", "length_mm = 300.0 mm"),
            ("length_mm = 300.0", "length_mm = 300,0"),
            ("length_mm = 300.0", "length_mm 300.0"),
            ("length_mm = 300.0", "length_mm ="),
            ("length_mm = 300.0", "length_mm = 300.0\nlength_mm = 400.0"),
            ("sense = \"opposite\"", "sense = opposite"),
            ("sense = \"opposite\"", "sense = \"opposite"),
            ("elements = [4, 4]", "elements = [4, 4"),
            ("[output]", "[output"),
            ("[output]", "[geometry]"),
            ("# A tape spring.", "symmetry = \"quarter\""),
            ("arc_deg = 110.0", "arc_deg ="),
            ("arc_deg = 110.0", "arc_deg = 110°"),
            ("mesh_history = false\n", "mesh_history = False"),
        ]),
    );
}

#[test]
fn settings() {
    pin(
        "settings",
        &setting_errors(&[
            "solver.max_iterations",
            "nonsense",
            "max_iterations=200",
            "banana=1",
            "solver.max_iteration=200",
            "solvr.max_iterations=200",
            "solver.max_iterations=many",
            "solver.max_iterations=",
            "solver.max_iterations=2 0",
            "solver.max_iterations = 0",
            "solver.tolerance=1",
            "load.increment_deg=90",
            "load.sense=eqal",
            "geometry.length_m=0.3",
            "geometry.arc=90",
            "symmetry=quarter",
            "a.b.c=1",
            "pipeline.stages=[\"solve\"]",
            "material.thickness_mm=12",
        ]),
    );
}

#[test]
fn help() {
    pin("help", &help_text());
}

/// What actions of [`GENERAL`] are put in front of.
const FIRST_PROBE: &str = "[[probe]]\nname = \"tip\"";

#[test]
fn offset_expansion_and_free_strain() {
    let action = |lines: &str| format!("[[action]]\n{lines}\n{FIRST_PROBE}");
    let heated = action("kind = \"temperature\"\nchange_k = -100.0");
    let half = "thermal_expansion_1_per_k = 1e-6\n[[ply]]";
    let large = "thermal_expansion_1_per_k = 1.0\nthermal_expansion_2_per_k = 22.5\n[[ply]]";
    let general = general_errors(&[
        ("[[ply]]", "offset_mm = 0.2\n[[ply]]"),
        ("[[ply]]", half),
        ("[[ply]]", large),
        (FIRST_PROBE, &heated),
        (FIRST_PROBE, &action("kind = \"temperature\"")),
        (FIRST_PROBE, &action("kind = \"natural-curvature\"\nchange_per_mm = 0.01")),
        (FIRST_PROBE, &action("kind = \"natural-curvature\"\ncurvature_per_mm = [0.01, 0.0, 0.0]")),
        (FIRST_PROBE, &action("kind = \"temperature\"\nchange_k = 9.0\nhistory = [[0.0, 1.0], [1.0, 2.0]]")),
    ]);
    let isotropic = |lines: &str| {
        let law = "kind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.1";
        let (from, to) = (GENERAL.find("kind = \"laminate\"").unwrap(), GENERAL.find("[mesh]").unwrap());
        format!("{}{law}\n{lines}\n{}", &GENERAL[..from], &GENERAL[to..])
    };
    let wrong = [
        isotropic("").replace(FIRST_PROBE, &heated),
        isotropic("offset_mm = -0.11"),
        isotropic("thermal_expansion_per_k = 23.1"),
        isotropic("cte = 23.1e-6"),
    ];
    let errors = wrong.map(|text| report(&parse(&text, "scene.toml").unwrap_err()));
    pin("offset_expansion_and_free_strain", &(general + "\n" + &errors.join("\n")));
}

#[test]
fn strengths() {
    let all = "tensile_strength_1_mpa = 1500.0\ncompressive_strength_1_mpa = 1200.0\ntensile_strength_2_mpa = 50.0\n\
               compressive_strength_2_mpa = 200.0\nshear_strength_12_mpa = 80.0\n[[ply]]";
    let errors = general_errors(&[
        ("[[ply]]", &all.replace("shear_strength_12_mpa = 80.0\n", "")),
        ("[[ply]]", &all.replace("compressive_strength_1_mpa = 1200.0", "compressive_strength_1_mpa = -1200.0")),
        ("[[ply]]", &all.replace("tensile_strength_2_mpa = 50.0\ncompressive_strength_2_mpa", "yt = 50.0\nyc_mpa")),
        ("[[ply]]", "[[ply]]\nshear_strength_12_mpa = 80.0"),
    ]);
    pin("strengths", &errors);
}

/// A plate and a laminate with supports, actions and probes of their own.
const GENERAL: &str = r#"# A plate.
[geometry]
kind = "plate"
length_mm = 100.0
width_mm = 40.0

[material]
kind = "laminate"
youngs_modulus_1_mpa = 140000.0
youngs_modulus_2_mpa = 10000.0
poissons_ratio_12 = 0.3
shear_modulus_12_mpa = 5000.0

[[ply]]
thickness_mm = 0.125
angle_deg = 0.0

[mesh]
elements = [8, 4]

[load]
kind = "steps"
factor = 2.0
increment = 0.25

[[support]]
name = "root"
on = "u-start"
kind = "clamped"

[[support]]
name = "side"
on = "v-start"
kind = "fixed"
hold = ["y"]

[[support]]
name = "pin"
on = [1.0, 1.0]
kind = "displacement"
z_mm = 0.5

[[action]]
name = "lift"
on = "u-end"
kind = "line-force"
force_n_per_mm = [0.0, 0.0, 0.02]
history = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]

[[probe]]
name = "tip"
kind = "displacement"
on = [1.0, 0.5]
component = "z"

[[probe]]
name = "root moment"
kind = "reaction"
support = "root"
component = "moment-y"

[adapt]
threshold = 0.02
length_limit_mm = [4.0, 8.0]
"#;

fn general_errors(slips: &[(&str, &str)]) -> String {
    let show = |(right, wrong): &(&str, &str)| {
        assert_eq!(GENERAL.matches(right).count(), 1, "`{right}` does not name one place");
        match parse(&GENERAL.replace(right, wrong), "scene.toml") {
            Ok(_) => panic!("`{wrong}` is taken"),
            Err(error) => report(&error),
        }
    };
    slips.iter().map(show).collect::<Vec<_>>().join("\n")
}

const PLATE: &str = "kind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 40.0";

#[test]
fn general_geometry() {
    parse(GENERAL, "scene.toml").unwrap();
    pin(
        "general_geometry",
        &general_errors(&[
            ("kind = \"plate\"", "kind = \"plat\""),
            ("width_mm = 40.0", "widht_mm = 40.0"),
            ("width_mm = 40.0", "width_mm = -40.0"),
            ("width_mm = 40.0", "width_mm = \"40\""),
            ("length_mm = 100.0\nwidth_mm", "width_mm"),
            (PLATE, "kind = \"cylinder-panel\"\nlength_mm = 9.0\nradius_mm = 3.0\narc_deg = 400.0"),
            (PLATE, "kind = \"cylinder-panel\"\nlength_mm = 9.0\nradius_mm = 3.0\narc_deg = 360.0"),
            (PLATE, "kind = \"cylinder-panel\"\nlength_mm = 9.0\nradius_mm = 3.0\narc_deg = 359.9999"),
            (PLATE, "kind = \"cylinder-panel\"\nlength_mm = 9.0\nradius_mm = 3.0\narc_deg = 90.0\nseam = \"free\""),
            (PLATE, "kind = \"cylinder-panel\"\nlength_mm = 9.0\nradius_mm = 0.1\narc_deg = 90.0"),
            (PLATE, "kind = \"annulus\"\ninner_radius_mm = 9.0\nouter_radius_mm = 3.0\narc_deg = 90.0"),
            (PLATE, "kind = \"sphere-zone\"\nradius_mm = 9.0\nlatitude_deg = [0.0, 90.0]\narc_deg = 90.0"),
            (PLATE, "kind = \"sphere-zone\"\nradius_mm = 9.0\nlatitude_deg = [72.0, 0.0]\narc_deg = 90.0"),
            (PLATE, "kind = \"sphere-zone\"\nradius_mm = 9.0\nlatitude_deg = 45.0\narc_deg = 90.0"),
            (PLATE, "kind = \"nurbs\"\ndegrees = [1, 1]"),
            (PLATE, "kind = \"nurbs\"\nfile = \"nowhere.json\""),
            (
                PLATE,
                "kind = \"nurbs\"\ndegrees = [1, 1]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 1, 1, 1]\ncontrol_points_mm = [[0, 0, 0]]",
            ),
            (
                PLATE,
                "kind = \"nurbs\"\ndegrees = [1, 1]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, 1]\ncontrol_points_mm = [[0, 0, 0]]",
            ),
            (
                PLATE,
                "kind = \"nurbs\"\ndegrees = [1, 1]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, 1]\ncontrol_points_mm = [[0, 0]]",
            ),
        ]),
    );
}

/// Surfaces of the user's own: knots, weights, degrees.
#[test]
fn nurbs() {
    let surface = |knots: &str, rest: &str| {
        let keys = format!("kind = \"nurbs\"\ndegrees = [2, 1]\nknots_u = {knots}\nknots_v = [0, 0, 1, 1]");
        let points = [0, 10, 20, 30, 40, 50].map(|x| format!("[{x}, 0, 0], [{x}, 9, 0]"));
        // One control point a function in u.
        let count = knots.matches(',').count() - 2;
        format!("{keys}\ncontrol_points_mm = [{}]\n{rest}", points[..count].join(", "))
    };
    const TWO_SPANS: &str = "[0, 0, 0, 0.5, 1, 1, 1]";
    let wrong = [
        surface("[0, 0, 0, 0.5, 0.50000001, 1, 1, 1]", ""),
        surface("[0, 0, 1e-9, 0.5, 1, 1, 1]", ""),
        surface("[0, 0, 0, 0.7, 0.3, 1, 1, 1]", ""),
        surface("[0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1]", ""),
        surface("[0, 0, 0.2, 0.5, 1, 1, 1]", ""),
        surface(TWO_SPANS, "weights = [1, 1, 1, 0, 1, 1, 1, 1]"),
        surface(TWO_SPANS, "weights = [1, 1, 1]"),
        surface(TWO_SPANS, "seam = \"closed\""),
        surface(TWO_SPANS, "weigths = [1, 1, 1, 1, 1, 1, 1, 1]"),
        surface(TWO_SPANS, "").replace("[2, 1]", "[2.5, 1]"),
        surface(TWO_SPANS, "").replace("[2, 1]", "[6, 1]"),
    ];
    let slips: Vec<(&str, &str)> = wrong.iter().map(|text| (PLATE, text.as_str())).collect();
    pin("nurbs", &general_errors(&slips));
    assert!(parse(&GENERAL.replace(PLATE, &surface(TWO_SPANS, "")), "scene.toml").is_ok());
}

/// Profiles: wrong names, units and values of pieces, arcs that are no arcs, and profiles that meet themselves.
#[test]
fn profiles() {
    let profile = |pieces: &str| format!("kind = \"profile\"\nlength_mm = 300.0\nprofile = {pieces}");
    const FLANGE: &str = "[{ line_mm = 8.0 }, { arc_deg = 105.0, radius_mm = 10.6 }]";
    assert!(parse(&GENERAL.replace(PLATE, &profile(FLANGE)), "scene.toml").is_ok());
    let wrong = [
        profile("[]"),
        profile("8.0"),
        profile("[8.0, { arc_deg = 105.0, radius_mm = 10.6 }]"),
        profile("[{ }]"),
        profile("[{ line_mm = 0.0 }, { arc_deg = 105.0, radius_mm = 10.6 }]"),
        profile("[{ line_mm = -8.0 }]"),
        profile("[{ line_m = 0.008 }, { arc_deg = 105.0, radius_mm = 10.6 }]"),
        profile("[{ line_mm = \"8 mm\" }]"),
        profile("[{ lien_mm = 8.0 }]"),
        profile("[{ line_mm = 8.0 }, { arc_deg = 105.0 }]"),
        profile("[{ line_mm = 8.0 }, { radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0, arc_deg = 105.0, radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0 }, { arc_deg = 0.0, radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0 }, { arc_deg = -400.0, radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0 }, { arc_rad = 1.8, radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0 }, { arc_deg = nan, radius_mm = 10.6 }]"),
        profile("[{ line_mm = 8.0 }, { arc_deg = 105.0, radius_mm = 0.05 }]"),
        profile("[{ arc_deg = 180.0, radius_mm = 4.0 }, { arc_deg = 180.0, radius_mm = 4.0 }]"),
        profile("[{ line_mm = 20.0 }, { arc_deg = 270.0, radius_mm = 4.0 }, { line_mm = 10.0 }]"),
        profile("[{ arc_deg = 200.0, radius_mm = 4.0 }, { arc_deg = 200.0, radius_mm = 4.0 }]"),
        format!("{}\nstart_mm = [0.0, 1.0, 2.0]", profile(FLANGE)),
        format!("{}\ndirection_rad = 1.5", profile(FLANGE)),
        format!("{}\nradius_mm = 10.0", profile(FLANGE)),
        "kind = \"profile\"\nlength_mm = 300.0".to_owned(),
    ];
    let slips: Vec<(&str, &str)> = wrong.iter().map(|text| (PLATE, text.as_str())).collect();
    let flange = GENERAL.replace(PLATE, &profile(FLANGE));
    let radial = flange.replacen("component = \"z\"", "component = \"radial\"", 1);
    let in_setting = parse_with_settings(&flange, "scene.toml", &["geometry.profile=[{line_mm=8}, {lin_mm=2}]"]);
    let errors = [parse(&radial, "scene.toml").unwrap_err(), in_setting.unwrap_err()];
    let others = errors.map(|error| report(&error)).join("\n");
    pin("profiles", &format!("{}\n{others}", general_errors(&slips)));
}

/// Keys of another kind, keys that stand in the place of others, a spring without a middle.
#[test]
fn another_kind_is_meant() {
    let of_springs = errors(&[
        ("youngs_modulus_mpa = 131000.0", "youngs_modulus_1_mpa = 131000.0\nyoungs_modulus_2_mpa = 9000.0"),
        ("poissons_ratio = 0.3", "poissons_ratio = 0.3\nangle_deg = 45.0"),
        ("arc_deg = 110.0", "arc_deg = 110.0\nseam = \"free\""),
        ("increment_deg = 0.4", "increment = 0.4"),
        ("length_mm = 300.0", "length_mm = 0.25"),
        ("length_mm = 300.0\nradius_mm = 10.0", "length_mm = 10.0\nradius_mm = 300.0"),
    ]);
    let of_plates = general_errors(&[
        ("youngs_modulus_1_mpa = 140000.0", "youngs_modulus_mpa = 140000.0"),
        ("increment = 0.25", "increment_deg = 0.25"),
        ("force_n_per_mm", "force_kn_per_mm"),
        ("[[ply]]\nthickness_mm = 0.125\nangle_deg = 0.0", "[ply]\nthickness_mm = 0.1\n[ply]\nthickness_mm = 0.2"),
        ("name = \"side\"\non = \"v-start\"", "name = \"side\"\nat = \"v-start\""),
    ]);
    pin("another_kind_is_meant", &(of_springs + "\n" + &of_plates));
}

/// Units, slips and symbols in tables of which there may be several.
#[test]
fn hints_in_supports_and_actions() {
    const LIFT: &str = "on = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.02]";
    pin(
        "hints_in_supports_and_actions",
        &general_errors(&[
            (LIFT, "on = [1.0, 0.5]\nkind = \"force\"\nforce_kn = [0.0, 0.0, 0.004]"),
            (LIFT, "on = [1.0, 0.5]\nkind = \"force\"\nforce = [0.0, 0.0, 4.0]"),
            (LIFT, "kind = \"pressure\"\npressure_kpa = 1.5"),
            (LIFT, "kind = \"pressure\"\npressure_mpa = \"1.5 kPa\""),
            (LIFT, "kind = \"natural-curvature\"\nchange_per_m = [20.0, 0.0, 0.0]"),
            ("on = \"v-start\"", "on = \"vstart\""),
            ("on = \"v-start\"", "edge = \"v-start\""),
            ("hold = [\"y\"]", "hold = [\"Y\"]"),
            ("hold = [\"y\"]", "held = [\"y\"]"),
            ("z_mm = 0.5", "uz = 0.5"),
            ("z_mm = 0.5", "z_cm = 0.05"),
            ("increment = 0.25", "increment_deg = 0.25"),
            ("increment = 0.25", "step = 0.25"),
            ("youngs_modulus_1_mpa = 140000.0", "e1_gpa = 140"),
            ("width_mm = 40.0", "width_m = 0.04"),
            ("component = \"z\"", "componnet = \"z\""),
        ]),
    );
}

/// All that is wrong with names and values is told at once, stray keys first, or else all that does not go together; ten
/// mistakes at most.
#[test]
fn several_mistakes() {
    let of_spring = RIGHT
        .replace("radius_mm = 10.0\n", "")
        .replace("arc_deg = 110.0", "banana = 1\narc_deg = 400.0")
        .replace("sense = \"opposite\"", "sense = \"up\"")
        .replace("[output]", "[ouptut]");
    let of_plate = GENERAL
        .replace("kind = \"clamped\"", "")
        .replace("on = \"v-start\"", "on = \"vstart\"\ncolour = \"red\"")
        .replace("angle_deg = 0.0", "angle_rad = 0.0")
        .replace("[0.0, 0.0, 0.02]", "[0.0, 0.02]");
    let strays: String = (1..=13).map(|number| format!("banana_{number} = {number}\n")).collect();
    let many = RIGHT.to_owned() + &strays;
    let together = RIGHT
        .replace("elements = [4, 4]", "elements = [4, 5]")
        .replace("increment_deg = 0.4\n", "increment_deg = 61.0\n")
        .replace("thickness_mm = 0.1", "thickness_mm = 12.0");
    let errors = [of_spring, of_plate, many, together].map(|text| report(&parse(&text, "scene.toml").unwrap_err()));
    pin("several_mistakes", &errors.join("\n"));
}

#[test]
fn general_material_and_load() {
    pin(
        "general_material_and_load",
        &general_errors(&[
            ("kind = \"laminate\"", "kind = \"isotropic\""),
            ("kind = \"laminate\"", "kind = \"composite\""),
            ("poissons_ratio_12 = 0.3", "poissons_ratio_12 = 4.0"),
            ("youngs_modulus_1_mpa = 140000.0\n", ""),
            ("thickness_mm = 0.125", "thickness_mm = 0.0"),
            ("angle_deg = 0.0", "angel_deg = 0.0"),
            ("[[ply]]\nthickness_mm = 0.125\nangle_deg = 0.0", ""),
            ("[[ply]]", "[ply]"),
            ("kind = \"steps\"", "kind = \"end-rotation\"\nsense = \"equal\""),
            ("increment = 0.25", "increment = 2.5"),
            ("increment = 0.25", "increment = 0.0"),
            ("increment = 0.25", "increment = 0.25\nleast_increment = 0.5"),
            ("increment = 0.25", "increment = 0.25\nlongest_increment = 0.1"),
            ("[adapt]", "[solver]\nleast_increment_deg = 1e-5\n[adapt]"),
            ("[adapt]", "[symmetry]\npart = \"quarter\"\n[adapt]"),
            ("length_limit_mm = [4.0, 8.0]", "length_limit = \"sqrt-radius-thickness\""),
            ("length_limit_mm = [4.0, 8.0]", "length_limit_mm = [4.0, 8.0, 9.0]"),
        ]),
    );
}

#[test]
fn general_supports_actions_and_probes() {
    pin(
        "general_supports_actions_and_probes",
        &general_errors(&[
            ("kind = \"clamped\"", "kind = \"clamp\""),
            ("on = \"u-start\"", "on = \"left\""),
            ("on = \"u-start\"", "on = [0.0, 0.5]"),
            ("on = \"u-start\"\nkind = \"clamped\"", "kind = \"clamped\""),
            ("on = \"v-start\"", "on = \"v=1.0\""),
            ("on = [1.0, 1.0]", "on = [1.0, 1.5]"),
            ("hold = [\"y\"]", "hold = [\"r\"]"),
            ("hold = [\"y\"]", "hold = []"),
            ("hold = [\"y\"]", "hold = \"y\""),
            ("z_mm = 0.5", ""),
            ("z_mm = 0.5", "z_mm = \"free\""),
            ("name = \"side\"", "name = \"root\""),
            ("on = \"v-start\"", "on = \"u-start\""),
            ("kind = \"displacement\"\nz_mm = 0.5", "kind = \"rigid\"\nrotation_x_deg = 3.0"),
            ("kind = \"line-force\"", "kind = \"force\""),
            ("kind = \"line-force\"", "kind = \"edge-load\""),
            ("[0.0, 0.0, 0.02]", "0.02"),
            ("[0.0, 0.0, 0.02]", "[0.0, 0.02]"),
            ("[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]", "[[0.0, 0.0], [2.0, 1.0], [1.0, 0.0]]"),
            ("[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]", "[[0.0, 1.0], [2.0, 1.0]]"),
            ("[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]", "[0.0, 1.0]"),
            ("component = \"z\"", "component = \"w\""),
            ("component = \"z\"", "component = \"radial\""),
            ("[0.0, 0.0, 0.02]", "0.02\nalong = \"radial\""),
            ("[0.0, 0.0, 0.02]", "[0.0, 0.0, 0.02]\nalong = \"normal\""),
            ("on = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.02]", "kind = \"gravity\""),
            ("kind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.02]", "kind = \"gravity\""),
            (
                "on = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.02]",
                "kind = \"area-force\"\nforce_n_per_mm2 = 0.02\nalong = \"normal\"\nper = \"projected-area\"",
            ),
            (
                "on = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.02]",
                "kind = \"area-force\"\nforce_n_per_mm2 = 0.02\nalong = \"outward\"",
            ),
            ("kind = \"displacement\"\nz_mm = 0.5", "kind = \"symmetric\""),
            (
                "name = \"side\"\non = \"v-start\"\nkind = \"fixed\"\nhold = [\"y\"]",
                "name = \"side\"\non = \"v-start\"\nkind = \"rigid-motions\"",
            ),
            ("support = \"root\"", "support = \"foot\""),
            ("name = \"tip\"\n", ""),
            ("name = \"root moment\"", "name = \"tip\""),
            (
                "kind = \"reaction\"\nsupport = \"root\"\ncomponent = \"moment-y\"",
                "kind = \"section-moment\"\non = \"u-end\"\ncomponent = \"y\"",
            ),
            ("kind = \"reaction\"", "kind = \"section-moment\"\non = \"u=0.5\""),
            ("[[probe]]\nname = \"tip\"", "[[probe]]\nname = \"tip\"\ncolour = \"red\""),
        ]),
    );
}

/// A plate with imperfections.
const IMPERFECT: &str = r#"[geometry]
kind = "plate"
length_mm = 100.0
width_mm = 40.0

[material]
kind = "isotropic"
youngs_modulus_mpa = 70000.0
poissons_ratio = 0.3
thickness_mm = 0.5

[[imperfection]]
name = "bow"
kind = "modes"
modes = [1]
amplitude = 0.5

[[imperfection]]
name = "shape"
kind = "random-field"
seed = 3
correlation_mm = 20.0
deviation = 0.2

[[imperfection]]
name = "measured"
kind = "grid"
u = [0.0, 0.5, 1.0]
v = [0.0, 1.0]
offsets_mm = [0.0, 0.0, 0.1, 0.1, 0.0, 0.0]

[load]
kind = "steps"
factor = 1.0
increment = 0.1

[[support]]
name = "root"
on = "u-start"
kind = "clamped"

[[action]]
name = "tip.load"
on = "u-end"
kind = "line-force"
force_n_per_mm = [-1.0, 0.0, 0.0]
"#;

fn imperfection_errors(slips: &[(&str, &str)]) -> String {
    let show = |(right, wrong): &(&str, &str)| {
        assert_eq!(IMPERFECT.matches(right).count(), 1, "`{right}` does not name one place");
        match parse(&IMPERFECT.replace(right, wrong), "scene.toml") {
            Ok(_) => panic!("`{wrong}` is taken"),
            Err(error) => report(&error),
        }
    };
    slips.iter().map(show).collect::<Vec<_>>().join("\n")
}

#[test]
fn imperfections() {
    let grid = "u = [0.0, 0.5, 1.0]";
    pin(
        "imperfections",
        &imperfection_errors(&[
            ("modes = [1]", "modes = [0]"),
            ("modes = [1]", "modes = [1.5]"),
            ("modes = [1]", "modes = [1, 2, 1]\nseed = 1"),
            ("modes = [1]", "modes = []"),
            ("modes = [1]", "modes = [1, 2]"),
            ("modes = [1]", "modes = [1]\nseed = 1"),
            ("modes = [1]\namplitude = 0.5", "modes = [1, 2]\nseed = 4\namplitude = -0.5"),
            ("amplitude = 0.5", "amplitude = 0"),
            ("amplitude = 0.5", "amplitude_mm = 0.5"),
            ("seed = 3\n", ""),
            ("seed = 3", "seed = -1"),
            ("deviation = 0.2", "amplitude = 0.2"),
            ("name = \"shape\"", "name = \"bow\""),
            (grid, "shell = \"web\"\nu = [0.0, 0.5, 1.0]"),
            (grid, "u = [0.0, 0.5, 0.9]"),
            (grid, "u = [0.0, 0.5, 0.5, 1.0]"),
            (grid, "u = [0.0, 1.0]"),
            (grid, "u = [0.0]"),
            (
                "kind = \"clamped\"",
                "kind = \"clamped\"\n[[support]]\nname = \"middle\"\non = \"v=0.5\"\nkind = \"symmetric\"",
            ),
            (grid, "file = \"nowhere.csv\"\nu = [0.0, 0.5, 1.0]"),
        ]),
    );
}

/// Slips in a measured grid, whose file is in the folder of the scene.
#[test]
fn measured_grids() {
    let folder = tempfile::tempdir().unwrap();
    let right = "u,v,offset_mm\n0,0,0\n0,0.5,0\n0,1,0\n0.5,0,0.1\n0.5,0.5,0.1\n0.5,1,0.1\n1,0,0\n1,0.5,0\n1,1,0\n";
    let scene = folder.path().join("scene.toml").to_str().unwrap().to_owned();
    let text = IMPERFECT.replace(
        "u = [0.0, 0.5, 1.0]\nv = [0.0, 1.0]\noffsets_mm = [0.0, 0.0, 0.1, 0.1, 0.0, 0.0]\n",
        "file = \"offsets.csv\"\n",
    );
    let read = |csv: &str| {
        std::fs::write(folder.path().join("offsets.csv"), csv).unwrap();
        parse(&text, &scene)
    };
    let taken = read(&format!("\u{feff}{}\n\n", right.replace('\n', "\r\n"))).unwrap();
    // The scene that a log keeps has the grid in it.
    assert_eq!(parse(&taken.to_toml(), "elsewhere.toml").unwrap(), taken);
    assert!(taken.may_read_files());
    let errors: Vec<String> = [
        ("u,v,offset_mm", "u,v,w_mm"),
        ("0.5,0.5,0.1", "0.5,0.5"),
        ("0.5,0.5,0.1", "0.5,0.5,nan"),
        ("0.5,0.5,0.1", "0.5,0.5,none"),
        ("0.5,0.5,0.1\n", ""),
        ("0.5,1,0.1\n", ""),
        ("1,1,0\n", ""),
        ("0.5,0.5,0.1", "0.5,0.6,0.1"),
        ("0,0.5,0\n0,1,0", "0,1,0\n0,0.5,0"),
        ("1,0,0\n", "0.4,0,0\n"),
        ("1,1,0\n", "1,1,0\n1,1,0\n"),
        ("0.5,0.5,0.1", "0.5,1.5,0.1"),
        ("1,0,0\n1,0.5,0\n1,1,0\n", ""),
        ("0.5,0,0.1\n0.5,0.5,0.1\n0.5,1,0.1\n1,0,0\n1,0.5,0\n1,1,0\n", ""),
    ]
    .into_iter()
    .map(|(right_part, wrong)| {
        assert_eq!(right.matches(right_part).count(), 1, "{right_part}");
        let error = read(&right.replace(right_part, wrong)).map(|_| wrong.to_owned()).unwrap_err();
        error.plain().replace(folder.path().to_str().unwrap(), "FOLDER")
    })
    .collect();
    std::fs::remove_file(folder.path().join("offsets.csv")).unwrap();
    pin("measured_grids", &errors.join("\n\n"));
    let missing = parse(&text, &scene).unwrap_err().plain();
    assert!(missing.contains("offsets.csv cannot be read"), "{missing}");
}

/// Settings name one of several tables, and tables of a shell.
#[test]
fn settings_of_named_tables() {
    let frame = include_str!("../../pipelines/structures/right-angle-frame.toml");
    let set = |text: &str, settings: &[&str]| {
        parse_with_settings(text, "scene.toml", settings).map_err(|error| report(&error))
    };
    let plain = set(IMPERFECT, &[]).unwrap();
    let by_file = |from: &str, to: &str| parse(&IMPERFECT.replace(from, to), "scene.toml").unwrap();
    assert_eq!(set(IMPERFECT, &["imperfection.shape.seed=9"]).unwrap(), by_file("seed = 3", "seed = 9"));
    assert_eq!(
        set(IMPERFECT, &["action.tip.load.force_n_per_mm=[0.0, 0.0, 2.0]"]).unwrap(),
        by_file("[-1.0, 0.0, 0.0]", "[0.0, 0.0, 2.0]")
    );
    assert_eq!(set(IMPERFECT, &["support.root.kind=hinged"]).unwrap(), by_file("\"clamped\"", "\"hinged\""));
    assert_eq!(set(IMPERFECT, &["imperfection.shape.seed=9", "imperfection.shape.seed=3"]).unwrap(), plain);
    let unnamed = IMPERFECT.replace("name = \"shape\"\n", "");
    let second = set(&unnamed, &["imperfection.imperfection 2.seed=9"]).unwrap();
    assert_eq!(second, parse(&unnamed.replace("seed = 3", "seed = 9"), "scene.toml").unwrap());
    // One shell alone: what it shared with the others it has for itself then.
    let own = set(
        frame,
        &["shell.arm.mesh.elements=[8, 4]", "shell.arm.material.thickness_mm=0.5", "shell.column.geometry.width_mm=10"],
    )
    .unwrap();
    let of_file = parse(frame, "scene.toml").unwrap();
    assert_eq!(own.shells[0].mesh, of_file.shells[0].mesh);
    assert_eq!((own.shells[1].mesh.elements, own.shells[1].mesh.degree), ([8, 4], of_file.shells[1].mesh.degree));
    assert_eq!(own.shells[0].material.thickness_mm(), of_file.shells[0].material.thickness_mm());
    assert_eq!(own.shells[1].material.thickness_mm(), 0.5);
    assert_ne!(own.shells[0].geometry, of_file.shells[0].geometry);
    assert_eq!(own.shells[1].geometry, of_file.shells[1].geometry);
    let wrong = [
        (IMPERFECT, "imperfection.seed=3"),
        (IMPERFECT, "imperfection.shap.seed=3"),
        (IMPERFECT, "imperfection.shape=3"),
        (IMPERFECT, "imperfection.shape.sed=3"),
        (IMPERFECT, "imperfection.shape.seed=-3"),
        (IMPERFECT, "joint.corner.kind=hinge"),
        (frame, "shell.arm.mesh.elements=many"),
        (frame, "shell.arm.mesh.element=3"),
        (frame, "shell.arm.ply.angle_deg=3"),
        (frame, "shell.leg.mesh.elements=3"),
    ];
    let errors: Vec<String> = wrong.into_iter().map(|(text, setting)| set(text, &[setting]).unwrap_err()).collect();
    pin("settings_of_named_tables", &errors.join("\n"));
}
