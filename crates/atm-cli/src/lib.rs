//! The `atm` command as a library.
