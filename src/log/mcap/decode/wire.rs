//! Values one after another as ROS writes them: CDR (OMG DDS-XTypes 1.3, 7.4) in ROS 2, and the same without alignment in ROS 1.

use super::definition::Scalar;

/// A number, or a time in ROS 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Real(f64),
    Whole(i64),
    Time(u32, u32),
}

/// What of a message is not yet read.
#[derive(Debug)]
pub(super) struct Wire<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// What a value is aligned to, at most.
    alignment: usize,
    /// A text's count includes a zero at its end.
    zero: bool,
}

impl<'a> Wire<'a> {
    /// A message of ROS 2: four bytes say how it is written. The words are why it can't be read.
    pub(super) fn cdr(message: &'a [u8]) -> Result<Self, String> {
        let Some(([0, representation, ..], bytes)) = message.split_first_chunk::<4>() else {
            return Err("it does not begin as CDR does".to_owned());
        };
        let (big_endian, alignment) = match representation {
            0 => (true, 8),
            1 => (false, 8),
            // The second version, as plain as the first: eight bytes are aligned to four.
            6 => (true, 4),
            7 => (false, 4),
            other => return Err(format!("it is CDR of the representation {other}, which is not plain")),
        };
        Ok(Self { bytes, at: 0, big_endian, alignment, zero: true })
    }

    /// A message of ROS 1.
    pub(super) fn ros1(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, big_endian: false, alignment: 1, zero: false }
    }

    /// Passes over values one after another.
    pub(super) fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), String> {
        if count == 0 {
            return Ok(());
        }
        let count = if scalar == Scalar::Time { count.saturating_mul(2) } else { count };
        self.align(scalar.size());
        self.take(count.saturating_mul(scalar.size())).map(|_| ())
    }

    pub(super) fn number(&mut self, scalar: Scalar) -> Result<Number, String> {
        Ok(match scalar {
            Scalar::U8 => Number::Whole(u8::from_le_bytes(self.array()?).into()),
            Scalar::I8 => Number::Whole(i8::from_le_bytes(self.array()?).into()),
            Scalar::U16 => Number::Whole(u16::from_le_bytes(self.array()?).into()),
            Scalar::I16 => Number::Whole(i16::from_le_bytes(self.array()?).into()),
            Scalar::U32 => Number::Whole(self.u32()?.into()),
            Scalar::I32 => Number::Whole(i32::from_le_bytes(self.array()?).into()),
            // What does not fit is no time of anybody.
            Scalar::U64 => Number::Whole(i64::try_from(u64::from_le_bytes(self.array()?)).unwrap_or(i64::MAX)),
            Scalar::I64 => Number::Whole(i64::from_le_bytes(self.array()?)),
            Scalar::F32 => Number::Real(f32::from_le_bytes(self.array()?).into()),
            Scalar::F64 => Number::Real(f64::from_le_bytes(self.array()?)),
            Scalar::Time => Number::Time(self.u32()?, self.u32()?),
        })
    }

    /// A text's bytes.
    pub(super) fn text(&mut self) -> Result<&'a [u8], String> {
        let count = self.u32()? as usize;
        let text = self.take(count)?;
        Ok(if self.zero { text.strip_suffix(&[0]).unwrap_or(text) } else { text })
    }

    /// Bytes behind their count.
    pub(super) fn octets(&mut self) -> Result<&'a [u8], String> {
        let count = self.count()?;
        self.take(count)
    }

    /// How many elements come, each of at least a byte.
    pub(super) fn count(&mut self) -> Result<usize, String> {
        let count = self.u32()? as usize;
        if count > self.bytes.len().saturating_sub(self.at) {
            return Err(format!("byte {} says that {count} elements come, and it is too short for that", self.at));
        }
        Ok(count)
    }

    fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    /// The bytes of one value, the lowest first.
    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.align(N);
        let bytes = self.take(N)?;
        let mut array = [0; N];
        for (to, from) in array.iter_mut().zip(bytes) {
            *to = *from;
        }
        if self.big_endian {
            array.reverse();
        }
        Ok(array)
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size.min(self.alignment));
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let taken = self.at.checked_add(count).and_then(|end| self.bytes.get(self.at..end));
        let taken = taken.ok_or_else(|| {
            format!("it ends after {} bytes, where {count} more are to come from byte {} on", self.bytes.len(), self.at)
        })?;
        self.at += count;
        Ok(taken)
    }
}
