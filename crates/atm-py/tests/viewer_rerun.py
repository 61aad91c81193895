"""Recordings that are written, loaded by the Rerun viewer without a screen. Not collected with the other tests: the viewer is large,
and sits in an environment of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

RERUN = Path(sys.executable).with_name("rerun")
DRAWN = ("/atm/arcs/points", "/atm/crossings/points", "/atm/echoes", "/atm/map", "/atm/path/points")
TRANSFORMS = ("/tf", "/tf_static")


def rerun(*arguments: object) -> tuple[str, str]:
    """Both outputs. The exit code does not tell; `ERROR` on standard error does."""
    done = subprocess.run([RERUN, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=True)
    assert "ERROR" not in done.stderr, done.stderr
    return done.stdout, done.stderr


@pytest.fixture(params=("foxglove", "ros2"))
def recording(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The sample, fused into a recording of either kind of messages, by the command that ATM names."""
    path = tmp_path / f"{request.param}.mcap"
    root = Path(__file__).resolve().parents[3]
    line = [os.environ["ATM"], "fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", path, "--schema", request.param]
    subprocess.run([str(part) for part in line], capture_output=True, timeout=60, check=True)
    return path


def columns(listing: str) -> dict[str, set[str]]:
    """What the viewer made of each topic, by the names of its columns."""
    found: dict[str, set[str]] = {}
    for entity, names in re.findall(r"rows .*? - (/\S*) - data columns: \[(.*)\]", listing):
        found.setdefault(entity, set()).update(names.split())
    return found


def test_viewer_finds_nothing_to_complain_about(recording: Path) -> None:
    listing, _ = rerun("mcap", "check", recording)
    rows = [line for line in listing.splitlines() if re.search(r" /(atm|tf)", line)]
    assert len(rows) == 11 and all(row.startswith("ok") for row in rows), listing


def test_points_and_transforms_are_there(recording: Path, tmp_path: Path) -> None:
    loaded = tmp_path / "loaded.rrd"
    rerun("mcap", "convert", recording, "-o", loaded)
    listing, _ = rerun("rrd", "print", loaded)
    found = columns(listing)
    for topic in DRAWN:
        assert {"Points3D:positions", "CoordinateFrame:frame"} <= found[topic], topic
    for topic in TRANSFORMS:
        assert {"Transform3D:parent_frame", "Transform3D:child_frame", "Transform3D:translation"} <= found[topic], topic
    assert {"InstancePoses3D:translations", "CoordinateFrame:frame"} <= found["/atm/pose"]
    # Kinds of echoes are told apart by their colours where the viewer reads these.
    if recording.stem == "foxglove":
        assert "Points3D:colors" in found["/atm/echoes"]


def test_positions_are_those_of_the_echoes(recording: Path, tmp_path: Path) -> None:
    table = tmp_path / "echoes.csv"
    root = Path(__file__).resolve().parents[3]
    subprocess.run([os.environ["ATM"], "fuse", root / "examples/doorway.csv", "--rig", "nomad200", "-o", table],
                   capture_output=True, timeout=60, check=True)
    first = table.read_text().splitlines()[1].split(",")
    loaded = tmp_path / "loaded.rrd"
    rerun("mcap", "convert", recording, "-o", loaded)
    listing, _ = rerun("rrd", "print", "-vvv", "--entity", "/atm/echoes", loaded)
    places = re.findall(r"\[(-?[\d.e-]+), (-?[\d.e-]+), (-?[\d.e-]+)\]", listing)
    x, y = float(first[2]), float(first[3])
    assert any(abs(float(place[0]) - x) < 1e-6 and abs(float(place[1]) - y) < 1e-6 for place in places), (x, y, places[:5])


@pytest.mark.parametrize("schema", ["foxglove", "ros2"])
def test_what_is_copied_beside_it_does_no_harm(schema: str, tmp_path: Path) -> None:
    log, out, loaded = tmp_path / "drive.mcap", tmp_path / "out.mcap", tmp_path / "loaded.rrd"
    for line in (["simulate", "doorway", "-o", log], ["fuse", log, "-o", out, "--passthrough", "--schema", schema]):
        subprocess.run([os.environ["ATM"], *map(str, line)], capture_output=True, timeout=60, check=True)
    rerun("mcap", "convert", out, "-o", loaded)
    found = columns(rerun("rrd", "print", loaded)[0])
    assert "Points3D:positions" in found["/atm/echoes"]
    assert "Scalars:scalars" in found["/range/sensor_0"]
    assert {"Transform3D:parent_frame", "Transform3D:child_frame"} <= found["/tf"]
