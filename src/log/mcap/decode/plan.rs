//! How to walk through the messages of one ROS type: a schema, with where the wanted values stand.

use super::{
    definition::{Base, Count, Definitions, Field, Scalar, short},
    said::{Found, Kind, MOST_VALUES, Said, Slot},
    wire::{Number, Wire},
};

/// Types within types, at most.
const DEEPEST: usize = 24;
/// Fields of a schema, those of the types within counted each time, at most.
const MOST: usize = 1 << 14;

/// One step on the way through a message.
#[derive(Debug)]
enum Node {
    Scalar(Scalar, Option<Slot>),
    Text(Option<Slot>),
    Struct(Vec<Node>),
    Fixed(Box<Node>, usize),
    List(Box<Node>),
    /// The list whose elements are read one by one.
    Each(Box<Node>),
    /// A list of numbers that are wanted.
    Values(Scalar),
    Opaque(String),
}

/// A way through the messages of one type.
#[derive(Debug)]
pub(super) struct Plan {
    kind: Kind,
    root: Node,
}

impl Plan {
    /// The way through the type `name`; the words are why there is none.
    pub(super) fn new(kind: Kind, name: &str, definitions: &Definitions) -> Result<Self, String> {
        let mut builder = Builder { kind, definitions, found: Found::default(), room: MOST };
        let mut root = builder.named(name, Some(""), 0)?;
        builder.found.check(kind)?;
        trim(&mut root);
        if let Some(what) = opaque(&root) {
            return Err(format!("it has {what} before a field that is needed"));
        }
        Ok(Self { kind, root })
    }

    /// Reads a message: calls `each` with what it says, once for each element where there is a list. The words are why it
    /// can't be read on.
    pub(super) fn read(
        &self,
        wire: &mut Wire<'_>,
        said: &mut Said,
        each: &mut dyn FnMut(&mut Said),
    ) -> Result<(), String> {
        said.clear();
        walk(&self.root, wire, said, each)?;
        if self.kind.list().is_none() {
            each(said);
        }
        Ok(())
    }
}

struct Builder<'a> {
    kind: Kind,
    definitions: &'a Definitions,
    found: Found,
    room: usize,
}

impl Builder<'_> {
    /// The way through a type; `path` is what leads to it, `None` where nothing of it is wanted.
    fn named(&mut self, name: &str, path: Option<&str>, depth: usize) -> Result<Node, String> {
        if depth > DEEPEST {
            return Err(format!("{name} holds types that hold types, without an end"));
        }
        let definitions = self.definitions;
        let fields = definitions.get(name).ok_or_else(|| format!("it does not say what {name} is"))?;
        let nodes: Result<Vec<Node>, String> = fields.iter().map(|field| self.field(field, path, depth)).collect();
        Ok(Node::Struct(nodes?))
    }

    fn field(&mut self, field: &Field, path: Option<&str>, depth: usize) -> Result<Node, String> {
        self.room = self.room.checked_sub(1).ok_or_else(|| format!("it has more than {MOST} fields"))?;
        let path = path.map(|path| if path.is_empty() { field.name.clone() } else { format!("{path}.{}", field.name) });
        let path = path.as_deref();
        let is_readings = matches!(&field.base, Base::Named(name) if short(name) == "sensor_msgs/Range");
        let listed = self.kind.list().filter(|(list, _)| {
            let is_it = if self.kind == Kind::Ranges { is_readings && depth == 0 } else { path == Some(list) };
            field.count == Count::Counted && is_it
        });
        if let (Base::Scalar(scalar @ (Scalar::F32 | Scalar::F64)), Count::Counted) = (&field.base, field.count)
            && path.and_then(|path| self.kind.slot(path)) == Some(Slot::Values)
        {
            self.found.add(Slot::Values);
            return Ok(Node::Values(*scalar));
        }
        let outer = self.kind;
        let inner = match (listed, field.count) {
            (Some((_, element)), _) => {
                self.kind = element;
                Some("")
            }
            (None, Count::One) => path,
            (None, _) => None,
        };
        let node = match &field.base {
            Base::Scalar(scalar) => {
                let slot = inner.and_then(|path| self.kind.slot(path)).filter(|slot| fits(*scalar, *slot));
                Node::Scalar(*scalar, self.note(slot))
            }
            Base::Text => {
                let slot = inner.and_then(|path| self.kind.slot(path));
                let slot = slot.filter(|slot| matches!(slot, Slot::Frame | Slot::Child));
                Node::Text(self.note(slot))
            }
            Base::Named(name) => self.named(name, inner, depth + 1)?,
            Base::Opaque(what) => Node::Opaque(what.clone()),
        };
        self.kind = outer;
        let many = field.count != Count::One;
        if many && matches!(&node, Node::Struct(fields) if fields.is_empty()) {
            return Err(format!("`{}` is a list of nothing", field.name));
        }
        Ok(match field.count {
            Count::One => node,
            Count::Fixed(size) => Node::Fixed(Box::new(node), size),
            Count::Counted if listed.is_some() => Node::Each(Box::new(node)),
            Count::Counted => Node::List(Box::new(node)),
        })
    }

    fn note(&mut self, slot: Option<Slot>) -> Option<Slot> {
        slot.inspect(|slot| self.found.add(*slot))
    }
}

