use std::{
    io::Read,
    sync::mpsc::{Receiver, channel},
    time::Duration,
};

use super::*;
use crate::{
    log::{
        Input,
        csv::{CsvReadings, Discover, PoseUse},
        tests::{broken, input},
    },
    rig::TableFormat,
};

fn log(input: Input) -> CsvReadings<Discover> {
    CsvReadings::new(input, &TableFormat::default(), PoseUse::Needed, None, Discover::default()).unwrap()
}

/// Rows of ever more sensors, now and then one that can't be used.
fn rows(count: usize) -> String {
    let mut text = String::from("t,sensor,range,x,y,yaw\n");
    for row in 0..count {
        let range = if row % 7 == 3 { "far".to_owned() } else { format!("{}", row % 11) };
        text.push_str(&format!("{row},s{},{range},{row},0,0\n", row / 100));
    }
    text
}

/// All that a source says, in the order in which it says it.
fn said(source: &mut dyn Source) -> Vec<String> {
    let (mut row, mut all) = (Row::default(), vec![format!("{} {:?}", source.has_poses(), source.ids())]);
    loop {
        let next = source.next_row(&mut row, &mut |problem| all.push(problem.to_string()));
        let ended = !matches!(next, Ok(Next::Record | Next::Unusable));
        match next {
            Ok(Next::Record) => all.push(format!("{row:?}")),
            other => all.push(format!("{other:?}")),
        }
        all.push(format!("{} {}", source.ids().len(), source.position()));
        if ended {
            return all;
        }
    }
}

#[test]
fn records_problems_sensors_and_positions_come_as_from_the_source_itself() {
    for count in [0, 1, RECORDS - 1, RECORDS, RECORDS + 1, 3000] {
        let text = rows(count);
        let expected = said(&mut log(input(text.clone())));
        for live in [false, true] {
            assert_eq!(said(&mut Ahead::new(log(input(text.clone())), live).unwrap()), expected, "{count} {live}");
        }
    }
}

#[test]
fn error_comes_after_the_rows_before_it() {
    let text = rows(1000);
    let expected = said(&mut log(broken(text.clone())));
    assert!(expected.iter().any(|said| said.starts_with("Err")), "the reader does break");
    assert_eq!(said(&mut Ahead::new(log(broken(text)), false).unwrap()), expected);
}

#[test]
fn nothing_comes_after_the_end() {
    let mut source = Ahead::new(log(input(rows(3))), false).unwrap();
    said(&mut source);
    for _ in 0..3 {
        assert_eq!(source.next_row(&mut Row::default(), &mut |_| ()).unwrap(), Next::End);
    }
}

/// A reader that waits for what is sent to it.
struct Waiting(Receiver<&'static str>);

impl Read for Waiting {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let piece = self.0.recv().unwrap_or("");
        bytes[..piece.len()].copy_from_slice(piece.as_bytes());
        Ok(piece.len())
    }
}

#[test]
fn row_of_a_live_log_is_handed_on_before_the_next_one_is_there() {
    let (send, receive) = channel();
    send.send("t,sensor,range,x,y,yaw\n").unwrap();
    let waiting = Input { reader: Box::new(Waiting(receive)), ..input("") };
    let mut source = Ahead::new(log(waiting), true).unwrap();
    let mut row = Row::default();
    for line in ["1,a,1,0,0,0\n", "2,a,1,0,0,0\n", "3,a,1,0,0,0\n4,a,1,0,0,0\n"] {
        assert!(source.drained(), "before {line:?}");
        send.send(line).unwrap();
        for _ in line.lines() {
            assert_eq!(source.next_row(&mut row, &mut |_| ()).unwrap(), Next::Record);
        }
    }
    assert_eq!(row.t, 4_000_000_000);
    // Nobody waits for a log that says nothing any more.
    drop(source);
    drop(send);
}

/// A source that goes wrong in a way it should not.
struct Panicking;

impl Source for Panicking {
    fn next_row(&mut self, _: &mut Row, _: &mut dyn FnMut(Problem)) -> Result<Next> {
        panic!("on the other thread");
    }
    fn drained(&self) -> bool {
        false
    }
    fn position(&self) -> u64 {
        0
    }
    fn has_poses(&self) -> bool {
        true
    }
    fn ids(&self) -> &[Arc<str>] {
        &[]
    }
}

#[test]
#[should_panic(expected = "on the other thread")]
fn panic_of_the_thread_is_the_callers() {
    let mut source = Ahead::new(Panicking, false).unwrap();
    let _ = source.next_row(&mut Row::default(), &mut |_| ());
}

/// Counts the records it has been asked for.
struct Endless(SyncSender<()>, Row);

impl Source for Endless {
    fn next_row(&mut self, row: &mut Row, _: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.clone_from(&self.1);
        let _ = self.0.try_send(());
        Ok(Next::Record)
    }
    fn drained(&self) -> bool {
        false
    }
    fn position(&self) -> u64 {
        0
    }
    fn has_poses(&self) -> bool {
        true
    }
    fn ids(&self) -> &[Arc<str>] {
        &[]
    }
}

#[test]
fn no_more_is_read_ahead_than_a_few_batches() {
    // Those that wait, the one that is handed over, and the one that is being filled.
    for (readings, at_most) in
        [(0, (WAITING + 2) * RECORDS), (WEIGHT / 2, (WAITING + 2) * 2), (2 * WEIGHT, WAITING + 2)]
    {
        let (count, counted) = sync_channel(1 << 20);
        let row = Row { readings: vec![(0, 1.0); readings], ..Row::default() };
        let source = Ahead::new(Endless(count, row), false).unwrap();
        counted.recv().expect("it begins");
        let mut records = 1;
        while counted.recv_timeout(Duration::from_millis(100)).is_ok() {
            records += 1;
        }
        assert!(records <= at_most, "{records} records of {readings} readings");
        drop(source);
    }
}
