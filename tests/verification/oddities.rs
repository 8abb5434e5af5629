//! Mistakes of unit and place are said or refused with their numbers, and no scene that is meant as it stands is.

use std::path::Path;

use foldline::model::{ModelError, Size, oddities};
use foldline::pipeline::Stages;
use foldline::scene::{Scene, parse};

const SPRING: &str = "baseline.toml";
const ROOF: &str = "verification/hinged-roof-12.7.toml";
const PLIES: &str = "verification/cured-plate.toml";
const CONE: &str = "verification/cone-pressure.toml";
const ZONE: &str = "verification/sphere-zone-pressure.toml";
const NET: &str = "../tests/verification/scenes/net-u-fastest.toml";
const STRIP: &str = "verification/cantilever-end-shear.toml";

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
];

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
    Ok(oddities(scene, &Size::of(scene)?))
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
