use super::*;
use crate::equilibrium::sparse::fronts::Fronts;

/// Unknowns one by one, each of which meets those up to `width(unknown)` before it.
fn banded(unknowns: usize, width: impl Fn(usize) -> usize) -> Couplings {
    let groups = (0..unknowns).map(|unknown| vec![unknown]).collect();
    let before = |row: usize| (row - width(row).min(row)..row).map(move |column| [column, row]);
    Couplings { unknowns, groups, pairs: (0..unknowns).flat_map(before).collect() }
}

/// Every storage of one structure, whatever is chosen for it, and the strips in every build that this machine runs.
fn each(couplings: &Couplings) -> Vec<SparseSolver> {
    let strips = |build| SparseSolver::Strips(StripSolver::structure(couplings, build).with_room().unwrap());
    let supernodes = SupernodalSolver::structure(couplings).with_room().unwrap();
    vec![strips(Build::detect()), strips(Build::Portable), SparseSolver::Supernodal(supernodes)]
}

/// A number in −1..1 that two unknowns share.
fn noise(a: usize, b: usize) -> f64 {
    let seed = (a.min(b) * 7919 + a.max(b) * 104_729) % 10_007;
    seed as f64 / 5003.5 - 1.0
}

/// Fills in `diagonal` on the diagonal and noise off it; returns the numbers.
fn fill(solver: &mut SparseSolver, couplings: &Couplings, diagonal: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut terms: Vec<_> = (0..couplings.unknowns).map(|i| (i, i, diagonal(i))).collect();
    for [i, j] in couplings.meetings() {
        let pairs = couplings.groups[i].iter().flat_map(|a| couplings.groups[j].iter().map(move |b| (*a, *b)));
        terms.extend(pairs.filter(|(a, b)| if i == j { a < b } else { a != b }).map(|(a, b)| (a, b, noise(a, b))));
    }
    solver.matrix_mut().fill(0.0);
    solver.add(&terms);
    solver.matrix_mut().to_vec()
}

#[test]
fn strips_and_supernodes_agree() {
    // Shorter than a strip, without a cut, with one, with rows that reach far back at either end, and without unknowns.
    let structures = [
        banded(0, |_| 0),
        banded(1, |_| 0),
        banded(7, |_| 3),
        banded(12, |_| 12),
        banded(100, |_| 60),
        banded(500, |_| 20),
        banded(611, |row| 3 + row * 37 % 29),
        banded(700, |row| if row > 690 { 80 } else { 11 }),
        banded(700, |row| if row < 90 { 90 } else { 11 }),
    ];
    for couplings in structures {
        let count = couplings.unknowns;
        for indefinite in [false, true] {
            let diagonal = |i: usize| if indefinite && i % 5 == 2 { -40.0 } else { 40.0 };
            let mut answers = Vec::new();
            for mut solver in each(&couplings) {
                let values = fill(&mut solver, &couplings, diagonal);
                let exact: Vec<f64> = (0..count).map(|i| noise(i, 3)).collect();
                let mut x = solver.multiply(&values, &exact);
                let negative = solver.factorize().unwrap();
                solver.solve(&mut x);
                for (x, exact) in x.iter().zip(&exact) {
                    assert!((x - exact).abs() < 1e-11, "{count}: {x} {exact}");
                }
                answers.push((negative.count, solver.multiply(&values, &exact)));
            }
            for pair in answers.windows(2) {
                let [one, other] = pair else { unreachable!() };
                assert_eq!(one.0, other.0, "{count} unknowns");
                for (a, b) in one.1.iter().zip(&other.1) {
                    assert!((a - b).abs() < 1e-10, "{count}: {a} {b}");
                }
            }
        }
    }
}

