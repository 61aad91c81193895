//! `atm draw`: logs, tables and recordings in, a picture out.

use std::{collections::BTreeSet, io::Write, sync::Arc};

use atm::{
    core::{Kind, Reflector},
    log::{
        Input,
        content::Content,
        crossing_log::CrossingLog,
        echo_log::EchoLog,
        echo_table::EchoTable,
        format::Format,
        output::{Output, overwrites},
    },
    summary::Dropped,
};
use atm_lab::{
    draw::{
        Panel, Picture, Scene,
        drive::{Key, drive},
        tables,
    },
    world::World,
};

use crate::{
    Failure, Outcome,
    args::{Draw, PanelSpec},
    report,
};

/// Layers that are no kinds of echoes.
const LAYERS: [&str; 11] =
    ["walls", "opening", "path", "arcs", "robot", "beam", "beams", "partners", "crossings", "truth", "grid"];
/// Layers that are only drawn where they are named.
const ON_DEMAND: [&str; 2] = ["centerline", "beams"];

/// Runs the command.
pub fn run(args: &Draw) -> Result<Outcome, Failure> {
    let as_png = check_output(args)?;
    let mut dropped = Dropped::default();
    let inputs = Inputs::read(args, &mut dropped)?;
    let picture = inputs.picture(args)?;
    let bytes = if as_png { picture.png(args.scale)? } else { picture.svg().into_bytes() };
    let mut output = Output::create(&args.output)?;
    output.write_all(&bytes).map_err(|error| output.error(error))?;
    output.commit()?;
    if let Some(unusable) = report::unusable(&dropped) {
        report::say(format_args!("{unusable}"));
        return Ok(Outcome::Partly);
    }
    Ok(Outcome::Done)
}

/// Whether the picture is to be a PNG; refuses names that say neither, and those of inputs.
fn check_output(args: &Draw) -> Result<bool, Failure> {
    let name = args.output.to_ascii_lowercase();
    let as_png = name.ends_with(".png");
    if !(as_png || name.ends_with(".svg") || name == "-") {
        return Err(Failure::Usage(format!("{}: a picture's name ends in .svg or .png", args.output)));
    }
    let others = [&args.world, &args.log.poses, &args.log.rig];
    let read = args.inputs.iter().chain(others.into_iter().flatten());
    if let Some(input) = read.into_iter().find(|input| overwrites(&args.output, input)) {
        return Err(Failure::Usage(format!("{}: writing it would overwrite the input {input}", args.output)));
    }
    if args.inputs.iter().filter(|input| *input == "-").count() > 1 {
        return Err(Failure::Usage("standard input can be one of the inputs only once".into()));
    }
    Ok(as_png)
}

/// What there is to be drawn.
struct Inputs {
    world: Scene,
    /// By name, as they stand on the command line.
    files: Vec<(String, Scene)>,
    /// Whether there is nothing but logs.
    only_logs: bool,
}

impl Inputs {
    fn read(args: &Draw, dropped: &mut Dropped) -> Result<Self, Failure> {
        let shown = args.reading.as_ref().map(|(t, sensor)| (*t, Arc::from(sensor.as_str())));
        let mut opened = Vec::new();
        for path in &args.inputs {
            let (format, input) = args.log.job(path, None, None)?.open()?;
            let (content, input) = match format {
                Format::Csv => input.content()?,
                // Topics of readings are only asked for where readings are.
                Format::Mcap => input.recorded(path, !args.log.range_topics.is_empty())?,
                _ => (Content::Readings, input),
            };
            opened.push((path.to_owned(), format, content, input));
        }
        let only_logs = opened.iter().all(|(_, _, content, _)| *content == Content::Readings);
        // Crossings first: they say which arcs of the log cross the reading that is shown.
        opened.sort_by_key(|(_, _, content, _)| *content != Content::Crossings);
        let (mut files, mut partners) = (Vec::new(), BTreeSet::new());
        for (path, format, content, input) in opened {
            let scene = match content {
                Content::Crossings => {
                    let crossings = CrossingLog::new(&path, format, input)?;
                    let (scene, found) = tables::crossings(crossings, shown.as_ref(), dropped)?;
                    partners.extend(found);
                    scene
                }
                Content::Truth => tables::truth(EchoTable::new(input)?, dropped)?,
                Content::Points => tables::echoes(EchoLog::new(&path, format, input)?, shown.as_ref(), dropped)?,
                _ => log(args, &path, (format, input), shown.as_ref(), &partners, dropped)?,
            };
            files.push((path, scene));
        }
        let world = args.world.as_deref().map(|name| World::load(name, &args.set)).transpose()?;
        let mut scene = world.as_ref().map(Scene::of_world).unwrap_or_default();
        if files.is_empty() {
            scene.path(world.iter().flat_map(|world| world.path().line()).map(Some));
        }
        Ok(Self { world: scene, files, only_logs })
    }

