"""Pictures of arcs, crossings and echoes, drawn with matplotlib as the figures of the paper are.

Thin grey arcs and dots where they cross (Fig. 16), and a mark for each echo by its kind (Fig. 17). matplotlib is imported at the first
call and comes with ``pip install 'atm-py[plot]'``. Nothing is shown or saved: that is up to the caller.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from . import Rig

__all__ = ["arcs", "echoes"]

# The library's table of styles, which a test holds this one against. Drawn from the back to the front, so that what is good enough to
# drive by lies on top.
_STYLES: dict[str, dict[str, Any]] = {
    "center": {"marker": "o", "s": 6, "color": "#d55e00", "linewidths": 0},
    "near": {"marker": "s", "s": 9, "color": "#b55d8d", "linewidths": 0},
    "pair": {"marker": "^", "s": 16, "color": "#b07a00", "linewidths": 0},
    "single": {"marker": "+", "s": 40, "color": "#111111", "linewidths": 1.0},
    "median": {"marker": "o", "s": 14, "color": "#0072b2", "linewidths": 0},
    "wall": {"marker": "v", "s": 16, "color": "#008a65", "linewidths": 0},
    "point": {"marker": "D", "s": 12, "color": "#0072b2", "linewidths": 0},
}
_CROSSINGS = "#2b87b8"
# A chord of a sixteenth of a beam of 180° leaves its arc by less than half a percent of the range.
_CHORDS = 16


def echoes(
    echoes: Any,
    ax: Axes | None = None,
    *,
    kinds: Collection[str] | None = None,
    legend: bool = True,
    **style: Any,
) -> Axes:
    """Draw echo points, each kind by its own mark, in the colours of ``atm draw``.

    Parameters
    ----------
    echoes
        What `atm.fuse` gives, a table with the columns ``x``, ``y`` and ``kind`` (pandas, polars, a dict of arrays), or a
        sequence of `atm.Echo`. Positions in metres.
    ax
        The axes to draw on; without, the current ones of pyplot.
    kinds
        Only these kinds, such as ``("median", "single")``; without, all.
    legend
        Whether to add a legend that names the kinds and counts their echoes.
    **style
        Handed to `matplotlib.axes.Axes.scatter`, over the marks' own.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, with equal scales.

    Raises
    ------
    ImportError
        If matplotlib is not installed.
    ValueError
        If `kinds` names a kind that does not exist.

    Notes
    -----
    Both estimators' kinds are drawn: ``median``, ``single``, ``center``, ``near`` and ``pair``, and the consensus's ``point`` and ``wall``.

    Examples
    --------
    >>> import atm.plot
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> ax = atm.plot.echoes({"x": [1.0, 2.0], "y": [0.0, 0.5], "kind": ["median", "center"]}, ax)
    >>> ax.get_legend_handles_labels()[1]
    ['center: 1', 'median: 1']
    """
    if kinds is not None:
        for kind in kinds:
            if kind not in _STYLES:
                raise ValueError(f"kinds: there is no kind {kind!r}; there are {', '.join(_STYLES)}")
    ax = _axes(ax)
    x, y, kind_of = (_column(echoes, name) for name in ("x", "y", "kind"))
    drawn = False
    for kind, marks in _STYLES.items():
        chosen = kind_of == kind
        if (kinds is None or kind in kinds) and np.any(chosen):
            ax.scatter(x[chosen], y[chosen], **{"label": f"{kind}: {np.count_nonzero(chosen)}", **marks, **style})
            drawn = True
    if legend and drawn:
        ax.legend(fontsize="small")
    return _in_metres(ax)


def arcs(
    t: ArrayLike,
    sensor: ArrayLike | None,
    range_: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    yaw: ArrayLike,
    *,
    rig: Rig,
    sensor_index: ArrayLike | None = None,
    ax: Axes | None = None,
    crossings: Any = None,
    field_of_view: float = np.deg2rad(22.5),
    color: Any = "0.7",
    linewidth: float = 0.4,
    **style: Any,
) -> Axes:
    """Draw the arc of every reading with an echo, and the crossings on them.

    Parameters
    ----------
    t, sensor, range_, x, y, yaw
        The arrays that `atm.fuse` takes, of one length: metres, radians, and the robot's poses. Times are not drawn; they are
        here so that the call reads like that of `fuse`.
    rig
        Where the sensors sit and what they see.
    sensor_index
        Places of the sensors in the rig, from 0, instead of ids; with ``sensor=None``.
    ax
        The axes to draw on; without, the current ones of pyplot.
    crossings
        What `atm.crossings` gives, or any table with the columns ``x`` and ``y``: drawn as dots.
    field_of_view
        The full beam of sensors of which the rig does not say it, in radians.
    color, linewidth, **style
        Of the arcs, handed to `matplotlib.collections.LineCollection`.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, with equal scales.

    Raises
    ------
    ImportError
        If matplotlib is not installed.
    ValueError
        If the arrays differ in length, or a sensor is not in the rig.

    Notes
    -----
    Fig. 16 of Choset, Nagatani and Lazar (2003).
    """
    ax = _axes(ax)
    from matplotlib.collections import LineCollection

    index = _mount_indices(sensor, sensor_index, rig)
    lines = _arc_points(index, _columns(index, t=t, range_=range_, x=x, y=y, yaw=yaw), rig, field_of_view)
    # Behind echoes, whichever is drawn first.
    ax.add_collection(LineCollection(list(lines), **{"color": color, "linewidth": linewidth, "zorder": 0.9, **style}))
    if crossings is not None:
        ax.scatter(_column(crossings, "x"), _column(crossings, "y"), s=3, color=_CROSSINGS, linewidths=0)
    ax.autoscale_view()
    return _in_metres(ax)


def _columns(index: NDArray[np.intp], **given: ArrayLike) -> dict[str, NDArray[np.float64]]:
    """The readings as arrays of the sensors' length."""
    columns = {name: np.asarray(column, dtype=np.float64) for name, column in given.items()}
    for name, column in columns.items():
        if column.shape != index.shape:
            raise ValueError(f"{name}: shape {column.shape}, but the sensors' is {index.shape}")
    return columns


