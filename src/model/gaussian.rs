//! Normally distributed numbers, the same for a seed on every machine: bits of BLAKE3 as a stream (O'Connor et al. 2020), and Box &
//! Muller 1958, *A note on the generation of random normal deviates*, with functions that are computed alike everywhere.

use std::f64::consts::TAU;

/// A stream of independent numbers with mean 0 and standard deviation 1.
#[derive(Debug)]
pub struct Gaussians {
    bits: blake3::OutputReader,
    /// The second number of a pair.
    kept: Option<f64>,
}

impl Gaussians {
    /// Creates the stream of a seed for a purpose: streams of other purposes have nothing in common with it.
    pub fn new(purpose: &str, seed: u64) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key(purpose);
        hasher.update(&seed.to_le_bytes());
        Self { bits: hasher.finalize_xof(), kept: None }
    }

    /// A number above 0 and up to 1.
    fn uniform(&mut self) -> f64 {
        let mut bytes = [0; 8];
        self.bits.fill(&mut bytes);
        ((u64::from_le_bytes(bytes) >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// The next number.
    pub fn draw(&mut self) -> f64 {
        if let Some(kept) = self.kept.take() {
            return kept;
        }
        let (radius, angle) = ((-2.0 * libm::log(self.uniform())).sqrt(), TAU * self.uniform());
        self.kept = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }

    /// The next three numbers.
    pub fn vector(&mut self) -> [f64; 3] {
        [(); 3].map(|()| self.draw())
    }
}
