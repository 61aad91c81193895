//! `atm plan`: equation (2) both ways.

use atm::core::{MinAngle, resolution};
use serde_json::json;

use crate::{Failure, Outcome, args::Plan};

/// H of the paper, for which the plan says how far it reaches.
const PAPER_HISTORY: u32 = 10;

/// Inches are what the paper's table speaks; the plan shows both.
const INCH: f64 = 0.0254;

struct Numbers {
    interval: f64,
    improvement: f64,
    min_angle: MinAngle<f64>,
    close_range: f64,
    travel: f64,
    /// Readings needed, and how far H readings reach, where speed and rate are known.
    motion: Option<(u32, f64)>,
}

/// Runs the command.
pub fn run(args: &Plan) -> Result<Outcome, Failure> {
    let numbers = numbers(args)?;
    let text = if args.json { as_json(&numbers) } else { as_text(args, &numbers) };
    crate::print(&text)
}

fn numbers(args: &Plan) -> Result<Numbers, Failure> {
    let (beam, delta, distance) = (&args.fov, args.range_resolution, args.distance);
    let usage = |error: atm::core::DomainError| Failure::Usage(error.to_string());
    let min_angle = match (args.min_angle, args.improvement) {
        (Some(angle), _) => angle,
        (None, Some(improvement)) => resolution::min_angle_for(improvement, distance, beam, delta).map_err(usage)?,
        (None, None) => return Err(Failure::Usage("one of --min-angle and --improvement is needed".into())),
    };
    let travel = resolution::travel(distance, &min_angle).map_err(usage)?;
    let motion = match (args.speed, args.rate) {
        (Some(speed), Some(rate)) => Some((
            resolution::readings_needed(travel, speed, rate).map_err(usage)?,
            resolution::reach(PAPER_HISTORY, speed, rate, &min_angle).map_err(usage)?,
        )),
        _ => None,
    };
    Ok(Numbers {
        interval: resolution::interval(delta, &min_angle),
        improvement: resolution::improvement(distance, beam, delta, &min_angle).map_err(usage)?,
        min_angle,
        close_range: resolution::close_range(beam, delta, &min_angle),
        travel,
        motion,
    })
}

fn as_json(numbers: &Numbers) -> String {
    let object = json!({
        "interval_m": numbers.interval,
        "improvement": numbers.improvement,
        "min_angle_rad": numbers.min_angle.radians(),
        "close_range_m": numbers.close_range,
        "travel_m": numbers.travel,
        "readings": numbers.motion.map(|(readings, _)| readings),
        "history_reach_m": numbers.motion.map(|(_, reach)| reach),
    });
    format!("{object:#}\n")
}

fn as_text(args: &Plan, numbers: &Numbers) -> String {
    let length = |metres: f64| format!("{:>8.3} m  ({:.2} in)", metres, metres / INCH);
    let mut text = format!(
        "at {:.3} m ({:.2} in), beam {:.2} deg, range resolution {:.4} m\n\
         min angle    {:>8.2} deg  crossings count from here on\n\
         interval   {}  along the arc in which an echo lies\n\
         gain         {:>8.2} x    finer than the whole arc\n\
         close range{}  up to here the arc's centre is as good\n\
         travel     {}  until arcs on one point cross at that angle\n",
        args.distance,
        args.distance / INCH,
        args.fov.field_of_view().to_degrees(),
        args.range_resolution.metres(),
        numbers.min_angle.radians().to_degrees(),
        length(numbers.interval),
        numbers.improvement,
        length(numbers.close_range),
        length(numbers.travel),
    );
    if numbers.improvement < 1.0 {
        text.push_str("note: at this distance the whole arc is shorter than the interval; nothing is gained\n");
    }
    match numbers.motion {
        Some((readings, reach)) => {
            text += &format!("readings     {readings:>8}      of one sensor on the way, the first included\n");
            text +=
                &format!("reach      {}  is as far as the paper's {PAPER_HISTORY} readings take it\n", length(reach));
            if readings > PAPER_HISTORY {
                text += &format!(
                    "note: {PAPER_HISTORY} readings (--preset paper) are too few for this distance; the local map spans the \
                     travel with --reach {:.3}m\n",
                    args.distance
                );
            }
        }
        None => text.push_str("readings            -      needs --speed and --rate\n"),
    }
    text
}
