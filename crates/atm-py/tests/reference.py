"""The arc-transversal median a second time: numpy and plain loops, and none of the package's code.

Other formulas on purpose. The package intersects circles with square roots and never computes an angle; here everything is
angles: the law of cosines gives where a partner's circle cuts an arc, the crossing angle is measured between the two radii,
and the median is taken of the azimuths themselves. Who met whom is worked out from the whole log at once, not reading by
reading.

Times are integer nanoseconds, lengths metres, angles radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]


@dataclass(frozen=True)
class Mount:
    """A sensor: its pose on the robot, its full beam, its limits and the step of its ranges."""

    x: float
    y: float
    yaw: float
    field_of_view: float
    min_range: float
    max_range: float
    range_resolution: float


@dataclass(frozen=True)
class Method:
    """What the method leaves open, with the paper's choices."""

    history: int = 10
    min_angle: float = np.pi / 6
    emit: str = "settled"
    on_none: str = "center"
    on_two: str = "drop"
    max_age_ns: int | None = None
    max_travel: float | None = None
    min_step: float | None = None
    drop_held: bool = False


@dataclass(frozen=True)
class Log:
    """Readings in the order of their arrival; `sensor` is the index of the mount."""

    t: NDArray[np.int64]
    sensor: IndexArray
    range: FloatArray
    x: FloatArray
    y: FloatArray
    yaw: FloatArray

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, chosen: slice | IndexArray) -> Log:
        poses = (self.x[chosen], self.y[chosen], self.yaw[chosen])
        return Log(self.t[chosen], self.sensor[chosen], self.range[chosen], *poses)


@dataclass(frozen=True)
class Echo:
    """One echo; `margin` is how far its closest decision was from going the other way (radians, or relative for lengths)."""

    reading: int
    t: int
    sensor: int
    x: float
    y: float
    kind: str
    range: float
    azimuth: float
    crossings: int
    resolution: float
    significance: float
    margin: float


@dataclass(frozen=True)
class Crossing:
    """One transversal crossing on the arc of a reading."""

    reading: int
    other: int
    x: float
    y: float
    azimuth: float
    angle: float


@dataclass(frozen=True)
class Arcs:
    """Every reading as an arc; where `is_echo` is false there is none."""

    x: FloatArray
    y: FloatArray
    heading: FloatArray
    radius: FloatArray
    half_beam: FloatArray
    interval: FloatArray
    is_echo: NDArray[np.bool_]


def arcs_of(log: Log, mounts: Sequence[Mount], min_angle: float) -> Arcs:
    """Mount after robot pose, as complex numbers; the interval is L(min_angle) = δ (1/sin + 1/tan)."""

    def column(name: str) -> FloatArray:
        return np.array([getattr(mount, name) for mount in mounts])[log.sensor]

    place = log.x + 1j * log.y + (column("x") + 1j * column("y")) * np.exp(1j * log.yaw)
    is_echo = (log.range > 0) & (log.range >= column("min_range")) & (log.range < column("max_range"))
    return Arcs(
        x=place.real,
        y=place.imag,
        heading=log.yaw + column("yaw"),
        radius=np.where(is_echo, log.range, 1.0),
        half_beam=column("field_of_view") / 2,
        interval=column("range_resolution") * (1 / np.sin(min_angle) + 1 / np.tan(min_angle)),
        is_echo=is_echo,
    )


def folded(angle: FloatArray) -> FloatArray:
    """The same direction within ±π."""
    turned: FloatArray = np.angle(np.exp(1j * angle))
    return turned


@dataclass(frozen=True)
class Found:
    """The transversal crossings on one arc, and how close any candidate was to the other side of a threshold."""

    azimuth: FloatArray
    angle: FloatArray
    other: IndexArray
    margin: float


