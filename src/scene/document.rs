//! TOML text and settings as one list of entries that know their place in the text. Nothing is judged here but syntax.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::entry::Entry;
use super::fault::{Checked, Fault, TextSpan};
use super::key_table::OF_A_SHELL;
use super::keys::Section;
use super::problem::Problem;
use super::{meant, syntax};
use crate::printable::one_line;

/// Name of the tables that each describe a shell of a structure.
const SHELL: &str = "shell";

/// The content of a scene file, with settings applied.
#[derive(Clone)]
pub(super) struct Document<'t> {
    /// The descriptions of the tables that are allowed.
    pub sections: &'static [Section],
    /// The tables, in the order of the text; those that settings add come last.
    pub tables: Vec<Written<'t>>,
    /// The tables below each `[[shell]]`, in the order of these.
    pub of_shells: Vec<Vec<Written<'t>>>,
    /// Keys and values in front of all tables, and tables of the wrong form.
    pub strays: Vec<Entry<'t>>,
    /// Behind the last text of the file.
    pub end: TextSpan,
    /// The file.
    text: &'t str,
}

/// A table as it is written.
#[derive(Clone)]
pub(super) struct Written<'t> {
    /// Its name, without the brackets.
    pub name: String,
    /// Its number, from 1, where it is an item of an array of tables.
    pub number: Option<usize>,
    /// The title of the `[[shell]]` that it stands below, if it does.
    pub below: Option<String>,
    pub place: TextSpan,
    pub entries: Vec<Entry<'t>>,
    /// Whether it is written in brackets on a line of its own, so that lines may be added below.
    own_line: bool,
}

impl<'t> Written<'t> {
    /// Creates the table that an item of a list of inline tables is; spans count from `base`.
    pub fn inline(section: &Section, number: usize, place: TextSpan, table: DeTable<'t>, base: &TextSpan) -> Self {
        let entries = in_order_of_text(table).into_iter().map(|(key, value)| {
            let start = base.span.start;
            let span = start + key.span().start..start + key.span().end;
            let place = TextSpan { source: base.source, span };
            Entry { place, name: key.into_inner().into_owned(), value, base: base.clone() }
        });
        let (name, entries) = (section.name.to_owned(), entries.collect());
        Self { name, number: Some(number), below: None, place, entries, own_line: false }
    }

    /// Returns the entry with this key.
    pub fn entry(&self, name: &str) -> Option<&Entry<'t>> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// What a setting calls it among others of its array: its name, or "action 2" where it has none.
    fn settings_name(&self) -> String {
        let name = self.entry("name").and_then(|entry| entry.value.get_ref().as_str()).map(str::to_owned);
        name.unwrap_or_else(|| format!("{} {}", self.name, self.number.unwrap_or_default()))
    }

    /// The name of the table in errors: `[geometry]`, `[[support]] 2`, `[[support]] "root"`.
    pub fn title(&self) -> String {
        let name = self.entry("name").and_then(|entry| entry.value.get_ref().as_str());
        if let Some(shell) = &self.below {
            return match self.number {
                None => format!("[shell.{}] of {shell}", self.name),
                Some(number) => format!("[[shell.{}]] {number} of {shell}", self.name),
            };
        }
        match (self.number, name) {
            (None, _) => format!("[{}]", self.name),
            (Some(_), Some(name)) => format!("[[{}]] \"{}\"", self.name, one_line(name)),
            (Some(number), None) => format!("[[{}]] {number}", self.name),
        }
    }
}

impl<'t> Document<'t> {
    /// Reads the file (source 0), and then each setting (sources 1, 2, …) in place of what the file has.
    pub fn read<S: AsRef<str>>(text: &'t str, settings: &'t [S], sections: &'static [Section]) -> Checked<Self> {
        let root =
            DeTable::parse(text).map_err(|error| syntax::fault(&error, text, &TextSpan { source: 0, span: 0..0 }))?;
        let last = text.trim_end().len();
        let end = TextSpan { source: 0, span: last..last };
        let mut document = Self { sections, tables: vec![], of_shells: vec![], strays: vec![], end, text };
        for (name, value) in in_order_of_text(root.into_inner()) {
            document.take_root(name, value);
        }
        for (index, setting) in settings.iter().enumerate() {
            document.set(index + 1, setting.as_ref())?;
        }
        Ok(document)
    }

