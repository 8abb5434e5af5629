//! Refinement indicators (Canales & Pellegrino): r_i = max|κ_i| h_i over an element, with κ_i the physical bending
//! strain along local axis i and h_i the element's length along it. An axis is refined where r_i > r₀ and h_i / 2
//! exceeds the length limit, each axis on its own. The mesh is a tensor product, so a marked element marks its whole
//! knot span.

use rayon::prelude::*;

use crate::adapt::judged_mesh::{MOST_PARTS, cuts};
use crate::energy::{Discretization, Shell};
use crate::model::{Member, Tables, members};
use crate::scene::{Adapt, Geometry, Indicator, LengthLimit, Scene, Splitting};
use crate::shell::{PointReference, Strains};
use crate::spline::{Grid, KnotLists, Patch, Spans};

/// Of the spans that are too coarse those are marked whose indicator is at least this share of the worst one; the others
/// wait for the next round. After a snap on a coarse mesh the fold is wider than it will be, and where it reaches too far
/// no mesh is needed in the end: the baseline ends with 992 elements that way and with 1056 when all are marked at once, in
/// 5 % less time, with the same moments. From 0.7 on rounds cost more than they save.
///
/// Knots are not removed again. Of the 62 spans along the length that the baseline's snap leaves, 6 to 8 could be merged with
/// their twins and stay below half, or 0.7, of the threshold, and none across: an eighth of the elements at most, against a
/// displacement that no longer lies in the space, one more equilibrium to find, and refinements at the next steps (12 more
/// spans by 60°).
const WORST_FIRST: f64 = 0.5;

/// Of the spans above the threshold that the length limit keeps, those are said to be blocked that are longer than this, in
/// decay lengths √(t/κ) of their own bending: layers of that length stand wherever bending changes, and a fold of
/// curvature 1/R has √(R t).
const LONGEST: f64 = 3.0;

/// Indicators of a state and the knots that they mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Indicators {
    /// Largest r_i each way, dimensionless.
    pub largest: [f64; 2],
    /// Knots to insert into each patch: the middles of the marked spans, or more within them.
    pub marked: KnotLists,
    /// What is too coarse and is not marked, as the length limit says; `None` where that is not far from fine enough.
    pub blocked: Option<Blocked>,
}

/// Spans that are too coarse by far and that the length limit keeps from being halved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocked {
    /// Spans each way.
    pub spans: [usize; 2],
    /// Length of the longest, in decay lengths √(t/κ) of its bending κ.
    pub decay_lengths: f64,
    /// Their largest indicator, over its threshold.
    pub over_threshold: f64,
}

/// Evaluates the indicators at the quadrature points of every element; each shell is judged on its own.
pub fn evaluate_indicators(
    scene: &Scene,
    adapt: &Adapt,
    discretization: &Discretization,
    displacement: &[[f64; 3]],
) -> Indicators {
    let shells = members(scene, &discretization.mesh).into_iter().zip(&discretization.shells);
    let mut all = Indicators { largest: [0.0; 2], marked: Vec::new(), blocked: None };
    for (Member { scene, patch, .. }, shell) in shells {
        let (largest, marked, blocked) = indicators_of(&scene, adapt, (patch, shell), displacement);
        all.largest = [0, 1].map(|axis| all.largest[axis].max(largest[axis]));
        all.marked.push(marked);
        all.blocked = match (all.blocked, blocked) {
            (Some(one), Some(other)) => Some(one.and(other)),
            (one, other) => one.or(other),
        };
    }
    all
}

/// The largest indicators of a shell, its marked knots, and what its length limit blocks.
fn indicators_of(
    scene: &Scene,
    adapt: &Adapt,
    (patch, shell): (&Patch, &Shell),
    displacement: &[[f64; 3]],
) -> ([f64; 2], [Vec<f64>; 2], Option<Blocked>) {
    let elements = shell.tables.elements;
    let limit = length_limit(scene, shell, adapt.length_limit);
    let threshold = match adapt.indicator {
        Indicator::BendingStrain(threshold) => threshold,
        Indicator::Error(_) => [f64::INFINITY; 2],
    };
    let values: Vec<[f64; 2]> =
        (0..elements.len()).into_par_iter().map(|element| element_indicators(shell, displacement, element)).collect();
    let judged = Judged { threshold, limit, lengths: &shell.tables.lengths, values: &values };
    let largest = values.iter().fold([0.0_f64; 2], |most, value| [0, 1].map(|axis| most[axis].max(value[axis])));
    let worst = [0, 1].map(|axis| {
        let too_coarse = (0..values.len()).filter(|element| judged.is_too_coarse(*element, axis));
        too_coarse.map(|element| values[element][axis]).fold(0.0, f64::max)
    });
    let is_marked = |element: usize, axis: usize| {
        judged.is_too_coarse(element, axis) && values[element][axis] >= WORST_FIRST * worst[axis]
    };
    let marked = [0, 1].map(|axis| {
        let bounds = Spans::of(&patch.knots[axis], patch.degree[axis]).bounds;
        let parts = |span: usize| match adapt.splitting {
            Splitting::Halves => 2,
            Splitting::Parts => {
                elements.line(axis, span).map(|element| judged.parts(element, axis)).fold(2, usize::max)
            }
        };
        let marks = spans_where(elements, axis, is_marked).into_iter().enumerate().filter(|(_, marked)| *marked);
        marks.flat_map(|(span, _)| cuts(bounds[span], parts(span))).collect()
    });
    (largest, marked, judged.blocked(elements, scene.material.thickness_mm()))
}

