//! How errors are spread.
use serde::Serialize;

/// Quantiles and mean of errors, in metres; `None` where there are no errors.
///
/// A quantile is exact: of the sorted errors x₀ … xₙ₋₁ the p-quantile lies at the place (n − 1) p, between two of them in
/// proportion (Hyndman and Fan's type 7, what numpy gives).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Spread {
    /// The median.
    pub p50: Option<f64>,
    /// Nine in ten are no larger.
    pub p90: Option<f64>,
    /// Nineteen in twenty are no larger.
    pub p95: Option<f64>,
    /// The arithmetic mean.
    pub mean: Option<f64>,
    /// How many errors there are.
    pub count: usize,
}

impl Spread {
    /// The spread of these errors; those that are no numbers are left out.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Self {
        let mut errors: Vec<f64> = errors.into_iter().filter(|error| !error.is_nan()).collect();
        // Summed before they are sorted, in the order in which they came.
        let sum: f64 = errors.iter().sum();
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        Self {
            p50: quantile(&errors, 0.5),
            p90: quantile(&errors, 0.9),
            p95: quantile(&errors, 0.95),
            mean: (count > 0).then(|| sum / count as f64),
            count,
        }
    }
}

/// The `p`-quantile of sorted values.
fn quantile(sorted: &[f64], p: f64) -> Option<f64> {
    let place = sorted.len().checked_sub(1)? as f64 * p;
    let below = place.floor();
    let low = *sorted.get(below as usize)?;
    let high = sorted.get(below as usize + 1).copied().unwrap_or(low);
    // Equal ones stay what they are, infinite ones included.
    Some(if low == high { low } else { low + (high - low) * (place - below) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_the_sorted_errors_in_proportion() {
        // numpy.percentile([4, 1, 3, 2, 10], [50, 90, 95]) is 3, 7.6, 8.8; the mean is 20 / 5.
        let spread = Spread::of([4.0, 1.0, 3.0, 2.0, 10.0]);
        let found = [spread.p50, spread.p90, spread.p95, spread.mean].map(Option::unwrap);
        for (found, expected) in found.into_iter().zip([3.0, 7.6, 8.8, 4.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
        }
        assert_eq!(spread.count, 5);
    }

    #[test]
    fn the_median_of_two_is_their_mean_and_of_one_itself() {
        assert_eq!(Spread::of([3.0, 1.0]).p50, Some(2.0));
        let one = Spread::of([0.25]);
        assert_eq!([one.p50, one.p90, one.p95, one.mean], [Some(0.25); 4]);
    }

    #[test]
    fn no_errors_have_no_spread_and_what_is_no_number_is_no_error() {
        assert_eq!(Spread::of([]), Spread::default());
        assert_eq!(Spread::of([f64::NAN, 2.0]), Spread::of([2.0]));
        assert_eq!(Spread::of([f64::INFINITY; 3]).p90, Some(f64::INFINITY));
    }
}
