//! Columns of numbers in few bytes: the smallest integers that hold them, packed, as text.
use std::io::Write as _;

use flate2::{Compression, write::DeflateEncoder};
use serde_json::{Value, json};

/// Columns begin at multiples of this many bytes, so that they can be looked at where they are.
const ALIGNMENT: usize = 8;

/// Named columns, one behind the other, little-endian.
#[derive(Debug, Default)]
pub(super) struct Columns {
    bytes: Vec<u8>,
    list: Vec<Value>,
}

impl Columns {
    /// Whole numbers.
    pub(super) fn whole(&mut self, name: &str, values: impl IntoIterator<Item = i64>) {
        let values: Vec<i64> = values.into_iter().collect();
        self.integers(name, &values, false);
    }

    /// Whole numbers of which neighbours differ by little: each less the one before it, the first as it is.
    pub(super) fn steps(&mut self, name: &str, values: impl IntoIterator<Item = i64>) {
        let mut last = 0;
        let step = |value: i64| value.wrapping_sub(std::mem::replace(&mut last, value));
        let steps: Vec<i64> = values.into_iter().map(step).collect();
        self.integers(name, &steps, true);
    }

    /// Numbers in single precision.
    pub(super) fn single(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        let values: Vec<[u8; 4]> = values.into_iter().map(|value| (value as f32).to_le_bytes()).collect();
        self.column(name, "f32", values.as_flattened(), values.len(), false);
    }

    fn integers(&mut self, name: &str, values: &[i64], steps: bool) {
        let fits = |low: i64, high: i64| values.iter().all(|value| (low..=high).contains(value));
        // A cast keeps what fits.
        if fits(i8::MIN.into(), i8::MAX.into()) {
            let bytes: Vec<u8> = values.iter().map(|value| *value as u8).collect();
            self.column(name, "i8", &bytes, values.len(), steps);
        } else if fits(i16::MIN.into(), i16::MAX.into()) {
            let bytes: Vec<[u8; 2]> = values.iter().map(|value| (*value as i16).to_le_bytes()).collect();
            self.column(name, "i16", bytes.as_flattened(), values.len(), steps);
        } else if fits(i32::MIN.into(), i32::MAX.into()) {
            let bytes: Vec<[u8; 4]> = values.iter().map(|value| (*value as i32).to_le_bytes()).collect();
            self.column(name, "i32", bytes.as_flattened(), values.len(), steps);
        } else {
            let bytes: Vec<[u8; 8]> = values.iter().map(|value| (*value as f64).to_le_bytes()).collect();
            self.column(name, "f64", bytes.as_flattened(), values.len(), steps);
        }
    }

    fn column(&mut self, name: &str, kind: &str, bytes: &[u8], count: usize, steps: bool) {
        self.bytes.resize(self.bytes.len().next_multiple_of(ALIGNMENT), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.list.push(json!({ "name": name, "type": kind, "offset": offset, "count": count, "steps": steps }));
    }

    /// What the columns are, and their bytes: deflated, in base 64.
    pub(super) fn finish(self) -> std::io::Result<(Value, String)> {
        let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
        deflated.write_all(&self.bytes)?;
        Ok((json!({ "bytes": self.bytes.len(), "list": self.list }), base64(&deflated.finish()?)))
    }
}

/// Base 64 with the usual letters and padding (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let part = |index: usize| u32::from(three.get(index).copied().unwrap_or(0));
        let bits = part(0) << 16 | part(1) << 8 | part(2);
        for place in 0..4 {
            let letter = LETTERS.get((bits >> (18 - 6 * place)) as usize & 63).copied().unwrap_or(b'=');
            text.push(char::from(if place <= three.len() { letter } else { b'=' }));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_that_of_the_rfc() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("fooba", "Zm9vYmE=")];
        for (plain, text) in cases {
            assert_eq!(base64(plain.as_bytes()), text);
        }
    }

    #[test]
    fn columns_are_as_narrow_as_their_numbers_and_aligned() {
        let mut columns = Columns::default();
        columns.whole("a", [1, -128, 127]);
        columns.whole("b", [0, 128]);
        columns.steps("c", [1_000_000, 1_000_001, 999_990]);
        columns.whole("d", [1 << 40]);
        let said: Vec<(String, u64)> = columns
            .list
            .iter()
            .map(|column| (column["type"].as_str().unwrap_or("").to_owned(), column["offset"].as_u64().unwrap_or(9)))
            .collect();
        let expected = [("i8", 0), ("i16", 8), ("i32", 16), ("f64", 32)].map(|(kind, at)| (kind.to_owned(), at));
        assert_eq!(said, expected);
        assert_eq!(columns.bytes[16..28], [1_000_000_i32, 1, -11].map(i32::to_le_bytes).concat());
    }
}
