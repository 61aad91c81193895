//! Single values as Python gives them, checked, with the argument's name in what is said of them.

use std::{
    hash::{DefaultHasher, Hash, Hasher},
    path::PathBuf,
};

use pyo3::{
    exceptions::PyOverflowError,
    prelude::*,
    types::{PyFloat, PyInt, PyString},
};

use crate::raise;

/// Longest piece of a value that is shown.
const SHOWN: usize = 60;

/// A value as messages show it: its repr, shortened, and its type.
pub fn shown(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string_lossy().into_owned());
    let text = match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text,
    };
    let kind = value.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    format!("{text} ({kind})")
}

/// A whole number that is not negative; one that does not fit counts as the largest that does.
pub fn whole(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let index = value.call_method0("__index__");
    let index = index.map_err(|_| raise::kind(argument, format_args!("expected an int, found {}", shown(value))))?;
    match index.extract::<i64>() {
        Ok(number) => usize::try_from(number).map_err(|_| raise::value(argument, format_args!("{number} is negative"))),
        Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) && index.gt(0)? => Ok(usize::MAX),
        Err(_) => Err(raise::value(argument, format_args!("{} is out of range", shown(value)))),
    }
}

/// Takes the numbers and words of a signature, so that what is refused is named.
pub mod named {
    use pyo3::prelude::*;

    macro_rules! numbers {
        ($($name:ident)*) => {$(
            pub fn $name(value: &Bound<'_, PyAny>) -> PyResult<f64> {
                super::number(stringify!($name), value)
            }
        )*};
    }

    macro_rules! optional_numbers {
        ($($name:ident)*) => {$(
            pub fn $name(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
                if value.is_none() { Ok(None) } else { super::number(stringify!($name), value).map(Some) }
            }
        )*};
    }

    macro_rules! words {
        ($($name:ident)*) => {$(
            pub fn $name<'a>(value: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
                super::word(stringify!($name), value)
            }
        )*};
    }

    numbers! { x y yaw distance radius first_yaw min_range max_range }
    optional_numbers! {
        min_angle field_of_view max_age max_travel min_step improvement speed rate range_resolution confidence range_error cell reach
    }
    macro_rules! optional_words {
        ($($name:ident)*) => {$(
            pub fn $name<'a>(value: &'a Bound<'_, PyAny>) -> PyResult<Option<&'a str>> {
                if value.is_none() { Ok(None) } else { super::word(stringify!($name), value).map(Some) }
            }
        )*};
    }

    macro_rules! flags {
        ($($name:ident)*) => {$(
            pub fn $name(value: &Bound<'_, PyAny>) -> PyResult<bool> {
                super::flag(stringify!($name), value)
            }
        )*};
    }

    words! { emit on_none on_two name id schema estimator }
    optional_words! { empty from_ to topic pose_topic fixed_frame clock held range_unit boresight t_unit preset units }
    flags! { drop_held strict passthrough }

    /// Where it has to be given or has a default of its own.
    pub fn range_step(value: &Bound<'_, PyAny>) -> PyResult<f64> {
        super::number("range_resolution", value)
    }
}

/// A float as Python writes it.
pub fn float(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}

/// A shape as Python writes it.
pub fn shape(shape: &[usize]) -> String {
    match shape {
        [only] => format!("({only},)"),
        many => format!("({})", many.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// A real number.
pub fn number(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let wrong = || raise::kind(argument, format_args!("expected a number, found {}", shown(value)));
    if value.is_instance_of::<PyString>() {
        return Err(wrong());
    }
    value.extract::<f64>().map_err(|_| wrong())
}

/// A text.
pub fn word<'a>(argument: &str, value: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    match value.cast::<PyString>() {
        Ok(word) => word.to_str(),
        Err(_) => Err(raise::kind(argument, format_args!("expected a str, found {}", shown(value)))),
    }
}

/// True or false, of Python or numpy.
pub fn flag(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.extract().map_err(|_| raise::kind(argument, format_args!("expected a bool, found {}", shown(value))))
}

/// A plain Python number, the common case of a single reading; `None` leaves it to numpy.
pub fn plain_number(value: &Bound<'_, PyAny>) -> Option<f64> {
    if value.is_instance_of::<PyFloat>() || value.is_exact_instance_of::<PyInt>() {
        return value.extract().ok();
    }
    None
}

/// A path as text, from a str or an `os.PathLike`.
pub fn path(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let path = value
        .extract::<PathBuf>()
        .map_err(|_| raise::kind(argument, format_args!("expected a path, found {}", shown(value))))?;
    path.into_os_string().into_string().map_err(|path| raise::value(argument, format_args!("{path:?} is not Unicode")))
}

/// One of a few words.
pub fn choice<T: Copy>(argument: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    choices.iter().find(|(name, _)| *name == word).map(|&(_, choice)| choice).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|&(name, _)| name).collect();
        raise::value(argument, format_args!("{word:?} is none of {}", names.join(", ")))
    })
}

/// Texts: an iterable of them, or one with commas between them.
pub fn words(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    if value.is_instance_of::<PyString>() {
        return Ok(value.extract::<String>()?.split(',').map(|word| word.trim().to_owned()).collect());
    }
    let items = value.try_iter();
    let items = items.map_err(|_| raise::kind(argument, format_args!("expected texts, found {}", shown(value))))?;
    items.enumerate().map(|(index, item)| word(&format!("{argument}[{index}]"), &item?).map(str::to_owned)).collect()
}

/// A hash that is the same for equal texts.
pub fn hash(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}
