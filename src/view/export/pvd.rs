//! A series of files for ParaView (`.pvd`), with the time of each.

use std::fmt::Write as _;

use super::instant::Instant;
use crate::view::drawing::escaped;

/// Times of a series: the parameter of each instant, where it ascends; else the load steps, as ParaView sorts by time, and
/// a path that turns back would play in another order than it was followed.
pub fn time_steps(instants: &[Instant]) -> Vec<f64> {
    let ascends = instants.windows(2).all(|pair| pair[0].parameter < pair[1].parameter);
    instants.iter().map(|instant| if ascends { instant.parameter } else { instant.step as f64 }).collect()
}

/// Formats the text of a `.pvd` file of these files and times.
pub fn pvd<'f>(files: impl IntoIterator<Item = (&'f str, f64)>) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (file, time) in files {
        let _ = writeln!(xml, "<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>", escaped(file));
    }
    xml.push_str("</Collection>\n</VTKFile>\n");
    xml
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Parameter;
    use crate::state::Hash;

    #[test]
    fn a_path_that_turns_back_is_played_by_load_step() {
        let instant = |(step, parameter): (usize, &f64)| Instant {
            step: step as u64 + 1,
            driven_by: Parameter::LoadFactor,
            parameter: *parameter,
            moment_n_mm: 0.0,
            strain_energy_n_mm: 0.0,
            state_hash: Hash::from_bytes([0; 32]),
        };
        let times = |parameters: &[f64]| time_steps(&parameters.iter().enumerate().map(instant).collect::<Vec<_>>());
        assert_eq!(times(&[0.1, 0.2, 0.4]), [0.1, 0.2, 0.4]);
        assert_eq!(times(&[0.1, 0.2, 0.15]), [1.0, 2.0, 3.0]);
    }
}
