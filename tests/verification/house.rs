//! The order of the house: who imports from whom, and what stands where.

use crate::imports::{Import, Sources, Token, circles, imports, sources, tokens};

/// From the bottom of the stack to its top: each folder imports only from those before it.
const ORDER: [&str; 23] = [
    "units",
    "printable",
    "digest",
    "platform",
    "whole_file",
    "spline",
    "scene",
    "shell",
    "model",
    "energy",
    "state",
    "equilibrium",
    "adapt",
    "record",
    "pipeline",
    "journal",
    "history",
    "study",
    "sweep",
    "view",
    "cli",
    "guide",
    "main",
];

/// Lines of a file at most.
const LONGEST_FILE: usize = 500;

/// The place of a file's folder in the stack.
fn rank(file: &str) -> usize {
    let folder = file.split('/').next().unwrap_or_default().trim_end_matches(".rs");
    let place = ORDER.iter().position(|known| *known == folder);
    place.unwrap_or_else(|| panic!("{folder} is not in the list of the house"))
}

fn lines<'a>(imports: impl IntoIterator<Item = &'a Import>) -> String {
    let line = |Import { from, line, to, path }: &Import| format!("{from}:{line}: {path}, of {to}\n");
    imports.into_iter().map(line).collect()
}

#[test]
fn folders_import_only_from_those_above() {
    let imports = imports(&sources());
    assert!(imports.len() > 1000, "{} imports", imports.len());
    let offences = imports.iter().filter(|import| rank(&import.to) > rank(&import.from));
    let offences = lines(offences);
    assert!(offences.is_empty(), "imports from below:\n{offences}");
}

#[test]
fn files_import_from_each_other_in_no_circle() {
    let imports = imports(&sources());
    let circles: Vec<String> = circles(&imports).into_iter().map(lines).collect();
    assert!(circles.is_empty(), "files import from each other:\n{}", circles.join("and\n"));
}

#[test]
fn no_file_is_too_long() {
    let counts = sources().into_iter().map(|(file, text)| (text.lines().count(), file));
    let long: Vec<_> = counts.filter(|(lines, _)| *lines > LONGEST_FILE).collect();
    assert!(long.is_empty(), "more than {LONGEST_FILE} lines: {long:?}");
}

/// Every folder says what its files are for: each stands in a table at the top of `mod.rs`.
#[test]
fn every_file_stands_in_the_table_of_its_folder() {
    let sources = sources();
    let mut missing = Vec::new();
    for (folder, text) in sources.iter().filter_map(|(file, text)| Some((file.strip_suffix("mod.rs")?, text))) {
        let tables: Vec<&str> = text.lines().filter(|line| line.starts_with("//! |")).collect();
        for file in sources.keys().filter_map(|file| file.strip_prefix(folder)) {
            let name = file.trim_end_matches("/mod.rs").trim_end_matches(".rs");
            let is_below = name.contains('/') || ["mod", "tests"].contains(&name);
            if !is_below && !tables.iter().any(|line| line.contains(&format!("`{name}`"))) {
                missing.push(format!("{folder}{name}"));
            }
        }
    }
    assert!(missing.is_empty(), "in no table: {missing:?}");
}

/// Numbers of control points, elements and samples are [`foldline::spline::Grid`]'s to form: elsewhere nothing is multiplied
/// with, divided by or cut at the count of the second direction. Nor is a weight taken out of coordinates.
#[test]
fn index_arithmetic_stands_in_the_spline_folder_alone() {
    let sources = sources();
    let elsewhere = sources.iter().filter(|(file, _)| !file.starts_with("spline/"));
    let found: Vec<String> = elsewhere
        .flat_map(|(file, text)| index_arithmetic(text).into_iter().map(move |at| format!("{file}:{at}")))
        .collect();
    assert!(found.is_empty(), "index arithmetic:\n{}", found.join("\n"));
}

