//! ROS 2 message definitions, as recordings carry them (`ros2msg`): the type's own fields, then those of each type it is made of.

/// A message type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Definition {
    package: &'static str,
    name: &'static str,
    fields: &'static str,
    /// Every type that is used in it, directly or not.
    parts: &'static [&'static Definition],
}

/// What separates the definitions of the parts.
const RULE: &str = "================================================================================\n";

impl Definition {
    /// The type's full name, `sensor_msgs/msg/Range`.
    pub(crate) fn full_name(&self) -> String {
        format!("{}/msg/{}", self.package, self.name)
    }

    /// The definition with its parts.
    pub(crate) fn text(&self) -> String {
        let parts = self.parts.iter().map(|part| {
            let Definition { package, name, fields, .. } = part;
            format!("{RULE}MSG: {package}/{name}\n{fields}")
        });
        std::iter::once(self.fields.to_owned()).chain(parts).collect()
    }
}

const fn part(package: &'static str, name: &'static str, fields: &'static str) -> Definition {
    Definition { package, name, fields, parts: &[] }
}

const TIME: Definition = part("builtin_interfaces", "Time", "int32 sec\nuint32 nanosec\n");
const DURATION: Definition = part("builtin_interfaces", "Duration", "int32 sec\nuint32 nanosec\n");
const HEADER: Definition = part("std_msgs", "Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const COLOR: Definition = part("std_msgs", "ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n");
const VECTOR: Definition = part("geometry_msgs", "Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
const POINT: Definition = part("geometry_msgs", "Point", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: Definition = part("geometry_msgs", "Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
const POSE: Definition =
    part("geometry_msgs", "Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const TRANSFORM: Definition =
    part("geometry_msgs", "Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n");
const TRANSFORM_STAMPED: Definition = part(
    "geometry_msgs",
    "TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
);
const POINT_FIELD: Definition = part(
    "sensor_msgs",
    "PointField",
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
     uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
);
const COMPRESSED_IMAGE: Definition =
    part("sensor_msgs", "CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n");
const UV_COORDINATE: Definition = part("visualization_msgs", "UVCoordinate", "float32 u\nfloat32 v\n");
const MESH_FILE: Definition = part("visualization_msgs", "MeshFile", "string filename\nuint8[] data\n");
/// As since Humble.
const MARKER: Definition = part(
    "visualization_msgs",
    "Marker",
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\n\
     int32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\n\
     int32 TRIANGLE_LIST=11\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\n\
     std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n\
     geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\n\
     geometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n\
     sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n\
     string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
);

pub(crate) const POSE_STAMPED: Definition = Definition {
    package: "geometry_msgs",
    name: "PoseStamped",
    fields: "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    parts: &[&HEADER, &TIME, &POSE, &POINT, &QUATERNION],
};
pub(crate) const PATH: Definition = Definition {
    package: "nav_msgs",
    name: "Path",
    fields: "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    parts: &[&HEADER, &TIME, &POSE_STAMPED, &POSE, &POINT, &QUATERNION],
};
pub(crate) const TF_MESSAGE: Definition = Definition {
    package: "tf2_msgs",
    name: "TFMessage",
    fields: "geometry_msgs/TransformStamped[] transforms\n",
    parts: &[&TRANSFORM_STAMPED, &HEADER, &TIME, &TRANSFORM, &VECTOR, &QUATERNION],
};
pub(crate) const POINT_CLOUD: Definition = Definition {
    package: "sensor_msgs",
    name: "PointCloud2",
    fields: "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n\
             uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
    parts: &[&HEADER, &TIME, &POINT_FIELD],
};
pub(crate) const MARKER_ARRAY: Definition = Definition {
    package: "visualization_msgs",
    name: "MarkerArray",
    fields: "visualization_msgs/Marker[] markers\n",
    parts: &[
        &MARKER,
        &HEADER,
        &TIME,
        &POSE,
        &POINT,
        &QUATERNION,
        &VECTOR,
        &COLOR,
        &DURATION,
        &COMPRESSED_IMAGE,
        &UV_COORDINATE,
        &MESH_FILE,
    ],
};
/// As since Iron, which added the variance.
pub(crate) const RANGE: Definition = Definition {
    package: "sensor_msgs",
    name: "Range",
    fields: "uint8 ULTRASOUND=0\nuint8 INFRARED=1\nstd_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\n\
             float32 min_range\nfloat32 max_range\nfloat32 range\nfloat32 variance\n",
    parts: &[&HEADER, &TIME],
};
