//! The standard types that are read, down to the last field that is: up to there all releases of ROS agree
//! (github.com/ros2/common_interfaces).

use super::{definition::short, rosmsg::Version};

const RANGE: &str = "\
std_msgs/Header header
uint8 radiation_type
float32 field_of_view
float32 min_range
float32 max_range
float32 range
";
const TRANSFORMS: &str = "geometry_msgs/TransformStamped[] transforms\n";
const TRANSFORM: &str = "std_msgs/Header header\nstring child_frame_id\nTransform transform\n";
const ODOMETRY: &str = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n";
const SCAN: &str = "\
std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
";
const POSE: &str = "std_msgs/Header header\nPose pose\n";

/// The types within, each in its own place.
const PARTS: [(&str, &str); 7] = [
    ("geometry_msgs/TransformStamped", TRANSFORM),
    ("geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"),
    ("geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/Pose", "Point position\nQuaternion orientation\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
];
const HEADER: [(&str, &str); 2] = [
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
];
const ROS1_HEADER: [(&str, &str); 1] = [("std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n")];

/// The definition of a standard type.
///
/// # Errors
/// It is none of those that are read.
pub(super) fn definition(name: &str, version: Version) -> Result<String, String> {
    let own = match short(name).as_str() {
        "sensor_msgs/Range" => RANGE,
        "tf2_msgs/TFMessage" | "tf/tfMessage" => TRANSFORMS,
        "geometry_msgs/TransformStamped" => TRANSFORM,
        "nav_msgs/Odometry" => ODOMETRY,
        "geometry_msgs/PoseStamped" => POSE,
        "sensor_msgs/LaserScan" => SCAN,
        _ => return Err(format!("its schema is empty, and {name} is not known")),
    };
    let header: &[(&str, &str)] = match version {
        Version::One => &ROS1_HEADER,
        Version::Two => &HEADER,
    };
    let mut text = own.to_owned();
    for (name, fields) in PARTS.iter().chain(header) {
        text.push_str(&format!("===\nMSG: {name}\n{fields}"));
    }
    Ok(text)
}
