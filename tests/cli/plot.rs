//! `foldline plot`: which files there are, what stands in them, and what is refused.

use crate::program::{Said, Sandbox};

const ROOF: &str = include_str!("../restart/path.toml");

/// Logs of the roof and of a part of the small tape spring.
fn logs() -> Sandbox {
    let place = Sandbox::new();
    place.write("roof.toml", ROOF);
    place.foldline("run roof.toml -o roof.mcap --quiet").ends(0);
    place.foldline("run small.toml -o spring.mcap --until 4 --quiet").ends(0);
    place
}

fn text(place: &Sandbox, file: &str) -> String {
    String::from_utf8(place.read(file)).unwrap()
}

fn refused(said: Said) -> String {
    said.ends(2).err
}

#[test]
fn curves_by_name() {
    let place = logs();
    let said = place.foldline("plot roof.mcap --x probe.w_c --y load_factor -o one").ends(0);
    assert_eq!(said.out, "one/load_factor-over-w_c.svg\n");
    let svg = text(&place, "one/load_factor-over-w_c.svg");
    assert!(svg.contains("\nw_c (mm)\n") && svg.contains("\nload factor\n") && svg.contains("limit point"));
    // The axis of a probe that moves down ends at 0.
    assert!(svg.contains("\n−10\n") && svg.contains("\n0\n") && !svg.contains("\n10\n"), "{svg}");
    // Of itself a curve begins at the left.
    place.foldline("plot roof.mcap -o two").ends(0);
    assert!(text(&place, "two/load-probe.svg").contains("\n−w_c (mm)\n"));
    place.foldline("plot spring.mcap --y strain_energy_n_mm -o three").ends(0);
    assert!(text(&place, "three/strain_energy-over-rotation.svg").contains("\nstrain energy (N·mm)\n"));
    place.foldline("plot roof.mcap --x=-w_c --y time -o four").ends(0).says(&["four/time-over-minus-w_c.svg"]);
}

#[test]
fn several_logs_in_one_picture() {
    let place = logs();
    place.foldline("run small.toml -o longer.mcap --until 6 --quiet").ends(0);
    let said = place.foldline("plot spring.mcap longer.mcap").ends(0);
    assert_eq!(said.out, "spring/moment-rotation.svg\n", "the mesh is of one log");
    let svg = text(&place, "spring/moment-rotation.svg");
    for name in ["spring", "longer", "Wuest 1954, uniform curvature"] {
        assert_eq!(svg.matches(&format!("\n{name}\n")).count(), 1, "{name}");
    }
    // Names that are the same are told apart by their folders.
    std::fs::create_dir(place.file("old")).unwrap();
    place.write("old/spring.mcap", place.read("spring.mcap"));
    place.foldline("plot spring.mcap old/spring.mcap -o both --y elements").ends(0);
    let svg = text(&place, "both/elements-over-rotation.svg");
    assert!(svg.contains("\nspring.mcap\n") && svg.contains("\nold/spring.mcap\n"));
    place.foldline("plot spring.mcap roof.mcap --x step --y strain_energy -o apart").ends(0);
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let place = logs();
    insta::assert_snapshot!(refused(place.foldline("plot roof.mcap --x tiem")), @"error: roof.mcap has no `tiem` to draw; there are load_factor, step, strain_energy, work, energy_released, path_length, time, total_iterations, iterations, factorizations, elements, elements_1, elements_2, unknowns, negative_pivots, residual, largest_indicator, estimated_error, w_c; did you mean `time`?");
    insta::assert_snapshot!(refused(place.foldline("plot roof.mcap spring.mcap")), @"error: these logs have no curve in common, since the ends of some turn and those of others do not: choose one with --x and --y");
    insta::assert_snapshot!(refused(place.foldline("plot roof.mcap roof.mcap --field displacement")), @"error: --field is for the mesh, which is drawn of one log, and 2 are given");
    insta::assert_snapshot!(refused(place.foldline("plot roof.mcap spring.mcap --animate")), @"error: --animate is for the mesh, which is drawn of one log, and 2 are given");
    assert!(refused(place.foldline("plot roof.mcap --x w_c --step 3")).contains("cannot be used with"));
    assert!(refused(place.foldline("plot roof.mcap --every 3")).contains("--animate"));
    assert!(refused(place.foldline("plot spring.mcap roof.mcap --x w_c")).contains("spring.mcap has no `w_c`"));
    let files = place.logs();
    assert_eq!(files, ["roof.mcap", "spring.mcap"], "nothing is written");
}

#[test]
fn a_picture_says_how_the_shell_is_held_and_loaded() {
    let place = logs();
    place.foldline("plot roof.mcap -o roof").ends(0);
    let svg = text(&place, "roof/mesh.svg");
    for words in [">undeformed<", ">hinged<", ">load<", ">drawn: "] {
        assert!(svg.contains(words), "{words}");
    }
    place.foldline("plot spring.mcap -o spring").ends(0);
    let svg = text(&place, "spring/mesh.svg");
    for words in [">rigid section<", ">given motion<"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(!svg.contains(">plane of symmetry<"), "the whole shell is shown");
}

#[test]
fn the_mesh_is_animated_over_the_load_steps() {
    let place = logs();
    place.foldline("plot spring.mcap --animate --every 2 -o spring").ends(0).says(&["spring/mesh.gif"]);
    let bytes = place.read("spring/mesh.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let mut frames = 0;
    while decoder.next_frame_info().unwrap().is_some() {
        frames += 1;
    }
    let log = place.log("spring.mcap");
    let last = log.entries().last().unwrap().record.report.step;
    assert_eq!(frames, last.div_ceil(2));
    assert_eq!(decoder.width(), 900);
}
