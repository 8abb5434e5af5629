//! Mistakes of unit and place are said or refused with their numbers, and no scene that is meant as it stands is.

use std::path::Path;

use foldline::model::{ModelError, Size, oddities};
use foldline::pipeline::Stages;
use foldline::scene::{Scene, parse, tables_refused};
use foldline::study::hardly_moved_or_thrown_off;

const SPRING: &str = "baseline.toml";
const ROOF: &str = "verification/hinged-roof-12.7.toml";
const PLIES: &str = "verification/cured-plate.toml";
const CONE: &str = "verification/cone-pressure.toml";
const ZONE: &str = "verification/sphere-zone-pressure.toml";
const NET: &str = "../tests/verification/scenes/net-u-fastest.toml";
const STRIP: &str = "verification/cantilever-end-shear.toml";

const PLATE: &str = "../src/cli/templates/plate.toml";
const PANEL: &str = "../src/cli/templates/panel.toml";
const LIP: &str = "../src/cli/templates/annulus.toml";
const DOME: &str = "../src/cli/templates/sphere.toml";
const HALF_CONE: &str = "../src/cli/templates/nurbs.toml";
const COOLED: &str = "../src/cli/templates/laminate.toml";

/// What was meant, the scene that it is done to, the text that is replaced and what it becomes, and what must be said.
type Mistake = (&'static str, &'static str, &'static [(&'static str, &'static str)], &'static [&'static str]);

const MISTAKES: &[Mistake] = &[
    (
        "all lengths in m",
        SPRING,
        &[("300.0", "0.3"), ("radius_mm = 10.0", "radius_mm = 0.01"), ("thickness_mm = 0.1", "thickness_mm = 1e-4")],
        &["0.3 mm at its longest", "in m"],
    ),
    (
        "all lengths in µm",
        SPRING,
        &[("300.0", "3e5"), ("radius_mm = 10.0", "radius_mm = 1e4"), ("thickness_mm = 0.1", "thickness_mm = 100.0")],
        &["300000 mm at its longest", "µm"],
    ),
    ("the length in m", SPRING, &[("length_mm = 300.0", "length_mm = 0.3")], &["0.3 mm", "boundary layer"]),
    ("the radius in m", SPRING, &[("radius_mm = 10.0", "radius_mm = 0.01")], &["0.01", "0.1"]),
    ("the thickness in m", SPRING, &[("thickness_mm = 0.1", "thickness_mm = 1e-4")], &["100000 times the thickness"]),
    ("the thickness in µm", SPRING, &[("thickness_mm = 0.1", "thickness_mm = 100.0")], &["100", "10"]),
    ("the thickness in hundredths of a mm", SPRING, &[("thickness_mm = 0.1", "thickness_mm = 1.1")], &["9.09 times"]),
    ("E in GPa", SPRING, &[("131000.0", "131.0")], &["youngs_modulus_mpa = 131 ", "write 131000"]),
    ("E in Pa", SPRING, &[("131000.0", "131e9")], &["1.31e11", "write 131000"]),
    ("E in kPa", SPRING, &[("131000.0", "131e6")], &["1.31e8"]),
    ("the arc in radians", SPRING, &[("arc_deg = 110.0", "arc_deg = 1.9199")], &["the arc is 1.92°", "110.002°"]),
    (
        "radius and length exchanged",
        SPRING,
        &[("length_mm = 300.0", "length_mm = 10.0"), ("radius_mm = 10.0", "radius_mm = 300.0")],
        &["a spring of 10 mm", "radius_mm is 300: are the two exchanged?"],
    ),
    (
        "radius and length exchanged, of a wide spring",
        SPRING,
        &[("length_mm = 300.0", "length_mm = 40.0"), ("radius_mm = 10.0", "radius_mm = 60.0")],
        &["geometry.length_mm = 40 is shorter than the arc, 115.2 mm"],
    ),
    (
        "radius and thickness exchanged",
        SPRING,
        &[("radius_mm = 10.0", "radius_mm = 0.1"), ("thickness_mm = 0.1", "thickness_mm = 10.0")],
        &["10", "0.1"],
    ),
    (
        "u and v of the mesh exchanged",
        "baseline-uniform.toml",
        &[("[128, 16]", "[16, 128]")],
        &["mesh.elements = [16, 128]", "u and v exchanged"],
    ),
    ("u and v of a net exchanged", CONE, &[("__net__", "")], &["90° off a right angle"]),
    ("u and v of a net exchanged, of a bent plate", NET, &[], &["u running fastest"]),
    ("the increment in radians", SPRING, &[("increment_deg = 0.4", "increment_deg = 0.007")], &["0.007", "8571.43"]),
    ("the target in radians", SPRING, &[("rotation_deg = 60.0", "rotation_deg = 0.35")], &["0.35", "0.4"]),
    (
        "a net in m",
        CONE,
        &[("__scale__", "1e-3"), ("thickness_mm = 0.5", "thickness_mm = 5e-4")],
        &["0.1 mm at its longest"],
    ),
    ("a net in m, the thickness in mm", CONE, &[("__scale__", "1e-3")], &["0.5", "0.05"]),
    ("a net in µm", CONE, &[("__scale__", "1e3")], &["times the thickness, 0.5 mm"]),
    (
        "a net in m of a boom as long as a rocket",
        CONE,
        &[("__scale__", "0.1"), ("thickness_mm = 0.5", "thickness_mm = 1e-4")],
        &["1e−4 mm thick"],
    ),
    (
        "latitudes in radians",
        ZONE,
        &[("[-30.0, 60.0]", "[-0.524, 1.047]")],
        &["the range of latitudes is 1.571°", "90.012°"],
    ),
    (
        "the full turn in radians",
        ZONE,
        &[("arc_deg = 360.0\nseam = \"smooth\"", "arc_deg = 6.2832")],
        &["the arc is 6.283°", "360.001°"],
    ),
    ("the angle of a ply in radians", PLIES, &[("angle_deg = 90.0", "angle_deg = 1.5708")], &["1.5708", "90"]),
    ("plies in µm", PLIES, &[("thickness_mm = 0.125", "thickness_mm = 125.0")], &["250", "200"]),
    ("plies in m", PLIES, &[("thickness_mm = 0.125", "thickness_mm = 0.125e-3")], &["2.5e−4 mm thick"]),
    (
        "E of the plies in GPa",
        PLIES,
        &[("181000.0", "181.0"), ("10300.0", "10.3"), ("7170.0", "7.17")],
        &["181", "181000"],
    ),
    ("E across the plies in GPa", PLIES, &[("10300.0", "10.3")], &["10.3", "10300"]),
    ("G of the plies in GPa", PLIES, &[("7170.0", "7.17")], &["shear_modulus_12_mpa = 7.17"]),
    ("expansion in millionths", PLIES, &[("22.5e-6", "22.5")], &["22.5", "22.5e-6"]),
    ("a cooling in mK", PLIES, &[("change_k = -150.0", "change_k = -150000.0")], &["150000 K"]),
    ("a strength in Pa", PLIES, &[("[[ply]]\nthickness_mm = 0.125\n\n", STRONG)], &["tensile_strength_1_mpa = 1.5e9"]),
    ("the density in g/cm³", STRIP, &[("poissons_ratio", "density_kg_m3 = 1.6\npoissons_ratio")], &["1.6", "g/cm³"]),
    (
        "the density in t/mm³",
        STRIP,
        &[("poissons_ratio", "density_kg_m3 = 1.6e-9\npoissons_ratio")],
        &["1.6e−9", "t/mm³"],
    ),
    ("a force in mN", ROOF, &[("-3000.0", "-3e6")], &["3e6 N"]),
    ("a pressure in Pa", ZONE, &[("pressure_mpa = 0.0001", "pressure_mpa = 100.0")], &["100 MPa"]),
    ("a weight in mm/s²", STRIP, &[("[[action]]", HEAVY)], &["9810 m/s²", "1000 times"]),
    (
        "a limit of refinement in m",
        SPRING,
        &[("\"sqrt-radius-thickness\"", "1e-3"), ("length_limit", "length_limit_mm")],
        &["0.001"],
    ),
    (
        "a plate in m",
        PLATE,
        &[("= 100.0 ", "= 0.1 "), ("= 40.0 ", "= 0.04 "), ("thickness_mm = 0.5", "thickness_mm = 5e-4")],
        &["0.1 mm at its longest", "in m"],
    ),
    ("the length of a plate in m", PLATE, &[("length_mm = 100.0 ", "length_mm = 0.1 ")], &["0.5 mm", "0.1 mm"]),
    (
        "the thickness of a plate in m",
        PLATE,
        &[("thickness_mm = 0.5", "thickness_mm = 5e-4")],
        &["5e−4 mm thick", "in m"],
    ),
    (
        "the thickness of a plate of 2 mm in m",
        PLATE,
        &[("thickness_mm = 0.5", "thickness_mm = 2e-3")],
        &["times its largest extent", "thickness in mm"],
    ),
    ("E of a plate in psi", PLATE, &[("70000.0", "10.0e6")], &["youngs_modulus_mpa = 1e7", "kPa"]),
    (
        "the density of a plate in kg/mm³",
        PLATE,
        &[("poissons_ratio", "density_kg_m3 = 2.7e-6\npoissons_ratio")],
        &["kg/mm³"],
    ),
    ("a force in kN/mm", PLATE, &[("[0.0, 0.0, 0.02]", "[0.0, 0.0, 2e-5]")], &["by linear theory", "of its thickness"]),
    ("a force in kN", PANEL, &[("-3000.0", "-3.0")], &["by linear theory", "of its thickness"]),
    ("a force in kN on a roof", ROOF, &[("-3000.0", "-3.0")], &["by linear theory", "of its thickness"]),
    ("the arc of a panel in radians", PANEL, &[("arc_deg = 12.0 ", "arc_deg = 0.2094 ")], &["12 mm", "9.137 mm"]),
    (
        "radius and length of a panel exchanged",
        PANEL,
        &[("length_mm = 500.0 ", "length_mm = 2500.0 "), ("radius_mm = 2500.0", "radius_mm = 12.0")],
        &["12"],
    ),
    (
        "E of a panel in GPa",
        PANEL,
        &[("3000.0\npoissons", "3.0\npoissons")],
        &["youngs_modulus_mpa = 3 ", "write 3000"],
    ),
    (
        "the radii of a plate in m",
        LIP,
        &[("inner_radius_mm = 60.0 ", "inner_radius_mm = 0.06 "), ("outer_radius_mm = 100.0", "outer_radius_mm = 0.1")],
        &["0.3 mm", "0.04"],
    ),
    (
        "the turn of a plate in radians",
        LIP,
        &[("arc_deg = 360.0", "arc_deg = 6.2832")],
        &["6.2832 degrees", "arc_deg = 360.0"],
    ),
    (
        "the radius of a dome in m",
        DOME,
        &[("radius_mm = 100.0", "radius_mm = 0.1")],
        &["1 mm is not thin for a radius of 0.1 mm"],
    ),
    ("latitudes of a dome in radians", DOME, &[("[30.0, 80.0]", "[0.52, 1.4]")], &["the range of latitudes is 0.88°"]),
    ("a pressure on a dome in Pa", DOME, &[("pressure_mpa = -0.1 ", "pressure_mpa = -1e5 ")], &["100000 MPa"]),
    ("a pressure on a dome in GPa", DOME, &[("pressure_mpa = -0.1 ", "pressure_mpa = -1e-4 ")], &["by linear theory"]),
    ("half a cone in m", HALF_CONE, &[("__scale__", "1e-3"), ("thickness_mm = 1.0", "thickness_mm = 1e-3")], &["in m"]),
    ("half a cone in m, its thickness in mm", HALF_CONE, &[("__scale__", "1e-3")], &["the thickness, 1 mm"]),
    (
        "a temperature for a change",
        COOLED,
        &[("change_k = -5.0", "change_k = 293.15")],
        &["change_k = 293.15", "20 °C"],
    ),
    ("E of plies in Pa", COOLED, &[("181000.0", "181.0e9"), ("10300.0", "10.3e9")], &["1.81e11", "write 181000"]),
    ("plies at an angle in radians", COOLED, &[("angle_deg = 90.0", "angle_deg = 1.5708")], &["1.5708", "90"]),
    (
        "the load on the clamped edge",
        PLATE,
        &[("on = \"u-end\"", "on = \"u-start\"")],
        &["action \"lift\"", "\"v-start\" meant"],
    ),
    (
        "u and v of a probe exchanged",
        PLATE,
        &[("on = [1.0, 0.5] ", "on = [0.0, 0.5] ")],
        &["probe \"tip\"", "support \"root\" keeps at 0", "[0.5, 0.0]"],
    ),
    (
        "a support that leaves a turn free",
        PLATE,
        &[("kind = \"clamped\" ", "kind = \"hinged\" ")],
        &["can turn about an axis along y"],
    ),
    ("u and v of a support exchanged", HINGES, &[], &["support \"right\"", "on = [1.0, 0.0]", "are u and v exchanged"]),
    ("the turn of a section in radians", TURNED, &[], &["is in degrees: in radians that would be 90"]),
];

/// A plate hinged along an edge, and held at a corner of that instead of one beyond it.
const HINGES: &str = "../tests/verification/scenes/hinges-exchanged.toml";
/// A plate whose edge turns by π/2.
const TURNED: &str = "../tests/verification/scenes/turned-in-radians.toml";

/// A ply with strengths, the first in Pa.
const STRONG: &str = "tensile_strength_1_mpa = 1500e6\ncompressive_strength_1_mpa = 1500.0\ntensile_strength_2_mpa = 40.0\n\
    compressive_strength_2_mpa = 246.0\nshear_strength_12_mpa = 68.0\n[[ply]]\nthickness_mm = 0.125\n\n";

/// A weight in mm/s² before other actions, and the density that it takes.
const HEAVY: &str =
    "[[action]]\nname = \"weight\"\nkind = \"gravity\"\nacceleration_m_s2 = [0.0, 0.0, -9810.0]\n\n[[action]]";

fn text_of(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(name)).unwrap()
}

/// The scene with a mistake in it.
fn mistaken(base: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text_of(base), |text, (from, to)| match *from {
        "__net__" => with_net(&text, |points| (0..6).map(|k| points[(k % 3) * 2 + k / 3]).collect()),
        "__scale__" => with_net(&text, |points| {
            let factor: f64 = to.parse().unwrap();
            points.iter().map(|point| point.map(|x| factor * x)).collect()
        }),
        from => {
            assert!(text.contains(from), "{base} has no {from}");
            let text = text.replace(from, to);
            // Weight takes a density.
            if *to == HEAVY { text.replace("poissons_ratio", "density_kg_m3 = 1600.0\npoissons_ratio") } else { text }
        }
    })
}

