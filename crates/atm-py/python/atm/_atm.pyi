from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Echo",
    "Fuser",
    "Rig",
    "Sensor",
    "__version__",
    "_main",
    "_restore_rig",
    "_restore_sensor",
    "_view",
    "compare",
    "crossings",
    "evaluate",
    "fuse",
    "fuse_file",
    "plan",
    "simulate",
]

__version__: str

_Emit = Literal["settled", "latest"]
_Kind = Literal["median", "single", "center", "near", "pair", "point", "wall"]
_TimeUnit = Literal["s", "ms", "us", "ns"]
_Held = Literal["keep", "drop", "edges"]
_Estimator = Literal["atm", "consensus"]
_OnNone = Literal["center", "drop"]
_OnTwo = Literal["drop", "center", "mean"]
_Format = Literal["csv", "mcap"]
_Path = str | PathLike[str]
_Table = NDArray[np.void] | Mapping[str, ArrayLike]
_SensorParts = tuple[
    str, Sequence[float], float | None, float, float, float | None, str | None
]

class _Plan(TypedDict):
    interval_m: float
    improvement: float
    min_angle_rad: float
    close_range_m: float
    travel_m: float
    readings: int | None
    history_reach_m: float | None

@final
class Sensor:
    def __new__(
        cls,
        id: str,
        x: float = 0.0,
        y: float = 0.0,
        yaw: float = 0.0,
        *,
        field_of_view: float | None = None,
        min_range: float = 0.0,
        max_range: float = ...,
        range_resolution: float | None = None,
        topic: str | None = None,
    ) -> Sensor: ...
    @property
    def id(self) -> str: ...
    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def yaw(self) -> float: ...
    @property
    def field_of_view(self) -> float | None: ...
    @property
    def min_range(self) -> float: ...
    @property
    def max_range(self) -> float: ...
    @property
    def range_resolution(self) -> float | None: ...
    @property
    def topic(self) -> str | None: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Rig:
    @staticmethod
    def ring(
        count: int,
        radius: float,
        first_yaw: float = 0.0,
        field_of_view: float | None = None,
        min_range: float = 0.0,
        max_range: float = ...,
        range_resolution: float | None = None,
    ) -> Rig: ...
    @staticmethod
    def from_sensors(sensors: Iterable[Sensor], name: str = "rig") -> Rig: ...
    @staticmethod
    def from_toml(source: _Path) -> Rig: ...
    @staticmethod
    def builtin(name: str) -> Rig: ...
    @staticmethod
    def load(name_or_path: _Path) -> Rig: ...
    @property
    def name(self) -> str: ...
    @property
    def ids(self) -> tuple[str, ...]: ...
    @property
    def sensors(self) -> tuple[Sensor, ...]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: int, /) -> Sensor: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Echo:
    @property
    def t(self) -> float | int: ...
    @property
    def sensor(self) -> str: ...
    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def kind(self) -> _Kind: ...
    @property
    def range(self) -> float: ...
    @property
    def azimuth(self) -> float: ...
    @property
    def crossings(self) -> int: ...
    @property
    def resolution(self) -> float: ...
    @property
    def significance(self) -> float: ...
    @property
    def support(self) -> int | None: ...
    @property
    def against(self) -> int | None: ...
    @property
    def sigma_azimuth(self) -> float | None: ...
    @property
    def sigma_range(self) -> float | None: ...
    @property
    def normal_x(self) -> float | None: ...
    @property
    def normal_y(self) -> float | None: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Fuser:
    def __new__(
        cls,
        rig: Rig | _Path,
        history: int | Literal["auto"] | None = None,
        *,
        min_angle: float | None = None,
        range_resolution: float | None = None,
        field_of_view: float | None = None,
        emit: _Emit = "settled",
        on_none: _OnNone = "center",
        on_two: _OnTwo = "drop",
        max_age: float | None = None,
        max_travel: float | None = None,
        min_step: float | None = None,
        drop_held: bool = False,
        held: _Held | None = None,
        estimator: _Estimator = "atm",
        confidence: float | None = None,
        range_error: float | None = None,
        reach: float | None = None,
        preset: Literal["paper"] | None = None,
    ) -> Fuser: ...
    def push(
        self,
        t: ArrayLike,
        sensor: ArrayLike | None,
        range_: ArrayLike,
        x: ArrayLike,
        y: ArrayLike,
        yaw: ArrayLike,
        *,
        sensor_index: ArrayLike | None = None,
        t_unit: _TimeUnit | None = None,
    ) -> list[Echo]: ...
    def finish(self) -> list[Echo]: ...
    def snapshot(self) -> list[Echo]: ...

