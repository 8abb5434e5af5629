//! Conditions on reports, such as `moment_n_mm < 100` or `step > 20 and elements >= 500`.

use serde_json::Value;

use crate::journal::word_number;
use crate::record::{Outcome, Report, as_number, fields_of};
use crate::scene::Stage;

/// A condition on the report of a stage: comparisons that must all hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    terms: Vec<Term>,
}

#[derive(Clone, Debug, PartialEq)]
struct Term {
    field: String,
    operator: Operator,
    value: Operand,
}

#[derive(Clone, Debug, PartialEq)]
enum Operand {
    Number(f64),
    Word(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

/// Longer spellings first, so that `<=` is not read as `<`.
const OPERATORS: [(&str, Operator); 6] = [
    ("<=", Operator::LessOrEqual),
    (">=", Operator::GreaterOrEqual),
    ("==", Operator::Equal),
    ("!=", Operator::NotEqual),
    ("<", Operator::Less),
    (">", Operator::Greater),
];

/// Why the text of a condition is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditionError {
    /// A term without an operator.
    #[error(
        "`{term}` compares nothing; write FIELD OPERATOR VALUE with one of < <= > >= == !=, such as moment_n_mm < 100"
    )]
    NoOperator {
        /// The part of the condition.
        term: String,
    },
    /// The report has no such field.
    #[error("reports have no field `{field}`; they have {}", known.join(", "))]
    NoSuchField {
        /// What was written.
        field: String,
        /// Fields of a report.
        known: Vec<String>,
    },
    /// A word that the field never holds.
    #[error("{field} is never `{value}`; it is one of {}", known.join(", "))]
    NoSuchWord {
        /// The field.
        field: String,
        /// What was written.
        value: String,
        /// The values that the field can have.
        known: Vec<String>,
    },
    /// A word compared by size, or with a field that holds numbers.
    #[error("`{value}` is not a number, and {field} {problem}")]
    NotANumber {
        /// The field.
        field: String,
        /// What was written.
        value: String,
        /// Why a word does not do.
        problem: &'static str,
    },
}

impl Condition {
    /// Parses `FIELD OPERATOR VALUE`, several joined by `and`. Fields are those of a report in JSON and the names of
    /// its probes; `elements`, `marked` stand for the product or sum of their two numbers, `elements_1` and
    /// `elements_2` for one of them. A probe has a value at equilibria alone.
    ///
    /// # Errors
    /// Where it has another form or names a field that reports do not have.
    pub fn parse(text: &str, sample: &Report) -> Result<Self, ConditionError> {
        let fields = fields_of(sample);
        let terms = text.split(" and ").map(|term| parse_term(term.trim(), &fields)).collect::<Result<_, _>>()?;
        Ok(Self { terms })
    }

    /// Whether the condition holds for a report. What is not a number (a residual after a failed solve) meets no
    /// condition but `!=`.
    pub fn holds(&self, report: &Report) -> bool {
        let fields = fields_of(report);
        self.terms.iter().all(|term| {
            let value = fields.iter().find(|(name, _)| *name == term.field).map(|(_, value)| value);
            match (value, &term.value) {
                (Some(Value::String(word)), Operand::Word(other)) => match term.operator {
                    Operator::Equal => word == other,
                    _ => word != other,
                },
                (Some(value), Operand::Number(number)) => {
                    as_number(value).is_some_and(|found| term.operator.holds(found, *number))
                }
                _ => false,
            }
        })
    }
}

impl Condition {
    /// The names of the fields that are compared, one for each comparison.
    pub fn fields(&self) -> Vec<&str> {
        self.terms.iter().map(|term| term.field.as_str()).collect()
    }

    /// Whether the condition holds for values of [`Self::fields`] as an index stores them.
    pub fn holds_for(&self, numbers: &[u64]) -> bool {
        self.terms.iter().zip(numbers).all(|(term, number)| match &term.value {
            Operand::Number(value) => term.operator.holds(f64::from_bits(*number), *value),
            Operand::Word(word) => (*number == word_number(word)) == (term.operator == Operator::Equal),
        })
    }
}

impl Operator {
    /// Whether a number compares so; one that is not there, or none, never does.
    fn holds(self, found: f64, number: f64) -> bool {
        match self {
            Operator::Less => found < number,
            Operator::LessOrEqual => found <= number,
            Operator::Greater => found > number,
            Operator::GreaterOrEqual => found >= number,
            Operator::Equal => found == number,
            Operator::NotEqual => found != number && !found.is_nan(),
        }
    }
}

fn parse_term(term: &str, fields: &[(String, Value)]) -> Result<Term, ConditionError> {
    let found = OPERATORS.iter().find_map(|(text, operator)| term.split_once(text).map(|(a, b)| (a, *operator, b)));
    let Some((field, operator, value)) = found else {
        return Err(ConditionError::NoOperator { term: term.to_string() });
    };
    let (field, value) = (field.trim().to_string(), value.trim().trim_matches(['"', '\'']).to_string());
    let Some((_, sample)) = fields.iter().find(|(name, _)| *name == field) else {
        let known = fields.iter().map(|(name, _)| name.clone()).collect();
        return Err(ConditionError::NoSuchField { field, known });
    };
    let equality = matches!(operator, Operator::Equal | Operator::NotEqual);
    let value = match (value.parse::<f64>(), sample) {
        (_, Value::String(_)) if equality => {
            let known = words_of(&field);
            if !known.is_empty() && !known.contains(&value) {
                return Err(ConditionError::NoSuchWord { field, value, known });
            }
            Operand::Word(value)
        }
        (_, Value::String(_)) => {
            return Err(ConditionError::NotANumber { field, value, problem: "holds a word: compare it with == or !=" });
        }
        (Ok(number), _) if number.is_nan() => {
            let problem = "compares with none: with what is no number nothing does";
            return Err(ConditionError::NotANumber { field, value, problem });
        }
        (Ok(number), _) => Operand::Number(number),
        (Err(_), _) if value == "true" => Operand::Number(1.0),
        (Err(_), _) if value == "false" => Operand::Number(0.0),
        (Err(_), _) => return Err(ConditionError::NotANumber { field, value, problem: "holds a number" }),
    };
    Ok(Term { field, operator, value })
}

/// Every word that a field can hold; empty for fields that hold numbers.
fn words_of(field: &str) -> Vec<String> {
    let outcomes = [
        Outcome::Done,
        Outcome::RejectedJump,
        Outcome::RejectedNoEquilibrium,
        Outcome::RejectedCriticalPoint,
        Outcome::RejectedSharpTurn,
    ];
    match field {
        "stage" => Stage::ALL.iter().map(|stage| stage.name().to_string()).collect(),
        "outcome" => {
            outcomes.iter().filter_map(|it| Some(serde_json::to_value(it).ok()?.as_str()?.to_string())).collect()
        }
        _ => Vec::new(),
    }
}
