//! Messages of ROS 2.
pub(super) mod definitions;
pub(super) mod qos;

use definitions::{Definition, MARKER_ARRAY, PATH, POINT_CLOUD, POSE_STAMPED, TF_MESSAGE};

use super::{
    cdr::CdrWriter,
    content::{Cloud, Color, Content, Drawing, Form, Scene, Sort, Transform, half_turn, seconds},
    file::SchemaText,
};
use crate::track::Pose;

/// The message encoding of every channel.
pub(super) const ENCODING: &str = "cdr";
/// The profile of a file that holds nothing else.
pub(super) const PROFILE: &str = "ros2";

/// Numbers of visualization_msgs/Marker.
mod marker {
    pub(super) const LINE_STRIP: i32 = 4;
    pub(super) const SPHERE_LIST: i32 = 7;
    pub(super) const ADD: i32 = 0;
    pub(super) const DELETE: i32 = 2;
}

/// The schema of a message type.
pub(super) fn schema(definition: &Definition) -> SchemaText {
    SchemaText { name: definition.full_name(), encoding: "ros2msg", data: definition.text().into_bytes() }
}

/// The message type of a sort of content.
pub(super) const fn definition(sort: Sort) -> &'static Definition {
    match sort {
        Sort::Transforms => &TF_MESSAGE,
        Sort::Pose => &POSE_STAMPED,
        Sort::Path => &PATH,
        Sort::Cloud => &POINT_CLOUD,
        Sort::Scene => &MARKER_ARRAY,
    }
}

/// Writes content as its message.
pub(super) fn write(content: &Content<'_>, out: &mut CdrWriter) {
    out.clear();
    match *content {
        Content::Transforms(transforms) => write_transforms(transforms, out),
        Content::Pose { t, frame, pose } => {
            header(t, frame, out);
            write_pose(pose, out);
        }
        Content::Path { t, frame, poses } => {
            header(t, frame, out);
            out.count(poses.len());
            for &(t, pose) in poses {
                header(t, frame, out);
                write_pose(pose, out);
            }
        }
        Content::Cloud(cloud) => write_cloud(&cloud, out),
        Content::Scene { frame, scene, groups } => {
            out.count(scene.drawings.len());
            for drawing in &scene.drawings {
                write_marker(frame, scene, drawing, &groups(drawing.group), out);
            }
        }
    }
}

/// Writes a std_msgs/Header. ROS holds times from 1901 to 2038: one beyond is written as the nearest of these.
pub(super) fn header(t: i64, frame: &str, out: &mut CdrWriter) {
    let (whole, nanoseconds) = seconds(t);
    match i32::try_from(whole) {
        Ok(whole) => {
            out.i32(whole);
            out.u32(nanoseconds);
        }
        Err(_) if whole < 0 => {
            out.i32(i32::MIN);
            out.u32(0);
        }
        Err(_) => {
            out.i32(i32::MAX);
            out.u32(999_999_999);
        }
    }
    out.string(frame);
}

/// Writes a geometry_msgs/Pose, or a Transform, which is laid out alike.
pub(super) fn write_pose(pose: Pose, out: &mut CdrWriter) {
    let (z, w) = half_turn(pose.yaw);
    for part in [pose.x, pose.y, 0.0, 0.0, 0.0, z, w] {
        out.f64(part);
    }
}

pub(super) fn write_transforms(transforms: &[Transform<'_>], out: &mut CdrWriter) {
    out.count(transforms.len());
    for transform in transforms {
        header(transform.t, transform.parent, out);
        out.string(transform.child);
        write_pose(transform.pose, out);
    }
}

fn write_cloud(cloud: &Cloud<'_>, out: &mut CdrWriter) {
    header(cloud.t, cloud.frame, out);
    let stride = cloud.layout.stride();
    let width = cloud.points.len() / stride.max(1);
    out.u32(1);
    out.count(width);
    out.count(cloud.layout.fields().len());
    for (name, offset, number) in cloud.layout.fields() {
        out.string(name);
        out.count(*offset);
        out.u8(number.in_point_field());
        out.u32(1);
    }
    out.bool(false);
    out.count(stride);
    out.count(cloud.points.len());
    out.octets(cloud.points);
    out.bool(true);
}

fn write_marker(frame: &str, scene: &Scene, drawing: &Drawing, group: &str, out: &mut CdrWriter) {
    header(drawing.t, frame, out);
    out.string(group);
    out.i32(i32::try_from(drawing.slot).unwrap_or(i32::MAX));
    let (kind, points) = match &drawing.form {
        Some(Form::Line(points)) => (marker::LINE_STRIP, points.clone()),
        Some(Form::Marks(points)) => (marker::SPHERE_LIST, points.clone()),
        None => (marker::LINE_STRIP, 0..0),
    };
    out.i32(kind);
    out.i32(if drawing.form.is_some() { marker::ADD } else { marker::DELETE });
    write_pose(Pose { x: 0.0, y: 0.0, yaw: 0.0 }, out);
    for size in [scene.width; 3] {
        out.f64(size);
    }
    write_color(scene.color, out);
    // Lifetime: until it is replaced. Not locked to its frame: where it was when it was drawn.
    out.i32(0);
    out.u32(0);
    out.bool(false);
    let points = scene.points.get(points).unwrap_or_default();
    out.count(points.len());
    for point in points {
        for part in [point.x, point.y, 0.0] {
            out.f64(part);
        }
    }
    write_nothing_else(out);
}

fn write_color(color: Color, out: &mut CdrWriter) {
    for part in [color.red, color.green, color.blue, color.alpha] {
        out.f32(f32::from(part) / 255.0);
    }
}

/// The rest of a Marker: colours by point, texture, text, mesh. There is none.
fn write_nothing_else(out: &mut CdrWriter) {
    out.count(0); // colors
    out.string(""); // texture_resource
    header(0, "", out); // texture
    out.string(""); // its format
    out.count(0); // its data
    out.count(0); // uv_coordinates
    out.string(""); // text
    out.string(""); // mesh_resource
    out.string(""); // mesh_file
    out.count(0); // its data
    out.bool(false); // mesh_use_embedded_materials
}
