//! A few of many values, evenly spread over all that came: enough for a median in bounded memory.

/// Values that are kept, at most; even.
const MOST: usize = 64;

/// Every 2ⁿ-th of the values that came, with n as small as room allows.
#[derive(Debug, Clone)]
pub(crate) struct Sample<T> {
    values: Vec<T>,
    /// One of this many is kept.
    every: u64,
    /// How many came.
    count: u64,
}

impl<T> Default for Sample<T> {
    fn default() -> Self {
        Self { values: Vec::new(), every: 1, count: 0 }
    }
}

impl<T: Copy + Ord> Sample<T> {
    /// Takes the next value in.
    pub(crate) fn add(&mut self, value: T) {
        if self.count.is_multiple_of(self.every) {
            if self.values.len() >= MOST {
                let mut index = 0;
                self.values.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.every = self.every.saturating_mul(2);
            }
            self.values.push(value);
        }
        self.count += 1;
    }

    /// How many values came.
    pub(crate) const fn count(&self) -> u64 {
        self.count
    }

    /// The median of those kept, the lower one of two; `None` where nothing came.
    pub(crate) fn median(&self) -> Option<T> {
        let mut values = self.values.clone();
        let middle = values.len().checked_sub(1)? / 2;
        Some(*values.select_nth_unstable(middle).1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_give_their_exact_median() {
        let mut sample = Sample::default();
        assert_eq!(sample.median(), None);
        for value in [5, 1, 9] {
            sample.add(value);
        }
        assert_eq!((sample.median(), sample.count()), (Some(5), 3));
    }

    #[test]
    fn a_million_values_take_no_more_room_and_their_median_is_near() {
        let mut sample = Sample::default();
        for value in 0..1_000_000_u32 {
            sample.add(value);
        }
        assert!(sample.values.len() <= MOST);
        let median = sample.median().unwrap();
        assert!(median.abs_diff(500_000) < 40_000, "{median}");
    }
}
