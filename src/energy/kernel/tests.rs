use std::ops::{Add, Div, Mul, Sub};

use super::*;
use crate::model::starting_patch;
use crate::scene::{Quadrature, parse};
use crate::shell::{Hessian, PointReference};

/// Every number of points and of functions that leaves something over: in a batch, a block, a vector, a tile.
const CASES: [([usize; 2], Quadrature); 16] = [
    ([2, 2], Quadrature::Full),
    ([2, 2], Quadrature::Reduced),
    ([2, 3], Quadrature::Full),
    ([3, 2], Quadrature::Full),
    ([3, 3], Quadrature::Full),
    ([3, 3], Quadrature::Reduced),
    ([3, 3], Quadrature::Patch),
    ([5, 4], Quadrature::Patch),
    ([2, 4], Quadrature::Full),
    ([4, 4], Quadrature::Full),
    ([4, 3], Quadrature::Reduced),
    ([5, 3], Quadrature::Full),
    ([5, 5], Quadrature::Full),
    ([2, 2], Quadrature::Balanced),
    ([3, 3], Quadrature::Balanced),
    ([4, 3], Quadrature::Balanced),
];

const ELEMENT: usize = 5;

fn tables_of(degree: [usize; 2], quadrature: Quadrature) -> Tables {
    let mut scene = parse(include_str!("../../../pipelines/baseline.toml"), "baseline.toml").unwrap();
    scene.mesh.degree = degree;
    scene.mesh.quadrature = quadrature;
    Tables::new(&scene, &starting_patch(&scene).unwrap())
}

/// Buffers with a displacement, and what an earlier element left in them.
fn prepared(tables: &Tables) -> ElementBuffers {
    let padded = tables.padded;
    let mut buffers = ElementBuffers::new(padded);
    for c in 0..3 {
        for a in 0..tables.functions_per_element {
            buffers.displacement[c * padded + a] = 0.1 * ((a * 31 + c * 17) % 13) as f64 - 0.6;
        }
    }
    buffers.residual.fill(7.0);
    buffers.stiffness.fill(7.0);
    buffers.energy = 7.0;
    buffers
}

fn integrated(tables: &Tables, want: Want, build: Build) -> ElementBuffers {
    let mut buffers = prepared(tables);
    integrate_element(tables, ELEMENT, want, build, &mut buffers);
    buffers
}

/// The numbers of the residual and of the blocks a ≤ b.
fn numbers(tables: &Tables, buffers: &ElementBuffers) -> (Vec<f64>, Vec<f64>) {
    let (used, padded) = (tables.functions_per_element, tables.padded);
    let residual = (0..3).flat_map(|c| buffers.residual[c * padded..][..used].to_vec()).collect();
    let rows = (0..9 * used).flat_map(|row| buffers.stiffness[row * padded..][..row / 9 + 1].to_vec()).collect();
    (residual, rows)
}

/// Largest difference over the largest number.
fn difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let largest = one.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    one.iter().zip(other).fold(0.0_f64, |most, (x, y)| most.max((x - y).abs())) / largest
}

/// Points of the element, the derivatives of its functions there, and how many those are.
fn point_lists(tables: &Tables) -> Vec<(&[PointReference], &[f64], usize)> {
    let whole = &tables.points;
    let mut lists = vec![(whole.element_points(ELEMENT), whole.element_functions(ELEMENT), 5)];
    lists.extend(
        tables.stretching.iter().map(|table| (table.element_points(ELEMENT), table.element_functions(ELEMENT), 2)),
    );
    lists
}

/// Energy, residual and stiffness as plain sums over points, from the derivatives of single points.
fn plain_sums(tables: &Tables) -> (f64, Vec<f64>, Vec<f64>) {
    let (used, padded) = (tables.functions_per_element, tables.padded);
    let displacement = prepared(tables).displacement;
    let mut energy = 0.0;
    let mut residual = vec![0.0; 3 * used];
    let mut stiffness = Vec::new();
    let mut at_points = Vec::new();
    let zeros = vec![0.0; used];
    for (references, functions, rows) in point_lists(tables) {
        for (q, point) in references.iter().enumerate() {
            let row = |k: usize| if k < rows { &functions[(q * rows + k) * padded..][..used] } else { &zeros };
            let f: Vec<Vec<f64>> = (0..5).map(|k| row(k).to_vec()).collect();
            let mut u = [[0.0; 3]; 5];
            for k in 0..5 {
                for c in 0..3 {
                    u[k][c] = (0..used).map(|a| f[k][a] * displacement[c * padded + a]).sum();
                }
            }
            let mut hessian: Hessian = [[0.0; 16]; 15];
            let (of_point, gradient) = point.hessian(&u, &mut hessian);
            energy += of_point;
            for c in 0..3 {
                for a in 0..used {
                    residual[c * used + a] += (0..5).map(|k| f[k][a] * gradient[k][c]).sum::<f64>();
                }
            }
            at_points.push((f, hessian));
        }
    }
    for b in 0..used {
        for dc in 0..9 {
            for a in 0..=b {
                let mut sum = 0.0;
                for (f, hessian) in &at_points {
                    for k in 0..5 {
                        for l in 0..5 {
                            sum += f[k][a] * hessian[3 * k + dc % 3][3 * l + dc / 3] * f[l][b];
                        }
                    }
                }
                stiffness.push(sum);
            }
        }
    }
    (energy, residual, stiffness)
}

