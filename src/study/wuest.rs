//! Bending of a tape spring at uniform longitudinal curvature, in closed form.
//!
//! W. Wuest, "Einige Anwendungen der Theorie der Zylinderschale", ZAMM 34 (1954) 444–454: a strip of arc length
//! s = R α and transverse curvature c is bent to the longitudinal curvature k; its cross-section deforms so that the
//! energy is least. With D = E t³ / 12(1−ν²), λ = [3(1−ν²)]^¼ s / √(t/k) and
//!
//! > F₁ = (2/λ)(cosh λ − cos λ)/(sinh λ + sin λ),   F₂ = F₁/4 − sinh λ sin λ/(sinh λ + sin λ)²,
//!
//! the moment is M = s D [k + ν c − ν (c + ν k) F₁ + (c + ν k)² F₂ / k], with c = +1/R where the bending is of opposite
//! sense and c = −1/R where it is of equal sense (k > 0 either way).
//!
//! Two rearrangements keep this accurate. Written with G = 1 − F₁, no large terms cancel:
//! M = s D [(1−ν²) k + ν (c + ν k) G + (c + ν k)² F₂ / k]. And as F₂ = −λ F₁′/4 = −k dF₁/dk / 2, M is the derivative
//! of the energy of a unit of length U = ½ s D [(1−ν²) k² + (c + ν k)² G], so areas under M need no quadrature.
//!
//! Fold moments: K. A. Seffen and S. Pellegrino, "Deployment dynamics of tape springs", Proc. R. Soc. A 455 (1999).

use super::section_shape::SectionShape;
use crate::scene::{Geometry, Material, Scene, Sense};

/// Curvatures searched for the first maximum and the minimum after it, in units of 1/R. A spring that has no maximum
/// before it is curved ten times more tightly than its own section has none.
const SEARCH_FROM: f64 = 1e-6;
const SEARCH_TO: f64 = 10.0;
const SEARCH_POINTS: usize = 600;

/// An open cylindrical shell, bent in one sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapeSpring {
    /// Length L, mm.
    pub length_mm: f64,
    /// Radius R of the mid-surface, mm.
    pub radius_mm: f64,
    /// Angle α of the whole arc, radians.
    pub arc_rad: f64,
    /// Thickness t, mm.
    pub thickness_mm: f64,
    /// Young's modulus E, MPa.
    pub youngs_modulus_mpa: f64,
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Sense of the bending.
    pub sense: Sense,
}

/// The first maximum of the moment under uniform curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Moment, N·mm.
    pub moment_n_mm: f64,
    /// Rotation of each end, degrees.
    pub parameter: f64,
    /// Longitudinal curvature, 1/mm.
    pub curvature_per_mm: f64,
}

/// The equal-energy (Maxwell) construction on the moment–curvature curve: the moment at which an almost straight part
/// and a fold stand side by side, and a bit of the one turns into the other at no cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// Moment, N·mm.
    pub moment_n_mm: f64,
    /// Curvature of the almost straight part, 1/mm.
    pub straight_curvature_per_mm: f64,
    /// Curvature of the fold, 1/mm.
    pub fold_curvature_per_mm: f64,
}

/// The moments of a fold with a flat section and the radius of the section along its length (Seffen & Pellegrino 1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldMoments {
    /// Opposite sense: (1+ν) D α, N·mm.
    pub opposite_n_mm: f64,
    /// Equal sense: (1−ν) D α, N·mm.
    pub equal_n_mm: f64,
}

impl TapeSpring {
    /// The tape spring with turning ends that a scene describes, whatever part of it the scene models; `None` for other
    /// scenes and materials, for which these laws do not hold.
    pub fn of_scene(scene: &Scene) -> Option<Self> {
        let Geometry::TapeSpring { length_mm, radius_mm, arc_deg } = scene.geometry else { return None };
        let Material::Isotropic { youngs_modulus_mpa, poissons_ratio, thickness_mm, .. } = scene.material else {
            return None;
        };
        Some(Self {
            length_mm,
            radius_mm,
            arc_rad: arc_deg.to_radians(),
            thickness_mm,
            youngs_modulus_mpa,
            poissons_ratio,
            sense: scene.end_rotation()?.sense,
        })
    }

    /// Bending stiffness of the shell D = E t³ / 12(1−ν²), N·mm.
    pub fn bending_stiffness_n_mm(&self) -> f64 {
        self.youngs_modulus_mpa * self.thickness_mm.powi(3) / (12.0 * (1.0 - self.poissons_ratio.powi(2)))
    }

    /// Second moment of area of the undeformed section about its transverse centroidal axis,
    /// I = R³ t [(α + sin α)/2 − 4 sin²(α/2)/α], mm⁴.
    pub fn second_moment_mm4(&self) -> f64 {
        let alpha = self.arc_rad;
        let bracket = (alpha + alpha.sin()) / 2.0 - 4.0 * (alpha / 2.0).sin().powi(2) / alpha;
        self.radius_mm.powi(3) * self.thickness_mm * bracket
    }

