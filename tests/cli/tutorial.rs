//! The tutorial: every command in it runs, and prints what stands there.

#[test]
fn the_tutorial_is_what_the_program_does() {
    let cases = trycmd::TestCases::new();
    cases.case("src/guide/tutorial.md");
    cases.env("FOLDLINE_THREADS", "2");
    cases.run();
}
