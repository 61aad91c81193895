"""What can't be used is refused with the argument's name and the first index at fault; nothing is fused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import atm

NAMES = ("t", "sensor", "range_", "x", "y", "yaw")
REFUSED = (ValueError, TypeError)


def readings(n: int = 20) -> dict[str, Any]:
    """Good readings by name."""
    return {
        "t": np.arange(n, dtype=np.int64) * 10**8,
        "sensor": np.arange(n) % 16,
        "range_": np.full(n, 1.5),
        "x": np.linspace(0, 1, n),
        "y": np.zeros(n),
        "yaw": np.zeros(n),
    }


def refusal(expected: Any, call: Callable[[], Any]) -> str:
    """What the call is refused with; no word of Rust's."""
    with pytest.raises(expected) as caught:
        call()
    assert not isinstance(caught.value, atm.__dict__.get("PanicException", ()))
    message = str(caught.value)
    for word in ("panick", "unwrap", "RUST_BACKTRACE", "Option", "usize", "PyErr"):
        assert word not in message, message
    return message


def assert_names(message: str, argument: str, index: int | None = None) -> None:
    spelled = [argument] if index is None else [f"{argument}[{index}]"]
    assert any(word in message for word in spelled), message


def with_(**changes: Any) -> dict[str, Any]:
    return {**readings(), **changes}


def at(name: str, index: int, value: Any) -> dict[str, Any]:
    """Good readings with one item changed, and the one after it as well: the first has to be named."""
    columns = readings()
    columns[name] = columns[name].astype(np.float64) if isinstance(value, float) else columns[name].copy()
    columns[name][index : index + 2] = value
    return columns


