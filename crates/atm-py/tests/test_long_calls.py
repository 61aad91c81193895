"""Calls that last, and calls that are many: threads, Ctrl-C, memory."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import tracemalloc
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import atm

Readings = tuple[np.ndarray, ...]


def long_drive(n: int) -> Readings:
    """A ring that circles a pole: with a long history every reading meets thousands of arcs."""
    turn = np.arange(n) / 16 // 1 * 0.01
    t = np.arange(n) * 1_000_000
    return t, np.arange(n) % 16, np.full(n, 1.5), np.cos(turn), np.sin(turn), turn


SLOW: dict[str, Any] = {"rig": "nomad200", "history": 300}


def test_other_threads_run_while_one_fuses() -> None:
    """With the interpreter's lock held the other thread would not tick at all."""
    readings = long_drive(30_000)
    ticks, done = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.is_set():
            time.sleep(0.002)
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    start, before = time.perf_counter(), ticks
    atm.fuse(*readings, **SLOW)
    seconds, during = time.perf_counter() - start, ticks - before
    done.set()
    ticker.join()
    assert seconds > 0.05, f"too short to say anything: {seconds} s"
    assert during > seconds / 0.002 / 20, f"{during} ticks in {seconds} s"


def test_threads_give_the_same(doorway: Readings) -> None:
    alone = atm.fuse(*doorway, rig="nomad200")
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda _: atm.fuse(*doorway, rig="nomad200"), range(32)))
    for found in together:
        np.testing.assert_array_equal(found, alone)


def test_one_fuser_in_many_threads_stays_whole(doorway: Readings) -> None:
    """Pushes may come in any order or be refused; nothing may break."""
    fuser = atm.Fuser("nomad200", emit="latest")
    rest = tuple(column[:16] for column in doorway[1:])

    def push(_: int) -> int:
        try:
            return len(fuser.push(np.zeros(16, dtype=np.int64), *rest))
        except (RuntimeError, ValueError):
            return 0

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(push, range(200))) > 0


INTERRUPTED = """
import signal, sys, time
import numpy as np
import atm
sys.path.insert(0, {tests!r})
from test_long_calls import long_drive
signal.signal(signal.SIGINT, signal.default_int_handler)
readings = long_drive(2_000_000)
print("go", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print("stopped", flush=True)
    sys.exit(7)
print("came to its end", flush=True)
"""
CALLS = {
    "fuse": 'atm.fuse(*readings, rig="nomad200", history=300)',
    "push": 'atm.Fuser("nomad200", history=300).push(*readings)',
    "fuse_file": 'atm.fuse_file({log!r}, rig="nomad200", output={out!r}, history=2000)',
}


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_stops_a_long_call(name: str, tmp_path: Path) -> None:
    log, out = tmp_path / "log.csv", tmp_path / "out.csv"
    call = CALLS[name].format(log=str(log), out=str(out))
    if name == "fuse_file":
        t, sensor, *rest = long_drive(100_000)
        columns = (t / 1e9, sensor, *rest)
        np.savetxt(log, np.stack(columns, 1), delimiter=",", header="t,sensor,range,x,y,yaw", comments="", fmt="%.6g")
    script = INTERRUPTED.format(call=call, tests=str(Path(__file__).parent))
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        assert run.stdout.readline() == "go\n"
        time.sleep(0.7)
        sent = time.perf_counter()
        run.send_signal(signal.SIGINT)
        try:
            said, errors = run.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            run.kill()
            pytest.fail(f"{name} runs on 20 s after the signal")
        waited = time.perf_counter() - sent
    assert (said, run.returncode) == ("stopped\n", 7), errors
    assert waited < 3, f"{waited} s until {name} stopped"
    assert not out.exists()


def resident() -> int:
    """Bytes of this process in memory."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def fused(few: Readings) -> None:
    atm.fuse(*few, rig="nomad200")


def refused(few: Readings) -> None:
    broken = np.full(len(few[0]), np.nan)
    try:
        atm.fuse(few[0], few[1], few[2], broken, few[4], few[5], rig="nomad200")
    except ValueError:
        return
    raise AssertionError("NaN poses were taken")


def pushed(few: Readings) -> None:
    fuser = atm.Fuser("nomad200")
    fuser.push(*few)
    fuser.snapshot()
    fuser.finish()


def named(few: Readings) -> None:
    rig = atm.Rig.from_sensors([atm.Sensor(str(number)) for number in range(16)])
    atm.fuse(few[0], few[1].astype(str), *few[2:], rig=rig)


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="reads /proc")
@pytest.mark.parametrize("call", [fused, refused, pushed, named], ids=lambda call: call.__name__)
def test_no_leak_over_ten_thousand_calls(doorway: Readings, call: Callable[[Readings], None]) -> None:
    few = tuple(column[:24].copy() for column in doorway)
    for _ in range(1_000):
        call(few)
    gc.collect()
    before = resident()
    for _ in range(10_000):
        call(few)
    gc.collect()
    grown = resident() - before
    # One word a call would be 80 kB, one log 11 MB.
    assert grown < 2_000_000, f"{grown} bytes more after 10,000 calls"


def traced() -> int:
    """Bytes that Python holds, without what its cache of attributes keeps (up to 4096 names)."""
    gc.collect()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        sys._clear_type_cache()
    return tracemalloc.get_traced_memory()[0]


@pytest.mark.parametrize("call", [fused, refused, pushed, named], ids=lambda call: call.__name__)
def test_no_python_object_stays(doorway: Readings, call: Callable[[Readings], None]) -> None:
    few = tuple(column[:24].copy() for column in doorway)
    calls = 1_000
    tracemalloc.start()
    try:
        for _ in range(100):
            call(few)
        before = traced()
        for _ in range(calls):
            call(few)
        grown = traced() - before
    finally:
        tracemalloc.stop()
    # The smallest object has 16 bytes.
    assert grown < 10 * calls, f"{grown} bytes more after {calls} calls"


def test_references_are_given_back(doorway: Readings) -> None:
    few = tuple(column[:24].copy() for column in doorway)
    counts = [sys.getrefcount(column) for column in few]
    rig = atm.Rig.builtin("nomad200")
    of_rig = sys.getrefcount(rig)
    for _ in range(10):
        atm.fuse(*few, rig=rig)
        atm.Fuser(rig).push(*few)
    assert [sys.getrefcount(column) for column in few] == counts
    assert sys.getrefcount(rig) == of_rig
