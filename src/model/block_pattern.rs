//! The 3 × 3 blocks of a matrix on the control points: those of pairs that share an element, and others on request.

use crate::model::Connectivity;

/// Pattern of the blocks (i, j) with j ≥ i, row by row, in each row with growing j; the others are their transposes.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockPattern {
    /// Blocks of row i: `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    columns: Vec<usize>,
    /// Slots of each part.
    slots: Vec<Slots>,
}

/// Positions within their rows of the blocks of the functions a ≤ b of elements.
#[derive(Clone, Debug, Default, PartialEq)]
struct Slots {
    /// Positions of element e: `places[starts[e]..starts[e + 1]]`.
    starts: Vec<usize>,
    places: Vec<u16>,
}

impl BlockPattern {
    /// Creates the pattern of all pairs of control points that share an element of one of the parts, and of `pairs` in
    /// addition. The parts have the same control points.
    ///
    /// # Panics
    /// Where the parts have different numbers of control points, or a control point meets more than 65,535 others.
    pub fn new(parts: &[&Connectivity], pairs: &[[usize; 2]]) -> Self {
        let points = parts.first().map_or(0, |part| part.points());
        assert!(parts.iter().all(|part| part.points() == points), "parts of one matrix have the same control points");
        let rows = Rows::of(points, parts, pairs);
        let mut pattern = Self { starts: rows.starts, columns: rows.columns, slots: Vec::new() };
        pattern.slots = parts.iter().map(|part| pattern.slots_of(part)).collect();
        pattern
    }

    fn slots_of(&self, part: &Connectivity) -> Slots {
        let mut slots = Slots { starts: vec![0], places: Vec::new() };
        for element in 0..part.elements() {
            let controls = part.controls(element);
            for (a, one) in controls.iter().enumerate() {
                for other in &controls[a..] {
                    let [i, j] = [*one.min(other), *one.max(other)];
                    let Some(block) = self.block(i, j) else { unreachable!("control points of an element meet") };
                    let slot = block - self.starts[i];
                    assert!(slot <= u16::MAX as usize, "control point {i} meets more than 65,535 others");
                    slots.places.push(slot as u16);
                }
            }
            slots.starts.push(slots.places.len());
        }
        slots
    }

    /// Number of control points.
    pub fn points(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Index of the first block of a row, which is that of the control point with itself.
    pub fn start(&self, row: usize) -> usize {
        self.starts[row]
    }

    /// Control points j ≥ i that share a block with a control point i.
    pub fn row(&self, row: usize) -> &[usize] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// The control points i ≤ j of all blocks, in their order.
    pub fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        (0..self.points()).flat_map(|i| self.row(i).iter().map(move |j| [i, *j]))
    }

    /// Index of the block of control points i ≤ j; `None` where they share none.
    pub fn block(&self, i: usize, j: usize) -> Option<usize> {
        self.row(i).binary_search(&j).ok().map(|slot| self.starts[i] + slot)
    }

    /// Positions within their rows of the blocks of an element's functions a ≤ b: (0, 0), (0, 1), ..., (1, 1), ...
    pub fn slots(&self, part: usize, element: usize) -> &[u16] {
        let Slots { starts, places } = &self.slots[part];
        &places[starts[element]..starts[element + 1]]
    }
}

/// Rows of blocks.
struct Rows {
    starts: Vec<usize>,
    columns: Vec<usize>,
}

impl Rows {
    fn of(points: usize, parts: &[&Connectivity], pairs: &[[usize; 2]]) -> Self {
        let mut elements_of: Vec<Vec<(usize, usize)>> = vec![Vec::new(); points];
        for (index, part) in parts.iter().enumerate() {
            for element in 0..part.elements() {
                part.controls(element).iter().for_each(|control| elements_of[*control].push((index, element)));
            }
        }
        let mut more: Vec<Vec<usize>> = vec![Vec::new(); points];
        pairs.iter().for_each(|[one, other]| more[*one.min(other)].push(*one.max(other)));
        // The row that a control point was last found in.
        let mut met_in = vec![usize::MAX; points];
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for row in 0..points {
            let first = columns.len();
            let of_elements = elements_of[row].iter().flat_map(|(index, element)| parts[*index].controls(*element));
            for other in std::iter::once(&row).chain(of_elements).chain(&more[row]) {
                if *other >= row && met_in[*other] != row {
                    met_in[*other] = row;
                    columns.push(*other);
                }
            }
            columns[first..].sort_unstable();
            starts.push(columns.len());
        }
        Self { starts, columns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_share_no_element_have_no_block_unless_asked_for() {
        let elements = [vec![0, 1, 2], vec![2, 3]];
        let connectivity = Connectivity::new(5, &elements, &[1, 1], 1);
        let pattern = BlockPattern::new(&[&connectivity], &[[4, 1], [2, 1]]);
        assert_eq!(pattern.row(0), [0, 1, 2]);
        assert_eq!(pattern.row(1), [1, 2, 4]);
        assert_eq!(pattern.row(2), [2, 3]);
        assert_eq!(pattern.row(4), [4]);
        assert_eq!(pattern.block(0, 3), None);
        assert_eq!(pattern.block(1, 4), Some(5));
        assert_eq!(pattern.slots(0, 0), [0, 1, 2, 0, 1, 0]);
        assert_eq!(pattern.slots(0, 1), [0, 1, 0]);
        assert_eq!((pattern.points(), pattern.blocks()), (5, 10));
    }
}
