//! Keys of `[output]` and `[expect]`.

use crate::scene::keys::Presence::{Default, Follows};
use crate::scene::keys::Reach::Free;
use crate::scene::keys::Unit::None;
use crate::scene::keys::{Key, Kind, Limit, Limits, choice};

pub static SYNC: Key = Key {
    section: "output",
    name: "sync",
    unit: None,
    kind: Kind::Word(&[
        choice("each-stage", "after every stage"),
        choice("each-second", "at most once a second, and at the end"),
        choice("at-end", "at the end only"),
    ]),
    presence: Default("\"each-second\""),
    reach: Free,
    meaning: "When the log is forced to disk; a killed process loses nothing either way, a power cut may.",
    example: "\"each-second\"",
    aliases: &["fsync", "flush"],
};

pub static MESH_HISTORY: Key = Key {
    section: "output",
    name: "mesh_history",
    unit: None,
    kind: Kind::Switch,
    presence: Default("false"),
    reach: Free,
    meaning: "Whether the deformed mesh is written for viewers after every stage that changes it.",
    example: "true",
    aliases: &["history", "meshes"],
};

pub static OUTCOME: Key = Key {
    section: "expect",
    name: "outcome",
    unit: None,
    kind: Kind::Word(&[
        choice("finished", "at its target"),
        choice("refused", "before its first step: mesh, supports and loads do not go together"),
        choice("no-equilibrium", "where no increment, however small, leads to an equilibrium"),
        choice("jump-not-followed", "at a jump beyond which no equilibrium is found"),
        choice("not-re-equilibrated", "on a refined mesh that has no equilibrium"),
        choice("refined-too-far", "where refinement asks for more than memory holds"),
        choice("path-lost", "where a path by arc length cannot be followed, however short the step"),
        choice("path-too-long", "where a path by arc length has taken all the steps that it may"),
    ]),
    presence: Default("\"finished\""),
    reach: Free,
    meaning: "How the run ends.",
    example: "\"finished\"",
    aliases: &["end", "ending", "result"],
};

pub static SAME_AS: Key = Key {
    section: "expect",
    name: "same_as",
    unit: None,
    kind: Kind::Text,
    presence: Follows("no other scene"),
    reach: Free,
    meaning: "A scene in the same folder that has the same curve but for units: M/(E t^3) over the rotation (of other \
              scenes the strain energy over E t^3) agrees at every equilibrium to 1e-9 of the largest.",
    example: "\"millimetres.toml\"",
    aliases: &["equals", "same"],
};

pub static LEAST_BITS: Key = Key {
    section: "expect",
    name: "least_bits",
    unit: None,
    kind: Kind::Count(Limits {
        low: Limit::included(1.0, "a result of which nothing survives says nothing"),
        high: Limit::included(52.0, "numbers have no more"),
    }),
    presence: Default("10"),
    reach: Free,
    meaning: "Bits of the result that survive where an input changes in its last place; fewer than ten only where the \
              shell has several ways to fall and rounding decides between them.",
    example: "10",
    aliases: &["bits", "significant_bits"],
};

const ANY_NUMBER: Limits = Limits { low: Limit::excluded(f64::NEG_INFINITY, ""), high: Limit::NONE };

pub static PEAK: Key = Key {
    section: "expect",
    name: "peak",
    unit: None,
    kind: Kind::Number(ANY_NUMBER),
    presence: Follows("nothing to be held against"),
    reach: Free,
    meaning: "The largest moment before the first jump (N mm; of other scenes the first probe, or else the strain energy), \
              from a closed form or a finer mesh.",
    example: "292.0",
    aliases: &["largest", "maximum"],
};

pub static LAST: Key = Key {
    section: "expect",
    name: "last",
    unit: None,
    kind: Kind::Number(ANY_NUMBER),
    presence: Follows("nothing to be held against"),
    reach: Free,
    meaning: "The same at the last equilibrium.",
    example: "28.3",
    aliases: &["value", "reference"],
};

pub static INEXACT: Key = Key {
    section: "expect",
    name: "inexact",
    unit: None,
    kind: Kind::Text,
    presence: Follows("right to 2 %"),
    reach: Free,
    meaning: "Why the run may be off `peak` or `last` by more than 2 %.",
    example: "\"elements of 75 mm hold no fold\"",
    aliases: &["because", "reason"],
};
