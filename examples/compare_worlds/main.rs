//! The measured tables of `docs/methods.md`: every method on the same drives through the built-in worlds.
//!
//! `cargo run --release --example compare_worlds [SEEDS] [NOISE]`, 30 seeds and no noise unless said; NOISE as `atm simulate --noise`
//! takes it. What stands in a cell is the median over the seeds. With `ATM_WRITE_PAGE` set the tables go into the page, where it has
//! a place for them; `scripts/methods` does that.

mod curve;
mod drive;
mod in_place;
mod page;
mod scores;
mod table;

#[cfg(test)]
mod tests;

use std::error::Error;

use atm_lab::simulate::Effects;

use crate::{drive::Driven, table::Table};

/// The worlds, and what their columns are called.
const WORLDS: [&str; 9] =
    ["doorway", "closed-wall", "tee", "room", "rough-wall", "specular-wall", "diffuse-wall", "corners", "pole"];
/// Those in which a robot turns in place.
const TURNED_IN: [&str; 3] = ["corners", "specular-wall", "doorway"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let seeds: u64 = args.next().map_or(Ok(30), |text| text.parse())?;
    let effects: Effects = args.next().map_or(Ok(Effects::default()), |text| text.parse())?;
    let tables = measured(&WORLDS, &TURNED_IN, effects, seeds)?;
    if std::env::var_os(page::WRITE).is_some_and(|set| !set.is_empty()) {
        return Ok(page::write(&tables, effects)?);
    }
    tables.iter().for_each(|table| println!("{table}"));
    Ok(())
}

/// All tables, of drives through these worlds and of turns in place in those.
fn measured(
    worlds: &[&'static str],
    turned_in: &[&'static str],
    effects: Effects,
    seeds: u64,
) -> Result<Vec<Table>, Box<dyn Error>> {
    let driven: Vec<Driven> =
        worlds.iter().map(|world| Driven::through(world, &[], effects, seeds)).collect::<Result<_, _>>()?;
    let mut tables: Vec<Table> = scores::short(&driven).into_iter().collect();
    tables.extend(scores::points(&driven));
    tables.extend(scores::grids(&driven));
    tables.extend(scores::same_readings(&driven));
    tables.push(scores::both_answer(&driven));
    tables.push(curve::table(&driven));
    tables.push(in_place::turning(turned_in, effects, seeds)?);
    tables.push(in_place::interleaving(seeds)?);
    Ok(tables)
}
