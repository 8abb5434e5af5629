//! Keys of `[output]` and `[expect]`.

use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::Reach::Free;
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

const fn output(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("output", name, kind, example)
}

const fn expect(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("expect", name, kind, example)
}

pub(super) static OUTPUT: &[Key] = &[
    output(
        "sync",
        Kind::Word(&[
            choice("each-stage", "after every stage"),
            choice("each-second", "at most once a second, and at the end"),
            choice("at-end", "at the end only"),
        ]),
        "\"each-second\"",
    )
    .means("When the log is forced to disk; a killed process loses nothing either way, a power cut may.")
    .or(Default("\"each-second\""))
    .reaches(Free)
    .also_called(&["fsync", "flush"]),
    output("mesh_history", Kind::Switch, "true")
        .means("Whether the deformed mesh is written for viewers after every stage that changes it.")
        .or(Default("false"))
        .reaches(Free)
        .also_called(&["history", "meshes"]),
    output(
        "units",
        Kind::Word(&[
            choice("keys", "those that the names of keys end in"),
            choice("own", "units of the scene's own that go together, as in benchmarks without units"),
        ]),
        "\"keys\"",
    )
    .means("The units that the numbers of the scene are in. None is converted; numbers that look odd in the units of their keys \
            are warned of, and with \"own\" none is.")
    .or(Default("\"keys\""))
    .reaches(Free)
    .also_called(&["unit_system"]),
];

pub(super) static EXPECT: &[Key] = &[
    expect("outcome", Kind::Word(&[
        choice("finished", "at its target"),
        choice("refused", "before its first step: mesh, supports and loads do not go together"),
        choice("no-equilibrium", "where no increment, however small, leads to an equilibrium"),
        choice("jump-not-followed", "at a jump beyond which no equilibrium is found"),
        choice("not-re-equilibrated", "on a refined mesh that has no equilibrium"),
        choice("refined-too-far", "where refinement asks for more than memory holds"),
        choice("path-lost", "where a path by arc length cannot be followed, however short the step"),
        choice("path-too-long", "where a path by arc length has taken all the steps that it may"),
    ]), "\"finished\"")
        .means("How the run ends.")
        .or(Default("\"finished\""))
        .reaches(Free)
        .also_called(&["end", "ending", "result"]),
    expect("same_as", Kind::Text, "\"millimetres.toml\"")
        .means("A scene in the same folder that has the same curve but for units: M/(E t^3) over the rotation (of other \
              scenes the strain energy over E t^3) agrees at every equilibrium to 1e-9 of the largest.")
        .or(Follows("no other scene"))
        .reaches(Free)
        .also_called(&["equals", "same"]),
    expect("least_bits", Kind::Count(Limits {
        low: Limit::included(1.0, "a result of which nothing survives says nothing"),
        high: Limit::included(52.0, "numbers have no more"),
    }), "10")
        .means("Bits of the result that survive where an input changes in its last place; fewer than ten only where the \
              shell has several ways to fall and rounding decides between them.")
        .or(Default("10"))
        .reaches(Free)
        .also_called(&["bits", "significant_bits"]),
    expect("peak", Kind::Number(Limits::ANY), "292.0")
        .means("The largest moment before the first jump (N mm; of other scenes the first probe, or else the strain energy), \
              from a closed form or a finer mesh.")
        .or(Follows("nothing to be compared with"))
        .reaches(Free)
        .also_called(&["largest", "maximum"]),
    expect("last", Kind::Number(Limits::ANY), "28.3")
        .means("The same at the last equilibrium.")
        .or(Follows("nothing to be compared with"))
        .reaches(Free)
        .also_called(&["value", "reference"]),
    expect("within", Kind::Number(Limits {
        low: Limit::excluded(0.0, "no run is without error"),
        high: Limit::excluded(1.0, "an error as large as the value says nothing of it"),
    }), "0.05")
        .means("The largest error of `peak` and `last`, relative to them.")
        .or(Default("0.02"))
        .reaches(Free)
        .also_called(&["tolerance", "error", "relative_error"]),
    expect("inexact", Kind::Text, "\"elements of 75 mm hold no fold\"")
        .means("Why that is more than 2 %.")
        .or(Follows("right to 2 %"))
        .reaches(Free)
        .also_called(&["because", "reason"]),
];
