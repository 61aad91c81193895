//! Numbers and times in numpy arrays, looked at in place.

use numpy::{
    PyArray1, PyArrayDescr, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray1, PyUntypedArray,
    PyUntypedArrayMethods, ndarray::ArrayView1,
};
use pyo3::{
    basic::CompareOp,
    exceptions::PyValueError,
    prelude::*,
    types::{PyInt, PyString},
};

use crate::{
    argument,
    raise::{self, Fault},
    time::{self, Clock},
};

/// Whether an argument may be a single value, which then holds for every reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// One dimension.
    Array,
    /// One dimension or none.
    Any,
}

/// One argument: an array, or one value for all.
pub enum Held<'py, T: numpy::Element> {
    Each(PyReadonlyArray1<'py, T>),
    Same(T),
}

/// What is read of an argument without the interpreter.
#[derive(Clone, Copy)]
pub enum Column<'a, T> {
    Each(ArrayView1<'a, T>),
    Same(T),
}

impl<'py, T: numpy::Element + Copy> Held<'py, T> {
    pub fn len(&self) -> Option<usize> {
        match self {
            Self::Each(array) => Some(array.len()),
            Self::Same(_) => None,
        }
    }

    pub fn column(&self) -> Column<'_, T> {
        match self {
            Self::Each(array) => Column::Each(array.as_array()),
            Self::Same(value) => Column::Same(*value),
        }
    }
}

impl<T: Copy> Column<'_, T> {
    #[inline]
    pub fn get(&self, index: usize, beyond: T) -> T {
        match self {
            Self::Each(view) => view.get(index).copied().unwrap_or(beyond),
            Self::Same(value) => *value,
        }
    }

    /// The index of the first item that `wrong` says something of, and what; no index for a single value.
    pub fn first<R>(&self, mut wrong: impl FnMut(T) -> Option<R>) -> Option<(Option<usize>, R)> {
        match self {
            Self::Each(view) => {
                view.iter().enumerate().find_map(|(index, &value)| wrong(value).map(|what| (Some(index), what)))
            }
            Self::Same(value) => wrong(*value).map(|what| (None, what)),
        }
    }
}

/// Times in nanoseconds, and how they were given.
pub struct HeldTimes<'py> {
    pub clock: Clock,
    nanoseconds: Nanoseconds<'py>,
}

enum Nanoseconds<'py> {
    /// As they lie in the array.
    Given(Held<'py, i64>),
    /// From seconds.
    Taken(Vec<i64>),
}

impl HeldTimes<'_> {
    pub fn len(&self) -> Option<usize> {
        match &self.nanoseconds {
            Nanoseconds::Given(held) => held.len(),
            Nanoseconds::Taken(list) => Some(list.len()),
        }
    }

    pub fn column(&self) -> Column<'_, i64> {
        match &self.nanoseconds {
            Nanoseconds::Given(held) => held.column(),
            Nanoseconds::Taken(list) => Column::Each(ArrayView1::from(list)),
        }
    }
}

/// The argument as numpy sees it, of a dimension that is allowed; a mask's items are not looked through.
pub fn array<'py>(name: &str, given: &Bound<'py, PyAny>, shape: Shape) -> PyResult<Bound<'py, PyUntypedArray>> {
    let numpy = given.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (given,)).map_err(|error| ragged(name, given, &error))?;
    let array = array.cast_into::<PyUntypedArray>()?;
    let found = argument::shape(array.shape());
    match (array.ndim(), shape) {
        (1, _) | (0, Shape::Any) => Ok(array),
        (_, Shape::Any) => Err(raise::value(
            name,
            format_args!("shape {:?}: expected one dimension, or a single value", array.shape()),
        )),
        (_, Shape::Array) => Err(raise::value(name, format_args!("shape {found}: expected one dimension"))),
    }
}

/// What is said where numpy can't make an array: of the first item that is none, where that is so.
fn ragged(name: &str, given: &Bound<'_, PyAny>, error: &PyErr) -> PyErr {
    let items = given.try_iter().into_iter().flatten().enumerate();
    let nested = items.filter_map(|(index, item)| Some((index, item.ok()?))).find(|(_, item)| item.len().is_ok());
    match nested {
        Some((index, item)) => {
            let message = format!("expected a single value, found {}", argument::shown(&item));
            raise::value(&format!("{name}[{index}]"), message)
        }
        None => raise::value(name, format_args!("can't be made an array: {}", error.value(given.py()))),
    }
}

