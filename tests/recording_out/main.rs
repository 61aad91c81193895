//! Recordings that are written, read back by decoders of their own.

mod cdr;
mod cloud;
mod consensus;
mod content;
mod file;
mod passing;
mod proto;
mod read_back;
mod robot;
mod sample;