@pytest.mark.parametrize("name", ["x", "y", "yaw"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_poses_that_are_no_numbers(name: str, value: float) -> None:
    message = refusal(ValueError, lambda: atm.fuse(**at(name, 7, value), rig="nomad200"))
    assert_names(message, name, 7)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_times_that_are_no_times(value: float) -> None:
    message = refusal(ValueError, lambda: atm.fuse(**at("t", 7, value), rig="nomad200"))
    assert_names(message, "t", 7)


def test_times_that_go_back() -> None:
    columns = readings()
    columns["t"][9] = 0
    columns["t"][15] = 0
    assert_names(refusal(ValueError, lambda: atm.fuse(**columns, rig="nomad200")), "t", 9)
    seconds = {**columns, "t": columns["t"] / 1e9}
    assert_names(refusal(ValueError, lambda: atm.fuse(**seconds, rig="nomad200")), "t", 9)


def test_ranges_without_an_echo_are_no_errors() -> None:
    columns = readings()
    columns["range_"][:4] = [np.nan, np.inf, -np.inf, -1.0]
    assert len(atm.fuse(**columns, rig="nomad200")) > 0


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("length", [0, 1, 19, 21])
def test_lengths_that_differ(name: str, length: int) -> None:
    columns = readings()
    columns[name] = np.resize(columns[name], length)
    message = refusal(ValueError, lambda: atm.fuse(**columns, rig="nomad200"))
    # Where t differs from the rest, it may as well be the rest that is named.
    assert str(length) in message and "20" in message, message
    assert any(f"{other}:" in message or f"{other} " in message for other in NAMES), message
    if name != "t":
        assert_names(message, name)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("shape", [(4, 5), (20, 1), (1, 20)])
def test_shapes_that_are_no_columns(name: str, shape: tuple[int, ...]) -> None:
    columns = readings()
    columns[name] = columns[name].reshape(shape)
    assert_names(refusal(ValueError, lambda: atm.fuse(**columns, rig="nomad200")), name)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "value",
    [
        np.array([object()] * 20),
        [None] * 20,
        [{}] * 20,
        np.zeros(20, dtype=complex),
        np.zeros(20, dtype="m8[ns]"),
        np.zeros(20, dtype=[("a", "f8")]),
        np.array([b"\xff"] * 20),
        object(),
        None,
    ],
    ids=["objects", "None", "dicts", "complex", "timedelta64", "records", "bytes", "an object", "nothing"],
)
def test_objects_instead_of_numbers(name: str, value: Any) -> None:
    assert_names(refusal(REFUSED, lambda: atm.fuse(**with_(**{name: value}), rig="nomad200")), name)


@pytest.mark.parametrize("name", ["t", "range_", "x", "y", "yaw"])
def test_strings_instead_of_numbers(name: str) -> None:
    text = np.array(["1.0"] * 20)
    assert_names(refusal(REFUSED, lambda: atm.fuse(**with_(**{name: text}), rig="nomad200")), name)


@pytest.mark.parametrize("name", ["range_", "x", "y", "yaw"])
def test_one_object_among_numbers(name: str) -> None:
    mixed: list[Any] = [1.0] * 20
    mixed[7] = object()
    message = refusal(REFUSED, lambda: atm.fuse(**with_(**{name: mixed}), rig="nomad200"))
    assert_names(message, name, 7)


@pytest.mark.parametrize("unknown", [16, 99, -1, 2**40])
def test_sensors_beyond_the_rig(unknown: int) -> None:
    message = refusal(ValueError, lambda: atm.fuse(**at("sensor", 7, unknown), rig="nomad200"))
    assert_names(message, "sensor", 7)
    assert str(unknown) in message


def test_sensor_names_that_the_rig_does_not_have() -> None:
    columns = readings()
    columns["sensor"] = columns["sensor"].astype("U9")
    columns["sensor"][7:9] = "rear"
    message = refusal(ValueError, lambda: atm.fuse(**columns, rig="nomad200"))
    assert_names(message, "sensor", 7)
    assert "rear" in message


def test_one_number_among_sensor_names() -> None:
    mixed: list[Any] = [str(k % 16) for k in range(20)]
    mixed[7] = 3.5
    message = refusal(REFUSED, lambda: atm.fuse(**with_(sensor=np.array(mixed, dtype=object)), rig="nomad200"))
    assert_names(message, "sensor", 7)


DOMAINS: list[tuple[str, Any]] = [
    ("history", 0),
    ("history", -1),
    ("history", 2**70),
    ("history", 2.5),
    ("history", "ten"),
    ("min_angle", 0.0),
    ("min_angle", -0.5),
    ("min_angle", 0.9 * np.deg2rad(1)),
    ("min_angle", 1.01 * np.pi / 2),
    ("min_angle", 30),
    ("min_angle", np.nan),
    ("min_angle", "30deg"),
    ("range_resolution", 0.0),
    ("range_resolution", -0.1),
    ("range_resolution", np.nan),
    ("range_resolution", np.inf),
    ("field_of_view", 0.0),
    ("field_of_view", 3.5),
    ("field_of_view", np.nan),
    ("emit", "later"),
    ("emit", 3),
    ("on_none", "mean"),
    ("on_two", "center "),
    ("max_age", -1.0),
    ("max_age", np.nan),
    ("max_travel", -1.0),
    ("max_travel", np.nan),
    ("min_step", -1.0),
    ("min_step", np.nan),
    ("keep", ["medium"]),
    ("keep", 3),
    ("drop_held", "no"),
    ("held", "once"),
    ("held", 3),
    ("estimator", "median"),
    ("estimator", None),
    ("confidence", 0.5),
    ("range_error", 0.01),
    ("confidence", "much"),
]


@pytest.mark.parametrize(("name", "value"), DOMAINS, ids=lambda value: str(value))
def test_options_out_of_their_domain(name: str, value: Any) -> None:
    message = refusal(REFUSED, lambda: atm.fuse(**readings(), rig="nomad200", **{name: value}))
    assert_names(message, name)
    if name != "keep":
        message = refusal(REFUSED, lambda: atm.Fuser("nomad200", **{name: value}))
        assert_names(message, name)


@pytest.mark.parametrize(
    ("name", "value"),
    [("confidence", 1.0), ("confidence", -0.1), ("confidence", np.nan), ("range_error", -1.0), ("range_error", np.inf),
     ("on_none", "drop"), ("on_two", "mean"), ("keep", "median")],
    ids=str,
)
def test_options_of_the_consensus_out_of_their_domain(name: str, value: Any) -> None:
    options = {"estimator": "consensus", name: value}
    assert_names(refusal(REFUSED, lambda: atm.fuse(**readings(), rig="nomad200", **options)), name)
    if name != "keep":
        assert_names(refusal(REFUSED, lambda: atm.Fuser("nomad200", **options)), name)


def test_held_said_twice() -> None:
    twice: dict[str, Any] = {"held": "keep", "drop_held": True}
    assert_names(refusal(REFUSED, lambda: atm.fuse(**readings(), rig="nomad200", **twice)), "held")


def test_options_that_do_not_exist() -> None:
    with pytest.raises(TypeError, match="min_angel"):
        atm.fuse(**readings(), rig="nomad200", min_angel=0.5)


@pytest.mark.parametrize("rig", [None, 3, [], object(), "", "nomad2000"])
def test_rigs_that_are_none(rig: Any) -> None:
    refusal((ValueError, TypeError, OSError), lambda: atm.fuse(**readings(), rig=rig))


def test_rig_is_required() -> None:
    with pytest.raises(TypeError, match="rig"):
        atm.fuse(**readings())


@pytest.mark.parametrize("count", [0, -1, 65_537, 1_000_000, 2**64, 2.5, "16"])
def test_ring_counts(count: Any) -> None:
    assert_names(refusal(REFUSED, lambda: atm.Rig.ring(count=count, radius=0.2)), "count")


RING_DOMAINS = [
    ("radius", -0.1),
    ("radius", np.nan),
    ("first_yaw", np.inf),
    ("field_of_view", 0.0),
    ("field_of_view", np.nan),
    ("field_of_view", 7.0),
    ("min_range", -1.0),
    ("min_range", np.inf),
    ("max_range", np.nan),
    ("max_range", -2.0),
    ("range_resolution", 0.0),
]


@pytest.mark.parametrize(("name", "value"), RING_DOMAINS)
def test_ring_domains(name: str, value: float) -> None:
    message = refusal(ValueError, lambda: atm.Rig.ring(**{"count": 4, "radius": 0.2, name: value}))
    assert name in message or name.replace("_", " ") in message, message


def test_a_million_sensors_in_a_list() -> None:
    one = atm.Sensor("a")
    assert "sensor" in refusal(ValueError, lambda: atm.Rig.from_sensors([one] * 1_000_000))
    many = (atm.Sensor(str(number)) for number in range(70_000))
    assert "65" in refusal(ValueError, lambda: atm.Rig.from_sensors(many))


def test_sensors_that_are_none() -> None:
    good = atm.Sensor("a")
    assert_names(refusal(TypeError, lambda: atm.Rig.from_sensors([good, "b"])), "sensors", 1)
    assert "id" in refusal(ValueError, lambda: atm.Rig.from_sensors([good, good]))
    refusal(ValueError, lambda: atm.Rig.from_sensors([]))
    refusal(TypeError, lambda: atm.Rig.from_sensors(3))


@pytest.mark.parametrize("toml", ["name = ", "[ring]\ncount = 0\nradius = 1\n", '[[sensor]]\nid = "a"\nyaw = 3\n', "x = 1\n"])
def test_toml_that_is_no_rig(toml: str) -> None:
    refusal(ValueError, lambda: atm.Rig.from_toml(toml))


def test_files_that_are_not_there(tmp_path: Any) -> None:
    with pytest.raises(OSError, match=r"none\.toml"):
        atm.Rig.load(tmp_path / "none.toml")
    with pytest.raises(OSError, match=r"none\.csv"):
        atm.fuse_file(tmp_path / "none.csv", rig="nomad200", output=tmp_path / "out.csv")
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize(
    "plan", [{"improvement": 0}, {"improvement": 1e9}, {"min_angle": 0.0}, {"improvement": 10, "min_angle": 0.5}, {}]
)
def test_plans_that_cannot_be(plan: dict[str, float]) -> None:
    refusal(REFUSED, lambda: atm.plan(distance=2.54, **plan))


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan, np.inf])
def test_plan_distance(distance: float) -> None:
    assert "distance" in refusal(ValueError, lambda: atm.plan(distance=distance, improvement=10))


@pytest.mark.parametrize("call", [atm.fuse, atm.crossings], ids=["fuse", "crossings"])
def test_coordinates_too_large_to_compute_with(call: Any) -> None:
    """Squares of these are infinite: refused or fused, but nothing that is not finite comes out."""
    columns = with_(x=np.full(20, 1e200), range_=np.full(20, 1.5))
    try:
        found = call(**columns, rig="nomad200")
    except ValueError as error:
        assert "x" in str(error)
    else:
        assert np.all(np.isfinite(found["x"]))
