//! Runs that something happens to: started, disturbed, and looked at afterwards.

use std::{
    fmt::Write as _,
    fs,
    io::Read,
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use super::{Ran, Row, atm_fed, number, root, sample_rows};

/// Far longer than anything here takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// The sample's drive again and again, time going on: a log of `count` rows.
pub fn drive(count: usize) -> String {
    let rows: Vec<(f64, String)> = sample_rows()
        .into_iter()
        .map(|Row { t, sensor, range, x, y, yaw }| (number(&t), format!("{sensor},{range},{x},{y},{yaw}")))
        .collect();
    let mut log = String::from("t,sensor,range,x,y,yaw\n");
    for (index, (t, row)) in rows.iter().cycle().take(count).enumerate() {
        writeln!(log, "{},{row}", t + 49.0 * (index / rows.len()) as f64).expect("memory");
    }
    log
}

/// What an undisturbed run of the log writes.
pub fn undisturbed(log: &str, more: &[&str]) -> String {
    let Ran { status, stdout, stderr } = atm_fed(super::FUSE_STDIN.iter().chain(more), log);
    assert!(status == 0 || status == 3, "{stderr}");
    String::from_utf8(stdout).expect("output is UTF-8")
}

/// A run that goes on while the test does something to it.
pub struct Running(pub Child);

/// How it ended, and what it said.
pub struct Ended {
    pub status: ExitStatus,
    pub stderr: String,
}

impl Running {
    /// Starts `atm`.
    pub fn start(args: &[&str], stdin: impl Into<Stdio>, stdout: impl Into<Stdio>) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_atm"));
        Self::start_as(command.args(args), stdin, stdout)
    }

    /// Starts any command.
    pub fn start_as(command: &mut Command, stdin: impl Into<Stdio>, stdout: impl Into<Stdio>) -> Self {
        let command = command.current_dir(root()).stdin(stdin).stdout(stdout).stderr(Stdio::piped());
        Self(command.spawn().expect("the command starts"))
    }

    /// Sends a signal by its name.
    pub fn signal(&self, name: &str) {
        let pid = self.0.id().to_string();
        let sent = Command::new("sh").args(["-c", "kill -s \"$0\" \"$1\"", name, &pid]).status();
        assert!(sent.expect("a shell").success());
    }

    /// Waits until `ready` says so.
    #[track_caller]
    pub fn until(&self, mut ready: impl FnMut() -> bool) {
        let end = Instant::now() + PATIENCE;
        while !ready() {
            assert!(Instant::now() < end, "it never came to that");
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits for the end. That it never panics, and ends, holds for every run.
    #[track_caller]
    pub fn ends(mut self) -> Ended {
        let end = Instant::now() + PATIENCE;
        let mut stderr = self.0.stderr.take().expect("its messages");
        let words = thread::spawn(move || {
            let mut words = String::new();
            stderr.read_to_string(&mut words).expect("messages are UTF-8");
            words
        });
        let status = loop {
            match self.0.try_wait().expect("its end") {
                Some(status) => break status,
                None if Instant::now() > end => {
                    self.0.kill().expect("its end");
                    panic!("it goes on and on");
                }
                None => thread::sleep(Duration::from_millis(2)),
            }
        };
        let stderr = words.join().expect("the reader's end");
        assert!(!stderr.contains("panicked"), "{stderr}");
        Ended { status, stderr }
    }
}

impl Ended {
    /// Insists on the exit status.
    #[track_caller]
    pub fn exits(self, status: i32) -> Self {
        assert_eq!(self.status.code(), Some(status), "{}: {}", self.status, self.stderr);
        self
    }

    /// Insists that standard error holds each of `words`.
    #[track_caller]
    pub fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.stderr.contains(word), "no `{word}` in: {}", self.stderr);
        }
        self
    }
}

/// Insists that a file holds the beginning of what an undisturbed run writes; returns how much.
#[track_caller]
pub fn begins(path: &str, undisturbed: &str) -> usize {
    let written = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    assert!(undisturbed.starts_with(&written), "{path} is no beginning of what an undisturbed run writes");
    written.len()
}

/// Straight to standard error: what a passing test prints is not shown.
pub fn skipped(why: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stderr(), "*** SKIPPED: {why} ***");
}