/// The scene of the cone with other control points.
fn with_net(text: &str, change: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>) -> String {
    let (head, rest) = text.split_once("control_points_mm = [").unwrap();
    let (net, tail) = rest.split_once("\n]").unwrap();
    let numbers: Vec<f64> = net
        .split(|c: char| "[], \n".contains(c))
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect();
    let points: Vec<[f64; 3]> = numbers.chunks(3).map(|point| [point[0], point[1], point[2]]).collect();
    format!("{head}control_points_mm = {:?}{tail}", change(&points))
}

fn odd(scene: &Scene) -> Result<Vec<String>, ModelError> {
    let size = Size::of(scene)?;
    let mut odd = oddities(scene, &size);
    let mut stages = Stages::new(scene.clone());
    if let Ok(start) = stages.start() {
        odd.extend(hardly_moved_or_thrown_off(&mut stages, &start, &size));
    }
    Ok(odd)
}

/// Everything that is said of a scene before its run, or the refusal.
fn said(text: &str) -> String {
    let scene = match parse(text, "scene.toml") {
        Ok(scene) => scene,
        Err(error) => return error.plain(),
    };
    let odd = odd(&scene).unwrap_or_default().join("\n");
    odd + &Stages::new(scene).start().err().map(|refusal| refusal.to_string()).unwrap_or_default()
}

