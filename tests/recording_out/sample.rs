//! The sample, fused into recordings in memory, and what is in them.

use std::{collections::BTreeMap, fs, sync::Arc};

use atm::{
    core::{ArcCrossing, Bounds, Consensus, Isometry2, MinAngle, Reading},
    echo::{AnyEcho, AnyEstimator},
    error::Result,
    log::{
        Input, Row,
        csv::{CsvReadings, PoseUse},
        echoes::TableWriter,
        mcap::write::{Frames, McapSink, Options, SENSORS, SchemaKind},
    },
    pipeline::{self, Defaults, EchoSink, Emit, History, Settings},
    rig::{Rig, TableFormat},
    track::Pose,
};
use mcap::{MessageStream, Summary, read::Options as ReadOptions};

pub const KINDS: [SchemaKind; 2] = [SchemaKind::Foxglove, SchemaKind::Ros2];

pub fn doorway() -> String {
    fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv")).expect("the sample is there")
}

pub fn nomad() -> Rig {
    Rig::builtin("nomad200").expect("it is built in")
}

/// Fuses a long table of the Nomad's ring into a sink.
pub fn fuse(table: &str, emit: Emit, sink: &mut dyn EchoSink) -> Result<()> {
    fuse_by(AnyEstimator::PAPER, table, emit, sink)
}

/// The same by the consensus.
pub fn fuse_consensus(table: &str, sink: &mut dyn EchoSink) -> Result<()> {
    fuse_by(AnyEstimator::Consensus(Consensus::new(MinAngle::PAPER)), table, Emit::Settled, sink)
}

fn fuse_by(estimator: AnyEstimator, table: &str, emit: Emit, sink: &mut dyn EchoSink) -> Result<()> {
    let rig = Arc::new(nomad());
    let sensors = Defaults::default().complete(&rig).expect("the built-in rig is complete");
    let input = Input { reader: Box::new(std::io::Cursor::new(table.to_owned())), name: "log".into(), length: None };
    let mut source = CsvReadings::new(input, &TableFormat::default(), PoseUse::Needed, None, rig)?;
    let settings = Settings { emit, history: History::PAPER, bounds: Bounds::NONE, estimator, strict: true };
    sink.sensors(nomad().ids())?;
    pipeline::fuse(&mut source, None, &sensors, &settings, sink, &mut |_| {}).1
}

/// Options for the Nomad's ring.
pub fn options(kind: SchemaKind) -> Options {
    let mounts: Vec<Isometry2<f64>> = nomad().sensors().iter().map(|sensor| sensor.mount()).collect();
    Options { kind, frames: Frames { mounts, ..Frames::default() }, ..Options::default() }
}

pub fn sink(options: Options) -> McapSink<Vec<u8>> {
    McapSink::new(Vec::new(), "recording".into(), options)
}

/// The recording of a table.
pub fn recorded(table: &str, options: Options) -> Vec<u8> {
    let mut sink = sink(options);
    fuse(table, Emit::Settled, &mut sink).expect("the table is fused");
    sink.finish().expect("memory takes it")
}

/// The tables of echoes and crossings.
pub struct Tables {
    echoes: TableWriter<Vec<u8>>,
    crossings: TableWriter<Vec<u8>>,
}

impl EchoSink for Tables {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        self.echoes.echo(echo).expect("memory takes it");
        Ok(true)
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        crossings.iter().for_each(|crossing| self.crossings.crossing(crossing).expect("memory takes it"));
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// The rows of both tables, their headers aside.
pub fn tables(table: &str) -> [Vec<String>; 2] {
    let rig = nomad();
    let ids = || rig.ids().iter().map(|id| &**id);
    let mut tables = Tables {
        echoes: TableWriter::echoes(Vec::new(), ids()).unwrap(),
        crossings: TableWriter::crossings(Vec::new(), ids()).unwrap(),
    };
    fuse(table, Emit::Settled, &mut tables).expect("the table is fused");
    [tables.echoes, tables.crossings].map(|table| {
        let text = String::from_utf8(table.into_inner()).unwrap();
        text.lines().skip(1).map(str::to_owned).collect()
    })
}

/// A message, with what its channel says of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Logged {
    pub topic: String,
    pub schema: String,
    pub encoding: String,
    pub metadata: BTreeMap<String, String>,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
    pub data: Vec<u8>,
}

impl From<mcap::Message<'_>> for Logged {
    fn from(message: mcap::Message<'_>) -> Self {
        let channel = &message.channel;
        Self {
            topic: channel.topic.clone(),
            schema: channel.schema.as_ref().map(|schema| schema.name.clone()).unwrap_or_default(),
            encoding: channel.message_encoding.clone(),
            metadata: channel.metadata.clone(),
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
            data: message.data.into_owned(),
        }
    }
}

/// The messages of a whole file in its order, checksums compared.
pub fn messages(file: &[u8]) -> Vec<Logged> {
    let stream = MessageStream::new_with_options(file, ReadOptions::ValidateChunkCrcs.into()).expect("it is MCAP");
    stream.map(|message| message.expect("every message can be read").into()).collect()
}

pub fn of_topic(file: &[u8], topic: &str) -> Vec<Logged> {
    messages(file).into_iter().filter(|message| message.topic == topic).collect()
}

pub fn summary(file: &[u8]) -> Summary {
    Summary::read(file).expect("it has a summary").expect("it has a summary")
}

/// The sensors' names by index, from the file's metadata.
pub fn sensor_names(file: &[u8]) -> BTreeMap<u16, String> {
    let records = summary(file).metadata_indexes;
    let ours = records.iter().filter(|index| index.name == SENSORS);
    let entries = ours.flat_map(|index| mcap::read::metadata(file, index).expect("it can be read").metadata);
    entries.map(|(index, id)| (index.parse().expect("an index"), id)).collect()
}

/// Hands everything on, except that a reader may be told of each record.
pub struct Recorded<'a, S> {
    pub sink: &'a mut S,
    pub after_record: &'a mut dyn FnMut(&mut S, &Row),
}

impl<S: EchoSink> EchoSink for Recorded<'_, S> {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        self.sink.sensors(ids)
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        (self.after_record)(self.sink, row);
        self.sink.record(row, pose)
    }

    fn reading(&mut self, reading: &Reading<f64>) -> Result<()> {
        self.sink.reading(reading)
    }

    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        self.sink.echo(echo)
    }

    fn wants_crossings(&self) -> bool {
        self.sink.wants_crossings()
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        self.sink.crossings(crossings)
    }

    fn flush(&mut self) -> Result<()> {
        self.sink.flush()
    }
}
