"""Random rigs and drives for property tests, the same for the package, the command and the reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

import atm
from reference import Log, Method, Mount


@dataclass(frozen=True)
class Drive:
    """A rig and the readings of one drive."""

    mounts: tuple[Mount, ...]
    log: Log

    @property
    def rig(self) -> atm.Rig:
        """The rig, as the package takes it; ids are "s0", "s1", …"""
        return atm.Rig.from_sensors([
            atm.Sensor(
                f"s{index}",
                x=mount.x,
                y=mount.y,
                yaw=mount.yaw,
                field_of_view=mount.field_of_view,
                min_range=mount.min_range,
                max_range=mount.max_range,
                range_resolution=mount.range_resolution,
            )
            for index, mount in enumerate(self.mounts)
        ])

    @property
    def toml(self) -> str:
        """The rig, as the command takes it; every number is written so that it is read back as it was."""
        keys = ("x", "y", "yaw", "field_of_view", "min_range", "max_range", "range_resolution")
        lines = ['name = "drawn"']
        for index, mount in enumerate(self.mounts):
            lines += ["[[sensor]]", f'id = "s{index}"']
            for key in keys:
                unit = "rad" if key in ("yaw", "field_of_view") else "m"
                lines.append(f'{key} = "{getattr(mount, key)!r}{unit}"')
        return "\n".join(lines) + "\n"

    @property
    def csv(self) -> str:
        """The log as a long table, times as exact decimals."""
        rows = ["t,sensor,range,x,y,yaw"]
        for t, sensor, *numbers in zip(*self.columns):
            rows.append(",".join((f"{t // 10**9}.{t % 10**9:09d}", sensor, *map(repr, map(float, numbers)))))
        return "\n".join(rows) + "\n"

    @property
    def columns(self) -> tuple[np.ndarray, ...]:
        """The six arrays of `atm.fuse`; sensors by name, times in whole nanoseconds."""
        log = self.log
        names = np.array([f"s{index}" for index in log.sensor], dtype=np.str_)
        return log.t, names, log.range, log.x, log.y, log.yaw


def options(method: Method) -> dict[str, Any]:
    """The method's choices as keyword arguments of `atm.fuse`."""
    chosen: dict[str, Any] = {
        "history": method.history,
        "min_angle": method.min_angle,
        "emit": method.emit,
        "on_none": method.on_none,
        "on_two": method.on_two,
        "drop_held": method.drop_held,
    }
    if method.max_age_ns is not None:
        chosen["max_age"] = method.max_age_ns / 1e9
    if method.max_travel is not None:
        chosen["max_travel"] = method.max_travel
    if method.min_step is not None:
        chosen["min_step"] = method.min_step
    return chosen


def flags(method: Method) -> list[str]:
    """The same as flags of ``atm fuse``."""
    # Whatever the drives draw is a motion of the robot's.
    chosen = ["--max-speed", "1e9m/s", "--history", str(method.history), "--min-angle", f"{method.min_angle!r}rad", "--emit", method.emit]
    chosen += ["--on-none", method.on_none, "--on-two", method.on_two]
    if method.drop_held:
        chosen.append("--drop-held")
    if method.max_age_ns is not None:
        chosen += ["--max-age", f"{method.max_age_ns // 10**6}ms"]
    if method.max_travel is not None:
        chosen += ["--max-travel", f"{method.max_travel!r}m"]
    if method.min_step is not None:
        chosen += ["--min-step", f"{method.min_step!r}m"]
    return chosen


def real(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_infinity=False)


@st.composite
def methods(draw: st.DrawFn) -> Method:
    """Every option of the method; each further bound in a quarter of them."""
    by_age, by_travel, by_step = (draw(st.sampled_from([False, False, False, True])) for _ in range(3))
    return Method(
        history=draw(st.integers(1, 12)),
        min_angle=np.deg2rad(draw(real(3, 75))).item(),
        emit=draw(st.sampled_from(["settled", "latest"])),
        on_none=draw(st.sampled_from(["center", "drop"])),
        on_two=draw(st.sampled_from(["drop", "center", "mean"])),
        max_age_ns=draw(st.integers(1, 4000)) * 1_000_000 if by_age else None,
        max_travel=draw(real(0.01, 3)) if by_travel else None,
        min_step=draw(real(0.001, 0.2)) if by_step else None,
        drop_held=draw(st.sampled_from([False, False, True])),
    )


@st.composite
def drives(draw: st.DrawFn, longest: int = 70) -> Drive:
    """A few sensors that drive among poles: enough crossings for every kind, and readings of every sort."""
    mounts = tuple(
        Mount(
            x=draw(real(-0.5, 0.5)),
            y=draw(real(-0.5, 0.5)),
            yaw=draw(real(-3.2, 3.2)),
            field_of_view=np.deg2rad(draw(real(5, 179))).item(),
            min_range=draw(real(0.0, 0.3)),
            max_range=draw(real(2.0, 9.0)),
            range_resolution=draw(real(0.001, 0.1)),
        )
        for _ in range(draw(st.integers(1, 6)))
    )
    n = draw(st.integers(0, longest))
    # From a seed: exact coincidences, which hypothesis would look for, are no matter for a reference in floats.
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    step = draw(st.sampled_from([0.0, 0.02, 0.1, 0.4]))
    sensor = rng.integers(0, len(mounts), n)
    t = draw(st.integers(0, 10**18)) + np.cumsum(rng.integers(0, 300, n) * 1_000_000)
    heading = np.cumsum(rng.normal(0, 0.2, n))
    # No two steps of one length: the package counts path in whole units, and n equal ones may add up to a bound exactly.
    steps = step * rng.uniform(0.5, 1.5, n)
    x, y = np.cumsum(steps * np.cos(heading)), np.cumsum(steps * np.sin(heading))
    pole_x, pole_y = rng.uniform(-3, 3, (2, 5))
    distance = np.hypot(pole_x - x[:, None], pole_y - y[:, None])[np.arange(n), rng.integers(0, 5, n)]
    readings = np.where(rng.random(n) < 0.7, distance, rng.uniform(0.1, 6, n))
    specials = np.array([np.inf, -np.inf, np.nan, 0.0, 1e-3, 40.0, -1.0])
    readings = np.where(rng.random(n) < 0.1, rng.choice(specials, n), readings)
    # A ring that repeats held values.
    held = rng.random(n) < 0.1
    for k in np.flatnonzero(held):
        before = np.flatnonzero(sensor[:k] == sensor[k])
        if len(before):
            readings[k] = readings[before[-1]]
    return Drive(mounts, Log(t, sensor, readings, x, y, heading))
