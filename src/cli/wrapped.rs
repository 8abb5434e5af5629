//! Sentences in lines that fit a terminal.

/// Characters of a line.
pub(super) const WIDTH: usize = 80;

/// A text in lines of at most [`WIDTH`] characters, the first behind `head`, the others indented as far.
pub(super) fn wrapped(head: &str, text: &str) -> String {
    let indent = head.chars().count();
    let mut lines = vec![head.to_owned()];
    let mut width = indent;
    for word in text.split(' ') {
        let length = word.chars().count();
        if width > indent && width + 1 + length > WIDTH {
            lines.push(" ".repeat(indent));
            width = indent;
        }
        if let Some(line) = lines.last_mut() {
            if width > indent {
                line.push(' ');
                width += 1;
            }
            line.push_str(word);
            width += length;
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_full_and_none_is_longer() {
        let text = wrapped("warning: ", "word ".repeat(40).trim_end());
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(text.lines().count(), 3);
        assert!(text.lines().skip(1).all(|line| line.starts_with("         word")), "{text}");
        assert_eq!(wrapped("  odd  ", "nothing"), "  odd  nothing");
        assert_eq!(wrapped("", &"x".repeat(100)), "x".repeat(100), "a word is not broken");
    }
}
