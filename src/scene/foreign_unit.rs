//! Units that people write where a key wants another: `length_m` for `length_mm`, `"0.3 m"` for `300.0`.

use super::keys::Unit;

/// A unit that no key of a scene ends in.
#[derive(Debug)]
pub(super) struct ForeignUnit {
    /// Spellings, in lower case.
    spellings: &'static [&'static str],
    /// The unit in a sentence.
    pub words: &'static str,
    /// The unit that scenes use.
    unit: Unit,
    /// How many of the scene's unit it is.
    factor: f64,
}

const fn foreign(spellings: &'static [&'static str], words: &'static str, unit: Unit, factor: f64) -> ForeignUnit {
    ForeignUnit { spellings, words, unit, factor }
}

static FOREIGN_UNITS: [ForeignUnit; 49] = [
    foreign(&["mm", "millimetre", "millimetres", "millimeter", "millimeters"], "mm", Unit::Millimetre, 1.0),
    foreign(&["cm", "centimetre", "centimetres", "centimeter", "centimeters"], "cm", Unit::Millimetre, 10.0),
    foreign(&["m", "metre", "metres", "meter", "meters"], "m", Unit::Millimetre, 1000.0),
    foreign(
        &["um", "µm", "μm", "micron", "microns", "micrometre", "micrometer"],
        "micrometres",
        Unit::Millimetre,
        1e-3,
    ),
    foreign(&["nm", "nanometre", "nanometer"], "nm", Unit::Millimetre, 1e-6),
    foreign(&["in", "inch", "inches"], "inches", Unit::Millimetre, 25.4),
    foreign(&["mil", "mils", "thou"], "mils", Unit::Millimetre, 0.0254),
    foreign(&["ft", "foot", "feet"], "feet", Unit::Millimetre, 304.8),
    foreign(&["deg", "degree", "degrees", "°"], "degrees", Unit::Degree, 1.0),
    foreign(&["rad", "radian", "radians"], "radians", Unit::Degree, 180.0 / std::f64::consts::PI),
    foreign(&["mrad", "milliradian", "milliradians"], "mrad", Unit::Degree, 0.18 / std::f64::consts::PI),
    foreign(&["turn", "turns", "rev", "revolutions"], "turns", Unit::Degree, 360.0),
    foreign(&["gon", "grad", "grads"], "gon", Unit::Degree, 0.9),
    foreign(&["mpa", "n_mm2", "n_per_mm2", "n/mm2", "n/mm²", "megapascal"], "MPa", Unit::Megapascal, 1.0),
    foreign(&["pa", "pascal", "pascals", "n_m2", "n/m2", "n/m²"], "Pa", Unit::Megapascal, 1e-6),
    foreign(&["kpa", "kilopascal"], "kPa", Unit::Megapascal, 1e-3),
    foreign(&["gpa", "gigapascal", "kn_mm2", "kn/mm2", "kn/mm²"], "GPa", Unit::Megapascal, 1e3),
    foreign(&["tpa", "terapascal"], "TPa", Unit::Megapascal, 1e6),
    foreign(&["bar"], "bar", Unit::Megapascal, 0.1),
    foreign(&["psi"], "psi", Unit::Megapascal, 0.006_894_757_293_168_361),
    foreign(&["ksi"], "ksi", Unit::Megapascal, 6.894_757_293_168_361),
    foreign(&["kg_m3", "kg_per_m3", "kg/m3", "kg/m³"], "kg/m3", Unit::KilogramPerCubicMetre, 1.0),
    foreign(&["g_cm3", "g_per_cm3", "g/cm3", "g/cm³"], "g/cm3", Unit::KilogramPerCubicMetre, 1e3),
    foreign(&["kg_mm3", "kg_per_mm3", "kg/mm3", "kg/mm³"], "kg/mm3", Unit::KilogramPerCubicMetre, 1e9),
    foreign(&["t_mm3", "t_per_mm3", "t/mm3", "t/mm³"], "t/mm3", Unit::KilogramPerCubicMetre, 1e12),
    foreign(&["n", "newton", "newtons"], "N", Unit::Newton, 1.0),
    foreign(&["mn", "millinewton"], "mN", Unit::Newton, 1e-3),
    foreign(&["kn", "kilonewton"], "kN", Unit::Newton, 1e3),
    foreign(&["lbf", "lb"], "lbf", Unit::Newton, 4.448_221_615_260_5),
    foreign(&["g", "gram", "grams"], "g", Unit::Kilogram, 1e-3),
    foreign(&["t", "tonne", "tonnes"], "t", Unit::Kilogram, 1e3),
    foreign(
        &["n_mm_per_rad", "n_mm_rad", "n mm/rad", "n·mm/rad"],
        "N mm per radian",
        Unit::NewtonMillimetrePerDegree,
        std::f64::consts::PI / 180.0,
    ),
    foreign(
        &["n_m_per_rad", "n_m_rad", "n m/rad", "n·m/rad"],
        "N m per radian",
        Unit::NewtonMillimetrePerDegree,
        1e3 * std::f64::consts::PI / 180.0,
    ),
    foreign(&["n_mm", "n/mm"], "N/mm", Unit::NewtonPerMillimetre, 1.0),
    foreign(&["n_m", "n_per_m", "n/m"], "N/m", Unit::NewtonPerMillimetre, 1e-3),
    foreign(&["kn_m", "kn_per_m", "kn/m"], "kN/m", Unit::NewtonPerMillimetre, 1.0),
    foreign(&["kn_mm", "kn_per_mm", "kn/mm"], "kN/mm", Unit::NewtonPerMillimetre, 1e3),
    foreign(&["mpa", "n_mm2", "n/mm2"], "N/mm2", Unit::NewtonPerSquareMillimetre, 1.0),
    foreign(&["pa", "n_m2", "n_per_m2", "n/m2"], "N/m2", Unit::NewtonPerSquareMillimetre, 1e-6),
    foreign(&["kpa", "kn_m2", "kn_per_m2", "kn/m2"], "kN/m2", Unit::NewtonPerSquareMillimetre, 1e-3),
    foreign(&["kn_mm2", "kn_per_mm2", "kn/mm2"], "kN/mm2", Unit::NewtonPerSquareMillimetre, 1e3),
    foreign(&["m_s2", "m_per_s2", "m/s2", "m/s²"], "m/s2", Unit::MetrePerSecondSquared, 1.0),
    foreign(&["mm_s2", "mm_per_s2", "mm/s2"], "mm/s2", Unit::MetrePerSecondSquared, 1e-3),
    foreign(&["k", "kelvin", "c", "celsius", "deg_c"], "K", Unit::Kelvin, 1.0),
    foreign(&["f", "fahrenheit", "deg_f"], "degrees Fahrenheit", Unit::Kelvin, 5.0 / 9.0),
    foreign(&["per_c", "per_celsius", "1/k", "1_k"], "1/K", Unit::PerKelvin, 1.0),
    foreign(&["ppm_per_k", "ppm_k", "um_m_k"], "ppm/K", Unit::PerKelvin, 1e-6),
    foreign(&["1_mm", "1/mm"], "1/mm", Unit::PerMillimetre, 1.0),
    foreign(&["per_m", "1_m", "1/m"], "1/m", Unit::PerMillimetre, 1e-3),
];

