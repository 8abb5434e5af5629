//! How much faster a run is than the cheapest uniform mesh that is as good, before the snap and behind it.
//!
//! A family of uniform meshes gives error against time on each side of the snap. Between two of its meshes both are interpolated
//! on a line in logarithms, as errors fall with a power of the number of unknowns and times rise with one. What a family needs for
//! an error is what it needs on the side where it needs more.

/// Share of the error of the mesh before, below which the error of the finest mesh of a family still falls: where elements across are
/// too few, no number of them along helps.
const FALLING: f64 = 0.8;

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

/// The ratio of times of uniform meshes and of a run that is as good, as far as the meshes that were run bound it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SpeedUp {
    /// It is at least this: 0 where the coarsest mesh of a family is as good already.
    pub at_least: f64,
    /// It is at most this; `None` where no mesh is as good.
    pub at_most: Option<f64>,
}

/// Finds the speed-up of a run over the families' cheapest mesh that is as good. `None` where the run has no error where the
/// reference has one (it has not snapped), or no family comes to its errors. Errors below `own`, those of the reference
/// itself, count as that.
pub fn speed_up(run: &MeshPoint, families: &[Vec<MeshPoint>], own: Errors) -> Option<SpeedUp> {
    let is_comparable = run.errors.iter().zip(own).all(|(error, own)| error.is_some() || own.is_none());
    let times: Vec<Needed> = families.iter().filter_map(|family| time_for(family, run.errors, own)).collect();
    let at_most = times.iter().filter_map(|needed| needed.at_most).reduce(f64::min);
    let at_least = times.iter().map(|needed| needed.at_least).reduce(f64::min)?;
    let ratio = |time: f64| time / run.wall_s;
    let at_least = at_most.map_or(at_least, |at_most| at_least.min(at_most));
    is_comparable.then_some(SpeedUp { at_least: ratio(at_least), at_most: at_most.map(ratio) })
}

/// Bounds of the time that a family takes for some errors, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Needed {
    at_least: f64,
    at_most: Option<f64>,
}

/// Time that a family, ordered from coarse to fine, takes for errors on both sides; `None` where it never comes to them.
fn time_for(family: &[MeshPoint], errors: Errors, own: Errors) -> Option<Needed> {
    let mut needed = Needed { at_least: 0.0, at_most: Some(0.0) };
    for side in 0..2 {
        let Some(error) = errors[side] else { continue };
        let least = own[side].unwrap_or(0.0);
        let curve =
            family.iter().filter_map(|mesh| Some((mesh.wall_s, mesh.errors[side]?.max(least)))).collect::<Vec<_>>();
        let one = time_on(&curve, error.max(least))?;
        needed.at_least = needed.at_least.max(one.at_least);
        needed.at_most = needed.at_most.zip(one.at_most).map(|(a, b)| a.max(b));
    }
    Some(needed)
}