/// Whether the items can be read where they lie.
fn in_place<T: numpy::Element>(array: &Bound<'_, PyUntypedArray>) -> bool {
    let dtype = array.dtype();
    dtype.is_equiv_to(&PyArrayDescr::of::<T>(array.py()))
        && array
            .getattr("flags")
            .is_ok_and(|flags| flags.getattr("aligned").is_ok_and(|aligned| aligned.is_truthy().unwrap_or(false)))
}

/// The items as `T`: where they lie if they are that, else converted.
pub fn held<'py, T: numpy::Element + Copy>(array: Bound<'py, PyUntypedArray>) -> PyResult<Held<'py, T>> {
    let array = if in_place::<T>(&array) {
        array.into_any()
    } else {
        array.call_method1("astype", (PyArrayDescr::of::<T>(array.py()),))?
    };
    if array.cast::<PyUntypedArray>()?.ndim() == 0 {
        let one = array.call_method1("reshape", (1,))?.cast_into::<PyArray1<T>>()?;
        let value = one.readonly().as_array().first().copied();
        return value.map(Held::Same).ok_or_else(|| PyValueError::new_err("an empty array"));
    }
    Ok(Held::Each(array.cast_into::<PyArray1<T>>()?.try_readonly()?))
}

/// What is wrong with an array that should hold numbers.
pub fn no_numbers(name: &str, array: &Bound<'_, PyUntypedArray>, expected: &str) -> PyErr {
    let item = array.call_method1("item", (0,)).ok().filter(|_| array.ndim() == 1);
    let wrong = array.try_iter().ok().and_then(|items| {
        items.enumerate().find_map(|(index, item)| {
            let item = item.ok()?;
            let number = item.extract::<f64>().is_ok() && !item.is_instance_of::<PyString>();
            (!number).then_some((index, item))
        })
    });
    let dtype = array.dtype();
    match (wrong, item) {
        (Some((index, item)), _) => raise::kind(
            &format!("{name}[{index}]"),
            format_args!("expected {expected}, found {} in an array of dtype {dtype}", argument::shown(&item)),
        ),
        (None, Some(item)) => raise::kind(
            &format!("{name}[0]"),
            format_args!(
                "expected {expected}, found {} in an array of dtype {dtype}; convert it with astype",
                argument::shown(&item)
            ),
        ),
        (None, None) => raise::kind(name, format_args!("expected {expected}, found dtype {dtype}")),
    }
}

/// Refuses masked items, which numpy would hand over as if they were not: by index. NaN stands for no number.
pub fn check_mask(name: &str, given: &Bound<'_, PyAny>) -> PyResult<()> {
    let Some(mask) = given.getattr_opt("mask")?.filter(|_| given.hasattr("filled").unwrap_or(false)) else {
        return Ok(());
    };
    let numpy = given.py().import("numpy")?;
    let masked = numpy.call_method1("flatnonzero", (mask,))?;
    match masked.try_iter()?.next() {
        Some(index) => {
            let name = format!("{name}[{}]", index?);
            Err(raise::value(&name, "is masked; fill the mask first (nan is a reading without an echo)"))
        }
        None => Ok(()),
    }
}

/// Numbers of any dtype as `float64`.
pub fn numbers<'py>(name: &str, given: &Bound<'py, PyAny>, shape: Shape) -> PyResult<Held<'py, f64>> {
    if let Some(value) = argument::plain_number(given).filter(|_| shape == Shape::Any) {
        return Ok(Held::Same(value));
    }
    check_mask(name, given)?;
    let array = array(name, given, shape)?;
    match array.dtype().kind() {
        b'f' | b'i' | b'u' => held(array),
        _ => Err(no_numbers(name, &array, "numbers")),
    }
}

