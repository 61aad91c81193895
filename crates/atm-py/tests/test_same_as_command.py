"""`atm.fuse` and ``atm fuse`` on the same log: the same rows, bit for bit."""

from __future__ import annotations

import csv
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import atm
from drives import Drive, drives, flags, methods, options
from reference import Method

FIELDS = "t,sensor,x,y,kind,range,azimuth,crossings,resolution,significance".split(",")
REALS = ("x", "y", "range", "azimuth", "resolution", "significance")
MORE = "support,against,sigma_azimuth,sigma_range,normal_x,normal_y".split(",")


def assert_same(echoes: np.ndarray, table: Path) -> int:
    """Every field of every row, floats by their bits; gives the number of rows."""
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    more = MORE if "support" in (echoes.dtype.names or ()) else []
    assert list(echoes.dtype.names) == FIELDS + more
    assert len(echoes) == len(rows)
    nanoseconds = [int(Decimal(row["t"]) * 10**9) for row in rows]
    if echoes["t"].dtype == np.int64:
        assert echoes["t"].tolist() == nanoseconds
    else:
        assert echoes["t"].dtype == np.float64
        assert echoes["t"].tolist() == [float(row["t"]) for row in rows]
    assert echoes["sensor"].tolist() == [row["sensor"] for row in rows]
    assert echoes["kind"].tolist() == [row["kind"] for row in rows]
    assert echoes["crossings"].tolist() == [int(row["crossings"]) for row in rows]
    for name in more[:2]:
        assert echoes[name].tolist() == [int(row[name]) for row in rows]
    for name in (*REALS, *more[2:]):
        # The normal of what is no wall is empty.
        written = np.array([float(row[name] or "nan") for row in rows], dtype=np.float64)
        bits = np.ascontiguousarray(echoes[name], dtype=np.float64)
        np.testing.assert_array_equal(bits.view(np.uint64), written.view(np.uint64), err_msg=name)
    return len(rows)


@pytest.mark.parametrize("emit", ["settled", "latest"])
@pytest.mark.parametrize("seconds", [False, True], ids=["int64", "float64"])
def test_sample_drive(
    doorway: Any, root: Path, command: Callable[..., Any], tmp_path: Path, emit: str, seconds: bool
) -> None:
    out = tmp_path / "echoes.csv"
    command("fuse", root / "examples" / "doorway.csv", "--rig", "nomad200", "--emit", emit, "-o", out)
    t, sensor, *rest = doorway
    echoes = atm.fuse(t / 1e9 if seconds else t, sensor.astype(str), *rest, rig="nomad200", emit=emit)
    assert assert_same(echoes, out) == {"settled": 631, "latest": 651}[emit]


CHOICES: list[tuple[list[str], dict[str, Any]]] = [
    (["--history", "3"], {"history": 3}),
    (["--min-angle", "0.9rad"], {"min_angle": 0.9}),
    (["--range-resolution", "0.1m"], {"range_resolution": 0.1}),
    (["--on-none", "drop", "--on-two", "mean"], {"on_none": "drop", "on_two": "mean"}),
    (["--on-two", "center"], {"on_two": "center"}),
    (["--max-age", "2.5s"], {"max_age": 2.5}),
    (["--max-travel", "0.7"], {"max_travel": 0.7}),
    (["--min-step", "0.3m"], {"min_step": 0.3}),
    (["--drop-held"], {"drop_held": True}),
    (["--keep", "median,single"], {"keep": ["median", "single"]}),
    (["--held", "edges"], {"held": "edges"}),
    (["--estimator", "consensus"], {"estimator": "consensus"}),
    (
        ["--emit", "latest", "--estimator", "consensus", "--confidence", "0.5", "--range-error", "1cm", "--keep", "point,wall"],
        {"emit": "latest", "estimator": "consensus", "confidence": 0.5, "range_error": 0.01, "keep": "point,wall"},
    ),
]


@pytest.mark.parametrize(("arguments", "keywords"), CHOICES, ids=lambda value: "" if isinstance(value, dict) else value[0])
def test_every_option(
    doorway: Any,
    root: Path,
    command: Callable[..., Any],
    tmp_path: Path,
    arguments: list[str],
    keywords: dict[str, Any],
) -> None:
    out = tmp_path / "echoes.csv"
    command("fuse", root / "examples" / "doorway.csv", "--rig", "nomad200", *arguments, "-o", out)
    echoes = atm.fuse(*doorway, rig="nomad200", **keywords)
    assert assert_same(echoes, out) > 0


