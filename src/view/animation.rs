//! The mesh over the load steps as an animated GIF: one view, one range of colours, one palette.

use std::borrow::Cow;
use std::collections::HashMap;

use color_quant::NeuQuant;
use gif::{Encoder, Frame, Repeat};
use rayon::prelude::*;

use super::mesh_picture::{Picture, View, mesh_drawing};
use super::raster::{Raster, raster};
use super::samples::SurfaceSamples;
use super::ticks::in_view;

/// Why an animation could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// No frame, or one without a pixel.
    #[error("there is nothing to animate")]
    Nothing,
    /// The encoder gave up.
    #[error("the animation could not be written")]
    Encoding(#[from] gif::EncodingError),
}

/// Hundredths of a second that a frame is shown, and the last one.
const DELAY: u16 = 12;
const LAST_DELAY: u16 = 150;
/// Colours of a GIF.
const COLOURS: usize = 256;
/// Frames that the palette is chosen by.
const JUDGED: usize = 6;
/// Frames that are drawn at a time.
const BATCH: usize = 16;
/// One pixel in this many is looked at for the palette.
const SAMPLING: i32 = 10;

/// Draws surfaces one after another, each with its picture, as a GIF that repeats. The size and the direction are those of the
/// first picture; the colours span the values of all.
///
/// # Errors
/// Where there is no frame.
pub fn mesh_animation(frames: &[(SurfaceSamples, Picture)]) -> Result<Vec<u8>, AnimationError> {
    let shown = || frames.iter().map(|(samples, picture)| (samples, picture));
    let view = View::of(shown());
    let ranges = frames.iter().filter_map(|(samples, _)| samples.value_range());
    let range = ranges.reduce(|[low, high], [least, largest]| [low.min(least), high.max(largest)]).map(in_view);
    let pixels = |(samples, picture): &(SurfaceSamples, Picture)| {
        let picture = Picture { value_range: range, ..picture.clone() };
        raster(&mesh_drawing(samples, &picture, &view)).ok_or(AnimationError::Nothing)
    };
    let stride = frames.len().div_ceil(JUDGED).max(1);
    let judged = frames.iter().rev().step_by(stride).map(|frame| Ok(pixels(frame)?.pixels));
    let mut palette = Palette::of(&judged.collect::<Result<Vec<_>, AnimationError>>()?.concat());

    let first = pixels(frames.first().ok_or(AnimationError::Nothing)?)?;
    let [width, height] = first.size.map(|length| u16::try_from(length).unwrap_or(u16::MAX));
    let mut encoder = Encoder::new(Vec::new(), width, height, &palette.colours)?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut left = frames.len();
    for batch in frames.chunks(BATCH) {
        for Raster { pixels, .. } in batch.par_iter().map(pixels).collect::<Result<Vec<_>, _>>()? {
            left -= 1;
            let delay = if left == 0 { LAST_DELAY } else { DELAY };
            let buffer =
                Cow::Owned(pixels.chunks_exact(4).map(|pixel| palette.index([pixel[0], pixel[1], pixel[2]])).collect());
            encoder.write_frame(&Frame { width, height, delay, buffer, ..Frame::default() })?;
        }
    }
    Ok(encoder.into_inner()?)
}

/// The colours of all frames.
struct Palette {
    nearest: NeuQuant,
    colours: Vec<u8>,
    /// Colours that were looked up before.
    known: HashMap<[u8; 3], u8>,
}

impl Palette {
    /// Chosen by pixels of four bytes.
    fn of(pixels: &[u8]) -> Self {
        const WHITE: [u8; 3] = [255; 3];
        let nearest = NeuQuant::new(SAMPLING, COLOURS, pixels);
        let mut palette = Self { colours: nearest.color_map_rgb(), nearest, known: HashMap::new() };
        // The sheet is white, and not nearly so.
        let white = usize::from(palette.index(WHITE));
        palette.colours[3 * white..3 * white + 3].copy_from_slice(&WHITE);
        palette
    }

    fn index(&mut self, [red, green, blue]: [u8; 3]) -> u8 {
        let nearest = &self.nearest;
        *self.known.entry([red, green, blue]).or_insert_with(|| nearest.index_of(&[red, green, blue, 255]) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of paper that rises.
    fn frame(height: f64) -> (SurfaceSamples, Picture) {
        let points = (0..3).flat_map(|i| [0.0, 2.0].map(|y| [f64::from(i), y, height * f64::from(i)])).collect();
        let samples = SurfaceSamples::new([3, 2], points, vec![height, 2.0 * height], vec![], "height (mm)").unwrap();
        (samples, Picture { width: 480, title: format!("height {height}"), ..Picture::default() })
    }

    #[test]
    fn every_frame_is_there_in_one_size_on_white() {
        let bytes = mesh_animation(&[0.0, 0.5, 1.0].map(frame)).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let size = [decoder.width(), decoder.height()];
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!([frame.width, frame.height], size);
            assert_eq!(frame.buffer[..3], [255; 3]);
            assert!(frame.buffer.chunks(4).any(|pixel| pixel[0] < 100), "something is drawn");
            delays.push(frame.delay);
        }
        assert_eq!((size[0], delays), (480, vec![DELAY, DELAY, LAST_DELAY]));
        assert!(matches!(mesh_animation(&[]), Err(AnimationError::Nothing)));
    }
}
