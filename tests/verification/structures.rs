//! Structures of several shells: joined, glued, and held by common sections.

use foldline::energy::Terms;
use foldline::equilibrium::{Configuration, Workspace, linear_buckling};
use foldline::model::{ModelError, starting_mesh};
use foldline::pipeline::Stages;
use foldline::scene::{Scene, parse};
use foldline::state::State;
use rayon::ThreadPoolBuilder;

use crate::support::{reading, run, scene, steps};

fn read(text: &str) -> Scene {
    parse(text, "structure.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Two strips at a right angle under a dead force at the end of the arm: tip and corner of a planar inextensible elastica (ODE, tolerance
/// 1e-11), c = F L²/EI.
#[test]
fn a_right_angle_frame_is_two_elasticas() {
    const TABLE: [[f64; 4]; 5] = [
        [0.25, 7.43588, -34.07199, 13.07854],
        [0.5, 6.12420, -62.27313, 24.92985],
        [0.75, 1.41652, -81.94864, 34.34033],
        [1.0, -3.52330, -95.70977, 41.80920],
        [1.5, -11.25040, -114.06345, 53.13337],
    ];
    let stages = run(scene("structures/right-angle-frame.toml"));
    for [at, tip_x, tip_y, corner_x] in TABLE {
        let (_, record) = stages.iter().find(|(state, _)| state.parameter == at).unwrap();
        let found = ["tip ux", "tip uy", "corner ux"].map(|name| reading(&record.report, name));
        for (found, expected) in found.into_iter().zip([tip_x, tip_y, corner_x]) {
            assert!((found - expected).abs() < 0.1, "{at}: {found} {expected}: 0.1 % of the arm");
        }
        let [corner] = &record.report.connections[..] else { panic!("one joint") };
        assert!(corner.opened_deg.unwrap().abs() < 0.01, "{corner:?}");
        assert!(corner.energy_share < 1e-3, "{corner:?}");
    }
}

/// A strip, or the same cut in two at half its length, each with its part of the elements.
fn strip(is_cut: bool, second: &str) -> Scene {
    let shells = match is_cut {
        false => "[geometry]\nkind = \"plate\"\nlength_mm = 40.0\nwidth_mm = 10.0\n[mesh]\ndegree = [4, 3]\nelements = [8, 3]\nquadrature = \"full\"\n".to_owned(),
        true => format!(
            "[[shell]]\nname = \"one\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 20.0\nwidth_mm = 10.0\n\
             [shell.mesh]\ndegree = [4, 3]\nelements = [4, 3]\nquadrature = \"full\"\n[[shell]]\nname = \"two\"\nposition_mm = [20.0, 0.0, 0.0]\n\
             [shell.geometry]\nkind = \"plate\"\nlength_mm = 20.0\nwidth_mm = 10.0\n[shell.mesh]\ndegree = [4, 3]\n\
             quadrature = \"full\"\nelements = {second}\n\
             [[joint]]\nkind = \"smooth\"\nedges = [\"one.u-end\", \"two.u-start\"]\n"
        ),
    };
    let [first, last] = if is_cut { ["shell = \"one\"", "shell = \"two\""] } else { [""; 2] };
    read(&format!(
        "{shells}\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\nthickness_mm = 0.5\n\
         [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 0.5\n\
         [[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n{first}\n\
         [[action]]\nkind = \"line-force\"\non = \"u-end\"\nforce_n_per_mm = [0.0, 0.05, 0.4]\n{last}\n\
         [[probe]]\nname = \"w\"\nkind = \"displacement\"\non = [1.0, 1.0]\ncomponent = \"z\"\n{last}\n"
    ))
}

/// With one quadrature inside and at edges, a shell that is cut in two has the functions of the whole one: to rounding where the edges conform, nearly where they do not.
#[test]
fn a_smooth_joint_is_not_seen() {
    let end = |scene: Scene| run(scene).pop().unwrap().1.report;
    let whole = end(strip(false, ""));
    let w = reading(&whole, "w");
    assert!(w > 10.0, "it bends far: {w}");
    let cut = end(strip(true, "[4, 3]"));
    assert!((reading(&cut, "w") / w - 1.0).abs() < 1e-9, "{} {w}", reading(&cut, "w"));
    assert!((cut.strain_energy_n_mm / whole.strain_energy_n_mm - 1.0).abs() < 1e-9);
    assert!(cut.connections.is_empty(), "control points are shared");
    let not_conforming = end(strip(true, "[5, 4]"));
    // A tenth of a per cent is what is asked of joints that do not conform; the finer side bends a little more on its own.
    assert!((reading(&not_conforming, "w") / w - 1.0).abs() < 1e-3, "{} {w}", reading(&not_conforming, "w"));
    assert!(not_conforming.connections[0].energy_share < 1e-3, "{:?}", not_conforming.connections);
    // Knots that are nested are passed on.
    let mesh = starting_mesh(&strip(true, "[4, 6]")).unwrap();
    assert_eq!(mesh.elements().each(), [[4, 6], [4, 6]]);
}

/// An arc of 110 degrees in one shell and in two or three, joined along generators: parts have other rational functions than the whole.
#[test]
fn an_arc_in_parts_is_the_arc() {
    let bent = |parts: usize| {
        let arc = 110.0 / parts as f64;
        let mut shells = String::new();
        for k in 0..parts {
            shells += &format!(
                "[[shell]]\nname = \"s{k}\"\n[shell.geometry]\nkind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 10.0\n\
                 arc_deg = {arc:?}\nfrom_deg = {:?}\n[shell.mesh]\nelements = [8, {}]\n",
                -55.0 + arc * k as f64,
                12 / parts
            );
        }
        for k in 1..parts {
            shells += &format!("[[joint]]\nkind = \"smooth\"\nedges = [\"s{}.v-end\", \"s{k}.v-start\"]\n", k - 1);
        }
        let edges = |edge: &str| {
            let all: Vec<String> = (0..parts).map(|k| format!("\"s{k}.{edge}\"")).collect();
            format!("edges = [{}]", all.join(", "))
        };
        let scene = read(&format!(
            "{shells}[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 131000.0\npoissons_ratio = 0.3\nthickness_mm = 0.1\n\
             [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 0.5\n\
             [[support]]\nname = \"root\"\nkind = \"clamped\"\n{}\n\
             [[support]]\nname = \"tip\"\nkind = \"rigid\"\n{}\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
             [[action]]\nkind = \"section-moment\"\nsection = \"tip\"\nmoment_n_mm = 150.0\nabout = \"y\"\nforces_along = \"x\"\n",
            edges("u-start"),
            edges("u-end")
        ));
        run(scene).pop().unwrap().1.report
    };
    let [one, two, three] = [1, 2, 3].map(bent);
    for part in [&two, &three] {
        assert!((part.strain_energy_n_mm / one.strain_energy_n_mm - 1.0).abs() < 1e-3, "{part:?}");
        assert_eq!(part.negative_pivots, 0);
        assert!(part.connections.is_empty());
    }
}

/// Two strips of 0.1 mm glued face to face are one of 0.2 mm, however the elements lie.
#[test]
fn glued_strips_are_one() {
    let glued = |upper: &str| {
        let scene = read(&format!(
            "[[shell]]\nname = \"lower\"\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 10.0\n\
             [[shell]]\nname = \"upper\"\nposition_mm = [0.0, 0.0, 0.1]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 100.0\n\
             width_mm = 10.0\n[shell.mesh]\nelements = {upper}\n\
             [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 131000.0\npoissons_ratio = 0.0\nthickness_mm = 0.1\n\
             [mesh]\nelements = [8, 1]\n[[bond]]\nshells = [\"lower\", \"upper\"]\n\
             [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
             [[support]]\nname = \"root\"\nkind = \"clamped\"\nedges = [\"lower.u-start\", \"upper.u-start\"]\n\
             [[action]]\nkind = \"line-force\"\nshell = \"lower\"\non = \"u-end\"\nforce_n_per_mm = [0.0, 0.0, 1e-5]\n\
             [[probe]]\nname = \"w\"\nkind = \"displacement\"\nshell = \"upper\"\non = [1.0, 0.5]\ncomponent = \"z\"\n"
        ));
        reading(&run(scene).pop().unwrap().1.report, "w")
    };
    let beam = 1e-4 * 100_f64.powi(3) / (3.0 * 131_000.0 * 10.0 * 0.2_f64.powi(3) / 12.0);
    for upper in ["[8, 1]", "[11, 2]"] {
        let w = glued(upper);
        assert!((w / beam - 1.0).abs() < 1e-3, "{upper}: {w} {beam}");
    }
}

/// The boom of the shipped scene with its rigid end loaded about y or z; dM/dθ of the linear solution, N·mm.
fn trac_stiffness(elements: [usize; 2], about: &str) -> f64 {
    let text = include_str!("../../pipelines/structures/trac-boom.toml");
    let text = match about {
        "z" => text
            .replace("z_mm = \"free\"\nrotation_y_deg = \"free\"", "y_mm = \"free\"\nrotation_z_deg = \"free\"")
            .replace("about = \"y\"", "about = \"z\""),
        _ => text.to_owned(),
    };
    let text = text
        .replace("moment_n_mm = 700.0", "moment_n_mm = 0.01")
        .replace("increment = 0.1", "increment = 1.0")
        .replace("elements = [30, 9]", &format!("elements = {elements:?}"));
    let report = run(read(&text)).pop().unwrap().1.report;
    0.01 * 0.01 / (2.0 * report.strain_energy_n_mm)
}

/// An independent isogeometric solver on 90 elements along the boom: 85145.3 and 72887.8 N·mm; beam theory 85076 and 72840.
#[test]
fn a_trac_boom_is_as_stiff_as_by_another_solver() {
    let [y, z] = ["y", "z"].map(|about| trac_stiffness([24, 9], about));
    assert!((y / 85_145.3 - 1.0).abs() < 5e-3, "{y}");
    assert!((z / 72_887.8 - 1.0).abs() < 5e-3, "{z}");
}

/// Linear buckling of the boom held at its end, by an independent solver: 825.40, 825.45, 836.61 N·mm on 90 elements along it.
#[test]
#[ignore = "half a minute"]
fn a_trac_boom_buckles_where_another_solver_says() {
    let mut boom = scene("structures/trac-boom.toml");
    boom.shells.iter_mut().for_each(|shell| shell.mesh.elements = [90, 15]);
    let start = Stages::new(boom.clone()).start().unwrap();
    let mut work = Workspace::new(&boom, &start.mesh).unwrap();
    let found = linear_buckling(&mut work, Configuration::of(&start), 3).unwrap();
    let moments: Vec<f64> = found.modes.iter().map(|mode| 700.0 * mode.factor).collect();
    println!("{moments:?}, counted {}", found.counted);
    assert_eq!(found.counted, 3);
    for (found, expected) in moments.iter().zip([825.40, 825.45, 836.61]) {
        assert!((found / expected - 1.0).abs() < 1e-2, "{moments:?}");
    }
}

/// Euler's column, pushed by a dead force on a section that may turn, and clamped at the other end: π² EI/(4 L²), 3² and 5² times that.
#[test]
fn a_column_buckles_at_the_loads_of_euler() {
    let column = read(
        "[geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 5.0\n\
         [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.0\nthickness_mm = 0.5\n\
         [mesh]\nelements = [12, 1]\n[load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n\
         [[support]]\nname = \"root\"\nkind = \"clamped\"\non = \"u-start\"\n\
         [[support]]\nname = \"tip\"\nkind = \"rigid\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
         [[action]]\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [-1.0, 0.0, 0.0]\n",
    );
    let start = Stages::new(column.clone()).start().unwrap();
    let mut work = Workspace::new(&column, &start.mesh).unwrap();
    let found = linear_buckling(&mut work, Configuration::of(&start), 3).unwrap();
    let euler = std::f64::consts::PI.powi(2) * 70_000.0 * 5.0 * 0.5_f64.powi(3) / 12.0 / (4.0 * 100.0 * 100.0);
    assert_eq!(found.counted, 3);
    for (mode, times) in found.modes.iter().zip([1.0, 9.0, 25.0]) {
        assert!((mode.factor / (times * euler) - 1.0).abs() < 2e-3, "{} {}", mode.factor, times * euler);
    }
}

/// A column beside one that is pulled a thousand times as hard: eight modes of the reversed load lie nearer to 0 than its own.
#[test]
fn a_mode_behind_many_of_the_reversed_load_is_found() {
    let shell = |name: &str, aside: f64| {
        format!(
            "[[shell]]\nname = \"{name}\"\nposition_mm = [0.0, {aside:?}, 0.0]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 5.0\n\
             [shell.mesh]\nelements = [24, 1]\n"
        )
    };
    let held = |name: &str, force: f64| {
        format!(
            "[[support]]\nname = \"root {name}\"\nkind = \"clamped\"\nshell = \"{name}\"\non = \"u-start\"\n\
             [[support]]\nname = \"tip {name}\"\nkind = \"rigid\"\nshell = \"{name}\"\non = \"u-end\"\nx_mm = \"free\"\nz_mm = \"free\"\nrotation_y_deg = \"free\"\n\
             [[action]]\nkind = \"section-force\"\nsection = \"tip {name}\"\nforce_n = [{force:?}, 0.0, 0.0]\n"
        )
    };
    let euler = std::f64::consts::PI.powi(2) * 70_000.0 * 5.0 * 0.5_f64.powi(3) / 12.0 / (4.0 * 100.0 * 100.0);
    // Pulled so much, or so little, that modes of the reversed load stand before all of those that are asked for, or before some.
    for pulled in [1000.0, 100.0, 3.0] {
        let scene = read(&format!(
            "{}{}[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.0\nthickness_mm = 0.5\n\
             [load]\nkind = \"steps\"\nfactor = 1.0\nincrement = 1.0\n{}{}",
            shell("pushed", 0.0),
            shell("pulled", 20.0),
            held("pushed", -1.0),
            held("pulled", pulled)
        ));
        let start = Stages::new(scene.clone()).start().unwrap();
        let mut work = Workspace::new(&scene, &start.mesh).unwrap();
        for count in [1, 3] {
            let found = linear_buckling(&mut work, Configuration::of(&start), count).unwrap();
            assert_eq!((found.counted, found.modes.len()), (count, count), "{pulled}");
            for (mode, times) in found.modes.iter().zip([1.0, 9.0, 25.0]) {
                assert!((mode.factor / (times * euler) - 1.0).abs() < 2e-3, "{pulled}: {} {times}", mode.factor);
            }
        }
    }
}

/// The chain of a structure that refines one shell beside a joint is the same on one thread and on two, and from any stage on.
#[test]
fn a_structure_runs_alike_on_threads_and_from_any_stage() {
    let mut frame = scene("structures/right-angle-frame.toml");
    frame.shells.iter_mut().for_each(|shell| shell.mesh.elements = [4, 1]);
    let text = frame.to_toml()
        + "[adapt]\nthreshold = 0.05\nlength_limit_mm = 5.0\n[pipeline]\nstages = [\"solve\", \"evaluate-indicators\", \"refine-knots\", \"project-displacements\", \"re-equilibrate\"]\n";
    let mut frame = read(&text.replacen("[pipeline]\nstages = [\"solve\"]\n", "", 1));
    frame.load.set_target(0.5);
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(frame.clone()))
    };
    let (one, two) = (on(1), on(2));
    let hashes =
        |stages: &[(State, foldline::record::Record)]| stages.iter().map(|(state, _)| state.hash()).collect::<Vec<_>>();
    assert_eq!(hashes(&one), hashes(&two));
    let elements = one.last().unwrap().0.mesh.elements();
    assert!(elements.count() > 8, "it refines: {elements}");
    assert!(steps(&one).iter().all(|(_, record)| record.report.negative_pivots == 0));
    for from in (0..one.len() - 1).step_by(3) {
        let mut stages = Stages::new(frame.clone());
        let (next, _) = stages.run(one[from + 1].1.report.stage, &one[from].0, &mut |_| {}).unwrap();
        assert_eq!(next.hash(), one[from + 1].0.hash(), "stage {}", from + 1);
    }
}

