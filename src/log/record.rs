//! A record of a table: its fields, wherever they lie.

/// One record: its fields, trimmed of ASCII blanks.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) ends: &'a [usize],
    /// Bytes between the end of a field and the start of the next.
    pub(super) gap: usize,
}

impl<'a> Record<'a> {
    /// Number of fields; 0 only before the first record.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether no record was read yet.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The field of this index, from 0.
    #[inline]
    pub fn get(&self, index: usize) -> Option<&'a [u8]> {
        let end = *self.ends.get(index)?;
        let start = match index.checked_sub(1) {
            Some(before) => *self.ends.get(before)? + self.gap,
            None => 0,
        };
        Some(self.bytes.get(start..end)?.trim_ascii())
    }

    /// The text of neighbouring fields with what stands between them; `None` where that is gone.
    #[inline]
    pub(super) fn span(&self, first: usize, last: usize) -> Option<&'a [u8]> {
        let start = match first.checked_sub(1) {
            Some(before) => *self.ends.get(before)? + self.gap,
            None => 0,
        };
        self.bytes.get(start..*self.ends.get(last)?).filter(|_| self.gap > 0)
    }

    /// The fields in order.
    pub fn fields(self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.len()).filter_map(move |index| self.get(index))
    }
}
