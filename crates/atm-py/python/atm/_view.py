"""A drive as a page: `atm.view`."""

from __future__ import annotations

import html
import os
import pathlib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

from atm import _atm

if TYPE_CHECKING:
    from . import Rig

    _Path = str | os.PathLike[str]
    _Method = Literal["centerline", "atm", "consensus"]

__all__ = ["Replay", "view"]


class Replay:
    """A page that replays a drive: shown where a notebook shows the value of a cell, written by :func:`view` or :meth:`save`.

    Attributes
    ----------
    html : str
        The page, whole: it needs no network and no other file.
    path : pathlib.Path or None
        Where it was written.
    """

    def __init__(self, page: str, path: pathlib.Path | None = None, height: int = 720) -> None:
        self.html = page
        self.path = path
        self._height = height

    def save(self, path: _Path) -> pathlib.Path:
        """Write the page to a file, and return its path."""
        self.path = pathlib.Path(path)
        self.path.write_text(self.html, encoding="utf-8")
        return self.path

    def _repr_html_(self) -> str:
        # A frame of its own: the page's styles and keys stay in it.
        page = html.escape(self.html, quote=True)
        style = f"width:100%;height:{self._height}px;border:0"
        return f'<iframe title="replay of a drive" style="{style}" srcdoc="{page}"></iframe>'

    def __repr__(self) -> str:
        where = f" in {str(self.path)!r}" if self.path else ""
        return f"<atm.Replay of {len(self.html) // 1000} kB{where}>"


def view(
    input: _Path,
    *,
    rig: Rig | _Path | None = None,
    output: _Path | None = None,
    poses: _Path | None = None,
    world: _Path | None = None,
    set: dict[str, str | float] | None = None,
    truth: _Path | None = None,
    methods: Iterable[_Method] | str | None = None,
    history: int | None = None,
    reach: float | str | None = None,
    preset: Literal["paper"] | None = None,
    min_angle: float | str | None = None,
    range_resolution: float | str | None = None,
    range_error: float | str | None = None,
    units: Literal["metric", "inches"] | None = None,
    height: int = 720,
) -> Replay:
    """Replay a log in the browser, or in the notebook: what ``atm view`` does.

    Parameters
    ----------
    input
        The log: a table or a recording.
    rig
        The sensors: a `Rig`, a built-in rig's name, or a TOML file. A table needs one; a recording says it itself.
    output
        Where the page is written; without, it is only shown.
    poses
        A trajectory in a second file, CSV ``t,x,y,yaw`` or TUM.
    world, set
        The walls, where they are known: a built-in world or a TOML file, and its parameters, ``{"opening": "36in"}``.
    truth
        A table of where each echo really came from, as ``atm simulate --truth`` writes it.
    methods
        What the panels can show, of "centerline", "atm", "consensus"; without, all.
    history, reach, preset, min_angle, range_resolution, range_error
        As in `fuse_file`.
    units
        Of lengths shown: "metric" or "inches"; without, those of the sensors.
    height
        Of the frame in a notebook, in pixels.

    Returns
    -------
    Replay
        The page, which a notebook shows.

    Raises
    ------
    OSError
        A file can't be read or written.
    ValueError
        What is in a file is no log, rig or world, or an option is out of its domain; in the command's words.

    Warns
    -----
    UserWarning
        Records that could not be used; more than 300,000 readings, which are thinned.

    Examples
    --------
    >>> import atm, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     log = pathlib.Path(directory, "drive.csv")
    ...     _ = log.write_text("t,sensor,range,x,y,yaw\\n0,0,2.5,0,0,0\\n0.1,0,2.4,0.1,0,0\\n")
    ...     replay = atm.view(log, rig="nomad200", output=log.with_suffix(".html"))
    ...     replay.path.name
    'drive.html'
    """
    options: dict[str, Any] = {
        "rig": rig,
        "poses": poses,
        "world": world,
        "set": set,
        "truth": truth,
        "methods": methods,
        "history": history,
        "reach": reach,
        "preset": preset,
        "min_angle": min_angle,
        "range_resolution": range_resolution,
        "range_error": range_error,
        "units": units,
    }
    given = {name: value for name, value in options.items() if value is not None}
    said = {name: os.fspath(value) if isinstance(value, os.PathLike) else value for name, value in given.items()}
    words = ", ".join([repr(os.fspath(input)), *(f"{name}={value!r}" for name, value in said.items())])
    replay = Replay(_atm._view(input, f"atm.view({words})", **given), height=height)
    if output is not None:
        replay.save(output)
    return replay