/// Significant digits that a converted value keeps, so that 0.007 m is 7 mm and not 7.000000000000001.
const CONVERTED_DIGITS: usize = 12;

/// Bytes beyond which a text is not looked at as a number with a unit.
const LONGEST_QUANTITY: usize = 64;

impl ForeignUnit {
    /// Finds the unit of this spelling that measures the same quantity as `unit`.
    pub fn find(spelling: &str, unit: Unit) -> Option<&'static ForeignUnit> {
        let spelling = spelling.to_lowercase();
        FOREIGN_UNITS.iter().find(|foreign| foreign.unit == unit && foreign.spellings.contains(&&*spelling))
    }

    /// Converts a value in this unit to the unit of the scene.
    pub fn convert(&self, value: f64) -> f64 {
        let digits = CONVERTED_DIGITS - 1;
        format!("{:.digits$e}", value * self.factor).parse().unwrap_or(value * self.factor)
    }
}

/// Reads `"0.3 m"` as a number with a unit (or without one) where a key of `unit` wants a number.
pub(super) fn quantity(text: &str, unit: Unit) -> Option<f64> {
    let text = text.trim();
    if text.len() > LONGEST_QUANTITY {
        return None;
    }
    if let Ok(value) = text.parse::<f64>() {
        return Some(value);
    }
    // The unit is what remains after the longest front that is a number.
    let ends = text.char_indices().map(|(at, _)| at).rev();
    let (value, rest) = ends.filter_map(|at| Some((text[..at].trim_end().parse::<f64>().ok()?, &text[at..]))).next()?;
    Some(ForeignUnit::find(rest.trim(), unit)?.convert(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_are_exact_to_the_digits_that_a_user_sees() {
        let convert = |spelling, unit, value| ForeignUnit::find(spelling, unit).map(|foreign| foreign.convert(value));
        assert_eq!(convert("m", Unit::Millimetre, 0.007), Some(7.0));
        assert_eq!(convert("GPa", Unit::Megapascal, 131.0), Some(131_000.0));
        assert_eq!(convert("rad", Unit::Degree, std::f64::consts::FRAC_PI_4), Some(45.0));
        assert_eq!(convert("um", Unit::Millimetre, 100.0), Some(0.1));
        assert_eq!(convert("m", Unit::Degree, 1.0), None);
    }

    #[test]
    fn quantities_are_read_with_and_without_a_unit() {
        assert_eq!(quantity("300", Unit::Millimetre), Some(300.0));
        assert_eq!(quantity(" 30 cm ", Unit::Millimetre), Some(300.0));
        assert_eq!(quantity("1e-4m", Unit::Millimetre), Some(0.1));
        assert_eq!(quantity("110°", Unit::Degree), Some(110.0));
        assert_eq!(quantity("long", Unit::Millimetre), None);
        assert_eq!(quantity("", Unit::Millimetre), None);
    }
}
