//! Little-endian CDR, read step by step (OMG DDS-XTypes 1.3, section 7.4.3).

/// A message that is read from its beginning.
pub struct Cdr<'a> {
    /// Behind the four bytes of the header.
    body: &'a [u8],
    at: usize,
}

impl<'a> Cdr<'a> {
    pub fn new(message: &'a [u8]) -> Self {
        assert_eq!(message[..4], [0, 1, 0, 0], "plain CDR, little endian");
        Self { body: &message[4..], at: 0 }
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        while !self.at.is_multiple_of(N) {
            assert_eq!(self.body[self.at], 0, "padding");
            self.at += 1;
        }
        let bytes = self.body[self.at..self.at + N].try_into().unwrap();
        self.at += N;
        bytes
    }

    pub fn u8(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    pub fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    pub fn bytes(&mut self) -> &'a [u8] {
        let length = self.u32() as usize;
        let bytes = &self.body[self.at..self.at + length];
        self.at += length;
        bytes
    }

    pub fn string(&mut self) -> &'a str {
        let text = self.bytes().strip_suffix(&[0]).expect("a zero byte ends a text");
        std::str::from_utf8(text).expect("UTF-8")
    }

    /// A std_msgs/Header: the stamp in nanoseconds, and the frame.
    pub fn header(&mut self) -> (i64, &'a str) {
        let (seconds, nanoseconds) = (self.i32(), self.u32());
        (i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds), self.string())
    }

    /// A geometry_msgs/Pose or Transform in the plane: x, y and the heading.
    pub fn pose(&mut self) -> [f64; 3] {
        let [x, y, z, qx, qy, qz, qw] = std::array::from_fn(|_| self.f64());
        assert_eq!([z, qx, qy], [0.0; 3]);
        [x, y, 2.0 * qz.atan2(qw)]
    }

    /// Insists that nothing is left.
    pub fn end(self) {
        assert_eq!(self.body.len(), self.at, "bytes are left");
    }
}
