"""Recordings that other people's code wrote: the echoes are those of the same readings as a table, to 1e-9 m."""

from __future__ import annotations

import csv
import io
import random
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import (
    BARE,
    LZ4,
    MOUNTS,
    PLAIN,
    RIG,
    SECOND,
    START,
    ZSTD,
    Drive,
    Json,
    Protobuf,
    Ros,
    Said,
    images,
    in_order,
    moving_transforms,
    odometry,
    ranges,
    record,
    stamped_poses,
    static_transforms,
    usual,
    write,
)
from rosbags.typesys import Stores

import atm

# More partners for each arc than by default: all kinds of echoes are there.
OPTIONS = ("--history", "40", "--min-angle", "20deg")
Rows = list[dict[str, str]]


def echoes(text: str) -> Rows:
    return list(csv.DictReader(io.StringIO(text)))


@pytest.fixture(scope="module")
def drive() -> Drive:
    return Drive.of()


@pytest.fixture(scope="module")
def expected(drive: Drive, tmp_path_factory: pytest.TempPathFactory, command: Callable[..., Any]) -> Rows:
    folder = tmp_path_factory.mktemp("table")
    (folder / "rig.toml").write_text(RIG)
    (folder / "drive.csv").write_text(drive.table())
    rows = echoes(command("fuse", folder / "drive.csv", "--rig", folder / "rig.toml", *OPTIONS).stdout)
    kinds = [row["kind"] for row in rows]
    assert kinds.count("median") > 20 and kinds.count("single") > 5 and len(rows) > 200
    return rows


def assert_same(found: Rows, wanted: Rows) -> None:
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted):
        for exact in ("t", "sensor", "kind", "crossings"):
            assert one[exact] == other[exact], (one, other)
        for close in ("x", "y", "range", "azimuth", "resolution"):
            assert abs(float(one[close]) - float(other[close])) < 1e-9, (one, other)


HUMBLE = Ros(Stores.ROS2_HUMBLE)
# As `rosidl` writes it: constants in a module of their own, arrays by typedef, texts in annotations.
HEADER_IDL = """\
================================================================================
IDL: std_msgs/msg/Header
#include "builtin_interfaces/msg/Time.idl"
module std_msgs {
  module msg {
    @verbatim (language="comment", text=
      "Two-integer timestamp, see http://example.org/time; (not closed" "\\n" "frame \\"id\\"")
    struct Header {
      builtin_interfaces::msg::Time stamp;
      string frame_id;
    };
  };
};
================================================================================
IDL: builtin_interfaces/msg/Time
module builtin_interfaces { module msg { struct Time { int32 sec; uint32 nanosec; }; }; };
"""
RANGE_IDL = (
    """\
================================================================================
IDL: sensor_msgs/msg/Range
// generated from rosidl_adapter
#include "std_msgs/msg/Header.idl"
module sensor_msgs {
  module msg {
    module Range_Constants {
      const uint8 ULTRASOUND = 0;
      const uint8 INFRARED = 1;
    };
    /* what
       it is */
    struct Range {
      std_msgs::msg::Header header;
      @unit (value="none")
      uint8 radiation_type;
      float field_of_view;
      float min_range;
      float max_range;
      float range;
    };
  };
};
"""
    + HEADER_IDL
)
TRANSFORMS_IDL = (
    """\
================================================================================
IDL: tf2_msgs/msg/TFMessage
module tf2_msgs { module msg { struct TFMessage { sequence<geometry_msgs::msg::TransformStamped> transforms; }; }; };
================================================================================
IDL: geometry_msgs/msg/TransformStamped
module geometry_msgs { module msg { struct TransformStamped {
  std_msgs::msg::Header header; string child_frame_id; geometry_msgs::msg::Transform transform; }; }; };
================================================================================
IDL: geometry_msgs/msg/Transform
module geometry_msgs { module msg { struct Transform {
  geometry_msgs::msg::Vector3 translation; geometry_msgs::msg::Quaternion rotation; }; }; };
================================================================================
IDL: geometry_msgs/msg/Vector3
module geometry_msgs { module msg { struct Vector3 { double x; double y; double z; }; }; };
================================================================================
IDL: geometry_msgs/msg/Quaternion
module geometry_msgs { module msg { struct Quaternion {
  @default (value=0.0) double x; @default (value=0.0) double y; @default (value=0.0) double z; @default (value=1.0) double w;
}; }; };
"""
    + HEADER_IDL
)
ODOMETRY_IDL = (
    """\
================================================================================
IDL: nav_msgs/msg/Odometry
module nav_msgs { module msg { struct Odometry {
  std_msgs::msg::Header header; string child_frame_id;
  geometry_msgs::msg::PoseWithCovariance pose; geometry_msgs::msg::TwistWithCovariance twist; }; }; };
================================================================================
IDL: geometry_msgs/msg/PoseWithCovariance
module geometry_msgs { module msg { typedef double double__36[36];
  struct PoseWithCovariance { geometry_msgs::msg::Pose pose; double__36 covariance; }; }; };
================================================================================
IDL: geometry_msgs/msg/TwistWithCovariance
module geometry_msgs { module msg { typedef double double__36[36];
  struct TwistWithCovariance { geometry_msgs::msg::Twist twist; double__36 covariance; }; }; };
================================================================================
IDL: geometry_msgs/msg/Twist
module geometry_msgs { module msg { struct Twist { geometry_msgs::msg::Vector3 linear; geometry_msgs::msg::Vector3 angular; }; }; };
================================================================================
IDL: geometry_msgs/msg/Pose
module geometry_msgs { module msg { struct Pose { geometry_msgs::msg::Point position; geometry_msgs::msg::Quaternion orientation; }; }; };
================================================================================
IDL: geometry_msgs/msg/Point
module geometry_msgs { module msg { struct Point { double x; double y; double z; }; }; };
"""
    + TRANSFORMS_IDL
)
IDL = Ros(
    Stores.ROS2_HUMBLE,
    idl={"sensor_msgs/msg/Range": RANGE_IDL, "tf2_msgs/msg/TFMessage": TRANSFORMS_IDL, "nav_msgs/msg/Odometry": ODOMETRY_IDL},
)


