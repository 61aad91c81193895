//! The host's side of the firmware test. See `firmware/test`, which calls it:
//!
//! ```text
//! check record LOG                                writes the recorded log
//! check judge NAME IMAGE OUTPUT LOG LIMITS        holds an image and what it printed against the host and the limits
//! ```
//! A line for each check, `ok` or `FAIL` in front; exit status 1 if any failed.

mod drive;
mod elf;
mod judge;
mod reference;

use std::{env, error::Error, fs, process::ExitCode};

fn main() -> ExitCode {
    match run(&env::args().skip(1).collect::<Vec<_>>()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("check: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<bool, Box<dyn Error>> {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["record", log] => fs::write(log, drive::record()?).map_err(|error| format!("{log}: {error}"))?,
        ["judge", name, image, output, log, limits] => {
            return judge::judge(&judge::Exhibits { name, image, output, log, limits });
        }
        _ => return Err("usage: check record LOG | check judge NAME IMAGE OUTPUT LOG LIMITS".into()),
    }
    Ok(true)
}
