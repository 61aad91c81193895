//! Messages in JSON, by the names of their fields.

use serde_json::Value;

use super::said::{Kind, Said, Slot};

/// Largest message that is read, in bytes: taken apart it takes a multiple.
const LARGEST: usize = 4 << 20;
/// Objects within objects whose fields are looked at, at most.
const DEEPEST: usize = 6;

/// Reads a message, as [`super::plan::Plan::read`] does.
pub(super) fn read(kind: Kind, data: &[u8], said: &mut Said, each: &mut dyn FnMut(&mut Said)) -> Result<(), String> {
    if data.len() > LARGEST {
        return Err(format!("it has {} bytes of JSON, more than {} MiB", data.len(), LARGEST >> 20));
    }
    let value: Value = match serde_json::from_slice(data) {
        Ok(value) => value,
        // Python writes numbers that are not finite as bare words.
        Err(error) => {
            serde_json::from_slice(&with_quoted_words(data)).map_err(|_| format!("it is no JSON: {error}"))?
        }
    };
    let mut one = |kind: Kind, value: &Value| {
        said.clear();
        fill(kind, value, &mut String::new(), DEEPEST, said);
        match said.missing(kind) {
            Some(name) => Err(format!("it has no `{name}` of the kind that is needed")),
            None => {
                each(said);
                Ok(())
            }
        }
    };
    match kind.list() {
        None => one(kind, &value),
        Some((list, element)) => match value.get(list).and_then(Value::as_array) {
            Some(elements) => elements.iter().try_for_each(|value| one(element, value)),
            None => Err(format!("it has no list `{list}`")),
        },
    }
}

/// The same text with `NaN`, `Infinity` and `-Infinity` in quotes, where they stand bare.
fn with_quoted_words(data: &[u8]) -> Vec<u8> {
    const WORDS: [&[u8]; 3] = [b"-Infinity", b"Infinity", b"NaN"];
    let (mut quoted, mut rest) = (Vec::with_capacity(data.len() + 16), data);
    let (mut in_text, mut escaped) = (false, false);
    while let [first, behind @ ..] = rest {
        let word = WORDS.iter().find(|word| !in_text && rest.starts_with(word));
        if let Some(word) = word {
            quoted.push(b'"');
            quoted.extend_from_slice(word);
            quoted.push(b'"');
            rest = rest.get(word.len()..).unwrap_or_default();
            continue;
        }
        in_text ^= *first == b'"' && !escaped;
        escaped = in_text && *first == b'\\' && !escaped;
        quoted.push(*first);
        rest = behind;
    }
    quoted
}

fn fill(kind: Kind, value: &Value, path: &mut String, depth: usize, said: &mut Said) {
    match value {
        Value::Object(fields) if depth > 0 => {
            for (name, value) in fields {
                let length = path.len();
                if length > 0 {
                    path.push('.');
                }
                path.push_str(name);
                fill(kind, value, path, depth - 1, said);
                path.truncate(length);
            }
        }
        Value::Object(_) | Value::Array(_) => {}
        leaf => {
            if let Some(slot) = kind.slot(path) {
                set(slot, leaf, said);
            }
        }
    }
}

fn set(slot: Slot, value: &Value, said: &mut Said) {
    match (slot, value) {
        (Slot::Frame | Slot::Child, Value::String(text)) => said.set_text(slot, text),
        (Slot::Seconds | Slot::Nanoseconds, Value::Number(_)) => {
            if let Some(whole) = value.as_i64() {
                said.set_whole(slot, whole);
            }
        }
        (Slot::Number(_), _) => {
            if let Some(number) = real(value) {
                said.set_number(slot, number);
            }
        }
        _ => {}
    }
}

/// A number. JSON has none for what is not finite: it is written in words, and as `null` where there is no reading.
fn real(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::Null => Some(f64::NAN),
        Value::String(text) => text.parse().ok(),
        _ => None,
    }
}

/// Whether a JSON schema has the fields of a reading.
pub(super) fn is_range(schema: &[u8]) -> bool {
    let Ok(schema) = serde_json::from_slice::<Value>(schema) else { return false };
    let has = |name| schema.get("properties").and_then(|fields| fields.get(name)).is_some();
    ["field_of_view", "min_range", "max_range", "range"].into_iter().all(has)
}