#[test]
fn mistakes_of_unit_and_place_are_said_with_their_numbers() {
    assert!(MISTAKES.len() >= 30);
    let silent: Vec<String> = MISTAKES
        .iter()
        .filter_map(|(what, base, changes, pieces)| {
            let said = said(&mistaken(base, changes));
            let is_missing = |piece: &&&str| !said.contains(**piece);
            let missing = pieces.iter().find(is_missing)?;
            Some(format!("{what}: {missing:?} is not in {said:?}"))
        })
        .collect();
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

/// Scenes of a folder in `pipelines/`.
fn scenes(folder: &str) -> Vec<(String, Scene)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(folder);
    let files = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path());
    let name = |file: std::path::PathBuf| format!("{folder}/{}", file.file_name().unwrap().to_str().unwrap());
    let read = |name: String| (parse(&text_of(&name), &name).unwrap_or_else(|error| panic!("{error}")), name);
    files.filter(|file| file.is_file()).map(name).map(read).map(|(scene, name)| (name, scene)).collect()
}

#[test]
fn no_scene_but_the_extremes_looks_odd() {
    for (name, scene) in scenes(".").into_iter().chain(scenes("verification")) {
        assert_eq!(odd(&scene).unwrap(), Vec::<String>::new(), "{name}");
    }
    // Of the extremes those look odd that are in other units, or whose plies or elements are of extreme proportions.
    let is_odd = |(name, scene): (String, Scene)| odd(&scene).is_ok_and(|odd| !odd.is_empty()).then_some(name);
    let mut found: Vec<String> = scenes("extreme").into_iter().filter_map(is_odd).collect();
    found.sort_unstable();
    assert_eq!(
        found,
        [
            "extreme/aspect-1000.toml",
            "extreme/laminate-1000-across.toml",
            "extreme/laminate-1000-along.toml",
            "extreme/laminate-1000-crossed.toml",
            "extreme/length-over-radius-300.toml",
            "extreme/modulus-1e-3.toml",
            "extreme/modulus-1e12.toml",
            "extreme/roof-metres.toml",
            "extreme/roof-micrometres.toml",
            "extreme/units-metres.toml",
            "extreme/units-micrometres.toml",
        ]
    );
}

