//! The scenes in `pipelines/`: all parse, and say what their names say.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use foldline::scene::{Geometry, Indicator, LengthLimit, Material, Quadrature, Scene, Sense, Stage, Symmetry, parse};
use foldline::study::StudyFile;

fn read(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(name);
    let text = fs::read_to_string(&path).unwrap();
    parse(&text, name).unwrap_or_else(|error| panic!("{error}"))
}

fn sizes(scene: &Scene) -> [f64; 3] {
    let Geometry::TapeSpring { length_mm, radius_mm, .. } = scene.geometry else { panic!() };
    [length_mm, radius_mm, scene.material.thickness_mm()]
}

#[test]
fn every_scene_parses_and_opens_with_what_it_shows() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(name.ends_with(".toml"), "{name} is no scene");
        read(name);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.lines().take(2).all(|line| line.starts_with("# ")), "{name} does not say what it shows");
        count += 1;
    }
    assert!(count >= 9);
}

#[test]
fn the_cases_of_the_paper_differ_from_the_baseline_in_their_sizes_alone() {
    let baseline = read("baseline.toml");
    assert_eq!(sizes(&baseline), [300.0, 10.0, 0.1]);
    assert_eq!(baseline.end_rotation().unwrap().sense, Sense::Opposite);
    assert_eq!(baseline.mesh.elements, [4, 4]);
    assert_eq!(baseline.mesh.quadrature, Quadrature::Balanced);
    assert_eq!(baseline.pipeline, Stage::REFINING);
    assert_eq!(baseline.adapt.as_ref().unwrap().length_limit, LengthLimit::SqrtRadiusThickness);
    let cases = [
        ("length-150.toml", [150.0, 10.0, 0.1]),
        ("length-600.toml", [600.0, 10.0, 0.1]),
        ("radius-6-thickness-0.15.toml", [300.0, 6.0, 0.15]),
        ("radius-15-thickness-0.06.toml", [300.0, 15.0, 0.06]),
        ("radius-15.toml", [300.0, 15.0, 0.1]),
        ("radius-20.toml", [300.0, 20.0, 0.1]),
    ];
    for (name, expected) in cases {
        let scene = read(name);
        assert_eq!(sizes(&scene), expected, "{name}");
        for difference in baseline.differences(&scene) {
            let path = difference.path.as_str();
            assert!(
                ["geometry.length_mm", "geometry.radius_mm", "material.thickness_mm"].contains(&path),
                "{name}: {path}"
            );
        }
    }
}

#[test]
fn the_quarter_model_is_the_baseline_cut_twice() {
    let differences = read("baseline.toml").differences(&read("baseline-quarter.toml"));
    let paths: Vec<_> = differences.iter().map(|difference| difference.path.as_str()).collect();
    assert_eq!(paths, ["symmetry.part"]);
}

#[test]
fn the_uniform_scene_has_no_stage_that_refines() {
    let uniform = read("baseline-uniform.toml");
    assert_eq!(uniform.pipeline, [Stage::Solve]);
    assert_eq!(uniform.adapt, None);
    assert_eq!(uniform.symmetry, Symmetry::Quarter);
    assert_eq!(uniform.mesh.elements, [128, 16]);
}

/// Studies find their scenes, and every run of them is a scene that parses.
#[test]
fn every_study_can_be_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines/studies");
    let mut structures = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let study = StudyFile::parse(&fs::read_to_string(&path).unwrap(), "study.toml").unwrap();
        for structure in &study.structure {
            let runs = study
                .runs(structure, &folder, &|path| fs::read_to_string(path))
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(runs.len() > 10 && structure.published.is_some(), "{}", structure.name);
            structures += 1;
        }
    }
    assert_eq!(structures, 9, "three tables of three");
}

