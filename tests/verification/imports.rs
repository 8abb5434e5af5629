//! Which source file imports from which: read from the text, so that the house can be looked at as it stands.
//!
//! Seen are `use` lines and paths inside code, each with `crate::`, `self::`, `super::`, the name of a module below or a name
//! that stands for a module; braces, globs and renames. A name imported from a module that only passes it on is an import of
//! the file that defines it. What is compiled for unit tests alone is left out. Not seen: methods, and names that a macro makes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A file and its path from `src/`.
pub type Sources = BTreeMap<String, String>;

/// The files of this crate.
pub fn sources() -> Sources {
    fn collect(root: &Path, folder: &Path, found: &mut Sources) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                found.insert(name, std::fs::read_to_string(&path).unwrap());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Sources::new();
    collect(&root, &root, &mut found);
    assert!(found.len() > 30);
    found
}

/// That one file imports from another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    pub from: String,
    pub line: usize,
    pub to: String,
    /// As it stands in the importing file, without braces.
    pub path: String,
}

/// What one file imports from others, of all of them.
pub fn imports(sources: &Sources) -> Vec<Import> {
    let crate_ = Crate::new(sources);
    let mut found = BTreeSet::new();
    for (home, module) in &crate_.modules {
        // A folder that passes a name on imports it only where it uses it itself.
        let is_folder = module.file.ends_with("mod.rs");
        let is_import = |named: &&Named| !is_folder || !named.passed_on || module.words.contains(named.bound());
        for named in module.uses.iter().filter(is_import).chain(&module.paths) {
            for to in crate_.files_of(home, &named.path) {
                let (from, line, path) = (module.file.clone(), named.line, named.path.join("::"));
                if to != from {
                    found.insert(Import { from, line, to, path });
                }
            }
        }
    }
    found.into_iter().collect()
}

/// Every set of files that import each other, be it by way of others of the set: the imports inside it.
pub fn circles(imports: &[Import]) -> Vec<Vec<&Import>> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for import in imports {
        next.entry(&import.from).or_default().insert(&import.to);
    }
    let reached: BTreeMap<&str, BTreeSet<&str>> = next.keys().map(|file| (*file, reached_from(file, &next))).collect();
    let reaches = |from: &str, to: &str| reached.get(from).is_some_and(|files| files.contains(to));
    let mut sets: BTreeMap<&str, Vec<&Import>> = BTreeMap::new();
    for import in imports.iter().filter(|import| reaches(&import.to, &import.from)) {
        // A set goes by the first of its files in the order of names.
        let first = next.keys().find(|file| reaches(file, &import.from) && reaches(&import.from, file));
        sets.entry(first.copied().unwrap_or_default()).or_default().push(import);
    }
    sets.into_values().collect()
}

/// All files that a file imports from, and those that they do.
fn reached_from<'a>(start: &'a str, next: &BTreeMap<&str, BTreeSet<&'a str>>) -> BTreeSet<&'a str> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![start]);
    while let Some(file) = open.pop() {
        open.extend(next.get(file).into_iter().flatten().filter(|to| reached.insert(**to)));
    }
    reached
}

/// Names from the top of the crate down to a module.
type Home = Vec<String>;

#[derive(Default)]
struct Module {
    file: String,
    uses: Vec<Named>,
    paths: Vec<Named>,
    /// All that stands outside `use` lines.
    words: BTreeSet<String>,
}

/// A path as it stands in a module.
struct Named {
    path: Vec<String>,
    /// What it is called from there on, where that is not its last name.
    renamed: Option<String>,
    /// Whether others may take it from here: `pub use`.
    passed_on: bool,
    line: usize,
}

impl Named {
    fn bound(&self) -> &String {
        self.renamed.as_ref().unwrap_or(&self.path[self.path.len() - 1])
    }
}

struct Crate {
    modules: BTreeMap<Home, Module>,
}

impl Crate {
    fn new(sources: &Sources) -> Self {
        let mut modules = BTreeMap::new();
        let mut for_tests = BTreeSet::new();
        for (file, text) in sources {
            let mut home: Home = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
            if home.last().is_some_and(|name| name == "mod") || home == ["lib"] {
                home.pop();
            }
            Reader { file, tokens: &tokens(text), at: 0, modules: &mut modules, for_tests: &mut for_tests }
                .module(home);
        }
        modules.retain(|home, _| !(1..=home.len()).any(|length| for_tests.contains(&home[..length])));
        Self { modules }
    }