/// A matrix of one block for each four unknowns, in which the sign of D is known: [[2, 1], [1, −3]] has pivots 2 and −3.5, and
/// L |D| Lᵀ is [[2, 1], [1, 4]]. In whatever order blocks are taken, the first of a pair meets nothing else.
#[test]
fn negative_pivots_turn_positive() {
    let count = 400;
    let couplings = banded(count, |row| row % 2);
    for mut solver in each(&couplings) {
        solver.add(&(0..count).map(|i| (i, i, if i % 2 == 0 { 2.0 } else { -3.0 })).collect::<Vec<_>>());
        solver.add(&(1..count).step_by(2).map(|i| (i, i - 1, 1.0)).collect::<Vec<_>>());
        let negative = solver.factorize().unwrap();
        assert_eq!(negative.count, count / 2);
        solver.make_positive();
        let mut x: Vec<f64> = (0..count).map(|i| noise(i, 1)).collect();
        let b = x.clone();
        solver.solve(&mut x);
        for pair in 0..count / 2 {
            let (i, j) = (2 * pair, 2 * pair + 1);
            // The pair is eliminated from either side: the second one first has pivots −3 and 7/3, and |D| gives
            // [[8/3, −1], [−1, 3]].
            let forward = [2.0 * x[i] + x[j] - b[i], x[i] + 4.0 * x[j] - b[j]];
            let backward = [8.0 / 3.0 * x[i] - x[j] - b[i], -x[i] + 3.0 * x[j] - b[j]];
            let solves = |residual: [f64; 2]| residual.iter().all(|r| r.abs() < 1e-12);
            assert!(solves(forward) || solves(backward), "pair {pair}: {forward:?} {backward:?}");
        }
    }
}

/// A band with as many negative eigenvalues as it likes: xᵀ (L |D| Lᵀ)⁻¹ x is positive for every x, and xᵀ A⁻¹ x is not.
#[test]
fn an_indefinite_band_turns_positive() {
    let couplings = banded(500, |row| 5 + row % 9);
    for mut solver in each(&couplings) {
        fill(&mut solver, &couplings, |i| if i % 3 == 0 { -30.0 } else { 30.0 });
        assert!(solver.factorize().unwrap().count > 100);
        let forms = |solver: &SparseSolver| -> Vec<f64> {
            (0..20)
                .map(|seed| {
                    let x: Vec<f64> = (0..500).map(|i| noise(i, seed) * f64::from(u8::from(i % 20 == seed))).collect();
                    let mut solved = x.clone();
                    solver.solve(&mut solved);
                    x.iter().zip(&solved).map(|(a, b)| a * b).sum()
                })
                .collect()
        };
        assert!(forms(&solver).iter().any(|form| *form < 0.0));
        solver.make_positive();
        assert!(forms(&solver).iter().all(|form| *form > 0.0));
    }
}

#[test]
fn counts_negative_eigenvalues() {
    // Eigenvalues of the tridiagonal matrix: d − 2 cos(k π / (n + 1)).
    let size = 400;
    let couplings = banded(size, |_| 1);
    // (1.0 would meet an exactly zero pivot, which the factorization does not survive: it does not pivot.)
    for shift in [2.5, 1.01, 0.3, -0.7] {
        let eigenvalue = |k: usize| shift - 2.0 * (k as f64 * std::f64::consts::PI / (size + 1) as f64).cos();
        let negative = (1..=size).filter(|k| eigenvalue(*k) < 0.0).count();
        for mut solver in each(&couplings) {
            solver.add(&(0..size).map(|i| (i, i, shift)).collect::<Vec<_>>());
            solver.add(&(1..size).map(|i| (i, i - 1, -1.0)).collect::<Vec<_>>());
            assert_eq!(solver.factorize().unwrap().count, negative, "shift {shift}");
        }
    }
}

#[test]
fn a_pivot_that_is_zero_is_named() {
    for zero in [3, 140, 299] {
        let couplings = banded(300, |_| 0);
        for mut solver in each(&couplings) {
            solver.add(&(0..300).map(|i| (i, i, f64::from(u8::from(i != zero)))).collect::<Vec<_>>());
            assert_eq!(solver.factorize(), Err(FactorError::BadPivot { index: zero, size: 300 }));
        }
    }
}

