"""`atm.Fuser`: the pieces of a log give the echoes of the log."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import atm
from drives import Drive, drives, methods, options
from reference import Method

FIELDS = ("t", "sensor", "x", "y", "kind", "range", "azimuth", "crossings", "resolution", "significance")
Readings = tuple[np.ndarray, ...]


def rows(echoes: list[atm.Echo]) -> list[tuple[Any, ...]]:
    return [tuple(getattr(echo, name) for name in FIELDS) for echo in echoes]


@settings(max_examples=50)
@given(drive=drives(), method=methods(), data=st.data())
def test_pieces_are_the_whole(drive: Drive, method: Method, data: st.DataObject) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(drive.log)), max_size=5), label="cuts"))
    fuser = atm.Fuser(drive.rig, **options(method))
    found = []
    for start, stop in zip([0, *cuts], [*cuts, len(drive.log)]):
        found += fuser.push(*(column[start:stop] for column in drive.columns))
    found += fuser.finish()
    assert rows(found) == atm.fuse(*drive.columns, rig=drive.rig, **options(method)).tolist()


@pytest.mark.parametrize("emit", ["settled", "latest"])
def test_one_reading_at_a_time(doorway: Readings, emit: str) -> None:
    fuser = atm.Fuser("nomad200", emit=emit)
    found = []
    for reading in zip(*doorway):
        found += fuser.push(*reading)
    found += fuser.finish()
    assert rows(found) == atm.fuse(*doorway, rig="nomad200", emit=emit).tolist()


def test_consensus_one_reading_at_a_time(doorway: Readings) -> None:
    fuser = atm.Fuser("nomad200", estimator="consensus")
    found = []
    for reading in zip(*doorway):
        found += fuser.push(*reading)
    found += fuser.finish()
    whole = atm.fuse(*doorway, rig="nomad200", estimator="consensus")
    assert rows(found) == whole[list(FIELDS)].tolist()
    # None stands where the array has nan.
    for name in ("support", "against", "sigma_azimuth", "sigma_range", "normal_x", "normal_y"):
        own = np.array([getattr(echo, name) for echo in found], dtype=float)
        np.testing.assert_array_equal(own, whole[name].astype(float), err_msg=name)
    assert {"point", "wall"} & set(whole["kind"].tolist())
    walls = [echo for echo in found if echo.kind == "wall"]
    assert all(abs(np.hypot(echo.normal_x or 0.0, echo.normal_y or 0.0) - 1.0) < 1e-12 for echo in walls)
    assert "sigma_azimuth=" in repr(found[0]) and "sigma" not in repr(atm.Fuser("nomad200", emit="latest").push(0, "0", 1, 0, 0, 0)[0])


def test_plain_numbers(doorway: Readings) -> None:
    """Python's own numbers, and ids as str."""
    fuser = atm.Fuser("nomad200", emit="latest")
    found = fuser.push(5, "3", 1.5, 0.0, 0.0, 0.0)
    assert [(echo.t, echo.sensor, echo.kind) for echo in found] == [(5, "3", "center")]
    assert isinstance(found[0], atm.Echo)
    found = fuser.push(6, 3, 2, 0, 0, 0)
    assert [(echo.t, echo.sensor, echo.range) for echo in found] == [(6, "3", 2.0)]


def test_seconds_come_back_as_seconds() -> None:
    fuser = atm.Fuser("nomad200", emit="latest")
    (echo,) = fuser.push(0.25, "3", 1.5, 0.0, 0.0, 0.0)
    assert (type(echo.t), echo.t) == (float, 0.25)


def test_settled_waits_and_latest_does_not(doorway: Readings) -> None:
    few = tuple(column[:16] for column in doorway)
    assert atm.Fuser("nomad200").push(*few) == []
    assert len(atm.Fuser("nomad200", emit="latest").push(*few)) > 0


def test_snapshot_changes_nothing(doorway: Readings) -> None:
    asked, left_alone = atm.Fuser("nomad200"), atm.Fuser("nomad200")
    for start in range(0, 784, 49):
        piece = tuple(column[start : start + 49] for column in doorway)
        assert rows(asked.push(*piece)) == rows(left_alone.push(*piece))
        assert rows(asked.snapshot()) == rows(asked.snapshot())
    assert rows(asked.finish()) == rows(left_alone.finish())


def test_settled_snapshot_at_the_end_of_a_short_log_is_what_finish_gives(doorway: Readings) -> None:
    fuser = atm.Fuser("nomad200")
    fuser.push(*(column[:100] for column in doorway))
    assert rows(fuser.snapshot()) == rows(fuser.finish())


def test_time_that_goes_back_between_pushes_is_refused() -> None:
    fuser = atm.Fuser("nomad200", emit="latest")
    fuser.push(10, 0, 1.0, 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"\bt\b"):
        fuser.push(9, 0, 1.0, 0.0, 0.0, 0.0)
    assert fuser.push(10, 0, 1.0, 0.0, 0.0, 0.0) == [], "a second reading at one time and place is none"
    assert len(fuser.push(10, 1, 1.0, 0.0, 0.0, 0.0)) == 1


def test_a_refused_push_leaves_the_fuser_as_it_was(doorway: Readings) -> None:
    fuser = atm.Fuser("nomad200")
    first, second = (tuple(column[part] for column in doorway) for part in (slice(0, 300), slice(300, None)))
    found = fuser.push(*first)
    broken = [column.copy() for column in second]
    broken[3][150] = np.nan
    with pytest.raises(ValueError, match="x.*150"):
        fuser.push(*broken)
    found += fuser.push(*second) + fuser.finish()
    assert rows(found) == atm.fuse(*doorway, rig="nomad200").tolist()


def test_echo_reads_well() -> None:
    (echo,) = atm.Fuser("nomad200", emit="latest").push(5, "3", 1.5, 0.0, 0.0, 0.0)
    assert "center" in repr(echo)
    with pytest.raises(AttributeError):
        echo.x = 3.0