    /// The files that define what a path means in a module; none for what is not of this crate.
    fn files_of(&self, home: &Home, path: &[String]) -> BTreeSet<String> {
        let mut files = BTreeSet::new();
        self.follow(home, path, &mut BTreeSet::new(), &mut files);
        files
    }

    fn follow(
        &self,
        home: &Home,
        path: &[String],
        seen: &mut BTreeSet<(Home, Vec<String>)>,
        files: &mut BTreeSet<String>,
    ) {
        let Some((first, rest)) = path.split_first() else { return };
        if !seen.insert((home.clone(), path.to_vec())) {
            return;
        }
        let below = || home.iter().chain([first]).cloned().collect::<Home>();
        match first.as_str() {
            "crate" => self.descend(&Home::new(), rest, seen, files),
            "self" => self.descend(home, rest, seen, files),
            "super" => self.descend(&home[..home.len().saturating_sub(1)].to_vec(), rest, seen, files),
            _ if self.modules.contains_key(&below()) => self.descend(&below(), rest, seen, files),
            // A name that a `use` line has made. Of a type, whose name begins with a capital, that line tells all.
            _ if !rest.is_empty() && first.starts_with(char::is_lowercase) => {
                for named in self.modules[home].uses.iter().filter(|named| named.bound() == first && named.path != path)
                {
                    let whole: Vec<_> = named.path.iter().chain(rest).cloned().collect();
                    self.follow(home, &whole, seen, files);
                }
            }
            _ => {}
        }
    }

    /// What a path means that begins at a module of this crate.
    fn descend(
        &self,
        home: &Home,
        path: &[String],
        seen: &mut BTreeSet<(Home, Vec<String>)>,
        files: &mut BTreeSet<String>,
    ) {
        let Some(module) = self.modules.get(home) else { return };
        let Some((first, rest)) = path.split_first() else {
            files.insert(module.file.clone());
            return;
        };
        let below: Home = home.iter().chain([first]).cloned().collect();
        if first == "super" {
            return self.follow(home, path, seen, files);
        }
        let uses = |wanted: fn(&Named, &str) -> bool| module.uses.iter().filter(|named| wanted(named, first)).collect();
        let mut passed: Vec<&Named> = uses(|named, first| named.bound() == first || first == "*" && named.passed_on);
        if first == "*" {
            files.insert(module.file.clone());
        } else if self.modules.contains_key(&below) {
            self.descend(&below, rest, seen, files);
        } else if passed.is_empty() {
            passed = uses(|named, _| named.bound() == "*" && named.passed_on);
            if passed.is_empty() {
                files.insert(module.file.clone());
            }
        }
        for named in passed {
            let whole: Vec<_> = named.path.iter().chain(rest).cloned().collect();
            self.follow(home, &whole, seen, files);
        }
    }
}

/// A word or a sign, and the line that it stands on.
pub type Token = (String, usize);

