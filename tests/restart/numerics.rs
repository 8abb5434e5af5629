//! A change of bits is seen, and recorded as a new revision of the numerics.
//!
//! `numerics.txt` holds the last chain hash of some small scenes for each revision and kind of kernel: those with fused
//! multiply-add (AVX2 and AVX-512) give one chain, the portable one another. Rows of former revisions stay.

use std::fmt::Write as _;
use std::path::Path;

use foldline::journal::Manifest;
use foldline::pipeline::{Run, Stages};
use foldline::record::{MemorySink, NUMERICS_REVISION};

use crate::program::{SMALL, STRUCTURE, scene};

/// Load steps, refinement and a snap; arc length to a bifurcation and the branch behind it; a growing increment; a tolerance,
/// knots that leave, and a return to before a jump on a refined mesh; shells that are joined, glued and hung on a spring.
const SCENES: [(&str, &str); 6] = [
    ("small", SMALL),
    ("path", include_str!("path.toml")),
    ("column", include_str!("column.toml")),
    ("growing", include_str!("../../checkpoints/golden/growing.toml")),
    ("tolerance", include_str!("tolerance.toml")),
    ("structure", STRUCTURE),
];

fn chain_of(text: &str) -> String {
    let mut stages = Stages::new(scene(text));
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    sink.stages.last().unwrap().1.commit.chain_hash.to_string()
}

#[test]
fn a_change_of_bits_is_a_new_revision() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/restart/numerics.txt");
    let mut stored = std::fs::read_to_string(&path).unwrap();
    let kernel = match Manifest::here(Path::new(""), "", 1).kernel.as_str() {
        "portable" => "portable",
        _ => "fused",
    };
    let rows: Vec<String> =
        SCENES.iter().map(|(name, text)| format!("{NUMERICS_REVISION} {kernel} {name} {}", chain_of(text))).collect();
    let known = stored.lines().any(|line| line.starts_with(&format!("{NUMERICS_REVISION} {kernel} ")));
    if std::env::var_os("FOLDLINE_STORE_BITS").is_some() && !known {
        rows.iter().for_each(|row| writeln!(stored, "{row}").unwrap());
        std::fs::write(&path, stored).unwrap();
        return;
    }
    if !known && kernel == "portable" {
        println!("not shown here: nothing is stored for the portable kernel");
        return;
    }
    for row in rows {
        assert!(
            stored.lines().any(|line| line == row),
            "the bits of this scene are not those of revision {NUMERICS_REVISION}:\n{row}\nIf they are meant to change, raise \
             NUMERICS_REVISION in src/record/revision.rs, then store the new ones:\n\
             FOLDLINE_STORE_BITS=1 cargo test --release --test restart numerics"
        );
    }
}
