"""Arrays of any kind, shape and content: echoes, or an error in words; never a crash, and nothing of the caller's is changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import atm

RIG = atm.Rig.ring(count=3, radius=0.2, field_of_view=1.0, max_range=5.0)
COLUMNS = ("t", "sensor", "range", "x", "y", "yaw")
# What may be said of an array that is not to be used. Anything else is a defect, a panic before all.
REFUSALS = (ValueError, TypeError, OverflowError)


def same(one: object, other: object) -> bool:
    """Equal, with every NaN equal to itself."""
    return repr(one) == repr(other) if not isinstance(one, np.ndarray) else one.tobytes() == np.asarray(other).tobytes()


def columns(length: int) -> st.SearchStrategy[Any]:
    """Numbers of any bits in any layout, text, objects; mostly of the right length."""
    lengths = st.sampled_from([length] * 12 + [0, length + 1])
    numbers = hnp.arrays(
        st.sampled_from(["f8", "f8", "f4", "i8", "u8", "i2", "u1", "?", ">f8", "f2", "M8[ns]", "c8"]),
        lengths,
        elements=None,
    )
    layouts = st.sampled_from([
        lambda a: a,
        lambda a: a[::-1],
        lambda a: np.repeat(a, 3)[::3],
        lambda a: np.asfortranarray(np.stack([a, a], axis=1))[:, 0],
        lambda a: a.reshape(-1, 1),
        lambda a: np.frombuffer(b"\0" + a.tobytes(), dtype=np.uint8)[1:].view(a.dtype),
    ])
    text = lengths.flatmap(lambda n: st.lists(st.sampled_from(["0", "1", "2", "", "9", "\u00e9", "0\0"]), min_size=n, max_size=n))
    strange = st.sampled_from([None, 1.0, "text", object(), [[1.0], [2.0, 3.0]], [None] * length, [2**70] * length, iter([])])
    drawn = st.builds(lambda layout, a: layout(a), layouts, numbers)
    ordinary = hnp.arrays("f8", st.just(length), elements=st.floats(-3, 3))
    return st.one_of(ordinary, ordinary, ordinary, drawn, text, text.map(np.array), strange)


@st.composite
def calls(draw: st.DrawFn) -> dict[str, Any]:
    """The six columns of a call."""
    length = draw(st.integers(0, 20))
    chosen = {name: draw(columns(length)) for name in COLUMNS}
    # So that some get further than the check of time and sensor.
    if draw(st.booleans()):
        chosen["t"] = np.sort(draw(hnp.arrays("i8", st.just(length))))
        chosen["sensor"] = draw(hnp.arrays("i8", st.just(length), elements=st.integers(0, 3)))
    return chosen


def sane(echoes: np.ndarray) -> None:
    """What holds of every echo."""
    assert np.all(np.abs(echoes["azimuth"]) <= np.pi / 2 + 1e-9)
    assert np.all(echoes["range"] > 0)
    assert np.all((echoes["significance"] >= 0) & (echoes["significance"] <= 1))
    assert set(echoes["kind"]) <= {"median", "single", "center", "near", "pair"}


# An array of complex numbers is refused; numpy has its say when the message looks for the first one.
@pytest.mark.filterwarnings("ignore:Casting complex")
@settings(max_examples=120)
@given(call=calls(), emit=st.sampled_from(["settled", "latest"]))
def test_any_arrays_give_echoes_or_words(call: dict[str, Any], emit: str) -> None:
    before = {name: column.copy() for name, column in call.items() if isinstance(column, np.ndarray)}
    try:
        echoes = atm.fuse(call["t"], call["sensor"], call["range"], call["x"], call["y"], call["yaw"], rig=RIG, emit=emit)
    except REFUSALS as refusal:
        assert str(refusal), type(refusal)
    else:
        sane(echoes)
    assert all(same(call[name], column) for name, column in before.items())


@settings(max_examples=80)
@given(
    pushes=st.lists(
        st.tuples(
            st.one_of(st.integers(-(2**63), 2**63 - 1), st.integers(), st.floats(), st.none()),
            st.one_of(st.integers(0, 3), st.integers(), st.text(max_size=2)),
            *(st.one_of(st.floats(-3, 3), st.floats(), st.integers()) for _ in range(4)),
        ),
        max_size=30,
    )
)
def test_any_pushes_give_echoes_or_words(pushes: list[tuple[Any, ...]]) -> None:
    fuser = atm.Fuser(RIG, history=2)
    for push in pushes:
        try:
            echoes = fuser.push(*push)
        except REFUSALS as refusal:
            assert str(refusal), type(refusal)
        else:
            assert all(abs(echo.azimuth) <= np.pi / 2 + 1e-9 for echo in echoes)
    assert len(fuser.finish()) + len(fuser.snapshot()) >= 0


@settings(max_examples=60)
@given(
    keywords=st.fixed_dictionaries(
        {},
        optional={
            name: st.one_of(st.floats(), st.integers(), st.none(), st.just("1"))
            for name in ("count", "radius", "first_yaw", "field_of_view", "min_range", "max_range", "range_resolution")
        },
    )
)
def test_any_rig_is_a_rig_or_words(keywords: dict[str, Any]) -> None:
    try:
        rig = atm.Rig.ring(**keywords)
    except REFUSALS as refusal:
        assert str(refusal), type(refusal)
    else:
        assert 1 <= len(rig) <= 65_535
