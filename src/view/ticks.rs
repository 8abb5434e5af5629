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

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs()
}

#[cfg(test)]
mod tests {
    use super::ticks;

    #[test]
    fn ticks_are_round_and_told_apart() {
        assert_eq!(ticks([0.0, 0.1037], 5), (vec![0.0, 0.025, 0.05, 0.07500000000000001, 0.1], 3));
        assert_eq!(ticks([0.0, 292.0], 6), (vec![0.0, 50.0, 100.0, 150.0, 200.0, 250.0], 0));
        assert_eq!(ticks([3.0, 3.0], 6).0, [3.0]);
        assert_eq!(ticks([0.0, f64::NAN], 6).0, [0.0]);
    }
}