    /// The tables of a list in a document, by themselves.
    pub fn of_inline(sections: &'static [Section], tables: Vec<Written<'t>>) -> Self {
        let end = tables.last().map_or(TextSpan { source: 0, span: 0..0 }, |table| table.place.clone());
        Self { sections, tables, of_shells: vec![], strays: vec![], end, text: "" }
    }

    /// The description of tables of this name.
    pub fn section(&self, name: &str) -> Option<&'static Section> {
        self.sections.iter().find(|section| section.name == name)
    }

    /// Where a line can be added to a table: at the end of the line of its last entry, or of its header.
    pub fn line_end(&self, table: &Written<'_>) -> Option<TextSpan> {
        if !table.own_line {
            return None;
        }
        let in_file = table.entries.iter().filter(|entry| entry.place.source == 0);
        let last = in_file.map(|entry| entry.value_place().span.end).max().unwrap_or(table.place.span.end);
        let rest = self.text.get(last..)?;
        let line = rest.find('\n').map_or(rest, |length| &rest[..length]);
        let at = last + line.trim_end_matches('\r').len();
        Some(TextSpan { source: 0, span: at..at })
    }

    fn is_array(&self, name: &str) -> bool {
        self.section(name).is_some_and(|section| section.many)
    }

    fn take_root(&mut self, name: Spanned<Cow<'t, str>>, value: Spanned<DeValue<'t>>) {
        let place = TextSpan { source: 0, span: name.span() };
        let name = name.into_inner().into_owned();
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(table) => self.take_table(name, None, place, table),
            DeValue::Array(tables) if self.is_array(&name) => {
                for (index, table) in tables.into_iter().enumerate() {
                    let place =
                        TextSpan { source: 0, span: if index == 0 { place.span.clone() } else { table.span() } };
                    let table = if let DeValue::Table(table) = table.into_inner() { table } else { DeTable::new() };
                    self.take_table(name.clone(), Some(index + 1), place, table);
                }
            }
            other => {
                let value = Spanned::new(span, other);
                self.strays.push(Entry { name, place, value, base: TextSpan { source: 0, span: 0..0 } });
            }
        }
    }

    fn take_table(&mut self, name: String, number: Option<usize>, place: TextSpan, table: DeTable<'t>) {
        let mut entries: Vec<Entry<'t>> = in_order_of_text(table).into_iter().map(entry_of_file).collect();
        let own_line = self.is_on_own_line(&place);
        let is_shell = name == SHELL && number.is_some() && self.is_array(SHELL);
        let nested = |entry: &mut Entry<'t>| {
            let value = entry.value.get_ref();
            OF_A_SHELL.contains(&&*entry.name) && (value.as_table().is_some() || is_of_tables(value))
        };
        let below = if is_shell { entries.extract_if(.., nested).collect() } else { Vec::new() };
        let shell = Written { name, number, below: None, place, entries, own_line };
        if is_shell {
            let title = shell.title();
            let tables = below.into_iter().flat_map(|entry| self.tables_below(&title, entry)).collect();
            self.of_shells.push(tables);
        }
        self.tables.push(shell);
    }

    /// The tables that an entry of a `[[shell]]` is.
    fn tables_below(&self, shell: &str, entry: Entry<'t>) -> Vec<Written<'t>> {
        let Entry { name, place, value, .. } = entry;
        let tables: Vec<(Option<usize>, TextSpan, DeTable<'t>)> = match value.into_inner() {
            DeValue::Table(table) => vec![(None, place, table)],
            DeValue::Array(tables) => {
                let table = |(index, table): (usize, Spanned<DeValue<'t>>)| {
                    let own = TextSpan { source: place.source, span: table.span() };
                    let DeValue::Table(inner) = table.into_inner() else { return None };
                    Some((Some(index + 1), if index == 0 { place.clone() } else { own }, inner))
                };
                tables.into_iter().enumerate().filter_map(table).collect()
            }
            _ => Vec::new(),
        };
        let written = |(number, place, table): (Option<usize>, TextSpan, DeTable<'t>)| {
            let entries = in_order_of_text(table).into_iter().map(entry_of_file).collect();
            let (name, below) = (name.clone(), Some(shell.to_owned()));
            Written { name, number, below, own_line: self.is_on_own_line(&place), place, entries }
        };
        tables.into_iter().map(written).collect()
    }

    /// Whether the header of a table is written in brackets on a line of its own.
    fn is_on_own_line(&self, place: &TextSpan) -> bool {
        let (before, from) = self.text.split_at(place.span.start);
        before.trim_end_matches([' ', '\t']).trim_end_matches("shell.").ends_with('[') || from.starts_with('[')
    }

    /// The document of one shell: its own tables, and those that the scene has for all shells.
    pub fn of_shell(&self, shell: usize) -> Self {
        let own = &self.of_shells[shell];
        let is_own = |name: &str| own.iter().any(|table| table.name == name);
        // Plies belong to the material that is laminated.
        let is_taken = |name: &str| is_own(name) || (name == "ply" && is_own("material"));
        let shared = self.tables.iter().filter(|table| OF_A_SHELL.contains(&&*table.name) && !is_taken(&table.name));
        let tables = own.iter().chain(shared).cloned().collect();
        let sections = &self.sections[..self.shell_sections()];
        Self { sections, tables, of_shells: vec![], strays: vec![], end: self.tables_end(shell), text: self.text }
    }

    /// The document without what describes single shells.
    pub fn of_structure(&self) -> Self {
        let tables = self.tables.iter().filter(|table| !OF_A_SHELL.contains(&&*table.name)).cloned().collect();
        let sections = &self.sections[self.shell_sections()..];
        Self { sections, tables, of_shells: vec![], strays: vec![], end: self.end.clone(), text: self.text }
    }

    /// Number of the sections that describe a single shell, which come first.
    fn shell_sections(&self) -> usize {
        self.sections.iter().take_while(|section| OF_A_SHELL.contains(&section.name)).count()
    }

    /// Where what a shell lacks is missing.
    fn tables_end(&self, shell: usize) -> TextSpan {
        let mut shells = self.tables.iter().filter(|table| table.name == SHELL);
        shells.nth(shell).map_or(&self.end, |table| &table.place).clone()
    }

    /// Applies one setting: `section.key=value`, or `section.NAME.key=value` for one of several tables, by its name.
    fn set(&mut self, source: usize, setting: &'t str) -> Checked<()> {
        let whole = TextSpan { source, span: 0..setting.len() };
        let Some((path, value_text)) = setting.split_once('=') else {
            let key = meant::key(self.sections, setting.trim());
            return Err(Fault::new(Problem::SettingWithoutValue { key }, &whole));
        };
        let start = path.len() - path.trim_start().len();
        let place = TextSpan { source, span: start..start + path.trim().len() };
        let Some((section, rest)) = path.trim().split_once('.') else {
            return Err(meant::setting_without_section(self.sections, path.trim(), &place));
        };
        let section_place = TextSpan { source, span: start..start + section.len() };
        let (target, name) = match self.is_array(section) {
            true => self.named_target(section, rest).map_err(|problem| Fault::new(problem, &place))?,
            false => (self.single_target(section, &section_place), rest),
        };
        let name_place = TextSpan { source, span: place.span.end - name.len()..place.span.end };

        let value_start = setting.len() - value_text.trim_start().len();
        let base = TextSpan { source, span: value_start..setting.len() };
        let value =
            setting_value(value_text.trim()).map_err(|error| syntax::fault(&error, value_text.trim(), &base))?;

        let table = match target {
            Target::Table(index) => &mut self.tables[index],
            Target::BelowShell(shell, index) => &mut self.of_shells[shell][index],
        };
        let section = self.sections.iter().find(|section| section.name == table.name);
        let displaced = section.map_or(vec![], |section| meant::stands_in_for(section, name));
        table.entries.retain(|entry| entry.name != name && !displaced.contains(&&*entry.name));
        table.entries.push(Entry { name: name.into(), place: name_place, value, base });
        Ok(())
    }

    /// The table of which there is one, which is added where the file has none.
    fn single_target(&mut self, section: &str, place: &TextSpan) -> Target {
        let at = self.tables.iter().position(|table| table.name == section).unwrap_or(self.tables.len());
        if at == self.tables.len() {
            let (name, place) = (section.to_owned(), place.clone());
            self.tables.push(Written { name, number: None, below: None, place, entries: Vec::new(), own_line: false });
        }
        Target::Table(at)
    }

    /// The table of an array that a setting names, and the key in it; of a shell also the tables below it.
    fn named_target<'p>(&mut self, section: &str, path: &'p str) -> Result<(Target, &'p str), Problem> {
        let wrong =
            |problem: String, remedy: String| Problem::Table { table: format!("[[{section}]]"), problem, remedy };
        let items = || self.tables.iter().enumerate().filter(|(_, table)| table.name == section);
        let names: Vec<(usize, String)> = items().map(|(index, table)| (index, table.settings_name())).collect();
        // Names may have points in them: the longest one that the path begins with is meant.
        let begins =
            |(_, name): &&(usize, String)| path.strip_prefix(&**name).is_some_and(|rest| rest.starts_with('.'));
        let Some((index, name)) = names.iter().filter(begins).max_by_key(|(_, name)| name.len()) else {
            let list = names.iter().map(|(_, name)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
            return Err(match names.is_empty() {
                true => {
                    wrong("the scene has none that a setting could change".into(), "add one to the scene file".into())
                }
                false => wrong(
                    format!("\"{path}\" does not begin with the name of one of them and a point"),
                    format!("write such as `{section}.{}.KEY=VALUE`; the names are {list}", names[0].1),
                ),
            });
        };
        let key = &path[name.len() + 1..];
        let below = key.split_once('.').filter(|(table, _)| section == SHELL && OF_A_SHELL.contains(table));
        let Some((table, below)) = below else { return Ok((Target::Table(*index), key)) };
        if self.is_array(table) {
            return Err(wrong(
                format!("a setting cannot name one of several tables of [[shell.{table}]], which have no names"),
                "change it in the scene file".into(),
            ));
        }
        let shell = names.iter().position(|(at, _)| at == index).unwrap_or_default();
        Ok((self.below_shell(shell, *index, table), below))
    }

    /// The table below a shell, with what it has of the one for all shells where it has none of its own.
    fn below_shell(&mut self, shell: usize, at: usize, name: &str) -> Target {
        let own = &self.of_shells[shell];
        if let Some(index) = own.iter().position(|table| table.name == name) {
            return Target::BelowShell(shell, index);
        }
        let title = self.tables[at].title();
        let is_taken = |table: &&Written<'t>| table.name == name || (name == "material" && table.name == "ply");
        let shared: Vec<Written<'t>> = self.tables.iter().filter(is_taken).cloned().collect();
        let added = match shared.iter().any(|table| table.name == name) {
            true => shared,
            false => {
                let place = self.tables[at].place.clone();
                let (name, below) = (name.to_owned(), Some(title.clone()));
                vec![Written { name, number: None, below, place, entries: Vec::new(), own_line: false }]
            }
        };
        let own = &mut self.of_shells[shell];
        own.extend(added.into_iter().map(|table| Written { below: Some(title.clone()), own_line: false, ..table }));
        Target::BelowShell(shell, own.iter().position(|table| table.name == name).unwrap_or_default())
    }
}

