//! Every term of a model by itself: forces are derivatives of its energy, its tangent of its forces; and all together they are what
//! a solve sees.

use std::sync::Arc;

use foldline::energy::{At, Discretization, Tangent, Term, Want};
use foldline::equilibrium::Assembled;
use foldline::model::starting_mesh;

use foldline::scene::parse;

const SCENE: &str = "[geometry]\nkind = \"cylinder-panel\"\nlength_mm = 10.0\nradius_mm = 8.0\narc_deg = 60.0\n\
     [material]\nkind = \"isotropic\"\nyoungs_modulus_mpa = 70e3\npoissons_ratio = 0.3\nthickness_mm = 0.4\n\
     thermal_expansion_per_k = 23e-6\n[mesh]\nelements = [3, 4]\n[load]\nkind = \"steps\"\nincrement = 1.0\n\
     [[support]]\non = \"u-start\"\nkind = \"clamped\"\n\
     [[action]]\nkind = \"temperature\"\nchange_k = -500.0\n\
     [[action]]\nkind = \"force\"\non = [1.0, 0.5]\nforce_n = [1.0, 2.0, 3.0]\n\
     [[action]]\nkind = \"pressure\"\npressure_mpa = 0.5\nfollower = true\n";

const PARAMETER: f64 = 0.7;

type Field = Vec<[f64; 3]>;

fn product(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

fn field(count: usize, seed: f64) -> Field {
    let value = |i: usize| 0.1 * (((i + 1) as f64 * seed).fract() - 0.5);
    (0..count).map(|i| [0, 1, 2].map(|c| value(3 * i + c))).collect()
}

fn forces_of(term: &dyn Term, at: At) -> Field {
    let mut forces = vec![[0.0; 3]; at.displacement.len()];
    term.add_forces(at, &mut forces);
    forces
}

#[test]
fn each_is_consistent_in_itself() {
    let discretization = discretization();
    let mesh = &*discretization.mesh;
    let count = mesh.point_count();
    let (shape, direction) = (field(count, 0.618_033_988_75), field(count, 0.732_050_807_57));
    let moved = |step: f64| -> Field {
        shape.iter().zip(&direction).map(|(u, d)| [0, 1, 2].map(|c| u[c] + step * d[c])).collect()
    };
    let step = 1e-5;
    let slope = |plus: f64, minus: f64| (plus - minus) / (2.0 * step);
    let (mut stored, mut tangents) = (0, 0);
    for term in discretization.all_terms() {
        let at = |displacement| At { mesh, displacement, parameter: PARAMETER };
        let [plus, here, minus] = [step, 0.0, -step].map(&moved);
        let exact = -product(&forces_of(term, at(&here)), &direction);
        if term.factors(PARAMETER).is_empty() {
            let found = slope(term.energy(at(&plus)), term.energy(at(&minus)));
            assert!((found / exact - 1.0).abs() < 1e-6, "{term:?}: {found} {exact}");
            stored += 1;
        }
        // Where the shell does not move: forces by the parameter, and what that puts in.
        let later = |parameter: f64| At { parameter, ..at(&here) };
        let mut rates = vec![[0.0; 3]; count];
        term.add_rates(at(&here), &mut rates);
        let (ahead, behind) = (forces_of(term, later(PARAMETER + step)), forces_of(term, later(PARAMETER - step)));
        let off = rates
            .iter()
            .zip(ahead.iter().zip(&behind))
            .flat_map(|(rate, (ahead, behind))| [0, 1, 2].map(|c| (slope(ahead[c], behind[c]) - rate[c]).abs()));
        let size = rates.as_flattened().iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        assert!(size > 0.0 && off.fold(0.0, f64::max) < 1e-6 * size, "{term:?}");
        let put_in = term.put_in(at(&here), 0.9);
        assert!(
            (put_in - (term.energy(later(0.9)) - term.energy(at(&here)))).abs() <= 1e-12 * put_in.abs(),
            "{term:?}"
        );
        if term.has_tangent() {
            let change: Field = forces_of(term, at(&plus))
                .iter()
                .zip(forces_of(term, at(&minus)))
                .map(|(plus, minus)| [0, 1, 2].map(|c| -slope(plus[c], minus[c])))
                .collect();
            let [symmetric, skew] = Tangent::of(term, at(&here), &discretization.blocks);
            let mut stiff = symmetric.multiply(&discretization.blocks, 1.0, &direction);
            if term.has_skew() {
                let skew = skew.multiply(&discretization.blocks, -1.0, &direction);
                stiff.iter_mut().zip(skew).for_each(|(sum, more)| (0..3).for_each(|c| sum[c] += more[c]));
            }
            let off: Field = stiff.iter().zip(&change).map(|(a, b)| [0, 1, 2].map(|c| a[c] - b[c])).collect();
            let (off, size) = (product(&off, &off).sqrt(), product(&stiff, &stiff).sqrt());
            assert!(off < 1e-6 * size, "{term:?}: {off} {size}");
            tangents += 1;
        }
    }
    assert_eq!((stored, tangents), (1, 2), "the shell stores energy; it and the pressure depend on the displacement");
}

/// The shell gives energy, forces and stiffness at once; they are those that it gives one by one, to the last bit.
#[test]
fn together_they_are_what_a_solve_sees() {
    let discretization = discretization();
    let shape = field(discretization.mesh.point_count(), 0.618_033_988_75);
    let at = At { mesh: &discretization.mesh, displacement: &shape, parameter: PARAMETER };
    let mut assembled = Assembled::new(&discretization);
    assembled.assemble(&discretization, &shape, PARAMETER, Want::Stiffness);
    let energy: f64 = discretization.all_terms().map(|term| term.energy(at)).sum();
    assert_eq!(energy, assembled.energy);
    let shell = &discretization.shells[0];
    assert!(assembled.residual.iter().zip(forces_of(shell, at)).all(|(g, f)| *g == f.map(|f| -f)));
    let loads = discretization.terms.iter().flat_map(|term| forces_of(term, at).into_iter().enumerate());
    let mut external = assembled.external.clone();
    loads.for_each(|(point, force)| (0..3).for_each(|c| external[point][c] -= force[c]));
    let size = product(&assembled.external, &assembled.external).sqrt();
    assert!(product(&external, &external).sqrt() < 1e-14 * size);
    let mut sum = Tangent::of(shell, at, &discretization.blocks)[0].values.clone();
    for term in discretization.terms.iter().filter(|term| term.has_tangent()) {
        let [symmetric, _] = Tangent::of(term, at, &discretization.blocks);
        sum.iter_mut().zip(&symmetric.values).for_each(|(sum, value)| *sum += value);
    }
    let largest = sum.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let off = sum.iter().zip(&assembled.stiffness.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= 1e-14 * largest, "{off} of {largest}");
}

fn discretization() -> Discretization {
    let scene = parse(SCENE, "terms.toml").unwrap();
    let mesh = Arc::new(starting_mesh(&scene).unwrap());
    Discretization::new(&scene, &mesh).unwrap()
}
