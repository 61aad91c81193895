//! Tables of one number, methods down and worlds across; and all numbers of one world.

use atm_lab::compare::{Assessment, Name};

use crate::{
    drive::{Driven, SHARED, median},
    table::{Table, cm, headings, text},
};

/// A number of an assessment.
type Number = fn(&Assessment) -> Option<f64>;

const POINTS: Number = |row| Some(row.points? as f64);
const AZIMUTH_50: Number = |row| cm(row.scores.as_ref()?.all.azimuth_error_m.p50);
const AZIMUTH_90: Number = |row| cm(row.scores.as_ref()?.all.azimuth_error_m.p90);
const SURFACE_50: Number = |row| cm(row.scores.as_ref()?.all.surface_error_m.p50);
const SURFACE_90: Number = |row| cm(row.scores.as_ref()?.all.surface_error_m.p90);
const COVERAGE: Number = |row| Some(100.0 * row.scores.as_ref()?.all.coverage?);
const GHOSTS: Number = |row| {
    let all = &row.scores.as_ref()?.all;
    (all.points > 0).then(|| 100.0 * all.ghosts as f64 / all.points as f64)
};
const DOORWAY: Number = |row| cm(row.scores.as_ref()?.all.doorway_width_m);
const ANSWERED: Number = |row| Some(100.0 * row.same_readings.as_ref()?.answered);

/// What a person asks first, of the paper's own case; `None` where it was not driven.
pub fn short(driven: &[Driven]) -> Option<Table> {
    const COLUMNS: [(&str, Number, usize); 7] = [
        ("answered, %", ANSWERED, 0),
        ("azimuth, cm", AZIMUTH_50, 1),
        ("90 %", AZIMUTH_90, 1),
        ("surface, cm", SURFACE_50, 1),
        ("coverage, %", COVERAGE, 0),
        ("ghosts, %", GHOSTS, 1),
        ("doorway, cm", DOORWAY, 0),
    ];
    let doorway = driven.iter().find(|driven| driven.world == "doorway")?;
    let row = |name: &Name| {
        let numbers = COLUMNS.map(|(_, number, digits)| (doorway.median(*name, number), digits));
        let cells = numbers.iter().map(|(number, digits)| text(*number, *digits));
        let filled = numbers.iter().any(|(number, _)| number.is_some());
        filled.then(|| [name.word().to_owned()].into_iter().chain(cells).collect())
    };
    let columns = COLUMNS.map(|(heading, ..)| heading);
    Some(Table {
        name: "short",
        title: "Past a doorway of 91.4 cm",
        header: headings(&[&[""], columns.as_slice()].concat()),
        words: 1,
        rows: Name::ALL.iter().filter_map(row).collect(),
    })
}

/// A table of one number.
fn table(name: &'static str, title: &'static str, driven: &[Driven], digits: usize, number: Number) -> Table {
    let row = |name: &Name| {
        let numbers: Vec<Option<f64>> = driven.iter().map(|driven| driven.median(*name, number)).collect();
        let cells = numbers.iter().map(|number| text(*number, digits));
        let filled = numbers.iter().any(Option::is_some);
        filled.then(|| [name.word().to_owned()].into_iter().chain(cells).collect())
    };
    Table { name, title, header: worlds(driven), words: 1, rows: Name::ALL.iter().filter_map(row).collect() }
}

fn worlds(driven: &[Driven]) -> Vec<String> {
    headings(&[""]).into_iter().chain(driven.iter().map(|driven| driven.world.to_owned())).collect()
}

/// The points of every method against the world.
pub fn points(driven: &[Driven]) -> [Table; 8] {
    [
        table("points", "Points", driven, 0, POINTS),
        table("azimuth-50", "Azimuth error, median, cm along the arc", driven, 1, AZIMUTH_50),
        table("azimuth-90", "Azimuth error, 90 %, cm along the arc", driven, 1, AZIMUTH_90),
        table("surface-50", "Distance to the nearest surface, median, cm", driven, 1, SURFACE_50),
        table("surface-90", "Distance to the nearest surface, 90 %, cm", driven, 1, SURFACE_90),
        table("coverage", "Coverage, %", driven, 0, COVERAGE),
        table("ghosts", "Ghosts, % of the points", driven, 1, GHOSTS),
        table("doorway", "Doorway, cm of 91.4", driven, 0, DOORWAY),
    ]
}

/// The grids, by the threshold that fits the world best.
pub fn grids(driven: &[Driven]) -> [Table; 3] {
    [
        table(
            "best-surface-50",
            "Best threshold, which a robot can't know: distance to the nearest surface, median, cm",
            driven,
            1,
            |row| cm(row.best.as_ref()?.scores.all.surface_error_m.p50),
        ),
        table("best-coverage", "Best threshold: coverage, %", driven, 0, |row| {
            Some(100.0 * row.best.as_ref()?.scores.all.coverage?)
        }),
        table("best-doorway", "Best threshold: doorway, cm of 91.4", driven, 0, |row| {
            cm(row.best.as_ref()?.scores.all.doorway_width_m)
        }),
    ]
}

/// How many readings each method answers, and how the others do on the same.
pub fn same_readings(driven: &[Driven]) -> [Table; 3] {
    [
        table("answered", "Readings answered, % of those with an echo", driven, 0, ANSWERED),
        table(
            "same-centerline",
            "The centres of the cones on the same readings: azimuth error, median, cm",
            driven,
            1,
            |row| cm(row.same_readings.as_ref()?.centerline_azimuth_error_m.p50),
        ),
        table("same-atm", "atm on the same readings: azimuth error, median, cm", driven, 1, |row| {
            cm(row.same_readings.as_ref()?.atm_azimuth_error_m.p50)
        }),
    ]
}

/// The two that leave readings out, on what both answer.
pub fn both_answer(driven: &[Driven]) -> Table {
    let row = |word: &str, cells: Vec<String>| [word.to_owned()].into_iter().chain(cells).collect();
    let counts = |driven: &Driven| text(median(driven.drives.iter().map(|drive| Some(drive.shared.0))), 0);
    let mut rows = vec![row("readings", driven.iter().map(counts).collect())];
    for (index, name) in SHARED.iter().enumerate() {
        let errors = |driven: &Driven| median(driven.drives.iter().map(|drive| *drive.shared.1.get(index)?));
        rows.push(row(name.word(), driven.iter().map(|driven| text(cm(errors(driven)), 1)).collect()));
    }
    Table {
        name: "both-answer",
        title: "On the readings that atm-median-single and tbf both answer: azimuth error, median, cm",
        header: worlds(driven),
        words: 1,
        rows,
    }
}

/// All that is said of a robot that turned in place.
pub fn turned(driven: &Driven, method: Name) -> [String; 5] {
    let columns: [(Number, usize); 5] = [(POINTS, 0), (AZIMUTH_50, 1), (SURFACE_50, 1), (COVERAGE, 0), (GHOSTS, 1)];
    columns.map(|(number, digits)| text(driven.median(method, number), digits))
}