def test_ring_in_radians_is_the_built_in_one(doorway: Any) -> None:
    ring = atm.Rig.ring(count=16, radius=0.2286, field_of_view=np.deg2rad(22.5), min_range=0.1524, max_range=6.477)
    echoes = atm.fuse(*doorway, rig=ring, range_resolution=0.0254)
    np.testing.assert_array_equal(echoes, atm.fuse(*doorway, rig="nomad200"))


def test_field_of_view_where_the_rig_has_none(command: Callable[..., Any], doorway: Any, root: Path, tmp_path: Path) -> None:
    toml = 'name = "bare"\n[ring]\ncount = 16\nradius = "9in"\n'
    rig_file, out = tmp_path / "bare.toml", tmp_path / "echoes.csv"
    rig_file.write_text(toml)
    command("fuse", root / "examples" / "doorway.csv", "--rig", rig_file, "--fov", "0.5rad", "-o", out)
    for rig in (atm.Rig.from_toml(toml), atm.Rig.load(rig_file), str(rig_file)):
        assert assert_same(atm.fuse(*doorway, rig=rig, field_of_view=0.5), out) > 0


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(drive=drives(), method=methods())
def test_random_drives(command: Callable[..., Any], tmp_path: Path, drive: Drive, method: Method) -> None:
    log, rig, out = tmp_path / "log.csv", tmp_path / "rig.toml", tmp_path / "echoes.csv"
    log.write_text(drive.csv)
    rig.write_text(drive.toml)
    command("fuse", log, "--rig", rig, *flags(method), "-o", out)
    assert_same(atm.fuse(*drive.columns, rig=drive.rig, **options(method)), out)


# Up to the times of today; a log's float seconds stand for whole nanoseconds, as near as a float gets.
SECONDS = st.floats(-2e9, 2e9).map(lambda seconds: round(seconds, 9))


@settings(max_examples=6, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(t=st.lists(SECONDS, min_size=1, max_size=30).map(sorted))
def test_float_seconds(command: Callable[..., Any], tmp_path: Path, t: list[float]) -> None:
    log, out = tmp_path / "log.csv", tmp_path / "echoes.csv"
    log.write_text("t,sensor,range,x,y,yaw\n" + "".join(f"{at!r},0,1,0,0,0\n" for at in t))
    command("fuse", log, "--rig", "nomad200", "-o", out)
    n = len(t)
    echoes = atm.fuse(np.array(t), np.zeros(n, int), np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n), rig="nomad200")
    assert_same(echoes, out)


def test_float_seconds_are_rounded_to_the_nearest_nanosecond() -> None:
    t = np.array([-1.0000000004, 0.1 + 0.2, 1 / 3, 2.0000000016])
    n = len(t)
    fuser = atm.Fuser("nomad200", emit="latest")
    found = fuser.push(t, np.zeros(n, int), np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n))
    assert [echo.t for echo in found] == [-1.0, 0.3, 0.333333333, 2.000000002]


def test_recording(sonar_tables: Path, command: Callable[..., Any], tmp_path: Path) -> None:
    table = np.loadtxt(sonar_tables / "measurement.txt", dtype=np.int64)
    poses = np.loadtxt(sonar_tables / "poses.txt")
    out = tmp_path / "echoes.csv"
    # A table with the numbers that numpy makes of it: how the command scales millimetres is not the question here.
    log = tmp_path / "log.csv"
    columns = (
        np.repeat(table[:, 0] * 1_000_000, 8),
        np.tile(np.arange(8), len(table)),
        np.where(table[:, 1:] == 5110, np.inf, table[:, 1:] / 1000).ravel(),
        *(np.repeat(column, 8) for column in (poses[:, 1] / 1000, poses[:, 2] / 1000, np.deg2rad(poses[:, 3] / 10))),
    )
    rows = ["t,sensor,range,x,y,yaw"]
    for t, sensor, *numbers in zip(*columns):
        rows.append(f"{t // 10**9}.{t % 10**9:09d},{sensor}," + ",".join(repr(float(number)) for number in numbers))
    log.write_text("\n".join(rows) + "\n")
    toml = "[[sensor]]\nid = \"{}\"\nyaw = \"{}deg\"\n"
    rig = tmp_path / "rig.toml"
    bearings = [-90, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90]
    rig.write_text(
        'name = "corridor"\nfield_of_view = "20deg"\nmin_range = "0.17m"\nmax_range = "5m"\nrange_resolution = "10mm"\n'
        + "".join(toml.format(*pair) for pair in enumerate(bearings))
    )
    command("fuse", log, "--rig", rig, "--drop-held", "-o", out)
    echoes = atm.fuse(*columns, rig=atm.Rig.builtin("robond8"), drop_held=True)
    assert assert_same(echoes, out) > 900
