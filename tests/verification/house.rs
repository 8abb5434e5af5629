//! Each folder imports only from those above it in the list of the house.

use std::path::{Path, PathBuf};

/// From the bottom of the stack to its top.
const ORDER: [&str; 19] = [
    "units",
    "printable",
    "error",
    "digest",
    "whole_file",
    "scene",
    "spline",
    "shell",
    "model",
    "state",
    "equilibrium",
    "adapt",
    "pipeline",
    "journal",
    "history",
    "study",
    "view",
    "cli",
    "main",
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|known| *known == module)
}

#[test]
fn folders_import_only_from_those_above() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(files.len() > 30);
    let mut offences = Vec::new();
    for file in files {
        let relative = file.strip_prefix(&root).unwrap();
        let folder = relative.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        if folder == "lib" {
            continue;
        }
        let own = rank(folder).unwrap_or_else(|| panic!("{folder} is not in the list of the house"));
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            for (at, _) in line.match_indices("crate::") {
                let rest = &line[at + 7..];
                let module: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                if module == "derive" || line.trim_start().starts_with("//") {
                    continue;
                }
                let other = rank(&module).unwrap_or_else(|| panic!("{}: unknown module in {line}", relative.display()));
                if other > own {
                    offences.push(format!("{}:{}: {}", relative.display(), number + 1, line.trim()));
                }
            }
        }
    }
    assert!(offences.is_empty(), "imports from below:\n{}", offences.join("\n"));
}

/// One dependency, one place.
#[test]
fn faer_mcap_and_bincode_are_named_in_one_place_each() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    for (name, home) in
        [("faer::", "equilibrium/sparse/supernodal.rs"), ("mcap::", "journal/"), ("bincode::", "journal/codec.rs")]
    {
        for file in &files {
            let relative = file.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
            let text = std::fs::read_to_string(file).unwrap();
            let named = text.lines().any(|line| line.contains(name) && !line.trim_start().starts_with("//"));
            assert!(!named || relative.starts_with(home), "{relative} names {name}");
        }
    }
}
