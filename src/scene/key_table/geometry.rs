//! Keys of `[geometry]`.

use crate::scene::keys::Presence::{Default, Follows, Unless};
use crate::scene::keys::{Key, Kind, Length, Limit, Limits, Section, choice};

/// A length of the shell: positive, and no more than a kilometre.
pub(super) const SHELL_LENGTH: Limits = Limits {
    low: Limit::excluded(0.0, "a shell without extent has nothing to fold"),
    high: Limit::included(1e6, "more than a kilometre; the value is in mm"),
};

/// Kinds that may close in a full turn.
const ROUND: &[&str] = &["cylinder-panel", "annulus", "sphere-zone"];
const NURBS: &[&str] = &["nurbs"];
const PROFILE: &[&str] = &["profile"];

const fn geometry(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("geometry", name, kind, example)
}

pub(super) static GEOMETRY: &[Key] = &[
    geometry("kind", Kind::Word(&[
        choice("tape-spring", "open circular cylinder: axis along x, the apex of the arc up, edges down"),
        choice("plate", "rectangle in the plane z = 0: u along x from 0 to length_mm, v along y from 0 to width_mm, n = +z"),
        choice(
            "cylinder-panel",
            "circular cylinder of any arc about the x axis: u along x from 0, v along the arc towards +y; the middle of the \
             arc is on top, at z = radius; n outwards",
        ),
        choice(
            "annulus",
            "flat ring or a sector of it about the origin, z = 0: u from the inner to the outer radius, v counterclockwise \
             from the +x axis; n = +z",
        ),
        choice(
            "sphere-zone",
            "part of a sphere about the origin between two latitudes: u along the longitude, counterclockwise from the +x \
             axis; v along the latitude towards +z; n outwards",
        ),
        choice(
            "profile",
            "cylinder over straight pieces and arcs in the y-z plane that go on in each other's direction: u along x from 0, v along \
             the profile; n on its left, seen with y to the right and z up (on +z where it runs towards +y); mesh.elements are \
             shared out over the pieces by their lengths, at least one for each, and more for an arc beyond 150 degrees",
        ),
        choice(
            "nurbs",
            "any smooth surface of one patch, without folds and poles; mesh.elements are shared out over the spans between \
             its knots by their lengths, at least one for each",
        ),
    ]), "\"tape-spring\"")
        .means("Shape of the shell.")
        .also_called(&["type", "shape"]),
    geometry("length_mm", Kind::Number(SHELL_LENGTH), "300.0")
        .of(&["tape-spring", "plate", "cylinder-panel", "profile"])
        .means("Length along the axis, or along x.")
        .also_called(&["l"]),
    geometry("width_mm", Kind::Number(SHELL_LENGTH), "50.0")
        .of(&["plate"])
        .means("Width along y.")
        .also_called(&["w", "b", "breadth"]),
    geometry("radius_mm", Kind::Number(SHELL_LENGTH), "10.0")
        .of(&["tape-spring", "cylinder-panel", "sphere-zone"])
        .means("Radius of the mid-surface of the cross-section, or of the sphere.")
        .also_called(&["r"]),
    geometry("inner_radius_mm", Kind::Number(SHELL_LENGTH), "6.0")
        .of(&["annulus"])
        .means("Inner radius.")
        .also_called(&["r_inner", "ri"]),
    geometry("outer_radius_mm", Kind::Number(SHELL_LENGTH), "10.0")
        .of(&["annulus"])
        .means("Outer radius.")
        .also_called(&["r_outer", "ro"]),
    geometry("arc_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "without an arc there is no cross-section"),
        high: Limit::excluded(360.0, "at 360 degrees the cross-section closes, and the shell is no longer open"),
    }), "110.0")
        .of(&["tape-spring"])
        .means("Angle that the whole cross-section subtends.")
        .also_called(ANGLES),
    geometry("arc_deg", Kind::Number(Limits {
        low: Limit::excluded(0.0, "without an arc there is no surface"),
        high: Limit::included(360.0, "at 360 degrees the turn is full"),
    }), "90.0")
        .of(ROUND)
        .means("Angle that the cross-section, the sector or the longitudes of the zone subtend.")
        .also_called(ANGLES),
    geometry("latitude_deg", Kind::Numbers(Length::Exactly(2), Limits {
        low: Limit::excluded(-90.0, POLE),
        high: Limit::excluded(90.0, POLE),
    }), "[0.0, 72.0]")
        .of(&["sphere-zone"])
        .means("From which latitude to which, from the equator.")
        .also_called(&["latitudes_deg", "latitudes"]),
    geometry("from_deg", Kind::Number(Limits {
        low: Limit::excluded(-360.0, "an arc starts within a turn"),
        high: Limit::included(360.0, "an arc starts within a turn"),
    }), "0.0")
        .of(ROUND)
        .means("Where the arc starts: from the top towards +y, or from the +x axis counterclockwise.")
        .or(Follows("half an arc before the top of a cylinder panel, and else 0.0"))
        .also_called(&["start_deg"]),
    geometry("profile", Kind::Tables, "[{ line_mm = 8.0 }, { arc_deg = 105.0, radius_mm = 10.6 }]")
        .list_of(&PIECE)
        .of(PROFILE)
        .means(
            "The profile, piece by piece: { line_mm = 8.0 } goes straight on, { arc_deg = 105.0, radius_mm = 10.6 } turns to the \
             left, the side of n, and an arc of a negative angle to the right. Fractions of v are those of its length.",
        )
        .also_called(&["pieces", "section", "cross_section"]),
    geometry("start_mm", Kind::Numbers(Length::Exactly(2), Limits::ANY), "[0.0, -8.0]")
        .of(PROFILE)
        .means("y and z where the profile starts.")
        .or(Default("[0.0, 0.0]"))
        .also_called(&["origin", "from"]),
    geometry("direction_deg", Kind::Number(Limits {
        low: Limit::included(-360.0, "a direction is within a turn"),
        high: Limit::included(360.0, "a direction is within a turn"),
    }), "90.0")
        .of(PROFILE)
        .means("Direction of the profile at its start, from +y towards +z.")
        .or(Default("0.0"))
        .also_called(&["heading", "start_direction"]),
    geometry("degrees", Kind::Pair(Limits {
        low: Limit::included(1.0, "a surface of degree 0 falls apart"),
        high: Limit::included(5.0, "write a surface of a higher degree as one of degree 5 or less"),
    }), "[1, 2]")
        .of(NURBS)
        .means("Polynomial degrees in u and v; mesh.degree may be higher.")
        .or(Unless("file"))
        .also_called(&["degree", "order"]),
    geometry("knots_u", Kind::Numbers(Length::Any, Limits::ANY), "[0.0, 0.0, 1.0, 1.0]")
        .of(NURBS)
        .means("Knots in u, clamped and ascending: the first and the last occur degree + 1 times.")
        .or(Unless("file")),
    geometry("knots_v", Kind::Numbers(Length::Any, Limits::ANY), "[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]")
        .of(NURBS)
        .means("Knots in v.")
        .or(Unless("file")),
    geometry("control_points_mm", Kind::Rows(3), "[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]")
        .of(NURBS)
        .means("x, y, z of each control point, not times its weight; v runs fastest.")
        .or(Unless("file"))
        .also_called(&["points", "control_net", "net"]),
    geometry("weights", Kind::Numbers(Length::Any, Limits {
        low: Limit::excluded(0.0, "a weight of 1 is that of an ordinary control point; take `weights` out where the surface is not rational"),
        high: Limit::NONE,
    }), "[1.0, 1.0]")
        .of(NURBS)
        .means("Weight of each control point, in the same order.")
        .or(Follows("all 1")),
    geometry("file", Kind::Text, "\"shell.json\"")
        .of(NURBS)
        .means(
            "A JSON object with degrees, knots_u, knots_v, control_points_mm and perhaps weights; its path is relative to the \
             scene file.",
        )
        .or(Follows("the surface is in the scene"))
        .also_called(&["path", "json"]),
    geometry("seam", Kind::Word(&[
        choice("smooth", "a closed turn; of a nurbs surface in both directions where both close"),
        choice("free", "a slit"),
    ]), "\"smooth\"")
        .of(&["cylinder-panel", "annulus", "sphere-zone", "nurbs"])
        .means("What a full turn does where it meets itself: given for 360 degrees, or where opposite edges coincide, and only there.")
        .or(Follows("none; a full turn needs one"))
        .also_called(&["joint", "closure"]),
];

