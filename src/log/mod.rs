//! Logs in and out, one file a format.
pub mod csv;
pub mod output;
pub mod poses;
pub mod table;
