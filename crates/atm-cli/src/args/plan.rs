use atm::core::{Beam, MinAngle, RangeResolution};
use clap::Args;

use super::values::{
    beam, min_angle, positive_length, positive_number, positive_rate, positive_speed, range_resolution,
};

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("angle").required(true).args(["min_angle", "improvement"]))]
pub struct Plan {
    /// Distance of what is to be seen
    #[arg(long, value_name = "L", value_parser = positive_length)]
    pub distance: f64,
    /// Full beam
    #[arg(long, value_name = "A", default_value = "22.5deg", value_parser = beam)]
    pub fov: Beam<f64>,
    /// Quantisation step of the ranges
    #[arg(long, value_name = "L", default_value = "1in", value_parser = range_resolution)]
    pub range_resolution: RangeResolution<f64>,
    /// Smallest crossing angle: what does it give?
    #[arg(long, value_name = "A", value_parser = min_angle)]
    pub min_angle: Option<MinAngle<f64>>,
    /// Wanted gain in resolution: what angle does it take?
    #[arg(long, value_name = "N", value_parser = positive_number)]
    pub improvement: Option<f64>,
    /// Speed of the robot
    #[arg(long, value_name = "V", value_parser = positive_speed, requires = "rate")]
    pub speed: Option<f64>,
    /// Readings of one sensor in a second
    #[arg(long, value_name = "F", value_parser = positive_rate, requires = "speed")]
    pub rate: Option<f64>,
    /// As JSON, in SI units
    #[arg(long)]
    pub json: bool,
}
