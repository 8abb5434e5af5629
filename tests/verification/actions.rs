//! Loads per area, weight, directions of the surface, supports of rigid motions and symmetric lines, against closed forms.

use std::f64::consts::PI;

use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, Report};
use foldline::scene::{Quadrature, Scene, parse};

use crate::support::scene;

/// The report of a run's last equilibrium.
fn solve(scene: Scene) -> Report {
    let mut stages = Stages::new(scene);
    let start = stages.start().unwrap_or_else(|error| panic!("{error}"));
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap_or_else(|error| panic!("{error}"));
    sink.stages.last().unwrap().1.report.clone()
}

fn probe(report: &Report, name: &str) -> f64 {
    report.probes.iter().find(|probe| probe.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}

/// A shell of steel, 70 GPa, in one load step.
fn shell(geometry: &str, thickness_mm: f64, elements: [usize; 2], tables: &str) -> Scene {
    let [nu, nv] = elements;
    let text = format!(
        "[geometry]\n{geometry}\n[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\n\
         thickness_mm = {thickness_mm:?}\ndensity_kg_m3 = 7800.0\n[mesh]\nelements = [{nu}, {nv}]\nquadrature = \"full\"\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n[solver]\ntolerance = 1e-11\n{tables}"
    );
    parse(&text, "test.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The error of a scene that is refused.
fn refused(scene: Scene) -> String {
    Stages::new(scene).start().unwrap_err().to_string()
}

const REACTIONS: [&str; 6] = ["force-x", "force-y", "force-z", "moment-x", "moment-y", "moment-z"];

fn reaction_probes(support: &str) -> String {
    let each = REACTIONS.map(|component| {
        format!("[[probe]]\nname = \"{component}\"\nkind = \"reaction\"\nsupport = \"{support}\"\ncomponent = \"{component}\"\n")
    });
    each.concat()
}

fn displacement_probe(name: &str, on: [f64; 2], component: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nkind = \"displacement\"\non = {on:?}\ncomponent = \"{component}\"\n")
}

fn assert_close(name: &str, value: f64, expected: f64, relative: f64) {
    let off = value / expected - 1.0;
    println!("{name}: {value:.6e} for {expected:.6e}, off by {:.4} %", 100.0 * off);
    assert!(off.abs() < relative, "{name}: {value} for {expected}, off by {off:.2e}");
}

/// The standard linear value, and the one with large rotations.
#[test]
fn scordelis_lo_roof() {
    let at = |factor: f64, elements: usize| {
        let mut roof = scene("verification/scordelis-lo-roof.toml");
        roof.load.set_target(factor);
        roof.mesh.elements = [elements; 2];
        roof.mesh.quadrature = Quadrature::Full;
        -probe(&solve(roof), "edge")
    };
    assert_close("linear", at(1e-3, 8), 3.006e-4, 1e-3);
    assert_close("whole weight", at(1.0, 8), 0.2529, 5e-3);
}

/// The same weight by density, acceleration and thickness.
#[test]
fn weight_of_the_roof_by_its_density() {
    let mut roof = scene("verification/scordelis-lo-roof.toml");
    let by_area = probe(&solve(roof.clone()), "edge");
    let text = roof.to_toml();
    let weighing = text
        .replace(
            "thickness_mm = 0.25\n",
            &format!("thickness_mm = 0.25\ndensity_kg_m3 = {:?}\n", 90.0 / (0.25 * 9.81) * 1e9),
        )
        .replace("kind = \"area-force\"\nforce_n_per_mm2 = [0.0, 0.0, -90.0]", "kind = \"gravity\"");
    assert_ne!(weighing, text);
    roof = parse(&weighing, "roof.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_close("by density", probe(&solve(roof), "edge"), by_area, 1e-9);
}

/// A strip that hangs from one end: the support carries ρ g over the volume, and the end sinks by ρ g L²/(2 E).
#[test]
fn a_hanging_strip() {
    let tables = "[[support]]\nname = \"top\"\non = \"u-start\"\nkind = \"fixed\"\nhold = [\"x\", \"z\"]\n\
         [[support]]\non = \"u-end\"\nkind = \"fixed\"\nhold = [\"z\"]\n[[support]]\non = \"v=0.5\"\nkind = \"fixed\"\nhold = [\"y\"]\n\
         [[action]]\nkind = \"gravity\"\nacceleration_m_s2 = [9.81, 0.0, 0.0]\n";
    let probes = reaction_probes("top") + &displacement_probe("end", [1.0, 0.5], "x");
    let plate = "kind = \"plate\"\nlength_mm = 2000.0\nwidth_mm = 50.0";
    let report = solve(shell(plate, 0.5, [8, 2], &format!("{tables}{probes}")));
    let weight_per_mm3 = 7800.0 * 9.81 * 1e-9;
    assert_close("weight", -probe(&report, "force-x"), weight_per_mm3 * 2000.0 * 50.0 * 0.5, 1e-10);
    assert_close("end", probe(&report, "end"), weight_per_mm3 * 2000.0_f64.powi(2) / (2.0 * 70000.0), 2e-4);
}

/// A laminate weighs what its plies do; a density of the material holds for plies that have none.
#[test]
fn a_laminate_weighs_what_its_plies_do() {
    let text = include_str!("../../pipelines/verification/laminated-plate.toml");
    let kind = text.find("kind = \"pressure\"").unwrap();
    let behind = text[kind..].find("\n\n").unwrap() + kind;
    let mut weighing = format!("{}kind = \"gravity\"{}", &text[..kind], &text[behind..]);
    weighing = weighing.replacen(
        "shear_modulus_12_mpa = 3500.0\n",
        "shear_modulus_12_mpa = 3500.0\ndensity_kg_m3 = 1600.0\n",
        1,
    );
    weighing = weighing.replacen("[[ply]]\n", "[[ply]]\ndensity_kg_m3 = 8000.0\n", 1);
    let scene = parse(&weighing, "plate.toml").unwrap_or_else(|error| panic!("{error}\n{weighing}"));
    let expected = (8000.0 * 0.25 + 1600.0 * 0.75) * 1e-9;
    assert!((scene.material.mass_kg_per_mm2().unwrap() / expected - 1.0).abs() < 1e-14);
    assert_eq!(parse(&scene.to_toml(), "again.toml").unwrap(), scene);
}

/// Snow on half a cylinder: the force is that of the ground plan, and of the whole surface by its own area.
#[test]
fn a_force_by_the_projected_area() {
    let panel = "kind = \"cylinder-panel\"\nlength_mm = 30.0\nradius_mm = 20.0\narc_deg = 180.0";
    let carried = |per: &str| {
        let tables = format!(
            "[[support]]\nname = \"foot\"\non = \"v-start\"\nkind = \"clamped\"\n[[action]]\nkind = \"area-force\"\n\
             force_n_per_mm2 = [0.0, 0.0, -1e-5]\n{per}\n{}",
            reaction_probes("foot")
        );
        probe(&solve(shell(panel, 1.0, [2, 8], &tables)), "force-z")
    };
    assert_close("snow", carried("per = \"projected-area\""), 1e-5 * 30.0 * 40.0, 1e-9);
    assert_close("whole area", carried(""), 1e-5 * 30.0 * 20.0 * PI, 1e-9);
}

/// On more than half a cylinder one part lies below another.
#[test]
fn a_force_by_the_projected_area_meets_one_side_alone() {
    let tables = "[[support]]\non = \"u-start\"\nkind = \"clamped\"\n[[action]]\nname = \"snow\"\nkind = \"area-force\"\n\
         force_n_per_mm2 = [0.0, 0.0, -1e-5]\nper = \"projected-area\"\n";
    let panel = |arc: f64| format!("kind = \"cylinder-panel\"\nlength_mm = 30.0\nradius_mm = 20.0\narc_deg = {arc:?}");
    let error = refused(shell(&panel(350.0), 1.0, [2, 16], tables));
    assert!(error.contains("\"snow\"") && error.contains("meets one side of the surface at (0, 0, 20) mm"), "{error}");
    Stages::new(shell(&panel(180.0), 1.0, [2, 16], tables)).start().unwrap();
}

/// The zone of a sphere in its membrane state, all of it free.
#[test]
fn a_zone_of_a_sphere_under_pressure() {
    for elements in [[24, 8], [32, 12]] {
        let mut zone = scene("verification/sphere-zone-pressure.toml");
        zone.mesh.elements = elements;
        zone.mesh.quadrature = Quadrature::Full;
        let report = solve(zone);
        let radial = 1e-4 * 100.0_f64.powi(2) * (1.0 - 0.3) / (2.0 * 70000.0 * 0.1);
        // Along its axis the zone moves as its support has it; across the axis nothing but the pressure moves it.
        assert_close("equator", probe(&report, "equator"), radial, 1e-3);
        assert_close("upper edge", probe(&report, "upper edge"), radial * (PI / 3.0).cos(), 1e-3);
    }
}

/// The membrane state of a cone.
#[test]
fn a_cone_under_pressure() {
    let mut cone = scene("verification/cone-pressure.toml");
    cone.mesh.quadrature = Quadrature::Full;
    let (radius, slant) = (75.0_f64, (PI / 6.0).cos());
    let radial = 0.0001 * radius.powi(2) * (1.0 - 0.15) / (70000.0 * 0.5 * slant);
    assert_close("middle", probe(&solve(cone), "middle"), radial, 5e-3);
}

const TUBE: &str = "kind = \"cylinder-panel\"\nlength_mm = 80.0\nradius_mm = 50.0\narc_deg = 360.0\nseam = \"smooth\"";
const FREE: &str = "[[support]]\nname = \"free\"\nkind = \"rigid-motions\"\n";

/// A free tube widens by p R²/(E t) everywhere, along its normal and away from its axis, and its support carries nothing;
/// pressure, force along the normal and radial force per area are one load. At a free edge the moment that widening leaves
/// there, ν D/R per unit of strain, vanishes within √(R t), and widens the edge by a share of about 0.07 t/R.
#[test]
fn a_free_tube_under_pressure() {
    let loads = [
        "kind = \"pressure\"\npressure_mpa = 1e-4\nfollower = false",
        "kind = \"pressure\"\npressure_mpa = 1e-4",
        "kind = \"area-force\"\nforce_n_per_mm2 = 1e-4\nalong = \"normal\"",
        "kind = \"area-force\"\nforce_n_per_mm2 = 1e-4\nalong = \"radial\"",
    ];
    let expected = 1e-4 * 50.0 * 50.0 / (70000.0 * 0.05);
    for load in loads {
        let mut probes = reaction_probes("free");
        for (name, on) in [("a", [0.0, 0.0]), ("b", [0.5, 0.3]), ("c", [1.0, 0.8])] {
            probes += &displacement_probe(&format!("{name} normal"), on, "normal");
            probes += &displacement_probe(&format!("{name} radial"), on, "radial");
        }
        let report = solve(shell(TUBE, 0.05, [4, 16], &format!("{FREE}[[action]]\n{load}\n{probes}")));
        for name in ["a normal", "a radial", "b normal", "b radial", "c normal", "c radial"] {
            assert_close(name, probe(&report, name), expected, 1e-4);
        }
        let force = 1e-4 * 2.0 * PI * 50.0 * 80.0;
        for component in REACTIONS {
            assert!(
                probe(&report, component).abs() < 1e-8 * force,
                "{load}: {component} {}",
                probe(&report, component)
            );
        }
    }
}

/// A ring pulled at its outer edge (Lamé): u = q b [(1 − ν) b² + (1 + ν) a²]/(E t (b² − a²)), and a sixth of it alike.
#[test]
fn a_ring_pulled_outward() {
    let (a, b, q) = (30.0_f64, 50.0_f64, 1e-3);
    let expected = q * b * (0.7 * b * b + 1.3 * a * a) / (70000.0 * 0.5 * (b * b - a * a));
    let planes =
        "[[support]]\non = \"v-start\"\nkind = \"symmetric\"\n[[support]]\non = \"v-end\"\nkind = \"symmetric\"\n";
    // On two oblique planes of symmetry, the motion along their common line is all that is free.
    for (arc, held) in [("arc_deg = 360.0\nseam = \"smooth\"", ""), ("arc_deg = 60.0\nfrom_deg = 17.0", planes)] {
        for along in ["radial", "outward"] {
            let ring = format!("kind = \"annulus\"\ninner_radius_mm = 30.0\nouter_radius_mm = 50.0\n{arc}");
            let tables = format!(
                "{held}{FREE}[[action]]\non = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = {q}\nalong = \"{along}\"\n{}",
                displacement_probe("u", [1.0, 0.4], "radial") + &displacement_probe("w", [1.0, 0.4], "normal")
            );
            let report = solve(shell(&ring, 0.5, [6, 12], &tables));
            assert_close("u", probe(&report, "u"), expected, 1e-4);
            assert!(probe(&report, "w").abs() < 1e-9 * expected);
        }
    }
}

/// Two opposite forces between two points of any shell: it is held, and nothing is felt of it.
#[test]
fn rigid_motions_of_any_shell_are_held() {
    let shapes = [
        ("kind = \"plate\"\nlength_mm = 60.0\nwidth_mm = 40.0", [60.0, 0.0, 0.0]),
        ("kind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 20.0\narc_deg = 50.0", [60.0, 0.0, 0.0]),
        ("kind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 20.0\narc_deg = 350.0", [60.0, 0.0, 0.0]),
        (TUBE, [80.0, 0.0, 0.0]),
        ("kind = \"annulus\"\ninner_radius_mm = 10.0\nouter_radius_mm = 30.0\narc_deg = 70.0", [20.0, 0.0, 0.0]),
        ("kind = \"sphere-zone\"\nradius_mm = 30.0\nlatitude_deg = [-80.0, 80.0]\narc_deg = 20.0", [0.0, 0.0, 1.0]),
    ];
    for (shape, chord) in shapes {
        // Corners that lie along one axis from each other.
        let [from, to] = if chord[2] == 0.0 { [[0.0, 0.0], [1.0, 0.0]] } else { [[0.0, 0.0], [0.0, 1.0]] };
        let size = chord.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
        let force = chord.map(|x| 1e-4 * x / size);
        let pull = |on: [f64; 2], sign: f64| {
            format!("[[action]]\non = {on:?}\nkind = \"force\"\nforce_n = {:?}\n", force.map(|x| sign * x))
        };
        let tables = [FREE.into(), pull(from, -1.0), pull(to, 1.0), reaction_probes("free")].concat();
        let mut scene = shell(shape, 0.5, [4, 4], &tables);
        scene.solver.tolerance = 1e-8;
        let report = solve(scene);
        assert!(report.strain_energy_n_mm > 0.0 && report.negative_pivots == 0);
        // The forces keep their direction and the shell is not to turn: a moment is left of their displacements.
        for (component, most) in REACTIONS.into_iter().zip([1e-9, 1e-9, 1e-9, 1e-6, 1e-6, 1e-6]) {
            let value = probe(&report, component);
            assert!(value.abs() < most, "{shape}: {component} {value:e}");
        }
    }
}

#[test]
fn rigid_motions_that_loads_push_or_nothing_leaves_free_are_refused() {
    let panel = "kind = \"cylinder-panel\"\nlength_mm = 80.0\nradius_mm = 50.0\narc_deg = 90.0";
    let pressure = "[[action]]\nkind = \"pressure\"\npressure_mpa = 1e-4\n";
    let error = refused(shell(panel, 0.5, [4, 4], &format!("{FREE}{pressure}")));
    assert!(error.contains("not in balance") && error.contains("it can move along z"), "{error}");
    let clamp = "[[support]]\non = \"u-start\"\nkind = \"clamped\"\n";
    let error = refused(shell(panel, 0.5, [4, 4], &format!("{clamp}{FREE}{pressure}")));
    assert!(error.contains("leave none free"), "{error}");
    // A load that is in balance at the end and not on the way there.
    let forces = "[[action]]\non = [0.0, 0.5]\nkind = \"force\"\nforce_n = [-1.0, 0.0, 0.0]\n[[action]]\non = [1.0, 0.5]\nkind = \"force\"\n\
         force_n = [1.0, 0.0, 0.0]\nhistory = [[0.0, 0.0], [0.5, 1.0], [1.0, 1.0]]\n";
    let error = refused(shell(panel, 0.5, [4, 4], &format!("{FREE}{forces}")));
    assert!(error.contains("load factor 0.5"), "{error}");
}

/// Where the arc starts turns the shell and nothing else; where it starts by default, not even that.
#[test]
fn an_arc_starts_where_it_is_told_to() {
    let tables = format!(
        "[[support]]\non = \"u-start\"\nkind = \"clamped\"\n[[action]]\non = [1.0, 0.0]\nkind = \"force\"\nforce_n = 0.02\nalong = \"normal\"\n\
         {}{}",
        displacement_probe("normal", [1.0, 0.0], "normal"),
        displacement_probe("z", [1.0, 0.0], "z")
    );
    let shapes = [
        ("kind = \"cylinder-panel\"\nlength_mm = 40.0\nradius_mm = 30.0\narc_deg = 70.0", -35.0),
        ("kind = \"sphere-zone\"\nradius_mm = 30.0\nlatitude_deg = [-20.0, 30.0]\narc_deg = 70.0", 0.0),
        ("kind = \"annulus\"\ninner_radius_mm = 20.0\nouter_radius_mm = 30.0\narc_deg = 70.0", 0.0),
    ];
    for (shape, default) in shapes {
        let from = |from_deg: f64| solve(shell(&format!("{shape}\nfrom_deg = {from_deg:?}"), 0.5, [3, 3], &tables));
        let (plain, same, turned) = (solve(shell(shape, 0.5, [3, 3], &tables)), from(default), from(123.0));
        assert_eq!(plain.probes, same.probes);
        assert_close(shape, probe(&turned, "normal"), probe(&plain, "normal"), 1e-8);
        let about_z = !shape.contains("panel");
        assert_eq!(about_z, (probe(&turned, "z") / probe(&plain, "z") - 1.0).abs() < 1e-8, "{shape}");
    }
}

const ARCH: &str = "kind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 20.0\narc_deg = 120.0";

/// On a shell that is its own mirror image, symmetric lines inside change nothing, wherever the knots stand: the discrete
/// solution meets them by itself. Its half has another spline, and the same answer on a finer mesh.
#[test]
fn symmetric_lines_inside_a_symmetric_shell_change_nothing() {
    let clamps = "[[support]]\nname = \"one\"\non = \"u-start\"\nkind = \"clamped\"\n[[support]]\non = \"u-end\"\nkind = \"clamped\"\n";
    let lines =
        "[[support]]\non = \"v=0.5\"\nkind = \"symmetric\"\n[[support]]\non = \"u=0.5\"\nkind = \"symmetric\"\n";
    let push = "[[action]]\non = [0.5, 0.5]\nkind = \"force\"\nforce_n = [0.0, 0.0, -2.0]\n";
    let probes = displacement_probe("w", [0.5, 0.5], "z") + &reaction_probes("one");
    for elements in [[5, 5], [6, 4]] {
        let [bare, held] =
            ["", lines].map(|lines| solve(shell(ARCH, 0.5, elements, &format!("{lines}{clamps}{push}{probes}"))));
        assert_close("w", probe(&held, "w"), probe(&bare, "w"), 1e-8);
        assert_close("energy", held.strain_energy_n_mm, bare.strain_energy_n_mm, 1e-8);
        let scale = probe(&bare, "force-z").abs();
        for component in REACTIONS {
            let [with, without] = [&held, &bare].map(|report| probe(report, component));
            assert!((with - without).abs() < 1e-6 * 20.0 * scale, "{component}: {with} {without}");
        }
    }
    let fine = [12, 16];
    let push = "[[action]]\nkind = \"area-force\"\nforce_n_per_mm2 = [0.0, 0.0, -1e-4]\n";
    let whole = solve(shell(ARCH, 0.5, fine, &format!("{lines}{clamps}{push}{probes}")));
    let half = ARCH.replace("arc_deg = 120.0", "arc_deg = 60.0\nfrom_deg = 0.0");
    let tables = format!("[[support]]\non = \"v-start\"\nkind = \"symmetric\"\n{clamps}{push}{probes}");
    let half = solve(shell(&half, 0.5, [fine[0], fine[1] / 2], &tables.replace("[0.5, 0.5]", "[0.5, 0.0]")));
    assert_close("half", probe(&half, "w"), probe(&whole, "w"), 1e-3);
    assert_close("energy", 2.0 * half.strain_energy_n_mm, whole.strain_energy_n_mm, 1e-3);
}

/// A strip of 100 x 2 mm that is hinged along both short edges and symmetric about the line at a fraction of its length.
fn strip(line: f64, tables: &str) -> Scene {
    let hinge = |edge: &str| format!("[[support]]\non = \"{edge}\"\nkind = \"fixed\"\nhold = [\"y\", \"z\"]\n");
    let tables = format!(
        "{}{}[[support]]\nname = \"middle\"\non = \"u={line:?}\"\nkind = \"symmetric\"\n{tables}",
        hinge("u-start"),
        hinge("u-end")
    );
    shell("kind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 2.0", 0.5, [64, 1], &tables)
}

fn line_force(u: f64, z: f64) -> String {
    format!("[[action]]\non = \"u={u:?}\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, {z:e}]\n")
}

/// A hinged strip under two forces at quarters of its length, w = P L³/(48 E I) below each: the line in the middle is all that
/// holds it along x, and it does not turn there.
#[test]
fn a_symmetric_line_holds_a_symmetric_strip() {
    let probes = displacement_probe("w", [0.25, 0.5], "z") + &displacement_probe("across", [0.5, 0.5], "x");
    let mut strip = strip(0.5, &(line_force(0.25, 1e-6) + &line_force(0.75, 1e-6) + &probes));
    let foldline::scene::Material::Isotropic { poissons_ratio, .. } = &mut strip.material else { panic!() };
    *poissons_ratio = 0.0;
    strip.solver.tolerance = 1e-8;
    let report = solve(strip);
    let rigidity = 70000.0 * 0.125 / 12.0;
    assert_close("w", probe(&report, "w"), 1e-6 * 1e6 / rigidity / 48.0, 1e-3);
    assert!(probe(&report, "across").abs() < 1e-12);
}

/// A symmetric line inside would hold what nothing else does where one side is not the image of the other.
#[test]
fn a_symmetric_line_asks_for_two_sides_alike() {
    let moment =
        |on: &str, size: f64| format!("[[action]]\non = \"{on}\"\nkind = \"edge-moment\"\nmoment_n = {size:?}\n");
    let force =
        |u: f64, v: f64, force: &str| format!("[[action]]\non = [{u:?}, {v:?}]\nkind = \"force\"\nforce_n = {force}\n");
    let pull = |u: f64, x: f64| force(u, 0.3, &format!("[{x:?}, 0.1, 0.2]"));
    let ramp = line_force(0.75, 1e-6) + "history = [[0.0, 0.0], [0.5, 1.0], [1.0, 1.0]]\n";
    let lift = |u: f64, z: f64| format!("[[support]]\non = [{u:?}, 0.5]\nkind = \"displacement\"\nz_mm = {z:?}\n");
    let taken = [
        line_force(0.2, 1e-6) + &line_force(0.8, 1e-6),
        line_force(0.5, 1e-6),
        moment("u-start", 1e-3) + &moment("u-end", -1e-3),
        moment("v-start", 1e-3),
        pull(0.1, 1.0) + &pull(0.9, -1.0),
        pull(0.1, 1.0) + &pull(0.1, 1.0) + &pull(0.9, -1.0) + &pull(0.9, -1.0),
        force(0.0, 0.0, "1.0\nalong = \"normal\"") + &force(1.0, 0.0, "1.0\nalong = \"normal\""),
        lift(0.3, 0.1) + &lift(0.7, 0.1),
    ];
    for tables in taken {
        Stages::new(strip(0.5, &tables)).start().unwrap_or_else(|error| panic!("{error}\n{tables}"));
    }
    let one_sided = [
        line_force(0.2, 1e-6),
        line_force(0.2, 1e-6) + &line_force(0.8, 2e-6),
        line_force(0.25, 1e-6) + &ramp,
        moment("u-start", 1e-3) + &moment("u-end", 1e-3),
        pull(0.1, 1.0) + &pull(0.9, 1.0),
        pull(0.1, 1.0) + &pull(0.1, 1.0) + &pull(0.9, -1.0),
        force(0.0, 0.0, "1.0\nalong = \"normal\"") + &force(1.0, 1.0, "1.0\nalong = \"normal\""),
        lift(0.3, 0.1) + &lift(0.7, 0.2),
        lift(0.3, 0.1),
    ];
    for tables in one_sided {
        let error = refused(strip(0.5, &tables));
        assert!(error.contains("has no mirror image on the other side"), "{error}\n{tables}");
    }
    let error = refused(strip(0.4, &line_force(0.2, 1e-6)));
    assert!(error.contains("\"middle\", a line inside: the line does not lie in its middle"), "{error}");
    // Square to its plane on the line, and wider on one side of it.
    let net = [(0.0, 20.0), (30.0, 10.0), (70.0, 15.0), (100.0, 15.0)]
        .map(|(x, y)| format!("[{x:?}, {:?}, 0], [{x:?}, {y:?}, 0]", -y));
    let uneven = format!(
        "kind = \"nurbs\"\ndegrees = [3, 1]\nknots_u = [0, 0, 0, 0, 1, 1, 1, 1]\nknots_v = [0, 0, 1, 1]\ncontrol_points_mm = [{}]",
        net.join(", ")
    );
    let held = "[[support]]\non = \"u=0.5\"\nkind = \"symmetric\"\n[[support]]\nkind = \"rigid-motions\"\n\
         [[action]]\nkind = \"pressure\"\npressure_mpa = 1e-4\n";
    let error = refused(shell(&uneven, 0.5, [4, 4], held));
    assert!(error.contains("mm off the surface"), "{error}");
}

/// Edges and lines inside of a parallelogram are told the same.
#[test]
fn lines_that_are_no_planes_of_symmetry_are_refused() {
    let clamp =
        "[[support]]\non = \"v-start\"\nkind = \"clamped\"\n[[support]]\non = \"v=0.3\"\nkind = \"symmetric\"\n";
    let push = "[[action]]\nkind = \"area-force\"\nforce_n_per_mm2 = [1e-6, 0.0, 0.0]\n";
    let zone = "kind = \"sphere-zone\"\nradius_mm = 30.0\nlatitude_deg = [0.0, 60.0]\narc_deg = 60.0";
    let error = refused(shell(zone, 0.5, [3, 3], &format!("{clamp}{push}")));
    assert!(error.contains("no plane of symmetry"), "{error}");
    // The equator is one, where both sides of it are held.
    let around = zone.replace("[0.0, 60.0]", "[-30.0, 30.0]");
    let middle = clamp.replace("v=0.3", "v=0.5");
    let other = "[[support]]\non = \"v-end\"\nkind = \"clamped\"\n";
    Stages::new(shell(&around, 0.5, [3, 3], &format!("{middle}{other}{push}"))).start().unwrap();
    let error = refused(shell(&around, 0.5, [3, 3], &format!("{middle}{push}")));
    assert!(error.contains("support \"support 1\" has no mirror image"), "{error}");

    let parallelogram = "kind = \"nurbs\"\ndegrees = [1, 1]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, 1]\n\
         control_points_mm = [[0, 0, 0], [20, 40, 0], [60, 0, 0], [80, 40, 0]]";
    for on in ["u-start", "u=0.5"] {
        let held = format!("[[support]]\nname = \"plane\"\non = \"{on}\"\nkind = \"symmetric\"\n{push}");
        let error = refused(shell(parallelogram, 0.5, [4, 4], &held));
        assert!(
            error.contains("the surface crosses its plane") && error.contains("26.6° off a right angle"),
            "{error}"
        );
    }
}

/// Where two moving sections carry the whole shell, no point is left to hold its rigid motions by.
#[test]
fn rigid_motions_need_points_that_no_moving_section_carries() {
    let free = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"]
        .map(|key| format!("{key} = \"free\"\n"));
    let section = |on: &str| format!("[[support]]\non = \"{on}\"\nkind = \"rigid\"\n{}", free.concat());
    let pull =
        |u: f64, x: f64| format!("[[action]]\non = [{u:?}, 0.5]\nkind = \"force\"\nforce_n = [{x:?}, 0.0, 0.0]\n");
    let tables = [section("u-start"), section("u-end"), FREE.into(), pull(0.0, -1.0), pull(1.0, 1.0)].concat();
    let plate = "kind = \"plate\"\nlength_mm = 60.0\nwidth_mm = 40.0";
    let error = refused(shell(plate, 0.5, [1, 4], &tables));
    assert!(error.contains("0 of them remain: put more elements between"), "{error}");
    Stages::new(shell(plate, 0.5, [6, 4], &tables)).start().unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn what_the_words_of_a_scene_come_to_is_said() {
    let said = |geometry: &str, tables: &str| {
        let mut stages = Stages::new(shell(geometry, 0.5, [4, 6], tables));
        let start = stages.start().unwrap();
        stages.remarks(&start).unwrap().join("; ")
    };
    let pressure = "[[action]]\nname = \"p\"\nkind = \"pressure\"\npressure_mpa = -1e-4\nfollower = false\n";
    let tube = said(TUBE, &format!("{FREE}{pressure}"));
    assert!(tube.contains("\"free\" holds all six rigid motions"), "{tube}");
    assert!(tube.contains("\"p\" pushes towards the axis, keeps that direction"), "{tube}");
    let planes =
        "[[support]]\non = \"v-start\"\nkind = \"symmetric\"\n[[support]]\non = \"u-start\"\nkind = \"clamped\"\n";
    let push = "[[action]]\nname = \"q\"\nkind = \"area-force\"\nforce_n_per_mm2 = 1e-4\nalong = \"normal\"\n";
    let plate = said("kind = \"plate\"\nlength_mm = 60.0\nwidth_mm = 40.0", &format!("{planes}{push}"));
    assert_eq!(plate, "action \"q\" pushes towards +z, and keeps that direction");
}

/// Places that are almost one are refused, with both names and what to do.
#[test]
fn places_that_are_almost_one_are_refused() {
    let plate = "kind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 20.0";
    let lifted = |on: &str| format!("[[support]]\nname = \"lifted\"\non = {on}\nkind = \"displacement\"\nz_mm = 1.0\n");
    let held = |on: &str| format!("[[support]]\nname = \"held\"\non = {on}\nkind = \"fixed\"\nhold = [\"z\"]\n");
    let pushed =
        |on: &str| format!("[[action]]\nname = \"push\"\non = {on}\nkind = \"force\"\nforce_n = [0.0, 0.0, 1.0]\n");
    let read = |tables: &str| {
        let text = format!(
            "[geometry]\n{plate}\n[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\n\
             thickness_mm = 1.0\n[mesh]\nelements = [6, 4]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
             [[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"clamped\"\n{tables}"
        );
        parse(&text, "scene.toml").map_err(|error| error.to_string())
    };
    for (tables, names) in [
        (lifted("\"u=0.000001\""), ["\"lifted\"", "the edge \"u-start\""]),
        (lifted("\"v=0.99999\""), ["\"lifted\"", "the edge \"v-end\""]),
        (held("\"u=0.3\"") + &lifted("\"u=0.300001\""), ["\"lifted\"", "support \"held\""]),
        (held("[0.3, 0.5]") + &lifted("[0.30000001, 0.5]"), ["\"lifted\"", "support \"held\""]),
        (held("\"u=0.3\"") + &pushed("[0.30005, 0.5]"), ["action \"push\"", "support \"held\""]),
    ] {
        let error = read(&tables).unwrap_err();
        assert!(names.iter().all(|name| error.contains(name)) && error.contains("almost the same place"), "{error}");
    }
    for tables in [
        held("\"u=0.3\"") + &lifted("\"u=0.3002\""),
        held("[0.3, 0.5]") + &lifted("[0.30000001, 0.6]"),
        held("\"v=0.3\"") + &pushed("[1.0, 0.3]"),
    ] {
        read(&tables).unwrap_or_else(|error| panic!("{error}\n{tables}"));
    }
}

/// Of two supports that meet the same control points, the one that says otherwise is named.
#[test]
fn the_support_in_the_way_is_named() {
    let tables = "[[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"clamped\"\n\
         [[support]]\nname = \"line\"\non = \"u=0.3\"\nkind = \"fixed\"\nhold = [\"z\"]\n\
         [[support]]\nname = \"point\"\non = [0.3, 0.5]\nkind = \"displacement\"\nz_mm = 1.0\n";
    let error = refused(shell("kind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 20.0", 1.0, [6, 4], tables));
    assert!(error.contains("\"point\" gives a displacement that \"line\" does not allow"), "{error}");
}

/// Loads that are none, or act where the shell is held, are said.
#[test]
fn that_nothing_acts_is_said() {
    let said = |action: &str| {
        let root = "[[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"clamped\"\n";
        let plate = "kind = \"plate\"\nlength_mm = 100.0\nwidth_mm = 20.0";
        let mut stages = Stages::new(shell(plate, 1.0, [6, 2], &format!("{root}[[action]]\n{action}\n")));
        let start = stages.start().unwrap();
        stages.remarks(&start).unwrap().join("; ")
    };
    let line = |on: &str, z: f64| format!("on = \"{on}\"\nkind = \"line-force\"\nforce_n_per_mm = [0.0, 0.0, {z:?}]");
    let none = [
        line("u-end", 0.0),
        "kind = \"gravity\"\nacceleration_m_s2 = [0.0, 0.0, 0.0]".into(),
        line("u-end", 0.1) + "\nhistory = [[0.0, 0.0], [1.0, 0.0]]",
        "kind = \"natural-curvature\"\nchange_per_mm = [0.0, 0.0, 0.0]".into(),
    ];
    for action in &none {
        assert!(said(action).contains("nothing acts on the shell") && said(action).contains("are zero"), "{action}");
    }
    assert!(said(&line("u-start", 1.0)).contains("on places that supports hold"));
    for action in [line("u-end", 0.1), line("u-end", 0.1) + "\nhistory = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]"] {
        assert_eq!(said(&action), "", "{action}");
    }
}

/// New words, written and read again.
#[test]
fn actions_and_supports_are_written_as_they_are_read() {
    let tables = "[[support]]\non = \"v=0.5\"\nkind = \"symmetric\"\n[[support]]\nkind = \"rigid-motions\"\n\
         [[action]]\non = [0.5, 0.5]\nkind = \"force\"\nforce_n = -1.5\nalong = \"radial\"\n\
         [[action]]\non = \"u-end\"\nkind = \"line-force\"\nforce_n_per_mm = 2.0\nalong = \"outward\"\n\
         [[action]]\nkind = \"area-force\"\nforce_n_per_mm2 = 0.5\nalong = \"normal\"\n\
         [[action]]\nkind = \"area-force\"\nforce_n_per_mm2 = [0.0, 0.0, -0.5]\nper = \"projected-area\"\n\
         [[action]]\nkind = \"gravity\"\n";
    let probes = displacement_probe("a", [0.0, 0.5], "normal") + &displacement_probe("b", [0.0, 0.5], "radial");
    let scene = shell(&format!("{ARCH}\nfrom_deg = 10.0"), 0.5, [4, 4], &format!("{tables}{probes}"));
    let again = parse(&scene.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{error}\n{}", scene.to_toml()));
    assert_eq!(again, scene);
    assert_eq!(again.hash(), scene.hash());
}
