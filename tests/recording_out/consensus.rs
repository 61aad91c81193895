//! Recordings of the consensus: its fields behind the usual ones.

use atm::{
    core::ConsensusEcho,
    echo::AnyEcho,
    error::Result,
    log::mcap::write::{Options, points::KINDS as KIND_NAMES},
    pipeline::EchoSink,
};

use crate::{
    cloud::Cloud,
    sample::{KINDS, doorway, fuse_consensus, of_topic, options, recorded, sink},
};

/// What the consensus says of each reading.
#[derive(Default)]
struct Said(Vec<ConsensusEcho<f64>>);

impl EchoSink for Said {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        self.0.push(*echo.consensus().expect("the median was not asked"));
        Ok(true)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn said() -> Vec<ConsensusEcho<f64>> {
    let mut said = Said::default();
    fuse_consensus(&doorway(), &mut said).expect("the sample is fused");
    said.0
}

fn clouds(file: &[u8], topic: &str) -> Vec<Cloud> {
    of_topic(file, topic).iter().map(Cloud::of).collect()
}

#[test]
fn every_field_is_what_the_consensus_said_to_the_last_bit() {
    let said = said();
    assert!(said.iter().any(|echo| echo.normal.is_some()));
    for kind in KINDS {
        let mut sink = sink(Options { consensus: true, ..options(kind) });
        fuse_consensus(&doorway(), &mut sink).expect("memory takes it");
        let points: Vec<_> = clouds(&sink.finish().expect("memory takes it"), "/atm/echoes")
            .into_iter()
            .flat_map(|cloud| cloud.points)
            .collect();
        assert_eq!(points.len(), said.len());
        for (point, echo) in points.iter().zip(&said) {
            let normal = echo.normal.map_or([f64::NAN; 2], |normal| [normal.x, normal.y]);
            let expected = [
                ("range", echo.range),
                ("azimuth", echo.azimuth()),
                ("resolution", echo.resolution),
                ("significance", echo.significance()),
                ("crossings", f64::from(echo.support)),
                ("support", f64::from(echo.support)),
                ("against", f64::from(echo.against)),
                ("sigma_azimuth", echo.sigma_azimuth),
                ("sigma_range", echo.sigma_range),
                ("normal_x", normal[0]),
                ("normal_y", normal[1]),
            ];
            for (name, value) in expected {
                assert_eq!(point[name].to_bits(), value.to_bits(), "{name} of {echo:?}");
            }
            assert_eq!(KIND_NAMES[point["kind"] as usize], echo.kind.name());
        }
    }
}

#[test]
fn fields_are_the_medians_and_then_its_own() {
    for kind in KINDS {
        let names = |file: &[u8]| clouds(file, "/atm/echoes").remove(0).fields;
        let usual = names(&recorded(&doorway(), options(kind)));
        let mut sink = sink(Options { consensus: true, ..options(kind) });
        fuse_consensus(&doorway(), &mut sink).expect("memory takes it");
        let fields = names(&sink.finish().expect("memory takes it"));
        assert_eq!(fields[..usual.len()], usual);
        let own = ["sigma_azimuth", "sigma_range", "normal_x", "normal_y", "support", "against"];
        assert_eq!(fields[usual.len()..].iter().map(|field| &*field.0).collect::<Vec<_>>(), own);
        assert!(fields.iter().all(|(_, offset, size)| offset % size == 0), "{fields:?}");
    }
}
