//! Quantities in words, the same wherever something is shown to a person.

/// Formats a number with its sign; the minus is a minus, not a hyphen.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    format!("{value:+.decimals$}").replace('-', "−")
}

/// Formats a number with up to three decimals, without trailing zeros.
pub(crate) fn rounded(value: f64) -> String {
    let text = format!("{value:.3}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_string(),
        text => text.replace('-', "−"),
    }
}

/// Formats a number with this many significant digits, without an exponent where a person reads that at a glance.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let decimals = digits.saturating_sub(1);
    let scientific = format!("{value:.decimals$e}");
    let shown = match scientific.parse::<f64>() {
        Ok(0.0) => "0".into(),
        Ok(rounded) if (1e-3..1e6).contains(&rounded.abs()) => rounded.to_string(),
        Ok(rounded) => format!("{rounded:e}"),
        Err(_) => scientific,
    };
    shown.replace('-', "−")
}

/// Formats a measured number with this many decimals, or in powers of ten where those would leave fewer than three
/// digits of it.
pub(crate) fn reading(value: f64, decimals: usize) -> String {
    let least = 10.0_f64.powi(2 - decimals as i32);
    match value.abs() {
        size if size == 0.0 || size >= least => format!("{value:.decimals$}"),
        _ => format!("{value:.decimals$e}"),
    }
    .replace('-', "−")
}

/// Formats a measured number with this many decimals, or with four significant digits where those would leave fewer than
/// three digits of it, or more than ten.
pub(crate) fn figure(value: f64, decimals: usize) -> String {
    let least = 10.0_f64.powi(2 - decimals as i32);
    match value.abs() {
        size if size == 0.0 || (least..1e7).contains(&size) => format!("{value:.decimals$}").replace('-', "−"),
        _ => significant(value, 4),
    }
}

/// Formats a point in space as "(x, y, z) mm"; a component of a millionth of the largest or less is 0.
pub(crate) fn place(point: [f64; 3]) -> String {
    let largest = point.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let [x, y, z] = point.map(|x| significant(if x.abs() <= 1e-6 * largest { 0.0 } else { x }, 5));
    format!("({x}, {y}, {z}) mm")
}

/// Replaces a component that would read "-0.00" with two decimals by 0.
#[cfg(feature = "cli")]
pub(crate) fn unsigned_zero(value: f64) -> f64 {
    if value.abs() < 0.005 { 0.0 } else { value }
}

/// Formats a count with its noun: "1 stage", "2 stages".
pub(crate) fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Formats seconds as a person would say them: "0.4 s", "2 min 05 s", "1 h 12 min".
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
        assert_eq!(
            ["0", "1.59e−6", "−0.0123", "12.3", "1230", "1.23e7"],
            [0.0, 1.59e-6, -0.012345, 12.345, 1234.5, 12_345_678.0].map(|value| significant(value, 3)).as_slice()
        );
        assert_eq!(
            ["0.0000", "−0.0123", "1.5900e−6"],
            [0.0, -0.0123, 1.59e-6].map(|value| reading(value, 4)).as_slice()
        );
        assert_eq!(
            ["2771.9", "−26.6", "2.772", "0.002772", "2.772e−9", "2.772e9", "0.0"],
            [2771.93, -26.57, 2.77193, 2.77193e-3, 2.77193e-9, 2.77193e9, 0.0].map(|value| figure(value, 1)).as_slice()
        );
        assert_eq!(place([1e-17, -2.0, 3.0e-4]), "(0, −2, 3e−4) mm");
        assert_eq!(count(1, "stage"), "1 stage");
        assert_eq!(count(0, "stage"), "0 stages");
        assert_eq!(
            ["0.0 s", "59.9 s", "1 min 00 s", "59 min 59 s", "1 h 00 min"],
            [0.0, 59.94, 59.96, 3599.4, 3599.6].map(duration).as_slice()
        );
    }
}
