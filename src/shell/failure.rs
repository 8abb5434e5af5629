//! Criteria of failure of an orthotropic layer in plane stress, each as an index that is 1 where the layer fails and grows as the
//! load does: the load over that at failure if all stresses grow alike (the inverse of the reserve factor R).
//!
//! Tsai and Wu (*J. Compos. Mater.* 5, 1971): the layer fails where F₁σ₁ + F₂σ₂ + F₁₁σ₁² + F₂₂σ₂² + 2F₁₂σ₁σ₂ + F₆₆τ² = 1, with
//!
//! F₁ = 1/Xₜ − 1/X_c, F₁₁ = 1/(Xₜ X_c), F₂ and F₂₂ alike of Y, F₆₆ = 1/S², and F₁₂ = −½ √(F₁₁ F₂₂),
//!
//! which makes it von Mises' criterion where the layer is equally strong every way (Tsai & Hahn, *Introduction to Composite
//! Materials*, 1980). The left side is no measure of the load, of which it has the square too: with a and b its quadratic and
//! linear parts, stresses R times as large fail where a R² + b R = 1, so that 1/R = ½ (b + √(b² + 4a)).
//!
//! Maximum strain: each strain in the layer's axes over that at which it fails alone, which is the strength over the modulus: the
//! layer is elastic up to there.

use crate::scene::{OrthotropicLaw, Strengths};

/// Tsai and Wu's criterion for stresses σ₁, σ₂, τ₁₂ in the layer's axes, MPa, as 1/R.
pub fn tsai_wu(strengths: &Strengths, [s1, s2, s12]: [f64; 3]) -> f64 {
    let Strengths {
        tensile_strength_1_mpa: xt,
        compressive_strength_1_mpa: xc,
        tensile_strength_2_mpa: yt,
        compressive_strength_2_mpa: yc,
        shear_strength_12_mpa: s,
    } = *strengths;
    let [f1, f2] = [1.0 / xt - 1.0 / xc, 1.0 / yt - 1.0 / yc];
    let (x, y, shear) = (s1 / (xt * xc).sqrt(), s2 / (yt * yc).sqrt(), s12 / s);
    let linear = f1 * s1 + f2 * s2;
    // Positive but for rounding.
    let quadratic = (x * x - x * y + y * y + shear * shear).max(0.0);
    0.5 * (linear + (linear * linear + 4.0 * quadratic).sqrt())
}

/// Maximum strain, for elastic strains ε₁, ε₂, 2ε₁₂ in the layer's axes.
pub fn maximum_strain(law: &OrthotropicLaw, strengths: &Strengths, [e1, e2, shear]: [f64; 3]) -> f64 {
    let exhausted = |strain: f64, modulus: f64, tensile: f64, compressive: f64| {
        strain.abs() * modulus / if strain < 0.0 { compressive } else { tensile }
    };
    let Strengths { tensile_strength_1_mpa: xt, compressive_strength_1_mpa: xc, .. } = *strengths;
    let Strengths { tensile_strength_2_mpa: yt, compressive_strength_2_mpa: yc, .. } = *strengths;
    let s = strengths.shear_strength_12_mpa;
    exhausted(e1, law.youngs_modulus_1_mpa, xt, xc).max(exhausted(e2, law.youngs_modulus_2_mpa, yt, yc)).max(exhausted(
        shear,
        law.shear_modulus_12_mpa,
        s,
        s,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRENGTHS: Strengths = Strengths {
        tensile_strength_1_mpa: 1500.0,
        compressive_strength_1_mpa: 1200.0,
        tensile_strength_2_mpa: 50.0,
        compressive_strength_2_mpa: 200.0,
        shear_strength_12_mpa: 80.0,
    };

    #[test]
    fn every_strength_alone_is_failure_and_half_of_it_is_half_way() {
        for stresses in
            [[1500.0, 0.0, 0.0], [-1200.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, -200.0, 0.0], [0.0, 0.0, -80.0]]
        {
            let index = |factor: f64| tsai_wu(&STRENGTHS, stresses.map(|stress| factor * stress));
            assert!((index(1.0) - 1.0).abs() < 1e-14 && (index(0.5) - 0.5).abs() < 1e-14, "{stresses:?}");
        }
        assert_eq!(tsai_wu(&STRENGTHS, [0.0; 3]), 0.0);
    }

    /// The stresses over the index lie on the surface F = 1.
    #[test]
    fn stresses_over_the_index_fail() {
        let stresses = [300.0, -70.0, 25.0];
        let [s1, s2, s12] = stresses.map(|stress| stress / tsai_wu(&STRENGTHS, stresses));
        let (f11, f22) = (1.0 / (1500.0 * 1200.0), 1.0_f64 / (50.0 * 200.0));
        let f12 = -0.5 * (f11 * f22).sqrt();
        let f = (1.0 / 1500.0 - 1.0 / 1200.0) * s1
            + (1.0 / 50.0 - 1.0 / 200.0) * s2
            + f11 * s1 * s1
            + f22 * s2 * s2
            + 2.0 * f12 * s1 * s2
            + s12 * s12 / 6400.0;
        assert!((f - 1.0).abs() < 1e-13, "{f}");
    }

    #[test]
    fn a_layer_that_is_equally_strong_every_way_fails_as_mises_has_it() {
        let x = 100.0;
        let even = Strengths {
            tensile_strength_1_mpa: x,
            compressive_strength_1_mpa: x,
            tensile_strength_2_mpa: x,
            compressive_strength_2_mpa: x,
            shear_strength_12_mpa: x / 3.0_f64.sqrt(),
        };
        let [s1, s2, s12] = [30.0, -45.0, 20.0_f64];
        let mises = (s1 * s1 - s1 * s2 + s2 * s2 + 3.0 * s12 * s12).sqrt();
        assert!((tsai_wu(&even, [s1, s2, s12]) - mises / x).abs() < 1e-14);
    }
}
