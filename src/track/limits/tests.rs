use super::*;

const S: u64 = 1_000_000_000;

fn every(period: u64, count: u64) -> Periods {
    let mut periods = Periods::default();
    (0..count).for_each(|number| periods.tick((number * period) as i64));
    periods
}

fn moved(distance: f64) -> Step {
    Step { distance, turn: 0.0 }
}

#[test]
fn a_speed_beyond_the_limit_is_too_fast_and_jitter_is_not() {
    let limit = MotionLimit::DEFAULT;
    assert!(limit.allows(moved(1.0), S / 10));
    assert!(!limit.allows(moved(1.2), S / 10));
    assert!(limit.allows(moved(0.04), 1), "a few centimetres between stamps that nearly agree");
    assert!(limit.allows(Step { distance: 0.0, turn: 2.0 }, S / 10));
    assert!(!limit.allows(Step { distance: 0.0, turn: 2.2 }, S / 10));
    assert!(!limit.allows(moved(f64::NAN), S));
    assert!(MotionLimit::NONE.allows(moved(1e9), 1));
    assert_eq!(MotionLimit::new(0.0), None);
    assert_eq!(MotionLimit::new(f64::NAN), None);
}

#[test]
fn poses_that_always_come_once_a_second_do_where_nobody_says_otherwise() {
    let at = Between { since: S / 1000, until: S - S / 1000 };
    let own = PoseLimits::default();
    assert_eq!(own.check(at, moved(0.3), &every(S, 5)), Ok(true));
    // Too few to know, a gap among frequent ones, and a robot that is somewhere else by then.
    for (step, periods) in [(0.3, every(S, 2)), (0.3, every(S / 10, 50)), (0.6, every(S, 5))] {
        let step = moved(step);
        assert_eq!(own.check(at, step, &periods), Err(PoseMiss::Gap { between: S, step }));
    }
    let named = PoseLimits { gap: GapLimit::of(Some(S / 2)), ..own };
    assert!(named.check(at, moved(0.0), &every(S, 5)).is_err(), "what somebody names is meant");
    assert_eq!(PoseLimits { gap: GapLimit::of(Some(S)), ..own }.check(at, moved(0.3), &every(S, 2)), Ok(false));
}

#[test]
fn the_gap_that_is_advised_would_do() {
    let miss = PoseMiss::Gap { between: 1_500_000_001, step: moved(0.3) };
    assert!(miss.to_string().contains("--max-gap 1.501s"), "{miss}");
}
