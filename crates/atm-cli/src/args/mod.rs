//! What can stand on the command line, one file a command.

#[cfg(feature = "lab")]
mod compare;
#[cfg(feature = "lab")]
mod draw;
#[cfg(feature = "lab")]
mod eval;
mod fuse;
mod info;
mod local_map;
mod log;
mod plan;
#[cfg(feature = "lab")]
mod simulate;
mod values;
#[cfg(feature = "lab")]
mod view;

use clap::{Parser, Subcommand};

#[cfg(feature = "lab")]
pub use self::{
    compare::Compare,
    draw::{Draw, PanelSpec},
    eval::Eval,
    fuse::HeldOption,
    simulate::Simulate,
    view::View,
};
pub use self::{
    fuse::{Emit, Fuse, NoneOption, TwoOption},
    info::Info,
    plan::Plan,
};

/// Sharp echo points from wide-beam range sensors on a moving robot: the arc-transversal median.
#[derive(Debug, Parser)]
#[command(name = "atm", version, max_term_width = 100, after_help = UNITS)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

const UNITS: &str = "\
Lengths take m, cm, mm, in or ft; angles deg or rad; times s or ms; speeds m/s or in/s; rates Hz. \
A bare number is SI, except for angles, which need their unit.

Exit status: 0 done; 1 failed; 2 wrong arguments; 3 done, but part of the input was unusable.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Turn a log of range readings into echo points
    Fuse(Box<Fuse>),
    /// What resolution to expect at a distance, and what it takes: equation (2) both ways
    Plan(Plan),
    /// What is in a log
    Info(Info),
    /// Drive a robot through a world and write its log
    #[cfg(feature = "lab")]
    Simulate(Simulate),
    /// How good echoes are, where the world is known: errors, coverage, ghosts, the doorway
    #[cfg(feature = "lab")]
    Eval(Eval),
    /// Every method on one log, side by side
    #[cfg(feature = "lab")]
    Compare(Box<Compare>),
    /// Draw walls, path, arcs, crossings and echoes
    #[cfg(feature = "lab")]
    Draw(Box<Draw>),
    /// Replay a log in the browser: one page, offline
    #[cfg(feature = "lab")]
    View(Box<View>),
}
