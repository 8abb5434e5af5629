//! Text that is not TOML, in words.

use super::explanation::Explanation;
use crate::scene::key_table::SECTIONS;
use crate::scene::keys::{Key, join_or};
use crate::scene::problem::SyntaxSlip;

pub(super) fn not_toml(message: &str, slip: Option<SyntaxSlip>) -> Explanation {
    const TITLE: &str = "this is not TOML";
    match slip {
        None => Explanation::new(TITLE, message),
        Some(SyntaxSlip::Twice) => {
            Explanation::new("a key or table is given twice", "again").also("first here").help("keep one of the two")
        }
        Some(SyntaxSlip::TwiceInSingleBrackets) => {
            Explanation::new("there may be several tables of this name, and each is written in two brackets", "again")
                .also("first here")
                .help(format!("write {}, each time", join_or(&in_two_brackets())))
        }
        Some(SyntaxSlip::BareWord) => Explanation::new("a word is written without quotes", "")
            .example("words are written in double quotes")
            .fix("with quotes"),
        Some(SyntaxSlip::MoreThanANumber) => Explanation::new(TITLE, "more than a number")
            .help("a number is written alone: its unit is in the name of the key"),
        Some(SyntaxSlip::DecimalComma) => {
            Explanation::new(TITLE, "a decimal comma").help("decimals are written after a point, as in 0.5")
        }
        Some(SyntaxSlip::OpenText) => {
            Explanation::new(TITLE, message).help("close the text with the quotes that open it")
        }
        Some(SyntaxSlip::NoValue) => Explanation::new("a key has no value", "here"),
        Some(SyntaxSlip::Capitals) => {
            Explanation::new("true and false are written in small letters", "").fix("in small letters")
        }
        Some(SyntaxSlip::OpenList) => {
            Explanation::new(TITLE, message).help("close the list with `]`, and put commas between its items")
        }
    }
}

pub(super) fn setting_without_value(key: Option<&Key>) -> Explanation {
    let explanation = Explanation::new("a setting is written section.key=value", "no `=` here");
    match key {
        Some(key) => explanation.help(format!("for example `--set {}={}`", key.path(), key.example.trim_matches('"'))),
        None => explanation.help("for example `--set solver.max_iterations=200`"),
    }
}

fn in_two_brackets() -> Vec<String> {
    SECTIONS.iter().filter(|section| section.many).map(|section| format!("`{}`", section.title())).collect()
}
