//! Types as ROS describes them, from whichever language.

use std::collections::BTreeMap;

/// A number's type, or a time in ROS 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
    /// Seconds and nanoseconds, `uint32` both (ROS 1).
    Time,
}

impl Scalar {
    /// Bytes of one, each of the two of a time.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 | Self::Time => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// What a field is, without how many.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Base {
    Scalar(Scalar),
    Text,
    /// Another type, by its full name `package/Name`.
    Named(String),
    /// Something that can't be passed over.
    Opaque(String),
}

/// How many there are of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    /// As many as a count before them says.
    Counted,
}

/// A field of a type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) base: Base,
    pub(super) count: Count,
}

/// All types that a schema describes, by their full names `package/Name`.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Definitions(pub(super) BTreeMap<String, Vec<Field>>);

impl Definitions {
    /// The fields of a type, by its full name or, where that is all there is, its last part.
    pub(super) fn get(&self, name: &str) -> Option<&[Field]> {
        let full = short(name);
        self.0.get(&full).map(Vec::as_slice)
    }
}

/// `package/Name` of `package/msg/Name`, `package::msg::Name` or `package::msg::dds_::Name_`.
pub(super) fn short(name: &str) -> String {
    let name = name.replace("::", "/");
    let parts: Vec<&str> = name.split('/').filter(|part| !part.is_empty()).collect();
    match parts[..] {
        [package, "msg", "dds_", name] => format!("{package}/{}", name.strip_suffix('_').unwrap_or(name)),
        [package, "msg", name] | [package, name] => format!("{package}/{name}"),
        _ => name,
    }
}
