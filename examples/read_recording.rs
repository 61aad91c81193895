//! A pass of the `mcap` crate's own reader over a recording, and nothing else: what `atm fuse` is measured against.
//!
//! ```console
//! $ cargo run --release --example read_recording -- drive.mcap
//! ```

use std::{env, error::Error, fs::File, io::Read};

use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader};

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).ok_or("which recording?")?;
    let (mut file, mut reader) = (File::open(path)?, LinearReader::new());
    let (mut records, mut bytes) = (0_u64, 0_u64);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(count) => {
                let read = file.read(reader.insert(count))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, .. } => {
                records += 1;
                bytes += data.len() as u64;
            }
        }
    }
    println!("{records} records of {bytes} bytes");
    Ok(())
}