/// Lines on which something is multiplied with n₂, divided by it, or cut at it, or [x, y, z] by w.
fn index_arithmetic(text: &str) -> Vec<usize> {
    let tokens = tokens(text);
    let at = |k: usize| tokens.get(k).map_or("", |token| token.0.as_str());
    let is_value = |k: usize| at(k).ends_with(|c: char| c.is_alphanumeric() || matches!(c, ')' | ']' | '_'));
    let names = names_of_second_count(&tokens);
    let lines = (0..tokens.len()).filter(|&k| {
        // What n₂ goes by: a name that the file gives it, counts[1], control_counts()[1].
        let end = match at(k) {
            name if name == "n2" || names.contains(&name) => k + 1,
            word if word.ends_with("counts") && at(k + 1) == "[" && at(k + 2) == "1" => k + 4,
            word if word.ends_with("counts") && at(k + 1) == "(" && at(k + 4) == "1" => k + 6,
            "x" => return at(k + 1) == "/" && at(k + 2) == "w" && at(k + 5) == "/" && at(k + 6) == "w",
            _ => return false,
        };
        // What it is a field of stands in front of it.
        let mut begin = k;
        while begin >= 2 && at(begin - 1) == "." {
            begin -= 2;
        }
        let before = begin >= 2 && matches!(at(begin - 1), "*" | "/" | "%") && is_value(begin - 2);
        let after = matches!(at(end), "*" | "/" | "%") && (is_value(end + 1) || at(end + 1) == "(");
        let cut = begin >= 2 && at(begin - 1) == "(" && matches!(at(begin - 2), "chunks" | "chunks_exact" | "step_by");
        (before || after || cut) && at(end) != "["
    });
    lines.map(|k| tokens[k].1).collect()
}

/// The names that a file gives n₂: `let [_, name] = grid.counts;` and `let name = mesh.control_counts()[1];`.
fn names_of_second_count(tokens: &[Token]) -> Vec<&str> {
    let at = |k: usize| tokens.get(k).map_or("", |token| token.0.as_str());
    let before = |end: usize, back: usize| at(end.wrapping_sub(back));
    let counts_end = |end: usize| match before(end, 1) {
        ")" => before(end, 2) == "(" && before(end, 3).ends_with("counts"),
        word => word.ends_with("counts"),
    };
    let named = |k: usize| {
        let end = (k..tokens.len()).find(|end| at(*end) == ";")?;
        let is_pair = at(k + 1) == "[" && at(k + 3) == "," && at(k + 5) == "]";
        let is_second = [3, 2, 1].map(|back| before(end, back)) == ["[", "1", "]"];
        match is_pair {
            true => counts_end(end).then(|| at(k + 4)),
            false => (at(k + 2) == "=" && is_second && counts_end(end - 3)).then(|| at(k + 1)),
        }
    };
    (0..tokens.len()).filter(|k| at(*k) == "let").filter_map(named).collect()
}

#[test]
fn index_arithmetic_is_seen() {
    for wrong in [
        "i * n2 + j",
        "k % self.counts[1]",
        "points.chunks(n2)",
        "n2 * (i + 1)",
        "k / mesh.control_counts()[1]",
        "let [rows, columns] = mesh.control_counts();\ni * columns + j",
        "let width = self.grid.counts[1];\npoints.chunks(width)",
        "let [x, y, z, w] = p;\n[x / w, y / w, z / w]",
    ] {
        assert!(!index_arithmetic(wrong).is_empty(), "{wrong}");
    }
    for right in [
        "let [n1, n2] = counts;",
        "f(*n2)",
        "let [a, b] = grid.counts;\na * c",
        "counts[1] - 1",
        "a * counts[1][e]",
        "format!(\"i * n2\") // i * n2",
    ] {
        assert!(index_arithmetic(right).is_empty(), "{right}");
    }
}

/// A made-up crate.
fn made_up(files: &[(&str, &str)]) -> Sources {
    let top = ("lib.rs", "");
    [top].iter().chain(files).map(|(file, text)| (file.to_string(), text.to_string())).collect()
}