const ANGLES: &[&str] = &["alpha", "α", "angle", "angle_deg", "arc_angle", "arc_angle_deg", "subtended_angle_deg"];

/// Why no pole belongs to a zone.
const POLE: &str = "at a pole (90 degrees) an edge would collapse to a point; leave a small hole";

const fn piece(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("geometry.profile", name, kind, example)
}

/// A piece of a profile.
static PIECE: Section = Section {
    name: "geometry.profile",
    many: true,
    required: true,
    meaning: "A piece of the profile: a straight line or an arc.",
    keys: &[
        piece(
            "arc_deg",
            Kind::Number(Limits {
                low: Limit::excluded(-360.0, "at a full turn the profile meets itself"),
                high: Limit::excluded(360.0, "at a full turn the profile meets itself"),
            }),
            "105.0",
        )
        .means("Angle of an arc: positive to the left, the side of n, negative to the right.")
        .or(Unless("line_mm"))
        .also_called(ANGLES),
        piece("radius_mm", Kind::Number(SHELL_LENGTH), "10.6")
            .means("Radius of an arc.")
            .or(Unless("line_mm"))
            .also_called(&["r"]),
        piece("line_mm", Kind::Number(SHELL_LENGTH), "8.0")
            .means("Length of a straight piece.")
            .or(Unless("arc_deg"))
            .also_called(&["length", "l", "straight"]),
    ],
};