    /// dM/dθ of the undeformed beam, 2 E I / L, N·mm per radian of each end. Beam theory, not Wuest's law: that takes
    /// the section for a parabola, which for a deep arc is stiffer.
    pub fn initial_stiffness_n_mm(&self) -> f64 {
        2.0 * self.youngs_modulus_mpa * self.second_moment_mm4() / self.length_mm
    }

    /// Uniform curvature 2 θ / L when each end has turned by `parameter` degrees, 1/mm.
    pub fn curvature_at_rotation(&self, parameter: f64) -> f64 {
        2.0 * parameter.to_radians() / self.length_mm
    }

    /// Moment of Wuest's law at the longitudinal curvature `k` ≥ 0 in 1/mm, N·mm.
    pub fn moment_at_curvature(&self, k: f64) -> f64 {
        if k == 0.0 {
            return 0.0;
        }
        let nu = self.poissons_ratio;
        let SectionShape { g, f2 } = SectionShape::at(self.lambda(k));
        let turned = self.section_curvature() + nu * k;
        self.width_stiffness() * ((1.0 - nu * nu) * k + nu * turned * g + turned * turned * f2 / k)
    }

    /// Strain energy of a unit of length in Wuest's law at the longitudinal curvature `k` ≥ 0 in 1/mm, N·mm/mm: the
    /// integral of the moment over the curvature.
    pub fn energy_at_curvature(&self, k: f64) -> f64 {
        let nu = self.poissons_ratio;
        let SectionShape { g, .. } = SectionShape::at(self.lambda(k));
        let turned = self.section_curvature() + nu * k;
        0.5 * self.width_stiffness() * ((1.0 - nu * nu) * k * k + turned * turned * g)
    }

    /// Moment of Wuest's law when each end has turned by `parameter` ≥ 0 degrees and the curvature is uniform, N·mm.
    pub fn moment_at_rotation(&self, parameter: f64) -> f64 {
        self.moment_at_curvature(self.curvature_at_rotation(parameter))
    }

    /// The first maximum of Wuest's law; `None` where the moment only rises (shallow or thick sections).
    pub fn peak(&self) -> Option<Peak> {
        let (k, _) = self.first_extremes()?;
        Some(Peak {
            moment_n_mm: self.moment_at_curvature(k),
            parameter: (k * self.length_mm / 2.0).to_degrees(),
            curvature_per_mm: k,
        })
    }

    /// The equal-energy plateau of Wuest's law; `None` where the law has no maximum, so that nothing folds.
    ///
    /// The moment M* with M(k₁) = M(k₂) = M* on the two rising branches and U(k₂) − U(k₁) = M* (k₂ − k₁).
    pub fn plateau(&self) -> Option<Plateau> {
        let (crest, trough) = self.first_extremes()?;
        let (mut low, mut high) = (self.moment_at_curvature(trough), self.moment_at_curvature(crest));
        let mut far = trough;
        while self.moment_at_curvature(far) < high {
            far *= 2.0;
        }
        let branches = |moment: f64| {
            let rises = |k: f64| self.moment_at_curvature(k) < moment;
            (bisect(0.0, crest, rises), bisect(trough, far, rises))
        };
        let (mut straight, mut fold) = (0.0, trough);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            (straight, fold) = branches(middle);
            let gained = self.energy_at_curvature(fold) - self.energy_at_curvature(straight);
            if gained > middle * (fold - straight) { low = middle } else { high = middle }
        }
        Some(Plateau {
            moment_n_mm: 0.5 * (low + high),
            straight_curvature_per_mm: straight,
            fold_curvature_per_mm: fold,
        })
    }

    /// The moments of folds of either sense, (1 ± ν) D α.
    pub fn fold_moments(&self) -> FoldMoments {
        let scale = self.bending_stiffness_n_mm() * self.arc_rad;
        FoldMoments {
            opposite_n_mm: (1.0 + self.poissons_ratio) * scale,
            equal_n_mm: (1.0 - self.poissons_ratio) * scale,
        }
    }

    /// The fold moment of this spring's own sense, N·mm.
    pub fn fold_moment_n_mm(&self) -> f64 {
        let moments = self.fold_moments();
        match self.sense {
            Sense::Opposite => moments.opposite_n_mm,
            Sense::Equal => moments.equal_n_mm,
        }
    }

    /// c, 1/mm: positive where the bending is of opposite sense.
    fn section_curvature(&self) -> f64 {
        match self.sense {
            Sense::Opposite => 1.0 / self.radius_mm,
            Sense::Equal => -1.0 / self.radius_mm,
        }
    }

    /// s D, N·mm².
    fn width_stiffness(&self) -> f64 {
        self.radius_mm * self.arc_rad * self.bending_stiffness_n_mm()
    }

    /// λ at curvature `k`.
    fn lambda(&self, k: f64) -> f64 {
        let width = self.radius_mm * self.arc_rad;
        (3.0 * (1.0 - self.poissons_ratio.powi(2))).powf(0.25) * width * (k / self.thickness_mm).sqrt()
    }

    /// Curvatures of the first maximum and of the first minimum after it.
    fn first_extremes(&self) -> Option<(f64, f64)> {
        let ratio = (SEARCH_TO / SEARCH_FROM).powf(1.0 / SEARCH_POINTS as f64);
        let at = |i: i32| SEARCH_FROM / self.radius_mm * ratio.powi(i);
        let moment = |k: f64| self.moment_at_curvature(k);
        let turns = |from: i32, sign: f64| {
            (from..SEARCH_POINTS as i32).find(|&i| {
                let here = sign * moment(at(i));
                here > sign * moment(at(i - 1)) && here >= sign * moment(at(i + 1))
            })
        };
        let crest = turns(1, 1.0)?;
        let trough = turns(crest + 1, -1.0)?;
        let refine = |i: i32, sign: f64| golden_section(at(i - 1), at(i + 1), |k| sign * moment(k));
        Some((refine(crest, 1.0), refine(trough, -1.0)))
    }
}

