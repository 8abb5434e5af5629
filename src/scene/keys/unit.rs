//! Units of keys.

/// The unit of a key's value, which is the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A word, a count or a plain number.
    None,
    /// Millimetres.
    Millimetre,
    /// Degrees.
    Degree,
    /// Megapascals, N/mm².
    Megapascal,
    /// Kilograms per cubic metre.
    KilogramPerCubicMetre,
    /// Newtons; of moments per length, N mm per mm.
    Newton,
    /// Newton millimetres.
    NewtonMillimetre,
    /// Kilograms.
    Kilogram,
    /// Newton millimetres per degree.
    NewtonMillimetrePerDegree,
    /// Newtons per millimetre.
    NewtonPerMillimetre,
    /// Newtons per square millimetre.
    NewtonPerSquareMillimetre,
    /// Metres per second squared.
    MetrePerSecondSquared,
    /// Kelvin.
    Kelvin,
    /// Per kelvin.
    PerKelvin,
    /// Per millimetre.
    PerMillimetre,
}

impl Unit {
    /// Those of the keys; a name that ends in two of them has the one that comes first.
    const ALL: [Unit; 14] = [
        Unit::NewtonMillimetrePerDegree,
        Unit::NewtonPerSquareMillimetre,
        Unit::NewtonPerMillimetre,
        Unit::PerMillimetre,
        Unit::PerKelvin,
        Unit::KilogramPerCubicMetre,
        Unit::MetrePerSecondSquared,
        Unit::NewtonMillimetre,
        Unit::Millimetre,
        Unit::Degree,
        Unit::Megapascal,
        Unit::Newton,
        Unit::Kelvin,
        Unit::Kilogram,
    ];

    /// The unit in which a name ends.
    pub(super) const fn of_name(name: &str) -> Self {
        let mut index = 0;
        while index < Self::ALL.len() {
            if ends_in(name.as_bytes(), Self::ALL[index].suffix().as_bytes()) {
                return Self::ALL[index];
            }
            index += 1;
        }
        Unit::None
    }

    /// The ending of names of keys with this unit.
    pub const fn suffix(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Millimetre => "mm",
            Unit::Degree => "deg",
            Unit::Megapascal => "mpa",
            Unit::KilogramPerCubicMetre => "kg_m3",
            Unit::Newton => "n",
            Unit::NewtonMillimetre => "n_mm",
            Unit::Kilogram => "kg",
            Unit::NewtonMillimetrePerDegree => "n_mm_per_deg",
            Unit::NewtonPerMillimetre => "n_per_mm",
            Unit::NewtonPerSquareMillimetre => "n_per_mm2",
            Unit::MetrePerSecondSquared => "m_s2",
            Unit::Kelvin => "k",
            Unit::PerKelvin => "per_k",
            Unit::PerMillimetre => "per_mm",
        }
    }

    /// The unit in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Millimetre => "mm",
            Unit::Degree => "degrees",
            Unit::Megapascal => "MPa",
            Unit::KilogramPerCubicMetre => "kg/m3",
            Unit::Newton => "N",
            Unit::NewtonMillimetre => "N mm",
            Unit::Kilogram => "kg",
            Unit::NewtonMillimetrePerDegree => "N mm per degree",
            Unit::NewtonPerMillimetre => "N/mm",
            Unit::NewtonPerSquareMillimetre => "N/mm2",
            Unit::MetrePerSecondSquared => "m/s2",
            Unit::Kelvin => "K",
            Unit::PerKelvin => "1/K",
            Unit::PerMillimetre => "1/mm",
        }
    }
}

/// Whether a name is some words, `_` and a suffix.
const fn ends_in(name: &[u8], suffix: &[u8]) -> bool {
    let Some(before) = name.len().checked_sub(suffix.len() + 1) else { return false };
    let mut index = 0;
    while index < suffix.len() {
        if name[before + 1 + index] != suffix[index] {
            return false;
        }
        index += 1;
    }
    name[before] == b'_'
}
