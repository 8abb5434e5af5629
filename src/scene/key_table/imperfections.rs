//! Keys of `[[imperfection]]`.

use super::structure::LABELS;
use crate::scene::keys::Presence::{Default, Follows, Unless};
use crate::scene::keys::Reach::Names;
use crate::scene::keys::{Key, Kind, Length, Limit, Limits, choice};

/// Seeds of 32 bits, which are exact as numbers of any program.
const SEED: Limits = Limits {
    low: Limit::included(0.0, "a seed has no sign"),
    high: Limit::included(4_294_967_295.0, "no more bits are needed: 2^32 - 1 is the largest"),
};

const MODES: Limits = Limits {
    low: Limit::included(1.0, "modes are counted from 1, the lowest"),
    high: Limit::included(200.0, "finding so many modes takes longer than a run"),
};

const FRACTION: Limits = Limits {
    low: Limit::included(0.0, "the surface begins at 0"),
    high: Limit::included(1.0, "the surface ends at 1"),
};

const fn imperfection(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("imperfection", name, kind, example)
}

pub(super) static IMPERFECTION: &[Key] = &[
    imperfection("name", Kind::Text, "\"out of round\"")
        .means("What errors and remarks call it, and settings: `--set imperfection.NAME.seed=3`.")
        .or(Follows("\"imperfection 1\", \"imperfection 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    imperfection("kind", Kind::Word(&[
        choice(
            "modes",
            "modes of linear buckling of the perfect structure about its undeformed state, under its loads at factor 1, as \
             `foldline stability LOG --step 0 --buckling N` shows them: one, or a random combination of several",
        ),
        choice(
            "random-field",
            "a homogeneous Gaussian field of offsets in x, y and z, a function of the place in space: shells that meet move alike. \
             Points at a distance r have the correlation exp(-(r/l)^2)",
        ),
        choice("grid", "offsets along the normal of one shell, measured on a grid of u and v; between them a cubic spline"),
    ]), "\"modes\"")
        .means("How the undeformed surface differs from the perfect one. It is free of stress.")
        .also_called(&["type"]),
    imperfection("modes", Kind::Numbers(Length::Any, MODES), "[1]")
        .of(&["modes"])
        .means("Numbers of the modes, the lowest load factor first. Several are combined at random, by `seed`.")
        .also_called(&["mode"]),
    imperfection("amplitude", Kind::Number(Limits::ANY), "0.5")
        .of(&["modes"])
        .means("Largest offset, in thicknesses of the thinnest shell. A negative one turns a single mode round.")
        .also_called(&["size", "amplitudes"]),
    imperfection("seed", Kind::Count(SEED), "1")
        .of(&["modes"])
        .means("Seed of the weights of several modes, which are normally distributed.")
        .or(Follows("there is one mode, which needs none")),
    imperfection("seed", Kind::Count(SEED), "1")
        .of(&["random-field"])
        .means("Seed of the field: the same seed gives the same field on every machine and mesh."),
    imperfection(
        "correlation_mm",
        Kind::Number(Limits {
            low: Limit::excluded(0.0, "a field without correlation has no surface"),
            high: Limit::included(1e6, "more than a kilometre; the value is in mm"),
        }),
        "20.0",
    )
    .of(&["random-field"])
    .means("Distance l at which the correlation has fallen to 1/e.")
    .also_called(&["correlation_length_mm", "correlation_length", "wavelength_mm"]),
    imperfection(
        "deviation",
        Kind::Number(Limits { low: Limit::excluded(0.0, "a field without deviation is none"), high: Limit::NONE }),
        "0.2",
    )
    .of(&["random-field"])
    .means("Standard deviation of the offset along any direction, in thicknesses of the thinnest shell.")
    .also_called(&["sigma", "standard_deviation", "amplitude", "rms"]),
    imperfection("shell", Kind::Text, "\"web\"")
        .of(&["grid"])
        .means("Shell that was measured.")
        .or(Follows("the only shell")),
    imperfection("file", Kind::Text, "\"offsets.csv\"")
        .of(&["grid"])
        .means(
            "A CSV file with the header u,v,offset_mm and a row for each point of a full grid of fractions of u and v, v running \
             fastest, both from 0 to 1; its path is relative to the scene file.",
        )
        .or(Follows("the offsets are in the scene"))
        .also_called(&["path", "csv"]),
    imperfection("u", Kind::Numbers(Length::Any, FRACTION), "[0.0, 0.5, 1.0]")
        .of(&["grid"])
        .means("Fractions of u, from 0 to 1.")
        .or(Unless("file")),
    imperfection("v", Kind::Numbers(Length::Any, FRACTION), "[0.0, 1.0]")
        .of(&["grid"])
        .means("Fractions of v, from 0 to 1.")
        .or(Unless("file")),
    imperfection("offsets_mm", Kind::Numbers(Length::Any, Limits::ANY), "[0.0, 0.0, 0.1, 0.1, 0.0, 0.0]")
        .of(&["grid"])
        .means("Offsets along the normal at each pair of u and v; v runs fastest.")
        .or(Unless("file"))
        .also_called(&["offset_mm", "offsets"]),
    imperfection("scale", Kind::Number(Limits::ANY), "1.0")
        .of(&["grid"])
        .means("Factor of the offsets.")
        .or(Default("1.0"))
        .also_called(&["factor"]),
];