/// Words and signs of a source text, without comments and without what stands in quotes.
pub fn tokens(text: &str) -> Vec<Token> {
    let letters: Vec<char> = text.chars().collect();
    let is =
        |at: usize, wanted: &str| wanted.chars().enumerate().all(|(k, letter)| letters.get(at + k) == Some(&letter));
    let word = |letter: &char| letter.is_alphanumeric() || *letter == '_';
    let (mut found, mut at, mut line) = (Vec::new(), 0, 1);
    while at < letters.len() {
        let start = at;
        let letter = letters[at];
        if is(at, "//") {
            at += letters[at..].iter().take_while(|letter| **letter != '\n').count();
        } else if is(at, "/*") {
            while at < letters.len() && !is(at, "*/") {
                at += 1;
            }
            at += 2;
        } else if letter == '"' {
            at += 1;
            while at < letters.len() && letters[at] != '"' {
                at += if letters[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
        } else if letter == 'r' && (is(at, "r\"") || is(at, "r#\"")) {
            let end = if is(at, "r#") { "\"#" } else { "\"" };
            at += 1 + end.len();
            while at < letters.len() && !is(at, end) {
                at += 1;
            }
            at += end.len();
        } else if letter == '\'' && (is(at + 1, "\\") || is(at + 2, "'")) {
            at += 3;
            while at <= letters.len() && letters[at - 1] != '\'' {
                at += 1;
            }
        } else if word(&letter) {
            at += letters[at..].iter().take_while(|letter| word(letter)).count();
            found.push((letters[start..at].iter().collect(), line));
        } else {
            at += if is(at, "::") { 2 } else { 1 };
            if !letter.is_whitespace() {
                found.push((letters[start..at].iter().collect(), line));
            }
        }
        at = at.min(letters.len());
        line += letters[start..at].iter().filter(|letter| **letter == '\n').count();
    }
    found
}

/// Goes through the tokens of a file.
struct Reader<'a> {
    file: &'a str,
    tokens: &'a [Token],
    at: usize,
    modules: &'a mut BTreeMap<Home, Module>,
    for_tests: &'a mut BTreeSet<Home>,
}

impl Reader<'_> {
    fn is(&self, ahead: usize, wanted: &[&str]) -> bool {
        wanted
            .iter()
            .enumerate()
            .all(|(k, text)| self.tokens.get(self.at + ahead + k).is_some_and(|token| token.0 == *text))
    }

    fn word(&self) -> Option<&str> {
        let text = self.tokens.get(self.at)?.0.as_str();
        text.starts_with(|letter: char| letter.is_alphabetic() || letter == '_').then_some(text)
    }

    /// Reads a module up to the brace that closes it, or the end of the file.
    fn module(&mut self, home: Home) {
        let mut module = Module { file: self.file.to_owned(), ..Module::default() };
        let (mut depth, mut passed_on) = (0, false);
        while let Some((text, line)) = self.tokens.get(self.at).cloned() {
            match text.as_str() {
                "#" if self.is(1, &["[", "cfg", "(", "test", ")", "]"]) => {
                    self.at += 7;
                    self.skip_item(&home);
                    continue;
                }
                "}" if depth == 0 => break,
                "}" => depth -= 1,
                "{" => depth += 1,
                "mod" if self.is(2, &["{"]) => {
                    let below = home.iter().chain([&self.tokens[self.at + 1].0]).cloned().collect();
                    self.at += 3;
                    self.module(below);
                }
                "mod" => self.at += 1,
                "pub" => passed_on = true,
                ";" => passed_on = false,
                "use" => {
                    self.at += 1;
                    self.tree(&[], passed_on, &mut module.uses);
                    passed_on = false;
                }
                _ if self.word().is_some() && (self.at == 0 || !matches!(&*self.tokens[self.at - 1].0, "::" | ".")) => {
                    let path = self.path();
                    module.words.insert(path[0].clone());
                    passed_on &= matches!(&*path[0], "crate" | "super" | "self" | "in") && path.len() == 1;
                    if path.len() > 1 {
                        module.paths.push(Named { path, renamed: None, passed_on: false, line });
                    }
                    continue;
                }
                _ => {}
            }
            self.at += 1;
        }
        self.modules.insert(home, module);
    }

    /// Words joined by `::` from here on.
    fn path(&mut self) -> Vec<String> {
        let mut path = Vec::new();
        while let Some(word) = self.word().map(str::to_owned) {
            path.push(word);
            self.at += 1;
            if !self.is(0, &["::"]) {
                break;
            }
            self.at += 1;
        }
        path
    }

    /// One branch of a `use` line, behind what stands in front of it; ends on the sign that follows.
    fn tree(&mut self, front: &[String], passed_on: bool, found: &mut Vec<Named>) {
        let line = self.tokens.get(self.at).map_or(0, |token| token.1);
        let mut path = front.to_vec();
        path.extend(self.path());
        if self.is(0, &["{"]) {
            while !self.is(0, &["}"]) && self.at < self.tokens.len() {
                self.at += 1;
                if !self.is(0, &["}"]) {
                    self.tree(&path, passed_on, found);
                }
            }
            self.at += 1;
            return;
        }
        if self.is(0, &["*"]) {
            path.push("*".to_owned());
            self.at += 1;
        }
        let renamed = self.is(0, &["as"]).then(|| {
            self.at += 2;
            self.tokens[self.at - 1].0.clone()
        });
        // `{self, …}` means what stands in front of the brace.
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        // Nothing stands here where `use<…>` says what a type captures.
        if !path.is_empty() {
            found.push(Named { path, renamed, passed_on, line });
        }
    }

    /// Past the item that begins here: to its semicolon, or to the brace that closes it.
    fn skip_item(&mut self, home: &Home) {
        if self.is(0, &["mod"]) {
            self.for_tests.insert(home.iter().chain([&self.tokens[self.at + 1].0]).cloned().collect());
        }
        let mut depth = 0;
        while let Some((text, _)) = self.tokens.get(self.at) {
            self.at += 1;
            match text.as_str() {
                "{" => depth += 1,
                "}" if depth == 1 => break,
                "}" => depth -= 1,
                ";" if depth == 0 => break,
                _ => {}
            }
        }
    }
}
