//! Runs the command as a user does, and reads what it wrote.
#![allow(dead_code)] // every test file uses its own part

pub mod cases;
pub mod fault;
pub mod recording;

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use serde_json::Value;
use tempfile::TempDir;

pub const INCH: f64 = 0.0254;
/// Full beam of the Nomad's sensors: 22.5 degrees.
pub const BEAM: f64 = std::f64::consts::PI / 8.0;
/// δ (1/sin θ + 1/tan θ) for 1 in and 30 degrees (Sec. IV-B): 3.732 in.
pub const PAPER_INTERVAL: f64 = INCH * 3.732_050_807_568_877;
pub const HEADER: &str = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance";
pub const CROSSINGS_HEADER: &str = "t,sensor,t_other,sensor_other,x,y,azimuth,angle";
pub const SAMPLE: &str = "examples/doorway.csv";
/// What every run on the sample begins with.
pub const FUSE: [&str; 4] = ["fuse", SAMPLE, "--rig", "nomad200"];
pub const FUSE_STDIN: [&str; 4] = ["fuse", "-", "--rig", "nomad200"];

/// Longer than any run here takes, so that a command that hangs fails its test.
const PATIENCE: Duration = Duration::from_secs(120);

/// The root of the repository, in which the commands run.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// How a run ended, and what it said.
#[derive(Debug)]
pub struct Ran {
    pub status: i32,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

/// Runs `atm` with nothing on standard input.
pub fn atm<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>) -> Ran {
    atm_fed(args, b"")
}

/// Runs `atm` with `input` on standard input. That it never panics holds for every run.
pub fn atm_fed<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>, input: impl AsRef<[u8]>) -> Ran {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_atm"));
    command.args(args).current_dir(root()).timeout(PATIENCE).write_stdin(input.as_ref().to_vec());
    let output = command.output().expect("atm runs");
    let stderr = String::from_utf8(output.stderr).expect("messages are UTF-8");
    assert!(!stderr.contains("panicked"), "{stderr}");
    let status = output.status.code().unwrap_or_else(|| panic!("killed: {}\n{stderr}", output.status));
    Ran { status, stdout: output.stdout, stderr }
}

/// `atm fuse` of the sample with more arguments.
pub fn fuse_sample(more: &[&str]) -> Ran {
    atm(FUSE.iter().chain(more))
}

/// `atm fuse - --rig nomad200` of a log in memory with more arguments.
pub fn fuse_text(log: impl AsRef<[u8]>, more: &[&str]) -> Ran {
    atm_fed(FUSE_STDIN.iter().chain(more), log)
}

impl Ran {
    /// Insists on the exit status.
    #[track_caller]
    pub fn exits(self, status: i32) -> Self {
        assert_eq!(self.status, status, "{}", self.stderr);
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

    /// Insists that standard output is empty.
    #[track_caller]
    pub fn writes_nothing(self) -> Self {
        assert!(self.stdout.is_empty(), "{}", String::from_utf8_lossy(&self.stdout));
        self
    }

    /// Insists that standard output holds exactly these bytes; says where it does not, and not all there is.
    #[track_caller]
    pub fn writes(self, expected: impl AsRef<[u8]>) -> Self {
        assert_same(&self.stdout, expected.as_ref());
        self
    }

    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("output is UTF-8")
    }

    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(self.text()).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    #[track_caller]
    pub fn echoes(&self) -> Vec<Echo> {
        echoes(self.text())
    }
}

/// A directory that goes when the test ends, and names in it.
pub struct Scratch(TempDir);

impl Scratch {
    pub fn new() -> Self {
        Self(TempDir::new().expect("a directory for the test"))
    }

    /// A name in the directory.
    pub fn name(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a path in UTF-8").to_owned()
    }

    /// A new file.
    pub fn file(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        let path = self.name(name);
        fs::write(&path, text).expect("a file for the test");
        path
    }

    /// The files there are, sorted.
    pub fn list(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("the test's directory");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }
}

