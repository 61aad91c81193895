//! Messages of Foxglove, in protobuf (docs.foxglove.dev, "Schemas"). Field numbers are those of [`types`].
mod descriptor;
mod types;

use types::{FRAME_TRANSFORMS, POINT_CLOUD, POSE_IN_FRAME, POSES_IN_FRAME, SCENE_UPDATE, Type};

use super::{
    content::{Cloud, Color, Content, Drawing, Form, Scene, Sort, half_turn, seconds},
    file::SchemaText,
    protobuf::ProtoWriter,
};
use crate::track::Pose;

/// The message encoding of every channel.
pub(super) const ENCODING: &str = "protobuf";

/// LinePrimitive's numbers for its kinds.
mod line {
    pub(super) const STRIP: i64 = 0;
    pub(super) const LIST: i64 = 2;
}

/// The message type of a sort of content.
pub(super) fn schema(sort: Sort) -> SchemaText {
    let root: &Type = match sort {
        Sort::Transforms => &FRAME_TRANSFORMS,
        Sort::Pose => &POSE_IN_FRAME,
        Sort::Path => &POSES_IN_FRAME,
        Sort::Cloud => &POINT_CLOUD,
        Sort::Scene => &SCENE_UPDATE,
    };
    SchemaText { name: root.full_name(), encoding: ENCODING, data: descriptor::set(root) }
}

/// Writes content as its message.
pub(super) fn write(content: &Content<'_>, out: &mut ProtoWriter) {
    out.clear();
    match *content {
        Content::Transforms(transforms) => {
            for transform in transforms {
                out.message(1, |out| {
                    timestamp(1, transform.t, out);
                    out.string(2, transform.parent);
                    out.string(3, transform.child);
                    write_place(transform.pose, (4, 5), out);
                });
            }
        }
        Content::Pose { t, frame, pose } => {
            timestamp(1, t, out);
            out.string(2, frame);
            out.message(3, |out| write_place(pose, (1, 2), out));
        }
        Content::Path { t, frame, poses } => {
            timestamp(1, t, out);
            out.string(2, frame);
            for &(_, pose) in poses {
                out.message(3, |out| write_place(pose, (1, 2), out));
            }
        }
        Content::Cloud(cloud) => write_cloud(&cloud, out),
        Content::Scene { frame, scene, groups } => write_scene(frame, scene, groups, out),
    }
}

fn timestamp(field: u32, t: i64, out: &mut ProtoWriter) {
    let (whole, nanoseconds) = seconds(t);
    out.message(field, |out| {
        out.integer(1, whole);
        out.integer(2, i64::from(nanoseconds));
    });
}

/// Writes position and orientation under their field numbers.
fn write_place(pose: Pose, (position, orientation): (u32, u32), out: &mut ProtoWriter) {
    out.message(position, |out| {
        out.double(1, pose.x);
        out.double(2, pose.y);
    });
    let (z, w) = half_turn(pose.yaw);
    out.message(orientation, |out| {
        out.double(3, z);
        out.double(4, w);
    });
}

fn write_cloud(cloud: &Cloud<'_>, out: &mut ProtoWriter) {
    timestamp(1, cloud.t, out);
    out.string(2, cloud.frame);
    out.message(3, |out| write_place(Pose { x: 0.0, y: 0.0, yaw: 0.0 }, (1, 2), out));
    let small = |size: usize| u32::try_from(size).unwrap_or(u32::MAX);
    out.fixed32(4, small(cloud.layout.stride()));
    for &(name, offset, number) in cloud.layout.fields() {
        out.message(5, |out| {
            out.string(1, name);
            out.fixed32(2, small(offset));
            out.integer(3, number.in_packed_element());
        });
    }
    out.octets(6, cloud.points);
}

fn write_scene(frame: &str, scene: &Scene, groups: &dyn Fn(u16) -> String, out: &mut ProtoWriter) {
    let id = |drawing: &Drawing| format!("{}/{}", groups(drawing.group), drawing.slot);
    for drawing in scene.drawings.iter().filter(|drawing| drawing.form.is_none()) {
        out.message(1, |out| {
            timestamp(1, drawing.t, out);
            out.string(3, &id(drawing));
        });
    }
    for drawing in &scene.drawings {
        let Some(form) = &drawing.form else { continue };
        out.message(2, |out| {
            timestamp(1, drawing.t, out);
            out.string(2, frame);
            out.string(3, &id(drawing));
            out.message(11, |out| write_line(scene, form, out));
        });
    }
}

/// Writes a LinePrimitive. There are no marks: a pair of short lines is the mark at a point.
fn write_line(scene: &Scene, form: &Form, out: &mut ProtoWriter) {
    let (kind, points) = match form {
        Form::Line(points) => (line::STRIP, points),
        Form::Marks(points) => (line::LIST, points),
    };
    let marks = matches!(form, Form::Marks(_));
    out.integer(1, kind);
    out.message(2, |out| write_place(Pose { x: 0.0, y: 0.0, yaw: 0.0 }, (1, 2), out));
    out.double(3, if marks { scene.width / 4.0 } else { scene.width });
    for point in scene.points.get(points.clone()).unwrap_or_default() {
        let half = scene.width / 2.0;
        let corners = [(-half, -half), (half, half), (-half, half), (half, -half)];
        for (dx, dy) in if marks { &corners[..] } else { &[(0.0, 0.0)] } {
            out.message(5, |out| {
                out.double(1, point.x + dx);
                out.double(2, point.y + dy);
            });
        }
    }
    out.message(6, |out| write_color(scene.color, out));
}

fn write_color(color: Color, out: &mut ProtoWriter) {
    for (field, part) in (1..).zip([color.red, color.green, color.blue, color.alpha]) {
        out.double(field, f64::from(part) / 255.0);
    }
}
