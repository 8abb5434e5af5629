//! How the section of a bent strip deforms: the functions F₁ and F₂ of Wuest's law, without cancellation.
//!
//! > F₁ = (2/λ)(cosh λ − cos λ)/(sinh λ + sin λ),   F₂ = F₁/4 − sinh λ sin λ/(sinh λ + sin λ)².

/// Below this λ, G and F₂ come from their power series in λ⁴; above, closed forms lose at most two digits.
const SERIES_BELOW_LAMBDA: f64 = 2.0;

/// Terms of the series: at λ = 2 the first one left out is below 1e-17 of the sum.
const SERIES_TERMS: usize = 8;

/// G = 1 − F₁ and F₂ at one λ.
pub(super) struct SectionShape {
    /// G = 1 − F₁: how far the section has opened, from 0.
    pub(super) g: f64,
    /// F₂ = −λ F₁′/4.
    pub(super) f2: f64,
}

impl SectionShape {
    /// At λ ≥ 0.
    pub(super) fn at(lambda: f64) -> Self {
        if lambda < SERIES_BELOW_LAMBDA { Self::series(lambda) } else { Self::closed(lambda) }
    }

    /// The formulas above, scaled by e^−λ so that nothing overflows.
    fn closed(lambda: f64) -> Self {
        let decay = (-lambda).exp();
        let (sin, cos) = lambda.sin_cos();
        let (sinh, cosh) = (0.5 * (1.0 - decay * decay), 0.5 * (1.0 + decay * decay));
        let below = sinh + decay * sin;
        let f1 = 2.0 / lambda * (cosh - decay * cos) / below;
        Self { g: 1.0 - f1, f2: f1 / 4.0 - sinh * decay * sin / (below * below) }
    }

    /// Power series in x = λ⁴, from
    /// cosh λ − cos λ = λ² Σ 2 xʲ/(4j+2)!, sinh λ + sin λ = 2 λ Σ xʲ/(4j+1)!, sinh λ sin λ = λ² Σ (−4)ʲ 2 xʲ/(4j+2)!.
    /// With N, B, P the three sums: G = (B − N)/B and F₂ = (N B − P)/4 B², where the constant terms cancel exactly.
    fn series(lambda: f64) -> Self {
        let x = lambda.powi(4);
        let (mut n, mut b, mut p) = ([0.0; SERIES_TERMS], [0.0; SERIES_TERMS], [0.0; SERIES_TERMS]);
        let (mut factorial, mut sign) = (1.0, 1.0);
        for j in 0..SERIES_TERMS {
            let first = (4 * j + 1) as f64;
            b[j] = 1.0 / factorial;
            n[j] = 2.0 / (factorial * (first + 1.0));
            p[j] = sign * n[j];
            factorial *= (first + 1.0) * (first + 2.0) * (first + 3.0) * (first + 4.0);
            sign *= -4.0;
        }
        let sum = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| sum * x + term);
        let mut product = [0.0; SERIES_TERMS];
        for (j, term) in product.iter_mut().enumerate() {
            *term = (0..=j).map(|i| n[i] * b[j - i]).sum::<f64>() - p[j];
        }
        let mut difference = [0.0; SERIES_TERMS];
        for (j, term) in difference.iter_mut().enumerate() {
            *term = b[j] - n[j];
        }
        let below = sum(&b);
        Self { g: x * sum(&difference[1..]) / below, f2: x * sum(&product[1..]) / (4.0 * below * below) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
    }

    #[test]
    fn series_and_closed_form_agree_where_they_meet() {
        for lambda in [1.5, 2.0, 2.5] {
            let (series, closed) = (SectionShape::series(lambda), SectionShape::closed(lambda));
            close(series.g / closed.g, 1.0, 1e-12);
            close(series.f2 / closed.f2, 1.0, 1e-11);
        }
    }

    #[test]
    fn both_are_lambda_to_the_fourth_over_180_at_first() {
        for lambda in [1e-6, 1e-3, 1e-2] {
            let SectionShape { g, f2 } = SectionShape::at(lambda);
            let first = f64::powi(lambda, 4) / 180.0;
            close(g / first, 1.0, 1e-8);
            close(f2 / first, 1.0, 1e-8);
        }
    }

    #[test]
    fn wide_strips_stay_finite() {
        let SectionShape { g, f2 } = SectionShape::at(1e5);
        close(g, 1.0 - 2e-5, 1e-15);
        close(f2, 0.5e-5, 1e-15);
    }
}
