//! The message types of Foxglove that are written, and all they are made of: names and numbers of their fields.

/// A field's type.
#[derive(Debug, Clone, Copy)]
pub(super) enum Value {
    Double,
    Int64,
    Int32,
    Fixed32,
    Bool,
    Text,
    Octets,
    /// One of the enumeration's names, by number.
    Enum(&'static str, &'static [&'static str]),
    Message(&'static Type),
}

/// A field: number, name, type, and whether it is a list.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field {
    pub(super) number: i32,
    pub(super) name: &'static str,
    pub(super) value: Value,
    pub(super) is_list: bool,
}

/// A message type; it sits in a file of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Type {
    pub(super) package: &'static str,
    pub(super) name: &'static str,
    pub(super) file: &'static str,
    pub(super) fields: &'static [Field],
}

impl Type {
    pub(super) fn full_name(&self) -> String {
        format!("{}.{}", self.package, self.name)
    }
}

const fn one(number: i32, name: &'static str, value: Value) -> Field {
    Field { number, name, value, is_list: false }
}

const fn list(number: i32, name: &'static str, value: Value) -> Field {
    Field { number, name, value, is_list: true }
}

macro_rules! foxglove {
    ($(#[$about:meta])* $visibility:vis $constant:ident = $name:literal [$($field:expr),* $(,)?]) => {
        $(#[$about])*
        $visibility static $constant: Type = Type {
            package: "foxglove",
            name: $name,
            file: concat!("foxglove/", $name, ".proto"),
            fields: &[$($field),*],
        };
    };
}

use Value::{Bool, Double, Enum, Fixed32, Int32, Int64, Message, Octets, Text};

static TIMESTAMP: Type = Type {
    package: "google.protobuf",
    name: "Timestamp",
    file: "google/protobuf/timestamp.proto",
    fields: &[one(1, "seconds", Int64), one(2, "nanos", Int32)],
};
static DURATION: Type = Type {
    package: "google.protobuf",
    name: "Duration",
    file: "google/protobuf/duration.proto",
    fields: &[one(1, "seconds", Int64), one(2, "nanos", Int32)],
};

foxglove!(VECTOR = "Vector3" [one(1, "x", Double), one(2, "y", Double), one(3, "z", Double)]);
foxglove!(POINT = "Point3" [one(1, "x", Double), one(2, "y", Double), one(3, "z", Double)]);
foxglove!(QUATERNION = "Quaternion" [one(1, "x", Double), one(2, "y", Double), one(3, "z", Double), one(4, "w", Double)]);
foxglove!(COLOR = "Color" [one(1, "r", Double), one(2, "g", Double), one(3, "b", Double), one(4, "a", Double)]);
foxglove!(POSE = "Pose" [one(1, "position", Message(&VECTOR)), one(2, "orientation", Message(&QUATERNION))]);
foxglove!(KEY_VALUE = "KeyValuePair" [one(1, "key", Text), one(2, "value", Text)]);

foxglove!(PACKED_ELEMENT = "PackedElementField" [
    one(1, "name", Text),
    one(2, "offset", Fixed32),
    one(3, "type", Enum("NumericType", &[
        "UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64",
    ])),
]);
foxglove!(pub(super) POINT_CLOUD = "PointCloud" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "frame_id", Text),
    one(3, "pose", Message(&POSE)),
    one(4, "point_stride", Fixed32),
    list(5, "fields", Message(&PACKED_ELEMENT)),
    one(6, "data", Octets),
]);

foxglove!(FRAME_TRANSFORM = "FrameTransform" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "parent_frame_id", Text),
    one(3, "child_frame_id", Text),
    one(4, "translation", Message(&VECTOR)),
    one(5, "rotation", Message(&QUATERNION)),
]);
foxglove!(pub(super) FRAME_TRANSFORMS = "FrameTransforms" [list(1, "transforms", Message(&FRAME_TRANSFORM))]);
foxglove!(pub(super) POSE_IN_FRAME = "PoseInFrame" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "frame_id", Text),
    one(3, "pose", Message(&POSE)),
]);
foxglove!(pub(super) POSES_IN_FRAME = "PosesInFrame" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "frame_id", Text),
    list(3, "poses", Message(&POSE)),
]);

foxglove!(ARROW = "ArrowPrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "shaft_length", Double),
    one(3, "shaft_diameter", Double),
    one(4, "head_length", Double),
    one(5, "head_diameter", Double),
    one(6, "color", Message(&COLOR)),
]);
foxglove!(CUBE = "CubePrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "size", Message(&VECTOR)),
    one(3, "color", Message(&COLOR)),
]);
foxglove!(SPHERE = "SpherePrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "size", Message(&VECTOR)),
    one(3, "color", Message(&COLOR)),
]);
foxglove!(CYLINDER = "CylinderPrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "size", Message(&VECTOR)),
    one(3, "bottom_scale", Double),
    one(4, "top_scale", Double),
    one(5, "color", Message(&COLOR)),
]);
foxglove!(LINE = "LinePrimitive" [
    one(1, "type", Enum("Type", &["LINE_STRIP", "LINE_LOOP", "LINE_LIST"])),
    one(2, "pose", Message(&POSE)),
    one(3, "thickness", Double),
    one(4, "scale_invariant", Bool),
    list(5, "points", Message(&POINT)),
    one(6, "color", Message(&COLOR)),
    list(7, "colors", Message(&COLOR)),
    list(8, "indices", Fixed32),
]);
foxglove!(TRIANGLES = "TriangleListPrimitive" [
    one(1, "pose", Message(&POSE)),
    list(2, "points", Message(&POINT)),
    one(3, "color", Message(&COLOR)),
    list(4, "colors", Message(&COLOR)),
    list(5, "indices", Fixed32),
]);
foxglove!(TEXT = "TextPrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "billboard", Bool),
    one(3, "font_size", Double),
    one(4, "scale_invariant", Bool),
    one(5, "color", Message(&COLOR)),
    one(6, "text", Text),
]);
foxglove!(MODEL = "ModelPrimitive" [
    one(1, "pose", Message(&POSE)),
    one(2, "scale", Message(&VECTOR)),
    one(3, "color", Message(&COLOR)),
    one(4, "override_color", Bool),
    one(5, "url", Text),
    one(6, "media_type", Text),
    one(7, "data", Octets),
]);

foxglove!(
    /// With all its primitives: viewers look into each list, used or not.
    SCENE_ENTITY = "SceneEntity" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "frame_id", Text),
    one(3, "id", Text),
    one(4, "lifetime", Message(&DURATION)),
    one(5, "frame_locked", Bool),
    list(6, "metadata", Message(&KEY_VALUE)),
    list(7, "arrows", Message(&ARROW)),
    list(8, "cubes", Message(&CUBE)),
    list(9, "spheres", Message(&SPHERE)),
    list(10, "cylinders", Message(&CYLINDER)),
    list(11, "lines", Message(&LINE)),
    list(12, "triangles", Message(&TRIANGLES)),
    list(13, "texts", Message(&TEXT)),
    list(14, "models", Message(&MODEL)),
]);
foxglove!(SCENE_DELETION = "SceneEntityDeletion" [
    one(1, "timestamp", Message(&TIMESTAMP)),
    one(2, "type", Enum("Type", &["MATCHING_ID", "ALL"])),
    one(3, "id", Text),
]);
foxglove!(pub(super) SCENE_UPDATE = "SceneUpdate" [
    list(1, "deletions", Message(&SCENE_DELETION)),
    list(2, "entities", Message(&SCENE_ENTITY)),
]);
