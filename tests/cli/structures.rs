//! What is shown of structures of several shells: exports, pictures and pages have all of them.

use crate::program::Sandbox;

/// A strip on a longer one, glued, under an end load.
const SCENE: &str = "[[shell]]\nname = \"long\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 60.0\nwidth_mm = 10.0\n\
    [shell.mesh]\nelements = [6, 1]\n[[shell]]\nname = \"short, thick\"\nposition_mm = [0.0, 0.0, 1.0]\n\
    [shell.geometry]\nkind = \"plate\"\nlength_mm = 40.0\nwidth_mm = 10.0\n[shell.mesh]\nelements = [4, 2]\n\
    [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 1.0\n\
    [[bond]]\nname = \"glue\"\nshells = [\"long\", \"short, thick\"]\nstiffness = 0.1\n\
    [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 0.5\n\
    [[support]]\nname = \"root\"\nkind = \"clamped\"\nshell = \"long\"\non = \"u-start\"\n\
    [[action]]\nkind = \"line-force\"\nshell = \"long\"\non = \"u-end\"\nforce_n_per_mm = [0.0, 0.0, 0.1]\n";

fn sandbox() -> Sandbox {
    let place = Sandbox::new();
    place.write("glued.toml", SCENE);
    place.foldline("run glued.toml -o glued.mcap").ends(0);
    place
}

fn text(place: &Sandbox, file: &str) -> String {
    String::from_utf8(place.read(file)).unwrap()
}

#[test]
fn tables_have_a_row_for_each_point_of_every_shell() {
    let place = sandbox();
    let fields = "--points 2 --fields bond_peel,displacement";
    place.foldline(&format!("export glued.mcap --to csv -o t.csv {fields}")).ends(0);
    let csv = text(&place, "t.csv");
    assert!(csv.starts_with("shell,element_u,"), "{csv}");
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    assert_eq!(rows.len(), 4 * (6 + 8));
    let of = |name: &str| rows.iter().filter(|row| row.starts_with(name)).count();
    assert_eq!([of("long,"), of("\"short, thick\",")], [4 * 6, 4 * 8]);
    // Two elements of the longer strip lie beyond the other one; where its end lies they touch it.
    assert_eq!(rows.iter().filter(|row| row.ends_with(",NaN")).count(), 6);
    place.foldline(&format!("export glued.mcap --to json -o t.json {fields}")).ends(0);
    let json: serde_json::Value = serde_json::from_slice(&place.read("t.json")).unwrap();
    let points = json["points"].as_array().unwrap();
    assert_eq!((points[0]["shell"].as_str(), points[24]["shell"].as_str()), (Some("long"), Some("short, thick")));
    assert_eq!(points.iter().filter(|point| point["bond_peel"][0].is_null()).count(), 6);
}

#[test]
fn other_formats_have_all_shells_or_the_one_that_is_named() {
    let place = sandbox();
    place.foldline("export glued.mcap --to vtu -o p --steps 1").ends(0);
    let xml = text(&place, "p/glued-00001.vtu");
    assert!(
        xml.contains("NumberOfCells=\"14\"") && xml.contains("Name=\"shell\"") && xml.contains("Name=\"shell_names\"")
    );
    place.foldline("export glued.mcap --to vtu -o one --steps 1 --shell long").ends(0);
    let xml = text(&place, "one/glued-00001.vtu");
    assert!(xml.contains("NumberOfCells=\"6\"") && !xml.contains("Name=\"shell\"") && xml.contains("bond_peel"));
    place.foldline("export glued.mcap --to stl -o t.stl --points 3").ends(0);
    assert_eq!(place.read("t.stl").len(), 84 + 50 * (6 + 8) * 8);
    place.foldline("export glued.mcap --to step -o t.step").ends(0);
    let step = text(&place, "t.step");
    assert_eq!([step.matches("=OPEN_SHELL").count(), step.matches("ADVANCED_FACE").count()], [2, 2]);
    assert!(step.contains("OPEN_SHELL('short, thick'"), "{step}");
    place.foldline("export glued.mcap --to npz -o t.npz").ends(0);
    let bytes = place.read("t.npz");
    let has = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(has("long.control_points.npy") && has("short, thick.displacement.npy") && has("load_factor.npy"));
    place
        .foldline("export glued.mcap --to csv --shell shrot")
        .ends(2)
        .says(&["no shell \"shrot\"", "long, short, thick"]);
    place.foldline("export glued.mcap --to mcap --shell long").ends(2).says(&["--shell", "all shells"]);
}

#[test]
fn what_is_glued_is_drawn_listed_and_told() {
    let place = sandbox();
    assert!(place.foldline("export glued.mcap --list-fields").ends(0).out.contains("bond_shear"));
    // A vector has a length.
    place.foldline("plot glued.mcap -o s --field bond_shear").ends(0);
    let svg = text(&place, "s/mesh.svg");
    assert!(svg.contains("bond shear (MPa)"), "{svg}");
    place.foldline("plot glued.mcap -o n --field bond_peel").ends(0);
    place.foldline("export glued.mcap --to mcap --fields bond_peel").ends(0);
    let said = place.foldline("inspect glued.mcap --step 1").ends(0).out;
    assert!(said.contains("glue: ") && said.contains("peel at most ") && said.contains("shear at most "), "{said}");
}
