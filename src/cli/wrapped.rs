//! Lines that fit a terminal.

use super::terminal::prose_columns;

/// A text in lines that fit, the first behind `head`, the others indented as far.
pub(super) fn wrapped(head: &str, text: &str) -> String {
    hanging(head, text, Some(prose_columns()))
}

/// The same in lines of so many columns.
pub(super) fn hanging(head: &str, text: &str, columns: Option<usize>) -> String {
    let Some(columns) = columns else { return format!("{head}{text}") };
    let hang = head.chars().count();
    let mut lines = Lines { columns, hang, line: head.to_owned(), used: hang, ..Lines::default() };
    lines.put_words("", text);
    lines.finish()
}

/// A text with the lines that are too long for a terminal broken: at gaps between columns, or else between words.
pub(super) fn fitted(text: &str, columns: Option<usize>) -> String {
    let Some(columns) = columns else { return text.to_owned() };
    let lines = text.split('\n').map(|line| match line.chars().count() > columns {
        true => broken(line, columns),
        false => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// A line in as many as it takes. What follows hangs below the second column, where that is near enough.
fn broken(line: &str, columns: usize) -> String {
    let pieces = pieces(line);
    let hang = match &pieces[..] {
        [(indent, first), (gap, _), ..] => {
            let second: usize = [indent, first, gap].map(|text| text.chars().count()).iter().sum();
            if 5 * second <= 2 * columns { second } else { indent.len() + 2 }
        }
        _ => line.len() - line.trim_start_matches(' ').len() + 2,
    };
    let mut lines = Lines { columns, hang, ..Lines::default() };
    for (gap, piece) in pieces {
        let [gap_columns, piece_columns] = [gap, piece].map(|text| text.chars().count());
        if lines.used + gap_columns + piece_columns <= columns {
            lines.put(gap, piece);
        } else if hang + piece_columns <= columns {
            lines.end();
            lines.put("", piece);
        } else {
            lines.put_words(gap, piece);
        }
    }
    lines.finish()
}

/// What stands between gaps of two spaces or more, each with the gap before it.
fn pieces(line: &str) -> Vec<(&str, &str)> {
    let mut pieces = Vec::new();
    let mut rest = line;
    while !rest.is_empty() {
        let (gap, behind) = rest.split_at(rest.len() - rest.trim_start_matches(' ').len());
        let (piece, next) = behind.split_at(behind.find("  ").unwrap_or(behind.len()));
        if !piece.is_empty() {
            pieces.push((gap, piece));
        }
        rest = next;
    }
    pieces
}

/// Lines under way.
#[derive(Default)]
struct Lines {
    columns: usize,
    /// Indent of all but the first.
    hang: usize,
    done: String,
    line: String,
    /// Columns of `line`.
    used: usize,
}

impl Lines {
    fn put(&mut self, gap: &str, text: &str) {
        self.line.push_str(gap);
        self.line.push_str(text);
        self.used += gap.chars().count() + text.chars().count();
    }

    /// Ends the line, unless it is an indent alone.
    fn end(&mut self) {
        if !self.line.trim().is_empty() {
            self.done.push_str(self.line.trim_end());
            self.done.push('\n');
            self.line = " ".repeat(self.hang);
            self.used = self.hang;
        }
    }

    /// Puts words, as many in a line as fit; none is broken.
    fn put_words(&mut self, gap: &str, text: &str) {
        let mut gap = gap;
        for word in text.split(' ') {
            if self.used > self.hang && self.used + gap.len() + word.chars().count() > self.columns {
                self.end();
                gap = "";
            }
            self.put(gap, word);
            gap = " ";
        }
    }

    fn finish(self) -> String {
        self.done + &self.line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_full_and_none_is_longer() {
        let text = wrapped("warning: ", "word ".repeat(40).trim_end());
        assert!(text.lines().all(|line| line.chars().count() <= prose_columns()), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("         word")), "{text}");
        assert_eq!(wrapped("  odd  ", "nothing"), "  odd  nothing");
        assert_eq!(wrapped("", &"x".repeat(100)), "x".repeat(100), "a word is not broken");
    }

    #[test]
    fn long_lines_are_broken_at_gaps_and_then_between_words() {
        let row = "  peak        322.3 N·mm at 10°  Wuest  287.9   +12.0 %";
        assert_eq!(fitted(row, None), row);
        assert_eq!(fitted(row, Some(60)), row);
        assert_eq!(fitted(row, Some(42)), "  peak        322.3 N·mm at 10°  Wuest\n              287.9   +12.0 %");
        let prose = "  warning at 16°: these elements cannot show the shape of the shell";
        assert_eq!(fitted(prose, Some(42)), "  warning at 16°: these elements cannot\n    show the shape of the shell");
        assert_eq!(fitted("short\n\nlines\n", Some(40)), "short\n\nlines\n");
        assert_eq!(fitted(&"x".repeat(50), Some(40)), "x".repeat(50), "a word is not broken");
    }
}
