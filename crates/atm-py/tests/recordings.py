"""Recordings made by other people's code (`rosbags`, `mcap`), and the same readings as a table.

A drive is a robot with four range sensors on a circle through a world of five poles. Every variant of a recording holds the
same readings; the table has them with the robot's pose at each, interpolated here.
"""

from __future__ import annotations

import io
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.writer import CompressionType, IndexType, Writer
from mcap_protobuf.schema import build_file_descriptor_set
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
"""Exact in float32, so that a table and a message mean the same."""
FIELD_OF_VIEW, MIN_RANGE, MAX_RANGE = 1.0, 0.125, 8.0
TILT = math.radians(5)


@dataclass(frozen=True)
class Mount:
    """Where a sensor is on the robot: x, y, yaw, and how far its boresight points down."""

    x: float
    y: float
    yaw: float
    pitch: float = 0.0

    def quaternion(self) -> tuple[float, float, float, float]:
        """x, y, z, w of a turn by yaw, then by pitch."""
        (sy, cy), (sp, cp) = ((math.sin(a / 2), math.cos(a / 2)) for a in (self.yaw, self.pitch))
        return (-sy * sp, cy * sp, sy * cp, cy * cp)


MOUNTS = {
    "front": Mount(0.3, 0.0, 0.0),
    "left": Mount(0.1, 0.2, math.pi / 2),
    "right": Mount(0.1, -0.2, -math.pi / 2),
    "low": Mount(0.25, 0.1, 0.4, TILT),
}
POLES = [(0.0, 0.0), (2.5, 1.0), (-1.0, 2.6), (-2.5, -1.0), (1.0, -2.6)]

RIG = "name = 'fixture'\nmin_range = 0.125\nmax_range = 8.0\nfield_of_view = '1rad'\n" + "".join(
    f"[[sensor]]\nid = '{name}'\nx = {mount.x!r}\ny = {mount.y!r}\nyaw = '{mount.yaw!r}rad'\n"
    for name, mount in MOUNTS.items()
)


def path(t: int) -> tuple[float, float, float]:
    """Position and heading of the robot; the heading passes half a turn."""
    s = (t - START) / SECOND
    return 1.4 * math.cos(0.5 * s), 1.4 * math.sin(0.5 * s), 2.6 + 0.9 * s


@dataclass(frozen=True)
class Reading:
    t: int
    log: int
    sensor: str
    range: float


