//! Pictures and maps of a comparison.

use std::{fs, io::Write, path::Path};

use atm::{error::Error, log::output::Output};
use atm_lab::{
    compare::{Outcome as Said, Recording, scene},
    draw::{Frame, Panel, Picture},
    world::World,
};

use crate::{Failure, args::Compare};

/// Methods in one row of the sheet that has them all.
const COLUMNS: usize = 4;
/// Width of that sheet, in pixels.
const WIDTH: f64 = 1800.0;

/// Refuses directories that can't be had, before anything is computed.
pub fn check(args: &Compare) -> Result<(), Failure> {
    for directory in [&args.draw, &args.map].into_iter().flatten() {
        make(directory)?;
    }
    Ok(())
}

/// Writes what was asked for.
pub fn write(args: &Compare, said: &[Said], recording: &Recording, world: Option<&World>) -> Result<(), Failure> {
    if let Some(directory) = &args.draw {
        draw(directory, said, recording, world)?;
    }
    if let Some(directory) = &args.map {
        for one in said {
            map(directory, one)?;
        }
    }
    Ok(())
}

fn draw(directory: &str, said: &[Said], recording: &Recording, world: Option<&World>) -> Result<(), Failure> {
    let mut panels = Vec::new();
    for one in said.iter().filter(|one| one.estimates.is_some()) {
        let title = one.name.word().to_owned();
        panels.push(Panel { title, subtitle: String::new(), scene: scene(one, recording, world)? });
    }
    // One frame for all, so that one can be laid on another.
    let points: Vec<_> = panels.iter().flat_map(|panel| panel.scene.extent()).collect();
    let frame = Frame::around(&points);
    for panel in &panels {
        let picture = Picture { panels: vec![panel.clone()], frame, ..Picture::default() };
        save(&format!("{directory}/{}.svg", panel.title), picture.svg().as_bytes())?;
    }
    let sheet = Picture { panels, columns: Some(COLUMNS), frame, width: Some(WIDTH), ..Picture::default() };
    save(&format!("{directory}/side-by-side.svg"), sheet.svg().as_bytes())?;
    save(&format!("{directory}/side-by-side.png"), &sheet.png(1.0)?)
}

fn map(directory: &str, said: &Said) -> Result<(), Failure> {
    let Some(evidence) = &said.evidence else {
        return Ok(());
    };
    let directory = format!("{directory}/{}", said.name.word());
    make(&directory)?;
    let occupancy = evidence.occupancy()?;
    save(&format!("{directory}/map.pgm"), &occupancy.pgm())?;
    save(&format!("{directory}/map.png"), &occupancy.png()?)?;
    // Last: who finds it finds the image, too.
    save(&format!("{directory}/map.yaml"), occupancy.yaml("map.pgm").as_bytes())
}

fn make(directory: &str) -> Result<(), Failure> {
    fs::create_dir_all(Path::new(directory)).map_err(|source| Error::Io { file: directory.into(), source }.into())
}

fn save(path: &str, bytes: &[u8]) -> Result<(), Failure> {
    let mut output = Output::create(path)?;
    output.write_all(bytes).map_err(|error| output.error(error))?;
    Ok(output.commit()?)
}
