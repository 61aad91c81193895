//! Sensors in arrays, by id or by index.

use atm::rig::Rig;
use numpy::{PyArray1, PyArrayDescr, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::{prelude::*, types::PyString};

use crate::{
    argument,
    column::{Held, Shape, array, check_mask, held, no_numbers},
    raise,
};

/// Sensors by their indices in the rig.
pub enum Sensors {
    Each(Vec<u16>),
    Same(u16),
}

impl Sensors {
    pub const fn len(&self) -> Option<usize> {
        match self {
            Self::Each(list) => Some(list.len()),
            Self::Same(_) => None,
        }
    }

    pub fn spread(self, len: usize) -> Vec<u16> {
        match self {
            Self::Each(list) => list,
            Self::Same(sensor) => vec![sensor; len],
        }
    }
}

/// Sensors by id: strings, or whole numbers where the rig's ids are their own indices.
pub fn ids(given: &Bound<'_, PyAny>, rig: &Rig, shape: Shape) -> PyResult<Sensors> {
    const NAME: &str = "sensor";
    if let Ok(id) = given.cast::<PyString>() {
        let id = id.to_string_lossy();
        if shape == Shape::Array {
            return Err(raise::value(NAME, format_args!("{id:?}: expected an array of ids")));
        }
        return known(rig, &id).map(Sensors::Same).map_err(|message| raise::value(NAME, message));
    }
    check_mask(NAME, given)?;
    let array = array(NAME, given, shape)?;
    match array.dtype().kind() {
        _ if array.is_empty() => Ok(Sensors::Each(Vec::new())),
        b'i' | b'u' if is_numbered(rig) => indices(NAME, array.as_any(), rig, shape),
        b'i' | b'u' => {
            let first = rig.sensors().first().map_or("", |sensor| sensor.id());
            let message = format!(
                "whole numbers, but the rig's ids are not \"0\" to \"{}\" (the first is {first:?}): give ids as strings, or \
                 sensor=None and indices as sensor_index=",
                rig.sensors().len() - 1
            );
            Err(raise::kind(NAME, message))
        }
        b'U' => wide_texts(&array, rig),
        b'S' => byte_texts(&array, rig),
        b'O' | b'T' => objects(&array, rig),
        _ => Err(raise::kind(
            &item_name(NAME, &array),
            format_args!("expected ids, strings or ints, found dtype {}", array.dtype()),
        )),
    }
}

fn item_name(name: &str, array: &Bound<'_, PyUntypedArray>) -> String {
    if array.ndim() == 0 { name.to_owned() } else { format!("{name}[0]") }
}

/// Whether every sensor's id is its index.
fn is_numbered(rig: &Rig) -> bool {
    rig.sensors().iter().enumerate().all(|(index, sensor)| sensor.id() == index.to_string())
}

fn known(rig: &Rig, id: &str) -> Result<u16, String> {
    rig.index_of(id).ok_or_else(|| format!("the rig {} has no sensor {id:?}", rig.name()))
}

/// Sensors by their indices in the rig.
pub fn indices(name: &'static str, given: &Bound<'_, PyAny>, rig: &Rig, shape: Shape) -> PyResult<Sensors> {
    check_mask(name, given)?;
    let array = array(name, given, shape)?;
    if !array.is_empty() && !matches!(array.dtype().kind(), b'i' | b'u') {
        return Err(no_numbers(name, &array, "whole numbers"));
    }
    let count = rig.sensors().len();
    let index_of = |index: i64| {
        let sensor = u16::try_from(index).ok().filter(|sensor| usize::from(*sensor) < count);
        sensor.ok_or_else(|| format!("the rig {} has no sensor {index}: they are 0 to {}", rig.name(), count - 1))
    };
    match held::<i64>(array)? {
        Held::Same(index) => index_of(index).map(Sensors::Same).map_err(|message| raise::value(name, message)),
        Held::Each(array) => each(name, array.as_array().iter().map(|&index| index_of(index))),
    }
}

/// Gathers sensors; the first that is none is named by its place.
fn each(name: &str, sensors: impl Iterator<Item = Result<u16, String>>) -> PyResult<Sensors> {
    let mut list = Vec::with_capacity(sensors.size_hint().0);
    for (index, sensor) in sensors.enumerate() {
        list.push(sensor.map_err(|message| raise::value(&format!("{name}[{index}]"), message))?);
    }
    Ok(Sensors::Each(list))
}

/// The items of an array of texts side by side, `T` a character, zeros at the end of each.
fn characters<'py, T: numpy::Element>(array: &Bound<'py, PyUntypedArray>) -> PyResult<Bound<'py, PyArray1<T>>> {
    let py = array.py();
    let native = array.dtype().call_method1("newbyteorder", ("=",))?;
    let array = py.import("numpy")?.call_method1("ascontiguousarray", (array, native))?;
    Ok(array.call_method1("reshape", (-1,))?.call_method1("view", (PyArrayDescr::of::<T>(py),))?.cast_into()?)
}

/// One sensor where the array has no dimension.
fn collapsed(array: &Bound<'_, PyUntypedArray>, sensors: Sensors) -> Sensors {
    match (&sensors, array.ndim()) {
        (Sensors::Each(list), 0) => list.first().map_or(Sensors::Each(Vec::new()), |sensor| Sensors::Same(*sensor)),
        _ => sensors,
    }
}

/// numpy's `U`: four bytes a character.
fn wide_texts(array: &Bound<'_, PyUntypedArray>, rig: &Rig) -> PyResult<Sensors> {
    let width = array.dtype().itemsize() / size_of::<u32>();
    let characters = characters::<u32>(array)?;
    let characters = characters.readonly();
    let mut id = String::with_capacity(width);
    let sensors = characters.as_slice()?.chunks_exact(width.max(1)).map(|item| {
        id.clear();
        let end = item.iter().rposition(|&code| code != 0).map_or(0, |last| last + 1);
        id.extend(item.iter().take(end).map(|&code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)));
        known(rig, &id)
    });
    Ok(collapsed(array, each("sensor", sensors)?))
}

/// numpy's `S`: bytes, taken as UTF-8.
fn byte_texts(array: &Bound<'_, PyUntypedArray>, rig: &Rig) -> PyResult<Sensors> {
    let width = array.dtype().itemsize();
    let bytes = characters::<u8>(array)?;
    let bytes = bytes.readonly();
    let sensors = bytes.as_slice()?.chunks_exact(width.max(1)).map(|item| {
        let end = item.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        known(rig, &String::from_utf8_lossy(item.get(..end).unwrap_or_default()))
    });
    Ok(collapsed(array, each("sensor", sensors)?))
}

/// Python strings one by one.
fn objects(array: &Bound<'_, PyUntypedArray>, rig: &Rig) -> PyResult<Sensors> {
    let items = array.call_method1("reshape", (-1,))?.call_method1("astype", ("O",))?;
    let mut list = Vec::with_capacity(array.len());
    for (index, item) in items.try_iter()?.enumerate() {
        let (item, name) = (item?, || format!("sensor[{index}]"));
        let id = item.cast::<PyString>().map_err(|_| {
            raise::kind(&name(), format_args!("expected an id, a string, found {}", argument::shown(&item)))
        })?;
        list.push(known(rig, &id.to_string_lossy()).map_err(|message| raise::value(&name(), message))?);
    }
    Ok(collapsed(array, Sensors::Each(list)))
}