def crossings_on(arcs: Arcs, a: int, partners: IndexArray, min_angle: float) -> Found:
    """Crosses the arc `a` with its partners: triangle sensor – sensor – crossing, law of cosines at both sensors."""
    b = partners[arcs.is_echo[partners]]
    ahead = arcs.x[b] - arcs.x[a] + 1j * (arcs.y[b] - arcs.y[a])
    d = np.abs(ahead)
    b, ahead, d = b[d > 0], ahead[d > 0], d[d > 0]
    ra, rb = arcs.radius[a], arcs.radius[b]
    with np.errstate(over="ignore"):
        # Sensors that all but coincide: their circles don't meet, or not transversally.
        cos_at_a = (ra**2 + d**2 - rb**2) / (2 * ra * d)
        cos_at_b = (rb**2 + d**2 - ra**2) / (2 * rb * d)
    meets = (np.abs(cos_at_a) <= 1) & (np.abs(cos_at_b) <= 1)
    b, ahead = b[meets], ahead[meets]
    at_a, at_b = np.arccos(cos_at_a[meets]), np.arccos(cos_at_b[meets])

    azimuths, angles, others, margins = [], [], [], [np.inf]
    for side in (1.0, -1.0):
        bearing_a = np.angle(ahead) + side * at_a
        bearing_b = np.angle(-ahead) - side * at_b
        azimuth_a = folded(bearing_a - arcs.heading[a])
        azimuth_b = folded(bearing_b - arcs.heading[b])
        apart = np.abs(folded(bearing_a - bearing_b))
        angle = np.minimum(apart, np.pi - apart)
        slack = np.stack(
            (arcs.half_beam[a] - np.abs(azimuth_a), arcs.half_beam[b] - np.abs(azimuth_b), angle - min_angle)
        )
        inside = np.all(slack >= 0, axis=0)
        azimuths.append(azimuth_a[inside])
        angles.append(angle[inside])
        others.append(b[inside])
        # A crossing that counts may lose by its smallest slack; one that does not has to make good its worst.
        margins += list(np.abs(slack.min(axis=0)))
    azimuth, angle, other = np.concatenate(azimuths), np.concatenate(angles), np.concatenate(others)
    return Found(azimuth, angle, other, float(np.min(margins)))


def echo_of(log: Log, arcs: Arcs, a: int, found: Found, method: Method) -> Echo | None:
    """The table of Section III-B: what the crossings on one arc make of it."""
    interval, radius = float(arcs.interval[a]), float(arcs.radius[a])
    length = 2 * float(arcs.half_beam[a]) * radius
    count = len(found.azimuth)
    margin = min(found.margin, abs(length - interval) / length)
    azimuth, resolution, significance = 0.0, length, 1.0
    if length <= interval:
        kind = "near"
    elif count == 0:
        if method.on_none == "drop":
            return None
        kind = "center"
    else:
        spread = 0.0
        if count == 2:
            if method.on_two == "drop":
                return None
            kind = "pair"
            spread = float(np.ptp(found.azimuth)) * radius
        else:
            kind = "single" if count == 1 else "median"
        if not (kind == "pair" and method.on_two == "center"):
            azimuth = float(np.median(found.azimuth))
            resolution = interval + spread
        away = np.abs(found.azimuth - azimuth) * radius - interval / 2
        margin = min(margin, float(np.min(np.abs(away))) / length)
        significance = (interval / length) ** int(np.sum(away <= 0))
    bearing = float(arcs.heading[a]) + azimuth
    return Echo(
        reading=a,
        t=int(log.t[a]),
        sensor=int(log.sensor[a]),
        x=float(arcs.x[a]) + radius * float(np.cos(bearing)),
        y=float(arcs.y[a]) + radius * float(np.sin(bearing)),
        kind=kind,
        range=radius,
        azimuth=azimuth,
        crossings=count,
        resolution=resolution,
        significance=significance,
        margin=margin,
    )


def that_take_a_slot(log: Log, mounts: Sequence[Mount], method: Method) -> IndexArray:
    """Indices of the readings that are neither held nor taken too close to their sensor's last one in the local map."""
    arcs = arcs_of(log, mounts, method.min_angle)
    path = path_of(log)
    value_before: dict[int, float] = {}
    last_of: dict[int, int] = {}
    taken: list[int] = []
    for k in range(len(log)):
        sensor = int(log.sensor[k])
        value = float(log.range[k]) if arcs.is_echo[k] else np.inf
        skipped = method.drop_held and value_before.get(sensor) == value
        value_before[sensor] = value
        last = last_of.get(sensor)
        if method.min_step is not None and last is not None and not _is_sent_away(log, path, last, taken, method):
            step = np.hypot(arcs.x[k] - arcs.x[last], arcs.y[k] - arcs.y[last])
            skipped = skipped or bool(step < method.min_step)
        if not skipped:
            last_of[sensor] = k
            taken.append(k)
    return np.array(taken, dtype=np.intp)


