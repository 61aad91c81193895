"""Recordings that are written, read by other people's code: ``mcap`` with its decoders for ROS 2 and protobuf, ``rosbags``."""

from __future__ import annotations

import csv
import math
import subprocess
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import foxglove_schemas_protobuf
import numpy as np
import pytest
from google.protobuf import descriptor_pb2
from google.protobuf.descriptor import FieldDescriptor
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoder
from mcap_ros2.decoder import DecoderFactory as Ros2Decoder
from recordings import BARE, LZ4, PLAIN
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

Command = Callable[..., subprocess.CompletedProcess[str]]
SCHEMAS = ("foxglove", "ros2")
SECOND = 1_000_000_000
KINDS = ("median", "single", "center", "near", "pair")
TYPES = {2: "u1", 4: "<u2", 6: "<u4", 7: "<f4", 8: "<f8"}
"""numpy's name for each type of sensor_msgs/PointField that is used."""


class Recording:
    """One file, all of it decoded and every checksum compared."""

    def __init__(self, path: Path) -> None:
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[Ros2Decoder(), ProtobufDecoder()])
            self.header = reader.get_header()
            summary = reader.get_summary()
            assert summary is not None and summary.statistics is not None
            self.summary = summary
            self.metadata = {record.name: record.metadata for record in reader.iter_metadata()}
            self.messages = [(channel, schema, message, decoded) for schema, channel, message, decoded in
                             reader.iter_decoded_messages(log_time_order=False)]

    def of(self, topic: str) -> list[Any]:
        """The decoded messages of a topic."""
        return [decoded for channel, _, _, decoded in self.messages if channel.topic == topic]