#[test]
fn the_size_of_a_shell_in_a_line() {
    let line = |name: &str| Size::of(&parse(&text_of(name), name).unwrap()).unwrap().to_string();
    let whole = "box 300 × 16.4 × 4.26 mm, smallest radius 10 mm, R/t 100, L/R 30, E 131000 MPa";
    assert_eq!(line(SPRING), whole);
    assert_eq!(line("baseline-quarter.toml"), whole, "of the whole shell");
    assert_eq!(line(PLIES), "box 200 × 200 × 0 mm, flat, L/t 800, E 10300 to 181000 MPa");
    // By its Gauss points: at the narrow end itself it is 50 / cos 30° = 57.7 mm.
    assert_eq!(line(CONE), "box 100 × 100 × 86.6 mm, smallest radius 58.5 mm, R/t 117, L/R 2.01, E 70000 MPa");
}

/// Numbers in units of the scene's own are not odd, and change no state.
#[test]
fn units_of_its_own_are_said_by_the_scene() {
    let text = mistaken(SPRING, &[("131000.0", "131.0")]);
    assert_ne!(said(&text), "");
    let own = format!("{text}\n[output]\nunits = \"own\"\n");
    assert_eq!(said(&own), "");
    let [scene, own] = [text, own].map(|text| parse(&text, "scene.toml").unwrap());
    assert_eq!(scene.hash(), own.hash());
    assert!(own.to_toml().contains("units = \"own\"") && !scene.to_toml().contains("units"));
}

/// Refusals that follow from the model show the tables that they are about.
#[test]
fn supports_that_do_not_hold_are_shown_in_the_scene() {
    let text = text_of("../tests/verification/scenes/hinges-exchanged.toml");
    let refusal = Stages::new(parse(&text, "scene.toml").unwrap()).start().unwrap_err();
    let (kind, name) = refusal.concerns().unwrap();
    let none: [&str; 0] = [];
    let error = tables_refused(&text, "scene.toml", &none, kind, name, &refusal.to_string()).unwrap();
    insta::assert_snapshot!(error.plain());
    assert!(tables_refused(&text, "scene.toml", &none, "probe", Some("none"), "").is_none());
}
