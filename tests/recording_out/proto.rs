//! Protobuf, read as what its bytes alone say (protobuf.dev, "Encoding").

/// A field's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Wire<'a> {
    Varint(u64),
    Eight([u8; 8]),
    Four([u8; 4]),
    Bytes(&'a [u8]),
}

/// A message's fields by number, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Proto<'a>(Vec<(u64, Wire<'a>)>);

fn varint(bytes: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..).step_by(7) {
        let (&byte, rest) = bytes.split_first().expect("a varint ends");
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            break;
        }
    }
    value
}

impl<'a> Proto<'a> {
    pub fn new(mut bytes: &'a [u8]) -> Self {
        let mut fields = Vec::new();
        let take = |bytes: &mut &'a [u8], length: usize| {
            let (taken, rest) = bytes.split_at(length);
            *bytes = rest;
            taken
        };
        while !bytes.is_empty() {
            let tag = varint(&mut bytes);
            let wire = match tag & 7 {
                0 => Wire::Varint(varint(&mut bytes)),
                1 => Wire::Eight(take(&mut bytes, 8).try_into().unwrap()),
                2 => {
                    let length = varint(&mut bytes) as usize;
                    Wire::Bytes(take(&mut bytes, length))
                }
                5 => Wire::Four(take(&mut bytes, 4).try_into().unwrap()),
                other => panic!("wire type {other}"),
            };
            fields.push((tag >> 3, wire));
        }
        Self(fields)
    }

    pub fn all(&self, number: u64) -> impl Iterator<Item = &Wire<'a>> {
        self.0.iter().filter(move |(field, _)| *field == number).map(|(_, wire)| wire)
    }

    pub fn messages(&self, number: u64) -> impl Iterator<Item = Proto<'a>> {
        self.all(number).map(|wire| match wire {
            Wire::Bytes(bytes) => Proto::new(bytes),
            other => panic!("{other:?} is no message"),
        })
    }

    pub fn message(&self, number: u64) -> Proto<'a> {
        self.messages(number).next().expect("the message is there")
    }

    pub fn double(&self, number: u64) -> f64 {
        match self.all(number).next() {
            None => 0.0,
            Some(Wire::Eight(bytes)) => f64::from_le_bytes(*bytes),
            Some(other) => panic!("{other:?} is no double"),
        }
    }

    pub fn integer(&self, number: u64) -> i64 {
        match self.all(number).next() {
            None => 0,
            Some(Wire::Varint(value)) => value.cast_signed(),
            Some(Wire::Four(bytes)) => i64::from(u32::from_le_bytes(*bytes)),
            Some(other) => panic!("{other:?} is no whole number"),
        }
    }

    pub fn bytes(&self, number: u64) -> &'a [u8] {
        match self.all(number).next() {
            None => &[],
            Some(Wire::Bytes(bytes)) => bytes,
            Some(other) => panic!("{other:?} are no bytes"),
        }
    }

    pub fn text(&self, number: u64) -> &'a str {
        std::str::from_utf8(self.bytes(number)).expect("UTF-8")
    }

    /// A google.protobuf.Timestamp, in nanoseconds.
    pub fn stamp(&self, number: u64) -> i64 {
        let stamp = self.message(number);
        stamp.integer(1) * 1_000_000_000 + stamp.integer(2)
    }

    /// x, y and heading from two fields.
    pub fn place(&self, position: u64, orientation: u64) -> [f64; 3] {
        let (position, orientation) = (self.message(position), self.message(orientation));
        assert_eq!([position.double(3), orientation.double(1), orientation.double(2)], [0.0; 3]);
        [position.double(1), position.double(2), 2.0 * orientation.double(3).atan2(orientation.double(4))]
    }
}