/// Whether a value of the type can go there.
fn fits(scalar: Scalar, slot: Slot) -> bool {
    let real = matches!(scalar, Scalar::F32 | Scalar::F64);
    match slot {
        Slot::Stamp => scalar == Scalar::Time,
        Slot::Seconds | Slot::Nanoseconds => !real && scalar != Scalar::Time,
        Slot::Number(_) => real,
        Slot::Frame | Slot::Child | Slot::Values => false,
    }
}

fn is_wanted(node: &Node) -> bool {
    match node {
        Node::Scalar(_, slot) | Node::Text(slot) => slot.is_some(),
        Node::Struct(nodes) => nodes.iter().any(is_wanted),
        Node::Each(_) | Node::Values(_) => true,
        Node::Fixed(..) | Node::List(_) | Node::Opaque(_) => false,
    }
}

/// Leaves off what comes behind the last wanted value: releases differ there, and messages may end before it.
fn trim(node: &mut Node) {
    if let Node::Struct(nodes) = node {
        let last = nodes.iter().rposition(is_wanted).map_or(0, |last| last + 1);
        nodes.truncate(last);
        if let Some(last) = nodes.last_mut() {
            trim(last);
        }
    }
}

/// Something on the way that can't be passed over.
fn opaque(node: &Node) -> Option<&str> {
    match node {
        Node::Opaque(what) => Some(what),
        Node::Struct(nodes) => nodes.iter().find_map(opaque),
        Node::Fixed(node, _) | Node::List(node) | Node::Each(node) => opaque(node),
        Node::Scalar(..) | Node::Text(_) | Node::Values(_) => None,
    }
}

fn walk(node: &Node, wire: &mut Wire<'_>, said: &mut Said, each: &mut dyn FnMut(&mut Said)) -> Result<(), String> {
    match node {
        Node::Scalar(scalar, None) => wire.skip(*scalar, 1),
        Node::Scalar(scalar, Some(slot)) => {
            match (wire.number(*scalar)?, slot) {
                (Number::Real(value), slot) => said.set_number(*slot, value),
                (Number::Whole(value), slot) => said.set_whole(*slot, value),
                (Number::Time(seconds, nanoseconds), _) => {
                    said.set_whole(Slot::Seconds, seconds.into());
                    said.set_whole(Slot::Nanoseconds, nanoseconds.into());
                }
            }
            Ok(())
        }
        Node::Text(slot) => {
            let text = wire.text()?;
            if let Some(slot) = slot {
                let text = std::str::from_utf8(text).map_err(|_| "a frame's name is no UTF-8 text".to_owned())?;
                said.set_text(*slot, text);
            }
            Ok(())
        }
        Node::Struct(nodes) => nodes.iter().try_for_each(|node| walk(node, wire, said, each)),
        Node::Fixed(node, size) => repeat(node, *size, wire, said, each),
        Node::List(node) => {
            let count = wire.count()?;
            repeat(node, count, wire, said, each)
        }
        Node::Each(node) => {
            for _ in 0..wire.count()? {
                said.clear();
                walk(node, wire, said, each)?;
                each(said);
            }
            Ok(())
        }
        Node::Values(scalar) => {
            let count = wire.count()?;
            if count > MOST_VALUES {
                return Err(format!("it has {count} beams: more than {MOST_VALUES} are a lidar's, which are no cones"));
            }
            let mut values = [0.0; MOST_VALUES];
            for value in values.iter_mut().take(count) {
                if let Number::Real(real) = wire.number(*scalar)? {
                    *value = real;
                }
            }
            said.set_values(values.into_iter().take(count));
            Ok(())
        }
        Node::Opaque(what) => Err(format!("{what} can't be passed over")),
    }
}

fn repeat(
    node: &Node,
    count: usize,
    wire: &mut Wire<'_>,
    said: &mut Said,
    each: &mut dyn FnMut(&mut Said),
) -> Result<(), String> {
    match node {
        Node::Scalar(scalar, _) => wire.skip(*scalar, count),
        // Each takes a byte at least: a wrong count ends where the message does.
        _ => (0..count).try_for_each(|_| walk(node, wire, said, each)),
    }
}
