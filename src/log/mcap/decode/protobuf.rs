//! Messages in protobuf (protobuf.dev, "Encoding"), by the descriptor that their schema holds.

use std::collections::BTreeMap;

use super::said::{Found, Kind, Said, Slot};

/// Messages within messages whose fields are looked at, at most.
const DEEPEST: usize = 5;
/// Types of a schema, at most.
const MOST_TYPES: usize = 1 << 14;

/// The value of a field, as it is on the wire.
#[derive(Debug, Clone, Copy)]
pub(super) enum Value<'a> {
    Varint(u64),
    Eight([u8; 8]),
    Bytes(&'a [u8]),
    Four([u8; 4]),
}

/// The fields of a message, one after another; stops where they can't be read on.
pub(super) struct Fields<'a> {
    rest: &'a [u8],
    broken: bool,
}

impl<'a> Fields<'a> {
    pub(super) const fn new(rest: &'a [u8]) -> Self {
        Self { rest, broken: false }
    }

    /// Insists that all of the message was read; the words are where it can't be read on.
    pub(super) fn end(&self) -> Result<(), String> {
        if self.broken { Err(format!("it can't be read on {} bytes before its end", self.rest.len())) } else { Ok(()) }
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let (byte, rest) = self.rest.split_first()?;
            self.rest = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(bytes)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.first_chunk().copied()
    }

    fn field(&mut self) -> Option<(u64, Value<'a>)> {
        let tag = self.varint()?;
        let value = match tag & 7 {
            0 => Value::Varint(self.varint()?),
            1 => Value::Eight(self.array()?),
            2 => {
                let count = usize::try_from(self.varint()?).ok()?;
                Value::Bytes(self.bytes(count)?)
            }
            5 => Value::Four(self.array()?),
            _ => return None,
        };
        Some((tag >> 3, value))
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = (u64, Value<'a>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() || self.broken {
            return None;
        }
        let field = self.field();
        self.broken = field.is_none();
        field
    }
}

/// Types of fields (`FieldDescriptorProto.Type`).
mod kind {
    pub(super) const DOUBLE: u64 = 1;
    pub(super) const FLOAT: u64 = 2;
    pub(super) const STRING: u64 = 9;
    pub(super) const MESSAGE: u64 = 11;
    pub(super) const SINT32: u64 = 17;
    pub(super) const SINT64: u64 = 18;
}

/// A field as its descriptor has it.
#[derive(Debug, Clone, Default)]
struct Field {
    name: String,
    number: u64,
    repeated: bool,
    kind: u64,
    type_name: String,
}

/// The message types of a schema by their full names.
#[derive(Debug, Default)]
struct Types(BTreeMap<String, Vec<Field>>);

impl Types {
    /// Reads a `FileDescriptorSet`; `None` where it is none.
    fn read(set: &[u8]) -> Option<Self> {
        let mut types = Self::default();
        let mut files = Fields::new(set);
        for (number, value) in &mut files {
            if let (1, Value::Bytes(file)) = (number, value) {
                let (mut package, mut messages) = (String::new(), Vec::new());
                for (number, value) in Fields::new(file) {
                    match (number, value) {
                        (2, Value::Bytes(name)) => package = text(name),
                        (4, Value::Bytes(message)) => messages.push(message),
                        _ => {}
                    }
                }
                for message in messages {
                    types.add(&package, message, DEEPEST)?;
                }
            }
        }
        (!files.broken).then_some(types)
    }

