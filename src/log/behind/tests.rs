use std::sync::{Arc, Mutex};

use atm_core::{
    Beam, Bounds, Echo, Fuser, Isometry2, LatestArrays, Limits, Point2, RangeResolution, Reading, TransversalMedian,
};

use super::*;
use crate::echo::AnyEcho;

/// What was written, for whoever looks; after `room` bytes there is no more of it.
#[derive(Clone)]
struct Shared {
    bytes: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Shared {
    fn new(room: usize) -> Self {
        Self { bytes: Arc::default(), room }
    }

    fn text(&self) -> String {
        String::from_utf8(self.bytes.lock().unwrap().clone()).unwrap()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut written = self.bytes.lock().unwrap();
        if written.len() + bytes.len() > self.room {
            return Err(io::Error::from_raw_os_error(28));
        }
        written.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Echoes that differ in time and place.
fn echoes(count: usize) -> Vec<AnyEcho> {
    let mut fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::<f64, 1, 1>::new());
    let mut all = Vec::new();
    for index in 0..count {
        let reading = Reading {
            t: index as i64,
            sensor: 0,
            range: Limits::NONE.classify(1.0 + index as f64 / 7.0),
            pose: Isometry2::identity(),
            robot: Point2::origin(),
            beam: Beam::new(0.4).unwrap(),
            range_resolution: RangeResolution::new(0.01).unwrap(),
        };
        fuser.push(&reading, &mut |echo: &Echo<f64>| all.push((*echo).into())).unwrap();
    }
    all
}

fn at_once(echoes: &[AnyEcho]) -> String {
    let mut table = TableWriter::echoes(Vec::new(), ["left"]).unwrap();
    echoes.iter().try_for_each(|echo| table.echo(echo)).unwrap();
    String::from_utf8(table.into_inner()).unwrap()
}

fn behind(out: &Shared) -> Behind<AnyEcho, Shared> {
    Behind::new(TableWriter::echoes(out.clone(), ["left"]).unwrap()).unwrap()
}

#[test]
fn rows_are_written_as_without_a_thread() {
    for count in [0, 1, ROWS - 1, ROWS, ROWS + 1, 10 * ROWS + 3] {
        let (echoes, out) = (echoes(count), Shared::new(usize::MAX));
        let mut table = behind(&out);
        echoes.iter().try_for_each(|echo| table.push(*echo)).unwrap();
        assert!(table.into_table().unwrap().is_some());
        assert!(out.text() == at_once(&echoes), "{count}");
    }
}

#[test]
fn what_was_flushed_has_been_written() {
    let (echoes, out) = (echoes(ROWS + 10), Shared::new(usize::MAX));
    let mut table = behind(&out);
    for (index, echo) in echoes.iter().enumerate() {
        table.push(*echo).unwrap();
        if index % 100 == 0 {
            table.flush().unwrap();
            assert!(out.text() == at_once(&echoes[..=index]), "{index}");
        }
    }
}

#[test]
fn error_of_the_writer_is_said_and_said_again() {
    let (echoes, out) = (echoes(20 * ROWS), Shared::new(50_000));
    let mut table = behind(&out);
    let pushed = echoes.iter().try_for_each(|echo| table.push(*echo)).unwrap_err();
    assert_eq!(pushed.kind(), io::ErrorKind::StorageFull);
    for _ in 0..2 {
        assert_eq!(table.flush().unwrap_err().raw_os_error(), Some(28));
    }
    assert_eq!(table.into_table().err().map(|error| error.kind()), Some(io::ErrorKind::StorageFull));
    // What went before is there, to the last whole row.
    let text = out.text();
    assert!(at_once(&echoes).starts_with(&text) && text.ends_with('\n') && text.len() > 49_000);
}

#[test]
fn error_of_the_last_rows_is_said_by_the_flush() {
    let out = Shared::new(200);
    let mut table = behind(&out);
    echoes(10).iter().try_for_each(|echo| table.push(*echo)).unwrap();
    assert_eq!(table.flush().unwrap_err().kind(), io::ErrorKind::StorageFull);
}