/// A scene of geometry, material and load alone is refined and coarsened by the error that its mesh causes; one that says how
/// many elements it has is not.
#[test]
fn a_scene_may_leave_its_mesh_to_the_program() {
    let baseline = include_str!("../../pipelines/baseline.toml");
    let until = |text: &str, section: &str| text[..text.find(section).unwrap()].to_owned();
    let load = &baseline[baseline.find("[load]").unwrap()..baseline.find("[adapt]").unwrap()];
    let plain = until(baseline, "[mesh]") + load;
    let parsed = |text: &str| parse(text, "plain.toml");
    let scene = parsed(&plain).unwrap();
    assert_eq!((scene.mesh.degree, scene.mesh.elements), ([3, 5], [4, 4]));
    let adapt = scene.adapt.unwrap();
    assert_eq!((adapt.indicator, adapt.length_limit), (Indicator::Error(0.01), LengthLimit::Thickness));
    assert_eq!(scene.pipeline, [&Stage::REFINING[..], &[Stage::CoarsenKnots]].concat());
    let uniform = parsed(&(plain.clone() + "[mesh]\nelements = [16, 8]\n")).unwrap();
    assert_eq!((uniform.mesh.degree, uniform.adapt, &uniform.pipeline[..]), ([3, 3], None, &[Stage::Solve][..]));
    let by_threshold = parsed(&(plain.clone() + "[adapt]\nthreshold = 0.02\n")).unwrap();
    assert_eq!(by_threshold.adapt.unwrap().indicator, Indicator::BendingStrain([0.02, 0.02]));
    assert_eq!(by_threshold.pipeline, Stage::REFINING);
    for refused in ["[pipeline]\nstages = [\"solve\"]\n", "[continuation]\ncontrol = \"arc-length\"\n"] {
        assert!(parsed(&(plain.clone() + refused)).unwrap_err().to_string().contains("`elements`"), "{refused}");
    }
}

/// What [material] says of a laminate holds for plies that say nothing of it, each key on its own.
#[test]
fn plies_take_from_their_material_what_they_lack() {
    let text = r#"
        [geometry]
        kind = "plate"
        length_mm = 10.0
        width_mm = 5.0
        [material]
        kind = "laminate"
        thermal_expansion_1_per_k = 1e-6
        thermal_expansion_2_per_k = 2e-6
        poissons_ratio_12 = 0.3
        density_kg_m3 = 1600.0
        [[ply]]
        thickness_mm = 0.1
        youngs_modulus_1_mpa = 1e5
        youngs_modulus_2_mpa = 1e4
        shear_modulus_12_mpa = 5e3
        density_kg_m3 = 1500.0
        [mesh]
        elements = [2, 2]
        [load]
        kind = "steps"
        increment = 1.0
        [[support]]
        on = "u-start"
        kind = "clamped"
        [[action]]
        kind = "temperature"
        change_k = 1.0
    "#;
    let Material::Laminate { plies, .. } = parse(text, "laminate.toml").unwrap().material else { panic!("a laminate") };
    assert_eq!(plies[0].law.thermal_expansion_2_per_k, Some(2e-6));
    assert_eq!((plies[0].law.poissons_ratio_12, plies[0].density_kg_m3), (0.3, Some(1500.0)));
    let error = parse(&text.replace("youngs_modulus_2_mpa = 1e4", ""), "laminate.toml").unwrap_err().to_string();
    assert!(error.contains("[[ply]] 1 lacks `youngs_modulus_2_mpa`"), "{error}");
}

/// What the JSON Schema refuses as well (`tests/cli/schema.py`).
#[test]
fn wrong_scenes_are_refused() {
    #[derive(serde::Deserialize)]
    struct Base {
        scene: String,
        slips: Vec<[String; 2]>,
    }
    let bases: BTreeMap<String, Base> = toml::from_str(include_str!("wrong_scenes.toml")).unwrap();
    let mut count = 0;
    for Base { scene, slips } in bases.values() {
        parse(scene, "right.toml").unwrap();
        for [right, wrong] in slips {
            assert_eq!(scene.matches(right).count(), 1, "`{right}` does not name one place");
            assert!(parse(&scene.replace(right, wrong), "wrong.toml").is_err(), "`{wrong}` is taken");
            count += 1;
        }
    }
    assert!(count >= 50, "{count}");
}

/// What a log keeps of a scene with a surface from a file is the scene written out.
#[test]
fn every_scene_written_out_is_the_same_scene() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders =
        ["pipelines", "pipelines/extreme", "pipelines/verification", "tests/restart", "tests/verification/scenes"];
    let entries = folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).unwrap());
    let mut count = 0;
    for path in
        entries.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|it| it == "toml"))
    {
        let Ok(scene) = parse(&fs::read_to_string(&path).unwrap(), path.to_str().unwrap()) else { continue };
        let again = parse(&scene.to_toml(), "written.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((again.hash(), &again), (scene.hash(), &scene), "{}", path.display());
        count += 1;
    }
    assert!(count >= 80, "{count}");
}
