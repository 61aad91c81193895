//! The median: of a few numbers, in place, without allocation (Sec. III-B).

use crate::scalar::Scalar;

/// The two middle values of `values` in order; the same one twice for an odd count; `None` if there are none.
///
/// Reorders `values`. Ties and any order of input are fine; NaN sorts after every number. Linear on average (Hoare's
/// selection, pivot of three).
pub(crate) fn middle_two<T: Scalar>(values: &mut [T]) -> Option<(T, T)> {
    let half = values.len() / 2;
    let even = values.len().is_multiple_of(2);
    let upper = select(values, half)?;
    if !even {
        return Some((upper, upper));
    }
    // Selection has left the lower half in front.
    let lower = values.get(..half)?.iter().copied().reduce(|a, b| if a.order(&b).is_lt() { b } else { a })?;
    Some((lower, upper))
}

/// The median of `values`, the mean of the two middle ones for an even count: median{1, 4, 6, 10} = 5 (Sec. III-B).
///
/// `None` if there are none. Reorders `values`.
pub fn median<T: Scalar>(values: &mut [T]) -> Option<T> {
    let (lower, upper) = middle_two(values)?;
    Some(lower * T::HALF + upper * T::HALF)
}

/// The value that would stand at `rank` if `values` were sorted; smaller or equal ones end up before it.
fn select<T: Scalar>(values: &mut [T], rank: usize) -> Option<T> {
    let (mut low, mut high) = (0, values.len().checked_sub(1)?);
    while low < high {
        let pivot = median_of_three(*values.get(low)?, *values.get(low + (high - low) / 2)?, *values.get(high)?);
        let (mut i, mut j) = (low, high);
        // Both scans stop at a value equal to the pivot: ties split evenly instead of all falling to one side.
        loop {
            while values.get(i)?.order(&pivot).is_lt() {
                i += 1;
            }
            while values.get(j)?.order(&pivot).is_gt() {
                j -= 1;
            }
            if i >= j {
                break;
            }
            let (a, b) = (*values.get(i)?, *values.get(j)?);
            *values.get_mut(i)? = b;
            *values.get_mut(j)? = a;
            i += 1;
            j -= 1;
        }
        // Now [low, i) ≤ pivot ≤ (j, high].
        if rank <= j {
            high = j;
        } else {
            low = j + 1;
        }
    }
    values.get(rank).copied()
}

fn median_of_three<T: Scalar>(a: T, b: T, c: T) -> T {
    let (low, high) = if b.order(&a).is_lt() { (b, a) } else { (a, b) };
    if c.order(&low).is_lt() {
        low
    } else if high.order(&c).is_lt() {
        high
    } else {
        c
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn paper_example_is_five() {
        assert_eq!(median(&mut [1.0, 4.0, 6.0, 10.0]), Some(5.0));
        assert_eq!(median(&mut [10.0f32, 1.0, 6.0, 4.0]), Some(5.0));
    }

    #[test]
    fn few_values() {
        assert_eq!(median::<f64>(&mut []), None);
        assert_eq!(median(&mut [3.0]), Some(3.0));
        assert_eq!(median(&mut [3.0, 1.0]), Some(2.0));
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
    }

    proptest! {
        #[test]
        fn equals_the_middle_of_a_sorted_copy(mut values in prop::collection::vec(prop_oneof![-2i32..3, -1000i32..1000], 1..80)) {
            let mut floats: Vec<f64> = values.iter().copied().map(f64::from).collect();
            values.sort_unstable();
            let expected = (values[(values.len() - 1) / 2], values[values.len() / 2]);
            let (lower, upper) = middle_two(&mut floats).unwrap();
            prop_assert_eq!((lower, upper), (f64::from(expected.0), f64::from(expected.1)));
        }

        #[test]
        fn any_bits_end(values in prop::collection::vec(any::<u64>(), 0..40)) {
            let mut floats: Vec<f64> = values.into_iter().map(f64::from_bits).collect();
            let empty = floats.is_empty();
            prop_assert_eq!(middle_two(&mut floats).is_none(), empty);
        }
    }
}
