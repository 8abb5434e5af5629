//! Round numbers for axes and colour bars.

/// Round numbers within `range`, about `wanted` of them, and the decimals that tell them apart.
pub(super) fn ticks(range: [f64; 2], wanted: usize) -> (Vec<f64>, usize) {
    let [low, high] = range;
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return (vec![low], 3);
    }
    let rough = span / wanted.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let decimals = (0..12).find(|&d| is_whole(step * 10f64.powi(d))).unwrap_or(12);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    ((first..=last).map(|i| i as f64 * step).collect(), decimals as usize)
}

/// The same as they are written: with as many decimals as tell them apart, or in powers of ten where those would be long.
pub(super) fn labelled_ticks([low, high]: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let largest = low.abs().max(high.abs());
    let is_plain = largest == 0.0 || (1e-3..1e6).contains(&largest);
    let power = if is_plain { 0 } else { largest.log10().floor() as i32 };
    let unit = 10f64.powi(power);
    let (mantissas, decimals) = ticks([low / unit, high / unit], wanted);
    let label = |mantissa: f64| {
        let digits = format!("{mantissa:.decimals$}");
        let text = if power == 0 || mantissa == 0.0 { digits } else { format!("{digits}e{power}") };
        text.replace('-', "−")
    };
    mantissas.into_iter().map(|mantissa| (mantissa * unit, label(mantissa))).collect()
}

/// The range in which values from `low` to `high` are shown: with 0, unless more than half of it would be empty.
pub(super) fn in_view([low, high]: [f64; 2]) -> [f64; 2] {
    let far_from_zero = low > 0.5 * high.abs() || high < -0.5 * low.abs();
    if far_from_zero { [low, high] } else { [low.min(0.0), high.max(0.0)] }
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs()
}

#[cfg(test)]
mod tests {
    use super::{in_view, labelled_ticks, ticks};

    #[test]
    fn ticks_are_round_and_told_apart() {
        assert_eq!(ticks([0.0, 0.1037], 5), (vec![0.0, 0.025, 0.05, 0.07500000000000001, 0.1], 3));
        assert_eq!(ticks([0.0, 292.0], 6), (vec![0.0, 50.0, 100.0, 150.0, 200.0, 250.0], 0));
        assert_eq!(ticks([3.0, 3.0], 6).0, [3.0]);
        assert_eq!(ticks([0.0, f64::NAN], 6).0, [0.0]);
    }

    #[test]
    fn labels_have_the_digits_that_tell_them_apart() {
        let labels = |range| labelled_ticks(range, 4).into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(labels([0.0, 0.75]), ["0.0", "0.2", "0.4", "0.6"]);
        assert_eq!(labels([-37.0, 0.0]), ["−30", "−20", "−10", "0"]);
        assert_eq!(labels([0.0, 4.2e-7]), ["0", "2e−7", "4e−7"]);
        assert_eq!(labels([0.0, 1.6e9]), ["0.0", "0.5e9", "1.0e9", "1.5e9"]);
    }

    #[test]
    fn zero_is_in_view_unless_half_of_the_range_would_be_empty() {
        assert_eq!(in_view([0.4, 1.0]), [0.0, 1.0]);
        assert_eq!(in_view([0.6, 1.0]), [0.6, 1.0]);
        assert_eq!(in_view([-1.0, -0.4]), [-1.0, 0.0]);
        assert_eq!(in_view([-1.0, -0.6]), [-1.0, -0.6]);
        assert_eq!(in_view([-1.0, 2.0]), [-1.0, 2.0]);
    }
}
