"""`atm.fuse` against the method written a second time, over random rigs and drives.

Both decide the same wherever no angle or length is within `MARGIN` of its threshold (radians, or relative to the length);
positions agree to a nanometre.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import atm
from drives import Drive, drives, methods, options
from reference import Fused, Method, Mount, fuse, snapshot

MARGIN = 1e-9
POSITION = 1e-9


def assert_agrees(echoes: Any, expected: Fused, drive: Drive) -> None:
    """Order, kinds and counts as they are; positions to `POSITION` metres; the rest to as many digits."""
    assert expected.margin > MARGIN

    def column(name: str) -> np.ndarray:
        return np.array([getattr(echo, name) for echo in expected.echoes])

    assert echoes["t"].tolist() == column("t").tolist()
    assert echoes["sensor"].tolist() == [f"s{sensor}" for sensor in column("sensor")]
    assert echoes["kind"].tolist() == column("kind").tolist()
    assert echoes["crossings"].tolist() == column("crossings").tolist()
    assert echoes["range"].tolist() == column("range").tolist()
    for name in ("x", "y", "azimuth", "resolution"):
        np.testing.assert_allclose(echoes[name], column(name), rtol=0, atol=POSITION, err_msg=name)
    np.testing.assert_allclose(echoes["significance"], column("significance"), rtol=1e-9, err_msg="significance")


@settings(max_examples=150)
@given(drive=drives(), method=methods())
def test_echoes(drive: Drive, method: Method) -> None:
    expected = fuse(drive.log, drive.mounts, method)
    assume(expected.margin > MARGIN)
    assert_agrees(atm.fuse(*drive.columns, rig=drive.rig, **options(method)), expected, drive)


@settings(max_examples=40)
@given(drive=drives(), method=methods(), data=st.data())
def test_snapshot_and_pieces(drive: Drive, method: Method, data: st.DataObject) -> None:
    """After any number of readings, the snapshot is that of the reference; nothing is reported by asking for it."""
    upto = data.draw(st.integers(0, len(drive.log)), label="readings")
    here = Drive(drive.mounts, drive.log[:upto])
    expected = snapshot(here.log, here.mounts, method)
    assume(expected.margin > MARGIN)
    fuser = atm.Fuser(drive.rig, **options(method))
    before = fuser.push(*here.columns)
    seen = fuser.snapshot()
    assert [(echo.t, echo.kind, echo.crossings) for echo in seen] == [
        (echo.t, echo.kind, echo.crossings) for echo in expected.echoes
    ]
    for echo, known in zip(seen, expected.echoes):
        assert abs(echo.x - known.x) <= POSITION
        assert abs(echo.y - known.y) <= POSITION
    rest = fuser.push(*(column[upto:] for column in drive.columns)) + fuser.finish()
    whole = atm.fuse(*drive.columns, rig=drive.rig, **options(method))
    assert [(echo.t, echo.x, echo.y) for echo in before + rest] == whole[["t", "x", "y"]].tolist()


@settings(max_examples=40)
@given(drive=drives(), method=methods())
def test_crossings(drive: Drive, method: Method) -> None:
    expected = fuse(drive.log, drive.mounts, method)
    assume(expected.margin > MARGIN)
    found = atm.crossings(*drive.columns, rig=drive.rig, **crossing_options(method))
    assert list(found.dtype.names) == ["t", "sensor", "t_other", "sensor_other", "x", "y", "azimuth", "angle"]
    assert len(found) == len(expected.crossings)
    # The two crossings of one pair of arcs may come in either order, and times may repeat: compare as sorted rows.
    names = ["x", "y", "azimuth", "angle"]
    ours = np.array([[getattr(crossing, name) for name in names] for crossing in expected.crossings]).reshape(-1, 4)
    theirs = np.stack([found[name] for name in names], axis=-1).reshape(-1, 4)
    by_place = [np.lexsort(np.round(rows, 6).T) for rows in (ours, theirs)]
    np.testing.assert_allclose(theirs[by_place[1]][:, :2], ours[by_place[0]][:, :2], rtol=0, atol=POSITION)
    # Near 0 and 90° an angle from its cosine has half the digits.
    np.testing.assert_allclose(theirs[by_place[1]][:, 2:], ours[by_place[0]][:, 2:], rtol=0, atol=1e-7)


def crossing_options(method: Method) -> dict[str, Any]:
    """What decides about crossings; what becomes of them does not."""
    return {key: value for key, value in options(method).items() if key not in ("on_none", "on_two")}


def test_random_drives_hold_every_kind() -> None:
    """The properties above are worth something only where the drives have crossings."""
    kinds: Counter[str] = Counter()

    @settings(max_examples=60, database=None, derandomize=True)
    @given(drive=drives())
    def count(drive: Drive) -> None:
        echoes = atm.fuse(*drive.columns, rig=drive.rig, on_two="mean")
        kinds.update(echoes["kind"].tolist())

    count()
    assert min(kinds[kind] for kind in ("median", "single", "pair", "center", "near")) >= 10, kinds


def test_sample_drive(doorway: Any) -> None:
    """The README's picture: 784 readings in the local map, echoes as the paper's table says."""
    t, sensor, *rest = doorway
    angles = 2 * np.pi * np.arange(16) / 16
    mounts = tuple(
        Mount(0.2286 * np.cos(a), 0.2286 * np.sin(a), a, np.deg2rad(22.5), 0.1524, 6.477, 0.0254) for a in angles
    )
    from reference import Log

    expected = fuse(Log(t, sensor, *rest), mounts, Method())
    echoes = atm.fuse(*doorway, rig="nomad200", preset="paper")
    assert Counter(echoes["kind"].tolist()) == Counter(echo.kind for echo in expected.echoes)
    assert Counter(echoes["kind"].tolist()) == {"median": 122, "single": 57, "center": 442}
    np.testing.assert_allclose(echoes["x"], [echo.x for echo in expected.echoes], rtol=0, atol=POSITION)
    np.testing.assert_allclose(echoes["y"], [echo.y for echo in expected.echoes], rtol=0, atol=POSITION)