    fn picture(&self, args: &Draw) -> Result<Picture, Failure> {
        let panels = if args.panel.is_empty() {
            vec![self.panel(&PanelSpec { title: String::new(), subtitle: String::new(), names: args.only.clone() })?]
        } else {
            args.panel.iter().map(|panel| self.panel(panel)).collect::<Result<_, _>>()?
        };
        let (width, height) = args.size.map_or((None, None), |(width, height)| (Some(width), height));
        Ok(Picture { title: args.title.clone(), panels, columns: None, frame: args.zoom, width, height })
    }

    /// One panel with what it names.
    fn panel(&self, spec: &PanelSpec) -> Result<Panel, Failure> {
        let is_file = |name: &String| self.files.iter().any(|(path, _)| path == name);
        let (files, layers): (Vec<&String>, Vec<&String>) = spec.names.iter().partition(|name| is_file(name));
        let mut scene = self.world.clone();
        for (path, file) in &self.files {
            if files.is_empty() || files.contains(&path) {
                scene.extend(file);
            }
        }
        let known: Vec<&str> = self.files.iter().flat_map(|(_, file)| file.names()).chain(LAYERS).collect();
        if let Some(unknown) = layers.iter().find(|name| !known.contains(&name.as_str()) && !is_kind(name)) {
            let known = known.join(", ");
            return Err(Failure::Usage(format!("{unknown}: no such layer, kind or input; there are {known}")));
        }
        let scene = scene.only(|name| self.is_shown(name, &layers));
        Ok(Panel { title: spec.title.clone(), subtitle: spec.subtitle.clone(), scene })
    }

    /// Whether a layer is drawn where `asked` names what to draw.
    fn is_shown(&self, name: &str, asked: &[&String]) -> bool {
        if asked.iter().any(|asked| *asked == name) {
            return true;
        }
        let by_itself = !ON_DEMAND.contains(&name) && (name != "arcs" || self.only_logs);
        let kinds_alone = asked.iter().all(|asked| !LAYERS.contains(&asked.as_str()));
        by_itself
            && (asked.is_empty() || (kinds_alone && LAYERS.contains(&name) && name != "crossings" && name != "truth"))
    }
}

/// Whether it is a kind of echoes, in the inputs or not.
fn is_kind(name: &str) -> bool {
    Kind::ALL.map(Kind::name).contains(&name) || Reflector::ALL.map(Reflector::name).contains(&name)
}

/// The layers of a log.
fn log(
    args: &Draw,
    path: &str,
    (format, input): (Format, Input),
    shown: Option<&Key>,
    partners: &BTreeSet<Key>,
    dropped: &mut Dropped,
) -> Result<Scene, Failure> {
    let job = args.log.job(path, None, None)?;
    let mut log = job.readings(format, input, false)?;
    let (source, track) = log.source();
    let (scene, found) = drive(source, track, &job.sensors()?, shown, partners)?;
    dropped.extend(found);
    Ok(scene)
}
