//! The annotated snippet of an error.

use std::borrow::Cow;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Patch, Renderer, Snippet};

use super::explain::{Explanation, explain};
use super::fault::{Fault, Source, TextSpan};
use crate::printable::is_obeyed;

pub(super) fn plain(fault: &Fault, sources: &[Source]) -> String {
    render(fault, sources, &Renderer::plain())
}

pub(super) fn coloured(fault: &Fault, sources: &[Source]) -> String {
    render(fault, sources, &Renderer::styled().decor_style(DecorStyle::Unicode))
}

fn render(fault: &Fault, sources: &[Source], renderer: &Renderer) -> String {
    let words = explain(fault).printable();
    let mut report = vec![what_is_wrong(fault, sources, &words)];
    if !fault.edits.is_empty() {
        report.push(how_to_mend_it(fault, sources, &words));
    }
    renderer.render(&report)
}

fn what_is_wrong<'a>(fault: &'a Fault, sources: &'a [Source], words: &'a Explanation) -> Group<'a> {
    let source = &sources[fault.place.source];
    let primary = annotation(AnnotationKind::Primary, source, &fault.place, &words.label);
    let mut first = Snippet::source(shown(&source.text)).path(&source.name).annotation(primary);
    for other in &fault.others {
        first = first.annotation(annotation(AnnotationKind::Primary, source, other, ""));
    }
    let mut second = None;
    if let Some(also) = &fault.also {
        let source = &sources[also.source];
        let context = annotation(AnnotationKind::Context, source, also, &words.also);
        if also.source == fault.place.source {
            first = first.annotation(context);
        } else {
            second = Some(Snippet::source(shown(&source.text)).path(&source.name).annotation(context));
        }
    }
    let group = Level::ERROR.primary_title(&words.title).element(first);
    let group = second.into_iter().fold(group, Group::element);
    let alone = (fault.also.is_none() && !words.alone.is_empty()).then_some(&words.alone);
    let notes = words.notes.iter().chain(alone).map(|note| Level::NOTE.message(note));
    // Where the mended text is shown, an example would only repeat it.
    let example = (fault.edits.is_empty() && !words.example.is_empty()).then_some(&words.example);
    let help = words.help.iter().chain(example).map(|help| Level::HELP.message(help));
    group.elements(notes).elements(help)
}

fn how_to_mend_it<'a>(fault: &'a Fault, sources: &'a [Source], words: &'a Explanation) -> Group<'a> {
    let source = &sources[fault.place.source];
    let edits = fault.edits.iter().filter(|(place, _)| place.source == fault.place.source);
    let patches = edits.map(|(place, text)| Patch::new(within(source, place), text));
    Level::HELP.secondary_title(&words.fix).element(Snippet::source(shown(&source.text)).patches(patches))
}

fn annotation<'a>(kind: AnnotationKind, source: &Source, place: &TextSpan, label: &'a str) -> Annotation<'a> {
    let annotation = kind.span(within(source, place));
    if label.is_empty() { annotation } else { annotation.label(label) }
}

/// The text of a source with other characters for those that a terminal obeys and the renderer lets through; each as long, so
/// that places stay what they are.
fn shown(text: &str) -> Cow<'_, str> {
    let is_let_through = |c: char| is_obeyed(c) && (!c.is_ascii() || c == '\u{7f}');
    if !text.contains(is_let_through) {
        return text.into();
    }
    let other = |c: char| match c.len_utf8() {
        _ if !is_let_through(c) => c,
        1 => '?',
        2 => '·',
        _ => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(other).collect::<String>().into()
}

/// The bytes of a place, cut to whole characters of the text.
fn within(source: &Source, place: &TextSpan) -> Range<usize> {
    let text = &source.text;
    let floor = |at: usize| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    let start = floor(place.span.start);
    let end = (place.span.end..text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len());
    start..end.max(start)
}
