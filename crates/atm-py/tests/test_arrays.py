"""What may go in and what comes out: types, strides, lengths, scalars, and the tables of other packages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import atm

FIELDS = ("t", "sensor", "x", "y", "kind", "range", "azimuth", "crossings", "resolution", "significance")
Readings = tuple[np.ndarray, ...]


@pytest.fixture(scope="module")
def echoes(doorway: Readings) -> np.ndarray:
    return atm.fuse(*doorway, rig="nomad200")


def test_fields_of_the_result(echoes: np.ndarray) -> None:
    assert echoes.dtype.names == FIELDS
    for name in ("x", "y", "range", "azimuth", "resolution", "significance"):
        assert echoes.dtype[name] == np.float64, name
    assert echoes.dtype["kind"].kind == "U"
    assert echoes.dtype["sensor"].kind == "U"
    assert echoes.dtype["crossings"].kind in "iu"
    assert set(echoes["kind"]) <= {"median", "single", "center", "near", "pair"}


@pytest.mark.parametrize("kind", [np.int64, np.float64])
def test_times_come_back_in_their_type(doorway: Readings, kind: Any) -> None:
    t = doorway[0] if kind is np.int64 else doorway[0] / 1e9
    found = atm.fuse(t, *doorway[1:], rig="nomad200")
    assert found.dtype["t"] == kind
    assert set(found["t"].tolist()) <= set(t.tolist())


def test_nanoseconds_beyond_the_digits_of_a_float() -> None:
    t = np.array([2**60 + 1, 2**60 + 2, 2**60 + 3])
    found = atm.fuse(t, [0, 0, 0], [1.0] * 3, [0.0] * 3, [0.0] * 3, [0.0] * 3, rig="nomad200", t_unit="ns")
    assert found["t"].tolist() == t.tolist()


LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "every other": lambda a: np.repeat(a, 2)[::2],
    "backwards in memory": lambda a: a[::-1].copy()[::-1],
    "column of a table": lambda a: np.stack([a, a], axis=1)[:, 1],
    "big-endian": lambda a: a.astype(a.dtype.newbyteorder(">")),
    "read-only": lambda a: np.frombuffer(a.tobytes(), dtype=a.dtype),
    "not aligned": lambda a: np.frombuffer(b"\0" + a.tobytes(), dtype=np.uint8)[1:].view(a.dtype),
    "list": lambda a: a.tolist(),
    "tuple": lambda a: tuple(a.tolist()),
    "buffer": lambda a: memoryview(np.ascontiguousarray(a)),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(doorway: Readings, echoes: np.ndarray, layout: str) -> None:
    found = atm.fuse(*map(LAYOUTS[layout], doorway), rig="nomad200")
    np.testing.assert_array_equal(found, echoes)


@pytest.mark.parametrize("kind", ["f2", "f4", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_numeric_types_are_the_float64_they_convert_to(kind: str) -> None:
    n = 40
    t = np.arange(n) * 10**8
    sensor = np.arange(n) % 16
    range_, x, y, yaw = (np.arange(n) % 2 + 1, np.arange(n) % 3, np.zeros(n), np.arange(n) % 2)
    ours = [column.astype(kind) for column in (range_, x, y, yaw)]
    as_floats = [column.astype(np.float64) for column in ours]
    found = atm.fuse(t, sensor, *ours, rig="nomad200")
    assert len(found) > 0
    np.testing.assert_array_equal(found, atm.fuse(t, sensor, *as_floats, rig="nomad200"))


@pytest.mark.parametrize("kind", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_integer_types_of_sensors(doorway: Readings, echoes: np.ndarray, kind: str) -> None:
    t, sensor, *rest = doorway
    np.testing.assert_array_equal(atm.fuse(t, sensor.astype(kind), *rest, rig="nomad200"), echoes)


@pytest.mark.parametrize("kind", ["U", "U40", "O", "list"])
def test_string_types_of_sensors(doorway: Readings, echoes: np.ndarray, kind: str) -> None:
    t, sensor, *rest = doorway
    names = sensor.astype(str).tolist() if kind == "list" else sensor.astype(str).astype(kind)
    np.testing.assert_array_equal(atm.fuse(t, names, *rest, rig="nomad200"), echoes)


def test_ids_with_letters_of_every_script() -> None:
    ids = ["links", "größer", "前", "🦇", "a" * 70]
    rig = atm.Rig.from_sensors([atm.Sensor(name, yaw=number) for number, name in enumerate(ids)])
    n = len(ids)
    found = atm.fuse(np.arange(n) / 10, np.array(ids), np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n), rig=rig)
    assert sorted(found["sensor"].tolist()) == sorted(ids)
    table = atm.fuse(np.arange(n) / 10, ids, np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n), rig=rig)
    np.testing.assert_array_equal(found, table)


def one_to_eight() -> atm.Rig:
    return atm.Rig.from_sensors([atm.Sensor(str(number), yaw=0.5 * number) for number in range(1, 9)])


def test_ids_from_1_refuse_integers() -> None:
    """A table that turned ids "1" … "8" into numbers must not shift them."""
    rows = np.arange(1, 9)
    rest = (np.ones(8), np.zeros(8), np.zeros(8), np.zeros(8))
    with pytest.raises((ValueError, TypeError), match="sensor"):
        atm.fuse(rows / 10, rows, *rest, rig=one_to_eight())
    with pytest.raises((ValueError, TypeError), match="sensor"):
        atm.fuse(rows / 10, rows - 1, *rest, rig=one_to_eight())
    found = atm.fuse(rows / 10, rows.astype(str), *rest, rig=one_to_eight())
    assert sorted(found["sensor"].tolist()) == [str(number) for number in range(1, 9)]


def test_places_in_the_rig_instead_of_ids() -> None:
    rows = np.arange(8)
    rest = (np.ones(8), np.zeros(8), np.zeros(8), np.zeros(8))
    by_place = atm.fuse(rows / 10, None, *rest, rig=one_to_eight(), sensor_index=rows)
    by_name = atm.fuse(rows / 10, (rows + 1).astype(str), *rest, rig=one_to_eight())
    np.testing.assert_array_equal(by_place, by_name)
    with pytest.raises(ValueError, match=r"sensor_index\[7\]"):
        atm.fuse(rows / 10, None, *rest, rig=one_to_eight(), sensor_index=rows + 1)
    with pytest.raises((ValueError, TypeError), match="sensor"):
        atm.fuse(rows / 10, rows.astype(str), *rest, rig=one_to_eight(), sensor_index=rows)
    with pytest.raises((ValueError, TypeError), match="sensor"):
        atm.fuse(rows / 10, None, *rest, rig=one_to_eight())


def test_floats_are_no_sensors() -> None:
    rows = np.arange(4)
    with pytest.raises((ValueError, TypeError), match="sensor"):
        atm.fuse(rows / 10, rows.astype(float), np.ones(4), rows, rows, rows, rig="nomad200")


def test_nothing_in_nothing_out(echoes: np.ndarray) -> None:
    for nothing in (np.array([]), [], np.zeros(0, dtype=np.float32)):
        found = atm.fuse(np.zeros(0, dtype=np.int64), nothing, nothing, nothing, nothing, nothing, rig="nomad200")
        assert found.shape == (0,)
        assert found.dtype.names == echoes.dtype.names
        assert found["kind"].tolist() == []


def test_arguments_are_left_alone(doorway: Readings) -> None:
    before = [column.copy() for column in doorway]
    atm.fuse(*doorway, rig="nomad200")
    for column, copy in zip(doorway, before):
        np.testing.assert_array_equal(column, copy)


def test_result_belongs_to_the_caller(echoes: np.ndarray) -> None:
    mine = echoes.copy()
    assert echoes.flags.writeable
    mine["x"] += 1
    assert not np.array_equal(mine["x"], echoes["x"])


def test_pandas_takes_it(echoes: np.ndarray) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(echoes)
    assert list(table.columns) == list(FIELDS)
    assert len(table) == len(echoes)
    assert table["kind"].value_counts()["median"] == np.count_nonzero(echoes["kind"] == "median")
    assert table["x"].to_numpy().tolist() == echoes["x"].tolist()


def test_pandas_columns_go_in(doorway: Readings, echoes: np.ndarray) -> None:
    pandas = pytest.importorskip("pandas")
    names = ("t", "sensor", "range", "x", "y", "yaw")
    table = pandas.DataFrame(dict(zip(names, doorway)))
    np.testing.assert_array_equal(atm.fuse(*(table[name] for name in names), rig="nomad200"), echoes)
    table["sensor"] = table["sensor"].astype(str)
    np.testing.assert_array_equal(atm.fuse(*(table[name] for name in names), rig="nomad200"), echoes)


def test_polars_takes_it(echoes: np.ndarray) -> None:
    polars = pytest.importorskip("polars")
    frame = polars.from_numpy(echoes)
    assert frame.columns == list(FIELDS)
    assert frame["kind"].to_list() == echoes["kind"].tolist()
    assert frame["x"].to_list() == echoes["x"].tolist()


def arrow_log(doorway: Readings, sensor: str = "string", seconds: bool = False) -> Any:
    pyarrow = pytest.importorskip("pyarrow")
    t, number, *rest = doorway
    text = pyarrow.array(number.astype(str).tolist())
    columns = {
        "t": pyarrow.array(t / 1e9 if seconds else t),
        "sensor": {
            "string": lambda: text,
            "large": lambda: text.cast(pyarrow.large_string()),
            "dictionary": text.dictionary_encode,
            "integer": lambda: pyarrow.array(number),
        }[sensor](),
    }
    return pyarrow.table({**columns, **dict(zip(("range", "x", "y", "yaw"), map(pyarrow.array, rest)))})


@pytest.mark.parametrize("seconds", [False, True])
@pytest.mark.parametrize("sensor", ["string", "large", "dictionary", "integer"])
def test_arrow_tables(doorway: Readings, sensor: str, seconds: bool) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    out = pyarrow.table(atm.fuse_table(arrow_log(doorway, sensor, seconds), rig="nomad200"))
    t = doorway[0] / 1e9 if seconds else doorway[0]
    echoes = atm.fuse(t, *doorway[1:], rig="nomad200")
    assert out.column_names == list(FIELDS)
    for name in FIELDS:
        assert out[name].to_pylist() == echoes[name].tolist(), name


def test_arrow_table_in_chunks_and_slices(doorway: Readings, echoes: np.ndarray) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    whole = arrow_log(doorway)
    pieces = pyarrow.concat_tables([whole.slice(0, 100), whole.slice(100, 1), whole.slice(101)])
    assert pieces["x"].num_chunks == 3
    out = pyarrow.table(atm.fuse_table(pieces, rig="nomad200"))
    assert out["x"].to_pylist() == echoes["x"].tolist()


def test_arrow_table_of_polars(doorway: Readings, echoes: np.ndarray) -> None:
    polars = pytest.importorskip("polars")
    pyarrow = pytest.importorskip("pyarrow")
    out = pyarrow.table(atm.fuse_table(polars.from_arrow(arrow_log(doorway)), rig="nomad200"))
    assert out["y"].to_pylist() == echoes["y"].tolist()
    assert polars.from_arrow(out).height == len(echoes)


def test_arrow_table_without_a_column(doorway: Readings) -> None:
    pytest.importorskip("pyarrow")
    with pytest.raises(ValueError, match="yaw"):
        atm.fuse_table(arrow_log(doorway).drop_columns(["yaw"]), rig="nomad200")


def test_crossings_lie_on_the_arcs_of_the_echoes(doorway: Readings, echoes: np.ndarray) -> None:
    found = atm.crossings(*doorway, rig="nomad200")
    assert len(found) >= echoes["crossings"].sum()
    assert np.all(found["angle"] >= np.pi / 6 - 1e-12)
    assert np.all(found["angle"] <= np.pi / 2)
    singles = echoes[echoes["kind"] == "single"]
    for echo in singles[:10]:
        mine = found[(found["t"] == echo["t"]) & (found["sensor"] == echo["sensor"])]
        assert len(mine) == 1
        assert (mine["x"][0], mine["y"][0]) == pytest.approx((echo["x"], echo["y"]), abs=1e-9)


def test_whole_numbers_need_their_unit_where_they_are_no_nanoseconds(doorway: Readings, echoes: np.ndarray) -> None:
    t, *rest = doorway
    whole = t // 10**9
    assert len(np.unique(whole)) == 49
    with pytest.raises(ValueError, match=r"t: whole numbers from 0 to 48.*48 ns for 49 different times.*t_unit"):
        atm.fuse(whole, *rest, rig="nomad200", max_age=5.0)
    with pytest.raises(ValueError, match="t_unit"):
        atm.Fuser("nomad200").push(whole, *rest)
    with pytest.raises(ValueError, match="t_unit"):
        atm.crossings(whole, *rest, rig="nomad200")
    seconds = atm.fuse(whole.astype(float), *rest, rig="nomad200", max_age=5.0)
    np.testing.assert_array_equal(atm.fuse(whole, *rest, rig="nomad200", max_age=5.0, t_unit="s"), seconds)
    np.testing.assert_array_equal(atm.fuse(whole * 1000, *rest, rig="nomad200", max_age=5.0, t_unit="ms"), seconds)
    assert len(seconds) != len(echoes) or not np.array_equal(seconds["kind"], echoes["kind"])
    # Who says that they are nanoseconds is believed.
    as_they_are = atm.fuse(whole, *rest, rig="nomad200", t_unit="ns")
    np.testing.assert_array_equal(as_they_are["kind"], echoes["kind"])
    with pytest.raises(ValueError, match="t_unit"):
        atm.fuse(whole, *rest, rig="nomad200", t_unit="min")


def test_one_time_alone_is_no_pace() -> None:
    fuser = atm.Fuser("nomad200", emit="latest")
    assert len(fuser.push([1, 1], ["0", "4"], [1.0, 2.0], 0.0, 0.0, 0.0)) == 2
    assert len(fuser.push(2, "0", 1.0, 0.0, 0.0, 0.0)) == 1


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_timestamps_say_their_unit(doorway: Readings, echoes: np.ndarray, unit: str) -> None:
    t, *rest = doorway
    found = atm.fuse(t.astype("datetime64[ns]").astype(f"datetime64[{unit}]"), *rest, rig="nomad200")
    np.testing.assert_array_equal(found, echoes)
    with pytest.raises(ValueError, match=r"t\[1\]: is no time: NaT"):
        atm.fuse(np.array([0, "NaT"], dtype="datetime64[ns]"), *(column[:2] for column in rest), rig="nomad200")
