//! Shells over profiles of straight pieces and arcs: one arc is a cylinder panel, thin-walled sections bend as beams do.

use std::f64::consts::PI;

use foldline::record::Report;
use foldline::scene::{Geometry, ProfilePiece, Scene, parse};

use crate::support::run;

fn read(text: &str) -> Scene {
    parse(text, "test.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn end_of(text: &str) -> Report {
    run(read(text)).pop().unwrap().1.report
}

fn probe(report: &Report, name: &str) -> f64 {
    report.probes.iter().find(|probe| probe.name == name).unwrap_or_else(|| panic!("no probe {name}")).value
}

/// A profile, to be walked along.
struct Walk {
    pieces: Vec<ProfilePiece>,
    start: [f64; 2],
    direction_deg: f64,
}

impl Walk {
    fn of(geometry: &Geometry) -> Self {
        let Geometry::Profile { profile, start_mm, direction_deg, .. } = geometry else { panic!("{geometry:?}") };
        Self { pieces: profile.clone(), start: *start_mm, direction_deg: *direction_deg }
    }

    fn length(&self) -> f64 {
        self.pieces.iter().map(ProfilePiece::length_mm).sum()
    }

    /// y, z and the direction, radians, at a length from the start: of each piece its chord, 2 R sin of half its angle, in the mean
    /// of its directions.
    fn at(&self, mut left: f64) -> ([f64; 2], f64) {
        let ([mut y, mut z], mut heading) = (self.start, self.direction_deg.to_radians());
        for piece in &self.pieces {
            let length = piece.length_mm().min(left);
            left -= length;
            let turn = length / piece.length_mm() * piece.turn_deg().to_radians();
            let chord = if turn == 0.0 { length } else { length * (turn / 2.0).sin() / (turn / 2.0) };
            y += chord * (heading + turn / 2.0).cos();
            z += chord * (heading + turn / 2.0).sin();
            heading += turn;
        }
        ([y, z], heading)
    }

    /// Bending stiffness over E about y and about z of a thin-walled beam of this section, with the moment about the other axis
    /// zero, mm⁴.
    fn inertias(&self, thickness: f64) -> [f64; 2] {
        const STEPS: usize = 20_000;
        let step = self.length() / STEPS as f64;
        let points: Vec<([f64; 2], f64)> = (0..STEPS).map(|k| self.at((k as f64 + 0.5) * step)).collect();
        let mean = |of: &dyn Fn(&[f64; 2], f64) -> f64| {
            points.iter().map(|(point, heading)| of(point, *heading)).sum::<f64>() / STEPS as f64
        };
        let centre = [0, 1].map(|c| mean(&|point, _| point[c]));
        let area = thickness * self.length();
        // The wall's own bending: t²/12 times the squares of its normal (−sin, cos).
        let own = thickness * thickness / 12.0;
        let zz = area * mean(&|p, h| (p[0] - centre[0]).powi(2) + own * h.sin().powi(2));
        let yy = area * mean(&|p, h| (p[1] - centre[1]).powi(2) + own * h.cos().powi(2));
        let yz = area * mean(&|p, h| (p[0] - centre[0]) * (p[1] - centre[1]) - own * h.sin() * h.cos());
        [yy - yz * yz / zz, zz - yz * yz / yy]
    }
}

/// The profile of one flange of a TRAC boom, a C with lips of straight pieces, and half of a lenticular section: lips, arcs
/// the other way, and an arc of the dome.
const TRAC: &str = "profile = [{ line_mm = 8.0 }, { arc_deg = 105.0, radius_mm = 10.6 }]\nstart_mm = [0.0, -8.0]\n\
                    direction_deg = 90.0";
const CHANNEL: &str = "profile = [{ line_mm = 10.0 }, { arc_deg = -90.0, radius_mm = 3.0 }, { line_mm = 20.0 }, \
                       { arc_deg = -90.0, radius_mm = 3.0 }, { line_mm = 10.0 }]\ndirection_deg = 180.0";
const LENTICULAR: &str = "profile = [{ line_mm = 5.0 }, { arc_deg = 60.0, radius_mm = 12.0 }, \
                          { arc_deg = -120.0, radius_mm = 12.0 }, { arc_deg = 60.0, radius_mm = 12.0 }, { line_mm = 5.0 }]";

fn geometry(profile: &str) -> Geometry {
    let scene = read(&beam(profile, 300.0, [4, 12], "y"));
    assert_eq!(parse(&scene.to_toml(), "again.toml").unwrap(), scene);
    scene.geometry
}

/// A beam of steel-like carbon between rigid ends of which one turns about an axis, free in all else.
fn beam(profile: &str, length: f64, [along, across]: [usize; 2], axis: &str) -> String {
    let turns = ["x", "y", "z"]
        .map(|name| format!("rotation_{name}_deg = {}\n", if name == axis { "0.01" } else { "\"free\"" }))
        .concat();
    format!(
        "[geometry]\nkind = \"profile\"\nlength_mm = {length:?}\n{profile}\n[material]\nkind = \"isotropic\"\n\
         youngs_modulus_mpa = 131000.0\npoissons_ratio = 0.3\nthickness_mm = 0.1\n[mesh]\nelements = [{along}, {across}]\n\
         [load]\nkind = \"steps\"\nincrement = 1.0\n[solver]\ntolerance = 1e-10\n\
         [[support]]\nname = \"root\"\non = \"u-start\"\nkind = \"rigid\"\n\
         [[support]]\nname = \"tip\"\non = \"u-end\"\nkind = \"rigid\"\nx_mm = \"free\"\ny_mm = \"free\"\nz_mm = \"free\"\n{turns}\
         [[probe]]\nname = \"moment\"\nkind = \"reaction\"\nsupport = \"tip\"\ncomponent = \"moment-{axis}\"\n"
    )
}

/// On the same mesh the same bends alike, to rounding.
#[test]
fn a_profile_of_one_arc_is_a_cylinder_panel() {
    for arc_deg in [110.0, 200.0_f64] {
        let [sin, cos] = [(arc_deg / 2.0).to_radians().sin(), (arc_deg / 2.0).to_radians().cos()];
        let [panel, profile] = [
            format!("kind = \"cylinder-panel\"\nlength_mm = 60.0\nradius_mm = 20.0\narc_deg = {arc_deg:?}"),
            format!(
                "kind = \"profile\"\nlength_mm = 60.0\nprofile = [{{ arc_deg = {:?}, radius_mm = 20.0 }}]\n\
                 start_mm = [{:?}, {:?}]\ndirection_deg = {:?}",
                -arc_deg,
                -20.0 * sin,
                20.0 * cos,
                arc_deg / 2.0
            ),
        ]
        .map(|geometry| {
            end_of(&format!(
                "[geometry]\n{geometry}\n[material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70000.0\npoissons_ratio = 0.3\n\
                 thickness_mm = 0.3\n[mesh]\nelements = [6, 8]\n[load]\nkind = \"steps\"\nincrement = 0.5\n\
                 [solver]\ntolerance = 1e-12\n[[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
                 [[action]]\nkind = \"force\"\non = [1.0, 0.3]\nforce_n = [0.2, 0.1, -1.0]\n\
                 [[probe]]\nname = \"tip\"\nkind = \"displacement\"\non = [0.8, 0.3]\ncomponent = \"z\"\n\
                 [[probe]]\nname = \"normal\"\nkind = \"displacement\"\non = [0.7, 0.9]\ncomponent = \"normal\"\n"
            ))
        });
        let pairs = [
            (panel.strain_energy_n_mm, profile.strain_energy_n_mm),
            (probe(&panel, "tip"), probe(&profile, "tip")),
            (probe(&panel, "normal"), probe(&profile, "normal")),
        ];
        for (one, other) in pairs {
            println!("arc {arc_deg}: {one:e} {other:e}, {:.1e}", other / one - 1.0);
            assert!(one.abs() > 1e-3 && (other / one - 1.0).abs() < 1e-9, "arc {arc_deg}: {one:e} {other:e}");
        }
    }
}

/// Two arcs of 55° are one of 110°: on the same mesh but for the knot between them, which takes continuity of curvature away.
#[test]
fn an_arc_in_two_is_the_same_arc() {
    let moment = |pieces: &str, across: usize| {
        let profile = format!("profile = [{pieces}]\ndirection_deg = 55.0");
        probe(&end_of(&beam(&profile, 60.0, [12, across], "y")), "moment")
    };
    let whole = "{ arc_deg = -110.0, radius_mm = 10.0 }";
    let halves = "{ arc_deg = -55.0, radius_mm = 10.0 }, { arc_deg = -55.0, radius_mm = 10.0 }";
    for (across, tolerance) in [(8, 2e-5), (16, 3e-6)] {
        let [one, two] = [whole, halves].map(|pieces| moment(pieces, across));
        println!("{across} across: {one} {two}, {:.1e}", two / one - 1.0);
        assert!((two / one - 1.0).abs() < tolerance, "{across} across: {one} {two}");
    }
}

/// Slender beams of open sections that bend about y or z, with the section free to move the other way: E I/L of thin lines, and up
/// to 0.2 % more at L = 300 mm, for rigid ends keep the section from changing its shape; of twice the length half as much.
#[test]
fn thin_walled_sections_bend_as_beams() {
    for (name, profile, across) in [("TRAC", TRAC, 12), ("channel", CHANNEL, 16), ("lenticular half", LENTICULAR, 16)] {
        let inertias = Walk::of(&geometry(profile)).inertias(0.1);
        for (axis, inertia) in ["y", "z"].into_iter().zip(inertias) {
            let off = [300.0, 600.0].map(|length| {
                let moment = probe(&end_of(&beam(profile, length, [(length / 12.0) as usize, across], axis)), "moment");
                let expected = 131_000.0 * inertia / length * 0.01 * PI / 180.0;
                println!(
                    "{name} about {axis}, L {length}: {moment} for {expected}, {:.3} %",
                    100.0 * (moment / expected - 1.0)
                );
                moment / expected - 1.0
            });
            assert!((0.0..0.0025).contains(&off[0]), "{name} about {axis}: {off:?}");
            assert!((0.45..0.55).contains(&(off[1] / off[0])), "{name} about {axis}: {off:?}, not as 1/L");
        }
    }
}
