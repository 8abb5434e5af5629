//! Questions to logs: where two part, where one jumped, when a condition first holds.

use crate::program::{SMALL, Sandbox, Straight, small_with};

#[test]
fn runs_on_one_thread_and_on_two_are_the_same() {
    let place = Sandbox::new();
    place.write("two.mcap", &Straight::small().bytes);
    place.foldline("run small.toml -o one.mcap --threads 1 --quiet").ends(0);
    let said = place.foldline("bisect one.mcap two.mcap").ends(0);
    said.says(&[&format!("the same: all {} stages", Straight::small().stages), "threads: 1 and 2"]);
    place.write("part.mcap", Straight::small().cut_after(20));
    let said = place.foldline("bisect one.mcap part.mcap").ends(0);
    said.says(&["the same as far as both go: one.mcap holds", "part.mcap holds 20"]);
}

/// The first stage that differs, found in logarithmic looks, is the one that reading front to back finds.
#[test]
fn scenes_that_differ_part_where_the_difference_first_tells() {
    let whole = Straight::small();
    let limits = (whole.stages as f64).log2().ceil() as usize + 1;
    let changes = [
        // Tighter, and so nothing differs until a solve would have stopped earlier.
        ("[solver]", "[solver]\ntolerance = 1e-9", "scene: solver.tolerance is 1e-7 and 1e-9"),
        ("snap_tolerance_deg = 0.1", "snap_tolerance_deg = 0.3", "scene: solver.snap_tolerance_deg is 0.1 and 0.3"),
        ("threshold = 0.019", "threshold = 0.03", "scene: adapt.threshold is 0.019 and 0.03"),
        ("thickness_mm = 0.1", "thickness_mm = 0.1001", "scene: material.thickness_mm is 0.1 and 0.1001"),
        ("increment_deg = 2.0", "increment_deg = 1.0", "scene: load.increment_deg is 2.0 and 1.0"),
    ];
    for (from, to, scenes) in changes {
        let place = Sandbox::new();
        place.write("a.mcap", &whole.bytes);
        place.write("small.toml", small_with(&[(from, to)]));
        place.foldline("run small.toml -o b.mcap --quiet").ends(0);
        let said = place.foldline("bisect a.mcap b.mcap").ends(1).says(&[scenes]);
        let (a, b) = (whole.log(), place.log("b.mcap"));
        let state = |log: &foldline::journal::Log, index: usize| log.entries()[index].record.commit.state_hash;
        let first = (0..a.entries().len()).find(|index| state(&a, *index) != state(&b, *index)).unwrap();
        let report = &a.entries()[first].record.report;
        let place = format!("part at stage {first}: step {} {} at", report.step, report.stage);
        assert!(said.out.starts_with(&place), "{place}\n{}", said.out);
        let looks: usize = number_after(&said.out, "(found in ") as usize;
        assert!(looks <= limits, "{looks} looks");
        if from == "thickness_mm = 0.1" {
            // The worst field first, with its values and its place.
            let worst = said.out.lines().nth(1).unwrap();
            let known = ["moment_n_mm", "strain_energy_n_mm", "displacement"];
            assert!(known.iter().any(|field| worst.trim().starts_with(field)), "{worst}");
            assert!(said.out.contains("bits agree") && said.out.contains("at control point ("), "{}", said.out);
        }
    }
}

/// The number behind a piece of text.
fn number_after(text: &str, piece: &str) -> f64 {
    let (_, rest) = text.split_once(piece).unwrap_or_else(|| panic!("no {piece:?} in {text}"));
    let end = rest.find(|c: char| !"+-.e0123456789".contains(c)).unwrap_or(rest.len());
    rest[..end].parse().unwrap_or_else(|_| panic!("no number behind {piece:?} in {text}"))
}