/// A long band is cut near its middle, a short and wide one not, and one that is wide at its front in the rest.
#[test]
fn the_cut_follows_the_band() {
    let cut = |couplings: &Couplings| StripSolver::structure(couplings, Build::Portable).cut();
    let middle = cut(&banded(4000, |_| 100));
    assert!(middle.start > 1900 && middle.end < 2100 && middle.len() == 100, "{middle:?}");
    assert_eq!(cut(&banded(400, |_| 300)), 400..400, "none");
    let wide_front = cut(&banded(4000, |row| if row < 1000 { 300 } else { 50 }));
    assert!(wide_front.start < 1000, "{wide_front:?}");
    for couplings in [banded(4000, |_| 100), banded(4000, |row| if row < 1000 { 300 } else { 50 })] {
        let solver = StripSolver::structure(&couplings, Build::Portable);
        assert_eq!(solver.most_threads(), 2);
        // The bound is near the sum of the squares of the column counts in the order of the unknowns.
        let mut last: Vec<usize> = (0..4000).collect();
        couplings.pairs.iter().for_each(|[column, row]| last[*column] = last[*column].max(*row));
        let exact: f64 = last.iter().enumerate().map(|(column, last)| ((last + 1 - column) as f64).powi(2)).sum();
        assert!(solver.flops() < 1.6 * exact && solver.flops() > 0.5 * exact, "{} {exact}", solver.flops());
    }
}

/// What is long and narrow goes to the strips, also where fronts are tried; what would fill its envelope goes to fronts.
#[test]
fn the_structure_decides() {
    let narrow = banded(4000, |_| 600);
    let scattered = banded(6000, |row| if row % 10 == 0 { row } else { 3 });
    let flops = |couplings: &Couplings| StripSolver::structure(couplings, Build::Portable).flops();
    assert!(flops(&narrow) > WORTH_ASKING_FLOPS && flops(&scattered) > WORTH_ASKING_FLOPS, "fronts are tried");
    assert!(matches!(SparseSolver::new(&narrow).unwrap(), SparseSolver::Strips(_)));
    assert!(matches!(SparseSolver::new(&scattered).unwrap(), SparseSolver::Supernodal(_)));
}

/// Patches of control points, each of which has three unknowns and meets its neighbours up to three away; the patches are
/// bonded on their first columns.
fn patches(patches: usize, [rows, columns]: [usize; 2], bonded: usize) -> Couplings {
    let point = |patch: usize, i: usize, j: usize| (patch * rows + i) * columns + j;
    let mut pairs = Vec::new();
    for (one, two) in (0..patches).flat_map(|one| (one..patches).map(move |two| (one, two))) {
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            for (k, l) in (i.saturating_sub(3)..rows.min(i + 4)).flat_map(|k| (0..columns).map(move |l| (k, l))) {
                let pair = [point(one, i, j), point(two, k, l)];
                if j.abs_diff(l) <= 3 && (one == two || j.max(l) < bonded) && pair[0] < pair[1] {
                    pairs.push(pair);
                }
            }
        }
    }
    let count = patches * rows * columns;
    let groups = (0..count).map(|point| (3 * point..3 * point + 3).collect()).collect();
    Couplings { unknowns: 3 * count, groups, pairs }
}

/// Groups of none to four unknowns, some of which belong to two, that meet at random; and unknowns that meet nothing.
fn random(groups: usize, meetings: usize) -> Couplings {
    let mut seed = (groups * 31 + meetings) as u64;
    let mut below = |count: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % count
    };
    let mut couplings = Couplings { unknowns: 3, ..Couplings::default() };
    for _ in 0..groups {
        let own = below(5);
        let mut group: Vec<usize> = (couplings.unknowns..couplings.unknowns + own).collect();
        if below(7) == 0 && couplings.unknowns > 3 {
            group.push(3 + below(couplings.unknowns - 3));
        }
        couplings.unknowns += own;
        couplings.groups.push(group);
    }
    couplings.pairs = (0..meetings).map(|_| [below(groups), below(groups)]).collect();
    couplings
}

/// Structures that dissection takes apart: in one piece and in several, with hubs, and those that have no separator.
fn structures() -> Vec<Couplings> {
    let mut several = random(40, 60);
    several.pairs.retain(|[i, j]| i % 3 == j % 3);
    vec![
        random(60, 90),
        random(150, 220),
        random(150, 3000),
        several,
        patches(1, [13, 9], 0),
        patches(2, [17, 9], 3),
        patches(3, [8, 8], 2),
        banded(400, |row| if row % 40 == 0 { row } else { 3 }),
    ]
}

