//! The Python package `atm`: converts and raises, nothing else. The numbers are the library's.

// What is written over a Python item is its docstring: numpydoc, not rustdoc.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]

mod argument;
mod column;
mod echo;
mod file;
mod fuse;
mod fuser;
mod interrupt;
mod job;
mod judge;
mod options;
mod plan;
mod raise;
mod readings;
mod rig;
mod sensors;
mod simulate;
mod table;
mod time;
mod view;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line `argv`, the program's name first, and returns the exit status.
#[pyfunction]
fn _main(py: Python<'_>, argv: Vec<OsString>) -> u8 {
    py.detach(|| atm_cli::run(argv))
}

/// The native part of the package atm.
#[pymodule]
mod _atm {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::{
        _main,
        echo::PyEcho,
        file::fuse_file,
        fuse::{crossings, fuse},
        fuser::PyFuser,
        judge::{compare, evaluate},
        plan::plan,
        rig::{_restore_rig, _restore_sensor, PyRig, PySensor},
        simulate::simulate,
        view::_view,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        for name in ["compare", "crossings", "evaluate", "fuse", "fuse_file", "plan", "simulate"] {
            // Where they are for those who use them.
            module.getattr(name)?.setattr("__module__", "atm")?;
        }
        Ok(())
    }
}