/// Times: seconds where they are floats, nanoseconds where they are whole numbers, and what they say themselves where they are
/// datetime64. `unit`: of whole numbers, in nanoseconds; without one it has to make sense that they are that.
pub fn times<'py>(given: &Bound<'py, PyAny>, shape: Shape, unit: Option<i64>) -> PyResult<HeldTimes<'py>> {
    const NAME: &str = "t";
    if let Some(value) = argument::plain_number(given).filter(|_| shape == Shape::Any) {
        if !given.is_instance_of::<PyInt>() {
            let clock = Clock::Seconds;
            let ns = time::nanoseconds(value).ok_or_else(|| raise::value(NAME, no_time(value)))?;
            return Ok(HeldTimes { clock, nanoseconds: Nanoseconds::Given(Held::Same(ns)) });
        }
        let wrong = |_| raise::value(NAME, format_args!("{} ns is no time: beyond 64 bits", argument::shown(given)));
        return whole_times(Held::Same(given.extract().map_err(wrong)?), unit);
    }
    check_mask(NAME, given)?;
    let array = array(NAME, given, shape)?;
    match array.dtype().kind() {
        b'f' => seconds(given.py(), &held(array)?),
        b'i' => whole_times(held(array)?, unit),
        b'u' => {
            let numpy = given.py().import("numpy")?;
            let beyond = numpy.call_method1("flatnonzero", (array.rich_compare(i64::MAX, CompareOp::Gt)?,))?;
            if let Some(index) = beyond.try_iter()?.next() {
                return Err(raise::value(&format!("{NAME}[{}]", index?), "is no time: beyond 64 bits"));
            }
            whole_times(held(array)?, unit)
        }
        b'M' => {
            let nanoseconds = array.call_method1("astype", ("datetime64[ns]",))?;
            let numpy = given.py().import("numpy")?;
            let missing = numpy.call_method1("flatnonzero", (numpy.call_method1("isnat", (&nanoseconds,))?,))?;
            if let Some(index) = missing.try_iter()?.next() {
                return Err(raise::value(&format!("{NAME}[{}]", index?), "is no time: NaT"));
            }
            whole_times(held(nanoseconds.call_method1("astype", ("int64",))?.cast_into()?)?, Some(1))
        }
        _ => Err(no_numbers(NAME, &array, "float seconds or int nanoseconds")),
    }
}

/// Whole numbers of a unit in nanoseconds. Only nanoseconds are given back as whole numbers.
fn whole_times(held: Held<'_, i64>, unit: Option<i64>) -> PyResult<HeldTimes<'_>> {
    match unit {
        None => check_pace(&held)?,
        Some(1) => {}
        Some(unit) => {
            let taken = |index, t: i64| {
                t.checked_mul(unit).ok_or_else(|| Fault {
                    argument: "t",
                    index,
                    message: format!("{t} is no time: beyond 64 bits"),
                })
            };
            let nanoseconds = match held.column() {
                Column::Same(t) => Nanoseconds::Given(Held::Same(taken(None, t)?)),
                Column::Each(view) => {
                    let items = view.iter().enumerate().map(|(index, &t)| taken(Some(index), t));
                    Nanoseconds::Taken(items.collect::<Result<_, Fault>>()?)
                }
            };
            return Ok(HeldTimes { clock: Clock::Seconds, nanoseconds });
        }
    }
    Ok(HeldTimes { clock: Clock::Nanoseconds, nanoseconds: Nanoseconds::Given(held) })
}

/// Refuses whole numbers that are no nanoseconds: more than a million instants a second are seconds, or some other unit.
fn check_pace(held: &Held<'_, i64>) -> PyResult<()> {
    const SHORTEST: u64 = 1_000;
    let Column::Each(view) = held.column() else { return Ok(()) };
    let (mut instants, mut last) = (0u64, None);
    for &t in view {
        instants += u64::from(last.replace(t).is_some_and(|last| last != t));
    }
    let (Some(&first), Some(last)) = (view.first(), last) else { return Ok(()) };
    // What goes back is refused as that.
    if last <= first {
        return Ok(());
    }
    let span = last.abs_diff(first);
    if instants == 0 || span / instants >= SHORTEST {
        return Ok(());
    }
    let message = format!(
        "whole numbers from {first} to {last}, which would be {span} ns for {} different times; say t_unit=\"s\", or \"ns\" if they \
         are that, or give float seconds",
        instants + 1
    );
    Err(raise::value("t", message))
}

/// Seconds as nanoseconds, with the interpreter let go.
fn seconds<'py>(py: Python<'py>, held: &Held<'py, f64>) -> PyResult<HeldTimes<'py>> {
    let taken = |index, t| time::nanoseconds(t).ok_or_else(|| Fault { argument: "t", index, message: no_time(t) });
    let nanoseconds = match held.column() {
        Column::Same(t) => Nanoseconds::Given(Held::Same(taken(None, t)?)),
        Column::Each(view) => {
            let items = view.iter().enumerate().map(|(index, &t)| taken(Some(index), t));
            Nanoseconds::Taken(py.detach(|| items.collect::<Result<_, Fault>>())?)
        }
    };
    Ok(HeldTimes { clock: Clock::Seconds, nanoseconds })
}

fn no_time(seconds: f64) -> String {
    format!("{} s is no time", argument::float(seconds))
}
