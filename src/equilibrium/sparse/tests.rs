use super::*;

/// Unknowns one by one, each of which meets those up to `width(unknown)` before it.
fn banded(unknowns: usize, width: impl Fn(usize) -> usize) -> Couplings {
    let groups = (0..unknowns).map(|unknown| vec![unknown]).collect();
    let before = |row: usize| (row - width(row).min(row)..row).map(move |column| [column, row]);
    Couplings { unknowns, groups, pairs: (0..unknowns).flat_map(before).collect() }
}

/// Both storages of one structure, whatever is chosen for it.
fn both(couplings: &Couplings) -> [SparseSolver; 2] {
    let strips = StripSolver::structure(couplings).with_room().unwrap();
    [SparseSolver::Strips(strips), SparseSolver::Supernodal(SupernodalSolver::new(couplings).unwrap())]
}

/// A number in −1..1 that two unknowns share.
fn noise(a: usize, b: usize) -> f64 {
    let seed = (a.min(b) * 7919 + a.max(b) * 104_729) % 10_007;
    seed as f64 / 5003.5 - 1.0
}

/// Fills in `diagonal` on the diagonal and noise off it; returns the numbers.
fn fill(solver: &mut SparseSolver, couplings: &Couplings, diagonal: impl Fn(usize) -> f64) -> Vec<f64> {
    let pairs: Vec<_> = couplings.pairs.iter().map(|[a, b]| (*a, *b, noise(*a, *b))).collect();
    solver.matrix_mut().fill(0.0);
    solver.add(&pairs);
    solver.add(&(0..couplings.unknowns).map(|i| (i, i, diagonal(i))).collect::<Vec<_>>());
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
            for mut solver in both(&couplings) {
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
            let [one, other] = &answers[..] else { unreachable!() };
            assert_eq!(one.0, other.0, "{count} unknowns");
            for (a, b) in one.1.iter().zip(&other.1) {
                assert!((a - b).abs() < 1e-12 * 100.0, "{count}: {a} {b}");
            }
        }
    }
}

/// With |D| for D the matrix is L |D| Lᵀ: solving with it and then with L D Lᵀ twice gives what D alone decides.
#[test]
fn pivots_turn_positive_alike() {
    let couplings = banded(400, |_| 15);
    let mut solutions = Vec::new();
    for mut solver in both(&couplings) {
        // A negative pivot comes last in any order where its unknown meets the whole of the matrix only through others.
        fill(&mut solver, &couplings, |_| 30.0);
        solver.factorize().unwrap();
        let mut positive: Vec<f64> = (0..400).map(|i| noise(i, 1)).collect();
        let mut again = positive.clone();
        solver.solve(&mut positive);
        solver.make_positive();
        solver.solve(&mut again);
        assert_eq!(positive, again, "a positive matrix stays what it is");
        fill(&mut solver, &couplings, |_| 30.0);
        solver.matrix_mut().iter_mut().for_each(|value| *value = -*value);
        assert_eq!(solver.factorize().unwrap().count, 400);
        solver.make_positive();
        let mut turned: Vec<f64> = (0..400).map(|i| noise(i, 1)).collect();
        solver.solve(&mut turned);
        for (a, b) in turned.iter().zip(&positive) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
        solutions.push(turned);
    }
    assert_eq!(solutions.len(), 2);
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
        for mut solver in both(&couplings) {
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
        for mut solver in both(&couplings) {
            solver.add(&(0..300).map(|i| (i, i, f64::from(u8::from(i != zero)))).collect::<Vec<_>>());
            assert_eq!(solver.factorize(), Err(FactorError::BadPivot { index: zero, size: 300 }));
        }
    }
}

/// A long band is cut and a square one not; what would fill the envelope goes to faer.
#[test]
fn the_structure_decides() {
    let narrow = SparseSolver::new(&banded(4000, |_| 100)).unwrap();
    assert!(matches!(narrow, SparseSolver::Strips(_)));
    let bottom = |row: usize| if row > 3980 { row } else { 40 };
    let wide = SparseSolver::new(&banded(4000, bottom)).unwrap();
    assert!(matches!(wide, SparseSolver::Strips(_)), "few long rows at the end fill nothing else");
    let top = |row: usize| if row % 10 == 0 { row } else { 3 };
    let scattered = SparseSolver::new(&banded(4000, top)).unwrap();
    assert!(matches!(scattered, SparseSolver::Supernodal(_)));
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let couplings = banded(900, |row| 10 + row % 17);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut solver = SparseSolver::new(&couplings).unwrap();
            fill(&mut solver, &couplings, |i| 20.0 - (i % 3) as f64);
            solver.factorize().unwrap();
            let mut x: Vec<f64> = (0..900).map(|i| noise(i, 2)).collect();
            solver.solve(&mut x);
            x
        })
    };
    assert_eq!(run(1), run(2));
}
