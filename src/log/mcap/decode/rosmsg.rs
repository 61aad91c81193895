//! Schemas in the language of `.msg` files, `ros1msg` and `ros2msg`: the type itself, then the types it needs, each behind a line
//! of `=` and a line `MSG: package/Name`.

use super::definition::{Base, Count, Definitions, Field, Scalar, short};

/// Which ROS a definition is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Version {
    One,
    Two,
}

/// Reads a schema of the type `name`; the words are what can't be read.
pub(super) fn parse(name: &str, text: &str, version: Version) -> Result<Definitions, String> {
    let mut definitions = Definitions::default();
    let (mut type_name, mut fields) = (short(name), Vec::new());
    let mut after_rule = false;
    for line in text.lines() {
        let line = without_comment(line).trim();
        if line.len() >= 3 && line.bytes().all(|byte| byte == b'=') {
            after_rule = true;
        } else if let Some(next) = line.strip_prefix("MSG:").filter(|_| after_rule) {
            definitions.0.insert(std::mem::replace(&mut type_name, short(next.trim())), std::mem::take(&mut fields));
            after_rule = false;
        } else if let Some(field) = field(line, package(&type_name), version)? {
            fields.push(field);
        }
    }
    definitions.0.insert(type_name, fields);
    Ok(definitions)
}

fn package(type_name: &str) -> &str {
    type_name.split('/').next().unwrap_or_default()
}

/// A `#` begins a comment, except in the value of a text constant, which is of no interest.
fn without_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// The field of a line; `None` where it has none: blank, or a constant.
fn field(line: &str, package: &str, version: Version) -> Result<Option<Field>, String> {
    let mut words = line.split_whitespace();
    let Some(kind) = words.next() else { return Ok(None) };
    // `name=value` is a constant; `name value` a field with a default value, of which only the name matters.
    let rest = line.get(kind.len()..).unwrap_or_default().trim_start();
    let name: &str = rest.split(|c: char| c.is_whitespace() || c == '=').next().unwrap_or_default();
    let behind = rest.get(name.len()..).unwrap_or_default().trim_start();
    if behind.starts_with('=') {
        return Ok(None);
    }
    if name.is_empty() {
        return Err(format!("`{line}` is no field"));
    }
    let (base, count) = match kind.split_once('[') {
        None => (kind, Count::One),
        Some((base, size)) => match size.strip_suffix(']') {
            Some("") => (base, Count::Counted),
            Some(bound) if bound.starts_with("<=") => (base, Count::Counted),
            Some(size) => (base, Count::Fixed(size.parse().map_err(|_| format!("`{line}` has no size"))?)),
            None => return Err(format!("`{line}` is no field")),
        },
    };
    // `string<=10` is a text all the same.
    let base = base.split("<=").next().unwrap_or(base);
    Ok(Some(Field { name: name.to_owned(), base: self::base(base, package, version), count }))
}

fn base(name: &str, package: &str, version: Version) -> Base {
    let scalar = match name {
        "bool" | "byte" | "uint8" => Scalar::U8,
        // In ROS 1 both are what they sound like, in ROS 2 the other way round; as wide they are all the same.
        "char" => Scalar::U8,
        "int8" => Scalar::I8,
        "uint16" => Scalar::U16,
        "int16" => Scalar::I16,
        "uint32" => Scalar::U32,
        "int32" => Scalar::I32,
        "uint64" => Scalar::U64,
        "int64" => Scalar::I64,
        "float32" => Scalar::F32,
        "float64" => Scalar::F64,
        "time" | "duration" if version == Version::One => Scalar::Time,
        "string" => return Base::Text,
        "wstring" => return Base::Opaque(name.to_owned()),
        "Header" => return Base::Named("std_msgs/Header".to_owned()),
        _ if name.contains('/') => return Base::Named(short(name)),
        _ => return Base::Named(format!("{package}/{name}")),
    };
    Base::Scalar(scalar)
}
