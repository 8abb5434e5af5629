//! The control points of each element, and the order in which elements are summed.
//!
//! Nothing here knows how a mesh is made: elements may have different numbers of control points, and several patches may
//! share them. One thread sums up the elements of a strand one after another; strands of one colour share no control point
//! and run at once, colours follow each other. Every sum is therefore formed in one order, whatever the number of threads.

use std::ops::Range;

use crate::spline::{Grid, Patch};

/// Elements with their control points, and the order of sums over them.
#[derive(Clone, Debug, PartialEq)]
pub struct Connectivity {
    points: usize,
    /// Control points of element e: `controls[starts[e]..starts[e + 1]]`.
    starts: Vec<usize>,
    controls: Vec<usize>,
    strands: Vec<Strand>,
    /// Strands of each colour, ascending.
    colours: Vec<Vec<usize>>,
}

/// Elements that one thread sums up one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct Strand {
    /// Elements of the strand.
    pub elements: Range<usize>,
    /// Control points of these elements, ascending, in as few runs as there are.
    pub runs: Vec<Range<usize>>,
}

impl Connectivity {
    /// Creates the connectivity of elements with these control points, in strands of these lengths. Strand k takes the
    /// first colour that is free for it, beginning with k modulo `cycle`.
    ///
    /// # Panics
    /// Where the strands do not have all of the elements, or an element has a control point twice, whose blocks would
    /// be lost.
    pub fn new(points: usize, elements: &[Vec<usize>], strand_lengths: &[usize], cycle: usize) -> Self {
        assert_eq!(strand_lengths.iter().sum::<usize>(), elements.len(), "every element is in one strand");
        let is_plain = |element: &Vec<usize>| {
            let mut sorted = element.clone();
            sorted.sort_unstable();
            sorted.windows(2).all(|pair| pair[0] < pair[1])
        };
        assert!(elements.iter().all(is_plain), "an element has no control point twice");
        let of_elements = starts(elements.iter().map(Vec::len));
        let controls: Vec<usize> = elements.concat();
        let firsts = starts(strand_lengths.iter().copied());
        let strands: Vec<Strand> = firsts
            .windows(2)
            .map(|pair| {
                let runs = runs(controls[of_elements[pair[0]]..of_elements[pair[1]]].to_vec());
                Strand { elements: pair[0]..pair[1], runs }
            })
            .collect();
        let colours = colours(points, &strands, cycle.max(1));
        Self { points, starts: of_elements, controls, strands, colours }
    }

    /// Creates the connectivity of a tensor-product mesh, on a grid of elements whose first control index in each
    /// direction is `first`: a strand for each column of elements across the first direction. Columns that are p₁ + 1
    /// apart share no control point.
    pub fn of_tensor_product(mesh: &Patch, first: &[Vec<usize>; 2]) -> Self {
        let elements = Grid::new(first.each_ref().map(Vec::len));
        let controls: Vec<Vec<usize>> = (0..elements.len())
            .map(|element| {
                let [e1, e2] = elements.place(element);
                mesh.window([first[0][e1], first[1][e2]]).collect()
            })
            .collect();
        let [columns, length] = elements.counts;
        Self::new(mesh.control_points.len(), &controls, &vec![length; columns], mesh.degree[0] + 1)
    }

    /// Returns the same elements on other control points: `numbers` are the new numbers of the old ones, among `points`
    /// in all.
    ///
    /// # Panics
    /// Where a number is missing.
    pub fn renumbered(&self, points: usize, numbers: &[usize]) -> Self {
        let renumbered = |element| self.controls(element).iter().map(|control| numbers[*control]).collect();
        let elements: Vec<Vec<usize>> = (0..self.elements()).map(renumbered).collect();
        let lengths: Vec<usize> = self.strands.iter().map(|strand| strand.elements.len()).collect();
        Self::new(points, &elements, &lengths, self.colours.len())
    }

    /// Returns the same elements as a part of a structure of so many `points`, in which the first control point of this part
    /// has the number `first`. The order of sums stays.
    pub fn shifted(mut self, points: usize, first: usize) -> Self {
        self.points = points;
        self.controls.iter_mut().for_each(|control| *control += first);
        let runs = self.strands.iter_mut().flat_map(|strand| &mut strand.runs);
        runs.for_each(|run| *run = run.start + first..run.end + first);
        self
    }

    /// Number of control points.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.starts.len() - 1
    }

    /// Control points of an element, in the order of its functions.
    pub fn controls(&self, element: usize) -> &[usize] {
        &self.controls[self.starts[element]..self.starts[element + 1]]
    }

    /// Strands, in the order of sums.
    pub fn strands(&self) -> &[Strand] {
        &self.strands
    }

    /// Indices of the strands of each colour.
    pub fn colours(&self) -> &[Vec<usize>] {
        &self.colours
    }
}

/// Sums of all counts before each one, and of all of them.
pub(super) fn starts(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let sums = counts.scan(0, |sum, count| {
        *sum += count;
        Some(*sum)
    });
    std::iter::once(0).chain(sums).collect()
}

/// Splits a list of numbers into runs of successive ones.
fn runs(mut list: Vec<usize>) -> Vec<Range<usize>> {
    list.sort_unstable();
    list.dedup();
    list.chunk_by(|one, next| one + 1 == *next).map(|run| run[0]..run[run.len() - 1] + 1).collect()
}

fn colours(points: usize, strands: &[Strand], cycle: usize) -> Vec<Vec<usize>> {
    let mut taken: Vec<Vec<usize>> = vec![Vec::new(); points];
    let mut colours: Vec<Vec<usize>> = Vec::new();
    for (index, strand) in strands.iter().enumerate() {
        let touched = || strand.runs.iter().cloned().flatten();
        let is_free = |colour: &usize| touched().all(|point| !taken[point].contains(colour));
        let in_turn = (0..cycle).map(|k| (index + k) % cycle).chain(cycle..);
        // There are endless colours, so that one is free.
        let Some(colour) = in_turn.into_iter().find(is_free) else { unreachable!("colours have no end") };
        touched().for_each(|point| taken[point].push(colour));
        colours.resize_with(colours.len().max(colour + 1), Vec::new);
        colours[colour].push(index);
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strands of one colour share no control point, and every strand has one colour.
    fn check(connectivity: &Connectivity) {
        let mut seen = vec![0; connectivity.strands().len()];
        for colour in connectivity.colours() {
            let mut touched = vec![false; connectivity.points()];
            for strand in colour {
                seen[*strand] += 1;
                for point in connectivity.strands()[*strand].runs.iter().cloned().flatten() {
                    assert!(!std::mem::replace(&mut touched[point], true), "control point {point} twice");
                }
            }
        }
        assert!(seen.iter().all(|count| *count == 1));
    }

    /// A strip of elements of 3 points, 2 apart, and two more elements across its ends.
    #[test]
    fn strands_of_a_colour_share_nothing() {
        let mut elements: Vec<Vec<usize>> = (0..5).map(|e| (2 * e..2 * e + 3).collect()).collect();
        elements.extend([vec![10, 0, 11, 12], vec![0, 5]]);
        let connectivity = Connectivity::new(13, &elements, &[2, 1, 2, 1, 1], 2);
        check(&connectivity);
        assert_eq!(connectivity.controls(5), [10, 0, 11, 12]);
        assert_eq!(connectivity.strands()[3].runs, [0..1, 10..13]);
        assert_eq!(connectivity.elements(), 7);
        check(&connectivity.renumbered(26, &(0..13).map(|k| 25 - 2 * k).collect::<Vec<_>>()));
    }
}
