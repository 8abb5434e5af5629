//! Tables that are printed row by row: where a terminal is too narrow, the columns that matter least are left out, and a line
//! says which.

use super::wrapped::hanging;

/// Indent of cells below the name of their row.
const BELOW: usize = 2;

/// A column of a table.
#[derive(Clone, Debug)]
pub(super) struct Column {
    head: String,
    width: usize,
    /// Spaces before it.
    gap: usize,
    is_left_aligned: bool,
    /// How soon it is left out: 0 never, others the largest first.
    rank: usize,
}

impl Column {
    /// A column of numbers.
    pub(super) fn of_numbers(head: impl Into<String>, width: usize) -> Self {
        Self { head: head.into(), width, gap: 1, is_left_aligned: false, rank: 0 }
    }

    /// A column of words.
    pub(super) fn of_words(head: impl Into<String>, width: usize) -> Self {
        Self { is_left_aligned: true, ..Self::of_numbers(head, width) }
    }

    /// The same behind another gap.
    pub(super) fn behind(self, gap: usize) -> Self {
        Self { gap, ..self }
    }

    /// The same, left out before those of a smaller rank.
    pub(super) fn rank(self, rank: usize) -> Self {
        Self { rank, ..self }
    }

    fn taken(&self) -> usize {
        self.gap + self.width
    }

    fn cell(&self, text: &str) -> String {
        let Self { width, gap, .. } = *self;
        match self.is_left_aligned {
            true => format!("{:gap$}{text:<width$}", ""),
            false => format!("{:gap$}{text:>width$}", ""),
        }
    }
}

/// The columns that are shown of a table. The first names the rows; where it takes half a terminal, or leaves too
/// little for those that are never left out, it has lines of its own.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    all: Vec<Column>,
    shown: Vec<usize>,
    /// Whether the name of a row stands above its cells.
    is_above: bool,
    columns: Option<usize>,
}

impl Columns {
    /// Chooses those that fit so many columns of a terminal.
    pub(super) fn fitting(mut all: Vec<Column>, columns: Option<usize>) -> Self {
        if let Some(first) = all.first_mut() {
            first.gap = 0;
        }
        let every: Vec<usize> = (0..all.len()).collect();
        let name = all.first().map_or(0, |first| first.width);
        let takes_half = !fit(&all, &every, columns) && columns.is_some_and(|columns| 2 * name >= columns);
        let mut shown = chosen(&all, columns);
        let is_above = takes_half || !fit(&all, &shown, columns);
        if is_above && let Some(first) = all.first_mut() {
            first.width = BELOW;
            shown = chosen(&all, columns);
        }
        Self { all, shown, is_above, columns }
    }

    /// The heads, below a line that says which columns are left out.
    pub(super) fn head(&self) -> String {
        let heads: Vec<&str> = self.all.iter().map(|column| &column.head[..]).collect();
        let missing: Vec<&str> =
            (0..self.all.len()).filter(|index| !self.shown.contains(index)).map(|index| heads[index]).collect();
        let missing = match (&missing[..], self.columns) {
            ([_, ..], Some(columns)) => {
                let said = format!("no room in {columns} columns, but with --json: {}", missing.join(", "));
                hanging("", &said, self.columns) + "\n"
            }
            _ => String::new(),
        };
        missing + &self.line(&heads)
    }

    /// A row; `cells` are those of all columns.
    pub(super) fn row(&self, cells: &[impl AsRef<str>]) -> String {
        self.line(cells)
    }

    fn line(&self, cells: &[impl AsRef<str>]) -> String {
        let name = cells.first().map_or("", AsRef::as_ref);
        let cells = self.shown.iter().map(|&index| match index {
            0 if self.is_above => " ".repeat(BELOW),
            _ => self.all[index].cell(cells[index].as_ref()),
        });
        let line = cells.collect::<String>();
        let above = if self.is_above { hanging("", name, self.columns) + "\n" } else { String::new() };
        above + line.trim_end() + "\n"
    }
}

/// Whether some columns of a table fit so many of a terminal.
fn fit(all: &[Column], shown: &[usize], columns: Option<usize>) -> bool {
    columns.is_none_or(|columns| shown.iter().map(|&index| all[index].taken()).sum::<usize>() <= columns)
}

/// The columns without those that have to be left out.
fn chosen(all: &[Column], columns: Option<usize>) -> Vec<usize> {
    let mut shown: Vec<usize> = (0..all.len()).collect();
    while !fit(all, &shown, columns) {
        let left_out = shown.iter().filter(|&&index| all[index].rank > 0).max_by_key(|&&index| all[index].rank);
        let Some(&left_out) = left_out else { break };
        shown.retain(|&index| index != left_out);
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(name: usize, columns: Option<usize>) -> String {
        let numbers = [("steps", 0), ("iterations", 2), ("wall s", 1)];
        let numbers = numbers.map(|(head, rank)| Column::of_numbers(head, 10).rank(rank));
        let all = std::iter::once(Column::of_words("run", name)).chain(numbers).collect();
        let table = Columns::fitting(all, columns);
        table.head() + &table.row(&["one", "7", "21", "0.4"])
    }

    #[test]
    fn what_matters_least_is_left_out_first() {
        assert_eq!(
            table(8, None),
            "run           steps iterations     wall s\none               7         21        0.4\n"
        );
        assert_eq!(table(8, Some(41)), table(8, None));
        assert_eq!(
            table(8, Some(40)),
            "no room in 40 columns, but with --json:\niterations\nrun           steps     wall s\n\
             one               7        0.4\n"
        );
    }

    #[test]
    fn a_long_name_stands_above() {
        let table = table(30, Some(40));
        assert_eq!(table, "run\n        steps iterations     wall s\none\n            7         21        0.4\n");
    }
}
