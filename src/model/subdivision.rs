//! Subdivision of the spans of a surface, so that a mesh has the elements that a scene asks for, as even as possible.

use crate::model::ModelError;
use crate::shell::norm;
use crate::spline::{Patch, Spans, mid_surface_point};

/// Number of steps in which the length of a span is summed up.
const STEPS: usize = 64;
/// Largest ratio of the parameter's speeds in a span at which the parameter is divided evenly: arcs of one segment
/// reach 1.6.
const EVEN_SPEED: f64 = 1.7;

/// Inserts knots so that there are exactly `elements` in each direction: shared out over the spans by their lengths on
/// the middle line, at least one for each, and even inside each span.
///
/// # Errors
/// Where fewer elements are asked for than the surface has spans.
pub fn subdivide(patch: Patch, elements: [usize; 2]) -> Result<Patch, ModelError> {
    let mut new: [Vec<f64>; 2] = Default::default();
    for direction in 0..2 {
        let spans: Vec<Span> = Spans::of(&patch.knots[direction], patch.degree[direction])
            .bounds
            .into_iter()
            .map(|bounds| Span::measured(&patch, direction, bounds))
            .collect();
        if elements[direction] < spans.len() {
            let name = ["u", "v"][direction];
            return Err(ModelError::TooFewElements { direction: name, asked: elements[direction], least: spans.len() });
        }
        let lengths: Vec<f64> = spans.iter().map(Span::length).collect();
        let pieces = shared_out(&lengths, elements[direction]);
        let even = pieces.iter().all(|count| *count == pieces[0]);
        for (index, (span, count)) in spans.iter().zip(&pieces).enumerate() {
            let [from, to] = span.bounds;
            let uniform = even && (spans.len() as f64 * from - index as f64).abs() < 1e-12;
            new[direction].extend((1..*count).map(|k| match (span.has_even_speed(), uniform) {
                // Uniform spans are divided as multiples of one number, so that equal meshes have equal bits.
                (true, true) => (index * count + k) as f64 / elements[direction] as f64,
                (true, false) => from + (to - from) * k as f64 / *count as f64,
                (false, _) => span.at(k as f64 / *count as f64),
            }));
        }
    }
    Ok(patch.with_knots(&new))
}

/// A span between two knots, on the middle line of the other direction.
struct Span {
    bounds: [f64; 2],
    /// Lengths from its start to the ends of [`STEPS`] equal steps of the parameter, mm.
    lengths: Vec<f64>,
}

impl Span {
    fn measured(patch: &Patch, direction: usize, bounds: [f64; 2]) -> Self {
        let [from, to] = bounds;
        let step = (to - from) / STEPS as f64;
        let mut length = 0.0;
        let sum = |k: usize| {
            let parameter = from + (k as f64 + 0.5) * step;
            let at = if direction == 0 { [parameter, 0.5] } else { [0.5, parameter] };
            length += step * norm(mid_surface_point(patch, &[], at).derivatives[direction]);
            length
        };
        Self { bounds, lengths: (0..STEPS).map(sum).collect() }
    }

    fn length(&self) -> f64 {
        self.lengths[STEPS - 1]
    }

    fn has_even_speed(&self) -> bool {
        let mut before = 0.0;
        let steps = self.lengths.iter().map(|length| length - std::mem::replace(&mut before, *length));
        let [least, most] =
            steps.fold([f64::INFINITY, 0.0_f64], |[least, most], step| [least.min(step), most.max(step)]);
        most <= EVEN_SPEED * least
    }

    /// Finds the parameter at a fraction of the length.
    fn at(&self, fraction: f64) -> f64 {
        let wanted = fraction * self.length();
        let k = self.lengths.partition_point(|length| *length < wanted).min(STEPS - 1);
        let before = if k == 0 { 0.0 } else { self.lengths[k - 1] };
        let within = (wanted - before) / (self.lengths[k] - before);
        let [from, to] = self.bounds;
        from + (to - from) * (k as f64 + within) / STEPS as f64
    }
}

/// Distributes `total` over the lengths in whole numbers of at least 1 that are nearest to their shares: each begins
/// where the rounded sum of those before it ends, so that a symmetric line is divided symmetrically where that can be.
fn shared_out(lengths: &[f64], total: usize) -> Vec<usize> {
    let whole: f64 = lengths.iter().sum();
    let mut reached = 0.0;
    let mut taken = 0;
    let mut pieces: Vec<usize> = lengths
        .iter()
        .map(|length| {
            reached += length;
            // A half is a half whatever rounding makes of it.
            let end = (total as f64 * reached / whole + 1e-9).round() as usize;
            let count = end - taken;
            taken = end;
            count
        })
        .collect();
    while let Some(empty) = pieces.iter().position(|count| *count == 0) {
        let size = |k: &usize| lengths[*k] / pieces[*k] as f64;
        let rich = (0..pieces.len()).filter(|k| pieces[*k] > 1).min_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(rich) = rich else { break };
        pieces[rich] -= 1;
        pieces[empty] += 1;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_shared_out_by_length() {
        assert_eq!(shared_out(&[1.0, 1.0, 1.0], 64), [21, 22, 21]);
        assert_eq!(shared_out(&[1.0, 1.0, 1.0], 16), [5, 6, 5]);
        assert_eq!(shared_out(&[1.0; 4], 64), [16; 4]);
        assert_eq!(shared_out(&[10.0, 30.0], 8), [2, 6]);
        assert_eq!(shared_out(&[1e-6, 1.0, 1e-6, 1e-6], 5), [1, 2, 1, 1]);
        assert_eq!(shared_out(&[1e-6, 1.0], 2), [1, 1]);
        for total in 3..200 {
            let pieces = shared_out(&[0.1, 7.0, 2.5], total);
            assert!(pieces.iter().sum::<usize>() == total && pieces.iter().all(|count| *count > 0), "{pieces:?}");
        }
    }
}