/// The bracket is as narrow as asked for, lies where the run found it, and the numbers go with one another.
#[test]
fn the_snap_is_located() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    let log = whole.log();
    let jump = log.entries().iter().position(|entry| entry.record.report.jumped).unwrap();
    let beyond = &log.entries()[jump].record.report;
    let before = log.entries()[..jump].iter().rev().map(|entry| &entry.record.report);
    let below = before.clone().find(|report| report.parameter < beyond.parameter).unwrap();
    let mut critical = None;
    for (option, tolerance) in [("", 1e-4), ("--tolerance 0.01", 0.01), ("--tolerance 1e-5", 1e-5)] {
        let text = place.foldline(&format!("bisect run.mcap --snap {option}")).ends(0).out;
        let [low, high] = [number_after(&text, "critical rotation    "), number_after(&text, "° to ")];
        // Six decimals are printed.
        assert!(low < high && high - low <= tolerance + 2e-6, "{text}");
        assert!(below.parameter <= low && high <= beyond.parameter + 1e-6, "{text}");
        let [moment, after] = [number_after(&text, "moment               "), number_after(&text, "before, ")];
        assert!((moment / below.moment_n_mm - 1.0).abs() < 0.05, "{text}");
        assert!(after > 0.0 && after < 0.5 * moment, "{text}");
        let [released, energy] =
            [number_after(&text, "energy released      "), number_after(&text, "strain energy before: ")];
        assert!(released > 0.0 && released < energy, "{text}");
        assert!((released / beyond.energy_released_n_mm.unwrap() - 1.0).abs() < 0.1, "{text}");
        let pivots = number_after(&text, "negative pivots      ");
        let [most, end] = [number_after(&text, "up to "), number_after(&text, "on the way, ")];
        assert!(pivots == 0.0 && most >= 1.0 && end == 0.0, "{text}");
        let eigenvalue = number_after(&text, "eigenvalue ");
        assert!(eigenvalue > 0.0, "the last stable state is stable: {text}");
        // Brackets of one snap, coarse and fine, have it between them.
        let [coarse_low, coarse_high] = *critical.get_or_insert([low, high]);
        assert!(low <= coarse_high + 1e-6 && high >= coarse_low - 1e-6, "{text}");
    }
    assert_eq!(place.read("run.mcap"), whole.bytes);
    place.foldline("run small.toml -o short.mcap --until 6").ends(0);
    place.foldline("bisect short.mcap --snap").ends(1).says(&["no stage of this log jumped", "is at 6°"]);
    place.foldline("bisect run.mcap --snap --tolerance 0").ends(2);
}

/// The first stage for which a condition holds, and the one before it.
#[test]
fn conditions() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    let log = whole.log();
    let when = |condition: &str| {
        let output = place.command("bisect run.mcap --when").arg(condition).output().unwrap();
        crate::program::Said::new(condition, output)
    };
    let report = |index: usize| &log.entries()[index].record.report;
    let first = |holds: &dyn Fn(usize) -> bool| (0..whole.stages).find(|index| holds(*index)).unwrap();
    let cases: [(&str, usize); 8] = [
        ("moment_n_mm < 100", 0),
        ("moment_n_mm < 100 and step > 3", first(&|i| report(i).moment_n_mm < 100.0 && report(i).step > 3)),
        ("rotation_deg >= 10", first(&|i| report(i).parameter >= 10.0)),
        ("elements > 16", first(&|i| report(i).elements.count() > 16)),
        ("elements_1 == 10", first(&|i| report(i).elements.each()[0][0] == 10)),
        ("jumped == true", first(&|i| report(i).jumped)),
        ("outcome != done", first(&|i| report(i).outcome != foldline::record::Outcome::Done)),
        ("stage == refine-knots", first(&|i| report(i).stage == foldline::scene::Stage::RefineKnots)),
    ];
    for (condition, index) in cases {
        let said = when(condition).ends(0);
        let last = said.out.lines().rev().find(|line| !line.trim().is_empty()).unwrap().trim().to_owned();
        assert!(last.starts_with(&format!("{index} ")), "{condition}: stage {index} and not\n{}", said.out);
    }
    when("moment_n_m < 100").ends(2).says(&["reports have no field `moment_n_m`; they have", "moment_n_mm"]);
    when("moment_n_mm").ends(2).says(&["`moment_n_mm` compares nothing", "moment_n_mm < 100"]);
    when("moment_n_mm < much").ends(2).says(&["`much` is not a number, and moment_n_mm holds a number"]);
    when("stage < solve").ends(2).says(&["stage holds a word: compare it with == or !="]);
    when("step > 99").ends(1).says(&["no stage of run.mcap meets the condition `step > 99`"]);
    // A word that no report can hold is a typo, not a condition that never holds.
    when("stage == sovle").ends(2).says(&["`sovle`", "re-equilibrate"]);
    when("outcome == finished").ends(2).says(&["`finished`", "rejected-jump"]);
}

#[test]
fn one_question_at_a_time() {
    let place = Sandbox::new();
    place.write("run.mcap", &Straight::small().bytes);
    place.foldline("bisect run.mcap").ends(2);
    place.foldline("bisect run.mcap --snap --when step>3").ends(2);
    place.foldline("bisect run.mcap run.mcap --snap").ends(2);
    place.foldline("bisect run.mcap none.mcap").ends(2).says(&["none.mcap", "No such file"]);
    place.write("scene.mcap", SMALL);
    place.foldline("bisect run.mcap scene.mcap").ends(1).says(&["this is not a log"]);
}

/// Fields are called by what they are in every scene: a load factor is no rotation.
#[test]
fn a_load_factor_is_not_called_a_rotation() {
    let roof = include_str!("path.toml").split("[continuation]").next().unwrap();
    let place = Sandbox::new();
    place.write("one.toml", roof);
    place.write("other.toml", roof.replace("increment = 0.2", "increment = 0.125"));
    for scene in ["one", "other"] {
        place.foldline(&format!("run {scene}.toml -o {scene}.mcap --until 0.5 --quiet")).ends(0);
    }
    let said = place.foldline("bisect one.mcap other.mcap");
    assert!(!said.out.contains("deg"), "{}", said.out);
}
