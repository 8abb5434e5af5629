//! Arrays of VTK's XML files: inline base64 (`format="binary"`), little-endian, compressed by zlib in blocks with their lengths in
//! front (VTK File Formats, "Compressed data"). Not-a-number survives, which ASCII arrays do not read back.

use std::fmt::Write as _;

use miniz_oxide::deflate::compress_to_vec_zlib;
use rayon::prelude::*;

/// How a file of an unstructured grid with such arrays begins.
pub(in crate::view) const OPENING: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
     byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n";

/// Bytes of a block before it is compressed, as VTK has them.
const BLOCK: usize = 1 << 15;
/// zlib's level: more takes longer, and saves next to nothing on numbers.
const LEVEL: u8 = 3;

/// One array, to be formatted as an element of XML.
#[derive(Debug)]
pub(in crate::view) struct XmlArray {
    kind: &'static str,
    attributes: String,
    unit: &'static str,
    bytes: Vec<u8>,
}

impl XmlArray {
    /// An array of the type `kind` with its bytes.
    pub(in crate::view) fn of_bytes(kind: &'static str, name: &str, bytes: impl Iterator<Item = u8>) -> Self {
        Self { kind, attributes: format!("Name=\"{name}\""), unit: "", bytes: bytes.collect() }
    }

    /// An array of floating-point numbers.
    pub(in crate::view) fn of_numbers(name: &str, numbers: impl Iterator<Item = f64>) -> Self {
        Self::of_bytes("Float64", name, numbers.flat_map(f64::to_le_bytes))
    }

    /// An array of numbers that are to be looked at: in single precision, but where that cannot hold one of them. What is no number
    /// stays so.
    pub(in crate::view) fn of_shown_numbers(name: &str, numbers: &[f64]) -> Self {
        let is_held = |number: &f64| *number == 0.0 || number.is_nan() || (*number as f32).is_normal();
        if numbers.iter().all(is_held) {
            Self::of_bytes("Float32", name, numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()))
        } else {
            Self::of_numbers(name, numbers.iter().copied())
        }
    }

    /// An array of indices.
    pub(in crate::view) fn of_indices(name: &str, indices: impl Iterator<Item = usize>) -> Self {
        Self::of_bytes("Int64", name, indices.flat_map(|index| (index as i64).to_le_bytes()))
    }

    /// A text, for field data.
    pub(in crate::view) fn of_text(name: &str, text: &str) -> Self {
        Self::of_texts(name, &[text])
    }

    /// Some texts, for field data.
    pub(in crate::view) fn of_texts(name: &str, texts: &[&str]) -> Self {
        let bytes = texts.iter().flat_map(|text| text.bytes().chain([0]));
        Self::of_bytes("String", name, bytes).tuples(texts.len())
    }

    /// The same array, of tuples with components of these names.
    pub(in crate::view) fn of_components(mut self, names: &[&str]) -> Self {
        let _ = write!(self.attributes, " NumberOfComponents=\"{}\"", names.len());
        for (index, name) in names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            let _ = write!(self.attributes, " ComponentName{index}=\"{name}\"");
        }
        self
    }

    /// The same array as field data, which says its number of tuples.
    pub(in crate::view) fn tuples(mut self, count: usize) -> Self {
        let _ = write!(self.attributes, " NumberOfTuples=\"{count}\"");
        self
    }

    /// The same array with the unit of its numbers.
    pub(in crate::view) fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Appends the element.
    pub(in crate::view) fn write(self, xml: &mut String) {
        let Self { kind, attributes, unit, bytes } = self;
        // Writing to a string does not fail.
        let _ = writeln!(xml, "<DataArray type=\"{kind}\" {attributes} format=\"binary\">\n{}", compressed(&bytes));
        if !unit.is_empty() {
            let key = "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">";
            let _ = writeln!(xml, "{key}{unit}</InformationKey>");
        }
        xml.push_str("</DataArray>\n");
    }
}

/// The number of blocks, their length, that of the last one where it is shorter (else 0) and their lengths when compressed, in
/// base64; then all of them, in base64 of their own.
fn compressed(bytes: &[u8]) -> String {
    let blocks: Vec<Vec<u8>> = bytes.par_chunks(BLOCK).map(|block| compress_to_vec_zlib(block, LEVEL)).collect();
    let lengths = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
    let front: Vec<u8> = lengths.flat_map(|length| (length as u64).to_le_bytes()).collect();
    base64(&front) + &base64(&blocks.concat())
}

/// RFC 4648, with padding.
pub(in crate::view) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().chain([&0, &0]).take(3).fold(0u32, |word, byte| word << 8 | u32::from(*byte));
        for place in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_rfc_4648() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn an_array_is_blocks_with_their_lengths_in_front() {
        let bytes: Vec<u8> = (0..2 * BLOCK + 5).map(|k| ((k * k) >> 7) as u8).collect();
        let text = compressed(&bytes);
        let front = base64(&[0; 8 * 6]).len();
        let decoded = |text: &str| {
            let digit =
                |c: u8| (b'A'..=b'Z').chain(b'a'..=b'z').chain(b'0'..=b'9').chain(*b"+/").position(|it| it == c);
            let bits: Vec<usize> = text.bytes().filter_map(digit).collect();
            bits.chunks(4)
                .flat_map(|four| {
                    let word = four.iter().fold(0, |word, bits| word << 6 | bits) << (6 * (4 - four.len()));
                    [word >> 16, word >> 8, word].into_iter().take(four.len() - 1).map(|byte| byte as u8)
                })
                .collect::<Vec<u8>>()
        };
        let lengths: Vec<usize> =
            decoded(&text[..front]).chunks(8).map(|it| u64::from_le_bytes(it.try_into().unwrap()) as usize).collect();
        assert_eq!(lengths[..3], [3, BLOCK, 5]);
        let mut rest = &decoded(&text[front..])[..];
        let mut found = Vec::new();
        for length in &lengths[3..] {
            let (block, others) = rest.split_at(*length);
            found.extend(miniz_oxide::inflate::decompress_to_vec_zlib(block).unwrap());
            rest = others;
        }
        assert!(rest.is_empty() && found == bytes);
    }

    #[test]
    fn numbers_that_are_shown_are_single_unless_one_does_not_fit() {
        let kind = |numbers: &[f64]| XmlArray::of_shown_numbers("a", numbers).kind;
        assert_eq!(
            [kind(&[0.0, -1e30, 1e-30]), kind(&[1.0, 1e39]), kind(&[1.0, 1e-42])],
            ["Float32", "Float64", "Float64"]
        );
    }
}