/// Halvings that take any bracket to the last bit.
const BISECTIONS: usize = 100;

/// The place in [low, high] up to which `holds` is true.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The maximum of a function with one maximum in [low, high].
fn golden_section(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = (5f64.sqrt() - 1.0) / 2.0;
    for _ in 0..BISECTIONS {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if f(left) < f(right) { low = left } else { high = right }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn baseline(sense: Sense) -> TapeSpring {
        TapeSpring {
            length_mm: 300.0,
            radius_mm: 10.0,
            arc_rad: 110f64.to_radians(),
            thickness_mm: 0.1,
            youngs_modulus_mpa: 131e3,
            poissons_ratio: 0.3,
            sense,
        }
    }

    #[track_caller]
    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
    }

    #[test]
    fn baseline_has_the_published_numbers() {
        let spring = baseline(Sense::Opposite);
        close(spring.initial_stiffness_n_mm(), 2771.9, 0.05);
        let peak = spring.peak().unwrap();
        close(peak.moment_n_mm, 287.9, 0.05);
        close(peak.parameter, 9.27, 0.005);
        close(spring.fold_moments().opposite_n_mm, 29.94, 0.005);
        close(spring.fold_moments().equal_n_mm, 16.12, 0.005);
        close(spring.plateau().unwrap().moment_n_mm, 28.31, 0.005);
    }

    #[test]
    fn moment_is_the_derivative_of_the_energy() {
        for sense in [Sense::Opposite, Sense::Equal] {
            let spring = baseline(sense);
            for k in [1e-6, 1e-4, 1e-3, 0.01, 0.1, 1.0] {
                let step = 1e-4 * k;
                let slope =
                    (spring.energy_at_curvature(k + step) - spring.energy_at_curvature(k - step)) / (2.0 * step);
                close(slope / spring.moment_at_curvature(k), 1.0, 1e-7);
            }
        }
    }

    #[test]
    fn small_curvature_has_its_limit() {
        let spring = baseline(Sense::Opposite);
        // F₂ → λ⁴/180, so M → k [E t³ s/12 + E t s⁵/(720 R²)]: the section taken for a parabola.
        let width = spring.radius_mm * spring.arc_rad;
        let second_moment =
            spring.thickness_mm * width.powi(5) / (720.0 * 100.0) + width * spring.thickness_mm.powi(3) / 12.0;
        for k in [1e-14, 1e-11, 1e-8] {
            let ratio = spring.moment_at_curvature(k) / (spring.youngs_modulus_mpa * second_moment * k);
            close(ratio, 1.0, 1e-4);
        }
        assert_eq!(spring.moment_at_curvature(0.0), 0.0);
    }

    #[test]
    fn extreme_curvature_stays_finite() {
        assert!(baseline(Sense::Equal).moment_at_curvature(1e6).is_finite());
    }

    #[test]
    fn equal_sense_folds_at_a_lower_moment() {
        let [opposite, equal] = [Sense::Opposite, Sense::Equal].map(|sense| baseline(sense).plateau().unwrap());
        assert!(equal.moment_n_mm < opposite.moment_n_mm);
        close(equal.moment_n_mm, baseline(Sense::Equal).fold_moment_n_mm(), 2.0);
    }

    #[test]
    fn plateau_cuts_off_equal_areas() {
        let spring = baseline(Sense::Opposite);
        let plateau = spring.plateau().unwrap();
        let (from, to) = (plateau.straight_curvature_per_mm, plateau.fold_curvature_per_mm);
        // Midpoint rule in log k: the peak is narrow beside the fold's curvature.
        let parts = 200_000;
        let width = (to / from).ln() / f64::from(parts);
        let area: f64 = (0..parts)
            .map(|i| {
                let k = from * (width * (f64::from(i) + 0.5)).exp();
                (spring.moment_at_curvature(k) - plateau.moment_n_mm) * k * width
            })
            .sum();
        close(area / (plateau.moment_n_mm * to), 0.0, 1e-7);
    }

    #[test]
    fn a_thick_shallow_section_has_no_peak_and_no_plateau() {
        let spring = TapeSpring { arc_rad: 0.3, thickness_mm: 2.0, ..baseline(Sense::Opposite) };
        assert_eq!(spring.peak(), None);
        assert_eq!(spring.plateau(), None);
    }
}
