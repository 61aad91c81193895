//! What many drives have in common.

/// The p-quantile: of the sorted values the one at the place (n − 1) p, between two of them in proportion. NaN of none.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = sorted.len().saturating_sub(1) as f64 * p;
    let at = |place: f64| sorted.get(place as usize).copied().unwrap_or(f64::NAN);
    at(place.floor()) + (at(place.ceil()) - at(place.floor())) * place.fract()
}

pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The median, and where the middle 80 % lie, as a table's cell.
pub fn cell(values: &[f64]) -> String {
    format!("{} ({} … {})", number(median(values)), number(quantile(values, 0.1)), number(quantile(values, 0.9)))
}

/// A number with two decimals, or one from ten on; a dash for none.
pub fn number(value: f64) -> String {
    match value.abs() {
        value if value.is_nan() => "–".to_owned(),
        size if size < 10.0 => format!("{value:.2}"),
        size if size < 1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// Share of the values for which something holds, in percent.
pub fn percent(values: &[f64], holds: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|value| holds(**value)).count() as f64 / values.len() as f64 * 100.0
}

#[test]
fn quantiles_lie_between_values_in_proportion() {
    assert_eq!(quantile(&[4.0, 1.0, 10.0, 6.0], 0.5), 5.0);
    assert_eq!(quantile(&[1.0, 2.0], 0.1), 1.1);
    assert_eq!(quantile(&[3.0], 0.9), 3.0);
    assert!(quantile(&[], 0.5).is_nan());
}
