//! Gauss–Legendre quadrature on [−1, 1].

/// Computes nodes (ascending) and weights of the Gauss–Legendre rule with `count` points, exact for polynomials of degree 2
/// count − 1.
pub fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let mut rule: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            // Newton on the Legendre polynomial from the asymptotic root: quadratic, a handful of steps.
            for _ in 0..12 {
                let (value, slope) = legendre(count, x);
                x -= value / slope;
            }
            let (_, slope) = legendre(count, x);
            [x, 2.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect();
    rule.sort_by(|a, b| a[0].total_cmp(&b[0]));
    rule
}

/// Computes a Legendre polynomial and its derivative by the three-term recurrence.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    let slope = degree as f64 * (x * value - before) / (x * x - 1.0);
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn integrates_every_power_that_it_should() {
        for count in 1..=6 {
            for power in 0..2 * count {
                let sum: f64 = gauss_legendre(count).iter().map(|[x, w]| w * x.powi(power as i32)).sum();
                let exact = if power % 2 == 0 { 2.0 / (power as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{count} points, x^{power}: {sum} instead of {exact}");
            }
        }
    }
}