/// A table that a setting changes.
enum Target {
    /// One of [`Document::tables`].
    Table(usize),
    /// One of those below a shell.
    BelowShell(usize, usize),
}

/// A key and its value in the file.
fn entry_of_file<'t>((key, value): (Spanned<Cow<'t, str>>, Spanned<DeValue<'t>>)) -> Entry<'t> {
    let base = TextSpan { source: 0, span: 0..0 };
    Entry { place: TextSpan { source: 0, span: key.span() }, name: key.into_inner().into_owned(), value, base }
}

/// Whether a value is a list of tables.
fn is_of_tables(value: &DeValue) -> bool {
    value.as_array().is_some_and(|items| !items.is_empty() && items.iter().all(|item| item.get_ref().is_table()))
}

/// The value of a setting: TOML, or a bare word, which needs no quotes (a shell would take them away).
fn setting_value(text: &str) -> Result<Spanned<DeValue<'_>>, toml::de::Error> {
    DeValue::parse(text).or_else(|error| {
        let bare = text.starts_with(|c: char| c.is_ascii_alphabetic())
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        if bare { Ok(Spanned::new(0..text.len(), DeValue::String(Cow::Borrowed(text)))) } else { Err(error) }
    })
}

fn in_order_of_text<'t>(table: DeTable<'t>) -> Vec<(Spanned<Cow<'t, str>>, Spanned<DeValue<'t>>)> {
    let mut items: Vec<_> = table.into_iter().collect();
    items.sort_by_key(|(key, _)| key.span().start);
    items
}
