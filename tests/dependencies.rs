//! What a build of the library brings with it: nothing that only proves or shows the method.

use std::{collections::BTreeSet, env, process::Command};

/// Geometry, pictures, their letters, and noise: what `atm-lab` is built from.
const LAB: [&str; 7] = ["atm-lab", "dejavu", "parry2d-f64", "png", "rand_chacha", "resvg", "ttf-parser"];

/// The crates that `cargo build` compiles with these arguments.
fn built(args: &[&str]) -> BTreeSet<String> {
    let cargo = env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let tree = ["tree", "--locked", "--offline", "--edges", "normal,build", "--prefix", "none", "--format", "{p}"];
    let output = Command::new(cargo).args(tree).args(args).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    text.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

fn of_the_lab(args: &[&str]) -> Vec<&'static str> {
    let built = built(args);
    LAB.into_iter().filter(|name| built.contains(*name)).collect()
}

#[test]
fn the_library_is_built_without_the_lab() {
    assert_eq!(of_the_lab(&["--package", "atm"]), [""; 0]);
}

#[test]
fn the_command_has_the_lab_as_a_feature() {
    assert_eq!(of_the_lab(&["--package", "atm-cli"]), LAB);
    assert_eq!(of_the_lab(&["--package", "atm-cli", "--no-default-features"]), [""; 0]);
}