@pytest.fixture(scope="module", params=SCHEMAS)
def recording(request: pytest.FixtureRequest, root: Path, command: Command, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """The sample, fused into a recording of either kind of messages."""
    path = tmp_path_factory.mktemp("written") / "echoes.mcap"
    command("fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", path, "--schema", request.param)
    return Recording(path)


@pytest.fixture(scope="module")
def tables(root: Path, command: Command, tmp_path_factory: pytest.TempPathFactory) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """The same as tables: echoes and crossings."""
    folder = tmp_path_factory.mktemp("tables")
    names = [folder / "echoes.csv", folder / "crossings.csv"]
    command("fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", names[0], "--crossings", names[1])
    with names[0].open() as echoes, names[1].open() as crossings:
        return list(csv.DictReader(echoes)), list(csv.DictReader(crossings))


def stamp(time: Any) -> int:
    """Nanoseconds of a ROS or protobuf time."""
    return int(time.sec * SECOND + time.nanosec) if hasattr(time, "sec") else int(time.seconds * SECOND + time.nanos)


def cloud(message: Any) -> tuple[int, str, np.ndarray]:
    """A cloud's stamp, frame and points."""
    if hasattr(message, "header"):
        fields = [(field.name, TYPES[field.datatype], field.offset) for field in message.fields]
        at, frame, stride = stamp(message.header.stamp), message.header.frame_id, message.point_step
        assert (message.height, message.is_bigendian, message.is_dense) == (1, False, True)
        assert message.width * stride == message.row_step == len(message.data)
    else:
        from_packed = {1: 2, 3: 4, 5: 6, 7: 7, 8: 8}
        fields = [(field.name, TYPES[from_packed[field.type]], field.offset) for field in message.fields]
        at, frame, stride = stamp(message.timestamp), message.frame_id, message.point_stride
    names, formats, offsets = (list(column) for column in zip(*fields, strict=True))
    layout = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": stride})
    return at, frame, np.frombuffer(bytes(message.data), layout)


def seconds(text: str) -> int:
    return round(float(text) * 1e3) * 1_000_000


def place(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and y in double precision."""
    exact = "exact_x" in points.dtype.names
    if exact:
        # What viewers take is the same place in single precision.
        np.testing.assert_array_equal(points["x"], points["exact_x"].astype(np.float32))
    return (points["exact_x"], points["exact_y"]) if exact else (points["x"], points["y"])


def test_echoes_are_those_of_the_table(recording: Recording, tables: Any) -> None:
    rows = iter(tables[0])
    sensors = recording.metadata["atm.sensors"]
    count = 0
    for message in recording.of("/atm/echoes"):
        at, frame, points = cloud(message)
        assert frame == "odom"
        for point, x, y in zip(points, *place(points), strict=True):
            row = next(rows)
            count += 1
            assert at + int(point["t"]) == seconds(row["t"])
            assert sensors[str(point["sensor"])] == row["sensor"]
            assert KINDS[point["kind"]] == row["kind"]
            assert int(point["crossings"]) == int(row["crossings"])
            assert (float(x), float(y), float(point["z"])) == (float(row["x"]), float(row["y"]), 0.0)
            for name in ("range", "azimuth", "resolution", "significance"):
                assert float(point[name]) == float(row[name])
    assert next(rows, None) is None and count == 631


def test_crossings_are_those_of_the_table(recording: Recording, tables: Any) -> None:
    rows = iter(tables[1])
    for message in recording.of("/atm/crossings/points"):
        at, _, points = cloud(message)
        for point, x, y in zip(points, *place(points), strict=True):
            row = next(rows)
            assert (at + int(point["t"]), at + int(point["t_other"])) == (seconds(row["t"]), seconds(row["t_other"]))
            assert (str(point["sensor"]), str(point["sensor_other"])) == (row["sensor"], row["sensor_other"])
            assert (float(x), float(y)) == (float(row["x"]), float(row["y"]))
            assert (float(point["azimuth"]), float(point["angle"])) == (float(row["azimuth"]), float(row["angle"]))
    assert next(rows, None) is None


def written_again(recording: Recording, path: Path, **layout: Any) -> Path:
    """The echoes alone, decoded and encoded anew by other people's code: ROS 2's in big endian."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    with path.open("wb") as file:
        writer = Writer(file, **layout)
        writer.start("", "rewritten")
        writer.add_metadata("atm.sensors", recording.metadata["atm.sensors"])
        channels: dict[int, int] = {}
        for channel, schema, message, decoded in recording.messages:
            if channel.topic != "/atm/echoes":
                continue
            if channel.id not in channels:
                named = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, named)
            if channel.message_encoding == "cdr":
                told = store.deserialize_cdr(message.data, schema.name)
                data = bytes(store.serialize_cdr(told, schema.name, little_endian=False))
            else:
                data = decoded.SerializeToString()
            writer.add_message(channels[channel.id], message.log_time, data, message.publish_time)
        writer.finish()
    return path


@pytest.mark.parametrize("layout", [BARE, PLAIN, {**LZ4, "chunk_size": 1000}], ids=["no chunks", "chunks", "lz4"])
def test_scores_of_echoes_that_others_wrote_again_are_those_of_the_table(
    layout: dict[str, Any], recording: Recording, root: Path, command: Command, tmp_path: Path
) -> None:
    table, again = tmp_path / "echoes.csv", written_again(recording, tmp_path / "again.mcap", **layout)
    command("fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", table)
    scores = [command("eval", echoes, "--world", "doorway", "--json").stdout for echoes in (table, again)]
    assert scores[0] == scores[1] and '"points": 631' in scores[0]


def colors(points: np.ndarray) -> Iterator[tuple[int, int, int]]:
    for point in points:
        if "rgb" in points.dtype.names:
            rgb = int(point["rgb"])
            yield rgb >> 16, rgb >> 8 & 255, rgb & 255
        else:
            yield int(point["red"]), int(point["green"]), int(point["blue"])


def test_each_kind_of_echo_has_a_colour_of_its_own(recording: Recording) -> None:
    seen = defaultdict(set)
    for message in recording.of("/atm/echoes"):
        _, _, points = cloud(message)
        for point, color in zip(points, colors(points), strict=True):
            seen[int(point["kind"])].add(color)
    assert {kind: len(colors) for kind, colors in seen.items()} == {0: 1, 1: 1, 2: 1}
    assert len(set.union(*seen.values())) == 3


def test_file_says_what_it_is(recording: Recording) -> None:
    statistics = recording.summary.statistics
    assert statistics is not None
    assert statistics.message_count == len(recording.messages) and statistics.chunk_count == len(recording.summary.chunk_indexes)
    times = [message.log_time for _, _, message, _ in recording.messages]
    assert times == sorted(times)
    assert all(index.compression == "zstd" for index in recording.summary.chunk_indexes)
    topics = {channel.topic for channel in recording.summary.channels.values()}
    assert topics == {"/tf", "/tf_static", *(f"/atm/{name}" for name in ("pose", "path", "path/points", "echoes", "map", "arcs",
                                                                        "arcs/points", "crossings", "crossings/points"))}


def poses(recording: Recording, topic: str) -> Iterator[tuple[str, str, float, float, float]]:
    """Parent, child, x, y and heading of each transform."""
    for message in recording.of(topic):
        for one in message.transforms:
            ros = hasattr(one, "transform")
            parent = one.header.frame_id if ros else one.parent_frame_id
            at, turn = (one.transform.translation, one.transform.rotation) if ros else (one.translation, one.rotation)
            yield parent, one.child_frame_id, at.x, at.y, 2 * math.atan2(turn.z, turn.w)


def test_transforms_make_one_tree_with_the_sensors_in_it(recording: Recording) -> None:
    assert next(iter(recording.messages))[0].topic == "/tf_static"
    mounts = list(poses(recording, "/tf_static"))
    assert [(parent, child) for parent, child, *_ in mounts] == [("base_link", str(index)) for index in range(16)]
    for index, (_, _, x, y, yaw) in enumerate(mounts):
        assert math.hypot(x, y) == pytest.approx(9 * 0.0254)
        assert math.remainder(yaw - index * math.pi / 8, 2 * math.pi) == pytest.approx(0, abs=1e-12)
        assert math.remainder(math.atan2(y, x) - yaw, 2 * math.pi) == pytest.approx(0, abs=1e-12)
    robot = list(poses(recording, "/tf"))
    assert {(parent, child) for parent, child, *_ in robot} == {("odom", "base_link")} and len(robot) == 49


def test_ros_types_are_those_of_ros(root: Path, command: Command, tmp_path: Path) -> None:
    path = tmp_path / "echoes.mcap"
    command("fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", path, "--schema", "ros2")
    with path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None and reader.get_header().profile == "ros2"
        messages = [(schema, message) for schema, _, message in reader.iter_messages() if schema is not None]
    for channel in summary.channels.values():
        offered = channel.metadata["offered_qos_profiles"]
        assert f"durability: {1 if channel.topic == '/tf_static' else 2}\n" in offered
    for store in (get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS2_JAZZY)):
        for schema in summary.schemas.values():
            assert schema.encoding == "ros2msg"
            ours = get_types_from_msg(schema.data.decode(), schema.name)
            for name, (_, fields) in ours.items():
                assert fields == store.fielddefs[name][1], name
        # The whole of each message is read, and written again is the same.
        for schema, message in messages[::7]:
            value = store.deserialize_cdr(message.data, schema.name)
            again = bytes(store.serialize_cdr(value, schema.name))
            assert again.rstrip(b"\0") == message.data.rstrip(b"\0"), schema.name


