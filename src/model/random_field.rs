//! A homogeneous Gaussian field of vectors in space by its spectral representation (Shinozuka & Deodatis 1991, *Simulation of stochastic
//! processes by spectral representation*), with wave vectors that are drawn from the spectrum:
//!
//! f(x) = σ/√M Σₘ (aₘ cos kₘ·x + bₘ sin kₘ·x),   aₘ, bₘ ~ N(0, I),   kₘ ~ N(0, 2/ℓ² I).
//!
//! Each component is normal with the standard deviation σ, components are independent, and points at a distance r have the
//! correlation E cos k·r = exp(−(r/ℓ)²): the spectrum of this correlation is the normal density of k. With M waves the correlation
//! of one seed differs from that by about 1/√M.

use crate::model::gaussian::Gaussians;
use crate::shell::{add, dot, scaled};

/// Number of waves: the correlation of one field is off by 4 %, and a field on 10⁴ points takes a tenth of a second.
const WAVES: usize = 512;

/// Changes where seeds are to mean other fields.
const PURPOSE: &str = "foldline random field 1";

/// A field of vectors in space.
#[derive(Debug)]
pub struct RandomField {
    waves: Vec<Wave>,
}

#[derive(Debug)]
struct Wave {
    /// k, 1/mm.
    vector: [f64; 3],
    /// σ/√M times a and b, mm.
    amplitudes: [[f64; 3]; 2],
}

impl RandomField {
    /// Draws the field of a seed, with its correlation length and standard deviation, mm.
    pub fn new(seed: u64, correlation_mm: f64, deviation_mm: f64) -> Self {
        let mut gaussians = Gaussians::new(PURPOSE, seed);
        let size = deviation_mm / (WAVES as f64).sqrt();
        let wave = |_| Wave {
            vector: scaled(std::f64::consts::SQRT_2 / correlation_mm, gaussians.vector()),
            amplitudes: [(); 2].map(|()| scaled(size, gaussians.vector())),
        };
        Self { waves: (0..WAVES).map(wave).collect() }
    }

    /// Evaluates the field at a place, mm.
    pub fn at(&self, place: [f64; 3]) -> [f64; 3] {
        self.waves.iter().fold([0.0; 3], |sum, Wave { vector, amplitudes: [cos, sin] }| {
            let phase = dot(*vector, place);
            add(sum, add(scaled(libm::cos(phase), *cos), scaled(libm::sin(phase), *sin)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over 4000 seeds: means of products of two components are normal about their expectation with a deviation of at most √2/√4000 =
    /// 2.2 %, of which four are allowed.
    #[test]
    fn variance_and_correlation_are_those_that_were_asked_for() {
        const SEEDS: u64 = 4000;
        let (length, deviation) = (7.0, 0.3);
        let places = [0.0, 3.0, 7.0, 14.0].map(|r| [5.0 + 0.6 * r, -2.0 + 0.8 * r, 1.0]);
        let mut products = [0.0; 4];
        let (mut crossed, mut means, mut fourth) = (0.0, [0.0; 3], 0.0);
        for seed in 0..SEEDS {
            let field = RandomField::new(seed, length, deviation);
            let values = places.map(|place| field.at(place));
            (0..4).for_each(|k| products[k] += values[0][2] * values[k][2] / (deviation * deviation));
            crossed += values[0][0] * values[0][1] / (deviation * deviation);
            (0..3).for_each(|c| means[c] += values[2][c] / deviation);
            fourth += (values[1][1] / deviation).powi(4);
        }
        let count = SEEDS as f64;
        let most = 4.0 * (2.0 / count).sqrt();
        for (product, r) in products.into_iter().zip([0.0_f64, 3.0, 7.0, 14.0]) {
            let expected = (-(r / length).powi(2)).exp();
            assert!((product / count - expected).abs() < most, "{} at {r}, not {expected}", product / count);
        }
        assert!((crossed / count).abs() < most, "components are independent: {}", crossed / count);
        assert!(means.iter().all(|mean| (mean / count).abs() < 4.0 / count.sqrt()), "{means:?}");
        // E x⁴ = 3 of a normal number, with a variance of 96.
        assert!((fourth / count - 3.0).abs() < 4.0 * (96.0 / count).sqrt(), "{}", fourth / count);
    }

    /// Bits of one field, as every machine has them.
    #[test]
    fn a_seed_is_one_field_for_ever() {
        let [x, y, z] = RandomField::new(1, 20.0, 0.1).at([10.0, -3.0, 0.5]);
        assert_eq!([x, y, z], [-0.0653101170940863, 0.058202461513648336, 0.14633586876050717]);
        assert_ne!(RandomField::new(2, 20.0, 0.1).at([10.0, -3.0, 0.5]), [x, y, z]);
    }
}
