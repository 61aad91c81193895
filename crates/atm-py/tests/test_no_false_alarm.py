"""Recordings that are in order get no advice, whoever has written them and however they say where the robot is."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import (
    BARE,
    LZ4,
    PLAIN,
    RIG,
    ZSTD,
    Drive,
    Json,
    Protobuf,
    Ros,
    in_order,
    moving_transforms,
    odometry,
    ranges,
    stamped_poses,
    static_transforms,
    usual,
    write,
)
from rosbags.typesys import Stores

import atm

# A robot that turns while it circles: a history of 10 readings spans little of its way.
OPTIONS = ("--history", "40", "--min-angle", "20deg")


def with_odometry(drive: Drive) -> list[Any]:
    return in_order(static_transforms(drive), odometry(drive), ranges(drive))


def with_poses(drive: Drive) -> list[Any]:
    return in_order(static_transforms(drive), stamped_poses(drive), ranges(drive))


def with_all(drive: Drive) -> list[Any]:
    return in_order(static_transforms(drive), moving_transforms(drive), odometry(drive), ranges(drive))


HUMBLE = Ros(Stores.ROS2_HUMBLE)
FILES = {
    "humble, zstd": (usual, HUMBLE, ZSTD),
    "humble, lz4": (usual, HUMBLE, LZ4),
    "humble, chunks": (usual, HUMBLE, PLAIN),
    "humble, bare": (usual, HUMBLE, BARE),
    "humble, big-endian": (usual, Ros(Stores.ROS2_HUMBLE, big_endian=True), ZSTD),
    "jazzy": (usual, Ros(Stores.ROS2_JAZZY), ZSTD),
    "noetic": (usual, Ros(Stores.ROS1_NOETIC), LZ4),
    "foxglove": (usual, Protobuf(), ZSTD),
    "json": (usual, Json(), ZSTD),
    "odometry": (with_odometry, HUMBLE, ZSTD),
    "poses": (with_poses, HUMBLE, ZSTD),
    "transforms and odometry": (with_all, HUMBLE, ZSTD),
}


@pytest.fixture(scope="module")
def drive() -> Drive:
    return Drive.of()


@pytest.mark.parametrize("name", FILES)
def test_recordings(name: str, drive: Drive, tmp_path: Path, command: Callable[..., Any]) -> None:
    said, encoder, options = FILES[name]
    log = write(tmp_path / "drive.mcap", said(drive), encoder, **options)
    counts = tmp_path / "counts.json"
    ran = command("fuse", log, "--summary", counts, "-o", tmp_path / "echoes.csv", *OPTIONS)
    assert json.loads(counts.read_text())["advice"] == []
    assert "warning" not in ran.stderr
    assert json.loads(command("info", "--json", log).stdout)["advice"] == []


def test_the_same_readings_as_a_table_and_as_arrays(
    drive: Drive, tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    log = tmp_path / "drive.csv"
    log.write_text(drive.table())
    options = {"history": 40, "min_angle": np.deg2rad(20), "range_resolution": 0.01}
    counts = atm.fuse_file(log, rig=tmp_path / "rig.toml", **options)
    assert counts["advice"] == []
    table = np.genfromtxt(log, delimiter=",", names=True, dtype=None, encoding="utf-8")
    columns = [table[field] for field in ("t", "sensor", "range", "x", "y", "yaw")]
    atm.fuse(*columns, rig=tmp_path / "rig.toml", **options)
    assert not recwarn.list


def test_what_is_likely_wrong_is_warned_of(drive: Drive, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    log = tmp_path / "drive.csv"
    log.write_text(drive.table())
    table = np.genfromtxt(log, delimiter=",", names=True, dtype=None, encoding="utf-8")
    t, sensor, range_, x, y, yaw = (table[field] for field in ("t", "sensor", "range", "x", "y", "yaw"))
    with pytest.warns(UserWarning, match="the ranges are in mm, not in m"):
        atm.fuse(t, sensor, 1000 * range_, x, y, yaw, rig=tmp_path / "rig.toml", range_resolution=0.01)
    with pytest.warns(UserWarning, match="poses do not move"):
        atm.fuse(t, sensor, range_, 0 * x, 0 * y, yaw, rig=tmp_path / "rig.toml", range_resolution=0.01)
