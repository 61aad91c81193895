//! A comparison as JSON: what `atm compare --json` prints, and Python returns.

use serde_json::{Map, Result, Value, json};

use super::{assess::Assessment, method::Name};
use crate::eval::Scores;

/// An object: the methods' words, each with the keys of `eval` and what is added to them; null where they don't apply.
///
/// # Errors
/// Those of serde_json, which has none for texts as keys.
pub fn as_json(rows: &[(Name, &Assessment)]) -> Result<Value> {
    let rows = rows.iter().map(|(name, assessment)| Ok((name.word().to_owned(), row(assessment)?)));
    rows.collect::<Result<Map<_, _>>>().map(Value::Object)
}

fn row(assessment: &Assessment) -> Result<Value> {
    let mut row = match &assessment.scores {
        Some(scores) => serde_json::to_value(scores)?,
        None => nulls(serde_json::to_value(Scores::default())?),
    };
    let added = [
        ("agreement", serde_json::to_value(&assessment.agreement)?),
        ("best", serde_json::to_value(&assessment.best)?),
        ("map_entropy_bits", serde_json::to_value(assessment.map_entropy_bits)?),
        ("points", json!(assessment.points)),
        ("same_readings", serde_json::to_value(&assessment.same_readings)?),
        ("seconds_per_reading", json!(assessment.seconds_per_reading)),
    ];
    if let Some(row) = row.as_object_mut() {
        row.extend(added.map(|(key, value)| (key.to_owned(), value)));
    }
    Ok(row)
}

/// The same keys without values.
fn nulls(value: Value) -> Value {
    match value {
        Value::Object(object) => object.into_iter().map(|(key, value)| (key, nulls(value))).collect(),
        _ => Value::Null,
    }
}
