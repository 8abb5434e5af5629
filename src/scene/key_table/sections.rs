//! Keys of `[[spring]]` and `[[mass]]`.

use super::structure::LABELS;
use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::Reach::Names;
use crate::scene::keys::{Key, Kind, Length, Limit, Limits};

const STIFFNESS: Kind = Kind::Numbers(
    Length::Exactly(3),
    Limits { low: Limit::included(0.0, "a spring of negative stiffness pushes away from its rest"), high: Limit::NONE },
);

const fn spring(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("spring", name, kind, example)
}

const fn mass(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("mass", name, kind, example)
}

pub(super) static SPRING: &[Key] = &[
    spring("name", Kind::Text, "\"hinge\"")
        .means("What probes and errors call it; no two springs and supports have the same.")
        .or(Follows("\"spring 1\", \"spring 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    spring("section", Kind::Text, "\"tip\"").means("Name of the rigid section: a [[support]] of kind \"rigid\".").also_called(&["support", "on"]),
    spring("translation_n_per_mm", STIFFNESS, "[0.0, 0.0, 5.0]")
        .means("Force for a translation of the section's reference point by 1 mm along x, y and z.")
        .or(Default("[0.0, 0.0, 0.0]"))
        .also_called(&["stiffness_n_per_mm", "translation"]),
    spring("rotation_n_mm_per_deg", STIFFNESS, "[0.0, 20.0, 0.0]")
        .means(
            "Moment for a turn by 1 degree about x, y and z: its energy is that of the components of the section's rotation vector, \
             which is to stay below half a turn.",
        )
        .or(Default("[0.0, 0.0, 0.0]"))
        .also_called(&["stiffness_n_mm_per_deg", "rotation"]),
];

pub(super) static MASS: &[Key] = &[
    mass("name", Kind::Text, "\"payload\"")
        .means("What errors call it.")
        .or(Follows("\"mass 1\", \"mass 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    mass("section", Kind::Text, "\"tip\"")
        .means("Name of the rigid section: a [[support]] of kind \"rigid\".")
        .also_called(&["support", "on"]),
    mass(
        "mass_kg",
        Kind::Number(Limits { low: Limit::excluded(0.0, "a point without mass has no effect"), high: Limit::NONE }),
        "0.25",
    )
    .means("The mass.")
    .also_called(&["mass", "m_kg"]),
    mass("at_mm", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[310.0, 0.0, 0.0]")
        .means("Where it is while the section is not moved; it may lie off the shell.")
        .or(Follows("the reference point of the section"))
        .also_called(&["position_mm", "at", "position"]),
];
