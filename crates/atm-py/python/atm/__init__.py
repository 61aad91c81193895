"""Sharp echo points from wide-beam range sensors on a moving robot: the arc-transversal median.

H. Choset, K. Nagatani, N. A. Lazar, "The Arc-Transversal Median Algorithm: A Geometric Approach to Increasing
Ultrasonic Sensor Azimuth Accuracy", IEEE Transactions on Robotics and Automation 19(3), 2003.

Arrays in, arrays out: :func:`fuse`, :func:`crossings`. Tables: :func:`fuse_table`. Files: :func:`fuse_file`. Reading by
reading: :class:`Fuser`. Sensors: :class:`Rig`, :class:`Sensor`. What to expect: :func:`plan`. Pictures: :mod:`atm.plot`. A replay
in the browser or notebook: :func:`view`.
Worlds and scores: :func:`simulate`, :func:`evaluate`, :func:`compare`.

Metres, radians; times are float seconds or int nanoseconds.
"""

from typing import TYPE_CHECKING

from atm._arrow import fuse_table
from atm._atm import (
    Echo,
    Fuser,
    Rig,
    Sensor,
    __version__,
    compare,
    crossings,
    evaluate,
    fuse,
    fuse_file,
    plan,
    simulate,
)
from atm._view import Replay, view

if TYPE_CHECKING:
    from types import ModuleType

__all__ = [
    "Echo",
    "Fuser",
    "Replay",
    "Rig",
    "Sensor",
    "__version__",
    "compare",
    "crossings",
    "evaluate",
    "fuse",
    "fuse_file",
    "fuse_table",
    "plan",
    "simulate",
    "view",
]


def __getattr__(name: str) -> "ModuleType":
    # atm.plot needs matplotlib, which is loaded where it is asked for.
    if name == "plot":
        import importlib

        return importlib.import_module("atm.plot")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
