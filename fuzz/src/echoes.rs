//! Echoes read back from tables and recordings: the same points whole and in pieces, and scores of whatever can be used.

use std::sync::LazyLock;

use atm::{
    error::Problem,
    log::{Input, echo_log::EchoLog, echo_table::Estimate},
};
use atm_lab::{eval::evaluate, world::World};

use crate::pieces::{pieces, whole};

static DOORWAY: LazyLock<World> = LazyLock::new(|| World::load("doorway", &[]).expect("built in"));

/// The first byte chooses the pieces, none of which is the scores; the rest is the file.
pub fn check(bytes: &[u8]) {
    let Some((&pattern, file)) = bytes.split_first() else { return };
    let at_once = read(whole(file));
    if pattern != 0 {
        assert_eq!(at_once, read(pieces(file, pattern).0));
    } else if let Ok((points, _)) = at_once {
        // Whatever the points are, the scores are numbers or nothing.
        let _ = evaluate(&points[..points.len().min(30)], &DOORWAY, None);
    }
}

type Said = Result<(Vec<Estimate>, Vec<Problem>), String>;

fn read(input: Input) -> Said {
    let (format, input) = input.sniff().map_err(|error| error.to_string())?;
    let mut log = EchoLog::new("-", format, input).map_err(|error| error.to_string())?;
    let (mut points, mut problems) = (Vec::new(), Vec::new());
    while let Some(point) =
        log.next_estimate(&mut |problem| problems.push(problem)).map_err(|error| error.to_string())?
    {
        let finite = |number: Option<f64>| number.is_none_or(f64::is_finite);
        assert!(point.position.x.is_finite() && point.position.y.is_finite());
        assert!(finite(point.azimuth) && finite(point.range), "{point:?}");
        points.push(point);
    }
    Ok((points, problems))
}
