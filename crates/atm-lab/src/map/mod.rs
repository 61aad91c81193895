//! Maps of square cells: the one grid that every grid method writes to, how a beam lies on it, and what becomes of it: files for
//! ROS's map server, pictures, and a measure of how spread out it is.
mod beam;
mod entropy;
mod grid;
mod ray;
mod ros;

pub use self::{
    beam::{BeamCell, Footprint},
    entropy::spread_bits,
    grid::{Cell, Grid},
    ray::Ray,
    ros::{FREE_THRESHOLD, OCCUPIED_THRESHOLD, Occupancy},
};