@dataclass
class Drive:
    """Readings, and when the robot's pose is said."""

    readings: list[Reading] = field(default_factory=list)
    poses: list[int] = field(default_factory=list)

    @staticmethod
    def of(seconds: float = 12.0) -> Drive:
        drive = Drive(poses=[START + k * SECOND // 20 for k in range(int(seconds * 20) + 1)])
        for k in range(int(seconds * 40)):
            t = START + k * SECOND // 40 + 7_654_321
            if t >= drive.poses[-1]:
                break
            sensor = list(MOUNTS)[k % len(MOUNTS)]
            drive.readings.append(Reading(t, t + 3_000_000, sensor, measure(t, sensor)))
        return drive

    def pose(self, t: int) -> tuple[float, float, float]:
        """The pose between the two that are said."""
        after = next(i for i, at in enumerate(self.poses) if at >= t)
        if self.poses[after] == t:
            return path(t)
        (x0, y0, a0), (x1, y1, a1) = path(self.poses[after - 1]), path(self.poses[after])
        share = (t - self.poses[after - 1]) / (self.poses[after] - self.poses[after - 1])
        turn = (a1 - a0 + math.pi) % (2 * math.pi) - math.pi
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0), a0 + share * turn

    def table(self) -> str:
        """The readings as a long table; those of a tilted sensor as seen from above."""
        rows = ["t,sensor,range,x,y,yaw"]
        for r in self.readings:
            x, y, yaw = self.pose(r.t)
            flat = r.range * math.cos(MOUNTS[r.sensor].pitch)
            rows.append(f"{r.t // SECOND}.{r.t % SECOND:09},{r.sensor},{flat!r},{x!r},{y!r},{yaw!r}")
        return "\n".join(rows) + "\n"


def measure(t: int, sensor: str) -> float:
    """The nearest pole in the beam, as a float32; +Inf where there is none."""
    (x, y, yaw), mount = path(t), MOUNTS[sensor]
    sx, sy = x + mount.x * math.cos(yaw) - mount.y * math.sin(yaw), y + mount.x * math.sin(yaw) + mount.y * math.cos(yaw)
    seen = [math.inf]
    for px, py in POLES:
        bearing = math.atan2(py - sy, px - sx) - yaw - mount.yaw
        if abs((bearing + math.pi) % (2 * math.pi) - math.pi) <= 0.45:
            seen.append(math.hypot(px - sx, py - sy))
    return float(np.float32(min(seen)))


def stamp(t: int) -> dict[str, int]:
    return {"sec": t // SECOND, "nanosec": t % SECOND}


def quaternion(yaw: float) -> dict[str, float]:
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


@dataclass(frozen=True)
class Said:
    """One message before it is encoded: ROS fields as nested dictionaries."""

    topic: str
    type: str
    log: int
    fields: dict[str, Any]


def header(t: int, frame: str) -> dict[str, Any]:
    return {"stamp": stamp(t), "frame_id": frame}


def transform(t: int, parent: str, child: str, xyz: tuple[float, float, float], q: dict[str, float]) -> dict[str, Any]:
    translation = dict(zip("xyz", xyz))
    return {
        "header": header(t, parent),
        "child_frame_id": child,
        "transform": {"translation": translation, "rotation": q},
    }


def static_transforms(drive: Drive) -> list[Said]:
    t = drive.poses[0]
    mounts = [
        transform(t, "base_link", name, (m.x, m.y, 0.1), dict(zip("xyzw", m.quaternion()))) for name, m in MOUNTS.items()
    ]
    return [Said("/tf_static", "tf2_msgs/msg/TFMessage", t - 1, {"transforms": mounts})]


def moving_transforms(drive: Drive) -> list[Said]:
    said = []
    for t in drive.poses:
        x, y, yaw = path(t)
        tf = transform(t, "odom", "base_link", (x, y, 0.0), quaternion(yaw))
        # What jumps must not matter.
        jump = transform(t, "map", "odom", (math.floor(t / SECOND) % 3, 0.0, 0.0), quaternion(0.1))
        said.append(Said("/tf", "tf2_msgs/msg/TFMessage", t + 2_000_000, {"transforms": [tf, jump]}))
    return said


def pose_of(t: int) -> dict[str, Any]:
    x, y, yaw = path(t)
    return {"position": {"x": x, "y": y, "z": 0.0}, "orientation": quaternion(yaw)}


def odometry(drive: Drive) -> list[Said]:
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    return [
        Said(
            "/odom",
            "nav_msgs/msg/Odometry",
            t + 1_000_000,
            {
                "header": header(t, "odom"),
                "child_frame_id": "base_link",
                "pose": {"pose": pose_of(t), "covariance": [0.0] * 36},
                "twist": {"twist": {"linear": zero, "angular": zero}, "covariance": [0.0] * 36},
            },
        )
        for t in drive.poses
    ]


def stamped_poses(drive: Drive) -> list[Said]:
    return [
        Said("/pose", "geometry_msgs/msg/PoseStamped", t + 1_000_000, {"header": header(t, "odom"), "pose": pose_of(t)})
        for t in drive.poses
    ]


def ranges(drive: Drive) -> list[Said]:
    return [
        Said(
            f"/range/{r.sensor}",
            "sensor_msgs/msg/Range",
            r.log,
            {
                "header": header(r.t, r.sensor),
                "radiation_type": 0,
                "field_of_view": FIELD_OF_VIEW,
                "min_range": MIN_RANGE,
                "max_range": MAX_RANGE,
                "range": r.range,
                "variance": 0.0,
            },
        )
        for r in drive.readings
    ]


def images(drive: Drive, size: int, every: int = 1) -> list[Said]:
    """Large messages that nobody asks for."""
    return [
        Said("/camera", "std_msgs/msg/String", t, {"data": "x" * size}) for t in drive.poses[::every]
    ]


def in_order(*groups: list[Said]) -> list[Said]:
    return sorted((said for group in groups for said in group), key=lambda said: said.log)


def usual(drive: Drive) -> list[Said]:
    """A drive as ROS 2 records it."""
    return in_order(static_transforms(drive), moving_transforms(drive), ranges(drive))


class Ros:
    """Encodes with `rosbags`."""

    def __init__(self, store: Stores, *, big_endian: bool = False, idl: dict[str, str] | None = None) -> None:
        self.store = get_typestore(store)
        self.version = 1 if store is Stores.ROS1_NOETIC else 2
        if self.version == 1:
            text = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))
        self.big_endian = big_endian
        self.idl = idl

    @property
    def encoding(self) -> str:
        return "cdr" if self.version == 2 else "ros1"

    def schema(self, type_: str) -> tuple[str, str, bytes]:
        if self.idl is not None:
            return type_, "ros2idl", self.idl[type_].encode()
        text, _ = self.store.generate_msgdef(type_, ros_version=self.version)
        name = type_ if self.version == 2 else type_.replace("/msg/", "/")
        return name, f"ros{self.version}msg", text.encode()

    def build(self, type_: str, fields: dict[str, Any]) -> object:
        defined = self.store.get_msgdef(type_).fields
        values = {}
        for name, (kind, detail) in defined:
            # Of ROS 1 alone.
            value = 0 if name == "seq" else fields[name]
            values[name] = self.value(kind, detail, value)
        return self.store.types[type_](**values)

    def value(self, kind: object, detail: Any, value: Any) -> object:
        kind = int(kind)
        if kind == 2:
            return self.build(detail, value)
        if kind in (3, 4):
            inner, inner_detail = detail[0]
            if int(inner) == 2:
                return [self.build(inner_detail, item) for item in value]
            return np.array(value, dtype=inner_detail[0])
        return value

    def message(self, said: Said) -> bytes:
        message = self.build(said.type, said.fields)
        if self.version == 1:
            return bytes(self.store.serialize_ros1(message, said.type))
        return bytes(self.store.serialize_cdr(message, said.type, little_endian=not self.big_endian))