def fuse(
    t: ArrayLike,
    sensor: ArrayLike | None,
    range_: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    yaw: ArrayLike,
    *,
    rig: Rig | _Path,
    history: int | Literal["auto"] | None = None,
    min_angle: float | None = None,
    range_resolution: float | None = None,
    field_of_view: float | None = None,
    emit: _Emit = "settled",
    on_none: _OnNone = "center",
    on_two: _OnTwo = "drop",
    max_age: float | None = None,
    max_travel: float | None = None,
    min_step: float | None = None,
    drop_held: bool = False,
    keep: Iterable[_Kind] | str | None = None,
    sensor_index: ArrayLike | None = None,
    held: _Held | None = None,
    estimator: _Estimator = "atm",
    confidence: float | None = None,
    range_error: float | None = None,
    t_unit: _TimeUnit | None = None,
    reach: float | None = None,
    preset: Literal["paper"] | None = None,
) -> NDArray[np.void]: ...
def crossings(
    t: ArrayLike,
    sensor: ArrayLike | None,
    range_: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    yaw: ArrayLike,
    *,
    rig: Rig | _Path,
    history: int | Literal["auto"] | None = None,
    min_angle: float | None = None,
    range_resolution: float | None = None,
    field_of_view: float | None = None,
    emit: _Emit = "settled",
    on_none: _OnNone = "center",
    on_two: _OnTwo = "drop",
    max_age: float | None = None,
    max_travel: float | None = None,
    min_step: float | None = None,
    drop_held: bool = False,
    sensor_index: ArrayLike | None = None,
    t_unit: _TimeUnit | None = None,
    reach: float | None = None,
    preset: Literal["paper"] | None = None,
) -> NDArray[np.void]: ...
def fuse_file(
    input: _Path,
    *,
    rig: Rig | _Path | None = None,
    poses: _Path | None = None,
    output: _Path | None = None,
    summary: _Path | None = None,
    crossings: _Path | None = None,
    max_gap: float | str | None = None,
    history: int | Literal["auto"] | None = None,
    max_age: float | str | None = None,
    max_travel: float | str | None = None,
    min_step: float | str | None = None,
    empty: Literal["no-echo", "skip"] | None = None,
    min_angle: float | str | None = None,
    improvement: float | None = None,
    at: float | str | None = None,
    range_resolution: float | str | None = None,
    fov: float | str | None = None,
    emit: _Emit = "settled",
    on_none: _OnNone = "center",
    on_two: _OnTwo = "drop",
    keep: Iterable[_Kind] | str | None = None,
    drop_held: bool = False,
    strict: bool = False,
    from_: _Format | None = None,
    to: _Format | None = None,
    schema: Literal["foxglove", "ros2"] = "foxglove",
    passthrough: bool = False,
    range_topics: Iterable[str] | str | None = None,
    pose_topic: str | None = None,
    fixed_frame: str | None = None,
    clock: Literal["header", "log", "publish"] | None = None,
    reorder: float | str | None = None,
    max_message: int | None = None,
    progress: Callable[[int, int | None], object] | None = None,
    held: _Held | None = None,
    estimator: _Estimator = "atm",
    confidence: float | None = None,
    range_error: float | str | None = None,
    tf_topics: Iterable[str] | str | None = None,
    scan_topics: Iterable[str] | str | None = None,
    max_speed: float | str | None = None,
    range_unit: str | None = None,
    boresight: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    reach: float | str | None = None,
    preset: Literal["paper"] | None = None,
) -> dict[str, Any]: ...
def plan(
    distance: float,
    *,
    min_angle: float | None = None,
    improvement: float | None = None,
    field_of_view: float | None = None,
    range_resolution: float = 0.0254,
    speed: float | None = None,
    rate: float | None = None,
) -> _Plan: ...
def simulate(
    world: _Path,
    *,
    rig: Rig | _Path | None = None,
    seed: int = 1,
    set: dict[str, str | float] | None = None,
    noise: str | None = None,
    field_of_view: float | None = None,
) -> tuple[NDArray[np.void], NDArray[np.void]]: ...
def evaluate(
    echoes: _Table,
    world: _Path,
    *,
    truth: _Table | None = None,
    set: dict[str, str | float] | None = None,
) -> dict[str, Any]: ...
def compare(
    t: ArrayLike,
    sensor: ArrayLike | None,
    range_: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    yaw: ArrayLike,
    *,
    rig: Rig | _Path,
    world: _Path | None = None,
    truth: _Table | None = None,
    set: dict[str, str | float] | None = None,
    methods: Iterable[str] | str | None = None,
    history: int | Literal["auto"] | None = None,
    min_angle: float | None = None,
    range_resolution: float | None = None,
    field_of_view: float | None = None,
    drop_held: bool = False,
    range_error: float | None = None,
    cell: float | None = None,
    sensor_index: ArrayLike | None = None,
    reach: float | None = None,
    preset: Literal["paper"] | None = None,
) -> dict[str, dict[str, Any]]: ...
def _view(
    input: _Path,
    command: str,
    *,
    rig: Rig | _Path | None = None,
    poses: _Path | None = None,
    world: _Path | None = None,
    set: dict[str, str | float] | None = None,
    truth: _Path | None = None,
    methods: Iterable[str] | str | None = None,
    history: int | None = None,
    reach: float | str | None = None,
    preset: Literal["paper"] | None = None,
    min_angle: float | str | None = None,
    range_resolution: float | str | None = None,
    range_error: float | str | None = None,
    units: Literal["metric", "inches"] | None = None,
) -> str: ...
def _main(argv: Sequence[str]) -> int: ...
def _restore_rig(
    name: str, sensors: Sequence[_SensorParts], toml: tuple[str, str] | None
) -> Rig: ...
def _restore_sensor(
    id: str,
    mount: Sequence[float],
    field_of_view: float | None,
    min_range: float,
    max_range: float,
    range_resolution: float | None,
    topic: str | None,
) -> Sensor: ...
