//! How much faster a run is than the cheapest uniform mesh that is as good, before the snap and behind it.
//!
//! A family of uniform meshes gives error against time on each side of the snap. Between two of its meshes both are interpolated
//! on a line in logarithms, as errors fall with a power of the number of unknowns and times rise with one. What a family needs for
//! an error is what it needs on the side where it needs more.

/// Errors before the first snap and behind it, relative.
pub type Errors = [Option<f64>; 2];

/// What the finer of two reference meshes is off by, from what the coarser one differs: the error of a mesh of degree p falls with
/// h^(2(p−1)) (the energy of bending; Strang & Fix 1973), so that the difference is (r^(2(p−1)) − 1) times the error, for lengths of
/// elements in the ratio r (Richardson 1911). Directions count by the one that is refined less.
pub fn error_of_finer(differences: Errors, finer: [usize; 2], coarser: [usize; 2], degree: [usize; 2]) -> Errors {
    let growth = [0, 1].map(|d| (finer[d] as f64 / coarser[d] as f64).powi(2 * (degree[d] as i32 - 1)) - 1.0);
    let least = growth[0].min(growth[1]).max(1.0);
    differences.map(|difference| Some(difference? / least))
}

/// A mesh of a family: its time in seconds and its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint {
    /// Wall time, seconds.
    pub wall_s: f64,
    /// Errors of its run.
    pub errors: Errors,
}

/// The ratio of times of uniform meshes and of a run that is as good.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedUp {
    /// The ratio.
    Times(f64),
    /// No mesh of the families is as good; the ratio for the slowest of all is less than what it would be.
    MoreThan(f64),
}

/// Finds the speed-up of a run over the families' cheapest mesh that is as good; `None` where the run has no error to hold
/// against or the families have no mesh. Errors below `floor`, the reference's own, count as that.
pub fn speed_up(run: &MeshPoint, families: &[Vec<MeshPoint>], floor: Errors) -> Option<SpeedUp> {
    let cheapest = families.iter().filter_map(|family| time_for(family, run.errors, floor)).reduce(f64::min);
    let slowest = families.iter().flatten().map(|mesh| mesh.wall_s).reduce(f64::max)?;
    run.errors.iter().any(Option::is_some).then_some(match cheapest {
        Some(time) => SpeedUp::Times(time / run.wall_s),
        None => SpeedUp::MoreThan(slowest / run.wall_s),
    })
}

/// Time that a family, ordered from coarse to fine, takes for errors on both sides; `None` where its finest mesh is not so good.
fn time_for(family: &[MeshPoint], errors: Errors, floor: Errors) -> Option<f64> {
    let side = |side: usize| match errors[side] {
        None => Some(0.0),
        Some(error) => {
            let floor = floor[side].unwrap_or(0.0);
            let curve = family.iter().map(|mesh| (mesh.wall_s, mesh.errors[side].map(|error| error.max(floor))));
            time_on(curve, error.max(floor))
        }
    };
    Some(side(0)?.max(side(1)?))
}

/// Time at which a curve of time and error first falls to an error. A mesh without an error on this side has not jumped: it is
/// not as good as any.
fn time_on(curve: impl Iterator<Item = (f64, Option<f64>)>, error: f64) -> Option<f64> {
    let mut before: Option<(f64, f64)> = None;
    for (time, found) in curve {
        let Some(found) = found else { continue };
        if found <= error {
            return Some(match before {
                Some((earlier, larger)) => {
                    let share = (larger / error).ln() / (larger / found.max(f64::MIN_POSITIVE)).ln();
                    (earlier.ln() + share * (time / earlier).ln()).exp()
                }
                None => time,
            });
        }
        before = Some((time, found));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_FLOOR: Errors = [None, None];

    fn point(wall_s: f64, before: f64, behind: f64) -> MeshPoint {
        MeshPoint { wall_s, errors: [Some(before), Some(behind)] }
    }

    fn times(found: Option<SpeedUp>) -> f64 {
        let Some(SpeedUp::Times(ratio)) = found else { panic!("{found:?}") };
        ratio
    }

    /// Errors that fall with the square of the time: 1 % takes √(4/1) of the time of 4 %.
    #[test]
    fn powers_are_interpolated_exactly() {
        let family = vec![point(1.0, 0.04, 0.04), point(4.0, 0.0025, 0.0025)];
        assert!((times(speed_up(&point(0.5, 0.01, 0.02), &[family.clone()], NO_FLOOR)) - 4.0).abs() < 1e-12);
        // The side that needs more decides.
        assert!((times(speed_up(&point(0.5, 0.04, 0.0025), &[family], NO_FLOOR)) - 8.0).abs() < 1e-12);
    }

    #[test]
    fn the_cheapest_family_counts_and_none_may_be_good_enough() {
        let families = [vec![point(3.0, 0.01, 0.01)], vec![point(2.0, 0.01, 0.01)], vec![point(9.0, 0.5, 0.5)]];
        assert_eq!(speed_up(&point(1.0, 0.02, 0.02), &families, NO_FLOOR), Some(SpeedUp::Times(2.0)));
        assert_eq!(speed_up(&point(1.0, 0.001, 0.02), &families, NO_FLOOR), Some(SpeedUp::MoreThan(9.0)));
        assert_eq!(speed_up(&point(1.0, 0.02, 0.02), &[], NO_FLOOR), None);
    }

    #[test]
    fn a_coarser_reference_tells_the_error_of_the_finer() {
        // Quartic, twice as fine: 63 times the error. Where both are alike nothing is gained.
        assert_eq!(error_of_finer([Some(0.63), None], [16, 8], [8, 4], [4, 4]), [Some(0.01), None]);
        assert_eq!(error_of_finer([Some(0.5), Some(0.1)], [16, 8], [16, 4], [4, 4]), [Some(0.5), Some(0.1)]);
    }

    /// Errors below that of the reference are not told apart.
    #[test]
    fn nothing_is_better_than_the_reference() {
        let family = vec![point(1.0, 0.02, 0.02), point(3.0, 0.009, 0.0004)];
        let run = point(1.0, 0.01, 0.0001);
        assert_eq!(speed_up(&run, &[family.clone()], NO_FLOOR), Some(SpeedUp::MoreThan(3.0)));
        assert!((times(speed_up(&run, &[family], [Some(0.0005), Some(0.0005)])) - 3.0).abs() < 1e-12);
    }

    /// A mesh that has not snapped has no error behind the snap, and is not as good as one that has.
    #[test]
    fn a_mesh_that_has_not_snapped_is_passed_over() {
        let still = MeshPoint { wall_s: 1.0, errors: [Some(0.001), None] };
        let family = vec![still, point(5.0, 0.001, 0.001)];
        assert_eq!(speed_up(&point(1.0, 0.01, 0.01), &[family], NO_FLOOR), Some(SpeedUp::Times(5.0)));
    }
}
