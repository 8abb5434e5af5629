//! The tutorial: every command in it runs, in a folder of its own, and prints what stands there.

use std::path::Path;

#[test]
fn the_tutorial_is_what_the_program_does() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide/tutorial.md");
    let folder = tempfile::tempdir().unwrap();
    // Commands are run where the test is.
    std::env::set_current_dir(folder.path()).unwrap();
    let cases = trycmd::TestCases::new();
    cases.case(page).env("FOLDLINE_THREADS", "2").env("NO_COLOR", "1");
    cases.run();
}
