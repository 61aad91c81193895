//! The `atm` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(atm_cli::run(std::env::args_os()))
}
