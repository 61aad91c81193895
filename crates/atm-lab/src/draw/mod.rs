//! Pictures: walls, path, arcs, crossings and echoes, as SVG, and as PNG made from it.
//!
//! A [`Scene`] holds what there is to be drawn, in metres; a [`Picture`] puts scenes beside one another, finds what part of the
//! plane to show, and explains the marks. The same picture gives the same bytes.
pub mod drive;
mod frame;
mod ink;
mod legend;
mod letters;
mod page;
mod panel;
mod png;
mod scene;
mod style;
mod svg;
pub mod tables;
mod world;

pub use self::{
    frame::Frame,
    page::{Panel, Picture, SIDES, WIDTH},
    scene::{Cone, Grid, Robot, Scene, Wall},
};

#[cfg(test)]
mod tests;
