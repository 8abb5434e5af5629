//! Why a text is no scene, as callers see it.

use std::fmt;

use super::explain;
use super::fault::{Fault, Source};
use super::problem::Problem;
use super::render::Look;

/// Mistakes shown at most.
const MOST_SHOWN: usize = 10;

/// Why a text is rejected as a scene: all wrong names and values, or else what does not go together. Its `Display`
/// shows the file, the line, the offending text underlined, what is allowed and the nearest right spelling.
#[derive(Clone, PartialEq)]
pub struct SceneError {
    /// The faults, at least one.
    faults: Vec<Fault>,
    sources: Vec<Source>,
}

impl SceneError {
    pub(super) fn new(faults: Vec<Fault>, sources: Vec<Source>) -> Self {
        Self { faults, sources }
    }

    /// The problems, in the order in which they are shown.
    pub fn problems(&self) -> impl Iterator<Item = &Problem> {
        self.faults.iter().map(|fault| &fault.problem)
    }

    /// The first problem, in one line.
    pub fn summary(&self) -> String {
        explain::explain(self.first()).title
    }

    /// The source of the first problem: the file name given to the parser, or `--set`.
    pub fn source_name(&self) -> &str {
        &self.sources[self.first().place.source].name
    }

    /// The line of the first problem in its source, from 1.
    pub fn line(&self) -> usize {
        let text = self.sources[self.first().place.source].text.as_bytes();
        let end = self.first().place.span.start.min(text.len());
        1 + text[..end].iter().filter(|byte| **byte == b'\n').count()
    }

    /// Renders the annotated snippets in plain ASCII, for pipes, logs and tests.
    pub fn plain(&self) -> String {
        self.rendered(&Look { colours: false, columns: None })
    }

    /// Renders the annotated snippets in colour, for terminals.
    pub fn coloured(&self) -> String {
        self.rendered(&Look { colours: true, columns: None })
    }

    /// Renders the annotated snippets with or without colours, in lines that fit so many columns of a terminal. Names of files
    /// are not cut.
    pub fn fitted(&self, colours: bool, columns: Option<usize>) -> String {
        self.rendered(&Look { colours, columns })
    }

    fn first(&self) -> &Fault {
        &self.faults[0]
    }

    fn rendered(&self, look: &Look) -> String {
        let shown: Vec<String> =
            self.faults.iter().take(MOST_SHOWN).map(|fault| look.render(fault, &self.sources)).collect();
        let text = shown.join("\n\n");
        match self.faults.len().saturating_sub(MOST_SHOWN) {
            0 => text,
            1 => text + "\n\nand one mistake more",
            more => format!("{text}\n\nand {more} mistakes more"),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.plain())
    }
}

impl fmt::Debug for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.plain())
    }
}

impl std::error::Error for SceneError {}
