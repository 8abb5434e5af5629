//! Keys of `[[shell]]`, `[[joint]]` and `[[bond]]`.

use super::structure::LABELS;
use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::Reach::Names;
use crate::scene::keys::{Key, Kind, Length, Limit, Limits, choice};

/// Factor of a stiffness that stands for a rigid connection.
const FACTOR: Limits = Limits {
    low: Limit::excluded(0.0, "a connection without stiffness joins nothing"),
    high: Limit::included(1e6, "beyond that the equations are badly conditioned"),
};

const fn shell(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("shell", name, kind, example)
}

const fn joint(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("joint", name, kind, example)
}

const fn bond(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("bond", name, kind, example)
}

pub(super) static SHELL: &[Key] = &[
    shell("name", Kind::Text, "\"web\"")
        .means("What joints, bonds, supports, actions and probes call it; no two shells have the same, and none has a point in it.")
        .also_called(LABELS),
    shell("position_mm", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.0, 0.0, 0.0]")
        .means("Where the origin of the shell's own axes lies.")
        .or(Default("[0.0, 0.0, 0.0]"))
        .also_called(&["position", "origin", "origin_mm"]),
    shell("x_axis", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[1.0, 0.0, 0.0]")
        .means("Direction of the shell's own x axis, of any length.")
        .or(Default("[1.0, 0.0, 0.0]"))
        .also_called(&["x"]),
    shell("y_axis", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.0, 1.0, 0.0]")
        .means("Direction of the shell's own y axis, of any length, at right angles to x_axis; z follows as on a right hand.")
        .or(Default("[0.0, 1.0, 0.0]"))
        .also_called(&["y"]),
];

pub(super) static JOINT: &[Key] = &[
    joint("name", Kind::Text, "\"seam\"")
        .means("What reports and errors call it.")
        .or(Follows("\"joint 1\", \"joint 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    joint("kind", Kind::Word(&[
        choice("smooth", "one surface goes on in the other: displacement and slope are continuous"),
        choice("kept-angle", "the angle between the two surfaces, whatever it is, stays: a web, a folded plate"),
        choice("hinge", "displacements are continuous, and the angle is free"),
    ]), "\"kept-angle\"")
        .means("How the edges are joined.")
        .also_called(&["type"]),
    joint("edges", Kind::Edges(Length::Exactly(2)), "[\"web.v-end\", \"flange.v-start\"]")
        .means(
            "The two edges; the shorter one lies on the longer. Where both have the same points and knots, or one has all knots of \
             the other, they share their control points and every knot that comes later; else penalties hold them together.",
        )
        .also_called(&["on", "between"]),
    joint("stiffness", Kind::Number(FACTOR), "1000.0")
        .means(
            "Factor of the penalties: on the angle in D/h, on the displacement in A/h, of the stiffer shell, with h the mean length \
             of the elements on both sides. An angle opens by about curvature times h over this.",
        )
        .or(Default("1000.0")),
];

pub(super) static BOND: &[Key] = &[
    bond("name", Kind::Text, "\"glue\"")
        .means("What reports and errors call it.")
        .or(Follows("\"bond 1\", \"bond 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    bond("shells", Kind::Texts(Length::Exactly(2)), "[\"left\", \"right\"]")
        .means("The two shells, glued wherever their faces lie together.")
        .also_called(&["between"]),
    bond(
        "gap_mm",
        Kind::Number(Limits {
            low: Limit::included(0.0, "faces that cross each other are not glued"),
            high: Limit::NONE,
        }),
        "0.0001",
    )
    .means("Largest distance of faces that are glued; they keep the distance that they have.")
    .or(Follows("a thousandth of the mean thickness"))
    .also_called(&["tolerance_mm", "gap"]),
    bond("stiffness", Kind::Number(FACTOR), "5.0")
        .means("Stiffness of the layer, in E/t of the stiffer shell: a real layer has about 1 to 10.")
        .or(Default("5.0")),
];
