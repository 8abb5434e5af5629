//! `foldline compare`: runs next to each other in 80 columns.

use crate::program::{Said, Sandbox, small_with};

/// A plate that is pulled, which has a probe and no moment.
const PLATE: &str = "[geometry]\nkind = \"plate\"\nlength_mm = 20.0\nwidth_mm = 10.0\n\
    [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
    [mesh]\nelements = [2, 2]\n[load]\nkind = \"steps\"\nincrement = 0.5\n\
    [[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
    [[action]]\nkind = \"force\"\non = [1.0, 0.5]\nforce_n = [0.0, 0.0, 0.4]\n\
    [[probe]]\nname = \"tip\"\nkind = \"displacement\"\non = [1.0, 0.5]\ncomponent = \"z\"\n";

fn pin(name: &str, said: &Said) {
    for line in said.out.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    // No two runs take the same time.
    let lines = said.out.lines().map(|line| if line.starts_with("  wall time s") { "  wall time s …" } else { line });
    let text = lines.collect::<Vec<_>>().join("\n");
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(name, text) });
}

#[test]
fn springs_on_two_meshes_and_one_that_is_not_finished() {
    let place = Sandbox::new();
    place.write("other.toml", small_with(&[("elements = [4, 4]", "elements = [4, 6]")]));
    place.foldline("run small.toml -o small.mcap --quiet").ends(0);
    place.foldline("run other.toml -o other.mcap --quiet").ends(0);
    place.foldline("run small.toml -o part.mcap --quiet --until 4").ends(0);
    pin("springs", &place.foldline("compare small.mcap other.mcap part.mcap small.mcap").ends(0));
}

#[test]
fn shells_that_turn_no_ends_are_compared_by_their_probe() {
    let place = Sandbox::new();
    place.write("thin.toml", PLATE);
    place.write("thick.toml", PLATE.replace("thickness_mm = 0.5", "thickness_mm = 0.505"));
    place.foldline("run thin.toml -o thin.mcap --quiet").ends(0);
    place.foldline("run thick.toml -o thick.mcap --quiet").ends(0);
    pin("plates", &place.foldline("compare thin.mcap thick.mcap").ends(0));
    place.foldline("run small.toml -o small.mcap --quiet --until 1").ends(0);
    let said = place.foldline("compare thin.mcap small.mcap").ends(0);
    said.says(&["not compared: it shows moment (N·mm) over the rotation, and the first tip (mm) over the load factor"]);
}

#[test]
fn the_page_is_that_of_a_report() {
    let place = Sandbox::new();
    place.foldline("run small.toml -o one.mcap --quiet --until 1").ends(0);
    place.foldline("run small.toml -o two.mcap --quiet --until 2").ends(0);
    place.foldline("report one.mcap two.mcap -o report.html").ends(0);
    let said = place.foldline("compare one.mcap two.mcap -o page.html").ends(0).says(&["B has the scene of A"]);
    assert_eq!(said.out.lines().last(), Some("page.html"));
    assert!(place.read("page.html") == place.read("report.html"));
    let said = place.foldline("compare one.mcap two.mcap -o page.html").ends(2);
    assert!(said.out.is_empty() && said.err.contains("page.html exists and is not overwritten"), "{}", said.err);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let place = Sandbox::new();
    place.foldline("compare small.toml").ends(2);
    let said = place.foldline("compare nothing.mcap small.toml").ends(2);
    assert!(said.err.contains("nothing.mcap"), "{}", said.err);
}
