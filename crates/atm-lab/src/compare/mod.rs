//! Every method on one log: what each of them says, how good that is where the world is known, how long it took.
//!
//! The log is read once into a [`Recording`]; every method gets the same readings from it, through the same intake. The rows of
//! the arc-transversal median come out of [`atm::pipeline::fuse`], as `atm fuse` has them.
mod agreement;
mod assess;
mod json;
mod method;
mod picture;
mod recording;
mod run;
mod simulated;

pub use self::{
    assess::{Assessment, Best, SameReadings, Sharpness, against_world, among_themselves, assess},
    json::as_json,
    method::{Name, Options},
    picture::{cells, scene},
    recording::{Recording, Replay},
    run::{Outcome, run},
    simulated::simulated,
};

#[cfg(test)]
mod tests;