/// A dense solution and the number of negative pivots, in the order of the unknowns.
fn dense(solver: &SparseSolver, values: &[f64], mut x: Vec<f64>) -> (Vec<f64>, usize) {
    let size = x.len();
    let unit = |i: usize| (0..size).map(|k| f64::from(u8::from(k == i))).collect::<Vec<_>>();
    let mut rows: Vec<Vec<f64>> = (0..size).map(|i| solver.multiply(values, &unit(i))).collect();
    let mut negative = 0;
    for k in 0..size {
        negative += usize::from(rows[k][k] < 0.0);
        let (pivot, rhs) = (rows[k].clone(), x[k]);
        for i in k + 1..size {
            let ratio = rows[i][k] / pivot[k];
            (k..size).for_each(|j| rows[i][j] -= ratio * pivot[j]);
            x[i] -= ratio * rhs;
        }
    }
    for k in (0..size).rev() {
        let sum: f64 = (k + 1..size).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (x[k] - sum) / rows[k][k];
    }
    (x, negative)
}

#[test]
fn fronts_solve_as_a_dense_matrix_does() {
    for (k, couplings) in structures().iter().enumerate() {
        let mut solver = SparseSolver::supernodal(couplings).unwrap();
        let size = couplings.unknowns;
        let values = fill(&mut solver, couplings, |i| if i % 5 == 2 { -150.0 } else { 150.0 });
        let right: Vec<f64> = (0..size).map(|i| noise(i, 4)).collect();
        let (expected, negative) = dense(&solver, &values, right.clone());
        assert_eq!(solver.factorize().unwrap().count, negative, "structure {k}");
        let mut x = right;
        solver.solve(&mut x);
        for (x, expected) in x.iter().zip(&expected) {
            assert!((x - expected).abs() < 1e-12, "structure {k}: {x} {expected}");
        }
    }
}

#[test]
fn every_unknown_has_one_place_and_every_row_lies_in_the_front_above() {
    for couplings in structures() {
        let fronts = Fronts::new(&couplings);
        let mut sorted = fronts.order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..couplings.unknowns as u32), "a permutation");
        assert!((0..couplings.unknowns).all(|unknown| fronts.order[fronts.places[unknown] as usize] == unknown as u32));
        for above in &fronts.fronts {
            let places: Vec<u32> = (above.begin as u32..).take(above.width).chain(above.rows.iter().copied()).collect();
            for below in above.below.iter().map(|below| &fronts.fronts[*below]) {
                let found = below.runs.iter().flat_map(|run| &places[run.to as usize..(run.to + run.length) as usize]);
                assert!(found.eq(&below.rows));
            }
        }
        assert!(fronts.tops.iter().all(|top| fronts.fronts[*top].rows.is_empty()));
    }
}

/// On a square patch of n control points: nested dissection takes some n^1.5 operations, where a band takes n².
#[test]
fn operations_grow_as_of_nested_dissection() {
    let flops = |side: usize| SupernodalSolver::structure(&patches(1, [side, side], 0)).flops();
    let (small, large) = (flops(30), flops(60));
    assert!(large < 11.0 * small, "{small:e} {large:e}");
    let strips = StripSolver::structure(&patches(1, [60, 60], 0), Build::Portable).flops();
    assert!(1.4 * large < strips, "{large:e} {strips:e}");
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let couplings = banded(900, |row| 10 + row % 17);
    same_bits(&couplings);
    // Subtrees and large fronts on threads of their own.
    let patch = patches(1, [40, 40], 0);
    assert!(Fronts::new(&patch).fronts.iter().any(|front| front.shared));
    same_bits(&patch);
    assert_eq!(StripSolver::structure(&couplings, Build::detect()).most_threads(), 2);
}

fn same_bits(couplings: &Couplings) {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let solve = |mut solver: SparseSolver| {
            fill(&mut solver, couplings, |i| 150.0 - (i % 3) as f64);
            solver.factorize().unwrap();
            let mut x: Vec<f64> = (0..couplings.unknowns).map(|i| noise(i, 2)).collect();
            solver.solve(&mut x);
            x
        };
        pool.install(|| each(couplings).into_iter().map(solve).collect::<Vec<_>>())
    };
    assert_eq!(run(1), run(2));
}
