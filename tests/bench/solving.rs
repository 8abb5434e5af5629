//! Factorization and solution at size: `cargo bench --bench solving [-- CASE...]`.
//!
//! Structures of stiffness matrices of cubic elements: each control point has three unknowns and meets its 7 × 7
//! neighbours. Prints, for the storage that is chosen and for the other one where it is small enough, the numbers in the factor and the
//! operations; and the seconds (median of five) for the analysis and, on one thread and on two, for factor and solution.

use std::time::Instant;

use foldline::equilibrium::{Couplings, SparseSolver};

/// Patches of elements, and the control points of a row that the patches share a bond on.
struct Case {
    name: &'static str,
    elements: [usize; 2],
    patches: usize,
    bonded: usize,
}

const CASES: [Case; 5] = [
    Case { name: "128x16", elements: [128, 16], patches: 1, bonded: 0 },
    Case { name: "128x64", elements: [128, 64], patches: 1, bonded: 0 },
    Case { name: "256x128", elements: [256, 128], patches: 1, bonded: 0 },
    Case { name: "256x256", elements: [256, 256], patches: 1, bonded: 0 },
    // A TRAC boom: two flanges, bonded over a third of their width.
    Case { name: "boom", elements: [90, 24], patches: 2, bonded: 9 },
];

/// Number of control points that a cubic basis function reaches to either side.
const REACH: usize = 3;
const REPETITIONS: usize = 5;

impl Case {
    fn couplings(&self) -> Couplings {
        let [rows, columns] = self.elements.map(|count| count + REACH);
        let point = |patch: usize, [i, j]: [usize; 2]| (patch * rows + i) * columns + j;
        let near = |k: usize, count: usize| k.saturating_sub(REACH)..(k + REACH + 1).min(count);
        let mut pairs = Vec::new();
        for [i, j] in (0..rows).flat_map(|i| (0..columns).map(move |j| [i, j])) {
            for other in near(i, rows).flat_map(|k| near(j, columns).map(move |l| [k, l])) {
                for (one, two) in (0..self.patches).flat_map(|one| (one..self.patches).map(move |two| (one, two))) {
                    let meet = one == two || (j < self.bonded && other[1] < self.bonded);
                    let pair = [point(one, [i, j]), point(two, other)];
                    if meet && pair[0] < pair[1] {
                        pairs.push(pair);
                    }
                }
            }
        }
        let count = self.patches * rows * columns;
        let groups = (0..count).map(|point| vec![3 * point, 3 * point + 1, 3 * point + 2]).collect();
        Couplings { unknowns: 3 * count, groups, pairs }
    }
}

/// Entries of an indefinite matrix that needs no pivoting.
fn entries(couplings: &Couplings) -> Vec<(usize, usize, f64)> {
    let value = |a: usize, b: usize| match a == b {
        true if a % 5 == 2 => -200.0,
        true => 200.0,
        false => ((a.min(b) * 7919 + a.max(b) * 104_729) % 10_007) as f64 / 5003.5 - 1.0,
    };
    let own = couplings.groups.iter().flat_map(|group| {
        group.iter().flat_map(move |a| group.iter().filter(move |b| *b <= a).map(move |b| (*a, *b, value(*a, *b))))
    });
    let pairs = couplings.pairs.iter().flat_map(|[i, j]| {
        let others = &couplings.groups[*j];
        couplings.groups[*i].iter().flat_map(move |a| others.iter().map(move |b| (*a, *b, value(*a, *b))))
    });
    own.chain(pairs).collect()
}

/// Median of the seconds that something takes.
fn seconds(mut run: impl FnMut()) -> f64 {
    let one = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    let mut times: Vec<f64> = (0..REPETITIONS).map(one).collect();
    times.sort_by(f64::total_cmp);
    times[REPETITIONS / 2]
}

fn measure(name: &str, couplings: &Couplings, make: fn(&Couplings) -> SparseSolver) {
    let start = Instant::now();
    let mut solver = make(couplings);
    let analysis = start.elapsed().as_secs_f64();
    let kind = if matches!(solver, SparseSolver::Strips(_)) { "strips" } else { "fronts" };
    let entries = entries(couplings);
    solver.matrix_mut().fill(0.0);
    solver.add(&entries);
    let values = solver.matrix_mut().to_vec();
    print!(
        "{name:8} {kind} {:7} unknowns {:6.1} million in the factor {:7.2e} operations, analysis {analysis:.2} s",
        couplings.unknowns,
        solver.factor_len() as f64 * 1e-6,
        solver.flops(),
    );
    for threads in [1, 2] {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
        let filled = seconds(|| solver.matrix_mut()[..values.len()].copy_from_slice(&values));
        let mut negative = 0;
        let factor = seconds(|| {
            solver.matrix_mut()[..values.len()].copy_from_slice(&values);
            negative = pool.install(|| solver.factorize()).map_or(usize::MAX, |pivots| pivots.count);
        });
        let mut x = vec![1.0; couplings.unknowns];
        let solution = seconds(|| pool.install(|| solver.solve(&mut x)));
        let factor = factor - filled;
        print!("; {threads} threads: factor {factor:.3} s ({negative} negative), solution {solution:.3} s");
    }
    println!();
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    for case in CASES.iter().filter(|case| asked.is_empty() || asked.iter().any(|name| name == case.name)) {
        let couplings = case.couplings();
        let supernodal = |couplings: &Couplings| SparseSolver::supernodal(couplings).expect("there is memory");
        measure(case.name, &couplings, supernodal);
        let chosen = |couplings: &Couplings| SparseSolver::new(couplings).expect("there is memory");
        if matches!(chosen(&couplings), SparseSolver::Strips(_)) {
            measure(case.name, &couplings, chosen);
        }
    }
}
