//! CDR out: how ROS 2 writes its messages (OMG DDS-XTypes 1.3, section 7.4.3; encoding 1, little endian).

/// What a message begins with: plain CDR, little endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// One message. Numbers are aligned to their size, counted from behind the four bytes that say how the message is written.
#[derive(Debug, Clone)]
pub struct CdrWriter {
    bytes: Vec<u8>,
}

impl Default for CdrWriter {
    fn default() -> Self {
        Self::new()
    }
}

macro_rules! numbers {
    ($($type:ident),*) => {$(
        #[doc = concat!("Writes one `", stringify!($type), "`.")]
        pub fn $type(&mut self, value: $type) {
            self.align(size_of::<$type>());
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    )*};
}

impl CdrWriter {
    /// An empty message.
    pub fn new() -> Self {
        Self { bytes: HEADER.to_vec() }
    }

    /// Begins the next message in the same memory.
    pub fn clear(&mut self) {
        self.bytes.truncate(HEADER.len());
    }

    /// The message so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    numbers!(u8, u16, u32, i32, f32, f64);

    /// Writes a truth value.
    pub fn bool(&mut self, value: bool) {
        self.u8(u8::from(value));
    }

    /// Writes a text, with its length and the zero byte at its end.
    pub fn string(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// Begins a sequence: `count` elements follow.
    pub fn count(&mut self, count: usize) {
        // What is written here is gathered in bounded memory, far below 2³² elements.
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }

    /// Writes a sequence of bytes.
    pub fn octets(&mut self, octets: &[u8]) {
        self.count(octets.len());
        self.bytes.extend_from_slice(octets);
    }

    fn align(&mut self, size: usize) {
        let written = self.bytes.len() - HEADER.len();
        self.bytes.resize(HEADER.len() + written.next_multiple_of(size), 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_behind_the_header() {
        let mut message = CdrWriter::new();
        message.u8(7);
        message.f64(1.0);
        message.u16(2);
        message.u32(3);
        #[rustfmt::skip]
        assert_eq!(message.bytes(), [
            0, 1, 0, 0,
            7, 0, 0, 0, 0, 0, 0, 0,
            0, 0, 0, 0, 0, 0, 0xf0, 0x3f,
            2, 0, 0, 0,
            3, 0, 0, 0,
        ]);
    }

    #[test]
    fn text_carries_its_length_and_a_zero() {
        let mut message = CdrWriter::new();
        message.string("ab");
        message.string("");
        #[rustfmt::skip]
        assert_eq!(message.bytes()[4..], [3, 0, 0, 0, b'a', b'b', 0, 0, 1, 0, 0, 0, 0]);
    }

    #[test]
    fn empty_sequence_of_wide_numbers_is_not_padded() {
        let mut message = CdrWriter::new();
        message.count(0);
        message.bool(true);
        assert_eq!(message.bytes()[4..], [0, 0, 0, 0, 1]);
        message.clear();
        assert_eq!(message.bytes(), HEADER);
    }
}
