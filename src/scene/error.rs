//! Why a text is no scene, as callers see it.

use std::fmt;

use super::fault::{Fault, Source};
use super::problem::Problem;
use super::{explain, render};

/// Why a text is no scene. Its `Display` shows the file, the line, the offending text underlined, what is allowed and
/// the nearest right spelling.
#[derive(Clone, PartialEq)]
pub struct SceneError {
    fault: Box<Fault>,
    sources: Vec<Source>,
}

impl SceneError {
    pub(super) fn new(fault: Box<Fault>, sources: Vec<Source>) -> Self {
        Self { fault, sources }
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.fault.problem
    }

    /// What is wrong, in one line.
    pub fn summary(&self) -> String {
        explain::explain(&self.fault.problem).title
    }

    /// Where it stands: the file name given to the parser, or `--set`.
    pub fn source_name(&self) -> &str {
        &self.sources[self.fault.place.source].name
    }

    /// The line in that source, from 1.
    pub fn line(&self) -> usize {
        let text = self.sources[self.fault.place.source].text.as_bytes();
        let end = self.fault.place.span.start.min(text.len());
        1 + text[..end].iter().filter(|byte| **byte == b'\n').count()
    }

    /// The annotated snippet in plain ASCII lines, for pipes, logs and tests.
    pub fn plain(&self) -> String {
        render::plain(&self.fault, &self.sources)
    }

    /// The annotated snippet in colour, for terminals.
    pub fn coloured(&self) -> String {
        render::coloured(&self.fault, &self.sources)
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
