use super::super::{
    McapReadings, Options,
    built::{chunk, lz4, record, unfinished, zstd},
    op,
    records::MAGIC,
};
use super::*;
use crate::log::{
    Input, Next, Row, Source,
    tests::{input, stuttering},
};

/// A recording of one chunk without a checksum, whose packed content somebody may `spoil`.
fn recording(compression: &str, pack: impl Fn(&[u8]) -> Vec<u8>, spoil: impl Fn(&mut [u8])) -> Vec<u8> {
    let schema = [&1u16.to_le_bytes()[..], &[0; 12]].concat();
    let plain = record(op::SCHEMA, &schema).repeat(20);
    let mut packed = pack(&plain);
    spoil(&mut packed);
    unfinished(&chunk(compression, plain.len() as u64, 0, &packed))
}

/// Why which byte of the recording can't be used.
fn problems(input: Input) -> Vec<(Reason, u64)> {
    let mut log = McapReadings::open("-", input, None, None, Options::default()).unwrap();
    let (mut row, mut problems) = (Row::default(), Vec::new());
    // That there is no reading in it is an error at its end.
    while let Ok(Next::Record | Next::Unusable) =
        log.next_row(&mut row, &mut |problem| problems.push((problem.reason, problem.place.byte)))
    {}
    problems
}

#[test]
fn what_is_wrong_behind_the_last_record_of_a_chunk_is_found_however_it_comes() {
    let chunk = (MAGIC.len() + record(op::HEADER, &[0; 8]).len()) as u64;
    type Pack = fn(&[u8]) -> Vec<u8>;
    for (name, pack) in [("lz4", lz4 as Pack), ("zstd", zstd as Pack)] {
        let right = recording(name, pack, |_| ());
        assert_eq!((problems(input(right.clone())), problems(stuttering(right))), (vec![], vec![]), "{name}");
        for back in 1..=8 {
            let bytes = recording(name, pack, |packed| {
                let at = packed.len() - back;
                packed[at] ^= 0x40;
            });
            let whole = problems(input(bytes.clone()));
            assert_eq!(whole, problems(stuttering(bytes)), "{name}, {back} bytes before the end");
            assert!(whole.is_empty() || whole == [(Reason::BadChunk, chunk)], "{whole:?}");
        }
    }
    let more = recording("", |plain| [plain, &[1, 2, 3]].concat(), |_| ());
    assert_eq!(problems(input(more)), [(Reason::BadChunk, chunk)]);
}