impl Blocked {
    /// The spans of two shells together.
    fn and(self, other: Self) -> Self {
        Self {
            spans: [0, 1].map(|axis| self.spans[axis] + other.spans[axis]),
            decay_lengths: self.decay_lengths.max(other.decay_lengths),
            over_threshold: self.over_threshold.max(other.over_threshold),
        }
    }
}

/// Spans of a direction in which an element is as asked.
fn spans_where(elements: Grid, axis: usize, holds: impl Fn(usize, usize) -> bool) -> Vec<bool> {
    let mut spans = vec![false; elements.counts[axis]];
    for element in 0..elements.len() {
        spans[elements.place(element)[axis]] |= holds(element, axis);
    }
    spans
}

/// The indicators and what they are compared with.
struct Judged<'a> {
    threshold: [f64; 2],
    /// Elements are not halved below this each way, mm.
    limit: [f64; 2],
    lengths: &'a [[f64; 2]],
    values: &'a [[f64; 2]],
}

impl Judged<'_> {
    fn is_above(&self, element: usize, axis: usize) -> bool {
        self.values[element][axis] > self.threshold[axis]
    }

    fn may_be_halved(&self, element: usize, axis: usize) -> bool {
        self.lengths[element][axis] / 2.0 > self.limit[axis]
    }

    fn is_too_coarse(&self, element: usize, axis: usize) -> bool {
        self.is_above(element, axis) && self.may_be_halved(element, axis)
    }

    /// Parts in which its indicator falls to the threshold, as far as the limit allows, up to four at once.
    fn parts(&self, element: usize, axis: usize) -> usize {
        let asked = (self.values[element][axis] / self.threshold[axis]).ceil();
        asked.min(self.lengths[element][axis] / self.limit[axis]).min(MOST_PARTS as f64) as usize
    }

    /// What the limit keeps far too long.
    fn blocked(&self, elements: Grid, thickness: f64) -> Option<Blocked> {
        let decay_lengths =
            |element: usize, axis: usize| (self.values[element][axis] * self.lengths[element][axis] / thickness).sqrt();
        let is_blocked = |element: usize, axis: usize| {
            self.is_above(element, axis) && !self.may_be_halved(element, axis) && decay_lengths(element, axis) > LONGEST
        };
        let spans = [0, 1].map(|axis| spans_where(elements, axis, is_blocked).into_iter().filter(|is| *is).count());
        let places = (0..self.values.len()).flat_map(|element| [(element, 0), (element, 1)]);
        let blocked = places.filter(|(element, axis)| is_blocked(*element, *axis));
        let found = blocked
            .map(|(element, axis)| [decay_lengths(element, axis), self.values[element][axis] / self.threshold[axis]]);
        let [decay_lengths, over_threshold] = found.reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])?;
        Some(Blocked { spans, decay_lengths, over_threshold })
    }
}

/// Length of every span in both directions of a shell, along the longest of its lines, mm.
pub fn span_lengths(shell: &Shell) -> [Vec<f64>; 2] {
    let Tables { elements, lengths, .. } = &shell.tables;
    let of_span = |axis: usize, span: usize| elements.line(axis, span).map(move |element| lengths[element][axis]);
    [0, 1].map(|axis| (0..elements.counts[axis]).map(|span| of_span(axis, span).fold(0.0, f64::max)).collect())
}

/// Elements are not halved below this, mm.
///
/// Beside forces on points and free edges √(R t) is not enough. Largest error of the deflection under the force, cubic
/// elements from 4 × 4 on, threshold 0.019, with √(R t), half of it and a quarter: open cylinder pulled at two points (R/t =
/// 53) 6.3, 1.6, 0.7 %; pinched hemisphere (R/t = 250) 1.3, 0.06, 0.06 %.
pub fn length_limit(scene: &Scene, shell: &Shell, rule: LengthLimit) -> [f64; 2] {
    let radius = || match scene.geometry {
        Geometry::TapeSpring { radius_mm, .. } => radius_mm,
        _ => 1.0 / largest_curvature(shell),
    };
    let decay_length = |radius: f64| (radius * scene.material.thickness_mm()).sqrt();
    match rule {
        LengthLimit::SqrtRadiusThickness => [decay_length(radius()); 2],
        LengthLimit::HalfDecayLength => [0.5 * decay_length(radius().min(shorter_side(shell))); 2],
        LengthLimit::Thickness => [scene.material.thickness_mm(); 2],
        LengthLimit::Millimetres(length) => length,
    }
}

