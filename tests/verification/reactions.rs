//! Reactions of supports: against the whole shell where a part of it is modelled, against the derivative of the energy
//! with a given motion, and in equilibrium with what acts.

use std::collections::BTreeMap;

use foldline::model::ModelError;
use foldline::pipeline::{Run, Stages};
use foldline::record::MemorySink;
use foldline::scene::{Edge, History, Hold, Region, Scene, Support, parse};

const COMPONENTS: [&str; 6] = ["force-x", "force-y", "force-z", "moment-x", "moment-y", "moment-z"];

/// A shell without supports: geometry, degree and elements; soft enough to move by many times its thickness.
struct Shell {
    geometry: String,
    degree: usize,
    elements: [usize; 2],
}

impl Shell {
    fn plate(length: f64, width: f64, degree: usize, elements: [usize; 2]) -> Self {
        Self { geometry: format!("kind = \"plate\"\nlength_mm = {length:?}\nwidth_mm = {width:?}"), degree, elements }
    }

    fn arch(length: f64, arc_deg: f64, degree: usize, elements: [usize; 2]) -> Self {
        let geometry =
            format!("kind = \"cylinder-panel\"\nlength_mm = {length:?}\nradius_mm = 20.0\narc_deg = {arc_deg:?}");
        Self { geometry, degree, elements }
    }

