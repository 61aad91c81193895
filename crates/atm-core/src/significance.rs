//! How unlikely it is that crossings cluster by chance (Sec. IV-A).

use crate::scalar::Scalar;

/// Equation (1), as its natural logarithm: n ln(Δ/Θ), the chance that `within` crossings, uniform along an arc of length
/// `arc_length`, all fall into one given interval of length `interval`.
///
/// 0 where the interval is no shorter than the arc. Logarithm, because 0.095³¹⁸ is too small for an `f64`.
pub fn log_chance<T: Scalar>(within: u32, interval: T, arc_length: T) -> T {
    let share = interval / arc_length;
    if !(share > T::ZERO && share < T::ONE) || within == 0 {
        return T::ZERO;
    }
    T::from_count(within) * share.logarithm()
}

/// The chance that SOME interval of length `interval` holds `within` or more of `crossings` uniform points on an arc of
/// length `arc_length`: what equation (1) leaves out, that the interval was chosen after looking.
///
/// Wallenstein and Neff's approximation of the scan statistic (Statistics in Medicine 6, 1987):
/// P ≈ min(1, (n/w − N − 1) b(n; N, w) + 2 P(Bin(N, w) ≥ n)); 1 where w = Δ/Θ ≥ 1 or n < 2. The approximation is for rare
/// clusters: where n ≤ w (N + 1), no more than are expected in one interval, its first term turns negative and the chance
/// is all but 1, so 1 is returned.
/// Cost: one term for each of N − n + 1 counts.
pub fn scan_chance<T: Scalar>(within: u32, crossings: u32, interval: T, arc_length: T) -> T {
    let share = interval / arc_length;
    if within < 2 || within > crossings || !(share > T::ZERO && share < T::ONE) {
        return T::ONE;
    }
    let places = T::from_count(within) / share - T::from_count(crossings) - T::ONE;
    if places <= T::ZERO {
        return T::ONE;
    }
    let exactly = log_binomial(within, crossings, share).exponential();
    let mut at_least = T::ZERO;
    for count in within..=crossings {
        at_least += log_binomial(count, crossings, share).exponential();
    }
    let chance = places * exactly + T::TWO * at_least;
    if chance < T::ONE { chance } else { T::ONE }
}

/// ln b(k; n, p): k successes in n trials.
fn log_binomial<T: Scalar>(k: u32, n: u32, p: T) -> T {
    let factorial = |count: u32| (T::from_count(count) + T::ONE).log_gamma();
    factorial(n) - factorial(k) - factorial(n - k)
        + T::from_count(k) * p.logarithm()
        + T::from_count(n - k) * (T::ONE - p).logarithm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of draws in which some window of width `w` holds `n` or more of `total` uniform points.
    fn monte_carlo(n: usize, total: usize, w: f64, draws: u32) -> f64 {
        extern crate std;
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut uniform = || {
            // xorshift64*: enough for a check to one in a hundred.
            state ^= state >> 12;
            state ^= state << 25;
            state ^= state >> 27;
            (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut hits = 0;
        for _ in 0..draws {
            let mut points: std::vec::Vec<f64> = (0..total).map(|_| uniform()).collect();
            points.sort_by(f64::total_cmp);
            hits += u32::from(points.windows(n).any(|run| run[n - 1] - run[0] <= w));
        }
        f64::from(hits) / f64::from(draws)
    }

    #[test]
    fn scan_chance_agrees_with_monte_carlo() {
        let (n, total, share) = (4, 10, 0.095);
        let formula: f64 = scan_chance(n, total, share, 1.0);
        assert!((formula - 0.31).abs() < 0.01, "{formula}");
        let drawn = monte_carlo(n as usize, total as usize, share, 40_000);
        assert!((formula - drawn).abs() < 0.02, "{formula} and {drawn}");
    }

    #[test]
    fn scan_chance_is_one_where_it_says_nothing() {
        assert_eq!(scan_chance(1, 10, 0.1, 1.0), 1.0);
        assert_eq!(scan_chance(5, 10, 1.0, 1.0), 1.0);
        assert_eq!(scan_chance(5, 10, f64::NAN, 1.0), 1.0);
    }

    #[test]
    fn chance_is_the_share_to_the_power_of_the_count() {
        assert!((log_chance(3, 0.5f64, 2.0).exp() - 0.25f64.powi(3)).abs() < 1e-15);
        assert_eq!(log_chance(3, 2.0, 1.0), 0.0);
        let tiny: f64 = log_chance(318, 0.095, 1.0);
        assert!((tiny - 318.0 * 0.095f64.ln()).abs() < 1e-9);
    }
}
