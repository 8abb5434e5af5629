//! Quantities in words, the same wherever something is shown to a person.

/// A number with its sign; the minus is a minus, not a hyphen.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    format!("{value:+.decimals$}").replace('-', "−")
}

/// A number with up to three decimals, and none that say nothing.
pub(crate) fn rounded(value: f64) -> String {
    let text = format!("{value:.3}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_string(),
        text => text.replace('-', "−"),
    }
}

/// A component with two digits behind the point that does not read "-0.00".
pub(crate) fn unsigned_zero(value: f64) -> f64 {
    if value.abs() < 0.005 { 0.0 } else { value }
}

/// "1 stage", "2 stages".
pub(crate) fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Seconds as a person would say them: "0.4 s", "2 min 05 s", "1 h 12 min".
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 59.95 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    match whole {
        0..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_for_numbers() {
        assert_eq!(signed(-4.94, 1), "−4.9");
        assert_eq!(signed(0.44, 1), "+0.4");
        assert_eq!(["9.9", "20", "0", "−0.001"], [9.9, 20.0, -0.0001, -0.001].map(rounded).as_slice());
        assert_eq!(count(1, "stage"), "1 stage");
        assert_eq!(count(0, "stage"), "0 stages");
        assert_eq!(
            ["0.0 s", "59.9 s", "1 min 00 s", "59 min 59 s", "1 h 00 min"],
            [0.0, 59.94, 59.96, 3599.4, 3599.6].map(duration).as_slice()
        );
    }
}