#[track_caller]
pub fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[track_caller]
pub fn read_json(path: &str) -> Value {
    serde_json::from_str(&read(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The sample log's text.
pub fn sample() -> String {
    read(root().join(SAMPLE).to_str().expect("a path in UTF-8"))
}

/// One row of a long table with poses, its cells as they stand there.
#[derive(Debug, Clone)]
pub struct Row {
    pub t: String,
    pub sensor: String,
    pub range: String,
    pub x: String,
    pub y: String,
    pub yaw: String,
}

/// The rows of the sample log.
pub fn sample_rows() -> Vec<Row> {
    let row = |line: &str| {
        let cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let [t, sensor, range, x, y, yaw] = cells.try_into().expect("six cells");
        Row { t, sensor, range, x, y, yaw }
    };
    sample().lines().skip(1).map(row).collect()
}

impl Row {
    pub fn time(&self) -> f64 {
        number(&self.t)
    }

    /// The range where it is an echo to the Nomad: from 6 in on, below 255 in.
    pub fn echo(&self) -> Option<f64> {
        let range = number(&self.range);
        (6.0 * INCH..255.0 * INCH).contains(&range).then_some(range)
    }

    /// Position and direction of the sensor: 9 in from the robot's middle, a sixteenth of a turn from one to the next.
    pub fn sensor_pose(&self) -> (f64, f64, f64) {
        let direction = number(&self.yaw) + number(&self.sensor) * BEAM;
        let (sin, cos) = direction.sin_cos();
        (number(&self.x) + 9.0 * INCH * cos, number(&self.y) + 9.0 * INCH * sin, direction)
    }
}

#[track_caller]
pub fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|error| panic!("`{text}`: {error}"))
}

/// One row of an echo table.
#[derive(Debug, Clone, PartialEq)]
pub struct Echo {
    pub t: String,
    pub sensor: String,
    pub x: f64,
    pub y: f64,
    pub kind: String,
    pub range: f64,
    pub azimuth: f64,
    pub crossings: usize,
    pub resolution: f64,
    pub significance: f64,
}

impl Echo {
    /// Which reading it belongs to.
    pub fn key(&self) -> (String, String) {
        (self.t.clone(), self.sensor.clone())
    }

    pub fn is(&self, kind: &str) -> bool {
        self.kind == kind
    }
}

/// Reads an echo table, and insists on its form.
#[track_caller]
pub fn echoes(table: &str) -> Vec<Echo> {
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some(HEADER));
    assert!(table.ends_with('\n'), "the last row has no end");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [t, sensor, x, y, kind, range, azimuth, crossings, resolution, significance] = cells[..] else {
            panic!("not ten cells: {line}");
        };
        Echo {
            t: t.to_owned(),
            sensor: sensor.to_owned(),
            x: number(x),
            y: number(y),
            kind: kind.to_owned(),
            range: number(range),
            azimuth: number(azimuth),
            crossings: crossings.parse().expect("a whole number"),
            resolution: number(resolution),
            significance: number(significance),
        }
    };
    lines.map(row).collect()
}

/// Rows of an echo table of one kind.
pub fn count(echoes: &[Echo], kind: &str) -> usize {
    echoes.iter().filter(|echo| echo.is(kind)).count()
}

/// Runs with `--summary`, and returns the counts beside how it ended.
pub fn with_summary(args: &[&str], input: impl AsRef<[u8]>) -> (Ran, Value) {
    let scratch = Scratch::new();
    let path = scratch.name("counts.json");
    let ran = atm_fed(args.iter().copied().chain(["--summary", &path]), input);
    let summary = read_json(&path);
    (ran, summary)
}

/// A count in a summary, by its path (`/skipped/held`).
#[track_caller]
pub fn tally(summary: &Value, path: &str) -> u64 {
    summary.pointer(path).and_then(Value::as_u64).unwrap_or_else(|| panic!("no count {path} in {summary}"))
}

/// Compares two texts byte by byte; shows the first line that differs.
#[track_caller]
pub fn assert_same(found: &[u8], expected: &[u8]) {
    let lines = |bytes| String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect::<Vec<_>>();
    let (found_lines, expected_lines) = (lines(found), lines(expected));
    for (index, pair) in found_lines.iter().zip(&expected_lines).enumerate() {
        assert_eq!(pair.0, pair.1, "line {} differs", index + 1);
    }
    assert_eq!(found_lines.len(), expected_lines.len(), "the number of lines differs");
    assert!(found == expected, "the line ends differ");
}

#[track_caller]
pub fn assert_near(value: f64, expected: f64, slack: f64) {
    assert!((value - expected).abs() <= slack, "{value} is not {expected} within {slack}");
}