def _is_sent_away(log: Log, path: FloatArray, last: int, taken: list[int], method: Method) -> bool:
    """Whether the last reading of a sensor has left because of others: a skipped reading sends nobody away."""
    later = np.array([k for k in taken if k > last], dtype=np.intp)
    if len(later) == 0:
        return False
    newest = later[-1]
    return bool(
        np.max(np.bincount(log.sensor[later])) >= 4 * method.history
        or (method.max_age_ns is not None and log.t[newest] - log.t[last] > method.max_age_ns)
        or (method.max_travel is not None and path[newest] - path[last] > method.max_travel)
    )


def departures(log: Log, method: Method, path: FloatArray) -> IndexArray:
    """The arrival at which each reading leaves the local map; the length of the log for those that never do."""
    n = len(log)
    leaves = np.full(n, n, dtype=np.intp)
    arrivals = {int(sensor): np.flatnonzero(log.sensor == sensor) for sensor in np.unique(log.sensor)}
    for k in range(n):
        for sensor, at in arrivals.items():
            later = at[at > k]
            allowed = method.history if sensor == log.sensor[k] else 4 * method.history
            if len(later) >= allowed:
                leaves[k] = min(leaves[k], later[allowed - 1])
        for new in range(k + 1, int(leaves[k])):
            too_old = method.max_age_ns is not None and log.t[new] - log.t[k] > method.max_age_ns
            too_far = method.max_travel is not None and path[new] - path[k] > method.max_travel
            if too_old or too_far:
                leaves[k] = new
                break
    return leaves


def path_of(log: Log) -> FloatArray:
    """Path length of the robot up to each reading."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(log.x), np.diff(log.y)))))[: len(log)]


@dataclass(frozen=True)
class Fused:
    """Echoes and crossings in the order they are reported, and the smallest margin of any decision."""

    echoes: list[Echo]
    crossings: list[Crossing]
    margin: float


def fuse(log: Log, mounts: Sequence[Mount], method: Method) -> Fused:
    """Fuses a whole log. An echo's `reading` is its place among the readings that took a slot."""
    taken = that_take_a_slot(log, mounts, method)
    path = path_of(log)[taken]
    log = log[taken]
    leaves = departures(log, method, path)
    index = np.arange(len(log))
    if method.emit == "settled":
        order = np.lexsort((index, leaves))
        met = [np.flatnonzero(((index < k) & (leaves > k)) | ((index > k) & (index < leaves[k]))) for k in index]
    else:
        order = index
        met = [np.flatnonzero((index < k) & (leaves > k)) for k in index]
    return _report(log, mounts, method, order, met)


def snapshot(log: Log, mounts: Sequence[Mount], method: Method) -> Fused:
    """Every arc that is in the local map after the last reading, against the others there."""
    taken = that_take_a_slot(log, mounts, method)
    path = path_of(log)[taken]
    log = log[taken]
    here = np.flatnonzero(departures(log, method, path) == len(log))
    met = [here[here != k] for k in range(len(log))]
    return _report(log, mounts, method, here, met)


def _report(log: Log, mounts: Sequence[Mount], method: Method, order: IndexArray, met: list[IndexArray]) -> Fused:
    arcs = arcs_of(log, mounts, method.min_angle)
    echoes, crossings, margins = [], [], [np.inf]
    for a in map(int, order):
        if not arcs.is_echo[a]:
            continue
        found = crossings_on(arcs, a, met[a], method.min_angle)
        margins.append(found.margin)
        for azimuth, angle, other in zip(found.azimuth, found.angle, found.other):
            point = arcs.x[a] + 1j * arcs.y[a] + arcs.radius[a] * np.exp(1j * (arcs.heading[a] + azimuth))
            crossings.append(Crossing(a, int(other), point.real, point.imag, float(azimuth), float(angle)))
        echo = echo_of(log, arcs, a, found, method)
        if echo is not None:
            margins.append(echo.margin)
            echoes.append(echo)
    return Fused(echoes, crossings, float(min(margins)))
