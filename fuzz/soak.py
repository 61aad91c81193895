#!/usr/bin/env python3
"""A hundred million readings: memory stays flat, and the last million gives what it gives alone.

    fuzz/soak.py command [READINGS]     through `atm fuse - -o - --max-age 5s`, the binary from $ATM, by default target/release/atm
    fuzz/soak.py python [READINGS]      through `Fuser.push`, with an interpreter that has the package

The log is the sample's drive again and again. Between two millions lies a thousand seconds, after which nothing of the first is in the
local map: the last million then has to give, bit for bit, what a run over it alone gives. Linux; takes a quarter of an hour and more.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections import deque
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MILLION = 1_000_000
MAX_AGE = 5
PAUSE = 1000
HEADER = b"t,sensor,range,x,y,yaw\n"
# How far memory may lie above what it was after the first million, in KiB.
FLAT = 1024


def rows() -> list[tuple[int, list[str]]]:
    """The sample: whole seconds, and the other cells."""
    lines = (ROOT / "examples/doorway.csv").read_text().splitlines()[1:]
    return [(int(float(t)), cells) for t, *cells in (line.split(",") for line in lines)]


def times(million: int) -> tuple[int, int]:
    """When a million begins, in seconds, and how long one drive takes."""
    drive = rows()
    period = drive[-1][0] + 1
    return million * (MILLION // len(drive) * period + period + PAUSE), period


def text(million: int) -> bytes:
    """A million rows of the log."""
    drive = [(t, "," + ",".join(cells) + "\n") for t, cells in rows()]
    begin, period = times(million)
    parts: list[str] = []
    for turn in range(-(-MILLION // len(drive))):
        start = begin + turn * period
        parts += [f"{start + t}{rest}" for t, rest in drive]
    return "".join(parts[:MILLION]).encode()


def memory(pid: int | str) -> int:
    """Resident memory, in KiB."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise RuntimeError("no VmRSS")


class Run:
    """`atm fuse` with the end of its output."""

    def __init__(self, keep: int) -> None:
        atm = os.environ.get("ATM", str(ROOT / "target/release/atm"))
        command = [atm, "fuse", "-", "-o", "-", "--rig", "nomad200", "--max-age", f"{MAX_AGE}s", "--quiet"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.blocks: deque[bytes] = deque()
        self.keep, self.kept, self.written = keep, 0, 0
        self.reader = threading.Thread(target=self.read)
        self.reader.start()
        self.feed(HEADER)

    def feed(self, bytes_: bytes) -> None:
        assert self.process.stdin
        self.process.stdin.write(bytes_)
        self.process.stdin.flush()

    def read(self) -> None:
        assert self.process.stdout
        while block := self.process.stdout.read1(1 << 16):
            self.blocks.append(block)
            self.kept += len(block)
            self.written += len(block)
            while self.kept - len(self.blocks[0]) > self.keep:
                self.kept -= len(self.blocks.popleft())

    def end(self) -> bytes:
        assert self.process.stdin
        self.process.stdin.close()
        assert self.process.wait() == 0
        self.reader.join()
        return b"".join(self.blocks)


def command(millions: int) -> None:
    alone = Run(keep=1 << 40)
    alone.feed(text(millions - 1))
    expected = alone.end().split(b"\n", 1)[1]

    run = Run(keep=len(expected))
    after: list[int] = []
    start = time.monotonic()
    for million in range(millions):
        run.feed(text(million))
        after.append(memory(run.process.pid))
        report(million + 1, start, after)
    found = run.end()
    print(f"output: {run.written} bytes, the last {len(expected)} are those of the last million")
    judge(after, found[-len(expected) :] == expected)


def python(millions: int) -> None:
    import atm

    drive = [(t, int(s), float(r), float(x), float(y), float(yaw)) for t, (s, r, x, y, yaw) in rows()]
    rig = atm.Rig.builtin("nomad200")

    def push(fuser: atm.Fuser, million: int, sink: list[object] | None) -> None:
        begin, period = times(million)
        count = 0
        for turn in range(-(-MILLION // len(drive))):
            start = begin + turn * period
            for t, sensor, range_, x, y, yaw in drive[: MILLION - count]:
                echoes = fuser.push((start + t) * 1_000_000_000, sensor, range_, x, y, yaw)
                if sink is not None:
                    sink += map(repr, echoes)
            count += len(drive)

    def fuser() -> atm.Fuser:
        return atm.Fuser(rig, history=10, max_age=float(MAX_AGE))

    long, after, start = fuser(), [], time.monotonic()
    for million in range(millions - 1):
        push(long, million, None)
        after.append(memory("self"))
        report(million + 1, start, after)
    # The echoes of the million before leave with the first reading of the last one: they are not its own.
    found: list[object] = []
    push(long, millions - 1, found)
    found += map(repr, long.finish())
    alone, expected = fuser(), []
    push(alone, millions - 1, expected)
    expected += map(repr, alone.finish())
    report(millions, start, after)
    print(f"echoes of the last million: {len(expected)}")
    judge(after, found[-len(expected) :] == expected)


def report(million: int, start: float, after: list[int]) -> None:
    if million <= 3 or million % 10 == 0:
        print(f"{million:4} million readings, {time.monotonic() - start:7.1f} s, {after[-1]} KiB", flush=True)


def judge(after: list[int], same: bool) -> None:
    growth = max(after[1:], default=after[0]) - after[0]
    print(f"memory after the first million {after[0]} KiB, at most {growth:+} KiB later")
    print(f"the last million: {'identical' if same else 'DIFFERENT'}")
    sys.exit(0 if same and growth <= FLAT else 1)


if __name__ == "__main__":
    which = {"command": command, "python": python}[sys.argv[1]]
    readings = int(float(sys.argv[2])) if len(sys.argv) > 2 else 100 * MILLION
    which(readings // MILLION)