    /// With these supports and actions, and probes of all six reactions of each of `watched` by the names of support and
    /// component.
    fn scene(&self, tables: &str, watched: &[&str]) -> Scene {
        let Self { geometry, degree, elements: [nu, nv] } = self;
        let mut text = format!(
            "[geometry]\n{geometry}\n[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 1000.0\n\
             poissons_ratio = 0.3\nthickness_mm = 0.5\n[mesh]\ndegree = [{degree}, {degree}]\nelements = [{nu}, {nv}]\n\
             [load]\nkind = \"steps\"\nincrement = 0.5\n[solver]\ntolerance = 1e-11\n{tables}\n"
        );
        for support in watched {
            for component in COMPONENTS {
                text += &format!(
                    "[[probe]]\nname = \"{support} {component}\"\nkind = \"reaction\"\nsupport = \"{support}\"\n\
                     component = \"{component}\"\n"
                );
            }
        }
        parse(&text, "test.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

fn support(name: &str, on: &str, words: &str) -> String {
    format!("[[support]]\nname = \"{name}\"\non = {on}\n{words}\n")
}

fn action(words: &str) -> String {
    format!("[[action]]\n{words}\n")
}

fn displacement_probe(on: &str, component: &str) -> String {
    format!("[[probe]]\nname = \"moved\"\nkind = \"displacement\"\non = {on}\ncomponent = \"{component}\"\n")
}

/// Planes of symmetry besides the supports of a scene, before them or behind them.
fn with_planes(mut scene: Scene, edges: &[Edge], first: bool) -> Scene {
    for (index, edge) in edges.iter().enumerate() {
        let plane = Support {
            name: format!("plane {index}"),
            on: Region::Edge(*edge),
            shell: 0,
            also: vec![],
            hold: Hold::Symmetric,
            history: History::default(),
        };
        scene.supports.insert(if first { 0 } else { scene.supports.len() }, plane);
    }
    scene
}

struct Found {
    values: BTreeMap<String, f64>,
    energy: f64,
}

impl Found {
    fn all(&self, support: &str) -> [f64; 6] {
        COMPONENTS.map(|component| self.values[&format!("{support} {component}")])
    }
}

fn solve(scene: Scene) -> Found {
    let mut stages = Stages::new(scene);
    let start = stages.start().unwrap_or_else(|error| panic!("{error}"));
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap_or_else(|error| panic!("{error}"));
    let report = &sink.stages.last().unwrap().1.report;
    assert_eq!((report.parameter, report.negative_pivots), (1.0, 0));
    let values = report.probes.iter().map(|probe| (probe.name.clone(), probe.value)).collect();
    Found { values, energy: report.strain_energy_n_mm }
}

/// Share that the model of a part reads of each component of the whole shell's reaction; `None` where symmetry cancels
/// it in the whole and not in the part.
type Shares = [Option<f64>; 6];

/// What does not agree.
fn differences(case: &str, part: [f64; 6], whole: [f64; 6], shares: Shares) -> Vec<String> {
    let force = whole[..3].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let moment = whole[3..].iter().fold(force, |most, value| most.max(value.abs()));
    let mut found = Vec::new();
    for (k, share) in shares.into_iter().enumerate() {
        let Some(share) = share else { continue };
        let (expected, scale) = (share * whole[k], if k < 3 { force } else { moment });
        if (part[k] - expected).abs() > 1e-7 * scale {
            found.push(format!("{case}, {}: {} and not {expected}", COMPONENTS[k], part[k]));
        }
    }
    found
}

/// The half of a shell at v ≤ 1/2, in degree 2 with a knot line on the plane: the same functions as the whole has, so that
/// both are one discrete problem and agree to rounding.
#[test]
fn a_half_reads_what_the_whole_does() {
    let (whole, half) = (Shell::plate(60.0, 40.0, 2, [5, 6]), Shell::plate(60.0, 20.0, 2, [5, 3]));
    let pull = action("on = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.5, 0.0, 0.1]");
    let pressure = action("kind = \"pressure\"\npressure_mpa = 0.002");
    let line = "kind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, 0.05]";
    let lift = "kind = \"displacement\"\nz_mm = 4.0";
    let turn = "kind = \"rigid\"\nx_mm = \"free\"\nz_mm = 3.0\nrotation_y_deg = -20.0";
    let root = support("root", "\"u-start\"", "kind = \"clamped\"");
    let hold_z = "kind = \"fixed\"\nhold = [\"z\"]";
    let [keel, ridge] = ["v=0.5", "v-end"].map(|on| support("held", &format!("{on:?}"), hold_z));
    // Forces across the plane, and moments about lines in it, cancel between the halves of the whole.
    let half_of = [Some(0.5), None, Some(0.5), None, Some(0.5), None];
    let own = [Some(1.0); 6];
    // Name, supports and actions of the whole and of the half, shares.
    let same = |tables: String| (tables.clone(), tables);
    let cases: Vec<(&str, (String, String), Shares)> = vec![
        ("clamped at the corner", same(support("held", "\"u-start\"", "kind = \"clamped\"") + &pull), half_of),
        (
            "hinged at the corners",
            same(
                support("held", "\"u-start\"", "kind = \"hinged\"")
                    + &support("far", "\"u-end\"", "kind = \"hinged\"")
                    + &pressure,
            ),
            half_of,
        ),
        ("an edge is lifted", same(root.clone() + &support("held", "\"u-end\"", lift) + &pressure), half_of),
        ("a section turns", same(root.clone() + &support("held", "\"u-end\"", turn) + &pressure), half_of),
        (
            "the opposite edge",
            {
                let near = support("held", "\"v-start\"", "kind = \"hinged\"");
                let far = support("far", "\"v-end\"", "kind = \"hinged\"");
                (format!("{near}{far}{pressure}"), format!("{near}{pressure}"))
            },
            own,
        ),
        (
            "the opposite edge, clamped",
            {
                let near = support("held", "\"v-start\"", "kind = \"clamped\"");
                let far = support("far", "\"v-end\"", "kind = \"clamped\"");
                (format!("{near}{far}{pressure}"), format!("{near}{pressure}"))
            },
            own,
        ),
        (
            "along the plane",
            {
                let hinge = support("root", "\"u-start\"", "kind = \"hinged\"");
                (format!("{keel}{hinge}{pressure}"), format!("{ridge}{hinge}{pressure}"))
            },
            half_of,
        ),
        (
            "along the plane, edges loaded",
            {
                let [near, far] = ["v-start", "v-end"].map(|edge| action(&format!("on = \"{edge}\"\n{line}")));
                (format!("{root}{keel}{near}{far}"), format!("{root}{ridge}{near}"))
            },
            half_of,
        ),
        (
            "a line is moved along the plane",
            {
                // The plane holds the half across itself.
                let all = support("held", "\"v=0.5\"", &format!("{lift}\ny_mm = 0.0"));
                let part = support("held", "\"v-end\"", lift);
                let [near, far] = ["v-start", "v-end"].map(|on| support(on, &format!("{on:?}"), hold_z));
                let slide = support("slide", "\"u-start\"", "kind = \"fixed\"\nhold = [\"x\"]") + &near;
                (format!("{slide}{far}{all}{pressure}"), format!("{slide}{part}{pressure}"))
            },
            half_of,
        ),
        (
            "a point of the plane",
            {
                let [all, part] = ["[1.0, 0.5]", "[1.0, 1.0]"].map(|on| support("held", on, lift));
                (format!("{root}{all}{pressure}"), format!("{root}{part}{pressure}"))
            },
            half_of,
        ),
        (
            "a point on the plane, inside",
            {
                let [all, part] = ["[0.7, 0.5]", "[0.7, 1.0]"].map(|on| support("held", on, lift));
                (format!("{root}{all}{pressure}"), format!("{root}{part}{pressure}"))
            },
            half_of,
        ),
        ("a line across the plane", same(root.clone() + &support("held", "\"u=0.5\"", lift) + &pull), half_of),
    ];
    let mut wrong = Vec::new();
    for (case, (all, part), shares) in cases {
        let found = solve(whole.scene(&all, &["held"]));
        // What a support carries does not depend on where the plane of symmetry stands in the scene.
        for first in [true, false] {
            let of_half = solve(with_planes(half.scene(&part, &["held"]), &[Edge::VEnd], first));
            assert!((2.0 * of_half.energy / found.energy - 1.0).abs() < 1e-8, "{case}");
            wrong.extend(differences(case, of_half.all("held"), found.all("held"), shares));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The quarter of a plate on four hinged edges whose middle is pushed down.
#[test]
fn a_quarter_reads_its_part() {
    let (whole, quarter) = (Shell::plate(60.0, 40.0, 2, [8, 8]), Shell::plate(30.0, 20.0, 2, [4, 4]));
    let hinged = |edge: &str| support(edge, &format!("\"{edge}\""), "kind = \"hinged\"");
    let down = "kind = \"displacement\"\nz_mm = -3.0";
    let held = hinged("u-start") + &hinged("v-start");
    let crown = |on: &str| support("crown", on, down);
    let all = held.clone() + &hinged("u-end") + &hinged("v-end") + &crown("[0.5, 0.5]");
    let found = solve(whole.scene(&all, &["u-start", "crown"]));
    let mut wrong = Vec::new();
    let tables = held + &crown("[1.0, 1.0]");
    for first in [true, false] {
        let scene = quarter.scene(&tables, &["u-start", "crown"]);
        let part = solve(with_planes(scene, &[Edge::UEnd, Edge::VEnd], first));
        let own = [None, None, Some(0.25), None, None, None];
        wrong.extend(differences("crown", part.all("crown"), found.all("crown"), own));
        let edge = [Some(0.5), None, Some(0.5), None, Some(0.5), None];
        wrong.extend(differences("edge", part.all("u-start"), found.all("u-start"), edge));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A shell, where one support of it moves and how, and in which component the force is that is conjugate to the motion.
struct Moved {
    case: &'static str,
    shell: Shell,
    planes: &'static [Edge],
    rest: String,
    on: &'static str,
    /// Up to the value of the motion, which ends the table.
    words: &'static str,
    value: f64,
    component: usize,
}

/// A reaction is the derivative of strain energy less work of the loads with respect to the motion of its support.
#[test]
fn a_reaction_is_conjugate_to_the_motion() {
    let root = support("root", "\"u-start\"", "kind = \"clamped\"");
    let hinged = support("root", "\"u-start\"", "kind = \"hinged\"");
    let slides = support("slide", "\"u-start\"", "kind = \"fixed\"\nhold = [\"x\"]")
        + &support("edge", "\"v-start\"", "kind = \"fixed\"\nhold = [\"z\"]");
    let foot = support("root", "\"v-start\"", "kind = \"clamped\"");
    let feet = foot.clone() + &support("foot", "\"v-end\"", "kind = \"hinged\"");
    let plate = |degree: usize| Shell::plate(60.0, 20.0, degree, [6, 4]);
    let lift = "kind = \"displacement\"\nz_mm = ";
    let pull = "kind = \"displacement\"\nx_mm = ";
    let turn = "kind = \"rigid\"\nx_mm = \"free\"\nz_mm = 1.0\nrotation_y_deg = ";
    let near = support("near", "[0.55, 0.5]", "kind = \"fixed\"\nhold = [\"z\"]");
    let (half, quarter): (&[Edge], &[Edge]) = (&[Edge::VEnd], &[Edge::VEnd, Edge::UEnd]);
    // Arcs of more than 90 degrees consist of segments, with joints between them.
    let arch = || Shell::arch(30.0, 180.0, 2, [3, 8]);
    let moved = |case, shell, planes, rest: &str, on, words, value, component| Moved {
        case,
        shell,
        planes,
        rest: rest.into(),
        on,
        words,
        value,
        component,
    };
    let cases = vec![
        moved("a point of the plane", plate(3), half, &root, "[0.7, 1.0]", lift, 3.0, 2),
        moved("a point beside the plane", plate(3), half, &root, "[0.7, 0.95]", lift, 3.0, 2),
        moved("the corner", plate(3), half, &root, "[1.0, 1.0]", lift, 3.0, 2),
        moved("along the plane", plate(3), half, &slides, "\"v-end\"", lift, 2.0, 2),
        moved("an edge is pulled", plate(3), half, &root, "\"u-end\"", pull, 0.5, 0),
        moved("an edge is lifted", plate(2), half, &root, "\"u-end\"", lift, 4.0, 2),
        moved("a section turns", plate(3), half, &root, "\"u-end\"", turn, -20.0, 4),
        moved("the middle of a quarter", plate(3), quarter, &hinged, "[1.0, 1.0]", lift, -2.0, 2),
        moved("a plane of a quarter", plate(3), quarter, &hinged, "\"u-end\"", lift, -2.0, 2),
        moved("beside another support", plate(3), &[], &(root.clone() + &near), "[0.6, 0.5]", lift, 1.0, 2),
        moved("beside a clamped edge", plate(3), &[], &root, "[0.05, 0.5]", lift, 0.01, 2),
        moved("along a joint", arch(), &[Edge::UEnd], &feet, "\"v=0.5\"", lift, -1.0, 2),
        moved("a point of a joint", arch(), &[Edge::UEnd], &feet, "[1.0, 0.5]", lift, -1.0, 2),
        moved("the end of a joint", arch(), half, &foot, "[0.0, 0.5]", lift, -1.0, 2),
    ];
    let mut wrong = Vec::new();
    for Moved { case, shell, planes, rest, on, words, value, component } in cases {
        let at = |value: f64, rest: &str| {
            // A force besides, so that the work of loads counts.
            let force = action("on = [0.9, 0.2]\nkind = \"force\"\nforce_n = [0.0, 0.0, 0.1]");
            let moving = support("moving", on, &format!("{words}{value:?}"));
            let probes = displacement_probe("[0.9, 0.2]", "z");
            let scene = shell.scene(&format!("{rest}{moving}{force}{probes}"), &["moving"]);
            solve(with_planes(scene, planes, true))
        };
        let potential = |value: f64| {
            let found = at(value, &rest);
            found.energy - 0.1 * found.values["moved"]
        };
        // Central differences of order 4.
        let step = if component > 2 { 0.2 } else { 0.01 };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| potential(value + k * step));
        let unit = if component > 2 { 1.0_f64.to_radians() } else { 1.0 };
        let slope = (a - d + 8.0 * (c - b)) / (12.0 * step * unit);
        let found = at(value, &rest).all("moving")[component];
        let off = (found - slope).abs() / slope.abs();
        println!("{case}: {found}, slope {slope}, off {off:.1e}");
        if off > 1e-5 {
            wrong.push(format!("{case}: {found} and not {slope}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// What all supports exert and what acts are in equilibrium, whichever of the supports share control points, and the
/// first of the scene takes what several could.
#[test]
fn reactions_and_loads_are_in_equilibrium() {
    let shell = Shell::arch(30.0, 180.0, 2, [4, 8]);
    let names = ["one", "other", "plane", "point"];
    let one = support("one", "\"u-start\"", "kind = \"hinged\"");
    let other = support("other", "\"v-start\"", "kind = \"clamped\"");
    let plane = support("plane", "\"u-end\"", "kind = \"symmetric\"");
    let point = support("point", "[0.1, 0.55]", "kind = \"displacement\"\nz_mm = 0.3");
    let load = action("on = \"v-end\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.05, 0.03]");
    let orders = [[&one, &other, &plane, &point], [&plane, &point, &other, &one]];
    let [first, second] = orders.map(|order| {
        let tables: String = order.into_iter().cloned().collect();
        let found = solve(shell.scene(&(tables + &load), &names));
        for (c, acting) in [0.0, 1.5, 0.9].into_iter().enumerate() {
            let sum: f64 = names.iter().map(|name| found.all(name)[c]).sum();
            assert!((sum + acting).abs() < 1e-8, "{sum} against {acting}");
        }
        found
    });
    for c in 0..3 {
        let [a, b] = [&first, &second].map(|found| found.all("one")[c] + found.all("other")[c]);
        assert!((a - b).abs() < 1e-8, "two that share a corner carry {a} and {b} together");
    }
    assert!((first.all("one")[2] - second.all("one")[2]).abs() > 1e-3, "the corner counts for the first");
    for name in ["plane", "point"] {
        let (a, b) = (first.all(name), second.all(name));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-8), "{name}: {a:?} {b:?}");
    }
}

/// A moment at the end of an arch goes through it unchanged, across joints of its segments too.
#[test]
fn a_section_moment_does_not_see_joints() {
    let shell = Shell::arch(30.0, 180.0, 2, [2, 8]);
    let lines = ["v=0.2", "v=0.45", "v=0.5", "v=0.55", "v=0.8"];
    let mut tables = support("root", "\"v-start\"", "kind = \"clamped\"");
    tables += &action("on = \"v-end\"\nkind = \"edge-moment\"\nmoment_n = 0.5");
    for line in lines {
        tables +=
            &format!("[[probe]]\nname = \"{line}\"\nkind = \"section-moment\"\non = \"{line}\"\ncomponent = \"x\"\n");
    }
    let found = solve(shell.scene(&tables, &["root"]));
    let root = found.all("root")[3];
    let wrong: Vec<String> = lines
        .into_iter()
        .filter(|line| (found.values[*line] + root).abs() > 1e-6 * root.abs())
        .map(|line| format!("{line}: {} and not {}", found.values[line], -root))
        .collect();
    assert!(wrong.is_empty() && (root.abs() - 15.0).abs() < 0.2, "{root} {wrong:?}");
}

/// A cantilever under a load per area bends as statics says, whatever elements its lines cut: M = q b (L − x)²/2.
#[test]
fn a_section_moment_has_the_loads_of_its_side_alone() {
    for (degree, elements) in [(3, 4), (5, 3)] {
        let shell = Shell::plate(100.0, 10.0, degree, [elements, 2]);
        let mut tables = support("root", "\"u-start\"", "kind = \"clamped\"");
        tables += &action("kind = \"area-force\"\nforce_n_per_mm2 = [0.0, 0.0, -1e-9]");
        let places: [f64; 4] = [0.3, 0.5, 0.75, 0.9];
        for at in places {
            tables += &format!(
                "[[probe]]\nname = \"M{at}\"\nkind = \"section-moment\"\non = \"u={at}\"\ncomponent = \"y\"\n"
            );
        }
        let found = solve(shell.scene(&tables, &["root"]));
        for at in places {
            let right = 1e-9 * 10.0 * (100.0 * (1.0 - at)).powi(2) / 2.0;
            let moment = found.values[&format!("M{at}")];
            assert!((moment / right - 1.0).abs() < 1e-6, "degree {degree}, {at}: {moment} for {right}");
        }
    }
}

/// A plane of symmetry one element away from an edge that moves would tie control points of two frames to each other.
#[test]
fn a_section_keeps_its_distance_from_ties() {
    let turn = support("end", "\"v-start\"", "kind = \"rigid\"\nrotation_x_deg = 5.0");
    let plate = |elements: usize| Shell::plate(20.0, 20.0, 2, [2, elements]).scene(&turn, &["end"]);
    let half = |elements: usize| Stages::new(with_planes(plate(elements), &[Edge::VEnd], false)).start();
    let error = half(1).unwrap_err().to_string();
    assert!(error.contains("\"plane 0\" and the rigid section \"end\", which moves, lie in one element"), "{error}");
    assert!(half(2).is_ok());
    let arch = |elements: usize| Stages::new(Shell::arch(20.0, 180.0, 2, [2, elements]).scene(&turn, &["end"])).start();
    let error = arch(2).unwrap_err().to_string();
    assert!(error.contains("a joint of the surface and the rigid section \"end\""), "{error}");
    assert!(arch(4).is_ok());
}

/// Sections on two edges that one element of degree 2 joins: three rows of control points for the four that they take.
#[test]
fn sections_that_share_a_row_are_refused() {
    let scene = |elements: usize| {
        let text = format!(
            r#"
            geometry = {{ kind = "plate", length_mm = 10, width_mm = 1 }}
            material = {{ kind = "isotropic", youngs_modulus_mpa = 1000, poissons_ratio = 0, thickness_mm = 0.1 }}
            mesh = {{ degree = 2, elements = [{elements}, 1] }}
            load = {{ kind = "steps", increment = 1 }}
            support = [{{ on = "u-start", kind = "clamped" }}, {{ on = "u-end", kind = "rigid", z_mm = 0.01 }}]
            "#
        );
        Stages::new(parse(&text, "strip.toml").unwrap()).start()
    };
    let refused = scene(1).unwrap_err();
    assert!(matches!(refused, ModelError::TooFewRows { along: "u", rows: 3, least: 2, .. }), "{refused}");
    assert!(scene(2).is_ok());
}
