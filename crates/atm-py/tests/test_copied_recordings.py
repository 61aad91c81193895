"""`--passthrough`: a recording that other people's code wrote, and what was fused of it, in one file that their code reads."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoder
from mcap_ros2.decoder import DecoderFactory as Ros2Decoder
from recordings import Drive, Json, Protobuf, Ros, Said, in_order, moving_transforms, odometry, ranges, static_transforms, usual
from rosbags.typesys import Stores

JAZZY = Ros(Stores.ROS2_JAZZY)
OFFERS = "- history: keep_last\n  depth: 1\n  reliability: reliable\n  durability: {}\n"


def record(path: Path, said: list[Said], encoder: Any, extra: tuple[str, ...] = ()) -> Path:
    """A recording with all that may be in one; `extra` are topics of bytes that nobody can read."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2" if encoder.encoding == "cdr" else "", "fixture")
        writer.add_metadata("survey", {"site": "dock 4"})
        writer.add_attachment(create_time=5, log_time=6, name="map.yaml", media_type="text/yaml", data=b"resolution: 0.05")
        channels: dict[str, int] = {}
        types: dict[str, int] = {}
        for topic in extra:
            channels[topic] = writer.register_channel(topic, "opaque", 0, {"made": "by hand"})
        for number, message in enumerate(said):
            if message.type not in types:
                types[message.type] = writer.register_schema(*encoder.schema(message.type))
            if message.topic not in channels:
                offers = OFFERS.format("transient_local" if message.topic == "/tf_static" else "volatile")
                channels[message.topic] = writer.register_channel(
                    message.topic, encoder.encoding, types[message.type], {"offered_qos_profiles": offers})
            writer.add_message(channels[message.topic], message.log, encoder.message(message), message.log - 1000, number)
            if number % 10 == 0:
                for topic in extra:
                    writer.add_message(channels[topic], message.log, b"\0" * number, message.log - 7, number)
        writer.finish()
    return path


def contents(path: Path) -> tuple[list[Any], Any]:
    """Every message with all that its channel and schema say, in the file's order, and the reader's summary."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        messages = [
            (channel.topic, channel.message_encoding, tuple(sorted(channel.metadata.items())),
             (schema.name, schema.encoding, schema.data) if schema else None,
             message.sequence, message.log_time, message.publish_time, message.data)
            for schema, channel, message in reader.iter_messages(log_time_order=False)
        ]
        assert summary is not None
        return messages, summary


def parents(path: Path) -> dict[str, set[str]]:
    """The parents of each frame, over all transforms of the file."""
    found: dict[str, set[str]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[Ros2Decoder(), ProtobufDecoder()])
        wanted = [channel.topic for channel in reader.get_summary().channels.values() if "tf" in channel.topic]  # type: ignore[union-attr]
        for _, _, _, message in reader.iter_decoded_messages(topics=wanted):
            for one in message.transforms:
                parent = one.header.frame_id if hasattr(one, "header") else one.parent_frame_id
                found.setdefault(one.child_frame_id, set()).add(parent)
    return found


DRIVE = Drive.of(6.0)
LOGS = {
    "transforms": (usual(DRIVE), JAZZY),
    "odometry": (in_order(static_transforms(DRIVE), odometry(DRIVE), ranges(DRIVE)), JAZZY),
    "both": (in_order(static_transforms(DRIVE), odometry(DRIVE), moving_transforms(DRIVE), ranges(DRIVE)), JAZZY),
    "json": (usual(DRIVE), Json()),
    "protobuf": (usual(DRIVE), Protobuf()),
}


@pytest.mark.parametrize("schema", ["foxglove", "ros2"])
@pytest.mark.parametrize("name", LOGS)
def test_all_of_it_is_there_unchanged_and_in_order(name: str, schema: str, command: Callable[..., Any], tmp_path: Path) -> None:
    log = record(tmp_path / "drive.mcap", *LOGS[name], extra=("/camera",))
    out = tmp_path / "out.mcap"
    command("fuse", log, "-o", out, "--schema", schema, "--passthrough")
    (before, _), (after, summary) = contents(log), contents(out)
    times = [message[5] for message in after]
    assert times == sorted(times)
    is_ours = lambda message: message[0].startswith("/atm/") or (message[0] == "/tf" and name == "odometry")
    copied = [message for message in after if not is_ours(message)]
    assert Counter(copied) == Counter(before)
    # What stood in order stands so still.
    assert copied == sorted(before, key=lambda message: message[5])
    assert any(message[0] == "/atm/echoes" for message in after)
    # QoS in the words of the log.
    for channel in summary.channels.values():
        if channel.message_encoding == "cdr" and JAZZY is LOGS[name][1]:
            assert "reliability: reliable" in channel.metadata["offered_qos_profiles"]
    with out.open("rb") as file:
        reader = make_reader(file)
        assert [(one.name, one.data) for one in reader.iter_attachments()] == [("map.yaml", b"resolution: 0.05")]
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
    assert metadata["survey"] == {"site": "dock 4"} and set(metadata["atm.sensors"].values()) >= {"left", "right"}


@pytest.mark.parametrize("schema", ["foxglove", "ros2"])
@pytest.mark.parametrize("name", ["transforms", "odometry", "both"])
def test_every_frame_has_one_parent(name: str, schema: str, command: Callable[..., Any], tmp_path: Path) -> None:
    log, out = record(tmp_path / "drive.mcap", *LOGS[name]), tmp_path / "out.mcap"
    command("fuse", log, "-o", out, "--schema", schema, "--passthrough")
    found = parents(out)
    assert all(len(of) == 1 for of in found.values()), found
    # From the echoes' frame there is a way to the robot and to every sensor.
    assert found["base_link"] == {"odom"} and found["left"] == {"base_link"}
    # Without the log's own transforms, all are this file's.
    command("fuse", log, "-o", out, "--schema", schema)
    assert {child: parent for child, parent in parents(out).items() if child in found and child != "odom"} == {
        child: parent for child, parent in found.items() if child != "odom"}


def test_echoes_are_the_same_with_and_without(command: Callable[..., Any], tmp_path: Path) -> None:
    log = record(tmp_path / "drive.mcap", *LOGS["transforms"])
    rows = list(csv.DictReader(io.StringIO(command("fuse", log).stdout)))
    for more in ((), ("--passthrough",)):
        out = tmp_path / "out.mcap"
        command("fuse", log, "-o", out, *more)
        with out.open("rb") as file:
            reader = make_reader(file, decoder_factories=[ProtobufDecoder()])
            clouds = [cloud for _, _, _, cloud in reader.iter_decoded_messages(topics=["/atm/echoes"])]
        assert sum(len(cloud.data) // cloud.point_stride for cloud in clouds) == len(rows) > 100
        assert {cloud.frame_id for cloud in clouds} == {"odom"}
