//! The table of a sweep: a row for each task, filtered, and as CSV or JSON lines.

use std::borrow::Cow;
use std::cmp::Ordering;

use serde_json::{Map, Value, json};

use super::error::SweepError;
use super::folder::Folder;
use super::plan::Head;
use super::record::Row;

/// What stands before the values of the axes in every row, and behind the results.
const BEFORE: [&str; 4] = ["number", "key", "role", "ending"];
const BEHIND: [&str; 5] = ["load_steps", "unknowns", "wall_s", "log", "reason"];

/// Rows of a sweep.
#[derive(Clone, Debug)]
pub struct Table {
    /// What the tasks share.
    pub head: Head,
    /// The rows.
    pub rows: Vec<Row>,
}

/// A condition on a column, such as `peak_moment_n_mm>800` or `ending=failed`.
#[derive(Clone, Debug)]
pub struct Condition {
    column: String,
    is: Comparison,
    value: Value,
}

/// Whether values of this order meet it; `None` where they have none.
type Comparison = fn(Option<Ordering>) -> bool;

/// Comparisons, the longer first.
const COMPARISONS: [(&str, Comparison); 6] = [
    ("<=", |order| matches!(order, Some(Ordering::Less | Ordering::Equal))),
    (">=", |order| matches!(order, Some(Ordering::Greater | Ordering::Equal))),
    ("!=", |order| order != Some(Ordering::Equal)),
    ("<", |order| order == Some(Ordering::Less)),
    (">", |order| order == Some(Ordering::Greater)),
    ("=", |order| order == Some(Ordering::Equal)),
];

impl Condition {
    /// Reads a condition.
    ///
    /// # Errors
    /// What to write instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        let found = COMPARISONS.iter().filter_map(|(sign, is)| Some((text.find(sign)?, *sign, *is)));
        // Of those at one place the longer one.
        let first = found.min_by_key(|(at, sign, _)| (*at, usize::MAX - sign.len()));
        let Some((at, sign, is)) = first.filter(|(at, ..)| *at > 0) else {
            return Err(
                "write a column, a comparison and a value, such as 'peak_moment_n_mm>800' or ending=failed".to_owned()
            );
        };
        let value = text[at + sign.len()..].trim();
        let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
        let value = number.map_or_else(|| Value::from(value.trim_matches('"')), Value::from);
        Ok(Self { column: text[..at].trim().to_owned(), is, value })
    }
}

impl Table {
    /// Reads the table of a folder, as far as its tasks have ended.
    ///
    /// # Errors
    /// Where the folder holds no sweep, or a damaged one.
    pub fn read(folder: &Folder) -> Result<Self, SweepError> {
        Ok(Self { head: folder.head()?, rows: folder.rows()? })
    }

    /// Names of all columns.
    pub fn columns(&self) -> Vec<String> {
        let before = BEFORE.iter().map(|name| (*name).to_owned());
        let results = self.head.outputs.iter().map(ToString::to_string);
        let behind = BEHIND.iter().map(|name| (*name).to_owned());
        before.chain(self.head.columns.iter().cloned()).chain(results).chain(behind).collect()
    }

    /// The value of a row in each column; null where it has none.
    pub fn values(&self, row: &Row) -> Vec<Value> {
        let Row { task, record } = row;
        let mut values = vec![json!(task.number), json!(task.key), json!(role(row)), json!(row.ending())];
        values.extend(task.values.iter().cloned());
        values.extend(self.head.outputs.iter().map(|output| json!(row.result(&output.to_string()))));
        let record = record.as_ref();
        values.extend([
            json!(record.and_then(|record| record.load_steps)),
            json!(record.and_then(|record| record.unknowns)),
            json!(record.and_then(|record| record.wall_s)),
            json!(record.and_then(|record| record.log.clone())),
            json!(record.and_then(|record| record.reason.clone())),
        ]);
        values
    }

    /// The column that a name means: its whole name, or the last part of one key alone.
    fn column(&self, name: &str) -> Result<usize, SweepError> {
        let columns = self.columns();
        let wrong = |problem: String| SweepError::Wrong { file: self.head.file.clone(), problem };
        if let Some(whole) = columns.iter().position(|column| column == name) {
            return Ok(whole);
        }
        let ends = |column: &String| column.rsplit('.').next() == Some(name);
        let ending: Vec<usize> = (0..columns.len()).filter(|index| ends(&columns[*index])).collect();
        match ending[..] {
            [one] => Ok(one),
            _ => Err(wrong(format!("no column is called `{name}`; there are {}", columns.join(", ")))),
        }
    }

    /// Keeps the rows that meet all conditions.
    ///
    /// # Errors
    /// Where a condition is on no column.
    pub fn retain(&mut self, conditions: &[Condition]) -> Result<(), SweepError> {
        for condition in conditions {
            let column = self.column(&condition.column)?;
            let rows = std::mem::take(&mut self.rows);
            self.rows = rows
                .into_iter()
                .filter(|row| (condition.is)(order(&self.values(row)[column], &condition.value)))
                .collect();
        }
        Ok(())
    }

    /// As CSV (RFC 4180) with a line of names.
    pub fn to_csv(&self) -> String {
        let mut text = line(self.columns().iter().map(|name| quoted(name)));
        for row in &self.rows {
            let values = self.values(row);
            text += &line(values.iter().map(|value| match value {
                Value::Null => Cow::Borrowed(""),
                Value::String(word) => quoted(word),
                value => Cow::Owned(quoted(&value.to_string()).into_owned()),
            }));
        }
        text
    }

    /// As a JSON object a line.
    pub fn to_json_lines(&self) -> String {
        let columns = self.columns();
        let object = |row: &Row| {
            let fields: Map<String, Value> = columns.iter().cloned().zip(self.values(row)).collect();
            Value::Object(fields).to_string() + "\n"
        };
        self.rows.iter().map(object).collect()
    }
}

/// Whether others are compared with it.
fn role(row: &Row) -> &'static str {
    if row.task.is_reference { "reference" } else { "task" }
}

fn line<'c>(cells: impl Iterator<Item = Cow<'c, str>>) -> String {
    cells.collect::<Vec<_>>().join(",") + "\n"
}

fn quoted(cell: &str) -> Cow<'_, str> {
    match cell.contains(['"', ',', '\n', '\r']) {
        true => Cow::Owned(format!("\"{}\"", cell.replace('"', "\"\""))),
        false => Cow::Borrowed(cell),
    }
}

/// The order of two values of one kind.
fn order(a: &Value, b: &Value) -> Option<Ordering> {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64()?.partial_cmp(&b.as_f64()?),
        (Value::String(a), Value::String(b)) => Some(a.cmp(b)),
        (Value::Bool(a), Value::String(b)) => Some(a.to_string().cmp(b)),
        (Value::Array(_), Value::String(b)) => Some(a.to_string().replace(' ', "").cmp(&b.replace(' ', ""))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_read() {
        let parsed = Condition::parse("a.b<=2.5").unwrap();
        assert_eq!((parsed.column.as_str(), &parsed.value), ("a.b", &json!(2.5)));
        assert_eq!(Condition::parse("ending = failed").unwrap().value, json!("failed"));
        for wrong in ["", "a", "=3", "<"] {
            assert!(Condition::parse(wrong).is_err(), "{wrong}");
        }
        assert!((Condition::parse("a!=2").unwrap().is)(None));
    }

    #[test]
    fn cells_are_quoted_where_they_must_be() {
        assert_eq!(quoted("plain"), "plain");
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }
}
