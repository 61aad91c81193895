//! What the workspace is built from: every crate under a permissive licence and in the list, no heavy one twice.
//!
//! `ATM_LICENCES=write cargo test -p atm-cli --test licences` writes the list anew.

mod support;

use std::{
    collections::{BTreeMap, BTreeSet},
    env, fs,
    process::Command,
};

use support::*;

/// Licences that ask for nothing but their own text (SPDX).
const PERMISSIVE: [&str; 13] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Crates that take long to build, or whose types would not fit one another.
const HEAVY: [&str; 19] = [
    "arrow",
    "clap_builder",
    "criterion",
    "foxglove",
    "glam",
    "glamx",
    "image",
    "mcap",
    "nalgebra",
    "numpy",
    "parry2d",
    "parry2d-f64",
    "prost",
    "pyo3",
    "rayon-core",
    "resvg",
    "simba",
    "tiny-skia",
    "zstd-sys",
];

const LIST: &str = "docs/licences.txt";

/// Name, version and licence of every crate from elsewhere that is built on this machine.
fn crates() -> BTreeSet<[String; 3]> {
    let cargo = env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let tree = ["tree", "--workspace", "--locked", "--offline", "--edges", "normal,build,dev", "--prefix", "none"];
    let output = Command::new(cargo).args(tree).args(["--format", "{p}|{l}"]).current_dir(root()).output();
    let output = output.expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    // `name v1.2.3 (proc-macro)|licence`; those of the workspace have their path in parentheses.
    let foreign = text.lines().filter(|line| !line.contains("(/") && line.contains('|'));
    let found = foreign.map(|line| {
        let (package, licence) = line.trim_end_matches(" (*)").split_once('|').expect("a licence");
        let mut words = package.split_whitespace().map(str::to_owned);
        [words.next().expect("a name"), words.next().expect("a version"), licence.to_owned()]
    });
    found.collect()
}

/// Whether an SPDX expression (its parentheses only around alternatives) leaves a choice that is permissive.
fn is_permissive(expression: &str) -> bool {
    let choice = |part: &str| part.split(" OR ").any(|licence| PERMISSIVE.contains(&licence.trim()));
    let expression = expression.replace('/', " OR ").replace("  ", " ");
    match expression.contains(" AND ") {
        true => expression.split(" AND ").all(|part| choice(part.trim().trim_matches(['(', ')']))),
        false => choice(&expression),
    }
}

#[test]
fn expressions_are_read_right() {
    for permissive in
        ["MIT", "MIT/Apache-2.0", "Apache-2.0 / MIT", "MIT OR GPL-3.0", "(MIT OR Apache-2.0) AND Unicode-3.0"]
    {
        assert!(is_permissive(permissive), "{permissive}");
    }
    for other in ["GPL-3.0", "MIT AND MPL-2.0", "LGPL-2.1 OR MPL-2.0", "", "(MIT OR Apache-2.0) AND OpenSSL"] {
        assert!(!is_permissive(other), "{other}");
    }
}

#[test]
fn every_crate_is_permissive_and_listed() {
    let crates = crates();
    let others: Vec<_> = crates.iter().filter(|[_, _, licence]| !is_permissive(licence)).collect();
    assert!(others.is_empty(), "not permissive: {others:?}");
    let lines: BTreeSet<String> = crates.iter().map(|[name, _, licence]| format!("{name}: {licence}")).collect();
    let path = root().join(LIST);
    if env::var_os("ATM_LICENCES").is_some_and(|wish| wish == "write") {
        fs::write(&path, lines.iter().map(|line| format!("{line}\n")).collect::<String>()).expect("the list");
    }
    let listed = fs::read_to_string(&path).unwrap_or_default();
    let listed: BTreeSet<&str> = listed.lines().collect();
    // Another platform may need fewer.
    let missing: Vec<_> = lines.iter().filter(|line| !listed.contains(line.as_str())).collect();
    assert!(
        missing.is_empty(),
        "not in {LIST}: {missing:#?}\nATM_LICENCES=write cargo test -p atm-cli --test licences"
    );
}

#[test]
fn no_heavy_crate_is_built_twice() {
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for [name, version, _] in crates() {
        versions.entry(name).or_default().insert(version);
    }
    versions.retain(|name, versions| versions.len() > 1 && HEAVY.contains(&name.as_str()));
    assert!(versions.is_empty(), "{versions:?}");
}
