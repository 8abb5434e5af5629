//! States as arrays for numpy (`.npz`): a zip archive of arrays in the format `.npy` 1.0 (NEP 1).
//!
//! The crate `zip` without its compressions writes the archive. An array is a short text in front of its numbers, for which a
//! crate would bring one of array types as well.

use std::io::{Cursor, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::instant::Instant;
use super::whole_shell::WholeShell;
use crate::spline::Patch;

/// Length of the front of an array is a multiple of this.
const ALIGNMENT: usize = 64;

/// States on one mesh.
#[derive(Debug)]
pub struct StatesOnMesh {
    /// The undeformed surface of each shell, with the name that it has in a structure.
    pub mesh: Vec<(Option<String>, Patch)>,
    /// Displacements of the control points of each shell, mm, and what state they are of.
    pub states: Vec<(Instant, Vec<Vec<[f64; 3]>>)>,
}

impl StatesOnMesh {
    /// The mesh of some shells.
    pub fn mesh_of(shells: &[WholeShell]) -> Vec<(Option<String>, Patch)> {
        shells.iter().map(|shell| (shell.name().map(str::to_owned), shell.undeformed().clone())).collect()
    }
}

/// Arrays of states on one mesh as the bytes of an `.npz` file: `degree` (2), `knots_u`, `knots_v`, `control_points` (n₁, n₂, 4)
/// as (x, y, z, w), the first three in mm and not times the weight w, `displacement` (states, n₁, n₂, 3) in mm, and for each number
/// of a state an array of that name. Of a structure, names of arrays of a shell begin with that of the shell: `NAME.degree`.
///
/// # Errors
/// Where the archive cannot be written.
pub fn npz(StatesOnMesh { mesh, states }: &StatesOnMesh) -> Result<Vec<u8>, ZipError> {
    let mut archive = Archive(ZipWriter::new(Cursor::new(Vec::new())));
    for (index, (name, patch)) in mesh.iter().enumerate() {
        let front = name.as_ref().map_or(String::new(), |name| format!("{name}."));
        let displacement = states.iter().flat_map(|(_, of_shells)| of_shells[index].as_flattened());
        archive.add_shell(&front, patch, states.len(), displacement)?;
    }
    let numbers: Vec<_> = states.iter().map(|(instant, _)| instant.numbers()).collect();
    for (index, (name, _)) in numbers.first().into_iter().flatten().enumerate() {
        archive.add_numbers(name, &[states.len()], numbers.iter().map(|numbers| &numbers[index].1))?;
    }
    let hashes: Vec<String> = states.iter().map(|(instant, _)| instant.state_hash.to_string()).collect();
    let length = hashes.first().map_or(0, String::len);
    archive.add("state_hash", &format!("|S{length}"), &[states.len()], hashes.iter().flat_map(|hash| hash.bytes()))?;
    Ok(archive.0.finish()?.into_inner())
}

/// Arrays by name.
struct Archive(ZipWriter<Cursor<Vec<u8>>>);

impl Archive {
    /// Adds the arrays of a shell, with this in front of their names.
    fn add_shell<'n>(
        &mut self,
        front: &str,
        patch: &Patch,
        states: usize,
        displacement: impl Iterator<Item = &'n f64>,
    ) -> Result<(), ZipError> {
        let named = |name: &str| format!("{front}{name}");
        let [n1, n2] = patch.control_counts();
        let degree = patch.degree.iter().flat_map(|degree| (*degree as i64).to_le_bytes());
        self.add(&named("degree"), "<i8", &[2], degree)?;
        self.add_numbers(&named("knots_u"), &[patch.knots[0].len()], patch.knots[0].iter())?;
        self.add_numbers(&named("knots_v"), &[patch.knots[1].len()], patch.knots[1].iter())?;
        let weights = patch.control_points.iter().map(|[.., weight]| *weight);
        let plain: Vec<[f64; 4]> = patch.points().zip(weights).map(|([x, y, z], weight)| [x, y, z, weight]).collect();
        self.add_numbers(&named("control_points"), &[n1, n2, 4], plain.as_flattened().iter())?;
        self.add_numbers(&named("displacement"), &[states, n1, n2, 3], displacement)
    }

    fn add_numbers<'n>(
        &mut self,
        name: &str,
        shape: &[usize],
        numbers: impl Iterator<Item = &'n f64>,
    ) -> Result<(), ZipError> {
        self.add(name, "<f8", shape, numbers.flat_map(|number| number.to_le_bytes()))
    }

    /// Adds an array of this type, the last index fastest.
    fn add(
        &mut self,
        name: &str,
        kind: &str,
        shape: &[usize],
        bytes: impl Iterator<Item = u8>,
    ) -> Result<(), ZipError> {
        // Of no date: the same states make the same file.
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
        self.0.start_file(format!("{name}.npy"), options)?;
        let content: Vec<u8> = front(kind, shape).into_iter().chain(bytes).collect();
        Ok(self.0.write_all(&content)?)
    }
}

/// What stands in front of the numbers of an array.
fn front(kind: &str, shape: &[usize]) -> Vec<u8> {
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    const MAGIC: &[u8; 8] = b"\x93NUMPY\x01\x00";
    let whole = (MAGIC.len() + 2 + text.len() + 1).next_multiple_of(ALIGNMENT);
    let padded = format!("{text:width$}\n", width = whole - MAGIC.len() - 3);
    MAGIC.iter().copied().chain((padded.len() as u16).to_le_bytes()).chain(padded.into_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn the_front_of_an_array_is_aligned_and_says_its_shape() {
        let front = front("<f8", &[3, 4]);
        assert_eq!(front.len() % 64, 0);
        assert_eq!(usize::from(front[8]) + 10, front.len());
        let text = std::str::from_utf8(&front[10..]).unwrap();
        assert_eq!(text.trim_end(), "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4,), }");
        assert!(text.ends_with('\n'));
    }
}
