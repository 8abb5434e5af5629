//! Points in the unit cube: Latin hypercubes, Sobol's sequence, independent points; the same for the same seed on every machine.

use super::sweep_file::{Method, Sample};

/// Points of the unit cube with so many axes, one after another.
pub(super) fn points(sample: &Sample, axes: usize) -> Vec<Vec<f64>> {
    let Sample { count, method, seed } = *sample;
    match method {
        Method::LatinHypercube => latin_hypercube(count, axes, seed),
        Method::Sobol => {
            let at = |index: usize, axis: usize| f64::from(sobol_burley::sample(index as u32, axis as u32, seed));
            (0..count).map(|index| (0..axes).map(|axis| at(index, axis)).collect()).collect()
        }
        Method::Random => {
            let mut numbers = Numbers::new(seed, 0);
            (0..count).map(|_| (0..axes).map(|_| numbers.share()).collect()).collect()
        }
    }
}

/// One point in each of `count` strata of every axis, at a random place in it; strata are matched at random.
fn latin_hypercube(count: usize, axes: usize, seed: u32) -> Vec<Vec<f64>> {
    let mut points = vec![Vec::with_capacity(axes); count];
    for axis in 0..axes {
        let mut numbers = Numbers::new(seed, axis as u64);
        let mut strata: Vec<usize> = (0..count).collect();
        // Fisher and Yates.
        for last in (1..count).rev() {
            strata.swap(last, numbers.below(last + 1));
        }
        for (point, stratum) in points.iter_mut().zip(strata) {
            point.push((stratum as f64 + numbers.share()) / count as f64);
        }
    }
    points
}

/// Random numbers from the hash of a seed: no version of a library changes them.
struct Numbers(blake3::OutputReader);

impl Numbers {
    fn new(seed: u32, stream: u64) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"foldline sample 1").update(&seed.to_le_bytes()).update(&stream.to_le_bytes());
        Self(hasher.finalize_xof())
    }

    fn next(&mut self) -> u64 {
        let mut bytes = [0; 8];
        self.0.fill(&mut bytes);
        u64::from_le_bytes(bytes)
    }

    /// From 0 to below 1, of 53 bits.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Below a bound: the high half of a product, whose bias is below 2⁻⁴⁰ for any list that fits.
    fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.next()) * bound as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(count: usize, method: Method, seed: u32) -> Vec<Vec<f64>> {
        points(&Sample { count, method, seed }, 3)
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_stratum() {
        let found = sample(50, Method::LatinHypercube, 7);
        for axis in 0..3 {
            let mut strata: Vec<usize> = found.iter().map(|point| (50.0 * point[axis]) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..50).collect::<Vec<_>>());
        }
        // Axes are matched at random, not in step.
        assert!(found.iter().filter(|point| (50.0 * point[0]) as usize == (50.0 * point[1]) as usize).count() < 10);
    }

    #[test]
    fn a_seed_gives_the_same_points_and_another_others() {
        for method in [Method::LatinHypercube, Method::Sobol, Method::Random] {
            assert_eq!(sample(9, method, 1), sample(9, method, 1));
            assert_ne!(sample(9, method, 1), sample(9, method, 2));
            assert!(sample(99, method, 1).iter().flatten().all(|share| (0.0..1.0).contains(share)));
        }
        // Points of a version stay those of the next.
        let known = sample(2, Method::LatinHypercube, 1);
        assert_eq!(format!("{:.6}", known[0][0]), KNOWN, "{known:?}");
    }

    const KNOWN: &str = "0.599049";

    #[test]
    fn sobol_fills_more_evenly_than_chance() {
        // The mean of x y over the unit square is 1/4.
        let off = |method| {
            let found = sample(1024, method, 3);
            (found.iter().map(|point| point[0] * point[1]).sum::<f64>() / 1024.0 - 0.25).abs()
        };
        assert!(off(Method::Sobol) < 1e-3, "{}", off(Method::Sobol));
    }
}
