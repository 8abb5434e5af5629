//! Arrays of VTK's XML files: inline base64 (`format="binary"`) with a 64-bit length in front, little-endian, uncompressed: exact,
//! and not-a-number survives, which ASCII arrays do not read back.

use std::fmt::Write as _;

/// One array, to be formatted as an element of XML.
#[derive(Debug)]
pub(in crate::view) struct XmlArray {
    kind: &'static str,
    attributes: String,
    unit: &'static str,
    /// A 64-bit length and as many bytes.
    framed: Vec<u8>,
}

impl XmlArray {
    /// An array of the type `kind` with its bytes.
    pub(in crate::view) fn of_bytes(kind: &'static str, name: &str, bytes: impl Iterator<Item = u8>) -> Self {
        let mut framed = vec![0; 8];
        framed.extend(bytes);
        let length = framed.len() as u64 - 8;
        framed[..8].copy_from_slice(&length.to_le_bytes());
        Self { kind, attributes: format!("Name=\"{name}\""), unit: "", framed }
    }

    /// An array of floating-point numbers.
    pub(in crate::view) fn of_numbers(name: &str, numbers: impl Iterator<Item = f64>) -> Self {
        Self::of_bytes("Float64", name, numbers.flat_map(f64::to_le_bytes))
    }

    /// An array of indices.
    pub(in crate::view) fn of_indices(name: &str, indices: impl Iterator<Item = usize>) -> Self {
        Self::of_bytes("Int64", name, indices.flat_map(|index| (index as i64).to_le_bytes()))
    }

    /// A text, for field data.
    pub(in crate::view) fn of_text(name: &str, text: &str) -> Self {
        Self::of_bytes("String", name, text.bytes().chain([0])).tuples(1)
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
        let Self { kind, attributes, unit, framed } = self;
        // Writing to a string does not fail.
        let _ = write!(xml, "<DataArray type=\"{kind}\" {attributes} format=\"binary\">\n{}\n", base64(&framed));
        if !unit.is_empty() {
            let key = "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">";
            let _ = writeln!(xml, "{key}{unit}</InformationKey>");
        }
        xml.push_str("</DataArray>\n");
    }
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
    fn an_array_has_its_length_in_front() {
        let mut xml = String::new();
        XmlArray::of_indices("offsets", [4, 6].into_iter()).write(&mut xml);
        let bytes: Vec<u8> = [16u64, 4, 6].iter().flat_map(|v| v.to_le_bytes()).collect();
        let text = base64(&bytes);
        assert_eq!(
            xml,
            format!("<DataArray type=\"Int64\" Name=\"offsets\" format=\"binary\">\n{text}\n</DataArray>\n")
        );
    }
}