/// Time at which a curve of time and error first falls to an error; `None` where it is above that and no longer falls.
fn time_on(curve: &[(f64, f64)], error: f64) -> Option<Needed> {
    let first = curve.iter().position(|(_, found)| *found <= error);
    match (first, curve) {
        (Some(0), [(time, _), ..]) => Some(Needed { at_least: 0.0, at_most: Some(*time) }),
        (Some(index), _) => {
            let [(earlier, larger), (time, found)] = [curve[index - 1], curve[index]];
            let share = (larger / error).ln() / (larger / found.max(f64::MIN_POSITIVE)).ln();
            let at = (earlier.ln() + share * (time / earlier).ln()).exp();
            Some(Needed { at_least: at, at_most: Some(at) })
        }
        (None, [.., (_, before), (time, last)]) if *last < FALLING * before => {
            Some(Needed { at_least: *time, at_most: None })
        }
        (None, _) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: Errors = [Some(0.0), Some(0.0)];

    fn point(wall_s: f64, before: f64, behind: f64) -> MeshPoint {
        MeshPoint { wall_s, errors: [Some(before), Some(behind)] }
    }

    fn bounds(found: Option<SpeedUp>) -> (f64, Option<f64>) {
        let rounded = |ratio: f64| (ratio * 1e9).round() / 1e9;
        found.map(|SpeedUp { at_least, at_most }| (rounded(at_least), at_most.map(rounded))).unwrap()
    }

    /// Errors that fall with the square of the time: 1 % takes √(4/1) of the time of 4 %.
    #[test]
    fn powers_are_interpolated_exactly() {
        let family = vec![point(1.0, 0.04, 0.04), point(4.0, 0.0025, 0.0025)];
        assert_eq!(bounds(speed_up(&point(0.5, 0.01, 0.02), std::slice::from_ref(&family), KNOWN)), (4.0, Some(4.0)));
        // The side that needs more decides.
        assert_eq!(bounds(speed_up(&point(0.5, 0.039, 0.0025), &[family], KNOWN)), (8.0, Some(8.0)));
    }

    #[test]
    fn the_meshes_that_were_run_bound_the_ratio() {
        let good = vec![point(10.0, 0.04, 0.04), point(20.0, 0.01, 0.01)];
        let just_misses = vec![point(1.0, 0.04, 0.04), point(2.0, 0.0101, 0.0101)];
        let run = point(1.0, 0.01, 0.01);
        assert_eq!(bounds(speed_up(&run, std::slice::from_ref(&good), KNOWN)), (20.0, Some(20.0)));
        assert_eq!(bounds(speed_up(&run, &[good.clone(), just_misses.clone()], KNOWN)), (2.0, Some(20.0)));
        assert_eq!(bounds(speed_up(&run, &[just_misses], KNOWN)), (2.0, None));
        // The coarsest mesh is better: a coarser one might be as good.
        assert_eq!(bounds(speed_up(&run, &[vec![point(10.0, 0.001, 0.001)]], KNOWN)), (0.0, Some(10.0)));
        // An error that no longer falls never comes there.
        let stuck = vec![point(0.5, 0.024, 0.01), point(0.7, 0.0235, 0.001)];
        assert_eq!(bounds(speed_up(&run, &[good, stuck.clone()], KNOWN)), (20.0, Some(20.0)));
        assert_eq!(speed_up(&run, &[stuck], KNOWN), None);
        assert_eq!(speed_up(&run, &[], KNOWN), None);
    }

    /// Errors below that of the reference are not told apart.
    #[test]
    fn nothing_is_better_than_the_reference() {
        let family = vec![point(1.0, 0.02, 0.02), point(3.0, 0.01, 0.0004)];
        let run = point(1.0, 0.01, 0.0001);
        assert_eq!(bounds(speed_up(&run, std::slice::from_ref(&family), KNOWN)), (3.0, None));
        assert_eq!(bounds(speed_up(&run, &[family], [Some(0.0005), Some(0.0005)])), (3.0, Some(3.0)));
    }

    /// Without an error behind the snap that the reference has: a mesh is passed over, and a run has no speed-up.
    #[test]
    fn what_has_not_snapped_is_not_compared() {
        let still = MeshPoint { wall_s: 1.0, errors: [Some(0.02), None] };
        let family = vec![still, point(4.0, 0.02, 0.02), point(5.0, 0.01, 0.01)];
        assert_eq!(bounds(speed_up(&point(1.0, 0.01, 0.01), std::slice::from_ref(&family), KNOWN)), (5.0, Some(5.0)));
        assert_eq!(speed_up(&still, std::slice::from_ref(&family), KNOWN), None);
        assert!(speed_up(&still, &[family], [Some(0.0), None]).is_some(), "where nothing snaps, one side is enough");
    }

    #[test]
    fn a_coarser_reference_tells_the_error_of_the_finer() {
        // Quartic, twice as fine: 63 times the error. Where both are alike nothing is gained.
        let quartic = [4, 4];
        assert_eq!(error_of_finer([Some(0.63), None], [16, 8], [8, 4], quartic), [Some(0.01), None]);
        assert_eq!(error_of_finer([Some(0.5), Some(0.1)], [16, 8], [16, 4], quartic), [Some(0.5), Some(0.1)]);
    }
}
