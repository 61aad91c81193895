//! Protocol Buffers out: just what the messages of Foxglove need (protobuf.dev, "Encoding").

/// How a field's value is laid out, as it stands in the field's tag.
#[derive(Clone, Copy)]
enum Wire {
    Varint = 0,
    Eight = 1,
    Delimited = 2,
    Four = 5,
}

/// One message. A field of value zero is left out, as proto3 does; an element of a list never is.
#[derive(Debug, Clone, Default)]
pub(super) struct ProtoWriter {
    bytes: Vec<u8>,
}

impl ProtoWriter {
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn double(&mut self, field: u32, value: f64) {
        // Minus zero is not zero here.
        if value.to_bits() != 0 {
            self.tag(field, Wire::Eight);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    pub(super) fn fixed32(&mut self, field: u32, value: u32) {
        if value != 0 {
            self.tag(field, Wire::Four);
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    /// A whole number, a truth value or the number of an enumeration; negative ones take ten bytes.
    pub(super) fn integer(&mut self, field: u32, value: i64) {
        if value != 0 {
            self.tag(field, Wire::Varint);
            self.varint(value.cast_unsigned());
        }
    }

    pub(super) fn string(&mut self, field: u32, text: &str) {
        self.octets(field, text.as_bytes());
    }

    pub(super) fn octets(&mut self, field: u32, octets: &[u8]) {
        if !octets.is_empty() {
            self.tag(field, Wire::Delimited);
            self.varint(octets.len() as u64);
            self.bytes.extend_from_slice(octets);
        }
    }

    /// A text in a list, be it empty.
    pub(super) fn element(&mut self, field: u32, text: &str) {
        self.tag(field, Wire::Delimited);
        self.varint(text.len() as u64);
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// A message within the message, which `write` fills.
    pub(super) fn message(&mut self, field: u32, write: impl FnOnce(&mut Self)) {
        self.tag(field, Wire::Delimited);
        // Nearly every one is shorter than 128 bytes: the length takes one byte, and only a longer one has to move.
        let start = self.bytes.len();
        self.bytes.push(0);
        write(self);
        let length = self.bytes.len() - start - 1;
        let mut prefix = Self::default();
        prefix.varint(length as u64);
        self.bytes.splice(start..=start, prefix.bytes);
    }

    fn tag(&mut self, field: u32, wire: Wire) {
        self.varint(u64::from(field << 3 | wire as u32));
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl FnOnce(&mut ProtoWriter)) -> Vec<u8> {
        let mut message = ProtoWriter::default();
        write(&mut message);
        message.bytes
    }

    #[test]
    fn examples_of_the_specification() {
        // protobuf.dev, "Encoding": {a: 150}, {b: "testing"}, {c: {a: 150}}.
        assert_eq!(written(|message| message.integer(1, 150)), [0x08, 0x96, 0x01]);
        assert_eq!(written(|message| message.string(2, "testing")), b"\x12\x07testing");
        assert_eq!(
            written(|message| message.message(3, |message| message.integer(1, 150))),
            [0x1a, 0x03, 0x08, 0x96, 0x01]
        );
        // {a: -2} takes ten bytes.
        let mut minus_two = vec![0x08, 0xfe];
        minus_two.extend([0xff; 8]);
        minus_two.push(0x01);
        assert_eq!(written(|message| message.integer(1, -2)), minus_two);
    }

    #[test]
    fn long_message_has_a_longer_length() {
        let text = "x".repeat(300);
        let bytes = written(|message| message.message(1, |message| message.string(1, &text)));
        assert_eq!(bytes[..6], [0x0a, 0xaf, 0x02, 0x0a, 0xac, 0x02]);
        assert_eq!(bytes[6..], *text.as_bytes());
    }

    #[test]
    fn zero_is_left_out_and_minus_zero_is_not() {
        assert!(written(|message| message.double(1, 0.0)).is_empty());
        assert_eq!(written(|message| message.double(1, -0.0)).len(), 9);
        assert_eq!(written(|message| message.message(1, |_| {})), [0x0a, 0]);
        assert_eq!(written(|message| message.element(1, "")), [0x0a, 0]);
    }
}