def shape(descriptor: descriptor_pb2.DescriptorProto) -> list[tuple[str, int, int, int, str]]:
    return [(field.name, field.number, field.type, field.label, field.type_name) for field in descriptor.field]


def test_foxglove_types_are_those_of_foxglove(root: Path, command: Command, tmp_path: Path) -> None:
    path = tmp_path / "echoes.mcap"
    command("fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", path)
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    compared = 0
    for schema in summary.schemas.values():
        assert schema.encoding == "protobuf" and schema.name.startswith("foxglove.")
        for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
            (message,) = file.message_type
            if file.package != "foxglove":
                assert file.name in ("google/protobuf/timestamp.proto", "google/protobuf/duration.proto")
                continue
            module = __import__(f"foxglove_schemas_protobuf.{message.name}_pb2", fromlist=[message.name])
            theirs = descriptor_pb2.FileDescriptorProto()
            module.DESCRIPTOR.CopyToProto(theirs)
            assert (file.name, file.syntax) == (theirs.name, theirs.syntax)
            expected = {field[0]: field for field in shape(theirs.message_type[0])}
            for field in shape(message):
                # A later release may have more fields than the package here, and never others.
                assert expected.get(field[0], field) == field, message.name
            assert set(expected) <= {field[0] for field in shape(message)}, message.name
            assert [(enum.name, [(value.name, value.number) for value in enum.value]) for enum in message.enum_type] == [
                (enum.name, [(value.name, value.number) for value in enum.value]) for enum in theirs.message_type[0].enum_type]
            compared += 1
    assert compared > 20 and foxglove_schemas_protobuf and FieldDescriptor.TYPE_DOUBLE == 1