#[test]
fn what_cannot_be_connected_is_refused() {
    let frame = include_str!("../../pipelines/structures/right-angle-frame.toml");
    let start = |text: &str| {
        let scene = read(text);
        starting_mesh(&scene).and_then(|mesh| Terms::on(&scene, &mesh, &[])).unwrap_err()
    };
    let apart = start(&frame.replace("position_mm = [0.0, 100.0, 0.0]", "position_mm = [0.0, 100.5, 0.0]"));
    let ModelError::EdgesApart { distance, .. } = apart else { panic!("{apart}") };
    assert!((distance - 0.5).abs() < 1e-9);
    let boom = include_str!("../../pipelines/structures/trac-boom.toml");
    let far = start(&boom.replace("start_mm = [-0.05, -8.0]", "start_mm = [-0.25, -8.0]"));
    assert!(matches!(far, ModelError::NothingGlued { gap: Some(gap), .. } if (gap - 0.2).abs() < 1e-6), "{far}");
    let crossing = start(&boom.replace("start_mm = [-0.05, -8.0]", "start_mm = [0.0, -8.0]"));
    assert!(matches!(crossing, ModelError::ShellsCross { by, .. } if (by - 0.05).abs() < 1e-6), "{crossing}");
    let flat = start(&boom.replace("about = \"y\"", "about = \"x\""));
    assert!(matches!(flat, ModelError::SectionWithoutExtent { .. }), "{flat}");
    for (before, after, says) in [
        ("\"arm.u-start\"]", "\"arm.u-strat\"]", "no edge of a shell"),
        ("\"arm.u-start\"]", "\"arm.u=0.5\"]", "write two shells that meet along that line"),
        ("\"arm.u-start\"]", "\"amr.u-start\"]", "did you mean \"arm\"?"),
        ("name = \"arm\"", "name = \"column\"", "another shell is called \"column\""),
        (
            "y_axis = [0.0, 0.0, 1.0]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 20.0\n\n[[shell]]",
            "y_axis = [0.0, 0.5, 1.0]\n[shell.geometry]\nkind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 20.0\n\n[[shell]]",
            "degrees with x_axis",
        ),
        ("shell = \"column\"\non = \"u-start\"", "on = \"u-start\"", "it does not say which shell is meant"),
        ("elements = [16, 2]", "", "it has no number of elements"),
    ] {
        let text = frame.replacen(before, after, 1);
        assert_ne!(text, frame, "{before}");
        let error = parse(&text, "frame.toml").unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

/// A shell that a joint was forgotten for is refused where nothing holds it, and else its edges are remarked; those of a joint, a bond or a section are not.
#[test]
fn edges_that_nothing_connects_are_remarked() {
    let remarks = |text: &str| {
        let mut stages = Stages::new(read(text));
        let start = stages.start().unwrap();
        stages.remarks(&start).unwrap().join("; ")
    };
    let frame = include_str!("../../pipelines/structures/right-angle-frame.toml");
    let joint = &frame[frame.find("[[joint]]").unwrap()..frame.find("[load]").unwrap()];
    let apart = frame.replace(joint, "");
    let refused = Stages::new(read(&apart)).start().unwrap_err().to_string();
    assert!(refused.contains("of shell \"arm\", which no joint, bond or section connects"), "{refused}");
    let said =
        remarks(&(apart + "[[support]]\nname = \"own\"\nkind = \"clamped\"\nshell = \"arm\"\non = \"v-start\"\n"));
    assert!(said.contains("\"column.u-end\" and \"arm.u-start\" lie on each other"), "{said}");
    let boom = include_str!("../../pipelines/structures/trac-boom.toml");
    for joined in [frame, boom, include_str!("../../pipelines/verification/t-beam.toml")] {
        let said = remarks(joined);
        assert!(!said.contains("lie on each other"), "{said}");
    }
}

/// A section that holds edges of two shells reports the force and moment that it carries for both: the root of a boom those that act on
/// its tip, about its reference point.
#[test]
fn a_common_section_reports_what_it_carries_for_all_its_shells() {
    let boom = include_str!("../../pipelines/structures/trac-boom.toml")
        .replace("elements = [30, 9]", "elements = [6, 6]")
        .replace("increment = 0.1", "increment = 1.0")
        .replace("moment_n_mm = 700.0", "moment_n_mm = 20.0");
    let force = "[[action]]\nname = \"tip\"\nkind = \"section-force\"\nsection = \"tip\"\nforce_n = [0.0, 0.0, 0.05]\n";
    let probe = |component: &str| {
        format!(
            "[[probe]]\nname = \"{component}\"\nkind = \"reaction\"\nsupport = \"root\"\ncomponent = \"{component}\"\n"
        )
    };
    let report = run(read(&format!("{boom}{force}{}{}", probe("moment-y"), probe("force-z")))).pop().unwrap().1.report;
    // M + r × F about y is M − 300 mm · F_z, and what holds it is opposite. The boom bends by less than 1e-3 of its length.
    let (moment, force) = (reading(&report, "moment-y"), reading(&report, "force-z"));
    assert!((moment + (20.0 - 300.0 * 0.05)).abs() < 2e-3 * 20.0, "{moment}");
    assert!((force + 0.05).abs() < 1e-6, "{force}");
}