class Json:
    """The same fields as JSON; what is infinite in words."""

    encoding = "json"

    def schema(self, type_: str) -> tuple[str, str, bytes]:
        names = {"sensor_msgs/msg/Range": ["field_of_view", "min_range", "max_range", "range"]}.get(type_, [])
        schema = {"type": "object", "properties": {name: {"type": "number"} for name in names}}
        name = "example.Sonar" if names else type_
        return name, "jsonschema", json.dumps(schema).encode()

    def message(self, said: Said) -> bytes:
        fields = dict(said.fields)
        if math.isinf(fields.get("range", 0)):
            fields["range"] = "Infinity"
        return json.dumps(fields).encode()


def sonar_class() -> Any:
    """A message type of somebody's own that has the fields of a reading."""
    kinds = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(name="sonar.proto", package="example", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    message = file.message_type.add(name="Sonar")
    once = kinds.LABEL_OPTIONAL
    message.field.add(
        name="timestamp", number=9, type=kinds.TYPE_MESSAGE, label=once, type_name=".google.protobuf.Timestamp"
    )
    message.field.add(name="frame_id", number=2, type=kinds.TYPE_STRING, label=once)
    for number, name in enumerate(["field_of_view", "min_range", "max_range"], 3):
        message.field.add(name=name, number=number, type=kinds.TYPE_FLOAT, label=once)
    message.field.add(name="range", number=6, type=kinds.TYPE_DOUBLE, label=once)
    pool = descriptor_pool.Default()
    try:
        descriptor = pool.FindMessageTypeByName("example.Sonar")
    except KeyError:
        pool.Add(file)
        descriptor = pool.FindMessageTypeByName("example.Sonar")
    return message_factory.GetMessageClass(descriptor)


class Protobuf:
    """Foxglove's own transforms, and somebody's readings."""

    encoding = "protobuf"

    def __init__(self) -> None:
        from foxglove_schemas_protobuf import FrameTransforms_pb2

        self.transforms = FrameTransforms_pb2.FrameTransforms
        self.sonar = sonar_class()

    def of(self, type_: str) -> Any:
        return self.sonar if type_.endswith("Range") else self.transforms

    def schema(self, type_: str) -> tuple[str, str, bytes]:
        cls = self.of(type_)
        return cls.DESCRIPTOR.full_name, "protobuf", build_file_descriptor_set(cls).SerializeToString()

    def message(self, said: Said) -> bytes:
        cls, fields = self.of(said.type), said.fields
        if cls is self.sonar:
            message = cls(frame_id=fields["header"]["frame_id"])
            for name in ("field_of_view", "min_range", "max_range", "range"):
                setattr(message, name, fields[name])
            put(message.timestamp, fields["header"]["stamp"])
            return bytes(message.SerializeToString())
        message = cls()
        for tf in fields["transforms"]:
            one = message.transforms.add(
                parent_frame_id=tf["header"]["frame_id"],
                child_frame_id=tf["child_frame_id"],
            )
            put(one.timestamp, tf["header"]["stamp"])
            for part in ("translation", "rotation"):
                for axis, value in tf["transform"][part].items():
                    setattr(getattr(one, part), axis, value)
        return bytes(message.SerializeToString())


def put(timestamp: Any, at: dict[str, int]) -> None:
    timestamp.seconds, timestamp.nanos = at["sec"], at["nanosec"]


def record(said: list[Said], encoder: Any, **options: Any) -> bytes:
    """A recording, written by `mcap`."""
    file = io.BytesIO()
    writer = Writer(file, **{"chunk_size": 16 * 1024, **options})
    writer.start("ros2" if encoder.encoding == "cdr" else "", "fixture")
    schemas: dict[str, int] = {}
    channels: dict[str, int] = {}
    for number, message in enumerate(said):
        if message.type not in schemas:
            name, encoding, data = encoder.schema(message.type)
            schemas[message.type] = writer.register_schema(name, encoding, data)
        if message.topic not in channels:
            channels[message.topic] = writer.register_channel(message.topic, encoder.encoding, schemas[message.type])
        data = encoder.message(message)
        writer.add_message(channels[message.topic], message.log, data, message.log - 1000, number)
    writer.finish()
    return file.getvalue()


BARE = {"use_chunking": False, "index_types": IndexType.NONE, "repeat_channels": False, "repeat_schemas": False}
"""As `fastwrite` does it: no chunks, no summary."""
PLAIN = {"compression": CompressionType.NONE}
LZ4 = {"compression": CompressionType.LZ4}
ZSTD = {"compression": CompressionType.ZSTD}


def write(path: Path, said: list[Said], encoder: Any, **options: Any) -> Path:
    path.write_bytes(record(said, encoder, **options))
    return path
