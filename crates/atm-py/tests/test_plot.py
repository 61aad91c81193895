"""`atm.plot`: what is drawn where, on the axes that are given, and nothing shown."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import atm
import atm.plot

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

Readings = tuple[np.ndarray, ...]


@pytest.fixture
def ax(monkeypatch: pytest.MonkeyPatch) -> Any:
    def shown(*_: Any, **__: Any) -> None:
        raise AssertionError("a picture was shown")

    monkeypatch.setattr(plt, "show", shown)
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def drawn(axes: Any) -> dict[str, np.ndarray]:
    """Offsets of the marks, by the kind in their label."""
    return {mark.get_label().split(":")[0]: np.asarray(mark.get_offsets()) for mark in axes.collections}


def test_every_echo_is_drawn_by_its_kind(doorway: Readings, ax: Any) -> None:
    echoes = atm.fuse(*doorway, rig="nomad200", on_two="mean")
    plt.figure()
    assert atm.plot.echoes(echoes, ax) is ax
    marks = drawn(ax)
    assert set(marks) == set(echoes["kind"])
    for kind, places in marks.items():
        chosen = echoes[echoes["kind"] == kind]
        np.testing.assert_array_equal(places, np.stack([chosen["x"], chosen["y"]], axis=1))
    assert plt.gcf().axes == [], "something was drawn on the current figure"
    assert ax.get_aspect() == 1.0
    labels = {text.get_text() for text in ax.get_legend().get_texts()}
    assert "median: 253" in labels


def test_only_some_kinds(doorway: Readings, ax: Any) -> None:
    atm.plot.echoes(atm.fuse(*doorway, rig="nomad200"), ax, kinds=("median", "single"), legend=False)
    assert set(drawn(ax)) == {"median", "single"}
    assert ax.get_legend() is None
    with pytest.raises(ValueError, match="medium"):
        atm.plot.echoes(atm.fuse(*doorway, rig="nomad200"), ax, kinds=("medium",))


def test_lists_of_echoes_and_tables(doorway: Readings, ax: Any) -> None:
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    fuser = atm.Fuser("nomad200")
    as_list = fuser.push(*doorway) + fuser.finish()
    echoes = atm.fuse(*doorway, rig="nomad200")
    for found in (as_list, pandas.DataFrame(echoes), polars.from_numpy(echoes), echoes):
        ax.clear()
        atm.plot.echoes(found, ax)
        assert sum(map(len, drawn(ax).values())) == len(echoes)


def test_nothing_to_draw(ax: Any) -> None:
    atm.plot.echoes([], ax)
    atm.plot.arcs([], [], [], [], [], [], rig=atm.Rig.builtin("nomad200"), ax=ax)
    ax.figure.canvas.draw()


def test_style_is_handed_on(doorway: Readings, ax: Any) -> None:
    atm.plot.echoes(atm.fuse(*doorway, rig="nomad200"), ax, kinds=("median",), color="red", s=9)
    (marks,) = ax.collections
    assert marks.get_sizes().tolist() == [9]
    np.testing.assert_array_equal(marks.get_edgecolor()[0][:3], [1, 0, 0])


def test_arcs_are_where_the_sensors_saw_them(ax: Any) -> None:
    """One sensor 0.1 m ahead that looks left, on a robot at (1, 2) turned by 90°: it looks to -x from (1, 2.1)."""
    sensor = atm.Sensor("a", x=0.1, yaw=np.pi / 2, field_of_view=np.deg2rad(40), max_range=3.0)
    rig = atm.Rig.from_sensors([sensor])
    ranges = [2.0, 3.0, np.inf, np.nan, 0.0]
    n = len(ranges)
    atm.plot.arcs(range(n), ["a"] * n, ranges, [1.0] * n, [2.0] * n, [np.pi / 2] * n, rig=rig, ax=ax)
    (lines,) = ax.collections
    (arc,) = lines.get_segments()
    np.testing.assert_allclose(np.hypot(arc[:, 0] - 1, arc[:, 1] - 2.1), 2.0)
    np.testing.assert_allclose(arc[len(arc) // 2], [-1.0, 2.1], atol=1e-12)
    spread = np.rad2deg(np.arctan2(arc[:, 1] - 2.1, -(arc[:, 0] - 1)))
    np.testing.assert_allclose([spread.min(), spread.max()], [-20, 20])


def test_echoes_lie_on_their_arcs(doorway: Readings, ax: Any) -> None:
    rig = atm.Rig.builtin("nomad200")
    atm.plot.arcs(*doorway, rig=rig, ax=ax, crossings=atm.crossings(*doorway, rig=rig))
    lines, dots = ax.collections
    assert len(lines.get_segments()) == 686
    points = np.concatenate(lines.get_segments())
    places = np.concatenate([np.asarray(dots.get_offsets())[::20], np.stack([
        atm.fuse(*doorway, rig=rig)[name] for name in ("x", "y")
    ], axis=1)[::20]])
    for place in places:
        # Half a chord of a beam of 22.5° at 6.5 m.
        assert np.min(np.hypot(*(points - place).T)) < 0.09


def test_arcs_refuse_what_fuse_refuses(doorway: Readings, ax: Any) -> None:
    t, sensor, *rest = (column[:20].copy() for column in doorway)
    rig = atm.Rig.builtin("nomad200")
    unknown = sensor.copy()
    unknown[7:9] = 99
    with pytest.raises(ValueError, match=r"sensor\[7\].*99"):
        atm.plot.arcs(t, unknown, *rest, rig=rig, ax=ax)
    with pytest.raises(ValueError, match=r"sensor_index\[7\].*99"):
        atm.plot.arcs(t, None, *rest, rig=rig, sensor_index=unknown, ax=ax)
    with pytest.raises(ValueError, match="yaw"):
        atm.plot.arcs(t, sensor, *rest[:-1], rest[-1][:5], rig=rig, ax=ax)


def test_current_axes_by_default(doorway: Readings, ax: Any) -> None:
    plt.sca(ax)
    assert atm.plot.echoes(atm.fuse(*doorway, rig="nomad200")) is ax


WITHOUT = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "matplotlib":
            raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")
sys.meta_path.insert(0, Missing())
import atm, atm.plot
for call in (lambda: atm.plot.echoes([]), lambda: atm.plot.arcs([], [], [], [], [], [], rig=atm.Rig.builtin("nomad200"))):
    try:
        call()
    except ImportError as error:
        assert "atm-py[plot]" in str(error), error
    else:
        raise AssertionError("drew without matplotlib")
"""


def test_without_matplotlib_it_says_how_to_get_it() -> None:
    subprocess.run([sys.executable, "-c", WITHOUT], check=True, timeout=60)


def test_importing_the_package_imports_no_matplotlib() -> None:
    line = "import sys, atm, atm.plot; assert not any(name.startswith('matplotlib') for name in sys.modules)"
    subprocess.run([sys.executable, "-c", line], check=True, timeout=60)
