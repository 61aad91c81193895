//! The driver against lines that expect every step of the data sheet's timing diagram.

use std::task::Poll;

use embedded_hal_mock::eh1::{
    MockError,
    digital::{Mock, State, Transaction},
};
use hc_sr04::{Air, Bank, Error, HcSr04, Measurement, Turns};

type Sensor = HcSr04<Mock, Mock>;

fn get(state: State) -> Transaction {
    Transaction::get(state)
}

/// The trigger line of one measurement.
fn one_pulse() -> Mock {
    Mock::new(&[Transaction::set(State::High), Transaction::set(State::Low)])
}

/// A sensor whose echo line is asked for these states in turn, and the lines to be checked at the end.
fn sensor(trigger: Mock, echo: &[State]) -> (Sensor, [Mock; 2]) {
    let echo = Mock::new(&echo.iter().copied().map(get).collect::<Vec<_>>());
    (HcSr04::new(trigger.clone(), echo.clone()), [trigger, echo])
}

fn done(lines: [Mock; 2]) {
    for mut line in lines {
        line.done();
    }
}

#[test]
fn a_pulse_of_5830_microseconds_is_a_metre_at_20_degrees() {
    let (mut sensor, lines) = sensor(one_pulse(), &[State::Low, State::Low, State::High, State::High, State::Low]);
    // Across the wrap of the clock.
    let start = u32::MAX - 200;
    let at = |microseconds: u32| start.wrapping_add(microseconds);
    sensor.start(start).unwrap();
    assert_eq!(sensor.deadline(), Some(at(10)));
    assert_eq!(sensor.poll(at(9)), Ok(Poll::Pending), "the trigger line stays high for 10 µs");
    assert_eq!(sensor.poll(at(10)), Ok(Poll::Pending));
    assert_eq!(sensor.poll(at(100)), Ok(Poll::Pending), "the burst");
    assert_eq!(sensor.poll(at(460)), Ok(Poll::Pending), "the echo line rises");
    assert_eq!(sensor.poll(at(3_000)), Ok(Poll::Pending));
    let Ok(Poll::Ready(measurement)) = sensor.poll(at(460 + 5_830)) else { panic!("no measurement") };
    assert_eq!(measurement, Measurement::Echo { microseconds: 5_830 });
    assert!((measurement.range(&Air::at_celsius(20.0).unwrap()) - 1.0).abs() < 0.001);
    assert_eq!(sensor.deadline(), None);
    assert_eq!(sensor.poll(at(7_000)), Ok(Poll::Pending), "nothing is under way");
    done(lines);
}

#[test]
fn a_pulse_longer_than_any_echo_is_nothing_there() {
    for width in [26_001, 38_000] {
        let (mut sensor, lines) = sensor(one_pulse(), &[State::Low, State::High, State::Low]);
        sensor.start(0).unwrap();
        for now in [10, 500] {
            assert_eq!(sensor.poll(now), Ok(Poll::Pending));
        }
        assert_eq!(sensor.poll(500 + width), Ok(Poll::Ready(Measurement::Beyond)));
        done(lines);
    }
    assert_eq!(Measurement::Beyond.range(&Air::at_celsius(0.0).unwrap()), f32::INFINITY);
}

#[test]
fn the_longest_echo_is_still_one() {
    let (mut sensor, lines) = sensor(one_pulse(), &[State::Low, State::High, State::Low]);
    sensor.start(0).unwrap();
    for now in [10, 500] {
        assert_eq!(sensor.poll(now), Ok(Poll::Pending));
    }
    assert_eq!(sensor.poll(26_500), Ok(Poll::Ready(Measurement::Echo { microseconds: 26_000 })));
    done(lines);
}

#[test]
fn an_echo_line_that_never_falls_is_given_up() {
    let (mut sensor, lines) = sensor(one_pulse(), &[State::Low, State::High, State::High, State::High]);
    sensor.start(0).unwrap();
    for now in [10, 500, 40_499] {
        assert_eq!(sensor.poll(now), Ok(Poll::Pending));
    }
    assert_eq!(sensor.deadline(), Some(40_500));
    assert_eq!(sensor.poll(40_500), Ok(Poll::Ready(Measurement::Beyond)));
    done(lines);
}

#[test]
fn a_sensor_that_is_not_there_is_silent() {
    let (mut sensor, lines) = sensor(one_pulse(), &[State::Low, State::Low, State::Low]);
    sensor.start(0).unwrap();
    for now in [10, 5_009] {
        assert_eq!(sensor.poll(now), Ok(Poll::Pending));
    }
    assert_eq!(sensor.poll(5_010), Ok(Poll::Ready(Measurement::Silent)));
    assert!(Measurement::Silent.range(&Air::at_celsius(0.0).unwrap()).is_nan());
    done(lines);
}

#[test]
fn no_burst_is_sent_while_the_last_pulse_lasts() {
    let echo = [State::High, State::High, State::Low, State::Low, State::High, State::Low];
    let (mut sensor, lines) = sensor(one_pulse(), &echo);
    sensor.start(0).unwrap();
    assert_eq!(sensor.poll(10_000), Ok(Poll::Pending), "the line is still high");
    assert_eq!(sensor.poll(20_000), Ok(Poll::Pending), "now it is low, and the trigger line is raised");
    assert_eq!(sensor.deadline(), Some(20_010));
    for now in [20_010, 20_500] {
        assert_eq!(sensor.poll(now), Ok(Poll::Pending));
    }
    assert_eq!(sensor.poll(21_500), Ok(Poll::Ready(Measurement::Echo { microseconds: 1_000 })));
    done(lines);
}

#[test]
fn a_line_that_fails_says_which() {
    let failing = MockError::Io(std::io::ErrorKind::NotConnected);
    let trigger = Mock::new(&[Transaction::set(State::High).with_error(failing.clone())]);
    let (mut sensor, lines) = sensor(trigger, &[State::Low]);
    assert_eq!(sensor.start(0), Err(Error::Trigger(failing)));
    assert_eq!(sensor.deadline(), None);
    done(lines);
}

#[test]
fn a_bank_lets_its_sensors_measure_one_after_another() {
    let measuring = |lines: &mut Vec<[Mock; 2]>| {
        let (sensor, own) = sensor(one_pulse(), &[State::Low, State::High, State::Low]);
        lines.push(own);
        sensor
    };
    let mut lines = Vec::new();
    let mut bank = Bank::new([measuring(&mut lines), measuring(&mut lines), measuring(&mut lines)], Turns::new());
    let mut found = Vec::new();
    for turn in 0..3u32 {
        let start = turn * 60_000;
        assert_eq!(bank.poll(start), Ok(Poll::Pending));
        assert_eq!(bank.active(), Some(turn as u16));
        for wait in [10, 500] {
            assert_eq!(bank.poll(start + wait), Ok(Poll::Pending));
        }
        let Ok(Poll::Ready(measured)) = bank.poll(start + 500 + 1_000 * (turn + 1)) else { panic!("turn {turn}") };
        found.push(measured);
        assert_eq!(bank.deadline(), Some(start + 60_000));
        assert_eq!(bank.poll(start + 59_999), Ok(Poll::Pending), "no sensor is started before the pause is over");
        assert_eq!(bank.active(), None);
    }
    let expected =
        [(0, 1_000), (1, 2_000), (2, 3_000)].map(|(sensor, microseconds)| (sensor, Measurement::Echo { microseconds }));
    assert_eq!(found, expected);
    for own in lines {
        done(own);
    }
}
