//! The annotated snippet of an error.

use std::borrow::Cow;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Patch, Renderer, Snippet};

use super::explain::{Explanation, explain};
use super::fault::{Fault, Source, TextSpan};
use crate::printable::is_obeyed;

/// How errors are shown.
pub(super) struct Look {
    pub(super) colours: bool,
    /// Columns that a line may have.
    pub(super) columns: Option<usize>,
}

/// The parts of a message before its text: `error: `, and behind the margin with the numbers of lines `= note: `.
const TITLE: usize = "error: ".len();
const NOTE: usize = " = note: ".len();
/// Columns between the numbers of lines and the source.
const BEFORE_SOURCE: usize = 3;
/// Columns of a tab in a source.
const TAB: usize = 4;

impl Look {
    /// A fault with the lines that it is in.
    pub(super) fn render(&self, fault: &Fault, sources: &[Source]) -> String {
        let renderer = match self.colours {
            true => Renderer::styled().decor_style(DecorStyle::Unicode),
            false => Renderer::plain(),
        };
        let words = self.folded(explain(fault).printable(), fault, sources);
        let mut report = vec![what_is_wrong(fault, sources, &words)];
        if !fault.edits.is_empty() {
            report.push(how_to_mend_it(fault, sources, &words));
        }
        match self.columns {
            None => renderer.render(&report),
            Some(columns) => {
                let text = renderer.term_width(columns).render(&report);
                text.split('\n').map(|line| cut(line, columns)).collect::<Vec<_>>().join("\n")
            }
        }
    }

    /// The words in lines that fit. A label that does not fit behind what it is on becomes a note.
    fn folded(&self, words: Explanation, fault: &Fault, sources: &[Source]) -> Explanation {
        let Some(columns) = self.columns else { return words };
        let margin = margin(fault, sources);
        let title = |text: &str| folded(text, columns.saturating_sub(TITLE));
        let note = |text: &String| folded(text, columns.saturating_sub(margin + NOTE));
        let room =
            |place: &TextSpan| columns.saturating_sub(margin + BEFORE_SOURCE + end_of(&sources[place.source], place));
        let fits = |label: &str, place: &TextSpan| label.is_empty() || label.chars().count() < room(place);
        let mut notes: Vec<String> = Vec::new();
        let (mut label, mut also) = (words.label, words.also);
        if !fits(&label, &fault.place) {
            notes.push(note(&std::mem::take(&mut label)));
        }
        if let Some(place) = fault.also.as_ref().filter(|place| !fits(&also, place)) {
            let source = &sources[place.source];
            let marked = &shown(&source.text)[within(source, place)];
            notes.push(note(&format!("{marked}: {}", std::mem::take(&mut also))));
        }
        notes.extend(words.notes.iter().map(note));
        Explanation {
            title: title(&words.title),
            label,
            also,
            notes,
            alone: note(&words.alone),
            help: words.help.iter().map(note).collect(),
            example: note(&words.example),
            fix: title(&words.fix),
        }
    }
}

/// Digits of the largest number of a line that is shown.
fn margin(fault: &Fault, sources: &[Source]) -> usize {
    let places = [Some(&fault.place), fault.also.as_ref()].into_iter().flatten();
    let places = places.chain(fault.edits.iter().map(|(place, _)| place));
    let line = |place: &TextSpan| {
        let text = sources[place.source].text.as_bytes();
        2 + text[..place.span.end.min(text.len())].iter().filter(|byte| **byte == b'\n').count()
    };
    places.map(line).max().unwrap_or(1).to_string().len()
}

/// The column behind a place.
fn end_of(source: &Source, place: &TextSpan) -> usize {
    let end = within(source, place).end;
    let line = source.text[..end].rsplit('\n').next().unwrap_or_default();
    line.chars().map(|c| if c == '\t' { TAB } else { 1 }).sum()
}

/// A text with its lines broken between words; one behind an indent is shown as it would be written.
fn folded(text: &str, columns: usize) -> String {
    let fold = |line: &str| {
        let (mut text, mut used) = (String::new(), 0);
        for word in line.split(' ') {
            let length = word.chars().count();
            let is_over = used > 0 && used + 1 + length > columns;
            if !text.is_empty() {
                text.push(if is_over { '\n' } else { ' ' });
            }
            text.push_str(word);
            used = if is_over || used == 0 { length } else { used + 1 + length };
        }
        text
    };
    let lines = text.split('\n').map(|line| if line.starts_with(' ') { line.to_owned() } else { fold(line) });
    lines.collect::<Vec<_>>().join("\n")
}

/// A line as far as it fits, with all its escapes: the renderer leaves lines whole that are to be written. The name of a file is
/// not cut.
fn cut(line: &str, columns: usize) -> String {
    let (mut bare, mut kept) = (String::new(), String::new());
    let (mut used, mut is_escape) = (0, false);
    for c in line.chars() {
        is_escape |= c == '\u{1b}';
        if is_escape {
            kept.push(c);
            is_escape = c != 'm';
            continue;
        }
        bare.push(c);
        used += 1;
        if used < columns {
            kept.push(c);
        } else if used == columns {
            kept.push('…');
        }
    }
    let start = bare.trim_start();
    let is_place = ["-->", ":::", "╭▸", "⸬"].iter().any(|mark| start.starts_with(mark));
    if used <= columns || is_place { line.to_owned() } else { kept }
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
