//! An energy of one's own: an elastic foundation, ½ k w² on every mm² of the undeformed shell.

use foldline::energy::{At, Tangent, Term, TermSource};
use foldline::model::{ModelError, Tables};
use foldline::scene::Scene;
use foldline::shell::gauss_legendre;
use foldline::spline::{Mesh, Spans, evaluate_surface, mid_surface_point};
use foldline::state::Hash;

/// Of stiffness k, N/mm³, under a plate in the plane z = 0.
#[derive(Clone, Copy, Debug)]
pub struct Foundation(pub f64);

impl TermSource for Foundation {
    fn name(&self) -> &str {
        "elastic foundation"
    }

    fn hash(&self) -> Hash {
        blake3::hash(&self.0.to_le_bytes())
    }

    fn on(&self, scene: &Scene, mesh: &Mesh, tables: &[Tables]) -> Result<Box<dyn Term>, ModelError> {
        self.below(scene, mesh, tables, [1.0; 2])
    }

    fn below(&self, _: &Scene, mesh: &Mesh, _: &[Tables], limits: [f64; 2]) -> Result<Box<dyn Term>, ModelError> {
        let patch = mesh.lone();
        let [along, across] = [0, 1].map(|way| {
            let spans = Spans::of(&patch.knots[way], patch.degree[way]).bounds.into_iter();
            let spans = spans.map(|[from, to]| [from, to.min(limits[way])]).filter(|[from, to]| from < to);
            let rule = gauss_legendre(patch.degree[way] + 1);
            let in_span = |[from, to]: [f64; 2]| rule.clone().into_iter().map(move |[x, w]| [from, to, x, w]);
            let point = |[from, to, x, w]: [f64; 4]| (0.5 * (from + to + (to - from) * x), 0.5 * (to - from) * w);
            spans.flat_map(in_span).map(point).collect::<Vec<_>>()
        });
        let pairs = along.iter().flat_map(|one| across.iter().map(move |other| (one, other)));
        let spring = |((u, one), (v, other)): (&(f64, f64), &(f64, f64))| {
            let (first, [values, ..]) = evaluate_surface(patch, [*u, *v]);
            let [a1, a2, ..] = mid_surface_point(patch, &[], [*u, *v]).derivatives;
            let shares = patch.window(first).zip(values).collect();
            Spring { shares, stiffness: self.0 * one * other * (a1[0] * a2[1] - a1[1] * a2[0]) }
        };
        Ok(Box::new(Bed(pairs.map(spring).collect())))
    }
}

/// The foundation on a mesh.
#[derive(Debug)]
struct Bed(Vec<Spring>);

#[derive(Debug)]
struct Spring {
    /// Control points with their functions.
    shares: Vec<(usize, f64)>,
    /// N/mm.
    stiffness: f64,
}

impl Spring {
    fn deflection(&self, at: At) -> f64 {
        self.shares.iter().map(|(point, share)| share * at.displacement[*point][2]).sum()
    }
}

impl Term for Bed {
    fn energy(&self, at: At) -> f64 {
        self.0.iter().map(|spring| 0.5 * spring.stiffness * spring.deflection(at).powi(2)).sum()
    }

    fn add_forces(&self, at: At, forces: &mut [[f64; 3]]) {
        for spring in &self.0 {
            let force = spring.stiffness * spring.deflection(at);
            spring.shares.iter().for_each(|(point, share)| forces[*point][2] -= share * force);
        }
    }

    fn has_tangent(&self) -> bool {
        true
    }

    fn add_tangent(&self, _: At, tangent: &mut Tangent) {
        for Spring { shares, stiffness } in &self.0 {
            for (i, one) in shares {
                for (j, other) in shares {
                    tangent.add([*i, *j], [[0.0; 3], [0.0; 3], [0.0, 0.0, -stiffness * one * other]]);
                }
            }
        }
    }
}
