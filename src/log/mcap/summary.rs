//! The summary at the end of a recording: which channels there are.

use std::io;

use super::{
    fields::Fields,
    op,
    records::MAGIC,
    registry::Registry,
    window::{Recording, Window},
};

/// Footer record and the mark of the end.
const TAIL: u64 = 9 + 20 + 8;
/// Largest schema, channel or statistics that is read of a summary.
const LARGEST: u64 = 16 << 20;

/// Reads the summary of a file into `registry`; says how many channels there are. `None`, and nothing is known, where there is
/// no whole one: the records themselves will tell.
pub(super) fn read(window: &mut Window<Recording>, registry: &mut Registry) -> io::Result<Option<u32>> {
    let channels = read_whole(window, registry)?;
    if channels.is_none() {
        registry.clear();
    }
    Ok(channels)
}

fn read_whole(window: &mut Window<Recording>, registry: &mut Registry) -> io::Result<Option<u32>> {
    let Some(tail) = window.length().and_then(|length| length.checked_sub(TAIL)) else { return Ok(None) };
    window.go_to(tail)?;
    let mut footer = Fields(window.need(TAIL as usize)?);
    let is_footer = footer.bytes(1) == Some(&[op::FOOTER]) && footer.u64() == Some(20);
    let (start, _, checksum) = (footer.u64(), footer.u64(), footer.u32());
    let (Some(start), Some(checksum), true) = (start, checksum, is_footer && footer.0 == MAGIC) else {
        return Ok(None);
    };
    if start == 0 || start > tail {
        return Ok(None);
    }
    window.go_to(start)?;
    window.begin_checksum();
    let channels = read_records(window, registry, tail)?;
    // The checksum is over everything up to itself: the footer's head and its first two fields, too.
    window.skip((tail + 9 + 16).saturating_sub(window.position()))?;
    let found = window.take_checksum();
    Ok(channels.filter(|_| checksum == 0 || found == Some(checksum)))
}

fn read_records(window: &mut Window<Recording>, registry: &mut Registry, end: u64) -> io::Result<Option<u32>> {
    let (mut record, mut channels) = (Vec::new(), None);
    while window.position() < end {
        let Some([opcode, length @ ..]) = window.peek::<9>()? else { return Ok(None) };
        let length = u64::from_le_bytes(length);
        if length > end.saturating_sub(window.position() + 9) {
            return Ok(None);
        }
        window.use_up(9);
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::STATISTICS) || length > LARGEST {
            window.skip(length)?;
            continue;
        }
        record.clear();
        window.copy(length, &mut record)?;
        let usable = match opcode {
            op::SCHEMA => registry.add_schema(&record).is_ok(),
            op::CHANNEL => registry.add_channel(&record).is_ok(),
            _ => {
                let mut fields = Fields(&record);
                channels = (|| {
                    fields.bytes(8 + 2)?;
                    fields.u32()
                })();
                channels.is_some()
            }
        };
        if !usable {
            return Ok(None);
        }
    }
    Ok(channels)
}
