//! Message types as protobuf describes them to a reader: a `FileDescriptorSet` (google/protobuf/descriptor.proto).

use super::{
    super::protobuf::ProtoWriter,
    types::{Field, Type, Value},
};

/// The type and all it is made of, each before what uses it.
pub(super) fn set(root: &'static Type) -> Vec<u8> {
    let mut types = Vec::new();
    gather(root, &mut types);
    let mut set = ProtoWriter::default();
    for one in types {
        set.message(1, |out| file(one, out));
    }
    set.bytes().to_vec()
}

/// The types of the fields that are messages, each once.
fn parts(whole: &Type) -> Vec<&'static Type> {
    let mut parts: Vec<&'static Type> = Vec::new();
    for field in whole.fields {
        if let Value::Message(part) = field.value
            && !parts.iter().any(|known| known.file == part.file)
        {
            parts.push(part);
        }
    }
    parts
}

fn gather(whole: &'static Type, types: &mut Vec<&'static Type>) {
    if types.iter().any(|known| known.file == whole.file) {
        return;
    }
    for part in parts(whole) {
        gather(part, types);
    }
    types.push(whole);
}

/// A FileDescriptorProto.
fn file(one: &Type, out: &mut ProtoWriter) {
    out.string(1, one.file);
    out.string(2, one.package);
    for part in parts(one) {
        out.element(3, part.file);
    }
    out.message(4, |out| message(one, out));
    out.string(12, "proto3");
}

/// A DescriptorProto.
fn message(one: &Type, out: &mut ProtoWriter) {
    out.string(1, one.name);
    for entry in one.fields {
        out.message(2, |out| field(one, entry, out));
    }
    for entry in one.fields {
        if let Value::Enum(name, values) = entry.value {
            out.message(4, |out| enumeration(name, values, out));
        }
    }
}

/// A FieldDescriptorProto.
fn field(whole: &Type, field: &Field, out: &mut ProtoWriter) {
    const OPTIONAL: i64 = 1;
    const REPEATED: i64 = 3;
    let (number, type_name) = match field.value {
        Value::Double => (1, String::new()),
        Value::Int64 => (3, String::new()),
        Value::Int32 => (5, String::new()),
        Value::Fixed32 => (7, String::new()),
        Value::Bool => (8, String::new()),
        Value::Text => (9, String::new()),
        Value::Message(part) => (11, format!(".{}", part.full_name())),
        Value::Octets => (12, String::new()),
        Value::Enum(name, _) => (14, format!(".{}.{name}", whole.full_name())),
    };
    out.string(1, field.name);
    out.integer(3, i64::from(field.number));
    out.integer(4, if field.is_list { REPEATED } else { OPTIONAL });
    out.integer(5, number);
    out.string(6, &type_name);
}

/// An EnumDescriptorProto; the values are numbered from 0.
fn enumeration(name: &str, values: &[&str], out: &mut ProtoWriter) {
    out.string(1, name);
    for (number, value) in (0..).zip(values) {
        out.message(2, |out| {
            out.string(1, value);
            out.integer(2, number);
        });
    }
}
