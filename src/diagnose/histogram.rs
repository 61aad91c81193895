//! Lengths by size, in bounded memory.

/// Bins in a factor of two, as a power of two: each is 1.1 % to 1.6 % wide.
const BITS: u32 = 6;
/// A float's exponent and the first bits of its fraction number the bins: the rest of the fraction is shifted out.
const SHIFT: u32 = f64::MANTISSA_DIGITS - 1 - BITS;
/// The lowest bin begins at 2⁻¹⁰ m, about a millimetre.
const FIRST: u64 = (1023 - 10) << BITS;
/// Up to 2¹⁸ m: millimetres that are taken for metres fit.
const BINS: usize = 28 << BITS;

/// How many lengths there were of each size. What is smaller or larger than all bins is in the outermost.
#[derive(Debug, Clone)]
pub(super) struct Histogram(Box<[u32]>);

impl Histogram {
    pub(super) fn new() -> Self {
        Self(vec![0; BINS].into_boxed_slice())
    }

    /// Counts a length in metres, positive and finite.
    #[inline]
    pub(super) fn add(&mut self, metres: f64) {
        if let Some(count) = self.0.get_mut(bin(metres)) {
            *count = count.saturating_add(1);
        }
    }

    /// How many were at least `low` and below `high`, in metres, to the width of a bin.
    pub(super) fn between(&self, low: f64, high: f64) -> u64 {
        self.0.get(bin(low)..bin(high)).unwrap_or_default().iter().map(|&count| u64::from(count)).sum()
    }

    /// The length below which this share of those from `low` to below `high` lies, in metres, to the width of a bin; `None`
    /// where there are none.
    pub(super) fn quantile(&self, share: f64, low: f64, high: f64) -> Option<f64> {
        let (first, last) = (bin(low), bin(high));
        let bins = self.0.get(first..=last)?;
        let total: u64 = bins.iter().map(|&count| u64::from(count)).sum();
        let wanted = share * total as f64;
        let mut sum = 0;
        for (index, &count) in bins.iter().enumerate().filter(|(_, count)| **count > 0) {
            sum += u64::from(count);
            if sum as f64 >= wanted {
                return Some(0.5 * (edge(first + index) + edge(first + index + 1)));
            }
        }
        None
    }

    /// Counts what another histogram has.
    pub(super) fn merge(&mut self, other: &Self) {
        for (count, more) in self.0.iter_mut().zip(&other.0) {
            *count = count.saturating_add(*more);
        }
    }
}

/// The bin of a length; NaN and what is negative is in the last.
#[inline]
fn bin(metres: f64) -> usize {
    let number = (metres.to_bits() >> SHIFT).saturating_sub(FIRST);
    usize::try_from(number).map_or(BINS - 1, |number| number.min(BINS - 1))
}

/// Where a bin begins, in metres.
fn edge(bin: usize) -> f64 {
    f64::from_bits((bin as u64 + FIRST) << SHIFT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_within_a_bin_of_those_of_a_sorted_list() {
        let mut histogram = Histogram::new();
        let values: Vec<f64> = (1..=1000).map(|step| f64::from(step) * 0.005).collect();
        values.iter().for_each(|&value| histogram.add(value));
        for share in [0.05, 0.5, 0.95] {
            let exact = values[(share * 1000.0) as usize - 1];
            let found = histogram.quantile(share, 0.0, f64::INFINITY).unwrap();
            assert!((found / exact - 1.0).abs() < 0.016, "{share}: {found} for {exact}");
        }
        assert_eq!(histogram.quantile(0.5, 6.0, 7.0), None, "there is nothing there");
    }

    #[test]
    fn what_fits_no_bin_is_in_the_outermost() {
        let mut histogram = Histogram::new();
        for value in [1e-300, 1e300] {
            histogram.add(value);
        }
        assert_eq!(histogram.between(0.0, 1.0), 1);
        assert!(histogram.quantile(1.0, 0.0, f64::INFINITY).unwrap() > 1e5);
    }
}