    fn add(&mut self, scope: &str, message: &[u8], depth: usize) -> Option<()> {
        if depth == 0 || self.0.len() >= MOST_TYPES {
            return None;
        }
        let (mut name, mut fields, mut nested) = (String::new(), Vec::new(), Vec::new());
        for (number, value) in Fields::new(message) {
            match (number, value) {
                (1, Value::Bytes(bytes)) => name = text(bytes),
                (2, Value::Bytes(bytes)) => fields.push(field(bytes)),
                (3, Value::Bytes(bytes)) => nested.push(bytes),
                _ => {}
            }
        }
        let full = if scope.is_empty() { name } else { format!("{scope}.{name}") };
        for message in nested {
            self.add(&full, message, depth - 1)?;
        }
        self.0.insert(full, fields);
        Some(())
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn field(bytes: &[u8]) -> Field {
    let mut field = Field::default();
    for (number, value) in Fields::new(bytes) {
        match (number, value) {
            (1, Value::Bytes(name)) => field.name = text(name),
            (3, Value::Varint(number)) => field.number = number,
            (4, Value::Varint(label)) => field.repeated = label == 3,
            (5, Value::Varint(kind)) => field.kind = kind,
            (6, Value::Bytes(name)) => field.type_name = text(name).trim_start_matches('.').to_owned(),
            _ => {}
        }
    }
    field
}

/// What is read of a field.
#[derive(Debug)]
enum Node {
    Value(Slot, u64),
    Message(Message),
    Each(Message),
}

/// What is read of a message, by the numbers of its fields.
#[derive(Debug, Default)]
struct Message(BTreeMap<u64, Node>);

/// A way through the messages of one type.
#[derive(Debug)]
pub(super) struct Plan {
    kind: Kind,
    root: Message,
}

impl Plan {
    /// The way through the type `name` of a schema; the words are why there is none.
    pub(super) fn new(kind: Kind, name: &str, schema: &[u8]) -> Result<Self, String> {
        let types = Types::read(schema).ok_or("it is no descriptor of protobuf types")?;
        let mut found = Found::default();
        let root = message(kind, &types, name, "", DEEPEST, &mut found);
        found.check(kind)?;
        Ok(Self { kind, root })
    }

    /// Reads a message, as [`super::plan::Plan::read`] does.
    pub(super) fn read(&self, data: &[u8], said: &mut Said, each: &mut dyn FnMut(&mut Said)) -> Result<(), String> {
        said.clear();
        walk(&self.root, data, said, each)?;
        if self.kind.list().is_none() {
            each(said);
        }
        Ok(())
    }
}

fn message(kind: Kind, types: &Types, name: &str, path: &str, depth: usize, found: &mut Found) -> Message {
    let mut nodes = BTreeMap::new();
    for field in types.0.get(name).into_iter().flatten() {
        let path = if path.is_empty() { field.name.clone() } else { format!("{path}.{}", field.name) };
        let listed = kind.list().filter(|(list, _)| field.repeated && path == *list);
        let node = match (field.kind, listed) {
            (kind::MESSAGE, _) if depth == 0 => None,
            (kind::MESSAGE, Some((_, element))) => {
                Some(Node::Each(message(element, types, &field.type_name, "", depth - 1, found)))
            }
            (kind::MESSAGE, None) if !field.repeated => {
                let inner = message(kind, types, &field.type_name, &path, depth - 1, found);
                (!inner.0.is_empty()).then_some(Node::Message(inner))
            }
            (value, None) if !field.repeated => {
                let slot = kind.slot(&path).filter(|slot| fits(value, *slot));
                slot.inspect(|slot| found.add(*slot)).map(|slot| Node::Value(slot, value))
            }
            _ => None,
        };
        nodes.extend(node.map(|node| (field.number, node)));
    }
    Message(nodes)
}

/// Whether a value of the type can go there.
fn fits(value: u64, slot: Slot) -> bool {
    match slot {
        Slot::Frame | Slot::Child => value == kind::STRING,
        Slot::Number(_) => matches!(value, kind::DOUBLE | kind::FLOAT),
        // Neither bytes nor groups nor messages nor real numbers.
        Slot::Seconds | Slot::Nanoseconds => matches!(value, 3..=7 | 13 | 15..=18),
        Slot::Stamp | Slot::Values => false,
    }
}

fn walk(message: &Message, data: &[u8], said: &mut Said, each: &mut dyn FnMut(&mut Said)) -> Result<(), String> {
    let mut fields = Fields::new(data);
    for (number, value) in &mut fields {
        match (message.0.get(&number), value) {
            (Some(Node::Value(slot, kind)), value) => set(*slot, *kind, value, said)?,
            (Some(Node::Message(inner)), Value::Bytes(data)) => walk(inner, data, said, each)?,
            (Some(Node::Each(inner)), Value::Bytes(data)) => {
                said.clear();
                walk(inner, data, said, each)?;
                each(said);
            }
            _ => {}
        }
    }
    fields.end()
}

fn set(slot: Slot, kind: u64, value: Value<'_>, said: &mut Said) -> Result<(), String> {
    match value {
        Value::Eight(bytes) if kind == kind::DOUBLE => said.set_number(slot, f64::from_le_bytes(bytes)),
        Value::Four(bytes) if kind == kind::FLOAT => said.set_number(slot, f32::from_le_bytes(bytes).into()),
        Value::Eight(bytes) => said.set_whole(slot, i64::from_le_bytes(bytes)),
        Value::Four(bytes) => said.set_whole(slot, i32::from_le_bytes(bytes).into()),
        // "Zigzag": the sign is the lowest bit.
        Value::Varint(bits) if matches!(kind, kind::SINT32 | kind::SINT64) => {
            said.set_whole(slot, (bits >> 1) as i64 ^ -((bits & 1) as i64));
        }
        Value::Varint(bits) => said.set_whole(slot, bits as i64),
        Value::Bytes(bytes) => {
            let text = std::str::from_utf8(bytes).map_err(|_| "a frame's name is no UTF-8 text".to_owned())?;
            said.set_text(slot, text);
        }
    }
    Ok(())
}

/// Whether the type has the fields of a reading.
pub(super) fn is_range(name: &str, schema: &[u8]) -> bool {
    Types::read(schema).is_some_and(|types| {
        let fields = types.0.get(name).map(Vec::as_slice).unwrap_or_default();
        let has = |name: &str| fields.iter().any(|field| field.name == name);
        ["field_of_view", "min_range", "max_range", "range"].into_iter().all(has)
    })
}
