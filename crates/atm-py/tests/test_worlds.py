"""`atm.simulate`, `atm.evaluate` and `atm.compare` say what the commands say."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import atm

NOISE = "range=1cm,dropout=5%,crosstalk=1%,multipath,odometry=1cm,heading=0.5deg"


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def assert_table(array: np.ndarray, path: Path, words: tuple[str, ...]) -> None:
    """Every field of every row, floats by their bits."""
    table = rows(path)
    assert list(array.dtype.names or ()) == list(table[0])
    assert len(array) == len(table) > 100
    for name in table[0]:
        written = [row[name] for row in table]
        if name in words:
            assert array[name].tolist() == written
        else:
            expected = np.array([float(cell) for cell in written])
            np.testing.assert_array_equal(array[name].view(np.uint64), expected.view(np.uint64), err_msg=name)


@pytest.mark.parametrize("noise", ["", NOISE])
def test_simulated_drives_are_the_commands(command: Callable[..., Any], tmp_path: Path, noise: str) -> None:
    log, truth = tmp_path / "log.csv", tmp_path / "truth.csv"
    more = ["--noise", noise] if noise else []
    command("simulate", "doorway", "--seed", 3, "--set", "opening=30in", *more, "-o", log, "--truth", truth)
    ours, came_from = atm.simulate("doorway", seed=3, set={"opening": "30in"}, noise=noise)
    assert_table(ours, log, ("sensor",))
    assert_table(came_from, truth, ("sensor", "cause"))


def test_parameters_may_be_numbers() -> None:
    as_text, as_number = (atm.simulate("doorway", set={"opening": opening})[0] for opening in ("0.8m", 0.8))
    np.testing.assert_array_equal(as_text, as_number)
    assert len(atm.simulate("pole", rig=atm.Rig.ring(count=4, radius=0.1), set={"length": "2m"})[0]) % 4 == 0


def drive() -> tuple[list[np.ndarray], np.ndarray]:
    log, truth = atm.simulate("doorway", seed=2)
    return [log[name] for name in log.dtype.names or ()], truth


@pytest.mark.parametrize("options", [{}, {"estimator": "consensus"}], ids=str)
def test_scores_are_the_commands(command: Callable[..., Any], tmp_path: Path, options: dict[str, Any]) -> None:
    log, truth, out = (tmp_path / name for name in ("log.csv", "truth.csv", "echoes.csv"))
    command("simulate", "doorway", "--seed", 2, "-o", log, "--truth", truth)
    more = [word for name, value in options.items() for word in (f"--{name}", value)]
    command("fuse", log, "--rig", "nomad200", *more, "-o", out)
    expected = json.loads(command("eval", out, "--world", "doorway", "--truth", truth, "--json").stdout)
    readings, came_from = drive()
    echoes = atm.fuse(*readings, rig="nomad200", **options)
    assert atm.evaluate(echoes, "doorway", truth=came_from) == expected
    assert expected["azimuth_error_m"]["count"] > 500
    # A dict of arrays as well, and points of which nothing else is known.
    fields = {name: echoes[name] for name in echoes.dtype.names or ()}
    assert atm.evaluate(fields, "doorway", truth=came_from) == expected
    bare = atm.evaluate({"x": echoes["x"], "y": echoes["y"]}, "doorway")
    assert bare["surface_error_m"] == expected["surface_error_m"] and bare["azimuth_error_m"]["p50"] is None


@pytest.mark.parametrize("known", [True, False])
def test_methods_are_the_commands(command: Callable[..., Any], tmp_path: Path, known: bool) -> None:
    log, truth = tmp_path / "log.csv", tmp_path / "truth.csv"
    command("simulate", "doorway", "--seed", 2, "-o", log, "--truth", truth)
    world = ["--world", "doorway", "--truth", truth] if known else []
    done = command("compare", log, "--rig", "nomad200", *world, "--history", 8, "--range-error", "5mm", "--json", "--quiet")
    expected = json.loads(done.stdout)
    readings, came_from = drive()
    options: dict[str, Any] = {"world": "doorway", "truth": came_from} if known else {}
    said = atm.compare(*readings, rig="nomad200", history=8, range_error=0.005, **options)
    assert said.keys() == expected.keys() and len(said) > 20
    for name, method in said.items():
        assert method.pop("seconds_per_reading") >= 0.0
        del expected[name]["seconds_per_reading"]
        assert method == expected[name], name


def test_methods_come_in_the_order_asked_for() -> None:
    readings, _ = drive()
    assert list(atm.compare(*readings, rig="nomad200", methods="tbf,atm,tbf")) == ["tbf", "atm"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: atm.simulate("doorways"), ["doorways"]),
        (lambda: atm.simulate("doorway", set={"opened": "1m"}), ["opened"]),
        (lambda: atm.simulate("doorway", set={"opening": "wide"}), ["wide"]),
        (lambda: atm.simulate("doorway", noise="fog=1"), ["noise", "fog"]),
        (lambda: atm.simulate("doorway", field_of_view=7.0), ["field_of_view"]),
        (lambda: atm.evaluate({"x": [1.0]}, "doorway"), ["echoes", "'y'", '"y"']),
        (lambda: atm.evaluate({"x": [1.0], "y": [1.0, 2.0]}, "doorway"), ["echoes", "y"]),
        (lambda: atm.evaluate({"x": [1.0, np.nan], "y": [1.0, 2.0]}, "doorway"), ["echoes", "[1]"]),
        (lambda: atm.evaluate({"x": [1.0], "y": [1.0]}, "doorway", truth={"t": [0]}), ["truth", "sensor"]),
        (lambda: atm.compare(*drive()[0], rig="nomad200", methods=["atm", "best"]), ["methods", "best"]),
        (lambda: atm.compare(*drive()[0], rig="nomad200", cell=0.0), ["cell"]),
        (lambda: atm.compare(*drive()[0], rig="nomad200", range_error=-1.0), ["range_error"]),
    ],
    ids=range(12),
)
def test_what_is_refused_is_named(call: Callable[[], object], words: list[str]) -> None:
    with pytest.raises((ValueError, TypeError, FileNotFoundError)) as caught:
        call()
    assert words[0] in str(caught.value) and any(word in str(caught.value) for word in words[1:] or words)
