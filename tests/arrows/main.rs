//! Which way the code leans: crate on crate, and module on module within each.
//!
//! Among the children of any module no circle, and between crates and layers no arrow up. A path counts wherever it stands outside
//! of tests and comments, and leads to where its item is defined, whoever re-exports it.

mod paths;

use std::{collections::BTreeSet, env, path::PathBuf, process::Command};

use paths::{Arrow, arrows};
use serde_json::Value;

/// The crates from the lowest to the highest; an arrow leads down.
const CRATES: [&str; 5] = ["atm-core", "atm", "atm-lab", "atm-cli", "atm-py"];
/// Who leans on a higher one in its tests, examples and benches.
const IN_TESTS: [(&str, &str); 1] = [("atm", "atm-lab")];

/// The modules of `atm`, layer by layer, the lowest first.
const LAYERS: [&[&str]; 5] = [
    &["echo", "error", "stamp", "storage", "style", "summary", "toml_document", "track", "units"],
    &["rig"],
    &["log"],
    &["intake", "pipeline"],
    &["job", "survey"],
];

/// Circles that are still to be opened: a line leaves with its circle, and none comes.
const CIRCLES: [(&str, &[&str]); 8] = [
    ("atm-core", &["arc", "crossing", "scalar", "sensor", "sweep"]),
    ("atm-core", &["consensus::fit", "consensus::poll"]),
    ("atm", &["diagnose", "intake", "log", "pipeline", "rig", "summary"]),
    (
        "atm",
        &[
            "log::mcap::chunk",
            "log::mcap::chunk_head",
            "log::mcap::records",
            "log::mcap::summary",
            "log::mcap::unpacker",
            "log::mcap::unpacking",
        ],
    ),
    ("atm", &["log::mcap::home", "log::mcap::whereabouts"]),
    ("atm", &["log::mcap::plane", "log::mcap::reader"]),
    ("atm", &["log::mcap::sensors", "log::mcap::tally"]),
    (
        "atm",
        &[
            "log::mcap::write::content",
            "log::mcap::write::foxglove",
            "log::mcap::write::points",
            "log::mcap::write::ros2",
            "log::mcap::write::schema",
        ],
    ),
];
/// Arrows of `atm` against its order that are still to be turned.
const UPWARD: [(&str, &str); 3] = [("log", "intake"), ("log", "pipeline"), ("rig", "log")];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn sources(package: &str) -> PathBuf {
    if package == "atm" { root().join("src") } else { root().join("crates").join(package).join("src") }
}

fn rank(package: &str) -> Option<usize> {
    CRATES.iter().position(|known| *known == package)
}

#[test]
fn crates_lean_on_lower_ones_alone() {
    let cargo = env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let mut arrows = 0;
    for package in metadata["packages"].as_array().expect("packages") {
        let name = package["name"].as_str().expect("a name");
        let own = rank(name).unwrap_or_else(|| panic!("{name} has no place in the order of crates"));
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            let on = dependency["name"].as_str().expect("a name");
            let Some(other) = rank(on).filter(|_| dependency["path"].is_string()) else { continue };
            let in_tests = dependency["kind"] == "dev" && IN_TESTS.contains(&(name, on));
            assert!(other < own || in_tests, "{name} leans on {on}, which stands above it");
            arrows += 1;
        }
    }
    assert!(arrows >= 8, "only {arrows} arrows found");
}

#[test]
fn there_are_no_circles_of_modules() {
    let mut known = CIRCLES.map(|(package, modules)| (package, BTreeSet::from_iter(modules.iter().copied()), false));
    for package in CRATES {
        let arrows = arrows(&sources(package));
        assert!(arrows.len() > 5, "{package}: only {} arrows found", arrows.len());
        for circle in circles(&arrows) {
            let names: BTreeSet<&str> = circle.iter().map(String::as_str).collect();
            let home = known.iter_mut().find(|(of, modules, _)| *of == package && names.is_subset(modules));
            let Some((_, _, still)) = home else {
                panic!("{package}: a circle of {names:?}:\n{}", shown(&arrows, &names))
            };
            *still = true;
        }
    }
    for (package, modules, still) in known {
        assert!(still, "{package}: the circle of {modules:?} is open: take it from the list");
    }
}

#[test]
fn a_log_is_below_what_fuses_it() {
    let layer = |module: &str| LAYERS.iter().position(|layer| layer.contains(&module));
    let (arrows, mut turned) = (arrows(&sources("atm")), BTreeSet::from(UPWARD));
    for Arrow { from, to, place } in &arrows {
        if let (Some(own), Some(other)) = (layer(from), layer(to))
            && own < other
        {
            let known = UPWARD.contains(&(from.as_str(), to.as_str()));
            assert!(known, "{place}: {from} leans on {to}, which stands above it");
            turned.remove(&(from.as_str(), to.as_str()));
        }
    }
    assert!(turned.is_empty(), "take from the list: {turned:?}");
}

/// Sets of modules each of which leads to all others of its set.
fn circles(arrows: &[Arrow]) -> BTreeSet<BTreeSet<String>> {
    let reached = |from: &str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
        while let Some(module) = open.pop() {
            let next = arrows.iter().filter(|arrow| arrow.from == module).map(|arrow| arrow.to.clone());
            open.extend(next.filter(|to| seen.insert(to.clone())));
        }
        seen
    };
    let modules: BTreeSet<&str> = arrows.iter().map(|arrow| arrow.from.as_str()).collect();
    let mutual = |module: &str| reached(module).into_iter().filter(|other| reached(other).contains(module)).collect();
    modules.into_iter().map(mutual).filter(|circle: &BTreeSet<String>| !circle.is_empty()).collect()
}

/// The arrows within a circle, one a line, with where each stands.
fn shown(arrows: &[Arrow], circle: &BTreeSet<&str>) -> String {
    let within = arrows.iter().filter(|arrow| circle.contains(&*arrow.from) && circle.contains(&*arrow.to));
    within.map(|Arrow { from, to, place }| format!("  {from} -> {to}: {place}\n")).collect()
}
