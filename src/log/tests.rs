use std::io::{Cursor, Read};

use super::*;

/// An input whose name in messages is `log.csv`.
pub(super) fn input(text: impl Into<Vec<u8>>) -> Input {
    Input { reader: Box::new(Cursor::new(text.into())), name: Arc::from("log.csv"), length: None }
}

/// The same, one byte a read, every other read interrupted.
pub(super) fn stuttering(text: impl Into<Vec<u8>>) -> Input {
    Input { reader: Box::new(Stutter { bytes: text.into(), at: 0, interrupt: false }), ..input("") }
}

/// The same, and then an error.
pub(super) fn broken(text: impl Into<Vec<u8>>) -> Input {
    Input { reader: Box::new(Cursor::new(text.into()).chain(Broken)), ..input("") }
}

/// What a reading of a format error says.
pub(super) fn message<T>(result: Result<T>) -> String {
    match result {
        Ok(_) => panic!("was accepted"),
        Err(error) => error.to_string(),
    }
}

struct Stutter {
    bytes: Vec<u8>,
    at: usize,
    interrupt: bool,
}

impl Read for Stutter {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        self.interrupt = !self.interrupt;
        if self.interrupt {
            return Err(io::ErrorKind::Interrupted.into());
        }
        let (Some(from), Some(to)) = (self.bytes.get(self.at), out.first_mut()) else {
            return Ok(0);
        };
        *to = *from;
        self.at += 1;
        Ok(1)
    }
}

struct Broken;

impl Read for Broken {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::Error::other("the disk is on fire"))
    }
}

#[test]
fn a_missing_file_is_named() {
    assert!(message(Input::open("/no/such/log.csv")).starts_with("/no/such/log.csv: "));
}

#[test]
fn a_directory_is_no_log() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_str().unwrap();
    assert_eq!(message(Input::open(path)), format!("{path}: is a directory, not a file"));
}

#[test]
fn a_minus_is_standard_input() {
    let input = Input::open("-").unwrap();
    assert_eq!((&*input.name, input.length), ("standard input", None));
}

#[test]
fn a_regular_file_tells_its_length() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv");
    fs::write(&path, "t,sensor,range\n").unwrap();
    assert_eq!(Input::open(path.to_str().unwrap()).unwrap().length, Some(15));
}
