use atm::core::Beam;
use atm_lab::simulate::Effects;
use clap::Args;

use super::{
    log::Format,
    values::{beam, parameter},
};

#[derive(Debug, Args)]
#[command(after_help = "\
Built-in worlds: doorway, closed-wall, tee, pole, specular-wall, rough-wall, diffuse-wall, corners, room. --set opening=36in sets \
one parameter of a world; a wrong one is answered with those there are. The rig's ranges come rounded to its resolution; \
all else is off unless --noise says so, as in --noise range=1cm,dropout=5%,crosstalk=1%,multipath,odometry=1cm,heading=0.5deg \
(deviations of range, and of position and yaw after a metre). The same arguments write the same bytes on every machine. A table begins at 0 s, a recording at 1 s.")]
pub struct Simulate {
    /// The world: a built-in one or a TOML file
    pub world: String,
    /// Where the log goes: a path, or - for standard output
    #[arg(short, long, value_name = "LOG", default_value = "-")]
    pub output: String,
    /// Format of the log, instead of what its name says
    #[arg(long, value_enum)]
    pub to: Option<Format>,
    /// Also write where each echo really came from: CSV t,sensor,x,y,azimuth,cause
    #[arg(long, value_name = "FILE")]
    pub truth: Option<String>,
    /// Which bumps, noise and outliers are drawn
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,
    /// The sensors: a built-in rig (nomad200, robond8) or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "nomad200")]
    pub rig: String,
    /// Full beam of sensors of which the rig does not say it
    #[arg(long, value_name = "A", default_value = "22.5deg", value_parser = beam)]
    pub fov: Beam<f64>,
    /// A parameter of the world, with its unit; may be given again
    #[arg(long, value_name = "KEY=VALUE", value_parser = parameter)]
    pub set: Vec<(String, String)>,
    /// Speed of the robot [default: the world's, else 5in/s]
    #[arg(long, value_name = "V")]
    pub speed: Option<String>,
    /// Sweeps of all sensors in a second [default: the world's, else 1Hz]
    #[arg(long, value_name = "F")]
    pub rate: Option<String>,
    /// What disturbs the drive
    #[arg(long, value_name = "NAME[=VALUE],…", default_value = "", hide_default_value = true, value_parser = effects)]
    pub noise: Effects,
}

fn effects(text: &str) -> Result<Effects, String> {
    if text.is_empty() {
        return Ok(Effects::default());
    }
    text.parse().map_err(|error: atm::error::Error| error.to_string())
}

impl Simulate {
    /// The parameters of the world, speed and rate among them.
    pub fn parameters(&self) -> Vec<(String, String)> {
        let named = |key: &str, value: &Option<String>| value.clone().map(|value| (key.to_owned(), value));
        let more = [named("speed", &self.speed), named("rate", &self.rate)];
        self.set.iter().cloned().chain(more.into_iter().flatten()).collect()
    }
}
