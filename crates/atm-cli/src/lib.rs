//! The `atm` command as a library: arguments, progress, exit codes; no algorithm.

mod args;
mod command;
mod interrupt;
mod report;

use std::{
    ffi::OsString,
    io::{self, Write},
};

use atm::error::Error;
use clap::Parser;

use crate::{
    args::{Cli, Command},
    interrupt::Interrupted,
};

/// How a run ended well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// Everything was used.
    Done,
    /// Done, but part of the input was unusable.
    Partly,
}

/// How a run did not end well.
#[derive(Debug)]
enum Failure {
    /// The arguments are wrong.
    Usage(String),
    /// It could not be done.
    Failed(String),
    /// Whoever read the output has closed it: nothing to say.
    ReaderGone,
    /// A signal ended it, with what is to be said of that.
    Interrupted(Interrupted, String),
}

/// Whether it is that whoever read the output has closed it.
fn is_reader_gone(error: &Error) -> bool {
    matches!(error, Error::Io { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match &error {
            _ if is_reader_gone(&error) => Self::ReaderGone,
            _ if let Some(interrupted) = Interrupted::of(&error) => {
                Self::Interrupted(interrupted, interrupted.to_string())
            }
            Error::Settings { .. } => Self::Usage(error.to_string()),
            _ => Self::Failed(error.to_string()),
        }
    }
}

/// Runs the command line `args`, the program's name first, and returns the exit status: 0 done, 1 failed, 2 wrong
/// arguments, 3 done but part of the input was unusable.
///
/// A signal that ends a run early (SIGINT, SIGTERM) ends the process here, once everything is said, as if nobody had caught it.
pub fn run(args: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> u8 {
    let args: Vec<OsString> = args.into_iter().map(Into::into).collect();
    let cli = match Cli::try_parse_from(&args) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version come this way, too; a closed standard output is no error for them.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    let result = match &cli.command {
        Command::Fuse(args) => command::fuse::run(args),
        Command::Plan(args) => command::plan::run(args),
        Command::Info(args) => command::info::run(args),
        #[cfg(feature = "lab")]
        Command::Simulate(args) => command::simulate::run(args),
        #[cfg(feature = "lab")]
        Command::Eval(args) => command::eval::run(args),
        #[cfg(feature = "lab")]
        Command::Compare(args) => command::compare::run(args),
        #[cfg(feature = "lab")]
        Command::Draw(args) => command::draw::run(args),
        #[cfg(feature = "lab")]
        Command::View(view) => command::view::run(view, &args),
    };
    match result {
        Ok(Outcome::Done) | Err(Failure::ReaderGone) => 0,
        Ok(Outcome::Partly) => 3,
        Err(Failure::Failed(message)) => {
            report::say(format_args!("atm: {message}"));
            1
        }
        Err(Failure::Interrupted(interrupted, message)) => {
            report::say(format_args!("atm: {message}"));
            interrupted.end()
        }
        Err(Failure::Usage(message)) => {
            report::say(format_args!("atm: {message}"));
            2
        }
    }
}

/// Prints a result on standard output.
fn print(text: &str) -> Result<Outcome, Failure> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(|source| Failure::from(Error::Io { file: "standard output".into(), source }))?;
    Ok(Outcome::Done)
}
