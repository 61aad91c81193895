"""One million readings: `atm.fuse` beside the same work in Rust, and beside plain numpy.

Run it with an interpreter that has the package, from the repository's root; it needs the Rust toolchain::

    python crates/atm-py/benches/million.py

The Rust side is ``cargo bench --bench columns``. Both take turns, so that a machine that slows down slows both; the ratio is
taken turn by turn. The numpy side is the reference of the tests, on the first readings alone: its cost a reading is given.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from statistics import median

import numpy as np

import atm

ROOT = Path(__file__).resolve().parents[3]
READINGS = 1_000_000
NUMPY_READINGS = 1_568  # two drives of the sample
TURNS = 5
CALLS = 7

sys.path.insert(0, str(ROOT / "crates/atm-py/tests"))
import reference  # noqa: E402


def columns() -> dict[str, np.ndarray]:
    """The doorway sample, again and again."""
    log = np.genfromtxt(ROOT / "examples/doorway.csv", delimiter=",", names=True)
    rounds = READINGS // len(log) + 1
    t = np.round(log["t"] * 1e9).astype(np.int64)
    t = np.concatenate([t + turn * (t[-1] + 1_000_000_000) for turn in range(rounds)])[:READINGS]
    names = ("range", "x", "y", "yaw")
    repeated = {name: np.tile(log[name], rounds)[:READINGS].copy() for name in names}
    sensor = np.tile(log["sensor"].astype(np.uint16), rounds)[:READINGS].copy()
    return {"t": t, "sensor": sensor, **repeated}


def python(log: dict[str, np.ndarray], rig: atm.Rig, emit: str) -> float:
    """Seconds of one call: the median of several."""
    readings = (log["t"], None, log["range"], log["x"], log["y"], log["yaw"])

    def once() -> float:
        start = time.perf_counter()
        atm.fuse(*readings, rig=rig, sensor_index=log["sensor"], emit=emit)
        return time.perf_counter() - start

    return median(once() for _ in range(CALLS))


def rust(emit: str) -> float:
    """Seconds of one run: the median that criterion found."""
    command = ["cargo", "bench", "--quiet", "--bench", "columns", "--", "--noplot", f"columns/{emit}"]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    metadata = subprocess.run(
        ["cargo", "metadata", "--format-version", "1", "--no-deps"], cwd=ROOT, check=True, capture_output=True
    )
    target = Path(json.loads(metadata.stdout)["target_directory"])
    estimates = json.loads((target / f"criterion/columns/{emit}/million/new/estimates.json").read_text())
    return float(estimates["median"]["point_estimate"]) * 1e-9


def plain_numpy(log: dict[str, np.ndarray], rig: atm.Rig, emit: str) -> float:
    """Seconds of the tests' reference for the first readings."""
    mounts = [
        reference.Mount(s.x, s.y, s.yaw, s.field_of_view, s.min_range, s.max_range, s.range_resolution)
        for s in rig.sensors
    ]
    first = {name: column[:NUMPY_READINGS] for name, column in log.items()}
    readings = reference.Log(**{**first, "sensor": first["sensor"].astype(np.intp)})
    start = time.perf_counter()
    reference.fuse(readings, mounts, reference.Method(emit=emit))
    return time.perf_counter() - start


def main() -> None:
    log, rig = columns(), atm.Rig.builtin("nomad200")
    for emit in ("latest", "settled"):
        turns = [(rust(emit), python(log, rig, emit)) for _ in range(TURNS)]
        ratios = sorted(ours / theirs for theirs, ours in turns)
        theirs, ours = (median(column) for column in zip(*turns))
        slow = plain_numpy(log, rig, emit) / NUMPY_READINGS
        print(
            f"{emit}: Rust {theirs * 1e3:.0f} ms, Python {ours * 1e3:.0f} ms, ratio {median(ratios):.2f} "
            f"({ratios[0]:.2f} to {ratios[-1]:.2f}); plain numpy {slow * READINGS / ours:.0f} times Python's"
        )


if __name__ == "__main__":
    main()
