//! Holds an image and what it printed against the host and the limits.

use std::{collections::BTreeMap, error::Error, fs, path::Path};

use atm_core::{Consensus, TransversalMedian};
use replay::{Fault, Log};

use crate::{
    elf::{Image, is_heap, is_soft_double},
    reference::{Judged, Reference, Tally, run},
};

/// What there is to judge.
pub struct Exhibits<'a> {
    /// Processor and estimator, `cortex-m4f` or `cortex-m4f-consensus`: a section of the limits.
    pub name: &'a str,
    /// The image.
    pub image: &'a str,
    /// What it printed.
    pub output: &'a str,
    /// The recorded log.
    pub log: &'a str,
    /// The limits.
    pub limits: &'a str,
}

type Limits = BTreeMap<String, BTreeMap<String, u64>>;

/// What came out, line by line.
struct Verdict {
    all_well: bool,
}

impl Verdict {
    fn check(&mut self, well: bool, what: &str) {
        self.all_well &= well;
        println!("{:4}  {what}", if well { "ok" } else { "FAIL" });
    }

    /// A figure beside its limit; without one it is only told.
    fn figure(&mut self, what: &str, value: u64, limit: Option<&u64>) {
        match limit {
            Some(&limit) => self.check(value <= limit, &format!("{what:50} {value:>8}   limit {limit:>8}")),
            None => println!("      {what:50} {value:>8}"),
        }
    }
}

/// Prints a line for each check; whether all of them passed.
pub fn judge(exhibits: &Exhibits<'_>) -> Result<bool, Box<dyn Error>> {
    if exhibits.name.ends_with("-consensus") {
        judge_estimator::<Consensus<f32>>(exhibits, "f64-consensus")
    } else {
        judge_estimator::<TransversalMedian<f32>>(exhibits, "f64")
    }
}

fn judge_estimator<E: Judged>(exhibits: &Exhibits<'_>, f64_limits: &str) -> Result<bool, Box<dyn Error>> {
    let limits: Limits = toml::from_str(&fs::read_to_string(exhibits.limits)?)?;
    let (log, output) = (read(exhibits.log)?, read(exhibits.output)?);
    let log = Log::new(&log).ok_or("the log is damaged")?;
    let reference = run::<E>(&log)?;
    let printed = Printed::parse(&String::from_utf8_lossy(&output));
    let mut verdict = Verdict { all_well: true };
    println!("      {} sweeps of {} sensors, H = {}", log.sweeps(), replay::SENSORS, replay::HISTORY);
    compare(&mut verdict, &reference, &printed);
    precision(&mut verdict, &reference, limits.get(f64_limits).ok_or("no limits for f64")?);
    faults(&mut verdict, &reference.faults);
    let own = limits.get(exhibits.name).cloned().unwrap_or_default();
    verdict.check(
        reference.worst == E::WORST,
        &format!("an adversary's reading has {} of {} {}", reference.worst, E::WORST, E::COUNTED),
    );
    cost(&mut verdict, &printed, &own)?;
    contents(&mut verdict, &Image::read(&read(exhibits.image)?)?, &own);
    Ok(verdict.all_well)
}

fn read(path: &str) -> Result<Vec<u8>, String> {
    fs::read(Path::new(path)).map_err(|error| format!("{path}: {error}"))
}

/// The image's output: figures, and the rest.
struct Printed {
    lines: Vec<String>,
    figures: BTreeMap<String, u64>,
}

impl Printed {
    fn parse(output: &str) -> Self {
        let mut printed = Self { lines: Vec::new(), figures: BTreeMap::new() };
        for line in output.lines() {
            match line.strip_prefix("figure ").and_then(|figure| figure.rsplit_once(' ')) {
                Some((name, value)) => {
                    printed.figures.insert(name.to_owned(), u64::from_str_radix(value, 16).unwrap_or(u64::MAX));
                }
                None => printed.lines.push(line.to_owned()),
            }
        }
        printed
    }

    fn figure(&self, name: &str) -> Result<u64, String> {
        self.figures.get(name).copied().ok_or_else(|| format!("the image did not print its figure `{name}`"))
    }
}

