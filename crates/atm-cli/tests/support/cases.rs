//! Small logs as people have them, with what they come from.
//!
//! They are looked for in `$ATM_TEST_CASES`, else in `../shared/cases` beside the repository. Without them the tests that need them
//! say so and end; where `CI` is set they fail.

use std::{env, path::PathBuf};

use super::root;

/// The path of a case, like `tables/base.csv`; `None`, with a notice, where there are none.
#[track_caller]
pub fn case(name: &str) -> Option<String> {
    let place = env::var_os("ATM_TEST_CASES").map_or_else(|| root().join("../shared/cases"), PathBuf::from);
    let path = place.join(name);
    if path.exists() {
        return Some(path.to_str().expect("a path in UTF-8").to_owned());
    }
    let notice = format!("no case {}; set ATM_TEST_CASES to the directory that holds the cases", path.display());
    assert!(env::var_os("CI").is_none(), "{notice}");
    eprintln!("SKIPPED: {notice}");
    None
}