/// The longest line of elements each way, and of these the shorter, mm.
fn shorter_side(shell: &Shell) -> f64 {
    let Tables { elements, lengths, .. } = &shell.tables;
    let longest = |way: usize| {
        let of_line = |beside| elements.line(1 - way, beside).map(|element| lengths[element][way]).sum();
        (0..elements.counts[1 - way]).map(of_line).fold(0.0, f64::max)
    };
    longest(0).min(longest(1))
}

/// Largest principal curvature of the undeformed surface at the quadrature points, 1/mm.
fn largest_curvature(shell: &Shell) -> f64 {
    shell.tables.points.references.iter().map(PointReference::largest_curvature).fold(0.0, f64::max)
}

/// max|κ_i| h_i over the quadrature points of an element.
fn element_indicators(shell: &Shell, displacement: &[[f64; 3]], element: usize) -> [f64; 2] {
    let mut largest = [0.0_f64; 2];
    for (strains, lengths) in element_strains(shell, displacement, element) {
        for axis in 0..2 {
            largest[axis] = largest[axis].max(strains.bending[axis].abs() / (lengths[axis] * lengths[axis]));
        }
    }
    [0, 1].map(|axis| largest[axis] * shell.tables.lengths[element][axis])
}

/// Strains at the quadrature points of an element, in the parameter basis, each with |A₁|, |A₂|: physical components
/// are strains over the lengths.
pub fn element_strains(shell: &Shell, displacement: &[[f64; 3]], element: usize) -> Vec<(Strains, [f64; 2])> {
    let tables = &shell.tables;
    let controls = tables.connectivity.controls(element);
    let functions = tables.points.element_functions(element);
    let at_point = |(q, point): (usize, &PointReference)| {
        let mut u = [[0.0; 3]; 5];
        for k in 0..5 {
            let row = &functions[(q * 5 + k) * tables.padded..][..controls.len()];
            for (control, function) in controls.iter().zip(row) {
                (0..3).for_each(|c| u[k][c] += function * displacement[*control][c]);
            }
        }
        (point.strains(&u), point.tangent_lengths())
    };
    tables.points.element_points(element).iter().enumerate().map(at_point).collect()
}

/// The largest magnitude of a Green–Lagrange strain along u or v in a surface of the shell (membrane strain and half the
/// thickness times the bending strain), and where it is.
pub fn largest_strain(
    (patch, shell): (&Patch, &Shell),
    displacement: &[[f64; 3]],
    thickness_mm: f64,
) -> (f64, [f64; 2]) {
    largest_along((patch, shell), displacement, |strains, axis| {
        strains.membrane[axis].abs() + 0.5 * thickness_mm * strains.bending[axis].abs()
    })
}

/// The largest magnitude of the bending strain along u or v, 1/mm, and where it is.
pub fn largest_bending_strain((patch, shell): (&Patch, &Shell), displacement: &[[f64; 3]]) -> (f64, [f64; 2]) {
    largest_along((patch, shell), displacement, |strains, axis| strains.bending[axis].abs())
}

/// The largest physical value along u or v of what `of` makes of the strains in the parameter basis, and the middle of the element
/// where it is, as parameters (u, v).
fn largest_along(
    (patch, shell): (&Patch, &Shell),
    displacement: &[[f64; 3]],
    of: impl Fn(&Strains, usize) -> f64 + Sync,
) -> (f64, [f64; 2]) {
    let elements = shell.tables.elements;
    let of_element = |element: usize| {
        let points = element_strains(shell, displacement, element);
        let physical = |(strains, lengths): &(Strains, [f64; 2])| {
            [0, 1].map(|axis| of(strains, axis) / (lengths[axis] * lengths[axis]))
        };
        points.iter().flat_map(physical).fold(0.0, f64::max)
    };
    let values: Vec<f64> = (0..elements.len()).into_par_iter().map(of_element).collect();
    let largest =
        (0..values.len()).fold(0, |best, element| if values[element] > values[best] { element } else { best });
    let at = elements.place(largest);
    let middle = |way: usize| {
        let [from, to] = Spans::of(&patch.knots[way], patch.degree[way]).bounds[at[way]];
        0.5 * (from + to)
    };
    (values[largest], [middle(0), middle(1)])
}
