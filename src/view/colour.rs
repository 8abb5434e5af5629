//! Viridis: a colour map that is perceptually uniform, and ordered in grey and for the colour-blind too
//! (S. van der Walt and N. Smith, for matplotlib, 2015; CC0).

/// Sixteen equidistant colours of the map; between them linear in sRGB, which is off by less than 2 of 255.
pub(super) const VIRIDIS: [u32; 16] = [
    0x44_01_54, 0x48_1a_6c, 0x47_2f_7d, 0x41_44_87, 0x39_56_8c, 0x31_68_8e, 0x2a_78_8e, 0x23_88_8e, 0x1f_98_8b,
    0x22_a8_84, 0x35_b7_79, 0x54_c5_68, 0x7a_d1_51, 0xa5_db_36, 0xd2_e2_1b, 0xfd_e7_25,
];

/// A colour, each channel from 0 to 1, sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour(pub(super) [f64; 3]);

impl Colour {
    /// For cells without a value.
    pub(super) const NONE: Colour = Colour([0.75, 0.75, 0.75]);
    pub(super) const INK: Colour = Colour([0.102, 0.102, 0.102]);
    pub(super) const WHITE: Colour = Colour([1.0, 1.0, 1.0]);
    /// Of the shell as it was.
    pub(super) const GREY: Colour = Colour([0.45, 0.45, 0.45]);
    /// Of loads, and of motions that supports are given; neither is in the map.
    pub(super) const LOAD: Colour = Colour([0.85, 0.16, 0.11]);
    pub(super) const MOTION: Colour = Colour([0.93, 0.47, 0.0]);

    /// The colour of `fraction`, from 0 to 1; beyond, the end colours.
    pub(super) fn viridis(fraction: f64) -> Self {
        if !fraction.is_finite() {
            return Self::NONE;
        }
        let place = fraction.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
        let below = (place as usize).min(VIRIDIS.len() - 2);
        let part = place - below as f64;
        let channel = |colour: u32, shift: u32| f64::from(colour >> shift & 0xff) / 255.0;
        Self(
            [16, 8, 0]
                .map(|shift| (1.0 - part) * channel(VIRIDIS[below], shift) + part * channel(VIRIDIS[below + 1], shift)),
        )
    }

    /// The colour under `light` from 0 (darkest) to 1 (as it is).
    pub(super) fn lit(self, light: f64) -> Self {
        const DARKEST: f64 = 0.35;
        Self(self.0.map(|channel| channel * (1.0 - DARKEST * (1.0 - light.clamp(0.0, 1.0)))))
    }

    /// Perceived lightness from 0 to 1 (Rec. 709 weights on sRGB values: good enough to choose ink by).
    pub(super) fn lightness(self) -> f64 {
        let [red, green, blue] = self.0;
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    /// Red, green and blue from 0 to 255.
    pub(super) fn bytes(self) -> [u8; 3] {
        self.0.map(|channel| (channel * 255.0).round() as u8)
    }

    /// As `#rrggbb`.
    pub(super) fn hex(self) -> String {
        let [red, green, blue] = self.bytes();
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::Colour;

    #[test]
    fn ends_and_beyond() {
        assert_eq!(Colour::viridis(0.0).hex(), "#440154");
        assert_eq!(Colour::viridis(-3.0).hex(), "#440154");
        assert_eq!(Colour::viridis(1.0).hex(), "#fde725");
        assert_eq!(Colour::viridis(9.0).hex(), "#fde725");
        assert_eq!(Colour::viridis(f64::NAN), Colour::NONE);
    }

    #[test]
    fn lightness_rises_all_the_way() {
        let lightness: Vec<f64> = (0..=100).map(|i| Colour::viridis(f64::from(i) / 100.0).lightness()).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
