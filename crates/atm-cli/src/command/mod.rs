//! One file a command, each a thin adapter over the library.

#[cfg(feature = "lab")]
pub mod compare;
#[cfg(feature = "lab")]
pub mod draw;
#[cfg(feature = "lab")]
pub mod eval;
pub mod fuse;
pub mod info;
pub mod plan;
#[cfg(feature = "lab")]
pub mod simulate;
#[cfg(feature = "lab")]
pub mod view;

use atm::error::Error;

use crate::Failure;

/// What is said of a run that did not end well: why, and where what it had written is.
fn unfinished(error: Error, done: &str, partials: &[String]) -> Failure {
    let kept = |message: String| match partials {
        [] => message,
        partials => format!("{message}\natm: what was {done} until then is in {}", partials.join(" and ")),
    };
    match Failure::from(error) {
        Failure::Failed(message) => Failure::Failed(kept(message)),
        Failure::Interrupted(interrupted, message) => Failure::Interrupted(interrupted, kept(message)),
        failure => failure,
    }
}