/// What the files of a made-up crate import from each other, in words.
fn found(files: &[(&str, &str)]) -> Vec<String> {
    imports(&made_up(files)).into_iter().map(|Import { from, to, .. }| format!("{from} {to}")).collect()
}

#[test]
fn imports_are_seen_however_they_are_written() {
    let both = ["a/one.rs a/two.rs"];
    let two = ("a/two.rs", "pub struct Two; pub fn two() {}");
    let folder = ("a/mod.rs", "mod one;\nmod two;\npub use two::Two;\npub(crate) use self::two::{two as renamed};");
    for one in [
        "use super::two::Two;",
        "use crate::{a::{two::{Two, two}, *}};",
        "pub(super) use crate::a::Two as Other;",
        "use crate::a::renamed;",
        "use super::*;\nfn f() { crate::a::two::two() }",
        "use super::two;\nfn f() { two::two() }",
        "use crate::a;\nfn f() { a::renamed() }",
        "fn f<'a>(c: &'a char) -> bool { let q = '\"'; super::two::two(); true }",
        "mod inner { use super::super::two::Two; }",
        "fn f() { let text = r#\"\"#; super::renamed() }",
    ] {
        let mut seen = found(&[folder, ("a/one.rs", one), two]);
        seen.retain(|line| line != "a/one.rs a/mod.rs");
        seen.dedup();
        assert_eq!(seen, both, "{one}");
    }
    for none in [
        "// use super::two::Two;",
        "const A: &str = \"super::two::Two\";",
        "use two::Two;",
        "use std::a::two::Two;",
        "#[cfg(test)]\nmod tests {\n use super::super::two::Two;\n}",
        "#[cfg(test)]\nuse super::two::Two;\nfn f() {}",
    ] {
        assert_eq!(found(&[folder, ("a/one.rs", none), two]), [""; 0], "{none}");
    }
    // Tests in a file of their own, and a folder that uses what it passes on.
    assert_eq!(
        found(&[("a.rs", "#[cfg(test)]\nmod tests;"), ("a/tests.rs", "use crate::b::B;"), ("b.rs", "pub struct B;")]),
        [""; 0]
    );
    assert_eq!(
        found(&[("a/mod.rs", "mod two;\npub use two::Two;\nfn f() -> Two { Two }"), two]),
        ["a/mod.rs a/two.rs"]
    );
}

#[test]
fn a_circle_is_found_by_way_of_others_and_of_a_folder() {
    let circle = [
        ("a/mod.rs", "mod one;\nmod two;\nmod three;\npub use three::{Three, Free};"),
        ("a/one.rs", "use super::two::Two; pub struct One;"),
        ("a/two.rs", "use crate::a::Three; pub struct Two;"),
        ("a/three.rs", "use super::one::One; pub struct Three; pub struct Free;"),
        ("b.rs", "use crate::a::Free;"),
    ];
    let all = imports(&made_up(&circle));
    let sets = circles(&all);
    assert_eq!(sets.len(), 1);
    let shown = lines(sets.into_iter().flatten());
    let expected = "a/one.rs:1: super::two::Two, of a/two.rs\n\
                    a/three.rs:1: super::one::One, of a/one.rs\n\
                    a/two.rs:1: crate::a::Three, of a/three.rs\n";
    assert_eq!(shown, expected);
    let mut without = circle;
    without[3].1 = "pub struct Three; pub struct Free;";
    assert!(circles(&imports(&made_up(&without))).is_empty());
}

/// One dependency, one place.
#[test]
fn faer_mcap_and_bincode_are_named_in_one_place_each() {
    let sources = sources();
    for (name, home) in
        [("faer::", "equilibrium/sparse/dense.rs"), ("mcap::", "journal/"), ("bincode::", "journal/codec/bytes.rs")]
    {
        for (file, text) in &sources {
            let named = text.lines().any(|line| line.contains(name) && !line.trim_start().starts_with("//"));
            assert!(!named || file.starts_with(home), "{file} names {name}");
        }
    }
}
