//! Writes the sample log: `cargo run --release --example make_doorway > examples/doorway.csv`.
use std::io::{self, Write};

use atm::world::rough::{DOORWAY_SEED, doorway_log};

fn main() -> io::Result<()> {
    io::stdout().write_all(doorway_log(DOORWAY_SEED).as_bytes())
}