@pytest.mark.parametrize(
    "encoder",
    [
        pytest.param(HUMBLE, id="humble"),
        pytest.param(Ros(Stores.ROS2_JAZZY), id="jazzy"),
        pytest.param(Ros(Stores.ROS2_FOXY), id="foxy"),
        pytest.param(Ros(Stores.ROS2_HUMBLE, big_endian=True), id="big endian"),
        pytest.param(IDL, id="idl"),
        pytest.param(Ros(Stores.ROS1_NOETIC), id="ros1"),
        pytest.param(Json(), id="json"),
        pytest.param(Protobuf(), id="protobuf"),
    ],
)
def test_encodings(encoder: Any, drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    log = write(tmp_path / "drive.mcap", usual(drive), encoder)
    done = command("fuse", log, *OPTIONS)
    assert_same(echoes(done.stdout), expected)
    assert "transforms up to the frame odom" in done.stderr


@pytest.mark.parametrize(
    "layout",
    [
        pytest.param(BARE, id="no chunks, no summary"),
        pytest.param(PLAIN, id="not compressed"),
        pytest.param(LZ4, id="lz4"),
        pytest.param(ZSTD, id="zstd"),
        pytest.param({**ZSTD, "chunk_size": 1 << 30}, id="one chunk"),
        pytest.param({**PLAIN, "chunk_size": 1}, id="a chunk for each message"),
        pytest.param({**BARE, "enable_data_crcs": True}, id="with a checksum of the data"),
    ],
)
def test_layouts(layout: dict[str, Any], drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    said = in_order(usual(drive), images(drive, 20_000, 10))
    log = write(tmp_path / "drive.mcap", said, HUMBLE, **layout)
    assert_same(echoes(command("fuse", log, *OPTIONS).stdout), expected)


@pytest.mark.parametrize(
    ("poses", "source"),
    [
        pytest.param(odometry, "/odom in the frame odom", id="odometry"),
        pytest.param(stamped_poses, "/pose in the frame odom", id="poses"),
    ],
)
@pytest.mark.parametrize("encoder", [HUMBLE, Ros(Stores.ROS1_NOETIC), Json()], ids=["ros2", "ros1", "json"])
def test_other_poses(
    poses: Callable[[Drive], list[Said]],
    source: str,
    encoder: Any,
    drive: Drive,
    expected: Rows,
    command: Callable[..., Any],
    tmp_path: Path,
) -> None:
    log = write(tmp_path / "drive.mcap", in_order(static_transforms(drive), poses(drive), ranges(drive)), encoder)
    done = command("fuse", log, *OPTIONS)
    assert_same(echoes(done.stdout), expected)
    assert source in done.stderr


def test_odometry_in_idl(drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    log = write(tmp_path / "drive.mcap", in_order(static_transforms(drive), odometry(drive), ranges(drive)), IDL)
    assert_same(echoes(command("fuse", log, *OPTIONS).stdout), expected)


@pytest.mark.parametrize("layout", [BARE, ZSTD], ids=["no chunks", "chunks"])
def test_unsorted(layout: dict[str, Any], drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    """Messages anywhere within half a second of where they belong, and transforms up to a second behind."""
    dice = random.Random(5)

    def place(said: Said) -> int:
        return said.log + (dice.randrange(SECOND) if said.topic == "/tf" else dice.randrange(SECOND // 2))

    said = sorted(usual(drive), key=place)
    assert [s.log for s in said] != sorted(s.log for s in said)
    log = write(tmp_path / "drive.mcap", said, HUMBLE, **layout)
    assert_same(echoes(command("fuse", log, *OPTIONS).stdout), expected)


def test_recorded_late(drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    """Each topic with a delay of its own: the stamps say when it was."""
    delays = {"/range/left": 700_000_000, "/tf": 300_000_000, "/range/low": 1_200_000_000}
    said = in_order([replace(s, log=s.log + delays.get(s.topic, 0)) for s in usual(drive)])
    log = write(tmp_path / "drive.mcap", said, HUMBLE)
    assert_same(echoes(command("fuse", log, *OPTIONS).stdout), expected)


def test_simulated_time(drive: Drive, command: Callable[..., Any], tmp_path: Path) -> None:
    """Stamps since the start of a simulation, log times of a wall clock: noticed, and the echoes are the same."""
    wall = 500_000_000 * SECOND
    clock = [Said("/clock", "rosgraph_msgs/msg/Clock", START, {"clock": {"sec": 0, "nanosec": 0}})]
    said = [replace(s, log=s.log + wall) for s in in_order(clock, usual(drive))]
    done = command("fuse", write(tmp_path / "drive.mcap", said, HUMBLE), *OPTIONS)
    assert "simulated time" in done.stderr
    assert len(echoes(done.stdout)) > 200
    plain = command("fuse", write(tmp_path / "plain.mcap", usual(drive), HUMBLE), *OPTIONS)
    assert "simulated" not in plain.stderr
    assert done.stdout == plain.stdout


def test_cut_anywhere(drive: Drive, tmp_path: Path) -> None:
    """At 60 places: no reading is invented, none is missed that ends before the cut, and the loss is told."""
    whole = record(usual(drive), HUMBLE, **PLAIN)
    messages = [HUMBLE.message(said) for said in ranges(drive)]
    ends = [whole.index(message) + len(message) for message in messages]
    log, dice = tmp_path / "drive.mcap", random.Random(7)
    for cut in sorted(dice.randrange(len(whole)) for _ in range(60)):
        log.write_bytes(whole[:cut])
        with pytest.warns(UserWarning, match="truncated"):
            counts = atm.fuse_file(log, max_gap="60s")
        before = sum(end <= cut for end in ends)
        # Those behind the last transform have no pose.
        assert counts["readings"] + counts["dropped"].get("no_pose", 0) == before
        assert before - counts["readings"] < 10
        assert counts["input_damaged"] is True


def test_chunks_of_others_are_passed_over(drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    """Chunks without a topic that is wanted are not even unpacked: what is in them may be broken."""
    said = in_order(usual(drive), images(drive, 50_000))
    log = write(tmp_path / "drive.mcap", said, HUMBLE, **{**PLAIN, "chunk_size": 1})
    data = bytearray(log.read_bytes())
    head = b"x" * 40_000
    at, broken = data.find(head), 0
    while at >= 0:
        data[at] = 0
        broken += 1
        at = data.find(head, at + 50_000)
    assert broken == len(drive.poses)
    log.write_bytes(data)
    assert_same(echoes(command("fuse", log, *OPTIONS).stdout), expected)
    # From a pipe all has to be read, and is then found to be broken.
    with log.open("rb") as pipe:
        import subprocess
        import sys

        done = subprocess.run([sys.executable, "-m", "atm", "fuse", "-", *OPTIONS], stdin=pipe, capture_output=True, text=True)
    assert done.returncode == 3 and f"{broken} bad_chunk" in done.stderr
    assert_same(echoes(done.stdout), expected)


def test_fuse_file(drive: Drive, expected: Rows, command: Callable[..., Any], tmp_path: Path) -> None:
    log, ours, theirs = write(tmp_path / "drive.mcap", usual(drive), HUMBLE), tmp_path / "ours.csv", tmp_path / "theirs.csv"
    told: list[Any] = []
    atm.fuse_file(log, output=ours, history=40, min_angle="20deg", progress=lambda *said: told.append(said))
    assert told[-1] == (log.stat().st_size, log.stat().st_size)
    command("fuse", log, "-o", theirs, *OPTIONS)
    assert ours.read_bytes() == theirs.read_bytes()
    assert_same(echoes(ours.read_text()), expected)
    for schema in ("foxglove", "ros2"):
        out, other = tmp_path / "ours.mcap", tmp_path / "theirs.mcap"
        atm.fuse_file(log, output=out, schema=schema, passthrough=True)
        command("fuse", log, "-o", other, "--schema", schema, "--passthrough")
        assert out.read_bytes() == other.read_bytes()
    some = atm.fuse_file(log, range_topics=["/range/left", "/range/right"], reorder=0.5, clock="header", max_message=10_000)
    assert some["readings"] == sum(r.sensor in ("left", "right") for r in drive.readings)
    with pytest.raises(ValueError, match="there is no topic /nowhere"):
        atm.fuse_file(log, pose_topic="/nowhere")
    with pytest.raises(ValueError, match="clock"):
        atm.fuse_file(log, clock="sundial")
    with pytest.raises(TypeError, match=r"range_topics\[0\]"):
        atm.fuse_file(log, range_topics=[3])


def test_info(drive: Drive, command: Callable[..., Any], tmp_path: Path) -> None:
    import json

    log = write(tmp_path / "drive.mcap", usual(drive), Ros(Stores.ROS1_NOETIC))
    found = json.loads(command("info", log, "--json").stdout)
    assert set(found["sensors"]) == set(MOUNTS)
    for name, sensor in found["sensors"].items():
        of = [r for r in drive.readings if r.sensor == name]
        assert sensor["topic"] == f"/range/{name}"
        assert sensor["readings"] == len(of)
        assert sensor["no_echo"] == sum(not np.isfinite(r.range) for r in of)
        assert sensor["rate_hz"] == pytest.approx(10)
        assert (sensor["field_of_view_rad"], sensor["min_range_m"], sensor["max_range_m"]) == (1.0, 0.125, 8.0)
    assert (found["start_ns"], found["end_ns"]) == (drive.readings[0].t, drive.readings[-1].t)


def test_noise_in_messages_never_panics(drive: Drive, command: Callable[..., Any], tmp_path: Path) -> None:
    """Each message with some bytes changed: whatever it says then, the command ends in order."""
    dice = random.Random(11)

    class Noisy:
        def __init__(self, inner: Any) -> None:
            self.inner, self.encoding = inner, inner.encoding

        def schema(self, type_: str) -> Any:
            return self.inner.schema(type_)

        def message(self, said: Said) -> bytes:
            data = bytearray(self.inner.message(said))
            for _ in range(dice.randrange(4)):
                data[dice.randrange(len(data))] = dice.randrange(256)
            return bytes(data)

    for encoder in (HUMBLE, Ros(Stores.ROS1_NOETIC), Json(), Protobuf()):
        log = write(tmp_path / "drive.mcap", usual(drive), Noisy(encoder))
        done = command("fuse", log, status=3)
        assert "panicked" not in done.stderr


def test_noise_in_a_file_never_panics(drive: Drive, tmp_path: Path) -> None:
    dice, log = random.Random(13), tmp_path / "drive.mcap"
    for layout in (BARE, PLAIN, ZSTD, LZ4):
        whole = record(usual(drive)[:200], HUMBLE, **layout)
        for _ in range(100):
            data = bytearray(whole)
            for _ in range(dice.randrange(1, 20)):
                data[dice.randrange(8, len(data))] = dice.randrange(256)
            # Absurd lengths, too.
            at = dice.randrange(8, len(data) - 8)
            if dice.random() < 0.3:
                data[at : at + 8] = struct.pack("<Q", dice.choice([2**63, 2**32 - 1, 2**40, 0]))
            log.write_bytes(data)
            try:
                with pytest.warns():
                    atm.fuse_file(log)
            except (ValueError, OSError, pytest.fail.Exception):
                pass
