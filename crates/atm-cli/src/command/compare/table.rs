//! The comparison for a person.

use atm_lab::{
    compare::{Assessment, Name, Recording},
    eval::Metrics,
};

/// A heading and what stands under it, row by row.
struct Column<'a> {
    heading: &'a str,
    cells: Vec<String>,
}

/// One row a method. Lengths are in centimetres, so that a row fits a terminal.
pub fn text(rows: &[(Name, &Assessment)], recording: &Recording, against_world: bool) -> String {
    let mut columns = vec![
        Column { heading: "method", cells: rows.iter().map(|(name, _)| name.word().to_owned()).collect() },
        column(rows, "points", |row| row.points.map(|points| points.to_string())),
    ];
    if against_world {
        columns.extend(scored(rows));
    } else {
        columns.extend(compared(rows));
    }
    columns.push(column(rows, "us/reading", |row| row.points.map(|_| format!("{:.2}", row.seconds_per_reading * 1e6))));
    let mut text = format!("{} readings; lengths in cm\n", recording.readings());
    for line in 0..=rows.len() {
        let mut row = String::new();
        for (index, column) in columns.iter().enumerate() {
            let width = column.cells.iter().map(String::len).chain([column.heading.len()]).max().unwrap_or(0);
            let cell =
                line.checked_sub(1).map_or(column.heading, |line| column.cells.get(line).map_or("", String::as_str));
            row += &if index == 0 { format!("{cell:width$}") } else { format!("  {cell:>width$}") };
        }
        text += row.trim_end();
        text.push('\n');
    }
    text + if against_world { AGAINST_WORLD } else { AMONG_THEMSELVES }
}

const AGAINST_WORLD: &str = "\
azimuth, surface: median and 90 % of the errors. cover: share of the observable surface with a point within 3 in.
ghosts: points over 6 in from every surface. door: what is left of the opening.
answered: share of the echoes that it speaks of; center50 is the median azimuth error of the cones' centres on the same readings.
best: the threshold that fits this world best, which a robot can't know, and with it the surface error and the coverage.
";
const AMONG_THEMSELVES: &str = "\
entropy: bits of the points' distribution over cells of 5 and 10 cm. agrees: share of its points that have one of another method
within 4 in, on average over the others; with atm: with the median and single echoes.
";

fn column<'a>(
    rows: &[(Name, &Assessment)],
    heading: &'a str,
    cell: impl Fn(&Assessment) -> Option<String>,
) -> Column<'a> {
    let cells = rows.iter().map(|(_, row)| cell(row).unwrap_or_else(|| "-".to_owned())).collect();
    Column { heading, cells }
}

fn scored(rows: &[(Name, &Assessment)]) -> Vec<Column<'static>> {
    let metric = |heading, cell: fn(&Metrics) -> Option<String>| {
        column(rows, heading, move |row| cell(&row.scores.as_ref()?.all))
    };
    vec![
        metric("azimuth50", |metrics| centimetres(metrics.azimuth_error_m.p50)),
        metric("90%", |metrics| centimetres(metrics.azimuth_error_m.p90)),
        metric("surface50", |metrics| centimetres(metrics.surface_error_m.p50)),
        metric("90%", |metrics| centimetres(metrics.surface_error_m.p90)),
        metric("cover", |metrics| percent(metrics.coverage)),
        metric("ghosts", |metrics| Some(metrics.ghosts.to_string())),
        metric("door", |metrics| centimetres(metrics.doorway_width_m)),
        column(rows, "answered", |row| percent(Some(row.same_readings.as_ref()?.answered))),
        column(rows, "center50", |row| centimetres(row.same_readings.as_ref()?.centerline_azimuth_error_m.p50)),
        column(rows, "best:above", |row| Some(format!("{:.3}", row.best.as_ref()?.threshold))),
        column(rows, "surface50", |row| centimetres(row.best.as_ref()?.scores.all.surface_error_m.p50)),
        column(rows, "cover", |row| percent(row.best.as_ref()?.scores.all.coverage)),
    ]
}

fn compared(rows: &[(Name, &Assessment)]) -> Vec<Column<'static>> {
    let bits = |bits: Option<f64>| bits.map(|bits| format!("{bits:.2}"));
    vec![
        column(rows, "entropy 5cm", |row| bits(row.map_entropy_bits.at_5_cm)),
        column(rows, "10cm", |row| bits(row.map_entropy_bits.at_10_cm)),
        column(rows, "agrees", |row| {
            let shares: Vec<f64> = row.agreement.as_ref()?.values().copied().flatten().collect();
            percent((!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64))
        }),
        column(rows, "with atm", |row| percent(*row.agreement.as_ref()?.get(Name::AtmMedianSingle.word())?)),
    ]
}

fn centimetres(metres: Option<f64>) -> Option<String> {
    metres.map(|metres| format!("{:.1}", 100.0 * metres))
}

fn percent(share: Option<f64>) -> Option<String> {
    share.map(|share| format!("{:.0}%", 100.0 * share))
}