def _arc_points(
    index: NDArray[np.intp], columns: dict[str, NDArray[np.float64]], rig: Rig, field_of_view: float
) -> NDArray[np.float64]:
    """Points along every arc, of shape (arcs, chords + 1, 2)."""
    mounts = rig.sensors

    def of_mount(values: Iterable[float]) -> NDArray[np.float64]:
        return np.fromiter(values, dtype=np.float64)[index]

    beam = of_mount(field_of_view if mount.field_of_view is None else mount.field_of_view for mount in mounts)
    lowest, highest = of_mount(mount.min_range for mount in mounts), of_mount(mount.max_range for mount in mounts)
    ahead, left = of_mount(mount.x for mount in mounts), of_mount(mount.y for mount in mounts)
    r, heading = columns["range_"], columns["yaw"]
    cos, sin = np.cos(heading), np.sin(heading)
    center_x, center_y = columns["x"] + cos * ahead - sin * left, columns["y"] + sin * ahead + cos * left
    # A reading at its maximum is no echo, and neither is one of 0, NaN or infinity.
    seen = (r > 0) & (r >= lowest) & (r < highest)
    bearing = (heading + of_mount(mount.yaw for mount in mounts))[seen, None]
    bearing = bearing + beam[seen, None] * np.linspace(-0.5, 0.5, _CHORDS + 1)
    x = center_x[seen, None] + r[seen, None] * np.cos(bearing)
    y = center_y[seen, None] + r[seen, None] * np.sin(bearing)
    return np.stack((x, y), axis=-1)


def _mount_indices(sensor: ArrayLike | None, sensor_index: ArrayLike | None, rig: Rig) -> NDArray[np.intp]:
    """Place in the rig of every reading's sensor; a whole number stands for the id that reads like it."""
    if (sensor is None) == (sensor_index is None):
        raise ValueError("sensor: give either ids, or None and sensor_index")
    if sensor_index is not None:
        name, given, known = "sensor_index", np.asarray(sensor_index), [str(place) for place in range(len(rig.sensors))]
    else:
        name, given, known = "sensor", np.asarray(sensor), [mount.id for mount in rig.sensors]
    place_of = {text: place for place, text in enumerate(known)}
    distinct, which = np.unique(given, return_inverse=True)
    places = [place_of.get(str(item), -1) for item in distinct.tolist()]
    found = np.array(places, dtype=np.intp)[which.reshape(given.shape)]
    if np.any(found < 0):
        first = int(np.argmax(found < 0))
        raise ValueError(f"{name}[{first}]: the rig has no sensor {given.ravel()[first].item()!r}")
    return found


def _column(table: Any, name: str) -> NDArray[Any]:
    """A column of a table, or that attribute of every item of a sequence."""
    if isinstance(table, (list, tuple)):
        return np.array([getattr(item, name) for item in table])
    return np.atleast_1d(np.asarray(table[name]))


def _axes(ax: Axes | None) -> Axes:
    """The given axes, or the current ones; says how to get matplotlib where it is missing."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as missing:
        raise ImportError("drawing needs matplotlib: pip install 'atm-py[plot]'") from missing
    return plt.gca()


def _in_metres(ax: Axes) -> Axes:
    """Equal scales on both axes: a metre is a metre. Labels that are there already stay."""
    ax.set_aspect("equal", adjustable="box")
    if not ax.get_xlabel():
        ax.set_xlabel("x (m)")
    if not ax.get_ylabel():
        ax.set_ylabel("y (m)")
    return ax