fn compare(verdict: &mut Verdict, reference: &Reference, printed: &Printed) {
    for run in ["log", "adversary", "faults"] {
        let of_run = |lines: &[String]| -> Vec<String> {
            lines.iter().filter(|line| line.split(' ').next() == Some(run)).cloned().collect()
        };
        let (expected, actual) = (of_run(&reference.lines), of_run(&printed.lines));
        let differing = expected.iter().zip(&actual).filter(|(a, b)| a != b);
        if let Some((a, b)) = differing.clone().next() {
            println!("      first difference: host  {a}\n                        image {b}");
        }
        let (count, expected, actual) = (differing.count(), expected.len(), actual.len());
        verdict.check(
            count == 0 && expected == actual && expected > 0,
            &format!("{run}: {actual} of {expected} outcomes printed, {count} differ from the host's f32 in a bit"),
        );
    }
    verdict.check(printed.lines.len() == reference.lines.len(), "nothing else was printed");
}

fn precision(verdict: &mut Verdict, reference: &Reference, limits: &BTreeMap<String, u64>) {
    let found = &reference.precision;
    let micrometres = (found.distance * 1e6).ceil() as u64;
    println!("      {} echoes of {} readings compared with the host's f64", found.echoes, found.readings);
    verdict.figure("largest distance from f64, µm", micrometres, limits.get("distance_micrometres"));
    let share = u64::from(found.unlike) * 1_000_000 / u64::from(found.readings.max(1));
    println!("      {} readings differ in kind or count", found.unlike);
    verdict.figure("of a million readings", share, limits.get("unlike_per_million"));
}

fn faults(verdict: &mut Verdict, tally: &Tally) {
    for (fault, count) in Fault::ALL.iter().zip(tally.inflicted) {
        println!("      fault {fault:?}: {count} readings");
    }
    println!(
        "      refused: {:?}; arrived: {}; echoes: {}, {} of them out of f32's bounds",
        tally.refused, tally.arrived, tally.echoes, tally.wild_echoes
    );
    verdict.check(tally.inflicted.iter().all(|&count| count > 20), "faults: each was inflicted more than 20 times");
    let refused = [
        ("pose", tally.of(Fault::NanPosition) + tally.of(Fault::LongHeading)),
        ("time going back", tally.of(Fault::OutOfOrder)),
        ("unknown sensor", tally.of(Fault::UnknownSensor)),
        ("another reason", 0),
    ];
    for (reason, expected) in refused {
        let actual = tally.refused_for(reason);
        verdict.check(actual == expected, &format!("faults: {actual} refused for {reason}, {expected} expected"));
    }
}

fn cost(verdict: &mut Verdict, printed: &Printed, limits: &BTreeMap<String, u64>) -> Result<(), String> {
    let average = printed.figure("log average")?;
    verdict.figure("instructions a reading, average", average, limits.get("instructions_average"));
    verdict.figure("instructions a reading, worst", printed.figure("log worst")?, limits.get("instructions_worst"));
    verdict.figure(
        "instructions of an adversary's reading",
        printed.figure("adversary worst")?,
        limits.get("instructions_adversary"),
    );
    verdict.figure(
        "instructions, worst, with faults",
        printed.figure("faults worst")?,
        limits.get("instructions_faults"),
    );
    verdict.figure("bytes of state (static RAM)", printed.figure("image state")?, limits.get("state_bytes"));
    verdict.figure("bytes of stack, whole image", printed.figure("image stack")?, limits.get("stack_bytes"));
    Ok(())
}

fn contents(verdict: &mut Verdict, image: &Image, limits: &BTreeMap<String, u64>) {
    verdict.figure("bytes of code, the fuser's part", image.fuser_code, limits.get("code_bytes"));
    for (name, size) in &image.fuser_parts {
        println!("        {size:6}  {:#}", rustc_demangle::demangle(name));
    }
    verdict.figure("bytes of code, whole image", image.instructions, None);
    verdict.figure("bytes of variables, whole image", image.variables, None);
    let doubles: Vec<_> = image.fuser_parts.iter().filter(|(name, _)| is_soft_double(name)).collect();
    verdict.check(doubles.is_empty(), &format!("no soft-double routine in the fuser's part {doubles:?}"));
    let heap: Vec<_> = image.symbols.iter().filter(|symbol| is_heap(symbol)).collect();
    verdict.check(heap.is_empty(), &format!("no heap symbol in the image {heap:?}"));
    let panics: Vec<_> = image.symbols.iter().filter(|symbol| symbol.contains("panic")).collect();
    verdict.check(panics.is_empty(), &format!("no panic symbol in the image {panics:?}"));
}