#[test]
fn stretching_has_points_of_its_own_in_some_cases() {
    let own = CASES.iter().filter(|(degree, quadrature)| tables_of(*degree, *quadrature).stretching.is_some());
    assert_eq!(own.count(), 3);
}

#[test]
fn every_build_gives_the_plain_sums() {
    for (degree, quadrature) in CASES {
        let tables = tables_of(degree, quadrature);
        let (energy, residual, stiffness) = plain_sums(&tables);
        for build in [Build::Portable, Build::detect()] {
            let found = integrated(&tables, Want::Stiffness, build);
            let (found_residual, found_stiffness) = numbers(&tables, &found);
            let name = build.name();
            assert!((found.energy / energy - 1.0).abs() < 1e-12, "{degree:?} {name}: {} {energy}", found.energy);
            assert!(difference(&residual, &found_residual) < 1e-12, "residual, {degree:?} {name}");
            assert!(difference(&stiffness, &found_stiffness) < 1e-12, "stiffness, {degree:?} {name}");
        }
    }
}

#[test]
fn less_wanted_is_the_same_to_the_last_bit() {
    for (degree, quadrature) in CASES {
        let tables = tables_of(degree, quadrature);
        for build in [Build::Portable, Build::detect()] {
            let all = integrated(&tables, Want::Stiffness, build);
            let residual = integrated(&tables, Want::Residual, build);
            let energy = integrated(&tables, Want::Energy, build);
            assert_eq!([all.energy.to_bits(); 2], [residual.energy.to_bits(), energy.energy.to_bits()]);
            assert_eq!(all.residual, residual.residual);
        }
    }
}

/// Eight lanes on any processor, with one rounding: what AVX-512 does, where there is none.
#[derive(Clone, Copy)]
struct Eight([f64; 8]);

impl Lanes for Eight {
    type Proof = ();
    type Array = [f64; 8];
    const WIDTH: usize = 8;

    fn splat((): (), value: f64) -> Self {
        Self([value; 8])
    }

    fn load((): (), from: &[f64; 8]) -> Self {
        Self(*from)
    }

    fn store(self, to: &mut [f64; 8]) {
        *to = self.0;
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].mul_add(b.0[i], c.0[i])))
    }

    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    fn chunks(slice: &[f64]) -> &[[f64; 8]] {
        slice.as_chunks().0
    }

    fn chunks_mut(slice: &mut [f64]) -> &mut [[f64; 8]] {
        slice.as_chunks_mut().0
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $operator:tt) => {
        impl $trait for Eight {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                Self(std::array::from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

/// Rows in vectors of eight, by AVX-512 where the processor has it, and by [`Eight`], against those of four.
#[cfg(target_arch = "x86_64")]
#[test]
fn the_width_of_the_vectors_changes_no_bit() {
    let Some(fma) = HasFma::detect() else { return };
    for (degree, quadrature) in CASES {
        let tables = tables_of(degree, quadrature);
        let narrow = numbers(&tables, &integrated(&tables, Want::Stiffness, Build::Fma(fma)));
        let mut buffers = prepared(&tables);
        integrate::<Fma, Eight>(fma, (), &ElementPoints::of(&tables, ELEMENT), Want::Stiffness, &mut buffers);
        assert!(numbers(&tables, &buffers) == narrow, "{degree:?}");
        if let Some(avx512) = HasAvx512::detect() {
            let wide = integrated(&tables, Want::Stiffness, Build::Avx512(avx512));
            assert!(numbers(&tables, &wide) == narrow, "{degree:?}");
        }
    }
}
